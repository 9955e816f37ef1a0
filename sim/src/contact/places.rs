//! Where nodes and points of obstacles are, and where bodies touch.

use super::Side;
use crate::carried::Weights;
use glam::DVec3;

/// Nodes and points of obstacles, numbered after them.
#[derive(Clone, Copy)]
pub(super) struct Places<'a> {
    pub(super) nodes: &'a [DVec3],
    pub(super) obstacles: &'a [DVec3],
}

impl Places<'_> {
    pub(super) fn node(&self, node: u32) -> DVec3 {
        let node = node as usize;
        if node < self.nodes.len() { self.nodes[node] } else { self.obstacles[node - self.nodes.len()] }
    }

    /// A point as the weighted mean of its nodes.
    pub(super) fn point(&self, points: &Weights, point: u32) -> DVec3 {
        match points.of(point as usize) {
            (&[node], _) => self.node(node),
            (nodes, weights) => nodes.iter().zip(weights).map(|(&node, &weight)| self.node(node) * weight).sum(),
        }
    }
}

/// A place where a body touches an obstacle, another body or itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// What the body touches.
    pub from: Side,
    /// The number of the body.
    pub on: usize,
    /// The place on the body (m).
    pub at: DVec3,
}

/// What touches is at most this share of the distance that is kept farther apart than that.
pub(super) const SLACK: f64 = 0.1;
