//! Arrows in the direction of motion of obstacles and grips.

use super::Item;
use super::arrows::arrow;
use super::camera::Lens;
use super::layout::{Rectangle, Scale};
use crate::look::Palette;
use glam::{DVec2, DVec3};

/// Length of the arrow of a fast object, and of the shortest drawn arrow (px in the reference picture).
const LENGTH: f64 = 74.0;
const SHORTEST: f64 = 11.0;
/// Longer arrows fade up to this part of their length above the shortest.
const FADING: f64 = 0.35;
/// From this part of the greatest speed on, the arrow has its full length.
const FAST: f64 = 0.25;
/// Height of the mark of an arrow: its head with room for a halo (px in the reference picture).
const HEIGHT: f64 = 23.0;

/// The motion of an object at one time.
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
    /// The room for arrows.
    pub(super) room: Rectangle,
    pub(super) scale: Scale,
    pub(super) palette: &'a Palette,
}

impl Pointers<'_> {
    /// The arrow of an object at a point (m), from that point or, with `arriving`, to it. It grows with the square root
    /// of the speed, so that it fades gently. A resting object has none, and none begins outside of its room. It is
    /// shorter near the sides of the room.
    pub(super) fn draw(&self, point: DVec3, going: Going, arriving: bool, gap: f64, marks: &mut Vec<Item>) {
        let speed = going.velocity.length();
        let share = (speed / (FAST * going.greatest)).min(1.0);
        if !(share > 0.0 && speed.is_finite()) {
            return;
        }
        let Some((from, distance)) = self.lens.project(point) else { return };
        let pixels = if self.lens.orthographic { self.lens.focal } else { self.lens.focal / distance };
        // A displacement of one pixel, which perspective hardly shortens.
        let way = going.velocity / speed;
        let Some((to, _)) = self.lens.project(point + way / pixels) else { return };
        let step = DVec2::from(to) - DVec2::from(from);
        let unit = self.scale.line();
        // Motion straight towards the viewer has a short arrow.
        let length = LENGTH * unit * share.sqrt() * step.length().min(1.0);
        let Some(along) = step.try_normalize() else { return };
        let near = DVec2::from(from) + if arriving { -gap * unit } else { gap * unit } * along;
        let far = if arriving { -along } else { along };
        let (inside, way) = self.way(near, far);
        let length = length.min(way);
        let ends = [near, near + length * far];
        let ends = if arriving { [ends[1], ends[0]] } else { ends };
        let grown = (length / (SHORTEST * unit) - 1.0) / FADING;
        marks.extend(arrow(ends, unit, self.palette.pointer, self.palette.background).faded(grown.min(inside)));
    }

    /// The opacity of an arrow from a point, which fades near the sides of its room, and the distance in a direction
    /// until it comes near them (px).
    fn way(&self, from: DVec2, along: DVec2) -> (f64, f64) {
        let [left, top, width, depth] = self.room.map(f64::from);
        let sides = [(from.x, along.x, left, left + width), (from.y, along.y, top, top + depth)];
        let height = HEIGHT * self.scale.line();
        let least = |rooms: [f64; 2]| rooms.into_iter().fold(f64::INFINITY, f64::min);
        let inside = least(sides.map(|(at, _, low, high)| (at - low).min(high - at))) / (height / 2.0) - 1.0;
        let rooms = sides.map(|(at, step, low, high)| {
            let room = if step < 0.0 { at - low } else { high - at };
            (room - height) / step.abs()
        });
        (inside, least(rooms))
    }
}
