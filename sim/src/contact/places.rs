//! Where bodies touch.

use super::Side;
use glam::DVec3;

/// A place where a body touches an obstacle, another body or itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// What the body touches.
    pub from: Side,
    /// The number of the body.
    pub on: usize,
    /// The place on the body (m).
    pub at: DVec3,
}

/// What touches is at most this share of the distance that is kept farther apart than that.
pub(super) const SLACK: f64 = 0.1;
