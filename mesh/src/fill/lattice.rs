//! The lattice of cubes about a surface.

use super::FillError;
use crate::{Measures, Surface};
use glam::DVec3;

/// Points nearer than this to a plane of the lattice, in units of its side, are moved onto it. Single precision and typed
/// decimals would otherwise leave layers of cells with hardly any filling.
pub(super) const SNAP: f64 = 4e-6;

/// The number of cubes along each axis about a surface.
pub(super) fn counts(measures: &Measures, side: f64) -> [f64; 3] {
    (measures.high - measures.low).to_array().map(|extent| (extent / side - SNAP).ceil().max(1.0))
}

/// Cubes of a lattice about a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lattice {
    /// The lowest corner.
    pub(super) origin: DVec3,
    /// The side of a cube.
    pub(super) side: f64,
    /// The number of cubes along each axis.
    pub(super) counts: [usize; 3],
}

impl Lattice {
    /// The lowest corner of a lattice about the middle of a surface's box.
    pub(super) fn origin(measures: &Measures, side: f64) -> DVec3 {
        let size = DVec3::from_array(counts(measures, side));
        0.5 * (measures.low + measures.high) - 0.5 * side * size
    }

    /// The cubes about a surface that is checked, and the surface in units of them from their lowest corner. Points that are almost on a
    /// plane of the lattice are on it in both. The lattice is about the middle of the surface, or has a given corner.
    ///
    /// # Errors
    /// If its triangles lie over each other by thousands.
    pub(super) fn about(
        surface: &mut Surface,
        side: f64,
        corner: Option<DVec3>,
        most: usize,
    ) -> Result<(Self, Surface), FillError> {
        let measures = surface.measures();
        let (mut origin, mut size) = (Self::origin(&measures, side), DVec3::from_array(counts(&measures, side)));
        if let Some(corner) = corner {
            let first = ((measures.low - corner) / side + SNAP).floor();
            size = (((measures.high - corner) / side - SNAP).ceil() - first).max(DVec3::ONE);
            origin = corner + side * first;
        }
        // Triangles that lie over each other by thousands are no surface.
        let overlaps: f64 = surface.triangles.iter().map(|&triangle| pieces(surface.corners(triangle), side)).sum();
        if overlaps > 64.0 * most as f64 + 16.0 * surface.triangles.len() as f64 + 1e6 {
            let message = format!(
                "has {} triangles that lie over each other: they reach into elements of side {side} some {overlaps:.0} times",
                surface.triangles.len()
            );
            return Err(FillError::new(message, format!("use a larger side, or more than {most} elements")));
        }
        let counts = size.to_array().map(|count| count as usize);
        let lattice = Self { origin, side, counts };
        let mut points = Vec::with_capacity(surface.points.len());
        for point in &mut surface.points {
            let at = (*point - lattice.origin) / side;
            let near = at.round();
            let is_near = (at - near).abs().cmple(DVec3::splat(SNAP));
            *point = DVec3::select(is_near, lattice.place(near), *point);
            points.push(DVec3::select(is_near, near, at).clamp(DVec3::ZERO, size));
        }
        Ok((lattice, Surface { points, triangles: surface.triangles.clone(), ..Surface::default() }))
    }

    /// The place of a point in units of the lattice.
    pub(super) fn place(&self, at: DVec3) -> DVec3 {
        self.origin + self.side * at
    }
}

/// About how many cubes a triangle reaches into, or more.
fn pieces([a, b, c]: [DVec3; 3], side: f64) -> f64 {
    let [x, y, z] = ((a.max(b).max(c) - a.min(b).min(c)) / side).to_array();
    1.0 + x + y + z + 0.5 * (x * y + y * z + z * x)
}

/// The cube of each place, in units of the lattice.
pub(super) type Cell = [u32; 3];

impl Lattice {
    /// A number for each cube, with x fastest, then y, then z.
    pub(super) fn key(&self, [x, y, z]: Cell) -> u64 {
        (u64::from(z) * self.counts[1] as u64 + u64::from(y)) * self.counts[0] as u64 + u64::from(x)
    }

    /// The cube with a number.
    pub(super) fn cell(&self, key: u64) -> Cell {
        let [x, y] = [self.counts[0] as u64, self.counts[1] as u64];
        [(key % x) as u32, (key / x % y) as u32, (key / x / y) as u32]
    }
}

/// The lowest corner of a cell.
pub(super) fn corner(cell: Cell) -> DVec3 {
    DVec3::from_array(cell.map(f64::from))
}

/// The corners of a cube, with x fastest, then y, then z.
pub(super) const CORNERS: [Cell; 8] =
    [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1]];

/// A cell with a part of the inside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Full {
    pub(super) cell: u64,
    /// The part of it that is inside.
    pub(super) filled: f64,
}
