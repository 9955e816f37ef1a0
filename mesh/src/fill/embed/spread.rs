//! The weights by which nodes of an element carry a place.

use super::fan::{Fan, Place};
use glam::{DMat3, DVec3};
use std::collections::BTreeSet;

impl Fan {
    /// The nodes of the element of a place and the weight of each: the least that reproduce affine maps. They are gentle also where a
    /// tetrahedron of the element is flat.
    pub(super) fn affine(&self, place: &Place) -> (Vec<u32>, Vec<f64>) {
        let at: DVec3 = place
            .simplex
            .corners
            .iter()
            .zip(&place.weights)
            .map(|(&at, weight)| self.points[at as usize] * *weight)
            .sum();
        let corners = self.of(place.simplex.element as usize).iter().flat_map(|simplex| simplex.corners);
        let nodes: BTreeSet<u32> = corners.filter(|&corner| (corner as usize) < self.nodes).collect();
        let nodes: Vec<u32> = nodes.into_iter().collect();
        let places = || nodes.iter().map(|&node| self.points[node as usize]);
        let share = 1.0 / nodes.len() as f64;
        let mean = places().sum::<DVec3>() * share;
        let spread = places()
            .map(|node| node - mean)
            .fold(DMat3::ZERO, |sum, from| sum + DMat3::from_cols(from * from.x, from * from.y, from * from.z));
        let way = spread.inverse() * (at - mean);
        let along: Vec<f64> = places().map(|node| way.dot(node - mean)).collect();
        let error = share * along.iter().sum::<f64>();
        (nodes, along.into_iter().map(|along| share + (along - error)).collect())
    }

    /// The nodes of a place and the weight of each.
    pub(super) fn spread(&self, place: &Place) -> (Vec<u32>, Vec<f64>) {
        let (mut nodes, mut of_nodes): (Vec<u32>, Vec<f64>) = (Vec::new(), Vec::new());
        let mut add = |node: u32, weight: f64| match nodes.iter().position(|&other| other == node) {
            Some(at) => of_nodes[at] += weight,
            None => {
                nodes.push(node);
                of_nodes.push(weight);
            }
        };
        for (&corner, &weight) in place.simplex.corners.iter().zip(&place.weights) {
            match (corner as usize).checked_sub(self.nodes) {
                None => add(corner, weight),
                Some(mean) => {
                    let of = &self.means[mean];
                    of.iter().for_each(|&node| add(node, weight / of.len() as f64));
                }
            }
        }
        (nodes, of_nodes)
    }
}
