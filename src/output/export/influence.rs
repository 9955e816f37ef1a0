//! The nodes that a point of a carried surface follows, at most four of them, as graphics devices take them.
//!
//! A point in a cube follows eight corners. The nodes of a cell span tetrahedra, and the point follows the corners of the one in which
//! it lies at rest. It is then at the same place at rest, and moves with affine motions as before. The tetrahedra are those whose
//! corners, raised by their heights into a fourth dimension, bound their hull from below: a regular triangulation
//! (Gelfand, Kapranov and Zelevinsky 1994). Heights belong to nodes, so that cells beside each other divide their common face alike, and
//! the surface has no cracks.
//!
//! A point outside the hull of its nodes, as beside a simplified cage, has negative weights, which graphics devices do not take. It
//! follows the nodes with the largest weights above zero. It is then at the same place at rest, as a skin moves each point by what its
//! nodes have moved, and moves with translations as before, but not with other affine motions.

use crate::sim::Carried;
use glam::{DMat3, DVec3};

/// The greatest number of nodes.
pub(super) const MOST: usize = 4;

/// A corner counts as used above this weight, and a point as inside a tetrahedron if none is below its negative.
const LEAST: f64 = 1e-9;

/// The nodes of a point of a surface and their weights, above zero and with the sum 1.
pub(super) fn of(carried: &Carried, point: usize, rest: &[DVec3]) -> Vec<(u32, f64)> {
    let (nodes, weights) = carried.weights.of(point);
    let mut all: Vec<(u32, f64)> = Vec::new();
    for (&node, &weight) in nodes.iter().zip(weights) {
        match all.iter_mut().find(|(other, _)| *other == node) {
            Some((_, sum)) => *sum += weight,
            None => all.push((node, weight)),
        }
    }
    all.retain(|(_, weight)| weight.abs() > LEAST);
    if all.len() <= MOST && all.iter().all(|(_, weight)| *weight > 0.0) {
        return all;
    }
    let at: DVec3 = all.iter().map(|&(node, weight)| rest[node as usize] * weight).sum();
    tetrahedron(&all, at, rest).unwrap_or_else(|| {
        // Nodes in a plane, or a point outside their hull.
        all.retain(|(_, weight)| *weight > 0.0);
        all.sort_by(|one, other| other.1.total_cmp(&one.1));
        all.truncate(MOST);
        let sum: f64 = all.iter().map(|(_, weight)| weight).sum();
        all.into_iter().map(|(node, weight)| (node, weight / sum)).collect()
    })
}

/// A number from 0 to 1 that depends on a number in no simple way, so that sums of a few hardly ever agree (SplitMix64: G. Steele,
/// D. Lea, C. Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014).
fn mixed(number: u32) -> f64 {
    let mut bits = (u64::from(number) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// The tetrahedron of nodes with the least height at a point, and the weights of its corners there.
fn tetrahedron(all: &[(u32, f64)], at: DVec3, rest: &[DVec3]) -> Option<Vec<(u32, f64)>> {
    let corner = |place: usize| rest[all[place].0 as usize] - at;
    let size = (0..all.len()).map(|place| corner(place).length_squared()).fold(0.0, f64::max);
    // Nodes on a sphere, such as the corners of a cube, differ by a little of their own.
    let height = |place: usize| corner(place).length_squared() / size + 1e-3 * mixed(all[place].0);
    let mut best: Option<(f64, [usize; MOST], [f64; MOST])> = None;
    for a in 0..all.len() {
        for b in a + 1..all.len() {
            for c in b + 1..all.len() {
                for d in c + 1..all.len() {
                    let origin = corner(a);
                    let sides = DMat3::from_cols(corner(b) - origin, corner(c) - origin, corner(d) - origin);
                    if sides.determinant().abs() <= LEAST * size * size.sqrt() {
                        continue;
                    }
                    let DVec3 { x, y, z } = sides.inverse() * -origin;
                    let (places, weights) = ([a, b, c, d], [1.0 - x - y - z, x, y, z]);
                    let sum = places.iter().zip(weights).map(|(&place, weight)| height(place) * weight).sum();
                    if weights.iter().all(|weight| *weight >= -LEAST) && best.is_none_or(|(least, ..)| sum < least) {
                        best = Some((sum, places, weights));
                    }
                }
            }
        }
    }
    let (_, places, weights) = best?;
    let used = places.into_iter().zip(weights).filter(|(_, weight)| *weight > LEAST);
    Some(used.map(|(place, weight)| (all[place].0, weight)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::Weights;

    /// Points of a cube, by trilinear weights.
    fn cube() -> (Carried, Vec<DVec3>) {
        let rest: Vec<_> =
            (0..8).map(|at: u32| DVec3::from_array([0, 1, 2].map(|axis| f64::from(at >> axis & 1)))).collect();
        let (mut weights, mut points) = (Weights::default(), Vec::new());
        for at in 0..1000_u32 {
            let point = DVec3::from_array([at % 10, at / 10 % 10, at / 100].map(|place| f64::from(place) / 9.0));
            let weight = |corner: &DVec3| (0..3).map(|axis| 1.0 - (corner[axis] - point[axis]).abs()).product::<f64>();
            weights.push(&[0, 1, 2, 3, 4, 5, 6, 7], &rest.iter().map(weight).collect::<Vec<_>>());
            points.push(point);
        }
        (Carried { rest: points, triangles: Vec::new(), weights }, rest)
    }

    #[test]
    fn points_stay_where_they_are_at_rest() {
        let (carried, rest) = cube();
        for (point, &at) in carried.rest.iter().enumerate() {
            let found = of(&carried, point, &rest);
            assert!(!found.is_empty() && found.len() <= MOST && found.iter().all(|(_, weight)| *weight > 0.0));
            let sum: f64 = found.iter().map(|(_, weight)| weight).sum();
            let there: DVec3 = found.iter().map(|&(node, weight)| rest[node as usize] * weight).sum();
            assert!((sum - 1.0).abs() < 1e-8 && there.distance(at) < 1e-8, "{at}: {found:?}");
        }
    }

    /// Two cubes side by side, whose lists of nodes run differently, divide their common face alike: a point of the face follows the
    /// same nodes with the same weights in both, and points on both sides of it stay together.
    #[test]
    fn the_surface_has_no_cracks() {
        let rest: Vec<_> = (0..12).map(|at| DVec3::from_array([at / 4, at / 2 % 2, at % 2].map(f64::from))).collect();
        // The common face is bent, so that its two halves tell how it is divided.
        let moved: Vec<_> = rest.iter().map(|at| *at + DVec3::splat(0.5 * (at.x - at.y * at.z))).collect();
        let cubes: [[u32; 8]; 2] = [[0, 1, 2, 3, 4, 5, 6, 7], [11, 7, 9, 5, 10, 6, 8, 4]];
        let follow = |nodes: &[u32; 8], at: DVec3| {
            let corner =
                |&node: &u32| (0..3).map(|axis| 1.0 - (rest[node as usize][axis] - at[axis]).abs()).product::<f64>();
            let mut weights = Weights::default();
            weights.push(nodes, &nodes.iter().map(corner).collect::<Vec<f64>>());
            let mut found = of(&Carried { rest: vec![at], triangles: Vec::new(), weights }, 0, &rest);
            found.sort_by_key(|(node, _)| *node);
            found
        };
        let place =
            |found: &[(u32, f64)]| -> DVec3 { found.iter().map(|&(node, weight)| moved[node as usize] * weight).sum() };
        let beside = 1e-5;
        for at in 0..400 {
            let at = DVec3::new(1.0, f64::from(at % 20) / 19.0, f64::from(at / 20) / 19.0);
            assert_eq!(follow(&cubes[0], at), follow(&cubes[1], at), "{at}");
            let [low, high] = [follow(&cubes[0], at - DVec3::X * beside), follow(&cubes[1], at + DVec3::X * beside)];
            assert!(place(&low).distance(place(&high)) < 20.0 * beside, "{at}: {low:?} {high:?}");
        }
    }

    /// However the corners move, points near each other stay near each other.
    #[test]
    fn points_of_a_cube_stay_together() {
        let (carried, rest) = cube();
        let moved: Vec<_> =
            rest.iter().map(|at| *at + DVec3::splat(0.5 * (at.x - at.y * at.z + at.x * at.y * at.z))).collect();
        let place = |point: usize| -> DVec3 {
            of(&carried, point, &rest).into_iter().map(|(node, weight)| moved[node as usize] * weight).sum()
        };
        for point in (0..1000).filter(|at| at % 10 < 9) {
            assert!(place(point).distance(place(point + 1)) < 4.0 / 9.0, "{point}");
        }
    }
}
