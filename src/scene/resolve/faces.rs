//! The faces of bodies on which loads act.

use crate::scene::SceneBody;
use crate::sim::{Body, Dimension, State, around, for_each_area};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Faces of a body.
#[derive(Debug)]
pub(super) enum Faces {
    /// Of its elements, by their nodes.
    Own(Vec<Vec<u32>>),
    /// Of the surface that it carries, by the points of this.
    Carried(Vec<[u32; 3]>),
}

impl Faces {
    /// The faces of the surface that a body carries, or else of the surface of its elements, with all corners among some points of its
    /// [`outside`].
    pub(super) fn among(body: &Body, points: &[u32]) -> Self {
        let count = body.carried().map_or(body.len(), |fine| fine.rest.len());
        let mut is_chosen = vec![false; count];
        points.iter().for_each(|&point| is_chosen[point as usize] = true);
        let takes = |corners: &[u32]| corners.iter().all(|&point| is_chosen[point as usize]);
        match body.carried() {
            Some(fine) => Self::Carried(fine.triangles.iter().copied().filter(|face| takes(face)).collect()),
            None => Self::Own(surface(body).into_iter().filter(|face| takes(face)).collect()),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        match self {
            Self::Own(faces) => faces.is_empty(),
            Self::Carried(triangles) => triangles.is_empty(),
        }
    }

    /// The nodes that bear the faces in rising order, each with its part of their areas at rest (m², in the plane m).
    pub(super) fn areas(&self, body: &Body) -> Vec<(u32, f64)> {
        let (triangles, fine) = match (self, body.carried()) {
            (Self::Carried(triangles), Some(fine)) => (triangles, fine),
            (Self::Own(faces), _) => return areas(faces.iter().map(Vec::as_slice), body.rest()),
            (Self::Carried(_), None) => return Vec::new(),
        };
        let mut all = BTreeMap::new();
        for (point, area) in areas(triangles.iter().map(<[u32; 3]>::as_slice), &fine.rest) {
            let (nodes, weights) = fine.weights.of(point as usize);
            nodes.iter().zip(weights).for_each(|(&node, weight)| *all.entry(node).or_insert(0.0) += area * weight);
        }
        all.into_iter().collect()
    }
}

/// The body whose nodes are the points from which faces are chosen: those of the surface that a body carries, or else its own.
pub(super) fn outside(of: &SceneBody) -> SceneBody {
    let skin = of.body.carried().and_then(|fine| {
        let body = Body::builder(fine.rest.clone()).build().ok()?;
        Some((Arc::new(body), State::at_rest(fine.positions(&of.initial.position))))
    });
    match skin {
        Some((body, initial)) => SceneBody { body, initial, groups: of.surface_groups.clone(), ..of.clone() },
        None => of.clone(),
    }
}

/// The corners of faces in rising order, each with its part of their areas (m², in the plane m).
fn areas<'a>(faces: impl Iterator<Item = &'a [u32]>, rest: &[DVec3]) -> Vec<(u32, f64)> {
    let mut all = BTreeMap::new();
    for face in faces {
        let mut whole = DVec3::ZERO;
        for_each_area(face, rest, |_, area| whole += area);
        let normal = whole.normalize_or_zero();
        for_each_area(face, rest, |node, area| *all.entry(node).or_insert(0.0) += area.dot(normal));
    }
    all.into_iter().collect()
}

/// The faces of the surface of the elements of a body, counter-clockwise seen from outside; in the plane their sides, with the body at the left.
pub(super) fn surface(body: &Body) -> Vec<Vec<u32>> {
    let faces = body.faces();
    let outside = (0..faces.nodes.len()).filter(|&face| faces.inner[face].is_some() && faces.outer[face].is_none());
    let outside = outside.map(|face| faces.nodes[face].to_vec());
    if body.dimension() == Dimension::Space {
        return outside.collect();
    }
    let sides: Vec<[u32; 2]> = outside.flat_map(|face| around(&face).collect::<Vec<_>>()).collect();
    let known: BTreeSet<_> = sides.iter().copied().collect();
    sides.into_iter().filter(|&[from, to]| !known.contains(&[to, from])).map(Vec::from).collect()
}
