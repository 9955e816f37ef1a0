//! Rest: the positions at which elastic forces balance gravity, loads and what holds bodies.
//!
//! Bodies that meet nothing are moved by [conjugate gradients](gradients), led by [groups of nodes](coarse). Where there is contact, and for
//! models without forces, they [move](motion) until they are at rest. Both take forces from steps: an acceleration is the velocity after a step
//! from rest, divided by the step. So the fast code computes it, and obstacles, friction and grips count as they do in a step.

mod coarse;
mod gradients;
mod motion;

use super::body::Body;
use super::contact::{Contacts, Obstacle, PairContact};
use super::crew::Crew;
use super::grip::Grip;
use super::integrate::Integrator;
use super::load::Load;
use super::model::ElasticModel;
use super::motion::{Interval, Motion, Pose};
use super::state::State;
use super::surroundings::Surroundings;
use super::world::{Stepping, World};
use glam::DVec3;
use std::f64::consts::TAU;
use std::sync::Arc;

/// The residual that is sought, as a share of the load.
const SOUGHT: f64 = 1e-9;
/// The largest residual of what counts as rest. Round-off and friction may keep it from being smaller.
const ENOUGH: f64 = 1e-6;
/// The same where surfaces meet, whose contact resolves one touch after another, and of which the residual is the mean over some steps.
const ENOUGH_OF_SURFACES: f64 = 1e-2;
const STEPS: u32 = 16;
/// Steps in the shortest period.
const STEPS_PER_PERIOD: f64 = 50.0;
/// The round-off of positions, relative to the largest coordinate.
const ROUND_OFF: f64 = 2.0 * f64::EPSILON;
/// The longest way of a node at a time, as a share of the size of the largest body.
const LONGEST: f64 = 0.05;
/// The most evaluations of forces.
const MOST: u64 = 200_000;

/// Bodies at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// The position of each node (m).
    pub position: Vec<DVec3>,
    /// The forces that are left on nodes, divided by the loads on them: the roots of the sums of their squares, without nodes that are
    /// held. Without loads, the forces at the start take their place. Of a load that is small beside the round-off of the forces much is left.
    pub residual: f64,
    /// How often the forces were evaluated.
    pub evaluations: u64,
}

/// Why no state of rest was found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoEquilibrium {
    /// Nothing holds a body, counted from 0, against a force (N).
    #[error("nothing holds body {body} against {} N", .force.length())]
    Unheld {
        /// The body.
        body: usize,
        /// The sum of gravity and loads on it at the start (N).
        force: DVec3,
    },
    /// Forces did not come to a balance.
    #[error("after {evaluations} evaluations of forces, {residual:.1e} of the load is left")]
    Unbalanced {
        /// As [`Equilibrium::residual`].
        residual: f64,
        /// As [`Equilibrium::evaluations`].
        evaluations: u64,
    },
}

/// Finds where bodies, each with its model, are at rest under what acts on them at the start, from the positions in `initial` on. Obstacles do
/// not move, loads stay as they are, and grips that hold nodes at the start hold them there. Contact does not rebound. The rest of a model that
/// [moves its nodes itself](ElasticModel::projection) depends on the time `step` (s), that of others does not.
///
/// A balance is a least potential near the start, as far as forces have one. Above the load at which it buckles, a straight column goes to any
/// side, or stays straight.
///
/// # Errors
/// When nothing holds a body, or no balance was found.
///
/// # Panics
/// As [`World::of_parts`].
pub fn equilibrium(
    bodies: &[(Arc<Body>, &dyn ElasticModel)],
    initial: &State,
    surroundings: &Surroundings,
    step: f64,
    crew: Crew,
) -> Result<Equilibrium, NoEquilibrium> {
    let moves = bodies.iter().any(|(body, model)| model.projection(body).is_some());
    let period = |(body, model): &(Arc<Body>, &dyn ElasticModel)| model.properties(body).shortest_period(body);
    let shortest = bodies.iter().map(period).fold(f64::INFINITY, f64::min);
    let step = if moves { step } else { shortest / STEPS_PER_PERIOD };
    let around = at_start(surroundings);
    let meets = !around.obstacles.is_empty() || around.contacts.is_some() && bodies.len() > 1;
    let meets = meets || around.contacts.iter().flat_map(|contacts| &contacts.bodies).any(|body| body.itself);
    let crew = Arc::new(crew);
    let world = |position: &[DVec3]| {
        let start = State::at_rest(position.to_vec());
        let stepping = Stepping::new(Integrator::SemiImplicitEuler, step);
        let mut world = World::of_parts(bodies, start, around.clone(), stepping);
        world.set_free(&crew);
        world
    };
    let mut forces = Forces::new(world(&initial.position), bodies, shortest);
    if !meets {
        forces.check_held(bodies)?;
    }
    let longest = LONGEST * bodies.iter().map(|(body, _)| body.extent()).fold(0.0, f64::max);
    let (steps, enough) = if forces.world.has_surfaces() { (STEPS, ENOUGH_OF_SURFACES) } else { (1, ENOUGH) };
    let position = if meets || moves {
        motion::settle(&mut forces, steps)
    } else {
        gradients::descend(&mut forces, &coarse::Groups::new(bodies), longest)
    };
    // A model whose forces depend on its history has others in a world that starts there.
    forces.world = world(&position);
    let [residual, beside_round_off] = match forces.mean(&position, steps) {
        Some(left) => forces.residuals(&position, &left),
        None => [f64::INFINITY; 2],
    };
    let evaluations = forces.evaluations;
    if beside_round_off <= enough {
        Ok(Equilibrium { position, residual, evaluations })
    } else {
        Err(NoEquilibrium::Unbalanced { residual, evaluations })
    }
}

/// The forces on nodes at rest.
struct Forces {
    world: World,
    mass: Vec<f64>,
    is_held: Vec<bool>,
    /// The size of the forces at the start, which is the load without loads.
    first: Option<f64>,
    /// The least load (N): that of which round-off of the forces is the share that is sought.
    least: f64,
    /// The square of the shortest period over 2π (s²).
    fast: f64,
    evaluations: u64,
}

impl Forces {
    fn new(world: World, bodies: &[(Arc<Body>, &dyn ElasticModel)], shortest: f64) -> Self {
        let (mass, is_held) = (world.masses().to_vec(), world.held_at_start());
        let rounded = bodies.iter().map(|(body, model)| {
            let far = body.rest().iter().fold(body.extent(), |far, at| far.max(at.abs().max_element()));
            let force = ROUND_OFF * far * model.properties(body).stiffest;
            force * force * body.len() as f64
        });
        let least = rounded.sum::<f64>().sqrt() / SOUGHT;
        let swing = shortest / TAU;
        Self { world, mass, is_held, first: None, least, fast: swing * swing, evaluations: 0 }
    }

    /// Writes the acceleration (m/s²) of each node at rest at a position (m), zero for nodes that are held. False if one is not finite.
    fn accelerations(&mut self, position: &[DVec3], out: &mut Vec<DVec3>) -> bool {
        self.world.place(position);
        self.evaluations += 1;
        let is_finite = self.world.take_step();
        let step = self.world.step();
        out.clear();
        let velocities = self.world.state().velocity.iter().zip(&self.is_held);
        out.extend(velocities.map(|(&velocity, &is_held)| if is_held { DVec3::ZERO } else { velocity / step }));
        is_finite
    }

    /// The forces that are left with accelerations (m/s²) at positions (m), as a share of the load, or of the least load if that is larger.
    fn residual(&mut self, position: &[DVec3], acceleration: &[DVec3]) -> f64 {
        self.residuals(position, acceleration)[1]
    }

    /// The forces that are left as a share of the load, and [`Self::residual`].
    fn residuals(&mut self, position: &[DVec3], acceleration: &[DVec3]) -> [f64; 2] {
        let left = acceleration.iter().zip(&self.mass).map(|(&acceleration, &mass)| acceleration * mass);
        let left = size(left);
        let first = *self.first.get_or_insert(left);
        let loads = self.world.loads(position).into_iter().zip(&self.is_held);
        let load = size(loads.filter(|(_, is_held)| !**is_held).map(|(force, _)| force));
        let load = if load > 0.0 { load } else { first.max(self.least) };
        // Nothing is left of no load.
        [if left > 0.0 { left / load } else { 0.0 }, left / self.least.max(load)]
    }

    /// # Errors
    /// A body of which no node is held, with a force on it.
    fn check_held(&self, bodies: &[(Arc<Body>, &dyn ElasticModel)]) -> Result<(), NoEquilibrium> {
        let loads = self.world.loads(&self.world.state().position);
        let mut first = 0;
        for (body, (of, _)) in bodies.iter().enumerate() {
            let nodes = first..first + of.len();
            first = nodes.end;
            let force: DVec3 = loads[nodes.clone()].iter().sum();
            let all: f64 = loads[nodes.clone()].iter().map(|force| force.length()).sum();
            if !self.is_held[nodes].contains(&true) && force.length() > ENOUGH * all {
                return Err(NoEquilibrium::Unheld { body, force });
            }
        }
        Ok(())
    }

    /// Twice the kinetic energy of nodes that are not held (J).
    fn kinetic_energy(&self) -> f64 {
        let speeds = self.world.state().velocity.iter().zip(&self.mass).zip(&self.is_held);
        speeds.filter(|(_, is_held)| !**is_held).map(|((speed, mass), _)| mass * speed.length_squared()).sum()
    }

    /// The mean accelerations (m/s²) in some steps from rest at a position (m); `None` if one is not finite.
    fn mean(&mut self, position: &[DVec3], steps: u32) -> Option<Vec<DVec3>> {
        let mut left = Vec::new();
        if !self.accelerations(position, &mut left) {
            return None;
        }
        for _ in 1..steps {
            self.evaluations += 1;
            if !self.world.take_step() {
                return None;
            }
        }
        let all = f64::from(steps) * self.world.step();
        let velocities = self.world.state().velocity.iter().zip(&self.is_held);
        Some(velocities.map(|(&velocity, &is_held)| if is_held { DVec3::ZERO } else { velocity / all }).collect())
    }
}

/// The root of the sum of squares.
fn size(vectors: impl Iterator<Item = DVec3>) -> f64 {
    vectors.map(|vector| vector.length_squared()).sum::<f64>().sqrt()
}

/// Surroundings that stay as they are at the start, without rebounds.
fn at_start(around: &Surroundings) -> Surroundings {
    let fixed = |pose: Pose| if pose == Pose::NONE { Motion::Still } else { Motion::Along(Arc::new(move |_| pose)) };
    let obstacle =
        |obstacle: &Obstacle| Obstacle { motion: fixed(obstacle.pose(0.0)), restitution: 0.0, ..obstacle.clone() };
    let grip = |grip: &Grip| Grip { until: f64::INFINITY, motion: Motion::Still, ..grip.clone() };
    let contacts = around.contacts.clone().map(|contacts| Contacts {
        restitution: 0.0,
        pairs: contacts.pairs.iter().map(|&pair| PairContact { restitution: Some(0.0), ..pair }).collect(),
        ..contacts
    });
    Surroundings {
        gravity: around.gravity,
        mass_damping: 0.0,
        obstacles: around.obstacles.iter().map(obstacle).collect(),
        contacts,
        grips: around.grips.iter().filter(|grip| grip.holds(0.0)).map(grip).collect(),
        loads: around.loads.iter().map(|load| Arc::new(AtStart(Arc::clone(load))) as Arc<dyn Load>).collect(),
    }
}

/// A load as it is at the start.
struct AtStart(Arc<dyn Load>);

impl Load for AtStart {
    fn add(&self, _: f64, position: &[DVec3], forces: &mut [DVec3]) {
        self.0.add(0.0, position, forces);
    }

    fn nodes(&self) -> Option<&[u32]> {
        self.0.nodes()
    }

    fn is_steady(&self, Interval { step, .. }: Interval) -> bool {
        self.0.is_steady(Interval { begin: 0.0, end: 0.0, step })
    }
}
