//! Obstacles as kernels see them: regions of possible contact, and floors, for which kernels compute contact themselves.

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

/// A half-space that nodes bounce off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Floor {
    /// Unit vector out of it.
    pub(crate) normal: DVec3,
    /// Distance of the surface from the origin along `normal` (m).
    pub(crate) height: f64,
    /// Restitution coefficient `e`.
    pub(crate) restitution: f64,
    /// Friction coefficient `μ`.
    pub(crate) friction: f64,
    /// The longest time for which friction acts on the path of a node (s); 0 if it acts on velocities only.
    pub(crate) longest: f64,
}
