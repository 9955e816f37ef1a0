//! A fine surface that a coarse body carries.

use super::lists::IndexLists;
use glam::DVec3;

/// A closed or open surface of triangles whose points follow the nodes of a body, finer than its own faces.
#[derive(Clone, Debug, PartialEq)]
pub struct Carried {
    /// The position of each point with the body at rest (m).
    pub rest: Vec<DVec3>,
    /// The points of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// How each point follows the nodes of the body.
    pub weights: Weights,
}

impl Carried {
    /// The position of each point (m), from those of the body's nodes.
    ///
    /// # Panics
    /// If a node is missing.
    pub fn positions(&self, nodes: &[DVec3]) -> Vec<DVec3> {
        (0..self.weights.len()).map(|point| self.weights.place(point, nodes)).collect()
    }
}

/// Points as weighted means of nodes. The weights of each point have the sum 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Weights {
    nodes: IndexLists,
    weights: Vec<f64>,
}

impl Weights {
    /// Appends a point.
    ///
    /// # Panics
    /// If there is not one weight for each node.
    pub fn push(&mut self, nodes: &[u32], weights: &[f64]) {
        assert_eq!(nodes.len(), weights.len(), "one weight for each node");
        self.nodes.push(nodes);
        self.weights.extend_from_slice(weights);
    }

    /// The number of points.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The nodes of a point, and the weight of each.
    ///
    /// # Panics
    /// If there is no such point.
    pub fn of(&self, point: usize) -> (&[u32], &[f64]) {
        (&self.nodes[point], &self.weights[self.nodes.range(point)])
    }

    /// Some of the points, carried by nodes that are counted on from `first`.
    ///
    /// # Panics
    /// If there is no such point.
    pub fn some(&self, points: impl IntoIterator<Item = u32>, first: u32) -> Self {
        let mut some = Self::default();
        for point in points {
            let (nodes, weights) = self.of(point as usize);
            some.push(&nodes.iter().map(|node| node + first).collect::<Vec<_>>(), weights);
        }
        some
    }

    /// The position of a point (m), from those of the nodes.
    ///
    /// # Panics
    /// If there is no such point, or a node is missing.
    #[inline]
    pub fn place(&self, point: usize, nodes: &[DVec3]) -> DVec3 {
        let (of, weights) = self.of(point);
        of.iter().zip(weights).map(|(&node, &weight)| nodes[node as usize] * weight).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_weighted_means_of_nodes() {
        let mut weights = Weights::default();
        weights.push(&[1], &[1.0]);
        weights.push(&[0, 2], &[0.25, 0.75]);
        let nodes = [DVec3::ZERO, DVec3::Y, DVec3::X * 4.0];
        let carried = Carried { rest: vec![DVec3::ZERO; 2], triangles: vec![], weights };
        assert_eq!(carried.positions(&nodes), [DVec3::Y, DVec3::X * 3.0]);
    }
}
