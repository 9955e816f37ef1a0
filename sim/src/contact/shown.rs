//! Surfaces at the start of a step: the places of their points, and which of their edges are flat.

use super::sleepers::Sleepers;
use super::solid::Solid;
use super::surface::{Placed, Surface};
use crate::motion::Interval;
use glam::DVec3;

/// How far the points of a surface have moved: by `drift`, and from there by at most `spread` (m).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Way {
    pub(super) drift: DVec3,
    pub(super) spread: f64,
}

impl Way {
    /// That of points from places to others.
    pub(super) fn of(from: &[DVec3], to: &[DVec3]) -> Self {
        let by = from.iter().zip(to).map(|(&from, &to)| to - from);
        // Any vector will do: the nearer it is to the mean, the less is left.
        let some = by.clone().step_by(from.len().div_ceil(8).max(1));
        let count = some.len().max(1) as f64;
        let drift = some.sum::<DVec3>() / count;
        let far = by.map(|by| by.distance_squared(drift)).fold(0.0, |most, far| if far > most { far } else { most });
        Self { drift, spread: far.sqrt() }
    }

    pub(super) fn relative(self, other: Self) -> f64 {
        (self.drift - other.drift).length() + self.spread + other.spread
    }

    pub(super) fn length(self) -> f64 {
        self.drift.length() + self.spread
    }
}

/// What pairs see of a surface.
#[derive(Clone, Debug, Default)]
pub(super) struct Shown {
    /// The places of its points (m); empty if it is in no pair.
    pub(super) points: Vec<DVec3>,
    /// How far its points have moved since the last step, and in this one.
    pub(super) since: Way,
    pub(super) ahead: Way,
    /// The way that they have moved relative to each other, at most (m).
    way: f64,
    /// For each edge, from which way on it may be flat or not otherwise than before (m).
    wakes: Sleepers,
    is_flat: Vec<bool>,
    /// Those that are looked at in this step.
    awake: Vec<u32>,
}

impl Shown {
    /// Adds what points of a surface have moved from their places at the start of the last step to those of this one, and sees where they go
    /// in it, from the places of its nodes (m).
    pub(super) fn go(&mut self, surface: &Surface, [last, start, end]: [&[DVec3]; 3]) {
        self.points.clear();
        let way = |from, to| {
            let Way { drift, spread } = Way::of(from, to);
            Way { drift, spread: surface.lever * spread }
        };
        (self.since, self.ahead) = (way(last, start), way(start, end));
        self.way += self.since.spread;
    }

    /// Takes the places of this step, from those of nodes (m).
    pub(super) fn place(&mut self, surface: &Surface, nodes: &[DVec3]) {
        let Self { points, way, wakes, is_flat, awake, .. } = self;
        points.extend(surface.places(nodes));
        if is_flat.len() != surface.edges.len() {
            is_flat.resize(surface.edges.len(), false);
            wakes.renew(surface.edges.len());
        }
        wakes.awake(*way, awake);
        for &edge in &*awake {
            let (number, place) = (edge as usize, |point: u32| points[point as usize]);
            let wings = surface.wings[number].iter().map(|&corner| place(corner));
            let bend = bend(surface.edges[number].map(place), wings);
            let stays;
            (is_flat[number], stays) = bend
                .map_or((false, f64::INFINITY), |(sine, height)| (sine < BEND, (sine - BEND).abs() * height / LEVER));
            wakes.sleep(edge, *way + stays);
        }
    }

    /// The way of its points (m) for which an edge stays flat; `None` if it is not.
    pub(super) fn stays_flat(&self, edge: u32) -> Option<f64> {
        self.is_flat[edge as usize].then(|| self.wakes.wake(edge) - self.way)
    }
}

/// What is known of a step when pairs are looked at.
#[derive(Clone, Copy)]
pub(super) struct Seen<'a> {
    /// Those of bodies, then those of obstacles with an extent.
    pub(super) surfaces: &'a [Surface],
    /// Where the nodes of bodies are at rest (m).
    pub(super) rest: &'a [DVec3],
    pub(super) solids: &'a [Solid],
    /// The surfaces at the start of the step; of those in pairs.
    pub(super) start: &'a [Shown],
    /// That of the step; `None` where it is not asked for how [round obstacles turn](super::rule::Touch::drag).
    pub(super) interval: Option<Interval>,
}

impl<'a> Seen<'a> {
    pub(super) fn placed(&self, surface: usize) -> Placed<'a> {
        Placed { surface: &self.surfaces[surface], at: &self.start[surface].points }
    }

    /// [`Solid::drag`] of a surface; zero for all that are not round obstacles.
    pub(super) fn drag(&self, surface: usize, at: DVec3, out: DVec3) -> DVec3 {
        let solid = surface.checked_sub(self.surfaces.len() - self.solids.len());
        match (solid.filter(|_| self.surfaces[surface].is_round), self.interval) {
            (Some(solid), Some(interval)) => self.solids[solid].drag(interval, at, out),
            _ => DVec3::ZERO,
        }
    }
}

/// The sine of the angle between two triangles from which on they do not continue each other.
const BEND: f64 = 0.1;

/// A way of points changes that sine by at most so many times as much as its share of the lesser height.
const LEVER: f64 = 6.0;

/// The sine of the angle between the two triangles at an edge, 1 from a right angle on, and their lesser height above it (m); `None` for an
/// edge with fewer or more triangles.
fn bend([from, to]: [DVec3; 2], mut wings: impl Iterator<Item = DVec3>) -> Option<(f64, f64)> {
    let (Some(first), Some(second), None) = (wings.next(), wings.next(), wings.next()) else { return None };
    let along = to - from;
    let [one, other] = [first, second].map(|corner| (corner - from).cross(along));
    let areas = one.length() * other.length();
    let sine = if one.dot(other) >= 0.0 || areas == 0.0 { 1.0 } else { one.cross(other).length() / areas };
    Some((sine, one.length().min(other.length()) / along.length()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_triangles_continue_each_other() {
        let edge = [DVec3::ZERO, DVec3::X];
        let of = |angle: f64| {
            let wings = [DVec3::new(0.5, -2.0, 0.0), DVec3::new(0.2, 3.0 * angle.cos(), 3.0 * angle.sin())];
            bend(edge, wings.into_iter()).expect("two triangles")
        };
        for (angle, sine) in [(0.0, 0.0), (0.05, 0.05_f64.sin()), (-0.2, 0.2_f64.sin()), (1.7, 1.0), (3.0, 1.0)] {
            let (found, height) = of(angle);
            assert!((found - sine).abs() < 1e-15 && height == 2.0, "{angle}: {found} {height}");
        }
        assert!(bend(edge, [DVec3::Y].into_iter()).is_none());
    }
}
