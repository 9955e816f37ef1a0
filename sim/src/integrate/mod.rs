//! Time integration: Eqs. (2) and (3) and alternatives.
//!
//! Every method is a [`Method`], which sees a world through a [`Step`]. Methods of other crates implement it, too.

mod backward_euler;
pub(crate) mod composition;
mod dormand_prince;
mod euler;
mod runge_kutta;
mod velocity_verlet;

pub use self::composition::{ByComposition, Composition};

use self::backward_euler::BackwardEuler;
use self::dormand_prince::DormandPrince;
use self::euler::Euler;
use self::runge_kutta::RungeKutta;
use self::velocity_verlet::VelocityVerlet;
use super::body::Body;
use super::contact::Timing;
use super::dynamics::Dynamics;
use super::limit::SpeedLimit;
use super::model::{ElasticModel, Scratch};
pub use super::motion::Interval;
use super::part::Part;
use super::state::{Nodes, State};
pub use super::state::{Runaway, Unsolved};
use super::system::System;
use glam::DVec3;
use std::sync::Arc;

/// The integrator, which advances positions and velocities by a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "scene", serde(rename_all = "kebab-case"))]
pub enum Integrator {
    /// Eq. (2), then Eq. (3) with the new velocity: symplectic, of first order.
    #[default]
    SemiImplicitEuler,
    /// Eqs. (2) and (3) as printed, the second with the old velocity. Its energy grows without bound: at ΔT = T/10 an
    /// oscillation grows by 18 % in each step. For comparison only.
    ExplicitEuler,
    /// Velocity Verlet: of second order, and symplectic without damping and rebounds, with one evaluation of forces a
    /// step, and two with damping.
    VelocityVerlet,
    /// Position-extended Forest–Ruth-like method: of fourth order and symplectic, with four evaluations a step. Without
    /// damping only.
    Pefrl,
    /// The classical Runge–Kutta method: of fourth order, also with damping, with four evaluations a step. Not
    /// symplectic: in long runs its energy drifts.
    RungeKutta,
    /// Dormand–Prince: of fifth order, also with damping, with six evaluations in each substep. It chooses substeps
    /// between the times of frames from a `tolerance`, which takes the place of `step`, and finds the moment of each
    /// rebound. Not symplectic. Not for bodies that rest on something: their nodes rebound again and again, and
    /// substeps are at most about `√(tolerance · size / g)`, 0.1 ms for a body of 0.1 m and a tolerance of 1e-6. Use
    /// `velocity-verlet` for them.
    DormandPrince,
    /// Backward Euler, implicit: of first order, also with damping, and stable for any step. For stiff bodies whose
    /// oscillations need not be resolved: it damps oscillations faster than the step. It evaluates the forces some ten
    /// to a hundred times a step.
    BackwardEuler,
}

impl Integrator {
    /// The tolerance of a method with steps of its own, if a scene gives none.
    pub const TOLERANCE: f64 = 1e-6;

    /// Whether the method finds its steps from a tolerance.
    pub fn is_adaptive(self) -> bool {
        self == Self::DormandPrince
    }

    /// Whether its order is above 2.
    pub(super) fn is_fine(self) -> bool {
        matches!(self, Self::Pefrl | Self::RungeKutta | Self::DormandPrince)
    }

    /// Why this method cannot advance a model with damping of masses (1/s), and which method can; `None` if it can.
    pub fn refusal(self, model: &dyn ElasticModel, body: &Arc<Body>, mass_damping: f64) -> Option<&'static str> {
        if self == Self::SemiImplicitEuler {
            return None;
        }
        if model.projection(body).is_some() {
            return Some(
                "cannot step a model such as `xpbd`, which moves its nodes itself, by constraints in place of forces; use \
                 \"semi-implicit-euler\" for it",
            );
        }
        if matches!(self, Self::ExplicitEuler | Self::VelocityVerlet) {
            return None;
        }
        let forces = model.prepare(body);
        match self {
            _ if forces.depends_on_history() => Some(
                "evaluates forces several times a step, but a fixed number of passes gives forces that depend on the \
                 evaluation before; use `rotation = \"robust\"` without `passes`, or \"velocity-verlet\"",
            ),
            Self::RungeKutta | Self::DormandPrince | Self::BackwardEuler => None,
            _ if forces.is_damped() || mass_damping > 0.0 => Some(
                "has substeps backwards in time, in which damping would feed energy in; use \"runge-kutta\" or \
                 \"velocity-verlet\", or take the damping out",
            ),
            _ => None,
        }
    }
}

/// A method of integration, which computes one step of a [`World`](super::World). [`World::set_method`](super::World::set_method)
/// takes one from another crate.
///
/// # Contract
/// A step is a function of the state. A method keeps its memory in [`Memory::integrator`](super::Memory::integrator), and only buffers
/// in itself. So a run that is continued from a copy of its state has the same bits. Memory of an unexpected length belongs to another
/// method.
///
/// # Example
/// The midpoint rule, of second order:
/// ```
/// use localshape_sim::State;
/// use localshape_sim::integrate::{Evaluation, Method, Runaway, Step};
///
/// #[derive(Default)]
/// struct Midpoint(Evaluation);
///
/// impl Method for Midpoint {
///     fn step(&mut self, step: &Step<'_>, state: &State, next: &mut State) -> Result<(), Runaway> {
///         let time = step.interval().step;
///         next.memory.model.clone_from(&state.memory.model);
///         (next.position.clone_from(&state.position), next.velocity.clone_from(&state.velocity));
///         for (from, share) in [(0.0, 0.5), (0.5, 1.0)] {
///             step.evaluate(from, next.nodes(), &next.memory.model, &mut self.0);
///             next.memory.model.copy_from_slice(&self.0.memory);
///             for (node, &acceleration) in self.0.acceleration.iter().enumerate() {
///                 next.position[node] = state.position[node] + next.velocity[node] * (share * time);
///                 next.velocity[node] = state.velocity[node] + acceleration * (share * time);
///             }
///             step.place_held(share, next);
///         }
///         step.finish(state, next)
///     }
///
///     fn copy(&self) -> Box<dyn Method> {
///         Box::<Self>::default()
///     }
/// }
/// ```
pub trait Method: Send + Sync {
    /// Writes the positions, the velocities and the memory of the models and of the integrator at the end of the step to `next`, which
    /// has the lengths of `state` and the memory of kinematic constraints already. Most methods end with [`Step::finish`].
    ///
    /// # Errors
    /// When a node would become too fast; see [`Step::check`].
    fn step(&mut self, step: &Step<'_>, state: &State, next: &mut State) -> Result<(), Runaway>;

    /// A copy for another world. Buffers need not be copied.
    fn copy(&self) -> Box<dyn Method>;

    /// The steps up to a state whose equation an implicit method has not solved; `None` if it has solved all.
    fn unsolved(&self, state: &State) -> Option<Unsolved> {
        let _ = state;
        None
    }
}

/// Accelerations and the next memory of the models, computed together. Methods keep it from step to step to save allocations.
#[derive(Debug, Default)]
pub struct Evaluation {
    /// The acceleration of each node (m/s²).
    pub acceleration: Vec<DVec3>,
    /// The next memory of the models.
    pub memory: Vec<f64>,
    scratch: Scratch,
}

/// A step of a world, as a [`Method`] sees it.
#[derive(Clone, Copy)]
pub struct Step<'a> {
    system: &'a System,
    interval: Interval,
    limit: f64,
}

impl Step<'_> {
    /// When it begins and ends.
    pub fn interval(&self) -> Interval {
        self.interval
    }

    /// The mass of each node (kg).
    pub fn masses(&self) -> &[f64] {
        &self.system.mass
    }

    /// Whether forces depend on velocities.
    pub fn is_damped(&self) -> bool {
        self.system.is_damped()
    }

    /// Evaluates the forces of models, gravity and forces from outside on nodes after a `share` of the step, with the memory that models had
    /// after the last evaluation.
    pub fn evaluate(&self, share: f64, at: Nodes<'_>, memory: &[f64], out: &mut Evaluation) {
        let Evaluation { acceleration, memory: next, scratch } = out;
        acceleration.resize(at.position.len(), DVec3::ZERO);
        next.resize(memory.len(), 0.0);
        self.system.forces(self.interval.after(share), at, memory, next, scratch, acceleration);
        acceleration.iter_mut().zip(&self.system.mass).for_each(|(force, &mass)| *force /= mass);
    }

    /// Places the nodes that kinematic constraints hold at the end of the step where they are after a `share` of it, with their
    /// velocity in the step.
    pub fn place_held(&self, share: f64, next: &mut State) {
        self.system.place_held(self.interval, share, next);
    }

    /// Writes the velocities of the nodes that kinematic constraints hold at the end of the step, after a method has changed them.
    pub fn hold(&self, next: &mut State) {
        for (_, node, _, speed) in self.system.held(self.interval, &next.memory.constraints) {
            next.velocity[node] = speed;
        }
    }

    /// Calls `each` with the nodes that kinematic constraints hold at the end of the step.
    pub fn for_each_held(&self, next: &State, mut each: impl FnMut(usize)) {
        self.system.held(self.interval, &next.memory.constraints).for_each(|(_, node, ..)| each(node));
    }

    /// The elastic energy (J) of nodes at `position` (m), with the memory of models; `None` if a model has none.
    fn energy(&self, position: &[DVec3], memory: &[f64]) -> Option<f64> {
        // Energies do not depend on velocities.
        let at = Nodes { position, velocity: position };
        let of_part =
            |part: &Part| part.forces.report(part.nodes_of(at), &memory[part.memory.clone()], &mut |_, _, _| {}).energy;
        self.system.parts.iter().map(of_part).sum()
    }

    /// Gives the nodes that are [held](Self::hold) their velocities, and checks that no node is faster than the speed limit.
    ///
    /// # Errors
    /// The first node above the limit, or with a velocity that is NaN: the world has diverged, and keeps its last state.
    pub fn check(&self, next: &mut State) -> Result<(), Runaway> {
        self.system.feel_grips(self.interval, next);
        self.hold(next);
        let limit = self.limit * self.limit;
        // NaN is never within the limit.
        let within_bounds = |velocity: &DVec3| velocity.length_squared() <= limit;
        match next.velocity.iter().position(|velocity| !within_bounds(velocity)) {
            Some(node) => Err(Runaway { node }),
            None => Ok(()),
        }
    }

    /// Applies contact and kinematic constraints at the end of the step. `acceleration` (m/s²) is constant in the step for each node;
    /// `None` if nodes moved at constant velocity. The velocity at the start of a step with accelerations decides how surfaces rebound, as for
    /// velocity Verlet.
    pub fn constrain(&self, state: &State, next: &mut State, acceleration: Option<&[DVec3]>) {
        let timing = if acceleration.is_some() { Timing::Start } else { Timing::End };
        self.system.constrain(self.interval, state, next, acceleration, timing);
    }

    /// Ends the step of a method with several evaluations: checks the speeds, applies contact and kinematic constraints, and clears
    /// the memory of the integrator. A node rebounds as if its mean acceleration in the step had been constant.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub fn finish(&self, state: &State, next: &mut State) -> Result<(), Runaway> {
        self.check(next)?;
        next.memory.integrator.clear();
        let change = next.velocity.iter().zip(&state.velocity);
        let mean: Vec<DVec3> = change.map(|(&after, &before)| (after - before) / self.interval.step).collect();
        self.system.constrain(self.interval, state, next, Some(&mean), Timing::Start);
        Ok(())
    }

    /// Like [`Self::finish`]. True when a node has met an obstacle, so that earlier accelerations do not continue its motion. `before`
    /// becomes the positions, then the velocities, before contact.
    fn finish_and_tell(&self, state: &State, next: &mut State, before: &mut Vec<DVec3>) -> Result<bool, Runaway> {
        // Held nodes are placed first, so that they count only if an obstacle moves them.
        self.system.feel_grips(self.interval, next);
        self.place_held(1.0, next);
        before.clear();
        before.extend(next.position.iter().chain(&next.velocity));
        self.finish(state, next)?;
        Ok(!next.position.iter().chain(&next.velocity).eq(&*before))
    }

    /// Adds up the work of forces from outside until the step, and writes the memory of kinematic constraints at its end.
    fn begin(&self, state: &State, next: &mut State) {
        let System { work, surroundings, .. } = self.system;
        if let Some(work) = work.as_ref().filter(|_| self.system.adds_work(state.steps)) {
            let mut forces = vec![DVec3::ZERO; state.position.len()];
            surroundings.push(self.interval.begin, &state.position, &mut forces);
            work.add(surroundings, self.interval.begin, state.nodes(), &forces);
        }
        let constraints = &mut next.memory.constraints;
        constraints.clone_from(&state.memory.constraints);
        self.system.change_grips(constraints, |grip, memory| {
            grip.reach(self.interval.end, memory, |node| state.position[node as usize])
        });
    }

    /// Eq. (2): evaluates the forces and writes the velocities (m/s) at the end of the step, `V + F/m ΔT`.
    ///
    /// # Errors
    /// As [`Self::check`].
    #[doc(alias = "Eq. 2")]
    fn velocities(&self, state: &State, next: &mut State, scratch: &mut Scratch) -> Result<(), Runaway> {
        let (memory, forces) = (&state.memory.model, &mut next.velocity);
        self.system.forces(self.interval.begin, state.nodes(), memory, &mut next.memory.model, scratch, forces);
        for ((force, &mass), &velocity) in forces.iter_mut().zip(&self.system.mass).zip(&state.velocity) {
            *force = velocity + *force / mass * self.interval.step;
        }
        // The Euler methods have no memory.
        next.memory.integrator.clear();
        self.check(next)
    }
}

/// The reference code: evaluates forces, then integrates. Every kernel is tested against it.
pub(super) struct ByForces {
    method: Box<dyn Method>,
    /// The state at the end of the step that is being computed.
    next: State,
}

/// The scales of a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scales {
    /// The largest extent of a body at rest (m).
    pub(super) length: f64,
    /// `T/2π` of the shortest period T of all models (s).
    pub(super) time: f64,
}

impl ByForces {
    pub(super) fn new(method: Box<dyn Method>, state: &State) -> Self {
        Self { method, next: state.clone() }
    }
}

impl Integrator {
    /// The method. `tolerance` is for one with steps of its own.
    pub(super) fn method(self, tolerance: f64, scales: Scales) -> Box<dyn Method> {
        match self {
            Self::SemiImplicitEuler | Self::ExplicitEuler => Box::new(Euler::new(self == Self::ExplicitEuler)),
            Self::VelocityVerlet => Box::<VelocityVerlet>::default(),
            Self::Pefrl => Box::new(ByComposition::new(composition::PEFRL)),
            Self::RungeKutta => Box::<RungeKutta>::default(),
            Self::DormandPrince => Box::new(DormandPrince::new(scales, tolerance)),
            Self::BackwardEuler => Box::new(BackwardEuler::new(scales)),
        }
    }
}

impl Dynamics for ByForces {
    fn advance(&mut self, system: &System, limit: &SpeedLimit, state: &mut State, count: u64) -> Result<(), Runaway> {
        for _ in 0..count {
            let interval = system.interval(state.steps);
            let step = Step { system, interval, limit: limit.at(interval.end) };
            let work = system.work.as_ref().filter(|_| system.adds_work(state.steps));
            work.inspect(|work| work.keep());
            step.begin(state, &mut self.next);
            let done = self.method.step(&step, state, &mut self.next);
            if let Some(impulses) = &system.impulses {
                if done.is_ok() { impulses.keep() } else { impulses.forget(0) }
            }
            if done.is_err() {
                work.inspect(|work| work.restore());
            }
            done?;
            swap(state, &mut self.next);
            state.steps += 1;
        }
        Ok(())
    }

    fn unsolved(&self, state: &State) -> Option<Unsolved> {
        self.method.unsolved(state)
    }

    fn copy(&self) -> Box<dyn Dynamics> {
        Box::new(Self { method: self.method.copy(), next: self.next.clone() })
    }
}

/// Exchanges what a step computes.
fn swap(state: &mut State, next: &mut State) {
    std::mem::swap(&mut state.position, &mut next.position);
    std::mem::swap(&mut state.velocity, &mut next.velocity);
    std::mem::swap(&mut state.memory, &mut next.memory);
}
