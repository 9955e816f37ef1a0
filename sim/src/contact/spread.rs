//! How points of features follow nodes, with the weights of each node in each corner.

use super::rule::Term;
use crate::carried::Weights;
use crate::lists::IndexLists;

/// The nodes that features of a surface follow, each once, and the weight of each in up to three corners.
#[derive(Clone, Debug, Default)]
pub(super) struct Spread {
    nodes: IndexLists,
    weights: Vec<[f64; 3]>,
}

impl Spread {
    /// Features with these corners, whose points follow nodes by weights.
    pub(super) fn new<'a>(points: &Weights, features: impl Iterator<Item = &'a [u32]>) -> Self {
        let mut made = Self::default();
        let mut own = Vec::new();
        for corners in features {
            own.clear();
            let first = made.weights.len();
            for (at, &corner) in corners.iter().enumerate() {
                let (nodes, weights) = points.of(corner as usize);
                for (&node, &weight) in nodes.iter().zip(weights) {
                    let place = own.iter().position(|&other| other == node).unwrap_or_else(|| {
                        own.push(node);
                        made.weights.push([0.0; 3]);
                        own.len() - 1
                    });
                    made.weights[first + place][at] += weight;
                }
            }
            made.nodes.push(&own);
        }
        made
    }

    /// Adds the nodes of a feature with their weights in a point that has such shares of the corners. Nodes of corners without a share belong
    /// to the feature, too.
    pub(super) fn follow(&self, feature: u32, shares: [f64; 3], terms: &mut Vec<Term>) {
        let range = self.nodes.range(feature as usize);
        let own = self.nodes.indices()[range.clone()].iter().zip(&self.weights[range]);
        terms.extend(own.map(|(&node, weights)| {
            let [a, b, c] = [0, 1, 2].map(|at| shares[at] * weights[at]);
            Term { node, weight: a + b + c }
        }));
    }
}
