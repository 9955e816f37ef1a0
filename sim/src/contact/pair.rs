//! Two surfaces that may meet: lists of their features that are near each other, and which of them touch in a step.

use super::candidates::Candidates;
use super::extent::{Extent, near, sweep};
use super::features::{Kind, Placed};
use super::rule::Law;
use super::shown::{Seen, Shown};
use super::surface::Surface;
use super::touches::{Sides, Touches};

/// Two surfaces that may meet, or one with itself.
#[derive(Clone, Debug)]
pub(super) struct Pair {
    /// The numbers of the surfaces, the lesser first.
    pub(super) of: [usize; 2],
    pub(super) law: Law,
    /// The way that points of one have moved relative to the other at most since the beginning (m).
    way: f64,
    /// Up to which way the lists hold all that can touch; `None` before they are made.
    until: Option<f64>,
    candidates: [Candidates; 3],
    /// What touches in this step.
    pub(super) touches: Touches,
}

impl Pair {
    pub(super) fn new(of: [usize; 2], law: Law) -> Self {
        Self { of, law, way: 0.0, until: None, candidates: Default::default(), touches: Touches::default() }
    }

    /// Adds the way since the last step (m). The lists are made anew if features that are not in them might touch in this one,
    /// in which points move relative to each other by `ahead` (m).
    pub(super) fn go(&mut self, seen: &Seen<'_>, way: f64, ahead: f64) {
        self.way += way;
        let needed = self.way + 2.0 * ahead;
        if self.until.is_none_or(|until| needed > until) {
            self.list(seen, ahead);
        }
    }

    /// Lists the features within a reach that lasts for some steps.
    fn list(&mut self, seen: &Seen<'_>, ahead: f64) {
        /// A share of the size of a cell, and of the way of a step.
        const SKIN: [f64; 2] = [2.0, 8.0];
        let [one, other] = self.of.map(|surface| seen.placed(surface));
        let skin = (SKIN[0] * (one.surface.thickness + other.surface.thickness)).max(SKIN[1] * ahead);
        let reach = self.law.gap + skin;
        self.candidates.iter_mut().for_each(|list| list.renew(std::iter::empty()));
        let [mine, theirs] = [one, other].map(|placed| Extent::around(placed.at.iter().copied()));
        let apart = mine.distance(&theirs);
        if apart >= reach && self.of[0] != self.of[1] {
            self.until = Some(self.way + (apart - self.law.gap));
            return;
        }
        self.until = Some(self.way + skin);
        let common = mine.grown(reach).common(&theirs.grown(reach));
        let lists = |placed: Placed<'_>| {
            let around = |points: &[u32]| Extent::around(points.iter().map(|&point| placed.point(point)));
            let points =
                (0u32..).zip(placed.at).map(|(number, &point)| (number, Extent::around(std::iter::once(point))));
            let facets = (0u32..).zip(&placed.surface.facets).map(|(number, facet)| (number, around(facet.used())));
            let edges = (0u32..).zip(&placed.surface.edges).map(|(number, ends)| (number, around(ends)));
            [near(points, &common), near(facets, &common), near(edges, &common)]
        };
        let [of_one, of_other] = [lists(one), lists(other)];
        let axes = common.longest_axes();
        for (at, kind) in Kind::ALL.into_iter().enumerate() {
            let sides = match kind {
                Kind::Point { of: 0 } => [&of_one[0], &of_other[1]],
                // A surface meets itself only once.
                Kind::Point { .. } if self.of[0] == self.of[1] => continue,
                Kind::Point { .. } => [&of_other[0], &of_one[1]],
                Kind::Edges => [&of_one[2], &of_other[2]],
            };
            let mut found = Vec::new();
            sweep(sides, reach, axes, |features| found.push(features));
            if self.of[0] == self.of[1] {
                let mut at = Shown::default();
                at.place(one.surface, &seen.rest);
                let rest = Placed { surface: one.surface, at: &at.points };
                found.retain(|&features| is_apart_at_rest(rest, kind, features, 2.0 * self.law.gap));
            }
            found.sort_unstable();
            self.candidates[at].renew(found.into_iter());
        }
    }

    /// Finds what touches in this step.
    pub(super) fn look(&mut self, seen: &Seen<'_>, ahead: f64) {
        let Self { of, law, way, candidates, touches, .. } = self;
        touches.clear();
        let (placed, is_same) = (of.map(|surface| seen.placed(surface)), of[0] == of[1]);
        let shown = of.map(|surface| &seen.start[surface]);
        let (due, far) = (*way + 2.0 * ahead, law.gap + 2.0 * ahead);
        for (kind, list) in Kind::ALL.into_iter().zip(candidates) {
            let sides = Sides { kind, of: *of, seen };
            list.for_each_awake(due, |features| {
                // Points and facets meet where two edges are flat.
                let flat = (kind == Kind::Edges).then(|| [0, 1].map(|side| shown[side].stays_flat(features[side])));
                if let Some([Some(one), Some(other)]) = flat {
                    return *way + one.min(other).max(f64::MIN_POSITIVE);
                }
                let closest = kind.closest(placed, is_same, features, far);
                let distance = closest.way.length();
                if distance >= far || closest.rests > 0.0 {
                    return *way + closest.rests.max(distance - law.gap);
                }
                if distance > 0.0 {
                    touches.push(&sides, features, &closest);
                }
                f64::NEG_INFINITY
            });
        }
    }
}

/// Whether two features of a surface share no node and are at rest farther from each other than a distance (m).
fn is_apart_at_rest(rest: Placed<'_>, kind: Kind, [first, second]: [u32; 2], far: f64) -> bool {
    if kind == Kind::Edges && first >= second {
        return false;
    }
    let Surface { points, facets, edges, .. } = rest.surface;
    let (mine, theirs) = match kind {
        Kind::Edges => (&edges[first as usize][..], &edges[second as usize][..]),
        Kind::Point { .. } => (std::slice::from_ref(&first), facets[second as usize].used()),
    };
    let nodes = |of| <[u32]>::iter(of).flat_map(|&point| points.of(point as usize).0);
    let is_joined = nodes(mine).any(|node| nodes(theirs).any(|other| node == other));
    !is_joined && kind.closest([rest; 2], true, [first, second], f64::INFINITY).way.length() > far
}
