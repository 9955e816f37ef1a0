//! What touches in a step, with what the rule needs to know of it.

use super::features::{Closest, Kind};
use super::rule::{Term, Touch};
use super::shown::Seen;
use super::surface::Surface;

/// What touches in a step: points with facets, and edges, each in the order of features.
#[derive(Clone, Debug, Default)]
pub(super) struct Touches {
    pub(super) of_points: Vec<Touch>,
    pub(super) of_edges: Vec<Touch>,
    pub(super) terms: Vec<Term>,
}

/// Two surfaces whose features touch.
pub(super) struct Sides<'a> {
    pub(super) kind: Kind,
    /// Their numbers.
    pub(super) of: [usize; 2],
    pub(super) seen: &'a Seen<'a>,
}

impl Touches {
    pub(super) fn clear(&mut self) {
        self.of_points.clear();
        self.of_edges.clear();
        self.terms.clear();
    }

    /// Adds a pair of closest points.
    pub(super) fn push(&mut self, sides: &Sides<'_>, [first, second]: [u32; 2], closest: &Closest) {
        let Sides { kind, of, seen } = *sides;
        let [one, other] = of.map(|surface| &seen.surfaces[surface]);
        let begin = self.terms.len();
        let [mine, theirs] = closest.shares;
        let sign = match kind {
            Kind::Edges => {
                self.follow(one, &one.edges[first as usize], mine, 1.0);
                self.follow(other, &other.edges[second as usize], theirs, -1.0);
                1.0
            }
            Kind::Point { of } => {
                let ([with_point, with_facet], sign) = if of == 0 { ([one, other], 1.0) } else { ([other, one], -1.0) };
                self.follow(with_point, &[first], mine, sign);
                self.follow(with_facet, with_facet.facets[second as usize].used(), theirs, -sign);
                sign
            }
        };
        let distance = closest.way.length();
        let normal = closest.way * (sign / distance);
        let there = if sign > 0.0 { closest.here - closest.way } else { closest.here };
        let drag = (seen.drag)(of[1], there, normal * other.thickness);
        let terms = [begin, self.terms.len()].map(|at| at as u32);
        let list = if kind == Kind::Edges { &mut self.of_edges } else { &mut self.of_points };
        list.push(Touch { normal, distance, drag, terms });
    }

    /// Adds the nodes of a feature with these corners, each once, with their weights in a point that has such shares of the corners, times a
    /// sign. Nodes of corners without a share belong to the feature, too.
    fn follow(&mut self, surface: &Surface, corners: &[u32], shares: [f64; 3], sign: f64) {
        let first = self.terms.len();
        for (&corner, share) in corners.iter().zip(shares) {
            let (nodes, weights) = surface.points.of(corner as usize);
            for (&node, &weight) in nodes.iter().zip(weights) {
                let weight = sign * share * weight;
                match self.terms[first..].iter_mut().find(|term| term.node == node) {
                    Some(term) => term.weight += weight,
                    None => self.terms.push(Term { node, weight }),
                }
            }
        }
    }
}
