//! The place and the rotation of a whole body.

use glam::{DMat3, DVec3};

/// The rigid placement of a body's rest shape that is nearest to its nodes (least squares).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Placement {
    /// Mean of the nodes at rest (m).
    pub rest_centre: DVec3,
    /// Mean of the nodes (m).
    pub centre: DVec3,
    /// The rotation.
    pub turn: DMat3,
}

impl Placement {
    /// The position of a point of the rest shape (m) in this placement.
    pub fn place(&self, rest: DVec3) -> DVec3 {
        self.centre + self.turn * (rest - self.rest_centre)
    }
}
