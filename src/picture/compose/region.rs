//! The part of a panel that the body and its lines may cover.

use super::draft::{Draft, PixelBox};
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
        let region = |of: &PixelBox| region(self.viewport, of, room);
        let [nodes, around] =
            [&self.position[..], around_obstacles].map(|points| region(&PixelBox::new(&self.lens, points)));
        let carried = &self.boxes()[self.bodies.parts.len() - self.bodies.skin.fine.len()..];
        let body = carried.iter().map(region).fold(nodes, union);
        // Obstacles are drawn below the rows of words, if there are any.
        let has_words = self.scene.view.labels.are_in_panels();
        let region = union(body, if has_words { overlap(around, self.room) } else { around });
        // Everything ends at the panel's words. A diverged body may cover the whole panel, and the words report it.
        if self.diverged { overlap(region, self.clear) } else { region }
    }

    /// Whether the body leaves the panel, if the camera does not follow it.
    pub(super) fn is_cut(&self) -> bool {
        let [left, top, width, height] = self.viewport.map(f64::from);
        let is_inside = |PixelBox { corners: [low, high], is_ahead }: &PixelBox| {
            let is_empty = low.x > high.x;
            let [from, to] = [DVec2::new(left, top), DVec2::new(left + width, top + height)];
            *is_ahead && (is_empty || (low.cmpge(from).all() && high.cmple(to).all()))
        };
        if self.framing.moves || self.diverged {
            return false;
        }
        // The elements that carry a surface are not seen.
        match self.carried().is_empty() {
            true => !is_inside(&PixelBox::new(&self.lens, &*self.whole())),
            false => !self.boxes().iter().all(is_inside),
        }
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

/// The part of a panel that points in a box and the lines between them may cover, with `room` (px) around it.
fn region(viewport: Rectangle, of: &PixelBox, room: f64) -> Rectangle {
    let ([left, top, width, height], [low, high]) = (viewport, of.corners);
    // Points behind the camera may appear anywhere.
    if !of.is_ahead {
        return viewport;
    }
    let within = |at: f64, start: u32, length: u32| at.clamp(f64::from(start), f64::from(start + length)) as u32;
    if low.x > high.x {
        return [left, top, 0, 0];
    }
    let [x, y] = [within((low.x - room).floor(), left, width), within((low.y - room).floor(), top, height)];
    let [x2, y2] = [within((high.x + room).ceil(), left, width), within((high.y + room).ceil(), top, height)];
    [x, y, x2 - x, y2 - y]
}
