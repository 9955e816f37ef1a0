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
    /// Sets of points with a name; empty ones, too, whose points are left out.
    pub groups: Vec<Group>,
    /// The number of cells that were turned over in the file.
    pub turned: usize,
    /// What is left out of the file or not read, each as the predicate of a sentence about it.
    pub notes: Vec<String>,
}

/// A set of points with a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// The name in the file.
    pub name: String,
    /// Its points, in ascending order.
    pub points: Vec<u32>,
}

impl Group {
    /// A set of points among so many, each once.
    pub(crate) fn new(name: String, mut points: Vec<u32>, count: usize) -> Self {
        // Marks, 64 in a word, are faster than sorting if they do not stand far apart.
        if points.len() > count / 64 {
            let mut marks = vec![0u64; count.div_ceil(64)];
            points.iter().for_each(|&point| marks[point as usize / 64] |= 1 << (point % 64));
            points.clear();
            for (word, mut marks) in (0..).zip(marks) {
                while marks != 0 {
                    points.push(64 * word + marks.trailing_zeros());
                    marks &= marks - 1;
                }
            }
        } else {
            points.sort_unstable();
            points.dedup();
        }
        Self { name, points }
    }

    /// The group with other indices of its points, some of which may be equal.
    pub(crate) fn renamed(&self, new: &[u32]) -> Self {
        Self::new(self.name.clone(), self.points.iter().map(|&point| new[point as usize]).collect(), new.len())
    }
}
