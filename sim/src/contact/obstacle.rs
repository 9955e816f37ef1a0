//! Obstacles, rebound and friction of nodes (paper, section 2, "Collision Processing").

use super::{Bound, Contact, Shape};
use crate::motion::{Motion, Pose};
use glam::DVec3;

/// A rigid obstacle that nodes collide with.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// Its shape and position at the start.
    pub shape: Shape,
    /// Its motion.
    pub motion: Motion,
    /// The point about which it rotates (m), at the start; it is translated together with the obstacle.
    pub pivot: DVec3,
    /// Restitution coefficient `e`, 0 to 1: normal velocity after a rebound divided by that before.
    pub restitution: f64,
    /// Friction coefficient `μ`, 0 or more.
    pub friction: f64,
    /// The motion that friction acts on.
    pub friction_of: FrictionOf,
}

/// The motion that friction acts on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "scene", serde(rename_all = "kebab-case"))]
pub enum FrictionOf {
    /// The velocity after the step, as in the paper. The displacement in the step remains: a body that rests on a slope
    /// creeps down with any friction.
    Velocity,
    /// Also the path since the node touched the obstacle, by the same factor as the velocity. A body at rest does not
    /// creep with a restitution up to 0.3, with velocity Verlet up to 0.8; above, it creeps less than with `velocity`.
    /// The default.
    #[default]
    Path,
}

/// The ground under a body at a time (s): unit normal and distance from the origin (m) of the first floor
/// that faces upwards.
pub fn ground(obstacles: &[Obstacle], time: f64) -> Option<(DVec3, f64)> {
    // Walls are not ground; slopes of up to 60° are.
    const LEAST_RISE: f64 = 0.5;
    let mut floors = obstacles.iter().filter_map(|obstacle| obstacle.floor(time));
    floors.find(|(normal, _)| normal.y > LEAST_RISE)
}

impl Obstacle {
    /// Whether it does not move.
    pub(crate) fn is_still(&self) -> bool {
        self.motion == Motion::Still
    }

    /// Its displacement at a time (s).
    pub fn pose(&self, time: f64) -> Pose {
        self.motion.pose(time)
    }

    /// Unit normal and distance from the origin (m) of a floor at a time (s); `None` for other obstacles.
    pub fn floor(&self, time: f64) -> Option<(DVec3, f64)> {
        let Shape::Floor { normal, height } = self.shape else { return None };
        if self.is_still() {
            return Some((normal, height));
        }
        let (pose, pivot) = (self.pose(time), self.pivot);
        let normal = pose.rotation * normal;
        Some((normal, normal.dot(pose.apply(pivot, pivot))))
    }

    /// The depth of a point below its surface at a time (s), negative above it (m).
    pub(crate) fn depth(&self, point: DVec3, time: f64) -> f64 {
        self.shape.surface(self.pose(time).undo(self.pivot, point)).depth
    }

    /// Unit normal and distance from the origin (m) of a half-space at a time (s), a floor or a plate; `None` for other obstacles.
    pub(super) fn half_space(&self, time: f64) -> Option<(DVec3, f64)> {
        let (Shape::Floor { normal, .. } | Shape::Plate { normal, .. }) = self.shape else { return None };
        let pose = self.pose(time);
        let normal = pose.rotation * normal;
        Some((normal, normal.dot(pose.apply(self.pivot, self.shape.middle()))))
    }

    /// The obstacle at the end of a step of `step` (s) that ends at `time` (s).
    pub fn at(&self, time: f64, step: f64) -> Placed<'_> {
        // At the start nothing has moved yet.
        let poses = [(time - step).max(0.0), time];
        Placed { obstacle: self, moving: (!self.is_still()).then(|| poses.map(|time| self.pose(time))), step }
    }
}

/// An obstacle at one moment.
#[derive(Clone, Debug)]
pub struct Placed<'a> {
    pub(crate) obstacle: &'a Obstacle,
    /// Its displacements at the start and at the end of the step, if it moves.
    moving: Option<[Pose; 2]>,
    /// The step (s).
    pub(crate) step: f64,
}

impl Placed<'_> {
    /// The depth of a point inside the obstacle, and the velocity (m/s) of the obstacle there.
    ///
    /// The velocity is the displacement of the obstacle's material point in the last step divided by the step,
    /// consistent with the velocity of nodes.
    pub fn contact(&self, point: DVec3) -> Option<(Contact, DVec3)> {
        self.surface(point).filter(|(contact, _)| contact.depth > 0.0)
    }

    /// Like [`Self::contact`], but also for points on the surface, to round-off.
    fn surface(&self, point: DVec3) -> Option<(Contact, DVec3)> {
        let (shape, farthest) = (&self.obstacle.shape, point.abs().max_element());
        let (pivot, Some([before, now])) = (self.obstacle.pivot, &self.moving) else {
            let contact = shape.surface(point);
            return (contact.depth > -shape.round_off(farthest)).then_some((contact, DVec3::ZERO));
        };
        let own = now.undo(pivot, point);
        let Contact { depth, normal } = shape.surface(own);
        // Both positions are rounded, and so is the displacement between them.
        let farthest = farthest + own.abs().max_element() + pivot.abs().max_element();
        if depth <= -shape.round_off(farthest) {
            return None;
        }
        let velocity = (point - before.apply(pivot, own)) / self.step;
        Some((Contact { depth, normal: now.rotation * normal }, velocity))
    }

    /// A region that contains all points of contact, with a margin (m) for round-off.
    pub(crate) fn bound(&self, margin: f64) -> Bound {
        let (middle, now) = (self.obstacle.shape.middle(), self.moving.as_ref().map(|[_, now]| now));
        let middle = now.map_or(middle, |now| now.apply(self.obstacle.pivot, middle));
        match self.obstacle.shape {
            Shape::Floor { normal, .. } | Shape::Plate { normal, .. } => {
                let normal = now.map_or(normal, |now| now.rotation * normal);
                Bound::HalfSpace { normal, height: normal.dot(middle) + margin }
            }
            // In the plane obstacles are infinite across it, but all nodes have z = 0.
            Shape::Sphere { .. } | Shape::Capsule { .. } | Shape::Box { .. } => {
                let reach = DVec3::splat(self.obstacle.shape.reach() + margin);
                Bound::Box { low: middle - reach, high: middle + reach }
            }
        }
    }

    /// Whether it is a floor that does not move.
    pub(crate) fn is_still_floor(&self) -> bool {
        self.moving.is_none() && matches!(self.obstacle.shape, Shape::Floor { .. })
    }

    /// The rebound of all nodes; see [`Self::rebound`]: each node found inside rebounds, wherever it came from. `acceleration` is the constant one of each node in the step
    /// (m/s²); `None` for nodes that moved at constant velocity.
    pub(crate) fn rebound_all(&self, position: &mut [DVec3], velocity: &mut [DVec3], acceleration: Option<&[DVec3]>) {
        let acceleration = |node: usize| acceleration.map_or(DVec3::ZERO, |all| all[node]);
        let nodes = position.iter_mut().zip(velocity).enumerate();
        match (&self.moving, &self.obstacle.shape) {
            // Most scenes have one floor and most nodes are far above it, so its shape is read only once.
            (None, shape @ &Shape::Floor { normal, height }) => nodes.for_each(|(node, (position, velocity))| {
                let depth = height - normal.dot(*position);
                if depth > -shape.round_off(position.abs().max_element()) {
                    let contact = Contact { depth, normal };
                    self.push_out(contact, DVec3::ZERO, acceleration(node), position, velocity);
                }
            }),
            _ => nodes.for_each(|(node, (position, velocity))| self.rebound(position, velocity, acceleration(node))),
        }
    }

    /// The rebound of one node that moved in the step with a constant acceleration (m/s²): reflected with restitution,
    /// with its tangential velocity reduced by friction. A node on the surface, to round-off, rebounds if it
    /// approaches.
    pub fn rebound(&self, position: &mut DVec3, velocity: &mut DVec3, acceleration: DVec3) {
        if let Some((contact, own)) = self.surface(*position) {
            self.push_out(contact, own, acceleration, position, velocity);
        }
    }

    /// The rebound of a node inside.
    ///
    /// A node at depth `d` is moved to height `e d`. Only if it is approaching, its normal velocity `v_n` becomes `−e
    /// v_n`. Friction is proportional to that change: it reduces the tangential velocity by at most `μ |Δv_n|` and
    /// never reverses it; with [`FrictionOf::Path`] also the way along the surface since the node touched it. All velocities are
    /// relative to that of the obstacle (m/s).
    fn push_out(
        &self,
        Contact { depth, normal }: Contact,
        own: DVec3,
        acceleration: DVec3,
        position: &mut DVec3,
        velocity: &mut DVec3,
    ) {
        let &Obstacle { restitution, friction, friction_of, .. } = self.obstacle;
        let relative = *velocity - own;
        let approach = -normal.dot(relative);
        if approach > 0.0 {
            let pressing = -normal.dot(acceleration);
            let [height, speed] = bounce(restitution, depth, approach, pressing);
            *position += normal * (depth + height);
            let change = approach + speed;
            let slip = relative + normal * approach;
            let slip_speed = slip.length();
            let kept = if slip_speed > 0.0 { (1.0 - friction * change / slip_speed).max(0.0) } else { 0.0 };
            *velocity = slip * kept + normal * speed + own;
            if friction_of == FrictionOf::Path {
                let time = touching(restitution, depth, approach, pressing).min(self.step);
                let along = acceleration + normal * pressing;
                *position -= (slip * time - along * (0.5 * time * time)) * (1.0 - kept);
            }
        } else if depth > 0.0 {
            *position += normal * (depth * (1.0 + restitution));
        }
    }
}

/// The time (s) since a node touched an obstacle, for [`FrictionOf::Path`], from the arguments of [`bounce`].
///
/// It is counted from the height `e d` to which the node rebounds: `(1 + e) d/v`, or with an acceleration, which it has had since it
/// met the surface with the speed `√(v² − 2 a d)`, `(1 + e)` times `2 d` over the sum of both speeds. A node that rests on a surface
/// rebounds in each step, `g ΔT²/(1 + e)²` deep at `g ΔT/(1 + e)`, and so touches it for exactly the step.
fn touching(e: f64, depth: f64, approach: f64, pressing: f64) -> f64 {
    let met = (approach * approach - 2.0 * pressing * depth).max(0.0).sqrt();
    (1.0 + e) * (2.0 * depth.max(0.0) / (approach + met))
}

/// Height above the surface (m) and speed away from it (m/s) of an approaching node after its rebound.
///
/// `e` is the restitution coefficient, `depth` (m) and `approach` (m/s) the depth and speed of the node, and
/// `pressing` its acceleration into the surface in the step (m/s²).
///
/// At constant velocity: height `e d`, speed `e v`. An acceleration `a` has increased the speed on the way from the
/// surface to depth `d`, and reduces it on the way up: the node hit the surface with `v² − 2 a d`, left it with
/// `e²` of that, and at height `e d` it has `2 a e d` less. A node that does not reach that height is placed at its
/// highest point. So with `e = 1` the energy under a constant force is conserved for any step; the paper's `−e v`
/// alone would add `m a v ΔT` in each bounce.
fn bounce(e: f64, depth: f64, approach: f64, pressing: f64) -> [f64; 2] {
    if pressing == 0.0 {
        return [e * depth, e * approach];
    }
    let hit = (approach * approach - 2.0 * pressing * depth).max(0.0);
    let left = e * e * hit;
    let speed = left - 2.0 * pressing * (e * depth);
    if speed >= 0.0 { [e * depth, speed.sqrt()] } else { [left / (2.0 * pressing), 0.0] }
}
