//! Surfaces of triangles: what is wrong with them, and mending it.

mod enclosed;
mod mending;
mod orienting;
mod refining;

use super::Group;
use super::edges::{EdgeUse, net};
use glam::DVec3;
use localshape_sim::geometry::bounds;

/// A surface of triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Position of each point, in the unit of the file.
    pub points: Vec<DVec3>,
    /// The points of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Sets of points with a name; empty ones, too, whose points are left out.
    pub groups: Vec<Group>,
    /// What is left out of the file or not read, each as the predicate of a sentence about it.
    pub notes: Vec<String>,
}

/// What is wrong with a surface, by number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flaws {
    /// Points at the same place as another but for round-off, which were welded.
    pub welded: usize,
    /// Those of them that are not at exactly the same place.
    pub near: usize,
    /// Triangles without area, or with a corner that has no place, which were left out. Those without area that keep a
    /// surface closed stay.
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

/// The size and form of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measures {
    /// The volume inside, by the divergence theorem. It means little for a surface that is not closed.
    pub volume: f64,
    /// The sum of the areas of triangles.
    pub area: f64,
    /// Whether the surface has an inside and an outside: each edge is passed as often in one direction as in the other.
    pub closed: bool,
    /// Euler's characteristic, points − edges + triangles: 2 for each ball, and 2 less for each hole through it.
    pub euler: i64,
    /// The lowest coordinates.
    pub low: DVec3,
    /// The highest coordinates.
    pub high: DVec3,
}

impl Surface {
    pub(crate) fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|point| self.points[point as usize])
    }

    /// The size and form of the surface. Points that belong to no triangle do not count.
    pub fn measures(&self) -> Measures {
        let mut used = vec![false; self.points.len()];
        for &point in self.triangles.as_flattened() {
            used[point as usize] = true;
        }
        let all = || self.points.iter().zip(&used).filter(|(_, used)| **used).map(|(&point, _)| point);
        let (low, high) = bounds(&all().collect::<Vec<_>>());
        let (mut volume, mut area) = (0.0, 0.0);
        for &triangle in &self.triangles {
            let [a, b, c] = self.corners(triangle).map(|corner| corner - low);
            volume += a.dot(b.cross(c)) / 6.0;
            area += 0.5 * (b - a).cross(c - a).length();
        }
        let uses = EdgeUse::all(&self.triangles);
        let (mut edges, mut closed) = (0, !self.triangles.is_empty());
        for edge in uses.chunk_by(EdgeUse::same) {
            edges += 1;
            closed &= net(edge) == 0;
        }
        Measures { volume, area, closed, euler: all().count() as i64 - edges + self.triangles.len() as i64, low, high }
    }
}
