//! Kernels at work in a simulation: which one computes a model on a body, and how contact and grips join in.

use super::lattice::{self, Lattice};
use super::{Around, Bound, Rotation, Runaway, Set};
use crate::sim::body::{Body, Dimension};
use crate::sim::contact::Obstacle;
use crate::sim::dynamics::{self, Dynamics, SpeedLimit};
use crate::sim::integrate::Integrator;
use crate::sim::model::Known;
use crate::sim::model::shape_based::{DampingReading, RotationReading, ShapeBased};
use crate::sim::state::{Memory, State};
use crate::sim::system::System;
use glam::DVec3;

/// A way of stepping one body with semi-implicit Euler that holds positions, velocities and memory in arrays of its own.
pub(super) trait Kernel: Send + Sync {
    /// Takes over a state: positions (m), velocities (m/s), and what the model remembers.
    fn load(&mut self, position: &[DVec3], velocity: &[DVec3], memory: &[f64]);
    /// Hands the state out.
    fn store(&self, position: &mut [DVec3], velocity: &mut [DVec3], memory: &mut [f64]);
    /// The position (m) and velocity (m/s) of a node.
    fn node(&self, node: usize) -> (DVec3, DVec3);
    /// Puts a node somewhere else.
    fn set_node(&mut self, node: usize, position: DVec3, velocity: DVec3);
    /// Takes steps.
    ///
    /// # Errors
    /// When a node would become faster than the limit. The state is then that before the step.
    fn step(&mut self, steps: u64, around: &Around<'_>) -> Result<(), Runaway>;
}

/// A kernel in a simulation.
pub(in crate::sim) struct ByKernel {
    kernel: Box<dyn Kernel>,
    /// Whether it holds the state.
    is_loaded: bool,
    /// The margin of contact (m): near enough to be asked.
    margin: f64,
}

impl ByKernel {
    /// The kernel for a model on a body; `None` if there is none, or none that knows this integrator.
    pub(in crate::sim) fn new(
        body: &Body,
        model: Known<'_>,
        integrator: Integrator,
        gravity: DVec3,
        step: f64,
    ) -> Option<Self> {
        /// Of the size of the body. Round-off decides at 1e-15 of the distance from the origin whether a node is on a
        /// surface, so this holds for bodies that are nearer than a billion times their size.
        const MARGIN: f64 = 1e-3;
        if integrator != Integrator::SemiImplicitEuler {
            return None;
        }
        let kernel = match model {
            Known::ShapeBased(model) => shape_based(body, model, gravity, step)?,
            Known::MassSpring(_) => return None,
        };
        Some(Self { kernel, is_loaded: false, margin: MARGIN * body.extent() })
    }
}

fn shape_based(body: &Body, model: &ShapeBased, gravity: DVec3, step: f64) -> Option<Box<dyn Kernel>> {
    let &ShapeBased { stiffness, damping, passes, rotation, damping_of } = model;
    if damping > 0.0 && damping_of == DampingReading::Deformation {
        return None;
    }
    let rotation = match rotation {
        RotationReading::Arctangent => Rotation::Arctangent { passes },
        RotationReading::Exact => Rotation::Quintic,
        RotationReading::VectorLength | RotationReading::LinearUpdate | RotationReading::Symmetric => return None,
    };
    if body.dimension == Dimension::Plane {
        return None;
    }
    let parameters = lattice::Parameters { stiffness, damping, rotation, gravity, step };
    Some(Box::new(Lattice::new(body, parameters, Set::best())?))
}

impl Dynamics for ByKernel {
    fn advance(
        &mut self,
        system: &System,
        limit: &SpeedLimit,
        state: &mut State,
        count: u64,
    ) -> Result<(), dynamics::Runaway> {
        if !self.is_loaded {
            self.kernel.load(&state.position, &state.velocity, &state.memory.model);
            self.is_loaded = true;
        }
        let obstacles = system.contact.obstacles().unwrap_or_default();
        let is_still = system.grips.is_empty() && obstacles.iter().all(Obstacle::is_still);
        let mut left = count;
        while left > 0 {
            let steps = if is_still { left } else { 1 };
            let interval = system.interval(state.steps);
            let placed: Vec<_> = obstacles.iter().map(|obstacle| obstacle.at(interval.end, interval.step)).collect();
            let bounds: Vec<Bound> = placed.iter().map(|obstacle| obstacle.bound(self.margin)).collect();
            let resolve = |_: usize, position: &mut DVec3, velocity: &mut DVec3, acceleration: DVec3| {
                placed.iter().for_each(|obstacle| obstacle.rebound(position, velocity, acceleration));
            };
            let first = state.steps;
            let speed_limit = |step: u64| limit.at(system.interval(first + step).end);
            let mut constraints = state.memory.constraints.clone();
            let kernel = &mut self.kernel;
            system.change_grips(&mut constraints, |grip, memory| {
                grip.reach(interval.end, memory, |node| kernel.node(node as usize).0);
            });
            let around = Around { bounds: &bounds, resolve: &resolve, speed_limit: &speed_limit };
            if let Err(Runaway { taken, node }) = kernel.step(steps, &around) {
                state.steps += taken;
                return Err(dynamics::Runaway { node });
            }
            state.memory.constraints = constraints;
            for (grip, memory) in system.grips(&state.memory.constraints) {
                grip.moved(interval, memory).for_each(|(node, to, speed)| kernel.set_node(node, to, speed));
            }
            state.steps += steps;
            left -= steps;
        }
        Ok(())
    }

    fn settle(&mut self, state: &mut State) {
        if self.is_loaded {
            let State { position, velocity, memory: Memory { model, .. }, .. } = state;
            self.kernel.store(position, velocity, model);
        }
    }

    fn restart(&mut self) {
        self.is_loaded = false;
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

    fn step(&mut self, steps: u64, around: &Around<'_>) -> Result<(), Runaway> {
        self.step(steps, around)
    }
}
