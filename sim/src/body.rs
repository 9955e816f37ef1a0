//! The [`Body`]: nodes, masses and elements at rest.

use super::carried::Carried;
use super::element::{Dimension, ElementKind};
use super::hull::{Hulls, bounds};
use super::lists::IndexLists;
use super::topology::{Elements, Faces};
use glam::DVec3;
use std::sync::Arc;

/// A deformable body at rest. It is immutable, and all runs of a scene share it.
///
/// ```
/// use glam::DVec3;
/// use localshape_sim::{Body, BodyError, IndexLists};
///
/// let nodes = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let of = |nodes: &[u32]| -> IndexLists { [nodes].into_iter().collect() };
/// let body = Body::builder(nodes.clone()).elements(of(&[0, 1, 2, 3])).masses(vec![0.25; 4]).build()?;
/// assert_eq!(body.faces().nodes.len(), 4);
///
/// let wrong = Body::builder(nodes).elements(of(&[0, 1, 2, 4])).build();
/// assert_eq!(wrong.unwrap_err().to_string(), "element 0 names node 4; the last one is 3");
/// # Ok::<(), BodyError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    pub(crate) dimension: Dimension,
    pub(crate) rest: Vec<DVec3>,
    pub(crate) mass: Vec<f64>,
    pub(crate) elements: IndexLists,
    pub(crate) kinds: Vec<ElementKind>,
    /// The faces at rest of the elements of kind [`ElementKind::Other`].
    pub(crate) hulls: Hulls,
    pub(crate) faces: Faces,
    pub(crate) fill: Option<Vec<f64>>,
    pub(crate) stiffness: Option<Vec<f64>>,
    pub(crate) modulus: Option<Vec<f64>>,
    pub(crate) carried: Option<Arc<Carried>>,
}

impl Body {
    /// Whether it meets half-spaces with the points of a carried surface, where surfaces meet. Other bodies meet them with their nodes.
    pub(crate) fn meets_by_surface(&self) -> bool {
        self.carried.is_some() && self.dimension == Dimension::Space
    }

    /// Whether it is in the plane or in space.
    pub fn dimension(&self) -> Dimension {
        self.dimension
    }

    /// Rest position of each node (m).
    pub fn rest(&self) -> &[DVec3] {
        &self.rest
    }

    /// Mass of each node (kg), positive.
    pub fn mass(&self) -> &[f64] {
        &self.mass
    }

    /// The nodes of each element, two or more.
    pub fn elements(&self) -> &IndexLists {
        &self.elements
    }

    /// The kind of each element.
    pub fn kinds(&self) -> &[ElementKind] {
        &self.kinds
    }

    /// The faces of the elements, or those given in place of them.
    pub fn faces(&self) -> &Faces {
        &self.faces
    }

    /// The filled part of the volume of each element; `None` if all are full. See [`Self::with_fill`].
    pub fn fill(&self) -> Option<&[f64]> {
        self.fill.as_deref()
    }

    /// The relative stiffness of each element; `None` if all are 1. See [`Self::with_stiffness`].
    pub fn stiffness(&self) -> Option<&[f64]> {
        self.stiffness.as_deref()
    }

    /// The relative modulus of each element; `None` if all are 1. See [`Self::with_modulus`].
    pub fn modulus(&self) -> Option<&[f64]> {
        self.modulus.as_deref()
    }

    /// The fine surface that the body carries.
    pub fn carried(&self) -> Option<&Arc<Carried>> {
        self.carried.as_ref()
    }

    /// All bodies as one, with the nodes, elements and faces of the first before those of the second, and so on. The whole
    /// carries no surface, unless it is the only body.
    ///
    /// # Panics
    /// If there is no body, or if one is in the plane and another in space.
    pub(crate) fn joined(bodies: &[Arc<Self>]) -> Arc<Self> {
        let (first, others) = bodies.split_first().expect("at least one body");
        let mut whole = Arc::clone(first);
        for body in others {
            // The first other body makes a copy of the first one.
            let whole = Arc::make_mut(&mut whole);
            let counts = [whole.elements.len(), body.elements.len()];
            let joined = |of: [&Option<Vec<f64>>; 2]| {
                let [one, other] = [0, 1].map(|at| of[at].clone().unwrap_or_else(|| vec![1.0; counts[at]]));
                of.iter().any(|of| of.is_some()).then(|| [one, other].concat())
            };
            whole.fill = joined([&whole.fill, &body.fill]);
            whole.stiffness = joined([&whole.stiffness, &body.stiffness]);
            whole.modulus = joined([&whole.modulus, &body.modulus]);
            whole.carried = None;
            assert_eq!(whole.dimension, body.dimension, "bodies of one dimension");
            let (node, element) = (whole.len() as u32, whole.elements.len() as u32);
            whole.rest.extend(&body.rest);
            whole.mass.extend(&body.mass);
            whole.elements.append(&body.elements, node);
            whole.kinds.extend(&body.kinds);
            whole.hulls.append(&body.hulls, node, element);
            whole.faces.append(&body.faces, node, element);
        }
        whole
    }

    /// The elements with their faces, edges and named springs.
    pub fn topology(&self) -> Elements<'_> {
        Elements { nodes: &self.elements, kinds: &self.kinds, hulls: &self.hulls, rest: &self.rest }
    }

    /// The number of nodes.
    pub fn len(&self) -> usize {
        self.rest.len()
    }

    /// Whether the body has no node.
    pub fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    /// The mass of the lightest node (kg). Where elements are filled in part, of the node that would be the lightest if they were
    /// full: its mass goes with the stiffness of full elements.
    pub fn lightest(&self) -> f64 {
        let parts = self.fill_of_nodes();
        let full = |(node, mass): (usize, &f64)| mass / parts.as_ref().map_or(1.0, |parts| parts[node]);
        self.mass.iter().enumerate().map(full).fold(f64::INFINITY, f64::min)
    }

    /// The mean of the filled parts of each node's elements, 1 for a node of no element; `None` if all elements are full.
    pub fn fill_of_nodes(&self) -> Option<Vec<f64>> {
        let fill = self.fill.as_ref()?;
        let mut of_nodes = vec![(0.0, 0.0); self.len()];
        for (nodes, part) in self.elements.iter().zip(fill) {
            for &node in nodes {
                let (sum, count) = &mut of_nodes[node as usize];
                (*sum, *count) = (*sum + part, *count + 1.0);
            }
        }
        Some(of_nodes.into_iter().map(|(sum, count)| if count > 0.0 { sum / count } else { 1.0 }).collect())
    }

    /// The largest side of the box around the body at rest (m).
    pub fn extent(&self) -> f64 {
        let (low, high) = bounds(&self.rest);
        (high - low).max_element()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topology::Springs;

    /// Layers of regular pentagons at a distance of 1.
    fn pentagons(layers: u32) -> Vec<DVec3> {
        let corner = |at: u32| {
            let angle = std::f64::consts::TAU / 5.0 * f64::from(at % 5);
            DVec3::new(angle.cos(), angle.sin(), f64::from(at / 5))
        };
        (0..5 * layers).map(corner).collect()
    }

    /// Two prisms, one on the other, with their nodes in any order.
    fn two_prisms(faces: Option<&IndexLists>) -> Body {
        let elements =
            [&[3, 1, 4, 0, 2, 9, 5, 7, 6, 8][..], &[5, 6, 7, 8, 9, 10, 11, 12, 13, 14]].into_iter().collect();
        Body::builder(pentagons(3)).elements(elements).faces(faces.cloned()).build().expect("a body")
    }

    #[test]
    fn elements_of_any_shape_have_faces_edges_and_springs() {
        let body = two_prisms(None);
        assert_eq!(body.kinds, [ElementKind::Other; 2]);
        assert_eq!(body.faces.nodes.len(), 13);
        let inner: Vec<_> = (0..13).filter(|&face| body.faces.outer[face].is_some()).collect();
        assert_eq!(inner.iter().map(|&face| &body.faces.nodes[face]).collect::<Vec<_>>(), [&[9, 5, 6, 7, 8]]);
        assert_eq!((body.faces.inner[inner[0]], body.faces.outer[inner[0]]), (Some(0), Some(1)));
        assert_eq!(body.topology().edges_of(0).len(), 15);
        let springs = |named| body.topology().springs(named).len();
        assert_eq!(springs(Springs::Edges), 25);
        assert_eq!(springs(Springs::EdgesOneDiagonal), 25 + 10 + 3 * 2);
        assert_eq!(springs(Springs::EdgesFaceDiagonals), 25 + 20 + 3 * 5);
        assert_eq!(springs(Springs::EdgesBodyDiagonals), 25 + 2 * 10);
        assert_eq!(springs(Springs::All), 2 * 45 - 10);
    }

    #[test]
    fn a_flat_element_is_a_face_of_its_own_that_bounds_nothing() {
        let rest: Vec<_> = (0..7).map(f64::from).map(|at| DVec3::new(at, at * at, 0.5 * at)).collect();
        let elements = [&[0, 1, 2, 3, 4, 5, 6][..]; 2].into_iter().collect();
        let body = Body::builder(rest).elements(elements).build().expect("a body");
        assert_eq!(body.faces.inner, [Some(0), Some(1)]);
        assert_eq!(body.faces.outer, [None, None]);
        assert_eq!(body.topology().springs(Springs::Edges).len(), 7);
    }

    #[test]
    fn listed_faces_lie_between_the_elements_that_hold_them() {
        let listed = [&[9, 8, 7, 6, 5][..], &[5, 6, 7, 8, 9], &[4, 3, 2, 1, 0], &[0, 1, 2], &[0, 1, 11, 10]];
        let faces = two_prisms(Some(&listed.into_iter().collect())).faces;
        assert_eq!(faces.inner, [Some(1), Some(0), Some(0), None, None]);
        assert_eq!(faces.outer, [Some(0), Some(1), None, Some(0), None]);
    }
}
