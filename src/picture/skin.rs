//! The surface of a whole body.

use super::camera::Lens;
use super::ears::Ears;
use crate::sim::Body;
use glam::DVec3;

/// Marks on faces fade between this cosine towards the viewer and zero.
const GRAZING: f64 = 0.08;

/// The surface of a body, independent of its turned-over elements.
#[derive(Debug)]
pub(super) struct Skin {
    /// The nodes on it.
    pub(super) nodes: Vec<u32>,
    /// Its triangles, as places in `nodes`.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The place of each node of the body in `nodes`, or [`INSIDE`].
    places: Vec<u32>,
}

/// The place of a node that is not on the surface.
const INSIDE: u32 = u32::MAX;

impl Skin {
    /// The skin of a body.
    pub(super) fn new(body: &Body, ears: &Ears) -> Self {
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
        let outside = body.faces.nodes.iter().zip(&body.faces.outer).filter(|(_, outer)| outer.is_none());
        let mut triangles = Vec::new();
        for (face, _) in outside {
            match ears.of(face) {
                Some(ears) => triangles.extend(ears.iter().map(|ear| ear.map(|at| place(face[at as usize])))),
                None => triangles.extend((2..face.len()).map(|at| [face[0], face[at - 1], face[at]].map(&mut place))),
            }
        }
        Self { nodes, triangles, places }
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
