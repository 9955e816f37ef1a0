//! The faces of bodies on which loads act.

use crate::sim::{Body, Dimension, around, for_each_area};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// The corners of faces in rising order, each with its part of their areas (m², in the plane m).
pub(super) fn areas(faces: &[Vec<u32>], rest: &[DVec3]) -> Vec<(u32, f64)> {
    let mut all = BTreeMap::new();
    for face in faces {
        let mut whole = DVec3::ZERO;
        for_each_area(face, rest, |_, area| whole += area);
        let normal = whole.normalize_or_zero();
        for_each_area(face, rest, |node, area| *all.entry(node).or_insert(0.0) += area.dot(normal));
    }
    all.into_iter().collect()
}

/// The faces of the surface of the elements of a body, or their sides in the plane, with all corners among some nodes.
pub(super) fn faces_among(body: &Body, nodes: &[u32]) -> Vec<Vec<u32>> {
    let mut is_chosen = vec![false; body.len()];
    nodes.iter().for_each(|&node| is_chosen[node as usize] = true);
    let mut faces = surface(body);
    faces.retain(|face| face.iter().all(|&node| is_chosen[node as usize]));
    faces
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
