//! The part of a panel that the body and its lines may cover.

use super::draft::Draft;
use crate::picture::camera::Lens;
use crate::picture::layout::Rectangle;
use crate::picture::layout::steps::FREE;
use glam::{DVec2, DVec3};

impl Draft<'_> {
    /// The part of the panel that the body, its lines and points around obstacles (m) may cover.
    pub(super) fn region(&self, around_obstacles: &[DVec3]) -> Rectangle {
        let mut room = FREE * self.scale.line() + 2.0;
        if let Some(radius) = self.bead_radius() {
            room = room.max(radius + 2.0);
        }
        let [nodes, surfaces, around] = [&self.position[..], self.carried(), around_obstacles]
            .map(|points| region(self.viewport, points.iter(), &self.lens, room));
        let body = union(nodes, surfaces);
        // Obstacles are drawn below the rows of words, if there are any.
        let has_words = self.scene.view.labels.are_in_panels();
        let region = union(body, if has_words { overlap(around, self.between_words()) } else { around });
        // Everything ends at the panel's words. A diverged body may cover the whole panel, and the words report it.
        if self.diverged { overlap(region, self.clear) } else { region }
    }

    /// Whether the body leaves the panel, if the camera does not follow it.
    pub(super) fn is_cut(&self) -> bool {
        let [left, top, width, height] = self.viewport.map(f64::from);
        let is_inside = |&at: &DVec3| {
            let pixel = self.lens.project(at).map(|(pixel, _)| pixel);
            pixel.is_some_and(|[x, y]| (left..=left + width).contains(&x) && (top..=top + height).contains(&y))
        };
        // The elements that carry a surface are not seen.
        let seen = if self.carried().is_empty() { &self.position[..] } else { &self.skin };
        !self.framing.moves && !self.diverged && !seen.iter().all(is_inside)
    }
}

/// The smallest rectangle around two, which may be empty.
fn union(one: Rectangle, other: Rectangle) -> Rectangle {
    let is_empty = |[_, _, width, height]: Rectangle| width == 0 || height == 0;
    if is_empty(one) || is_empty(other) {
        return if is_empty(one) { other } else { one };
    }
    let [left, top] = [one[0].min(other[0]), one[1].min(other[1])];
    let right = (one[0] + one[2]).max(other[0] + other[2]);
    let bottom = (one[1] + one[3]).max(other[1] + other[3]);
    [left, top, right - left, bottom - top]
}

/// The common part of two rectangles.
fn overlap([x, y, width, height]: Rectangle, [x2, y2, width2, height2]: Rectangle) -> Rectangle {
    let [left, top] = [x.max(x2), y.max(y2)];
    let right = (x + width).min(x2 + width2).max(left);
    let bottom = (y + height).min(y2 + height2).max(top);
    [left, top, right - left, bottom - top]
}

/// The part of a panel that points and the lines between them may cover, with `room` (px) around it.
fn region<'p>(viewport: Rectangle, points: impl Iterator<Item = &'p DVec3>, lens: &Lens, room: f64) -> Rectangle {
    let [left, top, width, height] = viewport;
    let mut low = DVec2::INFINITY;
    let mut high = DVec2::NEG_INFINITY;
    for &point in points {
        match lens.project(point) {
            Some((pixel, _)) => {
                low = low.min(DVec2::from(pixel));
                high = high.max(DVec2::from(pixel));
            }
            // Points behind the camera may appear anywhere.
            None => return viewport,
        }
    }
    let within = |at: f64, start: u32, length: u32| at.clamp(f64::from(start), f64::from(start + length)) as u32;
    if low.x > high.x {
        return [left, top, 0, 0];
    }
    let [x, y] = [within((low.x - room).floor(), left, width), within((low.y - room).floor(), top, height)];
    let [x2, y2] = [within((high.x + room).ceil(), left, width), within((high.y + room).ceil(), top, height)];
    [x, y, x2 - x, y2 - y]
}
