//! Obstacles. In space spheres, capsules and boxes are lit solids; plates and all floors but the ground are transparent
//! slabs, so that bodies stay visible behind them. In the plane all are polygons.

mod half_space;
mod near;
mod occluder;
mod plane;
mod shapes;
mod slab;
mod solid;
mod space;

pub(super) use half_space::{HalfSpace, half_space};
pub(super) use space::Staging;

use super::camera::Lens;
use super::narrow::narrow_point;
use super::pointer::Going;
use crate::look::Palette;
use crate::sim::Obstacle;
use glam::DVec3;

/// The obstacles of one panel, and the panel's data for drawing them.
pub(super) struct Site<'a> {
    pub(super) obstacles: &'a [Obstacle],
    /// The time of the panel's state (s).
    pub(super) time: f64,
    /// The time between two frames (s).
    pub(super) frame: f64,
    pub(super) lens: &'a Lens,
    /// The panel's origin (m).
    pub(super) origin: DVec3,
    /// The panel's unit of length (m).
    pub(super) side: f64,
    /// The size of the body (m).
    pub(super) extent: f64,
    pub(super) palette: &'a Palette,
}

impl Site<'_> {
    /// A point in the panel's coordinates.
    fn relative(&self, point: DVec3) -> [f32; 3] {
        narrow_point((point - self.origin) / self.side).to_array()
    }

    /// The motion of an obstacle at one of its points (m), and its greatest speed within about `reach` (m) of its
    /// pivot.
    fn going(&self, obstacle: &Obstacle, point: DVec3, reach: f64) -> Going {
        let pivot = obstacle.pivot;
        let own = obstacle.pose(self.time).undo(pivot, point);
        let half = 0.25 * self.frame;
        let [before, after] = [self.time - half, self.time + half].map(|time| obstacle.pose(time).apply(pivot, own));
        Going { velocity: (after - before) / (2.0 * half), greatest: obstacle.motion.greatest_speed(reach) }
    }
}

/// Points and triangles of solid obstacles for other parts of the picture.
#[derive(Debug, Default)]
pub(super) struct Staged {
    /// Points around them (m), for the part of the panel that they may cover.
    pub(super) outermost: Vec<DVec3>,
    /// Shadow casters: corners (m) and triangles.
    pub(super) shadow_points: Vec<DVec3>,
    pub(super) shadow_triangles: Vec<[u32; 3]>,
}

impl Staged {
    /// Adds a shadow caster.
    fn add(&mut self, points: &[DVec3], triangles: &[[u32; 3]]) {
        let base = self.shadow_points.len() as u32;
        self.shadow_points.extend(points);
        self.shadow_triangles.extend(triangles.iter().map(|triangle| triangle.map(|at| base + at)));
    }
}
