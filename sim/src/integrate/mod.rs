//! Time integration: Eqs. (2) and (3) and alternatives.

mod backward_euler;
pub(crate) mod composition;
mod dormand_prince;
mod explicit_euler;
pub(crate) mod quinlan_tremaine;
mod runge_kutta;
mod semi_implicit_euler;
mod velocity_verlet;

use self::backward_euler::BackwardEuler;
use self::composition::Composition;
use self::dormand_prince::DormandPrince;
use super::crew::Crew;
use super::dynamics::{Dynamics, Runaway, SpeedLimit};
use super::model::{ForceModel, Scratch};
use super::motion::Interval;
use super::state::{Nodes, State};
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
    /// Position-extended Forest–Ruth-like method: of fourth order and symplectic, with four evaluations a step and an
    /// error about 30 times smaller than that of `forest-ruth` for the same number of evaluations. Without damping only.
    Pefrl,
    /// Forest–Ruth: of fourth order and symplectic, with three evaluations a step. Without damping only.
    ForestRuth,
    /// Blanes–Moan, the Runge–Kutta–Nyström method with 14 evaluations a step: of sixth order and symplectic. Without
    /// damping only.
    BlanesMoan,
    /// The classical Runge–Kutta method: of fourth order, with four evaluations a step, also with damping. Not
    /// symplectic: in long runs its energy drifts.
    RungeKutta,
    /// Quinlan–Tremaine: a symmetric multistep method of eighth order with one evaluation a step. Of all methods it needs the
    /// fewest evaluations for errors below 1e-4 in free motion. Its first seven steps, and the seven after each step in which a
    /// node rebounds, are taken by a method of 18 evaluations: not for bodies that rest on something. Without damping only.
    QuinlanTremaine,
    /// Dormand–Prince: of fifth order, also with damping, with six evaluations in each substep. It finds its own substeps, from
    /// a `tolerance` that takes the place of `step`, between the times of frames, and the moment of each rebound. Not
    /// symplectic. Not for bodies that rest on something: there nodes rebound again and again, and substeps are no longer than
    /// about `√(tolerance · size / g)`, 0.1 ms for a body of 0.1 m and a tolerance of 1e-6; use `velocity-verlet`.
    DormandPrince,
    /// Backward Euler, implicit: of first order, and stable for any step, also with damping. For stiff bodies whose oscillations
    /// need not be resolved: it damps those faster than the step. It evaluates the forces some ten to a hundred times a step.
    BackwardEuler,
}

impl Integrator {
    /// The tolerance of a method with steps of its own, if a scene gives none.
    pub const TOLERANCE: f64 = 1e-6;

    /// Whether the method finds its steps from a tolerance.
    pub fn is_adaptive(self) -> bool {
        self == Self::DormandPrince
    }

    /// Why this method cannot advance a model, and which method can; `None` if it can.
    pub fn refusal(self, forces: impl FnOnce() -> Box<dyn ForceModel>) -> Option<&'static str> {
        if matches!(self, Self::SemiImplicitEuler | Self::ExplicitEuler | Self::VelocityVerlet) {
            return None;
        }
        let forces = forces();
        match self {
            _ if forces.depends_on_history() => Some(
                "evaluates forces several times a step, but a fixed number of passes gives forces that depend on the \
                 evaluation before; use `rotation = \"robust\"` without `passes`, or \"velocity-verlet\"",
            ),
            Self::RungeKutta | Self::DormandPrince | Self::BackwardEuler => None,
            Self::QuinlanTremaine if forces.is_damped() => Some(
                "needs forces that depend on positions alone, and damping depends on velocities; use \"runge-kutta\" or \
                 \"velocity-verlet\", or take the damping out",
            ),
            _ if forces.is_damped() => Some(
                "has substeps backwards in time, in which damping would feed energy in; use \"runge-kutta\" or \
                 \"velocity-verlet\", or take the damping out",
            ),
            _ => None,
        }
    }
}

/// The reference code: evaluates forces, then integrates. Every faster way is tested against it.
pub(super) struct ByForces {
    method: Method,
    trial: Trial,
}

/// The methods, some with buffers of their own.
enum Method {
    /// What needs no more than a [`Trial`].
    Simple(fn(&System, Interval, f64, &State, &mut Trial) -> Result<(), Runaway>),
    Composition(&'static Composition),
    DormandPrince(DormandPrince),
    BackwardEuler(BackwardEuler),
}

/// What is large for a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scales {
    /// The largest extent of a body at rest (m).
    pub(super) length: f64,
    /// `T/2π` of the shortest period T of all models (s).
    pub(super) time: f64,
}

/// A step that is being computed. The state is changed only when it is accepted.
struct Trial {
    /// The state at the end of the step.
    next: State,
    /// Stored evaluations of the forces, for integrators that need several.
    evaluations: [Vec<f64>; 2],
    /// Positions, then velocities, before contact.
    before_contact: Vec<DVec3>,
    scratch: Scratch,
}

impl ByForces {
    /// `tolerance` is for methods with steps of their own.
    pub(super) fn new(integrator: Integrator, tolerance: f64, scales: Scales, state: &State) -> Self {
        let method = match integrator {
            Integrator::SemiImplicitEuler => Method::Simple(semi_implicit_euler::step),
            Integrator::ExplicitEuler => Method::Simple(explicit_euler::step),
            Integrator::VelocityVerlet => Method::Simple(velocity_verlet::step),
            Integrator::Pefrl => Method::Composition(&composition::PEFRL),
            Integrator::ForestRuth => Method::Composition(&composition::FOREST_RUTH),
            Integrator::BlanesMoan => Method::Composition(&composition::BLANES_MOAN),
            Integrator::RungeKutta => Method::Simple(runge_kutta::step),
            Integrator::QuinlanTremaine => Method::Simple(quinlan_tremaine::step),
            Integrator::DormandPrince => Method::DormandPrince(DormandPrince::new(scales, tolerance)),
            Integrator::BackwardEuler => Method::BackwardEuler(BackwardEuler::new(scales)),
        };
        let (evaluations, before_contact, scratch) = Default::default();
        Self { method, trial: Trial { next: state.clone(), evaluations, before_contact, scratch } }
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
            let Self { method, trial } = self;
            trial.begin(system, interval, state);
            match method {
                Method::Simple(step) => step(system, interval, limit, state, trial),
                Method::Composition(method) => method.step(system, interval, limit, state, trial),
                Method::DormandPrince(method) => method.step(system, interval, limit, state, trial),
                Method::BackwardEuler(method) => method.step(system, interval, limit, state, trial),
            }?;
            trial.swap(state);
            state.steps += 1;
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

    /// Accepts what was computed, but for the number of steps.
    fn swap(&mut self, state: &mut State) {
        std::mem::swap(&mut state.position, &mut self.next.position);
        std::mem::swap(&mut state.velocity, &mut self.next.velocity);
        std::mem::swap(&mut state.memory, &mut self.next.memory);
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
        // The Euler methods have no memory.
        next.memory.integrator.clear();
        check(forces, limit)
    }
}

/// Computes accelerations (m/s²) and the next memory of the models, and stores them one after the other.
fn evaluate(system: &System, at: Nodes<'_>, memory: &[f64], out: &mut Vec<f64>, scratch: &mut Scratch) {
    out.resize(3 * at.position.len() + memory.len(), 0.0);
    let (acceleration, next) = out.split_at_mut(3 * at.position.len());
    let acceleration: &mut [DVec3] = bytemuck::cast_slice_mut(acceleration);
    system.forces(at, memory, next, scratch, acceleration);
    acceleration.iter_mut().zip(&system.mass).for_each(|(force, &mass)| *force /= mass);
}

/// Splits a stored evaluation into accelerations and memory of the models.
fn split<'a>(evaluation: &'a [f64], system: &System) -> (&'a [DVec3], &'a [f64]) {
    let (acceleration, model) = evaluation.split_at(3 * system.mass.len());
    (bytemuck::cast_slice(acceleration), model)
}

/// Contact and kinematic constraints at the end of a step that was computed without them, by a method of several
/// evaluations. A node rebounds as if its mean acceleration in the step had been constant.
fn finish(
    system: &System,
    interval: Interval,
    limit: f64,
    state: &State,
    next: &mut State,
    mean: &mut Vec<f64>,
) -> Result<(), Runaway> {
    check(&next.velocity, limit)?;
    mean.clear();
    let change = next.velocity.iter().zip(&state.velocity).map(|(&after, &before)| (after - before) / interval.step);
    mean.extend(change.flat_map(|acceleration| acceleration.to_array()));
    next.memory.integrator.clear();
    system.constrain(interval, state, next, Some(bytemuck::cast_slice(mean)));
    Ok(())
}

/// Like [`finish`]; returns whether a node has met an obstacle: what is known of the steps before then does not continue its
/// motion.
fn finish_and_tell(
    system: &System,
    interval: Interval,
    limit: f64,
    state: &State,
    trial: &mut Trial,
) -> Result<bool, Runaway> {
    let Trial { next, evaluations: [_, mean], before_contact, .. } = trial;
    // Placed before, a held node counts only if an obstacle moves it, too.
    system.place_held(interval, 1.0, next);
    before_contact.clear();
    before_contact.extend(next.position.iter().chain(&next.velocity));
    finish(system, interval, limit, state, next, mean)?;
    Ok(!next.position.iter().chain(&next.velocity).eq(&*before_contact))
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
