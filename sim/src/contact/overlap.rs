//! Bodies and obstacles that overlap or touch: contact of surfaces keeps them apart, but cannot part them.

use super::cross::{Corners, are_joined, near_facets};
use super::extent::Extent;
use super::inside::inside;
use super::shape::ROUND_OFF;
use super::stage::{Moment, Stage};
use super::surface::Placed;
use super::{Contacts, Obstacle, Side};
use crate::body::Body;
use glam::DVec3;
use std::sync::Arc;

/// Two bodies, or a body and an obstacle, that overlap, touch, or are much nearer than the distance that they keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// The two: the body with the lower number first, obstacles last. They are the same where a body crosses or touches itself.
    pub of: [Side; 2],
    /// The node of a body, among those of all bodies, that lies deepest, or nearest to the deepest place.
    pub node: usize,
    /// How far (m) the deepest point, side or facet has to move at least until it does not overlap; zero for what touches. Negative for what is
    /// so far apart.
    pub depth: f64,
    /// The distance (m) that contact keeps between the two, beside the radius of an obstacle.
    pub keeps: f64,
}

/// The surfaces of bodies and of obstacles, to ask what overlaps.
#[derive(Clone, Debug)]
pub struct Surfaces {
    pub(super) stage: Stage,
    pub(super) bodies: Vec<Arc<Body>>,
    pub(super) obstacles: Vec<Obstacle>,
}

/// What lies deepest of a pair: how deep (m), negative where it is apart, and a point of one of the two surfaces.
#[derive(Clone, Copy, Debug)]
struct Deepest {
    depth: f64,
    side: usize,
    point: u32,
}

impl Surfaces {
    /// The surfaces of bodies, whose nodes are numbered one body after the other, and of obstacles, which meet as `contacts` says.
    pub fn new(bodies: &[Arc<Body>], obstacles: &[Obstacle], contacts: &Contacts) -> Self {
        let stage = Stage::new(contacts, bodies, obstacles);
        Self { stage, bodies: bodies.to_vec(), obstacles: obstacles.to_vec() }
    }

    /// What overlaps or touches among the pairs that are `wanted`, in order, with positions of all nodes (m), and obstacles as they are
    /// at a time (s). What is nearer than nine tenths of the distance that it keeps counts, too: contact would throw it apart. What touches a round
    /// obstacle or a half-space does not count: the way out is known there.
    pub fn overlaps(&self, position: &[DVec3], time: f64, wanted: impl Fn([Side; 2]) -> bool) -> Vec<Overlap> {
        const NEAR: f64 = 0.9;
        let stage = &self.stage;
        let moment = stage.moment(position, time);
        let mut found = Vec::new();
        for one in 0..self.bodies.len() {
            for other in one..stage.surfaces.len() {
                let of = [one, other].map(|number| stage.side(number));
                let [mine, theirs] = [one, other].map(|number| stage.placed(&moment, number));
                let (round, keeps) = (round_off(&moment, [one, other]), stage.gap(one, other));
                let is_round = theirs.surface.radius() > 0.0;
                let reach = if is_round || one == other { round } else { round.max(NEAR * keeps) };
                if moment.distance([one, other]) > theirs.surface.radius() + reach
                    || !wanted(of)
                    || stage.law(one, other).is_none()
                {
                    continue;
                }
                let deepest =
                    if one == other { meeting_itself(mine, round) } else { deepest([mine, theirs], round, reach) };
                let least = if is_round { round } else { -reach };
                found.extend(deepest.filter(|deepest| deepest.depth > least).map(|Deepest { depth, side, point }| {
                    let node = match side {
                        0 => self.node(one, point),
                        _ if other < self.bodies.len() => self.node(other, point),
                        // Beside a point of an obstacle.
                        _ => self.node(one, nearest(mine, theirs.at[point as usize])),
                    };
                    let depth = if depth.abs() > round { depth } else { 0.0 };
                    Overlap { of, node, depth, keeps }
                }));
            }
            found.extend(self.below(one, position, &moment, time).into_iter().filter(|overlap| wanted(overlap.of)));
        }
        found
    }

    /// The half-spaces that a body reaches into: with its carried surface, or its nodes.
    fn below(&self, body: usize, position: &[DVec3], moment: &Moment, time: f64) -> Vec<Overlap> {
        let first: usize = self.bodies[..body].iter().map(|body| body.len()).sum();
        let is_carried = self.bodies[body].carried.is_some();
        let nodes = &position[first..first + self.bodies[body].len()];
        let points = if is_carried { &moment.at[body][..] } else { nodes };
        let below = self.obstacles.iter().enumerate().filter_map(|(number, obstacle)| {
            let (normal, height) = obstacle.half_space(time)?;
            let (point, depth) = self.deepest_below(body, points, normal, height)?;
            let node = if is_carried { self.node(body, point as u32) } else { first + point };
            Some(Overlap { of: [Side::Body(body), Side::Obstacle(number)], node, depth, keeps: 0.0 })
        });
        below.collect()
    }

    /// The point of a body that lies deepest in a half-space, and its depth (m); `None` if it reaches into it by round-off at most.
    pub(super) fn deepest_below(
        &self,
        body: usize,
        points: &[DVec3],
        normal: DVec3,
        height: f64,
    ) -> Option<(usize, f64)> {
        /// The depth that rounding may leave of a body that was set on a half-space, in body sizes.
        const TOUCHING: f64 = 1e-9;
        let depths = points.iter().map(|&point| height - normal.dot(point)).enumerate();
        let deepest = depths.reduce(|deepest, this| if this.1 > deepest.1 { this } else { deepest });
        deepest.filter(|&(_, depth)| depth > TOUCHING * self.bodies[body].extent())
    }

    /// The node that a point of a body follows most.
    fn node(&self, surface: usize, point: u32) -> usize {
        let (nodes, weights) = self.stage.surfaces[surface].points.of(point as usize);
        let most = |best: usize, at: usize| if weights[at] > weights[best] { at } else { best };
        self.stage.nodes[nodes[(0..nodes.len()).fold(0, most)] as usize] as usize
    }
}

/// The distance (m) that is round-off between two surfaces.
fn round_off(moment: &Moment, of: [usize; 2]) -> f64 {
    /// Positions that were turned or moved have errors of some roundings.
    const SEVERAL: f64 = 16.0;
    SEVERAL * ROUND_OFF * of.map(|number| moment.extents[number].farthest()).into_iter().fold(0.0, f64::max)
}

/// Whether two surfaces are nearer than a distance (m) above zero, or overlap.
pub(super) fn is_nearer(of: [Placed<'_>; 2], reach: f64) -> bool {
    let radius = of[1].surface.radius();
    let is_near = |&facets: &[u32; 2]| between(of, facets, radius).depth > -reach;
    near_facets(of, radius + reach).iter().any(is_near)
        || !inside(of[0].at, of[1]).is_empty()
        || !inside(of[1].at, of[0]).is_empty()
}

/// The deepest place of a surface that crosses or touches itself.
fn meeting_itself(of: Placed<'_>, round: f64) -> Option<Deepest> {
    let pairs = near_facets([of; 2], round).into_iter();
    let apart = pairs.filter(|&[first, second]| first < second && !are_joined(of, [first, second]));
    apart.map(|facets| between([of; 2], facets, 0.0)).filter(|deepest| deepest.depth >= -round).reduce(deeper)
}

/// What lies deepest of two surfaces, if they are nearer than a reach (m). Depths are equal to a round-off (m).
fn deepest(of: [Placed<'_>; 2], round: f64, reach: f64) -> Option<Deepest> {
    let radius = of[1].surface.radius();
    let facets = near_facets(of, radius + reach).into_iter().map(|facets| between(of, facets, radius));
    let near = facets.filter(|deepest| deepest.depth >= -reach).reduce(deeper);
    let within = [[0, 1], [1, 0]].into_iter().filter_map(|sides| deepest_point(of, sides, radius));
    let within = within.reduce(deeper);
    // Of a point and facets that are equally deep, the point is told.
    let found = match (within, near) {
        (Some(within), Some(near)) if near.depth <= within.depth + round => Some(within),
        (within, near) => near.or(within),
    };
    found.filter(|found| found.depth > round).or_else(|| deepest_middle(of)).or(found)
}

/// The point of a surface that is nearest to a place.
fn nearest(of: Placed<'_>, place: DVec3) -> u32 {
    let nearest = (0u32..)
        .zip(of.at)
        .min_by(|(_, one), (_, other)| one.distance_squared(place).total_cmp(&other.distance_squared(place)));
    nearest.map_or(0, |(point, _)| point)
}

fn deeper(one: Deepest, other: Deepest) -> Deepest {
    if other.depth > one.depth { other } else { one }
}

/// How deep two facets lie in each other, at a corner of the first one; the second one has a radius (m).
fn between(of: [Placed<'_>; 2], [first, second]: [u32; 2], radius: f64) -> Deepest {
    let (mine, theirs) = (Corners::of(of[0], first), Corners::of(of[1], second));
    let distance = mine.distance(&theirs);
    let depth = match mine.crosses(&theirs) {
        true => radius + distance,
        false => radius - distance,
    };
    let corners = of[0].used(first).iter().zip(mine.all());
    let nearest =
        corners.min_by(|(_, one), (_, other)| theirs.distance_to(**one).total_cmp(&theirs.distance_to(**other)));
    Deepest { depth, side: 0, point: nearest.map_or(0, |(&corner, _)| corner) }
}

/// The point of a surface that lies deepest inside another one.
fn deepest_point(of: [Placed<'_>; 2], [one, other]: [usize; 2], radius: f64) -> Option<Deepest> {
    let points = inside(of[one].at, of[other]);
    let depths = points.into_iter().map(|point| {
        let (distance, _) = to_surface(of[other], of[one].at[point as usize]);
        Deepest { depth: radius + distance, side: one, point }
    });
    depths.reduce(deeper)
}

/// The distance (m) of a point from the facets that bound a surface, and the nearest one.
fn to_surface(of: Placed<'_>, point: DVec3) -> (f64, u32) {
    let mut best = (f64::INFINITY, 0);
    for &facet in &of.surface.bounding {
        let corners = Corners::of(of, facet);
        if Extent::around(corners.all().iter().copied()).distance(&Extent::around(std::iter::once(point))) < best.0 {
            let distance = corners.distance_to(point);
            best = if distance < best.0 { (distance, facet) } else { best };
        }
    }
    best
}

/// The deepest middle of a facet, or place under it, that lies inside both of two surfaces. Where bodies with equal faces overlap, no point
/// of one need be inside the other: equal bodies at one place touch everywhere.
fn deepest_middle(of: [Placed<'_>; 2]) -> Option<Deepest> {
    /// How far under a facet, as a share of its sides.
    const UNDER: [f64; 2] = [0.0, 0.2];
    let found = [[0, 1], [1, 0]].into_iter().flat_map(|[one, other]| {
        let (mine, theirs) = (of[one], of[other]);
        UNDER.into_iter().filter_map(move |under| {
            let places: Vec<_> =
                mine.surface.bounding.iter().map(|&facet| Corners::of(mine, facet).under(under)).collect();
            let own = (under > 0.0).then(|| inside(&places, mine));
            let is_own = |place: &u32| own.as_ref().is_none_or(|own| own.binary_search(place).is_ok());
            let both = inside(&places, theirs).into_iter().filter(is_own);
            let depths = both.map(|at| {
                let (depth, facet) = to_surface(theirs, places[at as usize]);
                let facet = if one == 0 { mine.surface.bounding[at as usize] } else { facet };
                Deepest { depth, side: 0, point: of[0].used(facet)[0] }
            });
            depths.reduce(deeper)
        })
    });
    found.reduce(deeper)
}
