//! Obstacles that leave their panel fade instead of being cut off.

use super::draft::Draft;
use crate::picture::fade::FADING;
use crate::picture::narrow::narrow;
use crate::picture::plane::sides;
use crate::picture::{Fading, Item, Obstacles, Solid};
use glam::{DVec2, DVec3};

/// The margin around the body, which does not fade (px in the reference picture).
const AROUND_BODY: f64 = 4.0;
/// Obstacles that extend by less than the first length do not fade; obstacles that extend by more than the second one fade
/// fully (px in the reference picture).
const BEGINS: [f64; 2] = [0.5, 8.0];
/// Room for the lines of an obstacle (px in the reference picture).
const LINE_ROOM: f64 = 3.0;

/// Solid obstacles fade over this part of the width and of the height. It is long enough for thick rods not to look
/// cut, and short enough to keep most of the picture.
const FADE: [f64; 2] = [0.11, 0.13];

/// The part of obstacles beyond one side.
#[derive(Clone, Copy)]
struct Beyond {
    /// The strength of its fading, from 0 to 1.
    strength: f64,
    /// Its ends along the side (px).
    along: [f64; 2],
}

impl Draft<'_> {
    /// The fading of solid obstacles with some corners (m) where they leave the part of the panel between its words and
    /// half of its margins. They fade less where they hardly leave it, so that nothing changes suddenly.
    pub(super) fn fading<P: Iterator<Item = DVec3>>(&self, solids: impl Iterator<Item = P>) -> Option<Fading> {
        let has_words = self.scene.view.labels.are_in_panels();
        let room = if has_words { self.between_words() } else { self.viewport };
        let [left, top, right, bottom] = sides(room.map(f64::from));
        let beside = 0.5 * self.scale.margin();
        let room = [left + beside, top, right - beside, bottom];
        let solids = solids.filter_map(|points| self.bounds(points));
        let strength = self.beyond(room, solids).map(|part| part.map_or(0.0, |part| part.strength));
        let fades = strength.iter().any(|&strength| strength > 0.0);
        let distance = [FADE[0] * (room[2] - room[0]), FADE[1] * (room[3] - room[1])].map(narrow);
        fades.then(|| Fading { room: room.map(narrow), distance, strength: strength.map(narrow) })
    }

    /// A point of the panel (m).
    pub(super) fn place(&self, at: [f32; 3]) -> DVec3 {
        self.origin + self.side * DVec3::from(at.map(f64::from))
    }

    /// Lets solid obstacles in space fade. At the sides where plates leave the panel, covers everything but the body with
    /// the background, less towards the middle.
    pub(super) fn fade_obstacles(&self, obstacles: &mut Obstacles, marks: &mut Vec<Item>) {
        let corners = |solid: &Solid| solid.mesh.vertices.iter().map(|vertex| self.place(vertex.position)).collect();
        let solids = obstacles.solids.iter().map(corners).map(Vec::into_iter);
        obstacles.fade = self.fading(solids);
        // Plates extend behind words, too; walls have a fading of their own.
        let plates = obstacles.panes.iter().filter(|pane| !pane.grid).filter_map(|pane| {
            let corners = || pane.corners.iter().map(|corner| self.place(corner.position));
            // An obstacle that extends behind the camera leaves on all sides.
            let is_before = corners().all(|corner| self.lens.project(corner).is_some());
            if is_before { self.bounds(corners()) } else { Some([DVec2::NEG_INFINITY, DVec2::INFINITY]) }
        });
        self.cover_plates(sides(self.viewport.map(f64::from)), plates, marks);
    }

    /// Covers the sides of a room (px: left, top, right and bottom) that plates in boxes (px) leave.
    fn cover_plates(
        &self,
        [left, top, right, bottom]: [f64; 4],
        boxes: impl Iterator<Item = [DVec2; 2]>,
        marks: &mut Vec<Item>,
    ) {
        let parts = self.beyond([left, top, right, bottom], boxes);
        if parts.iter().all(Option::is_none) {
            return;
        }
        let distance = FADING * self.scale.unit;
        let around = AROUND_BODY * self.scale.line();
        let body = self.bounds(self.position.iter().copied()).unwrap_or_default();
        let body = [body[0].x - around, body[0].y - around, body[1].x + around, body[1].y + around];
        for (side, part) in parts.into_iter().enumerate() {
            let Some(Beyond { strength, along: [first, last] }) = part else { continue };
            // The box of the body, across and along the side.
            let ([from, to], [begin, end]) = match side % 2 {
                0 => ([body[0], body[2]], [body[1], body[3]]),
                _ => ([body[1], body[3]], [body[0], body[2]]),
            };
            for at in 0..distance.ceil() as u32 {
                let depth = f64::from(at);
                let share = ((depth + 0.5) / distance).min(1.0);
                let cover = strength * (1.0 - share * share * (3.0 - 2.0 * share));
                let across = [left + depth, top + depth, right - depth - 1.0, bottom - depth - 1.0][side];
                let is_beside = across + 1.0 > from && across < to;
                let [begin, end] =
                    if is_beside { [begin, end].map(|at| at.clamp(first, last).round()) } else { [last; 2] };
                for [start, stop] in [[first, begin], [end, last]].into_iter().filter(|[start, stop]| stop > start) {
                    let rectangle = match side % 2 {
                        0 => [across, start, 1.0, stop - start],
                        _ => [start, across, stop - start, 1.0],
                    };
                    let mark = Item::rectangle(rectangle, self.composer.palette.background);
                    marks.extend(mark.faded(cover));
                }
            }
        }
    }

    /// The parts of visible obstacles in boxes (px) beyond each side of a room. The fading spans all obstacles that
    /// reach into it, so that none is cut at its end.
    fn beyond(
        &self,
        [left, top, right, bottom]: [f64; 4],
        boxes: impl Iterator<Item = [DVec2; 2]>,
    ) -> [Option<Beyond>; 4] {
        let [first, full] = BEGINS.map(|distance| distance * self.scale.unit);
        let distance = FADING * self.scale.unit;
        let free = LINE_ROOM * self.scale.line();
        let is_seen = |[low, high]: &[DVec2; 2]| low.x < right && high.x > left && low.y < bottom && high.y > top;
        let over = |[low, high]: &[DVec2; 2]| [left - low.x, top - low.y, high.x - right, high.y - bottom];
        let boxes: Vec<_> = boxes.filter(is_seen).collect();
        [0, 1, 2, 3].map(|side: usize| {
            let farthest = boxes.iter().map(|one| over(one)[side]).fold(0.0, f64::max);
            let strength = ((farthest - first) / (full - first)).clamp(0.0, 1.0);
            let along = |[low, high]: &[DVec2; 2]| match side % 2 {
                0 => [(low.y - free).max(top), (high.y + free).min(bottom)],
                _ => [(low.x - free).max(left), (high.x + free).min(right)],
            };
            let reaching = boxes.iter().filter(|one| over(one)[side] > -distance).map(along);
            let along = reaching.reduce(|one, other| [one[0].min(other[0]), one[1].max(other[1])])?;
            (strength > 0.0).then_some(Beyond { strength, along: [along[0].floor(), along[1].ceil()] })
        })
    }

    /// The corners of the box around points (m) in the picture (px); `None` if none is before the camera.
    fn bounds(&self, points: impl Iterator<Item = DVec3>) -> Option<[DVec2; 2]> {
        let seen = points.filter_map(|at| self.lens.project(at)).map(|(pixel, _)| DVec2::from(pixel));
        seen.fold(None, |known: Option<[DVec2; 2]>, at| {
            Some(known.map_or([at; 2], |[low, high]| [low.min(at), high.max(at)]))
        })
    }
}
