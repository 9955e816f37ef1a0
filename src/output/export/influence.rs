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

use crate::scene::generate::random;
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

/// The tetrahedron of nodes with the least height at a point, and the weights of its corners there.
fn tetrahedron(all: &[(u32, f64)], at: DVec3, rest: &[DVec3]) -> Option<Vec<(u32, f64)>> {
    let corner = |place: usize| rest[all[place].0 as usize] - at;
    let size = (0..all.len()).map(|place| corner(place).length_squared()).fold(0.0, f64::max);
    // Nodes on a sphere, such as the corners of a cube, differ by a little of their own, so that sums of a few hardly ever agree.
    let height = |place: usize| corner(place).length_squared() / size + 1e-3 * random::nth(all[place].0);
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
#[path = "../../../tests/inside/influence.rs"]
mod tests;
