//! The surfaces of bodies, as programs show them that know no elements.

use crate::carried::positions;
use crate::sim::{Body, Carried, ElementKind, IndexLists};
use glam::DVec3;
use std::borrow::Cow;
use std::sync::Arc;

/// The visible parts of a body: the surface that it carries, or the outer faces of its elements, and elements that are lines.
pub(super) struct Surface {
    /// The points of each face, counter-clockwise seen from outside.
    pub(super) faces: IndexLists,
    /// The ends of each line.
    pub(super) lines: Vec<[u32; 2]>,
    /// The carried surface, whose points these are; `None` if they are the nodes of the body.
    pub(super) carried: Option<Arc<Carried>>,
    pub(super) body: Arc<Body>,
}

impl Surface {
    pub(super) fn of(body: &Arc<Body>) -> Self {
        let body = Arc::clone(body);
        if let Some(carried) = &body.carried() {
            let faces = carried.triangles.iter().map(|triangle| &triangle[..]).collect();
            return Self { faces, lines: Vec::new(), carried: Some(Arc::clone(carried)), body };
        }
        let all = body.faces();
        let is_outer = |&face: &usize| all.inner[face].is_none() || all.outer[face].is_none();
        let faces = (0..all.nodes.len()).filter(is_outer).map(|face| &all.nodes[face]).collect();
        let is_line =
            |(nodes, kind): (&[u32], &ElementKind)| (*kind == ElementKind::Segment).then(|| [nodes[0], nodes[1]]);
        let lines = body.elements().iter().zip(body.kinds()).filter_map(is_line).collect();
        Self { faces, lines, carried: None, body }
    }

    /// The vectors of the points, such as positions or velocities, from those of the nodes.
    pub(super) fn points<'p>(&self, nodes: &'p [DVec3]) -> Cow<'p, [DVec3]> {
        match &self.carried {
            Some(carried) => positions(carried, nodes).into(),
            None => nodes.into(),
        }
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/surface.rs"]
mod tests;
