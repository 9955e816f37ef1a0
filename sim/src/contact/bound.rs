//! Obstacles as kernels see them: regions of possible contact.

use glam::DVec3;

/// A region that contains all points of contact with an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Bound {
    /// All points with `normal · x < height`.
    HalfSpace {
        /// Unit vector out of it.
        normal: DVec3,
        /// Distance of the surface from the origin along `normal` (m).
        height: f64,
    },
    /// All points strictly between two corners.
    Box {
        /// The corner with the least coordinates (m).
        low: DVec3,
        /// The corner with the greatest (m).
        high: DVec3,
    },
}
