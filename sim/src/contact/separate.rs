//! Bodies that overlap are moved apart before the start.

use super::Side;
use super::cross::{Corners, near_facets};
use super::overlap::{Surfaces, is_nearer};
use super::stage::Moment;
use super::surface::Placed;
use glam::DVec3;

/// The most directions in which a way is sought for a body.
const MOST: usize = 24;

impl Surfaces {
    /// Moves bodies that overlap or touch others, or obstacles as they are at a time (s), as wholes to where they keep their distances, with
    /// positions of all nodes (m). Returns the way of each body (m).
    ///
    /// The first body of a pair stays, and obstacles stay. A body goes along a straight line: an axis, a normal of what it overlaps, or the
    /// line between both middles, whichever way is the shortest. Only bodies of pairs that meet are moved: `meets` tells which. A body for
    /// which there is no way stays.
    pub fn separate(&self, position: &mut [DVec3], time: f64, meets: impl Fn([usize; 2]) -> bool) -> Vec<DVec3> {
        let mut ways = vec![DVec3::ZERO; self.bodies.len()];
        for body in 0..self.bodies.len() {
            let is_wanted = |of: [Side; 2]| match of {
                [Side::Body(one), Side::Body(other)] => one != other && other == body && meets([one, other]),
                [Side::Body(one), Side::Obstacle(_)] => one == body,
                _ => false,
            };
            if self.overlaps(position, time, is_wanted).is_empty() {
                continue;
            }
            let moment = self.stage.moment(position, time);
            let earlier = (0..body).filter(|&other| meets([other, body]));
            let others: Vec<_> = earlier.chain(self.bodies.len()..self.stage.surfaces.len()).collect();
            let Some(way) = (Search { of: self, moment: &moment, body, others, time }).way() else { continue };
            ways[body] = way;
            let first: usize = self.bodies[..body].iter().map(|body| body.len()).sum();
            position[first..first + self.bodies[body].len()].iter_mut().for_each(|node| *node += way);
        }
        ways
    }
}

/// The search for the way of a body out of others.
struct Search<'a> {
    of: &'a Surfaces,
    moment: &'a Moment,
    body: usize,
    /// Surfaces that stay.
    others: Vec<usize>,
    time: f64,
}

impl Search<'_> {
    /// The shortest way on which the body becomes free.
    fn way(&self) -> Option<DVec3> {
        let mut best: Option<(f64, DVec3)> = None;
        for direction in self.directions() {
            let most = best.map_or(f64::INFINITY, |(length, _)| length);
            let length = self.length(direction, most).filter(|length| *length < most);
            best = length.map(|length| (length, direction)).or(best);
        }
        best.map(|(length, direction)| direction * length)
    }

    /// The length (m) of a way in a direction after which the body is free; `None` if it is not shorter than `most`.
    fn length(&self, direction: DVec3, most: f64) -> Option<f64> {
        /// To which share of the distance that is kept the length is found.
        const FINE: f64 = 1e-3;
        /// To which share of itself at least.
        const ROUND: f64 = 1e-9;
        /// The most bodies and obstacles that are passed one after the other.
        const PASSED: usize = 64;
        let (mut least, mut length) = (0.0, 0.0);
        for _ in 0..PASSED {
            let met = self.exit(direction, length);
            if met <= length {
                break;
            }
            (least, length) = (length, met);
            if least >= most || length == f64::INFINITY {
                return None;
            }
        }
        if self.exit(direction, length) > length {
            return None;
        }
        let fine = FINE * 2.0 * self.of.stage.surfaces[self.body].thickness;
        while length - least > fine.max(ROUND * length) {
            let middle = 0.5 * (least + length);
            if self.exit(direction, middle) > middle {
                least = middle
            } else {
                length = middle
            }
            if least >= most {
                return None;
            }
        }
        Some(length)
    }

    /// How far the body has to go in a direction to be beyond all that is too near after a length (m); that length if nothing is.
    fn exit(&self, direction: DVec3, length: f64) -> f64 {
        /// The least sine between a way and a half-space.
        const LEAST_RISE: f64 = 1e-3;
        let at: Vec<_> = self.mine().at.iter().map(|&point| point + direction * length).collect();
        let moved = Placed { at: &at, ..self.mine() };
        let last = |points: &[DVec3]| points.iter().fold(f64::NEG_INFINITY, |most, at| most.max(direction.dot(*at)));
        let back = self.mine().at.iter().fold(f64::INFINITY, |least, at| least.min(direction.dot(*at)));
        let mut exit = length;
        for &other in &self.others {
            let (theirs, gap) = (self.of.stage.placed(self.moment, other), self.of.stage.gap(self.body, other));
            if is_nearer([moved, theirs], gap) {
                // With a reserve for round-off.
                exit = exit.max((last(theirs.at) - back + theirs.surface.radius() + gap) * (1.0 + 1e-12));
            }
        }
        for obstacle in &self.of.obstacles {
            let Some((normal, height)) = obstacle.half_space(self.time) else { continue };
            if let Some((_, depth)) = self.of.deepest_below(self.body, &at, normal, height) {
                let rise = normal.dot(direction);
                exit = exit.max(if rise > LEAST_RISE { length + depth / rise } else { f64::INFINITY });
            }
        }
        exit
    }

    fn mine(&self) -> Placed<'_> {
        self.of.stage.placed(self.moment, self.body)
    }

    /// Unit vectors along which a way may lead: axes, normals of what the body overlaps, and lines from middle to middle.
    fn directions(&self) -> Vec<DVec3> {
        let axes = if self.of.bodies[self.body].dimension() == crate::Dimension::Plane { 2 } else { 3 };
        let mut all: Vec<_> = DVec3::AXES[..axes].iter().flat_map(|&axis| [axis, -axis]).collect();
        let mut add = |direction: DVec3| {
            let is_new = |known: &DVec3| known.dot(direction) < 1.0 - 1e-6;
            if direction.is_finite() && all.len() < MOST && all.iter().all(is_new) {
                all.push(direction);
            }
        };
        for obstacle in &self.of.obstacles {
            if let Some((normal, _)) = obstacle.half_space(self.time) {
                add(normal);
            }
        }
        for &other in &self.others {
            let (mine, theirs) = (self.mine(), self.of.stage.placed(self.moment, other));
            if !is_nearer([mine, theirs], self.of.stage.gap(self.body, other)) {
                continue;
            }
            let [here, there] = [self.body, other].map(|surface| self.moment.extents[surface].middle());
            add((here - there).normalize());
            for [first, second] in near_facets([mine, theirs], theirs.surface.radius()) {
                add(Corners::of(theirs, second).normal());
                add(-Corners::of(mine, first).normal());
            }
        }
        all
    }
}
