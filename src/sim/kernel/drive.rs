//! Kernels at work in a simulation: which one computes a model on a body, and how contact and grips join in.

use super::general::{Constants, General};
use super::lattice::{self, Lattice};
use super::motion::{self, Scheme};
use super::springs::Stencil;
use super::{Around, Bound, Rotation, Runaway, Set};
use crate::sim::body::{Body, Dimension};
use crate::sim::contact::Obstacle;
use crate::sim::dynamics::{self, Dynamics, SpeedLimit};
use crate::sim::integrate::Integrator;
use crate::sim::model::Known;
use crate::sim::model::mass_spring::MassSpring;
use crate::sim::model::shape_based::{DampingReading, RotationReading, ShapeBased};
use crate::sim::state::{Memory, State};
use crate::sim::system::System;
use glam::DVec3;

/// A way of stepping one body that holds positions, velocities and memory in arrays of its own.
pub(super) trait Kernel: Send + Sync {
    /// Takes over a state: positions (m), velocities (m/s), and what the model remembers.
    fn load(&mut self, position: &[DVec3], velocity: &[DVec3], memory: &[f64]);
    /// Hands the state out.
    fn store(&self, position: &mut [DVec3], velocity: &mut [DVec3], memory: &mut [f64]);
    /// The position (m) and velocity (m/s) of a node.
    fn node(&self, node: usize) -> (DVec3, DVec3);
    /// Puts a node somewhere else.
    fn set_node(&mut self, node: usize, position: DVec3, velocity: DVec3);
    /// Works with so many threads from now on, as far as there is work for them.
    fn set_threads(&mut self, threads: usize);
    /// Takes steps.
    ///
    /// # Errors
    /// When a node would become faster than the limit. The state is then that before the step.
    fn step(&mut self, scheme: Scheme, steps: u64, around: &Around<'_>) -> Result<(), Runaway>;
}

/// A kernel in a simulation.
pub(in crate::sim) struct ByKernel {
    kernel: Box<dyn Kernel>,
    scheme: Scheme,
    /// The steps taken and the memory of the constraints, if the kernel holds the state.
    holds: Option<(u64, Vec<f64>)>,
    /// The margin of contact (m): near enough to be asked.
    margin: f64,
}

impl ByKernel {
    /// The kernel for a model on a body; `None` if there is none, or none that knows this integrator.
    pub(in crate::sim) fn new(
        body: &Body,
        model: Known<'_>,
        integrator: Integrator,
        has_grips: bool,
        gravity: DVec3,
        step: f64,
    ) -> Option<Self> {
        /// Of the size of the body. Round-off decides at 1e-15 of the distance from the origin whether a node is on a
        /// surface, so this holds for bodies that are nearer than a billion times their size.
        const MARGIN: f64 = 1e-3;
        let scheme = match integrator {
            Integrator::SemiImplicitEuler => Scheme::SemiImplicitEuler,
            Integrator::ExplicitEuler => Scheme::ExplicitEuler,
            // Grips act within a step, and without damping accelerations go from one step to the next.
            Integrator::VelocityVerlet if has_grips || !model.is_damped() => return None,
            Integrator::VelocityVerlet => Scheme::VelocityVerlet,
        };
        let kernel = match model {
            Known::ShapeBased(model) => shape_based(body, model, scheme, gravity, step)?,
            Known::MassSpring(model) => mass_spring(body, model, gravity, step),
        };
        Some(Self { kernel, scheme, holds: None, margin: MARGIN * body.extent() })
    }
}

fn shape_based(body: &Body, model: &ShapeBased, scheme: Scheme, gravity: DVec3, step: f64) -> Option<Box<dyn Kernel>> {
    let &ShapeBased { stiffness, damping, passes, rotation, damping_of } = model;
    if damping > 0.0 && damping_of == DampingReading::Deformation {
        return None;
    }
    let rotation = match rotation {
        // Eq. (9) is exact.
        _ if body.dimension == Dimension::Plane => Rotation::Optimum,
        RotationReading::Arctangent => Rotation::Arctangent { passes },
        RotationReading::Exact => Rotation::Optimum,
        RotationReading::VectorLength | RotationReading::LinearUpdate | RotationReading::Symmetric => return None,
    };
    let parameters = lattice::Parameters { stiffness, damping, rotation, gravity, step };
    if let Some(lattice) = Lattice::new(body, parameters, scheme, Set::best(), 1) {
        return Some(Box::new(lattice));
    }
    Some(Box::new(General::new(body, rotation, Constants { stiffness, damping, gravity, step }, Set::best())))
}

fn mass_spring(body: &Body, model: &MassSpring, gravity: DVec3, step: f64) -> Box<dyn Kernel> {
    let MassSpring { stiffness, damping, springs } = model;
    let constants = Constants { stiffness: *stiffness, damping: *damping, gravity, step };
    match Stencil::new(springs, &body.rest, &body.mass, constants, Set::best()) {
        Some(stencil) => Box::new(stencil),
        None => Box::new(General::springs(body, springs, constants, Set::best())),
    }
}

impl Dynamics for ByKernel {
    fn advance(
        &mut self,
        system: &System,
        limit: &SpeedLimit,
        state: &mut State,
        count: u64,
    ) -> Result<(), dynamics::Runaway> {
        let Self { kernel, scheme, holds, margin } = self;
        let (done, constraints) = holds.get_or_insert_with(|| {
            kernel.load(&state.position, &state.velocity, &state.memory.model);
            (state.steps, state.memory.constraints.clone())
        });
        let obstacles = system.contact.obstacles().unwrap_or_default();
        let is_still = obstacles.iter().all(Obstacle::is_still);
        let mut left = count;
        while left > 0 {
            let interval = system.interval(*done);
            let steps = if is_still { system.steps_without_grips(*done).clamp(1, left) } else { 1 };
            let placed: Vec<_> = obstacles.iter().map(|obstacle| obstacle.at(interval.end, interval.step)).collect();
            let bounds: Vec<Bound> = placed.iter().map(|obstacle| obstacle.bound(*margin)).collect();
            let resolve = |_: usize, position: &mut DVec3, velocity: &mut DVec3, acceleration: DVec3| {
                placed.iter().for_each(|obstacle| obstacle.rebound(position, velocity, acceleration));
            };
            let first = *done;
            let speed_limit = |step: u64| limit.at(system.interval(first + step).end);
            let mut next = constraints.clone();
            system.change_grips(&mut next, |grip, memory| {
                grip.reach(interval.end, memory, |node| kernel.node(node as usize).0);
            });
            let floor = match &placed[..] {
                [one] => one.still_floor(),
                _ => None,
            };
            let around = Around { bounds: &bounds, resolve: &resolve, floor, speed_limit: &speed_limit };
            if let Err(Runaway { taken, node }) = kernel.step(*scheme, steps, &around) {
                *done += taken;
                return Err(dynamics::Runaway { node });
            }
            *constraints = next;
            for (grip, memory) in system.grips(constraints) {
                grip.moved(interval, memory).for_each(|(node, to, speed)| kernel.set_node(node, to, speed));
            }
            *done += steps;
            left -= steps;
        }
        Ok(())
    }

    fn settle(&mut self, state: &mut State) {
        if let Some((steps, known)) = &self.holds {
            let State { position, velocity, memory: Memory { model, constraints, .. }, .. } = state;
            self.kernel.store(position, velocity, model);
            constraints.clone_from(known);
            state.steps = *steps;
        }
    }

    fn steps(&self, state: &State) -> u64 {
        self.holds.as_ref().map_or(state.steps, |(steps, _)| *steps)
    }

    fn restart(&mut self) {
        self.holds = None;
    }

    fn set_threads(&mut self, threads: usize) {
        self.kernel.set_threads(threads);
    }
}

impl Kernel for Lattice {
    fn load(&mut self, position: &[DVec3], velocity: &[DVec3], memory: &[f64]) {
        self.load(position, velocity, memory);
    }

    fn store(&self, position: &mut [DVec3], velocity: &mut [DVec3], memory: &mut [f64]) {
        self.store(position, velocity, memory);
    }

    fn node(&self, node: usize) -> (DVec3, DVec3) {
        self.node(node)
    }

    fn set_node(&mut self, node: usize, position: DVec3, velocity: DVec3) {
        self.set_node(node, position, velocity);
    }

    fn set_threads(&mut self, threads: usize) {
        self.set_threads(threads);
    }

    /// It was made for its scheme.
    fn step(&mut self, _scheme: Scheme, steps: u64, around: &Around<'_>) -> Result<(), Runaway> {
        self.step(steps, around)
    }
}

impl Kernel for General {
    fn load(&mut self, position: &[DVec3], velocity: &[DVec3], memory: &[f64]) {
        self.load(position, velocity, memory);
    }

    fn store(&self, position: &mut [DVec3], velocity: &mut [DVec3], memory: &mut [f64]) {
        self.store(position, velocity, memory);
    }

    fn node(&self, node: usize) -> (DVec3, DVec3) {
        motion::Kernel::node(self, node)
    }

    fn set_node(&mut self, node: usize, position: DVec3, velocity: DVec3) {
        self.set_node(node, position, velocity);
    }

    fn set_threads(&mut self, threads: usize) {
        self.set_threads(threads);
    }

    fn step(&mut self, scheme: Scheme, steps: u64, around: &Around<'_>) -> Result<(), Runaway> {
        motion::advance(self, scheme, steps, *around)
    }
}

impl Kernel for Stencil {
    fn load(&mut self, position: &[DVec3], velocity: &[DVec3], _memory: &[f64]) {
        self.load(position, velocity);
    }

    fn store(&self, position: &mut [DVec3], velocity: &mut [DVec3], _memory: &mut [f64]) {
        self.store(position, velocity);
    }

    fn node(&self, node: usize) -> (DVec3, DVec3) {
        motion::Kernel::node(self, node)
    }

    fn set_node(&mut self, node: usize, position: DVec3, velocity: DVec3) {
        self.set_node(node, position, velocity);
    }

    fn set_threads(&mut self, threads: usize) {
        self.set_threads(threads);
    }

    fn step(&mut self, scheme: Scheme, steps: u64, around: &Around<'_>) -> Result<(), Runaway> {
        motion::advance(self, scheme, steps, *around)
    }
}
