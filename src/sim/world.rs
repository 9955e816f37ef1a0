//! The world of one run. Its step is section 2 of the paper: forces, motion, collisions.

use super::body::Body;
use super::crew::Crew;
use super::diagnose::Diagnose;
use super::diagnostics::Diagnostic;
use super::dynamics::{Dynamics, SpeedLimit};
use super::field::Field;
use super::integrate::{ByForces, Integrator};
use super::kernel::ByKernel;
use super::model::{ElasticModel, Report, Share};
use super::part::Part;
use super::snapshot::{Diagnostics, Divergence, Snapshot, Status};
use super::state::{Memory, State};
pub(crate) use super::system::Surroundings;
use super::system::System;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// How a run is stepped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stepping {
    /// The way of stepping.
    pub integrator: Integrator,
    /// Time step ΔT (s).
    pub step: f64,
    /// How a step is computed. A model without vectorised steps ([`ElasticModel::known`]), or several bodies together, take
    /// the plain code.
    pub kernel: Kernel,
}

impl Stepping {
    /// In the fastest way.
    #[cfg(test)]
    pub(crate) fn new(integrator: Integrator, step: f64) -> Self {
        Self { integrator, step, kernel: Kernel::default() }
    }
}

/// How a step is computed. The choice moves states by round-off in each step, which chaotic motion enlarges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Kernel {
    /// Vectorised, with the same bits on every machine and for any number of threads. Shape-based models with the rotations
    /// `exact` and `arctangent`, undamped or with `damping_of = "relative-motion"`, and mass-spring have it.
    #[default]
    Fast,
    /// The plain code that reads like the paper. The other rotations and the damping of deformation have nothing else.
    Reference,
}

impl Kernel {
    /// The fastest one for a model.
    pub fn of(model: &dyn ElasticModel) -> Self {
        if model.known().is_some() { Self::Fast } else { Self::Reference }
    }
}

/// A moment of simulated time: so many counts of a clock that counts at a rate, such as frames. A run with fixed steps shows
/// at a moment its nearest step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Counts since the start.
    pub count: f64,
    /// Counts per second (1/s).
    pub rate: f64,
}

impl Moment {
    /// A time (s).
    pub fn at(time: f64) -> Self {
        Self { count: time, rate: 1.0 }
    }

    /// `round(n / (rate · ΔT))`: the nearest step of a run with a time step ΔT (s).
    pub fn step(self, step: f64) -> u64 {
        // As written: dividing twice would round ties to other steps.
        (self.count / (self.rate * step)).round() as u64
    }
}

/// Bodies with their elastic models, on their way through time. It cannot fail: when it blows up it stops at its last
/// finite state and says so.
pub struct World {
    system: System,
    dynamics: Box<dyn Dynamics>,
    crew: Crew,
    limit: SpeedLimit,
    /// What snapshots show besides positions and velocities.
    field: Option<Field>,
    state: State,
}

impl World {
    /// A body at `initial`, about to be stepped.
    ///
    /// # Panics
    /// If `initial` has not one position and one velocity per node.
    pub(crate) fn new(
        body: &Arc<Body>,
        initial: State,
        model: &dyn ElasticModel,
        surroundings: Surroundings,
        stepping: Stepping,
    ) -> Self {
        Self::of_parts(&[(Arc::clone(body), model)], initial, surroundings, stepping)
    }

    /// Several bodies, each with its model, about to be stepped together. `initial` has the nodes of the first, then those
    /// of the second, and so on; in this order grips count nodes, too.
    ///
    /// # Panics
    /// If `initial` has not one position and one velocity per node.
    pub(crate) fn of_parts(
        bodies: &[(Arc<Body>, &dyn ElasticModel)],
        initial: State,
        surroundings: Surroundings,
        stepping: Stepping,
    ) -> Self {
        let nodes = bodies.iter().map(|(body, _)| body.len()).sum();
        assert!(initial.position.len() == nodes && initial.velocity.len() == nodes, "one entry per node");
        let mut state = State::new(initial.position, initial.velocity);
        for grip in &surroundings.grips {
            let memory = grip.start(&mut state);
            state.memory.constraints.extend(memory);
        }
        let (mut parts, mut limit) = (Vec::new(), None::<SpeedLimit>);
        let (mut first_node, mut mass) = (0, Vec::with_capacity(nodes));
        for (body, model) in bodies {
            let forces = model.prepare(body);
            let nodes = first_node..first_node + body.len();
            let start = forces.start(&state.position[nodes.clone()]);
            let first = state.memory.model.len();
            state.memory.model.extend(start);
            let memory = first..state.memory.model.len();
            let part = Part { body: Arc::clone(body), forces, nodes, memory, diagnose: Diagnose::new(body) };
            let period = model.shortest_period(body);
            let own = SpeedLimit::new(body, part.nodes_of(state.nodes()), period, &surroundings, stepping.step);
            limit = Some(limit.map_or(own, |limit| limit.max(own)));
            mass.extend_from_slice(&body.mass);
            first_node = part.nodes.end;
            parts.push(part);
        }
        let Surroundings { gravity, obstacles, grips } = surroundings;
        let Stepping { integrator, step, kernel } = stepping;
        let system = System { parts, mass, gravity, contact: Box::new(obstacles), grips, step };
        let fast = match bodies {
            [(body, model)] if kernel == Kernel::Fast => {
                model.known().map(|model| ByKernel::new(body, model, integrator, gravity, step))
            }
            _ => None,
        };
        let dynamics: Box<dyn Dynamics> = match fast {
            Some(kernel) => Box::new(kernel),
            None => Box::new(ByForces::new(integrator, &state)),
        };
        Self { system, dynamics, crew: Crew::new(1), limit: limit.unwrap_or_default(), field: None, state }
    }

    /// Lends it threads for vectorised steps, as far as there is work for them. They change no bit. Before, and with
    /// [`Kernel::Reference`], the calling thread and its pool do all.
    pub fn set_crew(&mut self, crew: Crew) {
        self.crew = crew;
    }

    /// The threads that were lent.
    pub fn crew(&mut self) -> &mut Crew {
        &mut self.crew
    }

    /// Makes snapshots show a field from now on, or none.
    pub(crate) fn show(&mut self, field: Option<Field>) {
        self.field = field;
    }

    /// Goes on by a number of steps. A diverged world only lets its clock go on.
    pub fn advance(&mut self, steps: u64) {
        self.advance_steps(steps);
        self.dynamics.settle(&mut self.state);
    }

    /// Goes on towards a moment by a number of steps at most, and returns whether it is there. However the way is cut up,
    /// the states have the same bits.
    ///
    /// # Panics
    /// If the moment has passed.
    pub fn advance_towards(&mut self, moment: Moment, most_steps: u64) -> bool {
        let left = self.steps_at(moment).checked_sub(self.steps()).expect("moments are taken in rising order");
        // What blew up only lets its clock go on.
        let most_steps = if self.state.status == Status::Ok { most_steps } else { u64::MAX };
        self.advance_steps(left.min(most_steps));
        let is_there = left <= most_steps;
        if is_there {
            self.dynamics.settle(&mut self.state);
        }
        is_there
    }

    /// How many steps have been taken at a moment.
    pub(crate) fn steps_at(&self, moment: Moment) -> u64 {
        moment.step(self.system.step)
    }

    fn advance_steps(&mut self, steps: u64) {
        let Self { system, dynamics, crew, limit, state, .. } = self;
        if state.status == Status::Ok {
            let last = dynamics.steps(state).saturating_add(steps);
            let Err(runaway) = dynamics.advance(system, limit, state, steps, crew) else { return };
            dynamics.settle(state);
            dynamics.restart();
            let (time, step) = (system.interval(state.steps).end, state.steps + 1);
            let (part, element) = system.place_of(runaway.node);
            state.status = Status::Diverged(Divergence { time, step, part, element });
            state.steps = last;
        } else {
            state.steps = state.steps.saturating_add(steps);
        }
    }

    /// Steps taken so far, also on the way to a moment.
    pub fn steps(&self) -> u64 {
        match self.state.status {
            Status::Ok => self.dynamics.steps(&self.state),
            Status::Diverged(_) => self.state.steps,
        }
    }

    /// The state at the last moment that was reached.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Goes on from another state of the same bodies under the same conditions. A time step that is another one would shift
    /// its clock.
    ///
    /// # Panics
    /// If it is a state of something else.
    pub fn set_state(&mut self, state: State) {
        let lengths = |state: &State| {
            let Memory { model, constraints, .. } = &state.memory;
            [state.position.len(), state.velocity.len(), model.len(), constraints.len()]
        };
        assert_eq!(lengths(&state), lengths(&self.state), "a state of the same bodies");
        self.state = state;
        let Memory { model, integrator, .. } = &mut self.state.memory;
        if integrator.len() != 3 * self.state.position.len() + model.len() {
            integrator.clear();
        }
        self.dynamics.restart();
    }

    /// Whether it goes on.
    pub fn status(&self) -> Status {
        self.state.status
    }

    /// What the model of a part says of the present state: its energy, and the error α of Eq. (18) with the rotations of
    /// the forces here. Every integrator evaluates its forces here, so asked before each step this is α at every
    /// evaluation, with velocity Verlet as with both Euler methods. Costs about one evaluation, and changes nothing.
    ///
    /// # Panics
    /// If there is no such part.
    pub(crate) fn report(&self, part: usize) -> Report {
        self.report_with(&self.system.parts[part], &mut |_, _, _| {})
    }

    /// α of Eq. (18) of each element of the first part (rad/s²) in the last step, which must have been one of an Euler method,
    /// with its nodes at `before` (m) when it began; empty for a model without rotations. It takes the rotations of the step
    /// itself, and so costs much less than [`Self::report`].
    pub(crate) fn residuals(&self, before: &[glam::DVec3]) -> Vec<f64> {
        let part = &self.system.parts[0];
        part.forces.residuals(&before[part.nodes.clone()], &self.state.memory.model[part.memory.clone()])
    }

    fn report_with(&self, part: &Part, share: &mut Share<'_>) -> Report {
        part.forces.report(part.nodes_of(self.state.nodes()), &self.state.memory.model[part.memory.clone()], share)
    }

    /// The numbers of the present moment alone, of the first part, without copies of all positions and velocities.
    pub fn diagnostics(&self) -> Diagnostics {
        let part = &self.system.parts[0];
        part.diagnose.state(part.nodes_of(self.state.nodes()), self.system.gravity, &self.report(0)).0
    }

    /// Some of them; the others are zero. What none of them needs is not computed.
    pub(crate) fn some_diagnostics(&self, wanted: &[Diagnostic]) -> Diagnostics {
        let part = &self.system.parts[0];
        part.diagnose.some(part.nodes_of(self.state.nodes()), self.system.gravity, || self.report(0), wanted)
    }

    /// The present moment of the first part with its diagnostics.
    pub fn snapshot(&self) -> Snapshot {
        self.snapshot_of(0)
    }

    /// The present moment of a part with its diagnostics.
    ///
    /// # Panics
    /// If there is no such part.
    pub(crate) fn snapshot_of(&self, part: usize) -> Snapshot {
        let part = &self.system.parts[part];
        let nodes = part.nodes_of(self.state.nodes());
        let mut energies = vec![0.0; if self.field == Some(Field::ElasticEnergy) { part.body.len() } else { 0 }];
        let report = self.report_with(part, &mut |_, nodes, shares| {
            if !energies.is_empty() {
                nodes.iter().zip(shares).for_each(|(&node, share)| energies[node as usize] += share);
            }
        });
        let (diagnostics, turned_over, placement) = part.diagnose.state(nodes, self.system.gravity, &report);
        let field = self.field.map_or_else(Vec::new, |field| field.values(&part.body, nodes, &placement, energies));
        Snapshot {
            step: self.state.steps,
            time: self.state.steps as f64 * self.system.step,
            position: nodes.position.to_vec(),
            velocity: nodes.velocity.to_vec(),
            turned_over,
            placement,
            field,
            diagnostics,
            status: self.state.status,
        }
    }
}
