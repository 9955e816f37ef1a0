//! How far the same nodes of two states of one body are apart.

use super::body::Dimension;
use super::rotation::{best, moment};
use glam::DVec3;

/// The nodes `from`, moved and turned as a rigid body to where they are nearest to the nodes `to` (least squares, all nodes
/// alike; m).
pub fn fitted(dimension: Dimension, from: &[DVec3], to: &[DVec3]) -> Vec<DVec3> {
    let mean = |points: &[DVec3]| points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    let [own, centre] = [mean(from), mean(to)];
    let shape: Vec<_> = from.iter().map(|&at| at - own).collect();
    let turn = best(dimension, moment(&shape, to.iter().map(|&at| at - centre)));
    shape.iter().map(|&at| centre + turn * at).collect()
}

/// The distance of each node from the same node of another state (m).
pub fn distances<'a>(one: &'a [DVec3], other: &'a [DVec3]) -> impl Iterator<Item = f64> + 'a {
    one.iter().zip(other).map(|(one, other)| one.distance(*other))
}

/// The largest distance of a node from the same node of another state (m), as they are or after the best rigid fit.
pub fn largest(dimension: Dimension, [one, other]: [&[DVec3]; 2], after_fit: bool) -> f64 {
    let largest = |other: &[DVec3]| distances(one, other).fold(0.0, f64::max);
    if after_fit { largest(&fitted(dimension, other, one)) } else { largest(other) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn a_rigid_motion_is_no_difference_after_the_fit() {
        let one: Vec<_> =
            (0..8).map(|at| DVec3::new(f64::from(at & 1), f64::from(at >> 1 & 1), f64::from(at >> 2))).collect();
        let turn = DQuat::from_xyzw(0.3, -0.4, 0.1, 0.8).normalize();
        let moved: Vec<_> = one.iter().map(|&at| DVec3::new(3.0, -1.0, 2.0) + turn * at).collect();
        let apart = |other: &[DVec3], after_fit| largest(Dimension::Space, [&one, other], after_fit);
        assert!(apart(&moved, false) > 2.0 && apart(&moved, true) < 1e-14);
        // What a rigid motion cannot undo is left: a tenth longer along each edge of half a length from the middle.
        let larger: Vec<_> = moved.iter().map(|&at| 1.1 * at).collect();
        assert!((apart(&larger, true) - 0.05 * 3_f64.sqrt()).abs() < 1e-14, "{}", apart(&larger, true));
        assert_eq!(apart(&one, false), 0.0);
    }
}
