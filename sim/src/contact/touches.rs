//! What touches in a step, with what the rule needs to know of it.

use super::features::{Closest, Kind};
use super::rule::{Term, Touch};
use super::shown::Seen;

/// What touches of two surfaces in a step, in the order of features.
#[derive(Clone, Debug, Default)]
pub(super) struct Touches {
    pub(super) all: Vec<Touch>,
    pub(super) terms: Vec<Term>,
}

impl Touches {
    pub(super) fn clear(&mut self) {
        self.all.clear();
        self.terms.clear();
    }

    /// Each with its terms.
    pub(super) fn iter(&self) -> impl Iterator<Item = (&Touch, &[Term])> {
        self.all.iter().map(|touch| {
            let [first, last] = touch.terms.map(|at| at as usize);
            (touch, &self.terms[first..last])
        })
    }

    /// Adds the closest points of two features of surfaces with these numbers.
    pub(super) fn push(
        &mut self,
        kind: Kind,
        of: [usize; 2],
        seen: &Seen<'_>,
        [first, second]: [u32; 2],
        closest: &Closest,
    ) {
        let [one, other] = of.map(|surface| &seen.surfaces[surface]);
        let begin = self.terms.len();
        let [mine, theirs] = closest.shares;
        let terms = &mut self.terms;
        let sign = match kind {
            Kind::Edges => {
                one.of_edges.follow(first, mine, terms);
                other.of_edges.follow(second, theirs.map(|share| -share), terms);
                1.0
            }
            Kind::Point { of } => {
                let ([with_point, with_facet], sign) = if of == 0 { ([one, other], 1.0) } else { ([other, one], -1.0) };
                let (nodes, weights) = with_point.points.of(first as usize);
                terms.extend(nodes.iter().zip(weights).map(|(&node, &weight)| Term { node, weight: sign * weight }));
                with_facet.of_facets.follow(second, theirs.map(|share| -sign * share), terms);
                sign
            }
        };
        let is_own = of[0] == of[1];
        if is_own {
            merge(terms, begin);
        }
        let distance = closest.way.length();
        let normal = closest.way * (sign / distance);
        let [at, there] = match sign > 0.0 {
            true => [closest.here, closest.here - closest.way],
            false => [closest.here - closest.way, closest.here],
        };
        let out = normal * other.thickness;
        let drag = seen.drag(of[1], there, out);
        let terms = [begin, self.terms.len()].map(|at| at as u32);
        let keeps_law = closest.is_least || is_own;
        self.all.push(Touch { at, normal, distance, keeps_law, drag, terms });
    }
}

/// Adds up the weights of the nodes that both features of a pair follow, in its terms, which begin at a place.
fn merge(terms: &mut Vec<Term>, begin: usize) {
    /// What is left of weights that cancel out: it would move nodes that no other one holds back.
    const ROUND_OFF: f64 = 1e-12;
    let mut end = begin;
    for at in begin..terms.len() {
        let term = terms[at];
        if let Some(known) = terms[begin..end].iter_mut().find(|known| known.node == term.node) {
            known.weight += term.weight;
            if known.weight.abs() < ROUND_OFF {
                known.weight = 0.0;
            }
        } else {
            terms[end] = term;
            end += 1;
        }
    }
    terms.truncate(end);
}

#[cfg(test)]
mod tests {
    use super::super::{Contacts, Surfaces};
    use super::*;
    use crate::body::Body;
    use glam::DVec3;
    use std::sync::Arc;

    /// Two bodies whose points are a local minimum only nearly keep a part of the law, folds of one body all of it.
    #[test]
    fn folds_of_one_body_keep_the_whole_law() {
        let corner = |at: u32| DVec3::from_array([0, 1, 2].map(|axis| f64::from(at >> axis & 1)));
        let nodes: Vec<u32> = (0..8).collect();
        let cube = Body::builder((0..8).map(corner).collect()).elements([&nodes[..]].into_iter().collect());
        let cube = Arc::new(cube.build().expect("a cube"));
        let both = Surfaces::new(&[Arc::clone(&cube), cube], &[], &Contacts::default());
        let seen = both.stage.seen(&[], None);
        let keeps_law = |of: [usize; 2], is_least: bool| {
            let shares = [[0.5, 0.5, 0.0]; 2];
            let closest = Closest { here: DVec3::ZERO, way: DVec3::X, shares, rests: 0.0, is_least };
            let mut touches = Touches::default();
            touches.push(Kind::Edges, of, &seen, [0, 5], &closest);
            touches.all[0].keeps_law
        };
        assert!(keeps_law([0, 0], false) && !keeps_law([0, 1], false) && keeps_law([0, 1], true));
    }

    /// Middles of faces that follow common nodes: each node has one term.
    #[test]
    fn common_nodes_have_one_weight() {
        let term = |(node, weight): (u32, f64)| Term { node, weight };
        let mut terms = [(9, 1.0), (1, 0.5), (2, 0.3), (3, 0.2), (2, -0.5), (4, -0.3), (3, -0.2)].map(term).to_vec();
        merge(&mut terms, 1);
        let found: Vec<_> = terms.iter().map(|&Term { node, weight }| (node, weight)).collect();
        assert_eq!(found, [(9, 1.0), (1, 0.5), (2, -0.2), (3, 0.0), (4, -0.3)]);
    }
}
