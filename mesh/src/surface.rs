//! Surfaces of triangles.

use glam::DVec3;

/// A surface of triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Position of each point, in the unit of the file.
    pub points: Vec<DVec3>,
    /// The points of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// What is wrong with a surface, by number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flaws {
    /// Points at the same place as another, which were welded.
    pub welded: usize,
    /// Triangles without area, which were left out.
    pub degenerate: usize,
    /// Triangles with the points of another, which were left out.
    pub doubled: usize,
    /// Triangles that were turned over, so that all of a piece look out.
    pub turned: usize,
    /// Edges of one triangle only.
    pub boundary: usize,
    /// Edges of three triangles or more.
    pub non_manifold: usize,
    /// Edges whose two triangles cannot both look out.
    pub inconsistent: usize,
    /// Separate pieces.
    pub pieces: usize,
}
