//! An exploded view: a body whose elements are drawn apart, to show the inside.

use crate::sim::body::{Body, IndexLists};
use crate::sim::hull::Hulls;
use crate::sim::topology::Elements;
use glam::DVec3;

/// A body whose elements do not share nodes: each has its own copies. It is drawn like any other body.
#[derive(Debug)]
pub(super) struct Exploded {
    pub(super) body: Body,
    /// The node of the whole body that each node is a copy of. Nodes of no element come last.
    originals: Vec<u32>,
    /// How far elements are moved apart, in parts of their distance from where they are moved away from.
    apart: f64,
}

impl Exploded {
    /// The elements of a body apart from each other. Faces are those of the elements, also where a body lists others.
    pub(super) fn new(whole: &Body, apart: f64) -> Self {
        let mut originals = whole.elements.indices().to_vec();
        let mut is_used = vec![false; whole.len()];
        originals.iter().for_each(|&node| is_used[node as usize] = true);
        originals.extend((0u32..).zip(&is_used).filter(|(_, used)| !**used).map(|(node, _)| node));
        let mut elements = IndexLists::default();
        for element in 0..whole.elements.len() {
            let own: Vec<u32> = whole.elements.range(element).map(|at| at as u32).collect();
            elements.push(&own);
        }
        let of = |values: &[DVec3]| originals.iter().map(|&node| values[node as usize]).collect::<Vec<_>>();
        let (rest, kinds) = (of(&whole.rest), whole.kinds.clone());
        let mass = originals.iter().map(|&node| whole.mass[node as usize]).collect();
        let hulls = Hulls::new(&elements, &kinds, &rest);
        let faces = Elements { nodes: &elements, kinds: &kinds, hulls: &hulls, rest: &rest }.shared_faces();
        let body = Body { dimension: whole.dimension, rest, mass, elements, kinds, hulls, faces };
        Self { body, originals, apart }
    }

    /// Where the nodes are drawn, from where those of the whole body are (m). Elements are moved away from the mean of
    /// the body, and up from the lowest of them where there is ground with a normal, so that none sinks into it.
    pub(super) fn positions(&self, whole: &[DVec3], ground: Option<DVec3>) -> Vec<DVec3> {
        let mut moved: Vec<_> = self.originals.iter().map(|&node| whole[node as usize]).collect();
        let elements = &self.body.elements;
        let of_elements = elements.indices().len();
        let mean = |nodes: &[DVec3]| nodes.iter().sum::<DVec3>() / nodes.len().max(1) as f64;
        let means: Vec<_> = (0..elements.len()).map(|element| mean(&moved[elements.range(element)])).collect();
        let mut anchor = mean(whole);
        if let Some(normal) = ground {
            let heights = means.iter().chain(&moved[of_elements..]).map(|at| at.dot(normal));
            let lowest = heights.fold(f64::INFINITY, f64::min);
            if lowest.is_finite() {
                anchor += (lowest - anchor.dot(normal)) * normal;
            }
        }
        for (element, mean) in means.into_iter().enumerate() {
            let way = self.apart * (mean - anchor);
            moved[elements.range(element)].iter_mut().for_each(|node| *node += way);
        }
        moved[of_elements..].iter_mut().for_each(|node| *node += self.apart * (*node - anchor));
        moved
    }

    /// The numbers of the nodes of the whole body, for each copy; others than one for each node stay as they are.
    pub(super) fn of_nodes(&self, values: &[f64], nodes: usize) -> Vec<f64> {
        if values.len() != nodes {
            return values.to_vec();
        }
        self.originals.iter().map(|&node| values[node as usize]).collect()
    }

    /// All copies of some nodes of the whole body.
    pub(super) fn copies(&self, nodes: &[u32]) -> Vec<u32> {
        let mut sorted = nodes.to_vec();
        sorted.sort_unstable();
        let copies = (0u32..).zip(&self.originals).filter(|(_, original)| sorted.binary_search(original).is_ok());
        copies.map(|(copy, _)| copy).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::body::{Dimension, Solids, bounds};

    /// Eight cubes, a bar beside them and a node of no element.
    fn cubes() -> Body {
        let at = |at: u32| DVec3::new(f64::from(at % 3), f64::from(at / 3 % 3), f64::from(at / 9));
        let mut rest: Vec<_> = (0..27).map(at).collect();
        rest.extend([DVec3::new(4.0, 0.0, 0.0), DVec3::new(0.0, 5.0, 0.0)]);
        let corner = |cell: u32, at: u32| {
            (cell & 1) + (at & 1) + 3 * ((cell >> 1 & 1) + (at >> 1 & 1)) + 9 * ((cell >> 2) + (at >> 2))
        };
        let mut elements = IndexLists::default();
        (0..8).for_each(|cell| elements.push(&(0..8).map(|at| corner(cell, at)).collect::<Vec<_>>()));
        elements.push(&[2, 27]);
        let mass = vec![1.0; rest.len()];
        Body::new(Dimension::Space, rest, mass, elements, Solids::Ordered, None)
    }

    #[test]
    fn elements_own_their_nodes_and_every_face_lies_outside() {
        let whole = cubes();
        let exploded = Exploded::new(&whole, 1.0);
        let body = &exploded.body;
        assert_eq!((body.len(), body.elements.len()), (8 * 8 + 2 + 1, 9));
        assert_eq!((body.faces.nodes.len(), body.faces.outer.iter().flatten().count()), (8 * 6, 0));
        assert_eq!(exploded.copies(&[13, 27, 28]).len(), 8 + 1 + 1);
        let numbers: Vec<_> = (0..29).map(f64::from).collect();
        let spread = exploded.of_nodes(&numbers, 29);
        assert_eq!((spread.len(), spread[7], spread[66]), (67, 13.0, 28.0));
        assert_eq!(exploded.of_nodes(&[1.0; 9], 29), [1.0; 9]);
    }

    #[test]
    fn elements_of_a_lattice_part_and_none_sinks_into_the_ground() {
        let whole = cubes();
        for apart in [0.1, 1.0, 3.0] {
            let exploded = Exploded::new(&whole, apart);
            for ground in [None, Some(DVec3::Y), Some(DVec3::new(0.6, 0.8, 0.0))] {
                let moved = exploded.positions(&whole.rest, ground);
                let boxes: Vec<_> = (0..8).map(|cell| bounds(&moved[8 * cell..8 * cell + 8])).collect();
                for (at, one) in boxes.iter().enumerate() {
                    assert!((one.1 - one.0 - DVec3::ONE).length() < 1e-12, "an element keeps its shape");
                    for other in &boxes[..at] {
                        let gap = (one.0 - other.1).max(other.0 - one.1).max_element();
                        assert!((gap - apart).abs() < 1e-12, "{gap} between neighbours");
                    }
                }
                let Some(normal) = ground else { continue };
                let lowest = |points: &[DVec3]| points.iter().map(|at| at.dot(normal)).fold(f64::INFINITY, f64::min);
                assert!(lowest(&moved) >= lowest(&whole.rest) - 1e-12);
            }
        }
    }

    #[test]
    fn nothing_apart_is_where_it_was() {
        let whole = cubes();
        let exploded = Exploded::new(&whole, 0.0);
        let there = |at: &u32| whole.rest[*at as usize];
        assert_eq!(exploded.positions(&whole.rest, None), exploded.originals.iter().map(there).collect::<Vec<_>>());
    }
}
