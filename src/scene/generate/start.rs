//! Degenerate, inverted and random starts.

use super::random;
use crate::scene::file::StartShape;
use crate::sim::Dimension;
use crate::sim::geometry::bounds;
use glam::DVec3;

/// The use of random numbers in clouds; the axis is added to it.
const CLOUD: u64 = 16;

/// Moves nodes (m) from rest to a start shape, with a unit direction if it has one and a seed if it is random.
pub(in crate::scene) fn brought_to_start(
    nodes: &mut [DVec3],
    shape: StartShape,
    direction: DVec3,
    seed: u32,
    dimension: Dimension,
) {
    let middle = nodes.iter().sum::<DVec3>() / nodes.len().max(1) as f64;
    let (low, high) = bounds(nodes);
    for (index, node) in nodes.iter_mut().enumerate() {
        let along = direction.dot(*node - middle) * direction;
        *node = match shape {
            StartShape::Point => middle,
            StartShape::Line => middle + along,
            StartShape::Plane => *node - along,
            StartShape::MirrorImage => *node - 2.0 * along,
            StartShape::Cloud => {
                let share = |axis: u64| random::unit(seed, index as u64, CLOUD + axis);
                let flat = dimension == Dimension::Plane;
                low + DVec3::new(share(0), share(1), if flat { 0.0 } else { share(2) }) * (high - low)
            }
        };
    }
}
