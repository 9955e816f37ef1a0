//! Arrows in the direction of motion of obstacles and grips.

use super::draft::Draft;
use crate::picture::Item;
use crate::picture::arrows::{arrow, inside};
use crate::picture::layout::Rectangle;
use crate::picture::layout::steps::{BESIDE, ROOM};
use glam::{DVec2, DVec3};

/// From this part of the greatest speed on, the arrow has its full length.
const FAST: f64 = 0.25;

impl Draft<'_> {
    /// The arrow of an object at a point (m) with a velocity and a greatest speed at any time (m/s), from that point or,
    /// with `arriving`, to it, at a distance (px in the reference picture). It grows with the square root of the speed, so that it fades gently, and ends where its
    /// `room` ends. A resting object has none.
    pub(super) fn pointer(
        &self,
        (point, velocity, greatest): (DVec3, DVec3, f64),
        arriving: bool,
        gap: f64,
        room: Rectangle,
    ) -> Option<Item> {
        let speed = velocity.length();
        let share = (speed / (FAST * greatest)).min(1.0);
        if !(share > 0.0 && speed.is_finite()) {
            return None;
        }
        let (from, distance) = self.lens.project(point)?;
        let pixels = if self.lens.orthographic { self.lens.focal } else { self.lens.focal / distance };
        // A displacement of one pixel, which perspective hardly shortens.
        let way = velocity / speed;
        let (to, _) = self.lens.project(point + way / pixels)?;
        let [from, to] = [from, to].map(DVec2::from);
        let (unit, palette) = (self.scale.line(), &self.composer.palette);
        // Motion straight towards the viewer has a short arrow.
        let length = ROOM * unit * share.sqrt() * from.distance(to).min(1.0);
        let along = (to - from).normalize_or_zero();
        let gap = gap * unit;
        let ends = if arriving { [-gap - length, -gap] } else { [gap, gap + length] };
        let ends = ends.map(|at| from + at * along);
        let (ends, opacity) = inside(ends, room, unit, BESIDE * unit)?;
        arrow(ends, unit, palette.pointer, palette.background).faded(opacity)
    }
}
