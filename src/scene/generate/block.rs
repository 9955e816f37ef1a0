//! The cells of a block and their nodes.

use crate::scene::file::{Lattice, SideFile};
use glam::DVec3;

/// The cells of a block and the nodes at their corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    /// Cells along x, y and z; 0 along z in the plane.
    pub(super) cells: [u32; 3],
    /// Sides of a cell (m).
    pub(super) sides: DVec3,
}

impl Block {
    pub(super) fn new(typed: &Lattice) -> Self {
        let axis = |axis: usize| match &typed.side {
            SideFile::Equal(side) => *side,
            SideFile::PerAxis(sides) => sides.get(axis).map_or(1.0, |side| side.0),
        };
        let cells = std::array::from_fn(|axis| typed.cells.get(axis).copied().unwrap_or(0));
        Self { cells, sides: DVec3::new(axis(0), axis(1), axis(2)) }
    }

    /// Whether the block is in the plane.
    pub(super) fn is_flat(&self) -> bool {
        self.cells[2] == 0
    }

    /// The number of nodes.
    pub(super) fn len(&self) -> u64 {
        self.cells.iter().fold(1, |all: u64, &cells| all.saturating_mul(u64::from(cells) + 1))
    }

    /// The node at the low corner of a cell: x fastest, then y, then z.
    pub(super) fn node(&self, [x, y, z]: [u32; 3]) -> u32 {
        let [nx, ny, _] = self.cells;
        x + (nx + 1) * (y + (ny + 1) * z)
    }

    /// The nodes of a cell, in bit order in space.
    pub(super) fn corners(&self, cell: [u32; 3]) -> [u32; 8] {
        let first = self.node(cell);
        let [row, layer] = [self.node([0, 1, 0]), self.node([0, 0, 1])];
        [0, 1, 2, 3, 4, 5, 6, 7].map(|bits: u32| first + (bits & 1) + row * (bits >> 1 & 1) + layer * (bits >> 2))
    }

    /// The nodes of a square, counter-clockwise.
    pub(super) fn square(&self, cell: [u32; 3]) -> [u32; 4] {
        let [a, b, d, c, ..] = self.corners(cell);
        [a, b, c, d]
    }

    /// All cells: x fastest, then y, then z.
    pub(super) fn each_cell(&self) -> impl Iterator<Item = [u32; 3]> {
        let [nx, ny, nz] = self.cells;
        (0..nz.max(1)).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])))
    }

    /// Positions of all nodes (m): the block stands on y = 0, its middle over the origin.
    pub(super) fn nodes(&self) -> Vec<DVec3> {
        let [nx, ny, nz] = self.cells;
        let mut nodes = Vec::with_capacity(self.len() as usize);
        let centred = |at: u32, cells: u32, side: f64| (f64::from(at) - 0.5 * f64::from(cells)) * side;
        for z in 0..=nz {
            for y in 0..=ny {
                let (height, depth) = (f64::from(y) * self.sides.y, centred(z, nz, self.sides.z));
                nodes.extend((0..=nx).map(|x| DVec3::new(centred(x, nx, self.sides.x), height, depth)));
            }
        }
        nodes
    }
}
