//! Two surfaces that may meet: lists of their features that are near each other, and what of them touches in a step.

use super::closest::{self, On};
use super::rule::{Law, Term, Timing, Touch};
use super::surface::{Facet, Surface};
use crate::carried::Weights;
use glam::DVec3;

/// Features of two surfaces in their order, and from which [`Pair::way`] on each of them is looked at (m).
#[derive(Clone, Debug, Default)]
struct Candidates {
    features: Vec<[u32; 2]>,
    wakes: Vec<f64>,
    /// The least of each [`Self::BLOCK`].
    least: Vec<f64>,
}

impl Candidates {
    /// So many are passed over at once where all of them rest.
    const BLOCK: usize = 16;

    /// Takes others, which are all awake.
    fn renew(&mut self, features: impl Iterator<Item = [u32; 2]>) {
        self.features.clear();
        self.features.extend(features);
        let count = self.features.len();
        for (list, len) in [(&mut self.wakes, count), (&mut self.least, count.div_ceil(Self::BLOCK))] {
            list.clear();
            list.resize(len, f64::NEG_INFINITY);
        }
    }

    /// Calls `look` with those that are awake at a way (m), in order. It returns when each wakes next.
    fn for_each_awake(&mut self, way: f64, mut look: impl FnMut([u32; 2]) -> f64) {
        let blocks = self.wakes.chunks_mut(Self::BLOCK).zip(self.features.chunks(Self::BLOCK));
        for (least, (wakes, features)) in self.least.iter_mut().zip(blocks).filter(|(least, _)| **least <= way) {
            for (wake, features) in wakes.iter_mut().zip(features).filter(|(wake, _)| **wake <= way) {
                *wake = look(*features);
            }
            *least = wakes.iter().fold(f64::INFINITY, |least, &wake| least.min(wake));
        }
    }
}

/// The kinds of features that meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// A point of the first surface and a facet of the second.
    PointFacet,
    /// A facet of the first and a point of the second.
    FacetPoint,
    Edges,
}

const KINDS: [Kind; 3] = [Kind::PointFacet, Kind::FacetPoint, Kind::Edges];

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
}

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

/// What is known of a step when pairs are looked at.
#[derive(Clone, Copy)]
pub(super) struct Seen<'a> {
    pub(super) surfaces: &'a [Surface],
    /// Nodes at rest (m), for bodies that meet themselves.
    pub(super) rest: Places<'a>,
    /// The points of each surface at the start of the step (m); of those in pairs.
    pub(super) start: &'a [Vec<DVec3>],
    /// All nodes then.
    pub(super) nodes: Places<'a>,
    /// At the end of the step, before contact.
    pub(super) end: Places<'a>,
    /// The velocities at the start and at the end (m/s).
    pub(super) velocity: [Places<'a>; 2],
    pub(super) inverse_mass: &'a [f64],
    /// See [`Touch::drag`]: for a surface, a point on its axis (m), and the way from there to its surface (m).
    pub(super) drag: &'a dyn Fn(usize, DVec3, DVec3) -> DVec3,
    pub(super) timing: Timing,
}

impl<'a> Seen<'a> {
    fn placed(&self, surface: usize) -> Placed<'a> {
        Placed { surface: &self.surfaces[surface], at: &self.start[surface] }
    }
}

/// What touches in a step: first points with facets, then edges, each in the order of pairs and features.
#[derive(Clone, Debug, Default)]
pub(super) struct Touches {
    pub(super) of_points: Vec<Touch>,
    pub(super) of_edges: Vec<Touch>,
    pub(super) terms: Vec<Term>,
}

impl Touches {
    pub(super) fn clear(&mut self) {
        self.of_points.clear();
        self.of_edges.clear();
        self.terms.clear();
    }
}

/// A surface with the places of its points (m).
#[derive(Clone, Copy)]
struct Placed<'a> {
    surface: &'a Surface,
    at: &'a [DVec3],
}

impl Placed<'_> {
    fn point(&self, point: u32) -> DVec3 {
        self.at[point as usize]
    }
}

/// Two closest points, each as weighted points of its surface.
struct Closest {
    way: DVec3,
    /// For each of the two surfaces its points and their shares. Points with a share of zero belong to the feature as well.
    shares: [[(u32, f64); 3]; 2],
    /// Zero for a contact: a local minimum of the distance that no other feature counts. Otherwise how far points of the features have to move
    /// at least (m) until it can be one.
    rests: f64,
}

/// A way of one point changes what depends on lengths of features by at most so many times as much.
const LEVER: f64 = 6.0;

impl Pair {
    pub(super) fn new(of: [usize; 2], law: Law) -> Self {
        Self { of, law, way: 0.0, until: None, candidates: Default::default() }
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
        let axis = common.longest_axis();
        for (at, kind) in KINDS.into_iter().enumerate() {
            let sides = match kind {
                Kind::PointFacet => [&of_one[0], &of_other[1]],
                // A surface meets itself only once.
                Kind::FacetPoint if self.of[0] == self.of[1] => continue,
                Kind::FacetPoint => [&of_one[1], &of_other[0]],
                Kind::Edges => [&of_one[2], &of_other[2]],
            };
            let mut found = Vec::new();
            sweep(sides, reach, axis, |features| found.push(features));
            if self.of[0] == self.of[1] {
                let points = 0..one.surface.points.len() as u32;
                let at: Vec<DVec3> = points.map(|point| seen.rest.point(&one.surface.points, point)).collect();
                let rest = Placed { surface: one.surface, at: &at };
                found.retain(|&features| is_apart_at_rest(rest, kind, features, 2.0 * self.law.gap));
            }
            found.sort_unstable();
            self.candidates[at].renew(found.into_iter());
        }
    }

    /// Adds what touches in this step to `touches`.
    pub(super) fn look(&mut self, seen: &Seen<'_>, ahead: f64, touches: &mut Touches) {
        let Self { of, law, way, candidates, .. } = self;
        let [one, other] = of.map(|surface| seen.placed(surface));
        let due = *way + 2.0 * ahead;
        for (kind, list) in KINDS.into_iter().zip(candidates) {
            list.for_each_awake(due, |features| {
                let closest = closest(kind, [one, other], of[0] == of[1], features);
                let distance = closest.way.length();
                if distance >= law.gap + 2.0 * ahead || closest.rests > 0.0 {
                    return *way + closest.rests.max(distance - law.gap);
                }
                if distance > 0.0 {
                    touches.push(kind, *of, [one.surface, other.surface], *law, &closest, distance, ahead, seen);
                }
                f64::NEG_INFINITY
            });
        }
    }
}

impl Touches {
    /// Adds a pair of closest points, if it may come nearer than its gap in this step.
    #[expect(clippy::too_many_arguments, reason = "the parts of one pair")]
    fn push(
        &mut self,
        kind: Kind,
        of: [usize; 2],
        surfaces: [&Surface; 2],
        law: Law,
        closest: &Closest,
        distance: f64,
        ahead: f64,
        seen: &Seen<'_>,
    ) {
        let first = self.terms.len();
        for (surface, (shares, sign)) in surfaces.into_iter().zip(closest.shares.iter().zip([1.0, -1.0])) {
            for &(point, share) in shares {
                let (nodes, weights) = surface.points.of(point as usize);
                for (&node, &weight) in nodes.iter().zip(weights) {
                    let weight = sign * share * weight;
                    match self.terms[first..].iter_mut().find(|term| term.node == node) {
                        Some(term) => term.weight += weight,
                        None => self.terms.push(Term { node, weight }),
                    }
                }
            }
        }
        let terms = &self.terms[first..];
        let inverse = |node: u32| seen.inverse_mass.get(node as usize).copied().unwrap_or(0.0);
        let mobility: f64 = terms.iter().map(|term| term.weight * term.weight * inverse(term.node)).sum();
        let normal = closest.way / distance;
        let along = |places: &Places<'_>| {
            normal.dot(terms.iter().map(|term| places.node(term.node) * term.weight).sum::<DVec3>())
        };
        if mobility == 0.0 || along(&seen.end) >= law.gap + ahead {
            self.terms.truncate(first);
            return;
        }
        let change = along(&seen.velocity[0]) - along(&seen.velocity[1]);
        let [to_rebound, to_path] = seen.timing.lags().map(|lag| lag * change);
        let there = terms.iter().filter(|term| term.weight < 0.0);
        let there: DVec3 = there.map(|term| seen.nodes.node(term.node) * -term.weight).sum();
        let drag = (seen.drag)(of[1], there, normal * surfaces[1].thickness);
        let terms = [first, self.terms.len()].map(|at| at as u32);
        let list = if kind == Kind::Edges { &mut self.of_edges } else { &mut self.of_points };
        list.push(Touch { law, normal, distance, mobility, drag, to_rebound, to_path, terms });
    }
}

/// The closest points of two features.
fn closest(kind: Kind, [one, other]: [Placed<'_>; 2], is_same: bool, features: [u32; 2]) -> Closest {
    match kind {
        Kind::PointFacet => point_facet([one, other], features, true, is_same),
        Kind::FacetPoint => {
            let [facet, point] = features;
            let Closest { way, shares: [first, second], rests } =
                point_facet([other, one], [point, facet], false, is_same);
            Closest { way: -way, shares: [second, first], rests }
        }
        Kind::Edges => edges([one, other], features),
    }
}

/// `counts_corners`: whether two points that meet are counted here, and not from the other side.
fn point_facet(
    [one, other]: [Placed<'_>; 2],
    [point, facet]: [u32; 2],
    counts_corners: bool,
    is_same: bool,
) -> Closest {
    let Placed { surface, .. } = other;
    let facet = &surface.facets[facet as usize];
    let place = |corner: u32| other.point(corner);
    let (here, corners) = (one.point(point), facet.corners.map(place));
    let nearest = match facet.count {
        3 => closest::of_triangle(here, corners),
        2 => closest::of_segment(here, [corners[0], corners[1]]),
        _ => closest::Nearest { shares: [1.0, 0.0, 0.0], on: On::Corner(0) },
    };
    let there: DVec3 = corners.iter().zip(nearest.shares).map(|(&corner, share)| corner * share).sum();
    let way = here - there;
    // How far the point has to move until another part of the facet is the nearest.
    let leaves = |on: &[usize]| {
        let others = corners[..facet.count as usize].iter().enumerate().filter(|(corner, _)| !on.contains(corner));
        let inwards = others.map(|(_, &corner)| -closest::along(way, corner - there));
        on.iter()
            .filter(|_| on.len() > 1)
            .map(|&end| corners[end].distance(there))
            .chain(inwards)
            .fold(f64::INFINITY, f64::min)
    };
    let rest = |counts: bool, towards: f64, on: &[usize]| match counts {
        true if towards <= 0.0 => 0.0,
        true => (towards.min(leaves(on)) / LEVER).max(f64::MIN_POSITIVE),
        false => (leaves(on) / LEVER).max(f64::MIN_POSITIVE),
    };
    let rests = match nearest.on {
        On::Inside => 0.0,
        On::Side(side) => {
            let wings = &surface.wings[facet.sides[side] as usize];
            let towards = closest::towards(way, there, wings.iter().map(|&corner| place(corner)));
            rest(facet.owns_sides[side], towards, &[side, (side + 1) % 3])
        }
        On::Corner(corner) => {
            let number = facet.corners[corner] as usize;
            let is_first = counts_corners && (!is_same || (point as usize) < number);
            let towards = closest::towards(way, there, surface.rings[number].iter().map(|&corner| place(corner)));
            rest(is_first && facet.owns_corners[corner], towards, &[corner])
        }
    };
    let shares = [0, 1, 2].map(|corner| (facet.corners[corner], nearest.shares[corner]));
    Closest { way, shares: [[(point, 1.0), (point, 0.0), (point, 0.0)], shares], rests }
}

/// Edges that cross each other. Two that are both flat do not count: points and facets meet there.
fn edges([one, other]: [Placed<'_>; 2], [first, second]: [u32; 2]) -> Closest {
    /// The least squared sine of the angle between them: parallel edges meet with their ends.
    const LEAST_SINE: f64 = 1e-6;
    let ends = [(one, first), (other, second)].map(|(placed, edge)| placed.surface.edges[edge as usize]);
    let [mine, theirs] = [(one, ends[0]), (other, ends[1])].map(|(placed, ends)| ends.map(|end| placed.point(end)));
    let [s, t] = closest::of_segments(mine, theirs);
    let (here, there) = (mine[0].lerp(mine[1], s), theirs[0].lerp(theirs[1], t));
    let way = here - there;
    let along = [mine[1] - mine[0], theirs[1] - theirs[0]];
    let sine = along[0].cross(along[1]).length_squared() / (along[0].length_squared() * along[1].length_squared());
    let of = |placed: Placed<'_>, edge: u32, from: DVec3, way: DVec3, along: DVec3| {
        let wings = &placed.surface.wings[edge as usize];
        let around = wings.iter().map(|&corner| placed.point(corner));
        (closest::towards(way, from, around.clone()), flat_for(along, from, around))
    };
    let [(my_way, my_flat), (their_way, their_flat)] =
        [of(one, first, here, -way, along[0]), of(other, second, there, way, along[1])];
    let is_inside = |share: f64| share > 0.0 && share < 1.0;
    let beyond = if is_inside(s) && is_inside(t) && sine > LEAST_SINE {
        my_way.max(their_way).max(0.0)
    } else {
        past_ends(mine, theirs, sine).max(f64::MIN_POSITIVE)
    };
    let rests = beyond.max(my_flat.min(their_flat)) / LEVER;
    let share = |[a, b]: [u32; 2], share: f64| [(a, 1.0 - share), (b, share), (b, 0.0)];
    Closest { way, shares: [share(ends[0], s), share(ends[1], t)], rests }
}

/// How far the ends of two segments have to move (m) until their lines are closest between them; zero if nearly parallel. `sine` is the squared
/// one of their angle, by which ways grow to those of the closest points.
fn past_ends([a, b]: [DVec3; 2], [c, d]: [DVec3; 2], sine: f64) -> f64 {
    let (one, other, from) = (b - a, d - c, a - c);
    let (aa, cc, ac) = (one.length_squared(), other.length_squared(), one.dot(other));
    let s = (ac * other.dot(from) - one.dot(from) * cc) / (aa * cc * sine);
    let t = (ac * s + other.dot(from)) / cc;
    let past = |share: f64, squared: f64| (-share).max(share - 1.0) * squared.sqrt();
    let past = past(s, aa).max(past(t, cc)).min(aa.min(cc).sqrt());
    if past > 0.0 { 0.5 * past * sine } else { 0.0 }
}

/// How far a corner has to move (m) until two triangles do not continue each other at an edge; zero if they do not.
fn flat_for(along: DVec3, from: DVec3, mut wings: impl Iterator<Item = DVec3>) -> f64 {
    /// The sine of the angle between them from which on they do not.
    const BEND: f64 = 0.1;
    let (Some(first), Some(second), None) = (wings.next(), wings.next(), wings.next()) else { return 0.0 };
    let [one, other] = [first, second].map(|corner| (corner - from).cross(along));
    let bend = one.cross(other).length() / (one.length() * other.length());
    if one.dot(other) >= 0.0 || bend >= BEND || bend.is_nan() {
        return 0.0;
    }
    (BEND - bend) * one.length().min(other.length()) / along.length()
}

/// Whether two features of a surface share no node and are at rest farther from each other than a distance (m).
fn is_apart_at_rest(rest: Placed<'_>, kind: Kind, [first, second]: [u32; 2], far: f64) -> bool {
    if kind == Kind::Edges && first >= second {
        return false;
    }
    let Placed { surface, .. } = rest;
    let nodes = |points: &[u32]| {
        points.iter().flat_map(|&point| surface.points.of(point as usize).0).copied().collect::<Vec<_>>()
    };
    let (mine, theirs) = match kind {
        Kind::Edges => (nodes(&surface.edges[first as usize]), nodes(&surface.edges[second as usize])),
        _ => (nodes(&[first]), nodes(surface.facets[second as usize].used())),
    };
    let is_joined = mine.iter().any(|node| theirs.contains(node));
    !is_joined && closest(kind, [rest; 2], true, [first, second]).way.length() > far
}

impl Facet {
    /// The corners that count.
    pub(super) fn used(&self) -> &[u32] {
        &self.corners[..self.count as usize]
    }
}

/// A box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    low: DVec3,
    high: DVec3,
}

impl Extent {
    /// The box around all points of a surface.
    pub(super) fn of(surface: &Surface, at: &Places<'_>) -> Self {
        Self::around(surface.nodes.iter().map(|&node| at.node(node)))
    }

    fn around(points: impl Iterator<Item = DVec3>) -> Self {
        let none = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
        points.fold(none, |Self { low, high }, point| Self { low: low.min(point), high: high.max(point) })
    }

    pub(super) fn grown(self, by: f64) -> Self {
        Self { low: self.low - by, high: self.high + by }
    }

    fn common(&self, other: &Self) -> Self {
        Self { low: self.low.max(other.low), high: self.high.min(other.high) }
    }

    fn meets(&self, other: &Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }

    /// The distance between two boxes (m).
    pub(super) fn distance(&self, other: &Self) -> f64 {
        (self.low - other.high).max(other.low - self.high).max(DVec3::ZERO).length()
    }

    pub(super) fn size(&self) -> DVec3 {
        self.high - self.low
    }

    fn longest_axis(&self) -> usize {
        let size = self.size();
        (1..3).fold(0, |best, axis| if size[axis] > size[best] { axis } else { best })
    }

    pub(super) fn begins(&self) -> f64 {
        self.low.x
    }

    pub(super) fn ends(&self) -> f64 {
        self.high.x
    }
}

/// The features whose boxes meet a box.
fn near(features: impl Iterator<Item = (u32, Extent)>, common: &Extent) -> Vec<(u32, Extent)> {
    features.filter(|(_, extent)| extent.meets(common)).collect()
}

/// Calls `found` with the features whose boxes are nearer than a reach (m) along each axis, by a sweep along one.
fn sweep([one, other]: [&Vec<(u32, Extent)>; 2], reach: f64, axis: usize, mut found: impl FnMut([u32; 2])) {
    let mut sorted = other.clone();
    sorted.sort_by(|a, b| a.1.low[axis].total_cmp(&b.1.low[axis]));
    let widest = sorted.iter().map(|(_, extent)| extent.high[axis] - extent.low[axis]).fold(0.0, f64::max);
    for (first, extent) in one {
        let grown = extent.grown(reach);
        let from = sorted.partition_point(|(_, other)| other.low[axis] < grown.low[axis] - widest);
        let beside = sorted[from..].iter().take_while(|(_, other)| other.low[axis] <= grown.high[axis]);
        beside.filter(|(_, other)| grown.meets(other)).for_each(|(second, _)| found([*first, *second]));
    }
}
