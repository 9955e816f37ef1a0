//! Where bodies touch each other and obstacles, for pictures. It depends on positions alone.

use super::Side;
use super::features::Kind;
use super::ground::Ground;
use super::pair::Pair;
use super::rule::Touch;
use super::shown::{Seen, Shown};
use super::stage::Stage;
use super::surface::Surface;
use glam::DVec3;

/// A place where a body touches an obstacle, another body or itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// What the body touches.
    pub from: Side,
    /// The number of the body.
    pub on: usize,
    /// The place on the body (m).
    pub at: DVec3,
}

/// What touches is at most this share of the distance that is kept farther apart than that.
const SLACK: f64 = 0.1;

/// Places of a pair that are nearer than so many times the distance that is kept are one: the fifth part of a usual element.
const SAME: f64 = 8.0;

impl Stage {
    /// Where surfaces touch at a time (s), with positions of all nodes (m), in the order of pairs.
    pub(crate) fn points(&self, position: &[DVec3], time: f64) -> Vec<ContactPoint> {
        let places = self.place(position, time);
        let mut shown = vec![Shown::default(); self.surfaces.len()];
        shown.iter_mut().zip(&self.surfaces).for_each(|(shown, surface)| shown.place(surface, &places));
        let seen = self.seen(&shown, None);
        let mut pairs = Vec::new();
        self.choose(&places, 0.0, &mut pairs);
        let mut found = Vec::new();
        for pair in &mut pairs {
            self.points_of(pair, &seen, &mut found);
        }
        self.grounds.iter().for_each(|ground| ground.points(&self.surfaces, &places, time, &mut found));
        found
    }

    fn points_of(&self, pair: &mut Pair, seen: &Seen<'_>, found: &mut Vec<ContactPoint>) {
        pair.reach(seen, 0.5 * SLACK * pair.law.gap);
        let ([on, other], first) = (pair.of, found.len());
        for kinds in [Kind::POINTS, Kind::EDGES] {
            pair.look(kinds, seen);
            for (&Touch { at, .. }, _) in pair.look.touches.iter() {
                let is_new = |point: &ContactPoint| point.at.distance(at) > SAME * pair.law.gap;
                if found[first..].iter().all(is_new) {
                    found.push(ContactPoint { from: self.side(other), on, at });
                }
            }
        }
    }
}

impl Ground {
    /// Adds the points of its surface that touch it at a time (s), with positions of nodes (m).
    fn points(&self, surfaces: &[Surface], position: &[DVec3], time: f64, found: &mut Vec<ContactPoint>) {
        let (plane, points, from) = (self.plane(time), &surfaces[self.body].points, Side::Obstacle(self.number));
        let places = (0..points.len()).map(|point| points.place(point, position));
        let touching = places.filter(|&at| plane.above(at) < self.law.gap * (1.0 + SLACK));
        found.extend(touching.map(|at| ContactPoint { from, on: self.body, at }));
    }
}
