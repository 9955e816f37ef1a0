//! Obstacles, rebound and friction (paper, section 2, "Collision Processing").

mod shape;

pub use super::motion::{Motion, Pose};
pub use shape::{Contact, Shape};

use super::body::State;
use glam::DVec3;

/// Something rigid that nodes bounce off.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// Its shape and place, before it moves.
    pub shape: Shape,
    /// How it moves.
    pub motion: Motion,
    /// The point about which it turns when it moves (m), of its own: it moves along with its shifts.
    pub pivot: DVec3,
    /// Restitution coefficient `e`, 0 to 1: the part of the normal velocity that a rebound gives back.
    pub restitution: f64,
    /// Friction coefficient `μ`, 0 or more.
    pub friction: f64,
}

/// What a body can stand on at a time (s): unit normal and distance from the origin (m) of the first floor that faces
/// upwards.
pub fn ground(obstacles: &[Obstacle], time: f64) -> Option<(DVec3, f64)> {
    // A wall is no place to stand on; a slope of some 60° still is.
    const LEAST_RISE: f64 = 0.5;
    let mut floors = obstacles.iter().filter_map(|obstacle| obstacle.floor(time));
    floors.find(|(normal, _)| normal.y > LEAST_RISE)
}

impl Obstacle {
    /// Where it is at a time (s).
    pub fn pose(&self, time: f64) -> Pose {
        self.motion.pose(time)
    }

    /// Unit normal and distance from the origin (m) of a floor at a time (s); `None` for other obstacles.
    pub fn floor(&self, time: f64) -> Option<(DVec3, f64)> {
        let Shape::Floor { normal, height } = self.shape else { return None };
        if self.motion == Motion::Still {
            return Some((normal, height));
        }
        let (pose, pivot) = (self.pose(time), self.pivot);
        let normal = pose.turn * normal;
        Some((normal, normal.dot(pose.apply(pivot, pivot))))
    }

    /// The obstacle as nodes meet it at the end of a step (s) that ends at a time (s).
    pub fn at(&self, time: f64, step: f64) -> Placed<'_> {
        let moving = (self.motion != Motion::Still).then(|| Moving {
            pivot: self.pivot,
            now: self.pose(time),
            // At the start nothing has moved yet.
            before: self.pose((time - step).max(0.0)),
            step,
        });
        Placed { obstacle: self, moving }
    }
}

/// An obstacle at one moment.
#[derive(Clone, Debug)]
pub struct Placed<'a> {
    obstacle: &'a Obstacle,
    moving: Option<Moving>,
}

/// How an obstacle has moved in a step.
#[derive(Clone, Debug)]
struct Moving {
    pivot: DVec3,
    now: Pose,
    before: Pose,
    step: f64,
}

impl Placed<'_> {
    /// The depth of a point inside the obstacle, and the velocity (m/s) of the obstacle there.
    ///
    /// The velocity is the way that the obstacle's own point has gone in the last step, over the step: what the steps
    /// of the nodes call velocity, too.
    pub fn contact(&self, point: DVec3) -> Option<(Contact, DVec3)> {
        let Some(moving) = &self.moving else { return Some((self.obstacle.shape.contact(point)?, DVec3::ZERO)) };
        let own = moving.now.undo(moving.pivot, point);
        let Contact { depth, normal } = self.obstacle.shape.contact(own)?;
        let velocity = (point - moving.before.apply(moving.pivot, own)) / moving.step;
        Some((Contact { depth, normal: moving.now.turn * normal }, velocity))
    }

    /// The rebound of all nodes; see [`Self::rebound`]. Whether there was any.
    pub fn rebound_all(&self, state: &mut State) -> bool {
        let nodes = state.position.iter_mut().zip(&mut state.velocity);
        match (&self.moving, &self.obstacle.shape) {
            // Nearly every scene stands on one, and most of its nodes are far above: its shape is asked for only once.
            (None, &Shape::Floor { normal, height }) => nodes.fold(false, |any, (position, velocity)| {
                let depth = height - normal.dot(*position);
                if depth > 0.0 {
                    self.obstacle.push_out(Contact { depth, normal }, DVec3::ZERO, position, velocity);
                }
                any | (depth > 0.0)
            }),
            _ => nodes.fold(false, |any, (position, velocity)| any | self.rebound(position, velocity)),
        }
    }

    /// The rebound of one node: mirrored out with restitution, its slip braked by friction. Whether there was one.
    pub fn rebound(&self, position: &mut DVec3, velocity: &mut DVec3) -> bool {
        let Some((contact, own)) = self.contact(*position) else { return false };
        self.obstacle.push_out(contact, own, position, velocity);
        true
    }
}

impl Obstacle {
    /// The rebound of a node inside.
    ///
    /// A node found at depth `d` is put at height `e d`; only if it is approaching, its normal velocity `v_n` becomes
    /// `−e v_n`. Friction comes from that change: it takes at most `μ |Δv_n|` from the velocity along the surface
    /// and never reverses it. All velocities are relative to the obstacle's own (m/s).
    fn push_out(&self, Contact { depth, normal }: Contact, own: DVec3, position: &mut DVec3, velocity: &mut DVec3) {
        let Self { restitution, friction, .. } = *self;
        *position += normal * (depth * (1.0 + restitution));
        let relative = *velocity - own;
        let approach = -normal.dot(relative);
        if approach > 0.0 {
            let change = (1.0 + restitution) * approach;
            let slip = relative + normal * approach;
            let speed = slip.length();
            let kept = if speed > 0.0 { (1.0 - friction * change / speed).max(0.0) } else { 0.0 };
            *velocity = slip * kept + normal * (restitution * approach) + own;
        }
    }
}
