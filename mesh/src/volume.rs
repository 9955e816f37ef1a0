//! Meshes of cells.

use glam::DVec3;
use localshape_sim::{Dimension, IndexLists, Solids};

/// A mesh of cells, which become the elements of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    /// Whether it is in the plane (z = 0) or in space.
    pub dimension: Dimension,
    /// Position of each point, in the unit of the file. Each belongs to a cell.
    pub points: Vec<DVec3>,
    /// The place of each point among all points of the file, rising.
    pub places: Vec<u32>,
    /// How cells of four, five, six and eight points are read: as hulls only if one of them is another polyhedron.
    pub solids: Solids,
    /// The points of each cell, in the order of [`Solids::Ordered`], none turned inside out.
    pub cells: IndexLists,
    /// Sets of points with a name.
    pub groups: Vec<Group>,
    /// The number of cells that were turned over in the file.
    pub turned: usize,
}

/// A set of points with a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// The name in the file.
    pub name: String,
    /// Its points, in ascending order.
    pub points: Vec<u32>,
}
