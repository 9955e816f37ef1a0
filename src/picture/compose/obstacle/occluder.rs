//! The obstacles that occlude the ambient light of a body near them.

use super::half_space::half_space;
use super::near::REACH;
use super::space::Staging;
use crate::picture::narrow::{narrow, narrow_point};
use crate::picture::{MOST_OCCLUDERS, Occluder};
use crate::sim::{Obstacle, Shape};
use glam::{DQuat, DVec3};

/// Radius of the edges of boxes, and half the sides of the box of a half-space (soft units).
const ROUND: f64 = 0.1;
const LARGE: f64 = 1e3;

impl Staging<'_> {
    /// The obstacles near the body but the ground, the nearest first.
    pub(super) fn occluders(&self) -> Vec<Occluder> {
        let Some(skin) = self.skin else { return Vec::new() };
        let nodes = || skin.nodes.iter().filter_map(|&node| self.draft.position.get(node as usize));
        let middle = nodes().sum::<DVec3>() / nodes().count().max(1) as f64;
        let size = nodes().map(|at| at.distance(middle)).fold(0.0, f64::max);
        let time = self.time();
        let mut near: Vec<_> = self
            .draft
            .scene
            .obstacles
            .iter()
            .filter(|obstacle| self.ground.is_none() || obstacle.floor(time) != self.ground)
            .map(|obstacle| (height(&obstacle.shape, obstacle.pose(time).undo(obstacle.pivot, middle)), obstacle))
            .filter(|(distance, _)| *distance < size + REACH * self.soft())
            .collect();
        near.sort_by(|one, other| one.0.total_cmp(&other.0));
        near.into_iter().take(MOST_OCCLUDERS).map(|(_, obstacle)| self.occluder(obstacle)).collect()
    }

    fn occluder(&self, obstacle: &Obstacle) -> Occluder {
        let pose = obstacle.pose(self.time());
        let place = |point: DVec3| pose.apply(obstacle.pivot, point);
        // With rounded edges the direction out of the box is also defined just inside.
        let round = |half: DVec3| half.min_element().min(ROUND * self.soft());
        let (centre, half, turn, radius) = match obstacle.shape {
            Shape::Floor { .. } | Shape::Plate { .. } => {
                let (normal, height) = half_space(obstacle, self.time()).unwrap_or((DVec3::Y, 0.0));
                let foot = self.draft.origin + (height - normal.dot(self.draft.origin)) * normal;
                let half = DVec3::splat(LARGE * self.soft());
                (foot - half.x * normal, half - round(half), DQuat::from_rotation_arc(DVec3::Y, normal), round(half))
            }
            Shape::Sphere { centre, radius } => (place(centre), DVec3::ZERO, DQuat::IDENTITY, radius),
            Shape::Capsule { from, to, radius } => {
                let [from, to] = [from, to].map(place);
                let axis = (to - from).try_normalize().unwrap_or(DVec3::Y);
                let half = 0.5 * from.distance(to) * DVec3::Y;
                (from.midpoint(to), half, DQuat::from_rotation_arc(DVec3::Y, axis), radius)
            }
            Shape::Box { centre, half, rotation } => {
                (place(centre), half - round(half), pose.rotation * rotation, round(half))
            }
        };
        Occluder {
            centre: narrow_point((centre - self.draft.origin) / self.draft.side),
            half: narrow_point(half / self.draft.side),
            rotation: turn.to_array().map(narrow),
            radius: narrow(radius / self.draft.side),
            is_clear: obstacle.shape.is_half_space(),
        }
    }
}

/// The distance of a point from a solid shape before it moves (m); negative inside.
fn height(shape: &Shape, point: DVec3) -> f64 {
    match *shape {
        Shape::Floor { normal, height } => normal.dot(point) - height,
        Shape::Plate { point: surface, normal } => normal.dot(point - surface),
        Shape::Sphere { centre, radius } => point.distance(centre) - radius,
        Shape::Capsule { from, to, radius } => {
            let along = to - from;
            let squared = along.length_squared();
            let share = if squared > 0.0 { ((point - from).dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
            point.distance(from + share * along) - radius
        }
        Shape::Box { centre, half, rotation } => {
            let beyond = (rotation.conjugate() * (point - centre)).abs() - half;
            beyond.max(DVec3::ZERO).length() + beyond.max_element().min(0.0)
        }
    }
}
