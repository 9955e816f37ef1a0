//! The half-spaces of floors and plates, and clipping of polygons and lines at them.

use crate::sim::{Obstacle, Shape};
use glam::DVec3;

/// A half-space: its outward unit normal, and its distance from the origin along the normal (m).
pub(in crate::picture) type HalfSpace = (DVec3, f64);

/// The half-space of a floor or a plate at a time (s).
pub(in crate::picture) fn half_space(obstacle: &Obstacle, time: f64) -> Option<HalfSpace> {
    let Shape::Plate { point, normal } = obstacle.shape else { return obstacle.floor(time) };
    let pose = obstacle.pose(time);
    let normal = pose.rotation * normal;
    Some((normal, normal.dot(pose.apply(point, point))))
}

/// The part of a convex polygon outside of half-spaces.
pub(super) fn clipped_polygon(polygon: &[DVec3], solid: &[HalfSpace]) -> Vec<DVec3> {
    let mut kept = polygon.to_vec();
    for &(normal, height) in solid {
        let above = |point: DVec3| normal.dot(point) - height;
        let mut next = Vec::with_capacity(kept.len() + 1);
        for (at, &point) in kept.iter().enumerate() {
            let before = kept[(at + kept.len() - 1) % kept.len()];
            let (from, to) = (above(before), above(point));
            if (from < 0.0) != (to < 0.0) {
                next.push(before.lerp(point, from / (from - to)));
            }
            if to >= 0.0 {
                next.push(point);
            }
        }
        kept = next;
    }
    kept
}

/// The part of a line outside of half-spaces.
pub(super) fn clipped_line([mut from, mut to]: [DVec3; 2], solid: &[HalfSpace]) -> Option<[DVec3; 2]> {
    for &(normal, height) in solid {
        let [a, b] = [from, to].map(|point| normal.dot(point) - height);
        match (a < 0.0, b < 0.0) {
            (true, true) => return None,
            (true, false) => from = from.lerp(to, a / (a - b)),
            (false, true) => to = from.lerp(to, a / (a - b)),
            (false, false) => {}
        }
    }
    Some([from, to])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::{Motion, Offset};
    use std::f64::consts::PI;

    #[test]
    fn polygons_and_lines_end_where_floors_begin() {
        let square = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
        let half = clipped_polygon(&square, &[(DVec3::Y, 0.5)]);
        assert_eq!(half.len(), 4);
        assert!(half.iter().all(|at| at.y >= 0.5));
        assert!(clipped_polygon(&square, &[(DVec3::Y, 2.0)]).is_empty());
        assert_eq!(clipped_line([DVec3::ZERO, DVec3::Y], &[(DVec3::Y, 0.5)]), Some([0.5 * DVec3::Y, DVec3::Y]));
        assert_eq!(clipped_line([DVec3::ZERO, DVec3::X], &[(DVec3::Y, 0.5)]), None);
    }

    #[test]
    fn a_plate_is_where_its_path_has_brought_it() {
        let place = Offset { shift: DVec3::new(0.0, -0.5, 0.0), rotation: DVec3::new(0.0, 0.0, PI / 2.0) };
        let plate = Obstacle {
            shape: Shape::Plate { point: DVec3::Y, normal: -DVec3::Y },
            motion: Motion::at(place),
            pivot: DVec3::Y,
            restitution: 0.0,
            friction: 0.0,
            friction_of: Default::default(),
        };
        let (normal, height) = half_space(&plate, 0.0).unwrap();
        assert!(normal.distance(DVec3::X) < 1e-12 && height.abs() < 1e-12, "{normal} {height}");
    }
}
