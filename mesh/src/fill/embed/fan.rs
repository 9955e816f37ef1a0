//! Elements divided into tetrahedra, and what of them carries a point.

use super::CLOSE;
use crate::boxes::Boxes;
use glam::DVec3;
use localshape_sim::geometry::{around, bounds};
use localshape_sim::{Body, ElementKind, IndexLists};
use rayon::prelude::*;

/// A tetrahedron of an element, between nodes and means of nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Simplex {
    pub(super) element: u32,
    /// Indices of [`Fan::points`]. The last three are on a face of the element.
    pub(super) corners: [u32; 4],
}

/// A simplex that carries a point, and the weights of its corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) simplex: Simplex,
    pub(super) weights: [f64; 4],
    /// The distance of the point from the element, in sides.
    pub(super) distance: f64,
}

/// Elements divided into tetrahedra.
#[derive(Default)]
pub(super) struct Fan {
    /// The positions of nodes, then of means (m).
    pub(super) points: Vec<DVec3>,
    /// The nodes of each mean.
    pub(super) means: IndexLists,
    /// The number of nodes.
    pub(super) nodes: usize,
    /// All tetrahedra, by element.
    pub(super) simplices: Vec<Simplex>,
    /// Where those of each element begin; the last number is where all end.
    starts: Vec<usize>,
    /// Tetrahedra whose last three corners are on the outside.
    outside: Vec<Simplex>,
}

impl Fan {
    pub(super) fn new(body: &Body) -> Self {
        let mut fan = Self { points: body.rest().to_vec(), nodes: body.rest().len(), ..Self::default() };
        let is_simple = |element: u32| body.kinds()[element as usize] == ElementKind::Tetrahedron;
        let mut middles = vec![u32::MAX; body.elements().len()];
        for (element, nodes) in (0u32..).zip(body.elements().iter()) {
            match *nodes {
                [a, b, c, d] if is_simple(element) => fan.simplices.push(Simplex { element, corners: [a, b, c, d] }),
                _ => middles[element as usize] = fan.mean(nodes),
            }
        }
        for (face, nodes) in body.faces().nodes.iter().enumerate() {
            let mut triangles = Vec::new();
            if let [a, b, c] = *nodes {
                triangles.push([a, b, c]);
            } else {
                let mean = fan.mean(nodes);
                triangles.extend(around(nodes).map(|[a, b]| [mean, a, b]));
            }
            let sides = [body.faces().inner[face], body.faces().outer[face]];
            for element in sides.into_iter().flatten() {
                let opposite = match is_simple(element) {
                    true => body.elements()[element as usize].iter().copied().find(|node| !nodes.contains(node)),
                    false => Some(middles[element as usize]),
                };
                let Some(opposite) = opposite else { continue };
                let simplices = triangles.iter().map(|&[a, b, c]| Simplex { element, corners: [opposite, a, b, c] });
                if !is_simple(element) {
                    fan.simplices.extend(simplices.clone());
                }
                if sides[1].is_none() {
                    fan.outside.extend(simplices);
                }
            }
        }
        fan.simplices.sort_by_key(|simplex| simplex.element);
        fan.outside.sort_by_key(|simplex| simplex.element);
        let count = body.elements().len() as u32;
        fan.starts = (0..=count).map(|at| fan.simplices.partition_point(|of| of.element < at)).collect();
        fan
    }

    fn mean(&mut self, nodes: &[u32]) -> u32 {
        let sum: DVec3 = nodes.iter().map(|&node| self.points[node as usize]).sum();
        self.means.push(nodes);
        self.points.push(sum / nodes.len() as f64);
        self.points.len() as u32 - 1
    }

    pub(super) fn corners(&self, simplex: &Simplex) -> [DVec3; 4] {
        simplex.corners.map(|corner| self.points[corner as usize])
    }

    /// The tetrahedra of an element.
    pub(super) fn of(&self, element: usize) -> &[Simplex] {
        &self.simplices[self.starts[element]..self.starts[element + 1]]
    }

    /// What carries each point: the first element that contains it, or the first of the nearest; `None` if all are farther than
    /// so many sides.
    pub(super) fn locate(&self, points: &[DVec3], side: f64, most: f64) -> Vec<Option<Place>> {
        let box_of = |element: usize| {
            let corners = self.of(element).iter().flat_map(|simplex| self.corners(simplex));
            let (low, high) =
                corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
            (low - CLOSE * side, high + CLOSE * side)
        };
        let ends = bounds(&self.points);
        let elements = Boxes::new((0..self.starts.len() - 1).into_par_iter().map(box_of).collect(), ends, side);
        let outside = self.outside.iter().map(|simplex| bounds(&self.corners(simplex)[1..])).collect();
        let faces = Boxes::new(outside, ends, side);
        let locate = |point: DVec3| {
            let containing = elements.around(point).find_map(|element| {
                self.of(element as usize).iter().find_map(|simplex| {
                    let weights = weights(self.corners(simplex), point);
                    weights.iter().all(|&weight| weight >= -CLOSE).then_some((*simplex, weights))
                })
            });
            if let Some((simplex, weights)) = containing {
                return Some(Place { simplex, weights, distance: 0.0 });
            }
            let of_face = |face: u32| {
                let [_, a, b, c] = self.corners(&self.outside[face as usize]);
                [a, b, c]
            };
            let (face, distance) = faces.nearest(of_face, point, most * side)?;
            let simplex = self.outside[face as usize];
            let weights = weights(self.corners(&simplex), point);
            Some(Place { simplex, weights, distance: distance / side })
        };
        // Points of one cell are close to the same elements, which are fast to get at one after the other.
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.par_sort_by_cached_key(|&at| elements.place(points[at]));
        let found: Vec<_> = order.par_iter().map(|&at| locate(points[at])).collect();
        let mut places = vec![None; points.len()];
        order.into_iter().zip(found).for_each(|(at, place)| places[at] = place);
        places
    }
}

/// The barycentric coordinates of a point.
pub(in crate::fill) fn weights([a, b, c, d]: [DVec3; 4], point: DVec3) -> [f64; 4] {
    // From the corners to the point: small numbers have small round-off.
    let [to_a, to_b, to_c, to_d] = [a, b, c, d].map(|corner| corner - point);
    let volumes = [
        to_b.cross(to_c).dot(to_d),
        -to_a.cross(to_c).dot(to_d),
        to_a.cross(to_b).dot(to_d),
        -to_a.cross(to_b).dot(to_c),
    ];
    let sum: f64 = volumes.iter().sum();
    volumes.map(|volume| volume / sum)
}
