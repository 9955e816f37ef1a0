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

use crate::picture::{Line, Solid};
use glam::DVec3;

/// Solid obstacles, with points and triangles of them for other parts of the picture.
#[derive(Debug, Default)]
pub(super) struct Staged {
    solids: Vec<Solid>,
    /// Their edges and contours.
    pub(super) lines: Vec<Line>,
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
