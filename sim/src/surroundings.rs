//! What acts on bodies from outside: gravity, damping of all motion, forces on nodes, obstacles and kinematic constraints.

use super::contact::{Contacts, Obstacle, Shape, Side};
use super::grip::Grip;
use super::load::Load;
use super::motion::{Interval, Motion, Offset};
use glam::DVec3;
use std::sync::Arc;

/// Gravity, damping of all motion, forces, obstacles and kinematic constraints around bodies.
#[derive(Clone, Debug, Default)]
pub struct Surroundings {
    /// Acceleration of gravity (m/s²).
    pub gravity: DVec3,
    /// Damping in proportion to masses, `α` of Rayleigh (1/s): the force `−α m V` on each node. It brakes all motion, also that of a body as
    /// a whole, and slow oscillations the most: the damping ratio of a mode with angular frequency `ω` is `α / 2ω`.
    pub mass_damping: f64,
    /// Obstacles, in the order in which they act.
    pub obstacles: Vec<Obstacle>,
    /// How surfaces meet; `None` for contact of nodes with obstacles alone, as in the paper.
    pub contacts: Option<Contacts>,
    /// Kinematic constraints, applied after all obstacles.
    pub grips: Vec<Grip>,
    /// Forces on nodes: constant ones, and others that change with time or with the positions of nodes.
    pub loads: Vec<Arc<dyn Load>>,
}

/// A mistake in the surroundings of bodies: what was found where, and what was expected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct WrongSurroundings {
    /// What is wrong: a `node`, an `obstacle`, a `grip`, a `contact` (of a body, or a pair), `gravity`, or `mass_damping`.
    pub of: &'static str,
    /// Its number, counted from 0.
    pub at: usize,
    /// The mistake.
    pub message: String,
}

/// A value that is out of range: its name, what was found, and what was expected.
type Fault = (&'static str, String, &'static str);

impl Surroundings {
    /// Checks everything for bodies with so many nodes together.
    ///
    /// # Errors
    /// The first mistake.
    pub fn check(&self, nodes: usize) -> Result<(), WrongSurroundings> {
        if !self.gravity.is_finite() {
            let message = format!("gravity is {}; expected finite numbers (m/s²)", self.gravity);
            return Err(WrongSurroundings { of: "gravity", at: 0, message });
        }
        if !(self.mass_damping >= 0.0 && self.mass_damping.is_finite()) {
            let message = format!("mass_damping is {}; expected a finite number, 0 or more (1/s)", self.mass_damping);
            return Err(WrongSurroundings { of: "mass_damping", at: 0, message });
        }
        let value = |of, at| {
            move |(value, found, expected): Fault| {
                let message = format!("the {value} of {of} {at} is {found}; expected {expected}");
                WrongSurroundings { of, at, message }
            }
        };
        for (at, obstacle) in self.obstacles.iter().enumerate() {
            fault_of_obstacle(obstacle).map_or(Ok(()), Err).map_err(value("obstacle", at))?;
        }
        if let Some((at, found)) =
            self.contacts.as_ref().and_then(|contacts| fault_of_contacts(contacts, self.obstacles.len()))
        {
            return Err(value("contact", at)(found));
        }
        for (at, load) in self.loads.iter().enumerate() {
            check_nodes(&format!("load {at}"), load.nodes().unwrap_or_default(), nodes)?;
        }
        for (at, grip) in self.grips.iter().enumerate() {
            check_nodes(&format!("grip {at}"), &grip.nodes, nodes)?;
            fault_of_grip(grip).map_or(Ok(()), Err).map_err(value("grip", at))?;
        }
        Ok(())
    }

    /// Whether forces from outside are the same at all times and positions in a step.
    pub(super) fn are_steady(&self, interval: Interval) -> bool {
        self.loads.iter().all(|load| load.is_steady(interval))
    }

    /// The greatest forces from outside on nodes at `position` (m), as far as they are known.
    pub(super) fn greatest(&self, position: &[DVec3]) -> Option<Vec<DVec3>> {
        let mut forces = vec![DVec3::ZERO; position.len()];
        self.loads.iter().all(|load| load.add_greatest(position, &mut forces)).then_some(forces)
    }

    /// The nodes of so many that forces from outside are on, in rising order.
    pub(super) fn loaded(&self, nodes: usize) -> Vec<u32> {
        if self.loads.iter().any(|load| load.nodes().is_none()) {
            return (0..nodes as u32).collect();
        }
        let mut all: Vec<u32> = self.loads.iter().flat_map(|load| load.nodes().unwrap_or_default()).copied().collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Adds the forces from outside on nodes at `position` (m) at a time (s).
    pub(super) fn push(&self, time: f64, position: &[DVec3], forces: &mut [DVec3]) {
        self.loads.iter().for_each(|load| load.add(time, position, forces));
    }
}

/// Checks that there is a finite vector for each node.
pub(super) fn check_vectors(
    one: &'static str,
    what: &'static str,
    given: &[DVec3],
    nodes: usize,
) -> Result<(), WrongSurroundings> {
    if given.len() != nodes {
        let message = format!("there are {} {what} for {nodes} nodes; give one for each", given.len());
        return Err(WrongSurroundings { of: "node", at: nodes.min(given.len()), message });
    }
    match given.iter().position(|vector| !vector.is_finite()) {
        Some(at) => {
            let message = format!("the {one} of node {at} is {}; expected finite numbers", given[at]);
            Err(WrongSurroundings { of: "node", at, message })
        }
        None => Ok(()),
    }
}

/// Checks that nodes are there.
pub(super) fn check_nodes(of: &str, named: &[u32], nodes: usize) -> Result<(), WrongSurroundings> {
    match named.iter().find(|&&node| node as usize >= nodes) {
        Some(&node) => {
            let message = format!("{of} names node {node}; the last one is {}", nodes.saturating_sub(1));
            Err(WrongSurroundings { of: "node", at: node as usize, message })
        }
        None => Ok(()),
    }
}

fn fault_of_obstacle(obstacle: &Obstacle) -> Option<Fault> {
    let &Obstacle { ref shape, ref motion, pivot, restitution, friction, .. } = obstacle;
    let vector =
        |value, vector: DVec3| (!vector.is_finite()).then(|| (value, vector.to_string(), "finite numbers (m)"));
    let unit = |normal: DVec3| {
        let is_unit = (normal.length() - 1.0).abs() < 1e-6;
        (!is_unit).then(|| ("normal", normal.to_string(), "a vector of length 1"))
    };
    let size =
        |value, size: f64| (!(0.0..=f64::INFINITY).contains(&size)).then(|| (value, size.to_string(), "0 or more (m)"));
    let finite = |value, size: f64| (!size.is_finite()).then(|| (value, size.to_string(), "a finite number (m)"));
    let of_shape = match *shape {
        Shape::Floor { normal, height } => unit(normal).or_else(|| finite("height", height)),
        Shape::Plate { point, normal } => unit(normal).or_else(|| vector("point", point)),
        Shape::Sphere { centre, radius } => vector("centre", centre).or_else(|| size("radius", radius)),
        Shape::Capsule { from, to, radius } => {
            vector("end", from).or_else(|| vector("end", to)).or_else(|| size("radius", radius))
        }
        Shape::Box { centre, half, rotation } => {
            let turned =
                (!rotation.is_normalized()).then(|| ("rotation", rotation.to_string(), "a quaternion of length 1"));
            turned.or_else(|| vector("centre", centre)).or_else(|| size("half side", half.min_element()))
        }
    };
    let of_touch = || fault_of_restitution(restitution).or_else(|| fault_of_friction(friction));
    of_shape.or_else(|| vector("pivot", pivot)).or_else(of_touch).or_else(|| fault_of_motion(motion))
}

fn fault_of_restitution(value: f64) -> Option<Fault> {
    let is_wrong = !(0.0..=1.0).contains(&value);
    is_wrong.then(|| ("restitution", value.to_string(), "a number from 0 to 1"))
}

fn fault_of_friction(value: f64) -> Option<Fault> {
    let is_wrong = !(value >= 0.0 && value.is_finite());
    is_wrong.then(|| ("friction", value.to_string(), "a finite number of 0 or more"))
}

/// The first mistake, and the number of the body or of the pair with it.
fn fault_of_contacts(contacts: &Contacts, obstacles: usize) -> Option<(usize, Fault)> {
    let thick = |value: f64| {
        let wrong = !(value > 0.0 && value.is_finite());
        wrong.then(|| ("thickness", value.to_string(), "a finite number above 0 (m)"))
    };
    let usual = fault_of_restitution(contacts.restitution).or_else(|| fault_of_friction(contacts.friction));
    let usual = usual.map(|fault| (0, fault));
    let of_bodies = || (0..).zip(&contacts.bodies).find_map(|(at, body)| Some((at, thick(body.thickness?)?)));
    let of_pairs = || {
        (0..).zip(&contacts.pairs).find_map(|(at, pair)| {
            let is_there = |side: &Side| !matches!(side, Side::Obstacle(number) if *number >= obstacles);
            let missing = || {
                let side = pair.of.iter().find(|side| !is_there(side))?;
                Some(("side", format!("{side:?}"), "a body or an obstacle that is there"))
            };
            let fault = pair.restitution.and_then(fault_of_restitution);
            let fault = fault.or_else(|| pair.friction.and_then(fault_of_friction));
            Some((at, fault.or_else(|| pair.thickness.and_then(thick)).or_else(missing)?))
        })
    };
    usual.or_else(of_bodies).or_else(of_pairs)
}

fn fault_of_grip(grip: &Grip) -> Option<Fault> {
    let is_wrong = !(grip.from <= grip.until && grip.from.is_finite());
    let times = is_wrong.then(|| {
        ("time", format!("from {} s until {} s", grip.from, grip.until), "a finite start that is not after the end")
    });
    times.or_else(|| fault_of_motion(&grip.motion))
}

fn is_finite(offset: &Offset) -> bool {
    offset.shift.is_finite() && offset.rotation.is_finite()
}

fn fault_of_motion(motion: &Motion) -> Option<Fault> {
    match motion {
        Motion::Keys { keys, .. } => {
            let is_wrong = |&at: &usize| {
                let is_late = at == 0 || keys[at].time > keys[at - 1].time;
                !(is_late && keys[at].time.is_finite() && is_finite(&keys[at].offset))
            };
            let at = (0..keys.len()).find(is_wrong)?;
            Some((
                "path",
                format!("{:?} at key {at}", keys[at]),
                "finite numbers, with a later time than the key before",
            ))
        }
        Motion::Swing { period, phase, amplitude } => {
            let is_wrong = !(*period > 0.0 && period.is_finite() && phase.is_finite() && is_finite(amplitude));
            is_wrong.then(|| ("swing", format!("{motion:?}"), "finite numbers, with a period above 0 (s)"))
        }
        Motion::Still | Motion::Along(_) => None,
    }
}
