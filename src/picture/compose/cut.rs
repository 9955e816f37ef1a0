//! Obstacles that leave their panel fade instead of being cut off.

use super::draft::{Draft, PixelBox};
use super::plane_body::path_of;
use super::plane_marks::soft;
use crate::picture::layout::Rectangle;
use crate::picture::layout::steps::NEAR;
use crate::picture::narrow::narrow;
use crate::picture::page::point;
use crate::picture::plane::sides;
use crate::picture::{Fading, Item};
use glam::{DVec2, DVec3};

/// Solid obstacles fade over this part of the width and of the height. It is long enough for thick rods not to look
/// cut, and short enough to keep most of the picture.
const FADE: [f64; 2] = [0.11, 0.13];

impl Draft<'_> {
    /// The fading of obstacles with some corners (m) where they leave the part of the panel between its words and half of
    /// its margins. They fade less where they hardly leave it, so that nothing changes suddenly.
    pub(super) fn fading(&self, solids: &[Vec<DVec3>]) -> Option<Fading> {
        let has_words = self.scene.view.labels.are_in_panels();
        let room = if has_words { self.between_words() } else { self.viewport };
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

    /// Covers obstacles with some outlines (m) at the sides of a part of the picture that they leave.
    pub(super) fn cover(&self, solids: &[Vec<DVec3>], region: Rectangle) -> Option<Item> {
        let Fading { distance, strength, .. } = self.fading(solids)?;
        let [left, top, right, bottom] = sides(region.map(f64::from));
        let size = DVec2::new(right - left, bottom - top);
        let cover = |side: usize| {
            let corner = [[left, top], [left, top], [right, top], [left, bottom]][side].into();
            let inwards = [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y][side] * f64::from(distance[side % 2]);
            let along = size * if side.is_multiple_of(2) { DVec2::Y } else { DVec2::X };
            let opacity = |share: f32| strength[side] * (1.0 - share * share * (3.0 - 2.0 * share));
            soft([corner, along, inwards], 1, self.palette.background, |_, share| opacity(share))
        };
        let items = (0..4).filter(|&side| strength[side] > 0.0).map(cover).collect();
        let pixels = |solid: &Vec<DVec3>| solid.iter().filter_map(|&at| self.pixel(at).map(point)).collect();
        Some(Item::Clip { path: path_of(solids.iter().map(pixels)), items })
    }

    /// A point of the panel (m).
    pub(super) fn place(&self, at: [f32; 3]) -> DVec3 {
        self.origin + self.side * DVec3::from(at.map(f64::from))
    }
}
