//! Surfaces at the start of a step: the places of their points, and which of their edges are flat.

use super::features::Placed;
use super::places::Places;
use super::surface::Surface;
use glam::DVec3;

/// What pairs see of a surface.
#[derive(Clone, Debug, Default)]
pub(super) struct Shown {
    /// The places of its points (m); empty if it is in no pair.
    pub(super) points: Vec<DVec3>,
    /// The way that its points have moved relative to each other, at most (m).
    way: f64,
    /// For each edge, from which way on it may be flat or not otherwise than before (m).
    wakes: Vec<f64>,
    is_flat: Vec<bool>,
}

impl Shown {
    /// Adds the way since the last step (m).
    pub(super) fn go(&mut self, way: f64) {
        self.points.clear();
        self.way += way;
    }

    /// Forgets what was known of edges.
    pub(super) fn forget(&mut self) {
        self.wakes.clear();
        self.is_flat.clear();
    }

    /// Takes the places of this step.
    pub(super) fn place(&mut self, surface: &Surface, at: &Places<'_>) {
        if !self.points.is_empty() {
            return;
        }
        let Self { points, way, wakes, is_flat } = self;
        points.extend((0..surface.points.len() as u32).map(|point| at.point(&surface.points, point)));
        wakes.resize(surface.edges.len(), f64::NEG_INFINITY);
        is_flat.resize(surface.edges.len(), false);
        for (edge, wake) in wakes.iter_mut().enumerate().filter(|(_, wake)| **wake <= *way) {
            let place = |point: u32| points[point as usize];
            let bend = bend(surface.edges[edge].map(place), surface.wings[edge].iter().map(|&corner| place(corner)));
            let stays;
            (is_flat[edge], stays) = bend
                .map_or((false, f64::INFINITY), |(sine, height)| (sine < BEND, (sine - BEND).abs() * height / LEVER));
            *wake = *way + stays;
        }
    }

    /// The way of its points (m) for which an edge stays flat; `None` if it is not.
    pub(super) fn stays_flat(&self, edge: u32) -> Option<f64> {
        self.is_flat[edge as usize].then(|| self.wakes[edge as usize] - self.way)
    }
}

/// What is known of a step when pairs are looked at.
#[derive(Clone, Copy)]
pub(super) struct Seen<'a> {
    pub(super) surfaces: &'a [Surface],
    /// Nodes at rest (m), for bodies that meet themselves.
    pub(super) rest: Places<'a>,
    /// The surfaces at the start of the step; of those in pairs.
    pub(super) start: &'a [Shown],
    /// See [`Touch::drag`](super::rule::Touch::drag): for a surface, a point on its axis (m), and the way from there to its surface (m).
    pub(super) drag: &'a (dyn Fn(usize, DVec3, DVec3) -> DVec3 + Sync),
}

impl<'a> Seen<'a> {
    pub(super) fn placed(&self, surface: usize) -> Placed<'a> {
        Placed { surface: &self.surfaces[surface], at: &self.start[surface].points }
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
