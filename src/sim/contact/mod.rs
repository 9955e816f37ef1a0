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

/// What a body can stand on: unit normal and distance from the origin (m) of the first floor that faces upwards.
pub fn ground(obstacles: &[Obstacle]) -> Option<(DVec3, f64)> {
    // A wall is no place to stand on; a slope of some 60° still is.
    const LEAST_RISE: f64 = 0.5;
    obstacles.iter().find_map(|obstacle| match obstacle.shape {
        Shape::Floor { normal, height } => (normal.y > LEAST_RISE).then_some((normal, height)),
    })
}

impl Obstacle {
    /// The rebound of one node: mirrored out with restitution, its slip braked by friction.
    ///
    /// A node found at depth `d` is put at height `e d`; only if it is approaching, its normal velocity `v_n` becomes
    /// `−e v_n`. Friction comes from that change: it takes at most `μ |Δv_n|` from the velocity along the surface
    /// and never reverses it.
    pub fn rebound(&self, position: &mut DVec3, velocity: &mut DVec3) {
        let Shape::Floor { normal, height } = self.shape;
        let depth = height - normal.dot(*position);
        if depth <= 0.0 {
            return;
        }
        *position += normal * (depth * (1.0 + self.restitution));
        let approach = -normal.dot(*velocity);
        if approach <= 0.0 {
            return;
        }
        let change = (1.0 + self.restitution) * approach;
        let slip = *velocity + normal * approach;
        let speed = slip.length();
        let kept = if speed > 0.0 { (1.0 - self.friction * change / speed).max(0.0) } else { 0.0 };
        *velocity = slip * kept + normal * (self.restitution * approach);
    }
}
