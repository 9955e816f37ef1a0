//! Closest points of points, segments and triangles, and whether they are a local minimum of the distance.
//!
//! C. Ericson, Real-Time Collision Detection (2005), sections 5.1.2, 5.1.5 and 5.1.9.

use super::lanewise::{along_segments, in_triangle};
use crate::lanes::{Lanes, One};
use glam::DVec3;

/// The closest point of a segment or triangle to a point, as shares of its corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nearest {
    /// The weight of each corner, with the sum 1.
    pub(super) shares: [f64; 3],
    /// Where it is.
    pub(super) on: On,
}

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

/// The closest point of a segment.
pub(super) fn of_segment(point: DVec3, [a, b]: [DVec3; 2]) -> Nearest {
    let along = b - a;
    let (way, whole) = (along.dot(point - a), along.length_squared());
    if way <= 0.0 || whole == 0.0 {
        return Nearest { shares: [1.0, 0.0, 0.0], on: On::Corner(0) };
    }
    if way >= whole {
        return Nearest { shares: [0.0, 1.0, 0.0], on: On::Corner(1) };
    }
    let share = way / whole;
    Nearest { shares: [1.0 - share, share, 0.0], on: On::Inside }
}

/// The closest point of a triangle.
pub(super) fn of_triangle(point: DVec3, corners: [DVec3; 3]) -> Nearest {
    let lanes = |at: DVec3| at.to_array().map(One::splat);
    let (shares, part) = in_triangle(lanes(point), corners.map(lanes));
    Nearest { shares: shares.map(|share| share.to_array()[0]), on: On::of(part.to_array()[0]) }
}

/// The closest points of two segments: how far along each they are, from 0 to 1.
pub(super) fn of_segments(one: [DVec3; 2], other: [DVec3; 2]) -> [f64; 2] {
    let lanes = |at: DVec3| at.to_array().map(One::splat);
    let [first, second, _] = along_segments(one.map(lanes), other.map(lanes));
    [first, second].map(|share| share.to_array()[0])
}

/// Whether a way from a closest point leads away from the surface there: towards none of the `around` corners of the faces that meet at the
/// point, but for a slack.
///
/// Where a surface is nearly flat along an edge that presses on it, each feature is the nearest in turn, from step to step, and the others go
/// through meanwhile. With the slack all of them count. One that counts without need does no harm: its points are near each other, too.
///
/// Returns by how much (m) the way leads towards one of them: zero if it leads away.
pub(super) fn towards(way: DVec3, from: DVec3, around: impl Iterator<Item = DVec3> + Clone) -> f64 {
    /// The cosine of the least angle between the way and a face, 73°. With 84° some corners that hit each other still crossed.
    const SLACK: f64 = 0.3;
    let whole = SLACK * SLACK * way.length_squared();
    let leads_away = |corner: DVec3| {
        let (direction, along) = (corner - from, way.dot(corner - from));
        along <= 0.0 || along * along <= whole * direction.length_squared()
    };
    if around.clone().all(leads_away) {
        return 0.0;
    }
    let most = around.fold(0.0, |most: f64, corner| most.max(along(way, corner - from)));
    (most - SLACK * way.length()).max(f64::MIN_POSITIVE)
}

/// The length of a way along a direction (m).
pub(super) fn along(way: DVec3, direction: DVec3) -> f64 {
    let length = direction.length();
    if length > 0.0 { direction.dot(way) / length } else { 0.0 }
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
            let nearest = of_triangle(point, corners);
            let at = mix(nearest.shares, corners);
            let distance = at.distance(point);
            for (i, j) in (0..=20).flat_map(|i| (0..=20 - i).map(move |j| (i, j))) {
                let [v, w] = [i, j].map(|k| f64::from(k) / 20.0);
                assert!(distance <= mix([1.0 - v - w, v, w], corners).distance(point) + 1e-13);
            }
            let across = |along: DVec3| assert!((point - at).dot(along).abs() < 1e-12 * along.length());
            match nearest.on {
                On::Inside => [1, 2].iter().for_each(|&to| across(corners[to] - corners[0])),
                On::Side(side) => across(corners[(side + 1) % 3] - corners[side]),
                On::Corner(corner) => assert_eq!(at, corners[corner]),
            }
            seen[match nearest.on {
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
        let sides = [DVec3::new(1.0, -0.5, 0.0), DVec3::new(-1.0, -0.5, 0.0)];
        let away = |way| towards(way, DVec3::ZERO, sides.into_iter()) == 0.0;
        assert!(away(DVec3::Y) && away(DVec3::new(0.2, 1.0, 0.0)) && away(DVec3::new(0.5, 1.0, 0.0)));
        assert!(!away(DVec3::X) && !away(-DVec3::Y) && !away(DVec3::new(1.5, 1.0, 0.0)));
        // A flat place: both sides count, to round-off.
        assert_eq!(towards(DVec3::Y, DVec3::ZERO, [DVec3::new(1.0, 1e-16, 0.0), -DVec3::X].into_iter()), 0.0);
    }
}
