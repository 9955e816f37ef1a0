//! Closest points of points, segments and triangles, and whether they are a local minimum of the distance.
//!
//! C. Ericson, Real-Time Collision Detection (2005), sections 5.1.2, 5.1.5 and 5.1.9.

use super::lanewise::{INSIDE, along_segments, in_triangle};
use crate::lanes::{Lanes, One};
use glam::DVec3;

/// The part of a facet on which a closest point lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum On {
    /// Inside, or between the ends of a segment.
    Inside,
    /// Between corner `i` and the next one.
    Side(usize),
    /// On corner `i`.
    Corner(usize),
}

impl On {
    /// By the number of a part, as lanes have it: 0 to 2 for corners, 3 to 5 for sides, then the inside.
    pub(super) fn of(part: f64) -> Self {
        match part as usize {
            corner @ 0..3 => Self::Corner(corner),
            side @ 3..6 => Self::Side(side - 3),
            _ => Self::Inside,
        }
    }
}

/// The closest point of a segment or triangle to a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    /// The weight of each corner, with the sum 1.
    pub(super) shares: [f64; 3],
    /// The number of the part on which it lies, as [`On::of`] reads it.
    pub(super) part: f64,
}

/// The closest point of a segment.
pub(super) fn of_segment(point: DVec3, [a, b]: [DVec3; 2]) -> Nearest {
    let along = b - a;
    let (way, whole) = (along.dot(point - a), along.length_squared());
    if way <= 0.0 || whole == 0.0 {
        return Nearest { shares: [1.0, 0.0, 0.0], part: 0.0 };
    }
    if way >= whole {
        return Nearest { shares: [0.0, 1.0, 0.0], part: 1.0 };
    }
    let share = way / whole;
    Nearest { shares: [1.0 - share, share, 0.0], part: INSIDE }
}

/// The closest point of a triangle.
pub(super) fn of_triangle(point: DVec3, corners: [DVec3; 3]) -> Nearest {
    let lanes = |at: DVec3| at.to_array().map(One::splat);
    let (shares, part) = in_triangle(lanes(point), corners.map(lanes));
    Nearest { shares: shares.map(|share| share.to_array()[0]), part: part.to_array()[0] }
}

/// The closest points of two segments: how far along each they are, from 0 to 1.
pub(super) fn of_segments(one: [DVec3; 2], other: [DVec3; 2]) -> [f64; 2] {
    let lanes = |at: DVec3| at.to_array().map(One::splat);
    let [first, second, _] = along_segments(one.map(lanes), other.map(lanes));
    [first, second].map(|share| share.to_array()[0])
}

/// How far (m) a way from a closest point leads along the faces that meet there, towards one of their corners `around`; zero if it leads away
/// from all of them, as at a local minimum of the distance.
pub(super) fn lean(way: DVec3, from: DVec3, around: impl Iterator<Item = DVec3>) -> f64 {
    let squared = |corner: DVec3| {
        let (direction, along) = (corner - from, way.dot(corner - from));
        if along > 0.0 { along * along / direction.length_squared() } else { 0.0 }
    };
    around.map(squared).fold(0.0, f64::max).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Noise;

    fn mix(shares: [f64; 3], corners: [DVec3; 3]) -> DVec3 {
        (0..3).map(|at| corners[at] * shares[at]).sum()
    }

    /// No other point of a fine grid on the triangle is nearer, and the way to the point is perpendicular to what it lies on.
    #[test]
    fn no_point_of_a_triangle_is_nearer() {
        let mut noise = Noise(5);
        let mut next = || noise.vector();
        let mut seen = [0; 3];
        for _ in 0..2000 {
            let (point, corners) = (next() * 1.5, [next(), next(), next()]);
            let Nearest { shares, part } = of_triangle(point, corners);
            let (at, on) = (mix(shares, corners), On::of(part));
            let distance = at.distance(point);
            for (i, j) in (0..=20).flat_map(|i| (0..=20 - i).map(move |j| (i, j))) {
                let [v, w] = [i, j].map(|k| f64::from(k) / 20.0);
                assert!(distance <= mix([1.0 - v - w, v, w], corners).distance(point) + 1e-13);
            }
            let across = |along: DVec3| assert!((point - at).dot(along).abs() < 1e-12 * along.length());
            match on {
                On::Inside => [1, 2].iter().for_each(|&to| across(corners[to] - corners[0])),
                On::Side(side) => across(corners[(side + 1) % 3] - corners[side]),
                On::Corner(corner) => assert_eq!(at, corners[corner]),
            }
            seen[match on {
                On::Inside => 0,
                On::Side(_) => 1,
                On::Corner(_) => 2,
            }] += 1;
        }
        assert!(seen.iter().all(|&count| count > 100), "{seen:?}");
    }

    /// Parallel segments have no closest points alone, and no others are nearer.
    #[test]
    fn no_points_of_parallel_segments_are_nearer() {
        let mut noise = Noise(5);
        for _ in 0..500 {
            let (one, from) = ([noise.vector(), noise.vector()], noise.vector());
            let other = [from, from + (one[1] - one[0]) * 0.7];
            let [s, t] = of_segments(one, other);
            let distance = one[0].lerp(one[1], s).distance(other[0].lerp(other[1], t));
            for (i, j) in (0..=20).flat_map(|i| (0..=20).map(move |j| (i, j))) {
                let [v, w] = [i, j].map(|k| f64::from(k) / 20.0);
                assert!(distance <= one[0].lerp(one[1], v).distance(other[0].lerp(other[1], w)) + 1e-12);
            }
        }
    }

    /// Above an edge of a roof the way up leads away, the way to the side does not.
    #[test]
    fn a_way_leads_away_from_convex_edges_only() {
        let sides = [DVec3::new(1.0, -0.75, 0.0), DVec3::new(-1.0, -0.75, 0.0)];
        let lean = |way| lean(way, DVec3::ZERO, sides.into_iter());
        assert_eq!([DVec3::Y, DVec3::new(0.75, 1.0, 0.0)].map(lean), [0.0; 2]);
        // Down the slope and below it.
        assert_eq!([DVec3::X, DVec3::new(1.0, -0.75, 0.0), -DVec3::Y].map(lean), [0.8, 1.25, 0.6]);
    }
}
