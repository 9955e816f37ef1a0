//! Obstacles that leave their panel fade instead of being cut off.

use super::draft::{Draft, PixelBox};
use crate::picture::Fading;
use crate::picture::layout::steps::NEAR;
use crate::picture::narrow::narrow;
use crate::picture::plane::sides;
use glam::DVec3;

/// Solid obstacles fade over this part of the width and of the height. It is long enough for thick rods not to look
/// cut, and short enough to keep most of the picture.
const FADE: [f64; 2] = [0.11, 0.13];

impl Draft<'_> {
    /// The fading of obstacles with some corners (m) where they leave the part of the panel between its words and half of
    /// its margins. They fade less where they hardly leave it, so that nothing changes suddenly.
    pub(super) fn fading(&self, solids: &[Vec<DVec3>]) -> Option<Fading> {
        let has_words = self.scene.view.labels.are_in_panels();
        let room = if has_words { self.room } else { self.viewport };
        let [left, top, right, bottom] = sides(room.map(f64::from));
        let beside = 0.5 * self.scale.margin();
        let [left, right] = [left + beside, right - beside];
        let mut over = [0.0_f64; 4];
        for solid in solids {
            let [low, high] = PixelBox::new(&self.lens, solid).corners;
            if low.x < right && high.x > left && low.y < bottom && high.y > top {
                let beyond = [left - low.x, top - low.y, high.x - right, high.y - bottom];
                over.iter_mut().zip(beyond).for_each(|(over, beyond)| *over = over.max(beyond));
            }
        }
        let strength = over.map(|over| narrow((over / (NEAR * self.scale.unit)).min(1.0)));
        let distance = [FADE[0] * (right - left), FADE[1] * (bottom - top)].map(narrow);
        let room = [left, top, right, bottom].map(narrow);
        strength.iter().any(|&strength| strength > 0.0).then_some(Fading { room, distance, strength })
    }

    /// A point of the panel (m).
    pub(super) fn place(&self, at: [f32; 3]) -> DVec3 {
        self.origin + self.side * DVec3::from(at.map(f64::from))
    }
}
