//! Two surfaces that may meet: lists of their features that are near each other, and which of them touch in a step.

use super::batch::Found;
use super::extent::{Extent, near, sweep};
use super::features::Kind;
use super::rule::Law;
use super::shown::Seen;
use super::sleepers::Sleepers;
use super::surface::{Placed, Surface};
use super::touches::Touches;

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
    /// How far they move relative to each other in this step (m).
    ahead: f64,
    candidates: [Candidates; 3],
    pub(super) look: Look,
}

/// Features of two surfaces, in their order, that may touch, and from which way on each two are looked at.
#[derive(Clone, Debug, Default)]
struct Candidates {
    features: Vec<[u32; 2]>,
    wakes: Sleepers,
}

impl Candidates {
    /// Takes others, which are all awake.
    fn renew(&mut self, features: &[[u32; 2]]) {
        self.features.clear();
        self.features.extend_from_slice(features);
        self.wakes.renew(features.len());
    }
}

/// The candidates of a pair that are looked at, by their numbers in a list and their features, with their closest points, and those of
/// them that touch. Pairs lend it to each other, so that it stays in the caches.
#[derive(Clone, Debug, Default)]
pub(super) struct Look {
    awake: Vec<u32>,
    features: Vec<[u32; 2]>,
    found: Vec<Found>,
    pub(super) touches: Touches,
}

impl Pair {
    pub(super) fn new(of: [usize; 2], law: Law) -> Self {
        Self { of, law, way: 0.0, until: None, ahead: 0.0, candidates: Default::default(), look: Look::default() }
    }

    /// Whether it is a surface with itself.
    pub(super) fn is_own(&self) -> bool {
        self.of[0] == self.of[1]
    }

    /// Goes on to this step. The lists are made anew if features that are not in them might touch in it.
    pub(super) fn go(&mut self, seen: &Seen<'_>) {
        let [one, other] = self.of.map(|surface| &seen.start[surface]);
        self.way += one.since.relative(other.since);
        self.reach(seen, one.ahead.relative(other.ahead));
    }

    /// Sees to it that the lists hold all that can touch where points move relative to each other by `ahead` (m).
    pub(super) fn reach(&mut self, seen: &Seen<'_>, ahead: f64) {
        self.ahead = ahead;
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
        self.candidates.iter_mut().for_each(|list| list.renew(&[]));
        let [mine, theirs] = [one, other].map(|placed| Extent::around(placed.at.iter().copied()));
        let apart = mine.distance(&theirs);
        if apart >= reach && !self.is_own() {
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
        for (at, &kind) in Kind::POINTS.iter().chain(Kind::EDGES).enumerate() {
            let sides = match kind {
                Kind::Point { of: 0 } => [&of_one[0], &of_other[1]],
                // A surface meets itself only once.
                Kind::Point { .. } if self.is_own() => continue,
                Kind::Point { .. } => [&of_other[0], &of_one[1]],
                Kind::Edges => [&of_one[2], &of_other[2]],
            };
            let mut found = Vec::new();
            sweep(sides, reach, axes, |features| found.push(features));
            if self.is_own() {
                let at: Vec<_> = one.surface.places(seen.rest).collect();
                let rest = Placed { surface: one.surface, at: &at };
                found.retain(|&features| is_free(one.surface, kind, features));
                kind.find([rest; 2], &found, &mut self.look.found);
                let mut far = self.look.found.iter().map(|found| found.distance > 2.0 * self.law.gap);
                found.retain(|_| far.next() == Some(true));
            }
            found.sort_unstable();
            self.candidates[at].renew(&found);
        }
    }

    /// Finds what touches in this step, of some kinds of features.
    pub(super) fn look(&mut self, kinds: &[Kind], seen: &Seen<'_>) {
        let Self { of, law, way, ahead, candidates, look, .. } = self;
        let Look { awake, features, found, touches } = look;
        touches.clear();
        let (placed, is_same) = (of.map(|surface| seen.placed(surface)), of[0] == of[1]);
        let shown = of.map(|surface| &seen.start[surface]);
        let (due, far) = (*way + 2.0 * *ahead, law.gap + 2.0 * *ahead);
        for &kind in kinds {
            let Candidates { features: all, wakes } = &mut candidates[kind.number()];
            wakes.awake(due, awake);
            if kind == Kind::Edges {
                // Points and facets meet where two edges are flat.
                awake.retain(|&at| {
                    let features = all[at as usize];
                    let [one, other] = [0, 1].map(|side| shown[side].stays_flat(features[side]));
                    let (Some(one), Some(other)) = (one, other) else { return true };
                    wakes.sleep(at, *way + one.min(other).max(f64::MIN_POSITIVE));
                    false
                });
            }
            features.clear();
            features.extend(awake.iter().map(|&at| all[at as usize]));
            kind.find(placed, features, found);
            for ((&at, &features), found) in awake.iter().zip(&*features).zip(&*found) {
                let distance = found.distance;
                let closest = kind.judge(placed, is_same, features, found);
                if distance >= far || closest.rests > 0.0 {
                    wakes.sleep(at, *way + closest.rests.max(distance - law.gap));
                    continue;
                }
                if distance > 0.0 {
                    touches.push(kind, *of, seen, features, &closest);
                }
                wakes.sleep(at, f64::NEG_INFINITY);
            }
        }
    }
}

/// Whether two features of a surface share no corner. Pairs of edges count once.
fn is_free(surface: &Surface, kind: Kind, [first, second]: [u32; 2]) -> bool {
    if kind == Kind::Edges && first >= second {
        return false;
    }
    let Surface { facets, edges, .. } = surface;
    let (mine, theirs) = match kind {
        Kind::Edges => (&edges[first as usize][..], &edges[second as usize][..]),
        Kind::Point { .. } => (std::slice::from_ref(&first), facets[second as usize].used()),
    };
    !mine.iter().any(|corner| theirs.contains(corner))
}
