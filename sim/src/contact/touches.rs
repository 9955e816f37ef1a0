//! What touches in a step, with what the rule needs to know of it.

use super::features::{Closest, Kind};
use super::rule::{Term, Touch};
use super::shown::Seen;
use glam::DVec3;

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
        let [one, other] = of.map(|surface| &seen.stage.surfaces[surface]);
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
        let distance = closest.way.length();
        let normal = closest.way * (sign / distance);
        let there = if sign > 0.0 { closest.here - closest.way } else { closest.here };
        let out = normal * other.thickness;
        let drag = seen.interval.map_or(DVec3::ZERO, |interval| seen.stage.drag(of[1], interval, there, out));
        let terms = [begin, self.terms.len()].map(|at| at as u32);
        let is_whole = closest.is_least || of[0] == of[1];
        self.all.push(Touch { normal, distance, is_whole, drag, terms });
    }
}
