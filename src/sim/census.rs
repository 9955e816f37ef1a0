//! How large a body will be, counted before anything is allocated for it.

use super::topology::{self, Dimension, ElementKind, Solids};
use std::collections::BTreeMap;

/// The sizes of a body that is not made yet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Census {
    /// In the plane or in space.
    pub dimension: Dimension,
    /// Nodes.
    pub nodes: u128,
    /// What elements of some numbers of nodes are.
    pub solids: Solids,
    /// How many elements there are of each number of nodes.
    pub elements: BTreeMap<usize, u128>,
    /// Whether the elements are the cells of one block, so that each node has few neighbours.
    pub lattice: bool,
    /// Springs listed by hand.
    pub springs: Option<u128>,
}

impl Census {
    /// A block of cells, of any size: cubes along three axes, squares along two.
    pub(crate) fn of_lattice(cells: &[u32]) -> Self {
        let product = |extra: u128| cells.iter().fold(1, |all: u128, &n| all.saturating_mul(u128::from(n) + extra));
        let (dimension, corners) = if cells.len() == 2 { (Dimension::Plane, 4) } else { (Dimension::Space, 8) };
        let elements = BTreeMap::from([(corners, product(0))]);
        Self { dimension, nodes: product(1), solids: Solids::Ordered, elements, lattice: true, springs: None }
    }

    /// The number of elements.
    pub(crate) fn count(&self) -> u128 {
        self.elements.values().fold(0, |sum, &count| sum.saturating_add(count))
    }

    /// Entries in all element lists together.
    pub(crate) fn corners(&self) -> u128 {
        self.sum(|_, nodes| nodes as u128)
    }

    /// Entries in the lists of the faces of all elements that are convex hulls, at most.
    pub(crate) fn hull_corners(&self) -> u128 {
        let hulls = |kind, nodes: usize| if kind == ElementKind::Other { face_corners(kind, nodes) } else { 0 };
        self.sum(hulls)
    }

    /// The sum over all elements of something that follows from an element's kind and its number of nodes.
    pub(crate) fn sum(&self, of_one: impl Fn(ElementKind, usize) -> u128) -> u128 {
        self.elements.iter().fold(0, |sum: u128, (&nodes, &count)| {
            sum.saturating_add(of_one(topology::kind(self.dimension, self.solids, nodes), nodes).saturating_mul(count))
        })
    }
}

/// Entries in the lists of one element's faces, at most.
fn face_corners(kind: ElementKind, nodes: usize) -> u128 {
    match kind {
        ElementKind::Segment => 0,
        // Twice the 3n − 6 edges that a convex solid has at most.
        ElementKind::Other => (6 * nodes as u128).saturating_sub(12),
        ElementKind::Polygon | ElementKind::Triangle => nodes as u128,
        ElementKind::Tetrahedron => 12,
        ElementKind::Pyramid => 16,
        ElementKind::Wedge => 18,
        ElementKind::Hexahedron => 24,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::hull::Hulls;
    use crate::sim::lists::IndexLists;
    use glam::DVec3;

    #[test]
    fn face_corners_are_those_of_the_faces() {
        let (ordered, convex) = (Solids::Ordered, Solids::Convex);
        for (dimension, solids, nodes) in
            [(Dimension::Plane, ordered, 2..9), (Dimension::Space, ordered, 2..10), (Dimension::Space, convex, 2..10)]
        {
            for nodes in nodes {
                let elements = BTreeMap::from([(nodes, 1)]);
                let census =
                    Census { dimension, nodes: nodes as u128, solids, elements, lattice: false, springs: None };
                let own: Vec<u32> = (0..nodes as u32).collect();
                let lists: IndexLists = [own.as_slice()].into_iter().collect();
                let kinds = [topology::kind(dimension, solids, nodes)];
                // On this curve every face of the hull is a triangle: as many as there can be.
                let rest: Vec<_> = (0..nodes).map(|at| at as f64).map(|t| DVec3::new(t, t * t, t * t * t)).collect();
                let hulls = Hulls::new(&lists, &kinds, &rest);
                let faces = topology::Elements { nodes: &lists, kinds: &kinds, hulls: &hulls, rest: &rest }.faces_of(0);
                assert_eq!(
                    census.sum(face_corners),
                    faces.iter().map(|face| face.len() as u128).sum::<u128>(),
                    "{nodes}"
                );
            }
        }
    }
}
