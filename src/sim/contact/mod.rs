//! Obstacles, rebound and friction (paper, section 2, "Collision Processing").

use glam::DVec3;

/// Something rigid that nodes bounce off.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// Its shape and place.
    pub shape: Shape,
    /// Restitution coefficient `e`, 0 to 1: the part of the normal velocity that a rebound gives back.
    pub restitution: f64,
    /// Friction coefficient `μ`, 0 or more.
    pub friction: f64,
}

/// The region that an obstacle fills.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// The half-space `normal · x < height`.
    Floor {
        /// Unit vector out of the floor.
        normal: DVec3,
        /// Distance of the surface from the origin along `normal` (m).
        height: f64,
    },
}
