//! The types of elements of Gmsh.

use crate::read::CellKind;

/// A type of elements.
#[derive(Clone, Copy)]
pub(in crate::read) struct Kind {
    pub(in crate::read) cell: CellKind,
    pub(in crate::read) dimension: i64,
    /// The number of its corners, which are the first of its nodes.
    pub(in crate::read) corners: usize,
    pub(in crate::read) nodes: usize,
}

impl Kind {
    /// The type of a number in Gmsh.
    pub(in crate::read) fn of(number: i64) -> Option<Self> {
        use CellKind::{Hexahedron, Line, Point, Polygon, Pyramid, Tetrahedron, Wedge};
        const NODES: [usize; 31] = [
            2, 3, 4, 4, 8, 6, 5, 3, 6, 9, 10, 27, 18, 14, 1, 8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5, 6, 20, 35, 56,
        ];
        let (cell, dimension, corners) = match number {
            15 => (Point, 0, 1),
            1 | 8 | 26..=28 => (Line, 1, 2),
            2 | 9 | 20..=25 => (Polygon, 2, 3),
            3 | 10 | 16 | 36..=38 => (Polygon, 2, 4),
            4 | 11 | 29..=31 => (Tetrahedron, 3, 4),
            5 | 12 | 17 | 92 | 93 => (Hexahedron, 3, 8),
            6 | 13 | 18 | 90 | 91 => (Wedge, 3, 6),
            7 | 14 | 19 | 118 => (Pyramid, 3, 5),
            _ => return None,
        };
        let nodes = match number {
            36..=38 => [16, 25, 36][number as usize - 36],
            90..=93 => [40, 75, 64, 125][number as usize - 90],
            118 => 30,
            _ => NODES[number as usize - 1],
        };
        Some(Self { cell, dimension, corners, nodes })
    }

    /// The type of first or second order with these numbers.
    pub(in crate::read) fn with(dimension: i64, nodes: usize) -> Option<Self> {
        (1..20).filter_map(Self::of).find(|kind| (kind.dimension, kind.nodes) == (dimension, nodes))
    }
}
