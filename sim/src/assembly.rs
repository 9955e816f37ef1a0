//! The [`Assembly`]: the bodies of one world.

use super::body::Body;
use super::placement::Placement;
use glam::DVec3;
use std::ops::Range;
use std::sync::Arc;

/// The bodies that are advanced together in one [`World`](crate::World), in order. Nodes, elements and faces are numbered over all
/// bodies: those of the first body, then those of the second, and so on.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembly {
    bodies: Vec<Arc<Body>>,
    whole: Arc<Body>,
    /// Where the nodes, elements and faces of each body begin; the last entry is where all end.
    starts: Vec<[usize; 3]>,
}

impl Assembly {
    /// Joins bodies, all in the plane or all in space.
    ///
    /// # Panics
    /// If there is no body, or if one is in the plane and another in space.
    pub fn new(bodies: Vec<Arc<Body>>) -> Self {
        let mut starts = vec![[0; 3]];
        for body in &bodies {
            let [nodes, elements, faces] = starts[starts.len() - 1];
            starts.push([nodes + body.len(), elements + body.elements.len(), faces + body.faces.nodes.len()]);
        }
        let whole = Body::joined(&bodies);
        Self { bodies, whole, starts }
    }

    /// The bodies in order.
    pub fn bodies(&self) -> &[Arc<Body>] {
        &self.bodies
    }

    /// All bodies as one.
    pub fn whole(&self) -> &Arc<Body> {
        &self.whole
    }

    /// The nodes of a body.
    ///
    /// # Panics
    /// If there is no such body.
    pub fn nodes(&self, body: usize) -> Range<usize> {
        self.starts[body][0]..self.starts[body + 1][0]
    }

    /// The elements of a body.
    ///
    /// # Panics
    /// If there is no such body.
    pub fn elements(&self, body: usize) -> Range<usize> {
        self.starts[body][1]..self.starts[body + 1][1]
    }

    /// The faces of a body.
    ///
    /// # Panics
    /// If there is no such body.
    pub fn faces(&self, body: usize) -> Range<usize> {
        self.starts[body][2]..self.starts[body + 1][2]
    }

    /// The rest shapes of all bodies in given placements: the position of each node (m).
    pub fn placed(&self, placements: &[Placement]) -> Vec<DVec3> {
        let bodies = self.bodies.iter().zip(placements);
        bodies.flat_map(|(body, placement)| body.rest.iter().map(|&rest| placement.place(rest))).collect()
    }

    /// The body to which a node belongs.
    ///
    /// # Panics
    /// If there is no such node.
    pub fn body_of_node(&self, node: usize) -> usize {
        assert!(node < self.whole.len(), "a node of the assembly");
        self.starts.partition_point(|start| start[0] <= node) - 1
    }
}

impl From<&Arc<Body>> for Assembly {
    fn from(body: &Arc<Body>) -> Self {
        Self::new(vec![Arc::clone(body)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::{ElementKind, Solids};
    use crate::topology::Springs;

    /// A cube, or an octahedron for six corners, at a height (m).
    fn body(corners: usize, height: f64) -> Arc<Body> {
        let cube = |at: usize| DVec3::from_array([0, 1, 2].map(|axis| (at >> axis & 1) as f64));
        let octahedron = |at: usize| DVec3::AXES[at / 2] * if at.is_multiple_of(2) { 1.0 } else { -1.0 };
        let corner = |at| if corners == 8 { cube(at) } else { octahedron(at) } + DVec3::Y * height;
        let nodes: Vec<u32> = (0..corners as u32).collect();
        let solids = if corners == 8 { Solids::Ordered } else { Solids::Convex };
        let rest = (0..corners).map(corner).collect();
        Arc::new(
            Body::builder(rest).elements([&nodes[..]].into_iter().collect()).solids(solids).build().expect("a body"),
        )
    }

    #[test]
    fn all_bodies_as_one_have_the_nodes_elements_and_faces_of_each() {
        let bodies = vec![body(6, 0.0), body(8, 3.0), body(6, -3.0)];
        let assembly = Assembly::new(bodies.clone());
        let whole = assembly.whole();
        assert_eq!((whole.len(), whole.elements.len(), whole.faces.nodes.len()), (20, 3, 8 + 6 + 8));
        for (at, own) in bodies.iter().enumerate() {
            let (nodes, elements, faces) = (assembly.nodes(at), assembly.elements(at), assembly.faces(at));
            let shifted = |list: &[u32]| list.iter().map(|&node| node + nodes.start as u32).collect::<Vec<_>>();
            assert_eq!(whole.rest[nodes.clone()], own.rest);
            assert_eq!(whole.kinds[elements.clone()], own.kinds);
            assert_eq!(whole.elements[elements.start], shifted(&own.elements[0]));
            for (face, place) in faces.clone().enumerate() {
                assert_eq!(whole.faces.nodes[place], shifted(&own.faces.nodes[face]));
                assert_eq!(whole.faces.inner[place], Some(elements.start as u32));
            }
            let edges = own.topology().edges_of(0).len();
            assert_eq!(whole.topology().edges_of(elements.start).len(), edges);
            assert!(nodes.clone().all(|node| assembly.body_of_node(node) == at));
        }
        let springs = |body: &Body| body.topology().springs(Springs::All).len();
        assert_eq!(springs(whole), bodies.iter().map(|own| springs(own)).sum::<usize>());
        assert_eq!(whole.kinds, [ElementKind::Other, ElementKind::Hexahedron, ElementKind::Other]);
    }

    #[test]
    fn one_body_is_the_whole() {
        let alone = body(6, 0.0);
        assert_eq!(**Assembly::from(&alone).whole(), *alone);
    }
}
