//! Time integration: Eqs. (2) and (3) and alternatives.

mod explicit_euler;
mod semi_implicit_euler;
mod velocity_verlet;

use super::crew::Crew;
use super::dynamics::{Dynamics, Runaway, SpeedLimit};
use super::model::Scratch;
use super::motion::Interval;
use super::state::State;
use super::system::System;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How positions and velocities are advanced by a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// Eq. (2), then Eq. (3) with the new velocity: symplectic, of first order.
    #[default]
    SemiImplicitEuler,
    /// Eqs. (2) and (3) as printed, the second with the old velocity. Its energy grows without bound: at ΔT = T/10 an
    /// oscillation grows by 18 % in each step. For comparison only.
    ExplicitEuler,
    /// Velocity Verlet: of second order, and symplectic without damping and rebounds. It evaluates the forces once in
    /// each step, and twice with damping.
    VelocityVerlet,
}

/// The reference code: evaluates forces, then integrates. Every faster way is tested against it.
pub(super) struct ByForces {
    integrator: Integrator,
    trial: Trial,
}

/// A step that is being computed. The state is changed only when it is accepted.
struct Trial {
    /// The state at the end of the step.
    next: State,
    /// Stored evaluations of the forces, for integrators that need several.
    evaluations: [Vec<f64>; 2],
    scratch: Scratch,
}

impl ByForces {
    pub(super) fn new(integrator: Integrator, state: &State) -> Self {
        let (evaluations, scratch) = Default::default();
        Self { integrator, trial: Trial { next: state.clone(), evaluations, scratch } }
    }
}

impl Dynamics for ByForces {
    fn advance(
        &mut self,
        system: &System,
        limit: &SpeedLimit,
        state: &mut State,
        count: u64,
        _: &mut Crew,
    ) -> Result<(), Runaway> {
        for _ in 0..count {
            let interval = system.interval(state.steps);
            let limit = limit.at(interval.end);
            self.trial.begin(system, interval, state);
            match self.integrator {
                Integrator::SemiImplicitEuler => {
                    semi_implicit_euler::step(system, interval, limit, state, &mut self.trial)
                }
                Integrator::ExplicitEuler => explicit_euler::step(system, interval, limit, state, &mut self.trial),
                Integrator::VelocityVerlet => velocity_verlet::step(system, interval, limit, state, &mut self.trial),
            }?;
            self.trial.accept(state);
        }
        Ok(())
    }
}

impl Trial {
    fn begin(&mut self, system: &System, interval: Interval, state: &State) {
        let constraints = &mut self.next.memory.constraints;
        constraints.clone_from(&state.memory.constraints);
        system.change_grips(constraints, |grip, memory| {
            grip.reach(interval.end, memory, |node| state.position[node as usize])
        });
    }

    fn accept(&mut self, state: &mut State) {
        std::mem::swap(&mut state.position, &mut self.next.position);
        std::mem::swap(&mut state.velocity, &mut self.next.velocity);
        std::mem::swap(&mut state.memory, &mut self.next.memory);
        state.steps += 1;
    }

    /// Eq. (2): evaluates the forces and writes the velocities (m/s) at the end of the step, `V + F/m ΔT`.
    ///
    /// # Errors
    /// When a node would become faster than the limit (m/s).
    #[doc(alias = "Eq. 2")]
    fn velocities(&mut self, system: &System, interval: Interval, limit: f64, state: &State) -> Result<(), Runaway> {
        let Self { next, scratch, .. } = self;
        let (memory, forces) = (&state.memory.model, &mut next.velocity);
        system.forces(state.nodes(), memory, &mut next.memory.model, scratch, forces);
        for ((force, &mass), &velocity) in forces.iter_mut().zip(&system.mass).zip(&state.velocity) {
            *force = velocity + *force / mass * interval.step;
        }
        // Only velocity Verlet has a memory.
        next.memory.integrator.clear();
        check(forces, limit)
    }
}

/// Whether all velocities (m/s) are within the limit.
fn check(velocities: &[DVec3], limit: f64) -> Result<(), Runaway> {
    let limit = limit * limit;
    // NaN is never within the limit.
    let within_bounds = |velocity: &DVec3| velocity.length_squared() <= limit;
    match velocities.iter().position(|velocity| !within_bounds(velocity)) {
        Some(node) => Err(Runaway { node }),
        None => Ok(()),
    }
}
