//! Points and cells as a file lists them.

use crate::Group;
use crate::weld::joined;
use glam::DVec3;
use localshape_sim::{ElementKind, IndexLists};

/// The order in which files list the corners of a hexahedron, around one side and then around the other, as places in the order of
/// [`localshape_sim::Solids::Ordered`]. It is its own inverse.
const AROUND: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];

/// The corners of a hexahedron that a file lists around one side and then around the other, x fastest, then y, then z.
pub(super) fn along(corners: &[u32; 8]) -> [u32; 8] {
    AROUND.map(|place| corners[place])
}

/// The kind of a cell in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CellKind {
    /// One point, or several that are not joined.
    Point,
    /// A line through its points.
    Line,
    /// A triangle, quadrilateral or polygon.
    Polygon,
    /// A tetrahedron.
    Tetrahedron,
    /// A pyramid on a quadrilateral.
    Pyramid,
    /// A wedge between two triangles.
    Wedge,
    /// A hexahedron.
    Hexahedron,
    /// The convex hull of its corners.
    Polyhedron,
}

impl CellKind {
    /// The kind of elements that such cells become.
    pub(super) fn element(self) -> Option<ElementKind> {
        Some(match self {
            Self::Point | Self::Line | Self::Polygon => return None,
            Self::Tetrahedron => ElementKind::Tetrahedron,
            Self::Pyramid => ElementKind::Pyramid,
            Self::Wedge => ElementKind::Wedge,
            Self::Hexahedron => ElementKind::Hexahedron,
            Self::Polyhedron => ElementKind::Other,
        })
    }

    pub(super) fn is_solid(self) -> bool {
        self.element().is_some()
    }

    pub(super) fn is_face(self) -> bool {
        self == Self::Polygon
    }
}

/// Points and cells as a file lists them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cells {
    /// Position of each point, in the unit of the file.
    pub points: Vec<DVec3>,
    /// The kind of each cell.
    pub kinds: Vec<CellKind>,
    /// The points of each cell without those between its corners, in the order of [`Solids::Ordered`](localshape_sim::Solids::Ordered).
    pub corners: IndexLists,
    /// Sets of points with a name, in ascending order.
    pub groups: Vec<Group>,
    /// Velocity of each point, in the unit of the file a second: the point data `velocity` of VTK's grids, in capital letters or not.
    pub velocities: Option<Vec<DVec3>>,
    /// Displacement of each point, in the unit of the file: the point data of VTK's grids named `displacement` or, without a pressure `p`
    /// beside it, `u`, in capital letters or not. They are not added to the points.
    pub displacements: Option<Vec<DVec3>>,
    /// Single points, and the corners of further cells, that are copies of those in other pieces of a parallel run.
    pub copies: IndexLists,
    /// What is left out of the file or not read, each as the predicate of a sentence about it.
    pub notes: Vec<String>,
}

impl Cells {
    /// Makes points nearer than a distance to an earlier one one with it, and returns their number.
    pub fn weld(&mut self, distance: f64) -> usize {
        let first = joined(&self.points, (0..self.points.len() as u32).collect(), distance);
        self.rename(&first);
        self.groups.iter_mut().for_each(|group| *group = group.renamed(&first));
        (0..).zip(&first).filter(|&(point, &first)| point != first).count()
    }

    /// Gives the corners of all cells other indices.
    pub(super) fn rename(&mut self, new: &[u32]) {
        let renamed: Vec<u32> = self.corners.indices().iter().map(|&corner| new[corner as usize]).collect();
        self.corners = (0..self.corners.len()).map(|at| &renamed[self.corners.range(at)]).collect();
    }

    pub(super) fn has(&self, wanted: fn(CellKind) -> bool) -> bool {
        self.kinds.iter().any(|&kind| wanted(kind))
    }

    /// The cells that a predicate selects, with their number in the file.
    pub(super) fn chosen(&self, wanted: impl Fn(CellKind) -> bool) -> impl Iterator<Item = (usize, CellKind, &[u32])> {
        let all = self.kinds.iter().zip(self.corners.iter()).enumerate();
        all.filter(move |&(_, (&kind, _))| wanted(kind)).map(|(at, (&kind, corners))| (at, kind, corners))
    }
}
