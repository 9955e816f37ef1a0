//! The ambient occlusion of solid obstacles by a body near them.

use super::space::Staging;
use glam::DVec3;

/// The distance at which occlusion between a body and an obstacle begins (soft units). The shader that lights bodies has
/// the same constant.
pub(super) const REACH: f64 = 1.3;
/// Below this part of that distance the direction to the body loses its influence: at contact it is undefined.
const TOUCHING: f64 = 0.3;

/// A triangle with a ball around it.
#[derive(Clone, Copy, Debug)]
struct Piece {
    corners: [DVec3; 3],
    middle: DVec3,
    radius: f64,
}

/// The part of a body near an obstacle.
#[derive(Debug)]
pub(super) struct Near {
    pieces: Vec<Piece>,
    /// The box around all pieces with their reach (m).
    bounds: [DVec3; 2],
    /// The distance at which their occlusion ends (m).
    reach: f64,
}

impl Staging<'_> {
    /// The part of the body near the box around points (m); `None` if that is empty.
    pub(super) fn near(&self, points: impl Iterator<Item = DVec3>) -> Option<Near> {
        let skin = self.skin?;
        let reach = REACH * self.soft();
        let [low, high] = bounds(points, reach);
        let place = |node: u32| self.draft.position.get(node as usize).copied();
        let near = |[a, b, c]: [u32; 3]| {
            let corners = [place(a)?, place(b)?, place(c)?];
            let [a, b, c] = corners;
            let apart = a.max(b).max(c).cmplt(low).any() || a.min(b).min(c).cmpgt(high).any();
            let middle = (a + b + c) / 3.0;
            let radius = corners.iter().map(|at| at.distance(middle)).fold(0.0, f64::max);
            (!apart).then_some(Piece { corners, middle, radius })
        };
        let pieces: Vec<_> = match &self.left {
            Some(left) => left.iter().copied().filter_map(near).collect(),
            None => skin.triangles.iter().map(|at| at.map(|at| skin.nodes[at as usize])).filter_map(near).collect(),
        };
        let bounds = bounds(pieces.iter().flat_map(|piece| piece.corners), reach);
        (!pieces.is_empty()).then_some(Near { pieces, bounds, reach })
    }
}

impl Near {
    /// The occlusion of a point of a surface with a unit normal: 1 where the body touches it, 0 from the reach on.
    pub(super) fn to(&self, point: DVec3, normal: DVec3) -> f64 {
        let [low, high] = self.bounds;
        if point.cmplt(low).any() || point.cmpgt(high).any() {
            return 0.0;
        }
        let (mut nearest, mut way) = (self.reach, DVec3::ZERO);
        for piece in &self.pieces {
            if piece.middle.distance_squared(point) < (nearest + piece.radius).powi(2) {
                let there = nearest_point(piece.corners, point) - point;
                let distance = there.length();
                if distance < nearest {
                    (nearest, way) = (distance, there);
                }
            }
        }
        let apart = nearest / self.reach;
        // A surface that faces away from the body is occluded less.
        let turned = 0.5 + 0.5 * normal.dot(way) / nearest.max(f64::MIN_POSITIVE);
        let counts = (apart / TOUCHING).min(1.0);
        (1.0 + counts * counts * (3.0 - 2.0 * counts) * (turned - 1.0)) * (1.0 - apart) * (1.0 - apart)
    }
}

/// The box around points, with room on all sides.
fn bounds(points: impl Iterator<Item = DVec3>, room: f64) -> [DVec3; 2] {
    let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let [low, high] = points.fold(none, |[low, high], at| [low.min(at), high.max(at)]);
    [low - room, high + room]
}

/// The point of a triangle that is nearest to another point (Ericson 2004, Real-Time Collision Detection, 5.1.5).
fn nearest_point([a, b, c]: [DVec3; 3], point: DVec3) -> DVec3 {
    let (along_b, along_c) = (b - a, c - a);
    let from_a = point - a;
    let [d1, d2] = [along_b.dot(from_a), along_c.dot(from_a)];
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let from_b = point - b;
    let [d3, d4] = [along_b.dot(from_b), along_c.dot(from_b)];
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let of_c = d1 * d4 - d3 * d2;
    if of_c <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + d1 / (d1 - d3) * along_b;
    }
    let from_c = point - c;
    let [d5, d6] = [along_b.dot(from_c), along_c.dot(from_c)];
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let of_b = d5 * d2 - d1 * d6;
    if of_b <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + d2 / (d2 - d6) * along_c;
    }
    let of_a = d3 * d6 - d5 * d4;
    if of_a <= 0.0 && d4 >= d3 && d5 >= d6 {
        return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
    }
    a + (of_b * along_b + of_c * along_c) / (of_a + of_b + of_c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_point_of_a_triangle_is_nearer_than_the_nearest() {
        let triangle = [DVec3::new(0.1, 0.0, 0.2), DVec3::new(1.0, 0.3, 0.0), DVec3::new(0.2, 0.9, -0.3)];
        let [a, b, c] = triangle;
        for at in 0..1000u32 {
            let point = DVec3::from_array([at % 10, at / 10 % 10, at / 100].map(|n| f64::from(n) * 0.3 - 1.2));
            let least = nearest_point(triangle, point).distance(point);
            for i in 0..=20 {
                for j in 0..=20 - i {
                    let there = a + (b - a) * f64::from(i) / 20.0 + (c - a) * f64::from(j) / 20.0;
                    assert!(there.distance(point) >= least - 1e-12, "{point}");
                }
            }
            let beside = [a, b, c].map(|corner| corner.distance(point)).into_iter().fold(f64::INFINITY, f64::min);
            assert!(least <= beside + 1e-12);
        }
    }

    #[test]
    fn what_touches_is_near_and_nearness_fades_smoothly() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Z];
        let piece = Piece { corners, middle: (DVec3::X + DVec3::Z) / 3.0, radius: 1.0 };
        let near = Near { pieces: vec![piece], bounds: bounds(corners.into_iter(), 0.5), reach: 0.5 };
        let above = |height: f64| near.to(DVec3::new(0.2, height, 0.2), -DVec3::Y);
        assert!((above(0.0) - 1.0).abs() < 1e-12);
        assert_eq!((above(0.5), above(0.9)), (0.0, 0.0));
        for step in -200..200 {
            let [one, other] = [step, step + 1].map(|step| above(f64::from(step) * 0.003));
            assert!((one - other).abs() < 0.05, "{step}: {one} {other}");
        }
    }
}
