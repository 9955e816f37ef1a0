//! The surface of bodies: faces of elements, and the fine surfaces that bodies carry in their place.

use crate::picture::camera::Lens;
use crate::picture::compose::fine::Fine;
use crate::picture::ears::Ears;
use crate::sim::Assembly;
use glam::DVec3;
use std::ops::Range;

/// Marks on faces fade between this cosine towards the viewer and zero.
const GRAZING: f64 = 0.08;

/// The surface of bodies, independent of their turned-over elements. Its points are nodes and, after them, the points of
/// carried surfaces.
#[derive(Debug)]
pub(super) struct Skin {
    /// The nodes on it.
    pub(super) nodes: Vec<u32>,
    /// The carried surfaces.
    pub(super) fine: Vec<Fine>,
    /// Its triangles of faces, as places among its nodes.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The place of each node of the bodies in `nodes`, or [`INSIDE`].
    places: Vec<u32>,
}

/// The place of a node that is not on the surface.
const INSIDE: u32 = u32::MAX;

impl Skin {
    /// The skin of bodies. If `fine`, it has carried surfaces in place of the faces of the elements that carry them.
    pub(super) fn new(bodies: &Assembly, ears: &Ears, fine: bool) -> Self {
        let body = bodies.whole();
        let fine = if fine { Fine::of(bodies) } else { Vec::new() };
        let mut places = vec![INSIDE; body.len()];
        let mut nodes = Vec::new();
        let mut place = |node: u32| {
            let place = &mut places[node as usize];
            if *place == INSIDE {
                *place = nodes.len() as u32;
                nodes.push(node);
            }
            *place
        };
        let outside =
            body.faces().nodes.iter().zip(&body.faces().outer).enumerate().filter(|(_, (_, outer))| outer.is_none());
        let mut triangles = Vec::new();
        for (_, (face, _)) in outside.filter(|&(at, _)| !fine.iter().any(|fine| fine.faces.contains(&at))) {
            match ears.of(face) {
                Some(ears) => triangles.extend(ears.iter().map(|ear| ear.map(|at| place(face[at as usize])))),
                None => triangles.extend((2..face.len()).map(|at| [face[0], face[at - 1], face[at]].map(&mut place))),
            }
        }
        Self { nodes, fine, triangles, places }
    }

    /// The positions of its points (m), from those of all nodes; none without nodes.
    pub(super) fn points(&self, position: &[DVec3]) -> Vec<DVec3> {
        if position.is_empty() {
            return Vec::new();
        }
        let mut points: Vec<_> = self.nodes.iter().map(|&node| position[node as usize]).collect();
        self.fine.iter().for_each(|fine| fine.place(position, &mut points));
        points
    }

    /// Its points that belong together: the nodes of each body, and those of each carried surface.
    pub(super) fn parts(&self, bodies: &Assembly) -> Vec<Range<usize>> {
        // The nodes of one body follow those of another.
        let body = |&node: &u32| bodies.body_of_node(node as usize);
        let of_nodes = self.nodes.chunk_by(|one, other| body(one) == body(other)).map(<[_]>::len);
        let mut first = 0;
        let range = |count: usize| {
            first += count;
            first - count..first
        };
        of_nodes.chain(self.fine.iter().map(|fine| fine.surface.rest.len())).map(range).collect()
    }

    /// Whether each element of bodies is inside a carried surface; empty without one.
    pub(super) fn inside(&self, bodies: &Assembly) -> Vec<bool> {
        let mut inside = vec![false; if self.fine.is_empty() { 0 } else { bodies.whole().elements().len() }];
        self.fine.iter().for_each(|fine| fine.mark_inside(bodies, &mut inside));
        inside
    }

    /// Whether a node is on the surface.
    pub(super) fn holds(&self, node: u32) -> bool {
        self.places[node as usize] != INSIDE
    }

    /// The visibility of each node of the body, from 0 to 1: 1 on faces towards the viewer, less as they turn to the
    /// side, 0 on faces turned away. In the plane all are visible.
    pub(super) fn visible(&self, position: &[DVec3], lens: &Lens) -> Vec<f64> {
        if lens.orthographic {
            return vec![1.0; position.len()];
        }
        let mut visible = vec![0.0_f64; position.len()];
        for triangle in &self.triangles {
            let nodes = triangle.map(|at| self.nodes[at as usize] as usize);
            let [a, b, c] = nodes.map(|node| position[node]);
            let share = (lens.facing(a, (b - a).cross(c - a)) / GRAZING).clamp(0.0, 1.0);
            nodes.iter().for_each(|&node| visible[node] = visible[node].max(share));
        }
        visible
    }
}
