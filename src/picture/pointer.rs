//! Arrows in the direction in which obstacles and grips move.

use super::Mark;
use super::arrows::arrow;
use super::camera::Lens;
use super::layout::{Rectangle, Scale};
use crate::look::Palette;
use glam::{DVec2, DVec3};

/// Length of the arrow of what moves fast, and of the shortest one drawn (px in the reference picture).
const LENGTH: f64 = 74.0;
const SHORTEST: f64 = 11.0;
/// It fades over this part of its length above the shortest.
const FADING: f64 = 0.35;
/// The part of the greatest speed from which on the arrow has its full length.
const FAST: f64 = 0.25;
/// Height of the mark that holds an arrow: its head with room for a halo (px in the reference picture).
const HEIGHT: f64 = 23.0;

/// The motion of something at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Going {
    /// Its velocity (m/s).
    pub(super) velocity: DVec3,
    /// Its greatest speed at any time (m/s).
    pub(super) greatest: f64,
}

/// Draws arrows into one panel.
pub(super) struct Pointers<'a> {
    pub(super) lens: &'a Lens,
    pub(super) viewport: Rectangle,
    pub(super) scale: Scale,
    pub(super) palette: &'a Palette,
}

impl Pointers<'_> {
    /// The arrow of what moves at a point (m), from there on or, with `arriving`, up to there. It grows with the root
    /// of the speed, so that it fades gently; there is none for what rests, and none outside the panel.
    pub(super) fn draw(&self, point: DVec3, going: Going, arriving: bool, gap: f64, marks: &mut Vec<Mark>) {
        let speed = going.velocity.length();
        let share = (speed / (FAST * going.greatest)).min(1.0);
        if !(share > 0.0 && speed.is_finite()) {
            return;
        }
        let Some((from, distance)) = self.lens.project(point) else { return };
        let pixels = if self.lens.orthographic { self.lens.focal } else { self.lens.focal / distance };
        // A way of one pixel, which perspective hardly shortens.
        let way = going.velocity / speed;
        let Some((to, _)) = self.lens.project(point + way / pixels) else { return };
        let step = DVec2::from(to) - DVec2::from(from);
        let unit = self.scale.line();
        // Motion straight towards the viewer has a short arrow.
        let length = LENGTH * unit * share.sqrt() * step.length().min(1.0);
        let Some(along) = step.try_normalize() else { return };
        let grown = (length / (SHORTEST * unit) - 1.0) / FADING;
        let tail = if arriving { -gap * unit - length } else { gap * unit };
        self.mark(DVec2::from(from) + tail * along, length * along, grown, marks);
    }

    /// An arrow, as opaque as it has grown. It fades before it reaches the sides of the panel.
    fn mark(&self, tail: DVec2, way: DVec2, grown: f64, marks: &mut Vec<Mark>) {
        let height = HEIGHT * self.scale.line();
        let [left, top, width, depth] = self.viewport.map(f64::from);
        let inside = |at: DVec2| {
            let sides = [at.x - left, left + width - at.x, at.y - top, top + depth - at.y];
            sides.into_iter().fold(f64::INFINITY, f64::min) / (height / 2.0) - 1.0
        };
        let ends = [tail, tail + way];
        let opacity = grown.min(inside(ends[0])).min(inside(ends[1]));
        let whole = arrow(ends, self.scale.line(), self.palette.pointer, self.palette.halo);
        marks.extend(whole.faded(opacity));
    }
}
