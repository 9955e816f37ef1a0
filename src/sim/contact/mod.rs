//! Obstacles, rebound and friction (paper, section 2, "Collision Processing").

mod bound;
mod shape;

pub(crate) use super::motion::{Motion, Pose};
pub(super) use bound::{Bound, Floor};
pub(crate) use shape::Contact;
pub(super) use shape::ROUND_OFF;
pub use shape::Shape;

use super::motion::Interval;
use super::part::Part;
use super::state::Nodes;
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

/// A way to treat contact at the end of each step.
pub(crate) trait ContactStage: Send + Sync {
    /// Corrects the positions (m) and velocities (m/s) of all nodes after a step, which were at `before` when it began.
    /// `acceleration` (m/s²) is that with which each node has moved in the step; `None` if it has moved at constant velocity.
    fn resolve(
        &self,
        parts: &[Part],
        interval: Interval,
        before: Nodes<'_>,
        position: &mut [DVec3],
        velocity: &mut [DVec3],
        acceleration: Option<&[DVec3]>,
    );

    /// The obstacles, if nothing else is met than each of them by each node alone, which kernels do on their way.
    fn obstacles(&self) -> Option<&[Obstacle]> {
        None
    }
}

/// The paper's collision processing: each node that is found inside an obstacle rebounds, whatever way it has come.
impl ContactStage for Vec<Obstacle> {
    fn resolve(
        &self,
        _parts: &[Part],
        interval: Interval,
        _before: Nodes<'_>,
        position: &mut [DVec3],
        velocity: &mut [DVec3],
        acceleration: Option<&[DVec3]>,
    ) {
        for obstacle in self {
            obstacle.at(interval.end, interval.step).rebound_all(position, velocity, acceleration);
        }
    }

    fn obstacles(&self) -> Option<&[Obstacle]> {
        Some(self)
    }
}

/// What a body can stand on at a time (s): unit normal and distance from the origin (m) of the first floor that faces
/// upwards.
pub(crate) fn ground(obstacles: &[Obstacle], time: f64) -> Option<(DVec3, f64)> {
    // A wall is no place to stand on; a slope of some 60° still is.
    const LEAST_RISE: f64 = 0.5;
    let mut floors = obstacles.iter().filter_map(|obstacle| obstacle.floor(time));
    floors.find(|(normal, _)| normal.y > LEAST_RISE)
}

impl Obstacle {
    /// Whether it stays where it is.
    pub(crate) fn is_still(&self) -> bool {
        self.motion == Motion::Still
    }

    /// Where it is at a time (s).
    pub(crate) fn pose(&self, time: f64) -> Pose {
        self.motion.pose(time)
    }

    /// Unit normal and distance from the origin (m) of a floor at a time (s); `None` for other obstacles.
    pub(crate) fn floor(&self, time: f64) -> Option<(DVec3, f64)> {
        let Shape::Floor { normal, height } = self.shape else { return None };
        if self.motion == Motion::Still {
            return Some((normal, height));
        }
        let (pose, pivot) = (self.pose(time), self.pivot);
        let normal = pose.rotation * normal;
        Some((normal, normal.dot(pose.apply(pivot, pivot))))
    }

    /// The obstacle as nodes meet it at the end of a step (s) that ends at a time (s).
    pub(crate) fn at(&self, time: f64, step: f64) -> Placed<'_> {
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
pub(crate) struct Placed<'a> {
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
    pub(crate) fn contact(&self, point: DVec3) -> Option<(Contact, DVec3)> {
        self.surface(point).filter(|(contact, _)| contact.depth > 0.0)
    }

    /// The same also for points on the surface, to round-off.
    fn surface(&self, point: DVec3) -> Option<(Contact, DVec3)> {
        let (shape, farthest) = (&self.obstacle.shape, point.abs().max_element());
        let Some(moving) = &self.moving else {
            let contact = shape.surface(point);
            return (contact.depth > -shape.round_off(farthest)).then_some((contact, DVec3::ZERO));
        };
        let own = moving.now.undo(moving.pivot, point);
        let Contact { depth, normal } = shape.surface(own);
        // Both places are rounded, and so is the way between them.
        let farthest = farthest + own.abs().max_element() + moving.pivot.abs().max_element();
        if depth <= -shape.round_off(farthest) {
            return None;
        }
        let velocity = (point - moving.before.apply(moving.pivot, own)) / moving.step;
        Some((Contact { depth, normal: moving.now.rotation * normal }, velocity))
    }

    /// A region outside of which no node is met, with a margin (m) for round-off.
    pub(super) fn bound(&self, margin: f64) -> Bound {
        let now = |point: DVec3| self.moving.as_ref().map_or(point, |moving| moving.now.apply(moving.pivot, point));
        let middle = now(self.obstacle.shape.middle());
        match self.obstacle.shape {
            Shape::Floor { normal, .. } | Shape::Plate { normal, .. } => {
                let normal = self.moving.as_ref().map_or(normal, |moving| moving.now.rotation * normal);
                Bound::HalfSpace { normal, height: normal.dot(middle) + margin }
            }
            // In the plane they are endless across it, but all nodes are at zero there.
            Shape::Sphere { .. } | Shape::Capsule { .. } | Shape::Box { .. } => {
                let reach = DVec3::splat(self.obstacle.shape.reach() + margin);
                Bound::Box { low: middle - reach, high: middle + reach }
            }
        }
    }

    /// This one as a floor that stays where it is, if that is what it is.
    pub(super) fn still_floor(&self) -> Option<Floor> {
        let &Obstacle { ref shape, restitution, friction, .. } = self.obstacle;
        match *shape {
            Shape::Floor { normal, height } if self.moving.is_none() => {
                Some(Floor { normal, height, restitution, friction })
            }
            _ => None,
        }
    }

    /// The rebound of all nodes; see [`Self::rebound`]. `acceleration` is that of each node (m/s²); `None` for nodes that
    /// have moved at constant velocity.
    fn rebound_all(&self, position: &mut [DVec3], velocity: &mut [DVec3], acceleration: Option<&[DVec3]>) {
        let acceleration = |node: usize| acceleration.map_or(DVec3::ZERO, |all| all[node]);
        let nodes = position.iter_mut().zip(velocity).enumerate();
        match (&self.moving, &self.obstacle.shape) {
            // Nearly every scene stands on one, and most of its nodes are far above: its shape is asked for only once.
            (None, shape @ &Shape::Floor { normal, height }) => nodes.for_each(|(node, (position, velocity))| {
                let depth = height - normal.dot(*position);
                if depth > -shape.round_off(position.abs().max_element()) {
                    let contact = Contact { depth, normal };
                    self.obstacle.push_out(contact, DVec3::ZERO, acceleration(node), position, velocity);
                }
            }),
            _ => nodes.for_each(|(node, (position, velocity))| self.rebound(position, velocity, acceleration(node))),
        }
    }

    /// The rebound of one node that has moved in the step with an acceleration (m/s²): mirrored out with restitution, its
    /// slip braked by friction. A node on the surface, to round-off, rebounds if it approaches.
    pub(crate) fn rebound(&self, position: &mut DVec3, velocity: &mut DVec3, acceleration: DVec3) {
        if let Some((contact, own)) = self.surface(*position) {
            self.obstacle.push_out(contact, own, acceleration, position, velocity);
        }
    }
}

impl Obstacle {
    /// The rebound of a node inside.
    ///
    /// A node found at depth `d` is put at height `e d`; only if it is approaching, its normal velocity `v_n` becomes
    /// `−e v_n`. Friction comes from that change: it takes at most `μ |Δv_n|` from the velocity along the surface
    /// and never reverses it. All velocities are relative to the obstacle's own (m/s).
    fn push_out(
        &self,
        Contact { depth, normal }: Contact,
        own: DVec3,
        acceleration: DVec3,
        position: &mut DVec3,
        velocity: &mut DVec3,
    ) {
        let Self { restitution, friction, .. } = *self;
        let relative = *velocity - own;
        let approach = -normal.dot(relative);
        if approach > 0.0 {
            let Bounce { height, speed } = Bounce::new(restitution, depth, approach, -normal.dot(acceleration));
            *position += normal * (depth + height);
            let change = approach + speed;
            let slip = relative + normal * approach;
            let slip_speed = slip.length();
            let kept = if slip_speed > 0.0 { (1.0 - friction * change / slip_speed).max(0.0) } else { 0.0 };
            *velocity = slip * kept + normal * speed + own;
        } else if depth > 0.0 {
            *position += normal * (depth * (1.0 + restitution));
        }
    }
}

/// Where a node that approaches the surface is after its rebound.
struct Bounce {
    /// Above the surface (m).
    height: f64,
    /// Away from the surface (m/s).
    speed: f64,
}

impl Bounce {
    /// From the restitution coefficient `e`, the depth (m) and speed (m/s) with which the node was found, and the
    /// acceleration into the surface (m/s²) with which it has moved in the step.
    ///
    /// At constant velocity: height `e d`, speed `e v`. An acceleration `a` has made the node faster on its way from the
    /// surface to where it was found, and brakes it on its way up: it hit the surface with `v² − 2 a d`, left it with `e²`
    /// of that, and at height `e d` has `2 a e d` less. A node that does not come so high is put where it turns round. So
    /// with `e = 1` its energy under a constant force stays as it was, however long the step; the paper's `−e v` alone
    /// would add `m a v ΔT` with every bounce.
    fn new(e: f64, depth: f64, approach: f64, pressing: f64) -> Self {
        if pressing == 0.0 {
            return Self { height: e * depth, speed: e * approach };
        }
        let hit = (approach * approach - 2.0 * pressing * depth).max(0.0);
        let left = e * e * hit;
        let speed = left - 2.0 * pressing * (e * depth);
        if speed >= 0.0 {
            Self { height: e * depth, speed: speed.sqrt() }
        } else {
            Self { height: left / (2.0 * pressing), speed: 0.0 }
        }
    }
}
