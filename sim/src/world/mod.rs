//! The simulation of one run. Its step is section 2 of the paper: forces, motion, collisions.

mod balance;
mod change;
mod touching;

use crate::body::Body;
use crate::broken::Broken;
use crate::crew::Crew;
use crate::diagnose::{BodyFacts, Diagnose, Outside};
use crate::diagnostics::{Diagnostic, Diagnostics, Facts};
use crate::dynamics::Dynamics;
use crate::field::Field;
use crate::integrate::{ByForces, Integrator, Method, Scales};
use crate::kernel::{ByKernel, Scheme};
use crate::limit::SpeedLimit;
use crate::model::{ElasticModel, Report, Scratch};
use crate::part::Part;
use crate::recording::{ByRecording, Recording, Unknown};
use crate::snapshot::Snapshot;
use crate::state::{Divergence, Memory, State, Status};
use crate::surroundings::Surroundings;
use crate::system::System;
use std::sync::Arc;

/// The method and step of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepping {
    /// The integration method, unless a model [moves its nodes itself](ElasticModel::projection).
    pub integrator: Integrator,
    /// Time step ΔT (s).
    pub step: f64,
    /// The error that an adaptive method allows in each of its substeps, as a share of the size of the body. Others ignore it.
    pub tolerance: f64,
    /// The code that computes a step. The reference code is used if the integrator or the model of one of the bodies has no
    /// vectorised steps ([`Kernel::of`]).
    pub kernel: Kernel,
}

impl Stepping {
    /// A method and step with the fastest code.
    pub fn new(integrator: Integrator, step: f64) -> Self {
        Self { integrator, step, tolerance: Integrator::TOLERANCE, kernel: Kernel::default() }
    }
}

/// The code that computes a step. The choice changes states by round-off in each step, which chaotic motion amplifies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "scene", serde(rename_all = "kebab-case"))]
pub enum Kernel {
    /// Vectorised, with the same bits on every machine and for any number of threads. All models have it, except `xpbd` and a shape-based model
    /// with `rotation = "vector-length"`, with `rotation = "linear-update"`, or with `rotation = "arctangent"` beside `bending` or `poisson`. A run
    /// of several bodies has it if the models of all of them do.
    #[default]
    Fast,
    /// The reference code, written like the equations of the paper. All models have it.
    Reference,
}

impl Kernel {
    /// The fastest one that a model has with an integrator.
    pub fn of(model: &dyn ElasticModel, integrator: Integrator) -> Self {
        if model.vectorised().is_some() && Scheme::of(integrator).is_some() { Self::Fast } else { Self::Reference }
    }
}

/// A moment of simulated time: a count at a rate, such as a frame number and frames per second. A run with fixed steps
/// has at a moment the state of its nearest step.
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

/// Bodies with their elastic models, as they move in time. Stepping cannot fail: a world that diverges stops at its
/// last finite state, and [`Self::status`] reports it.
///
/// What acts on the bodies can change between steps: see [`Self::set_loads`], [`Self::set_obstacles`] and the functions beside them. A copy
/// of a world goes on by itself, with one thread.
pub struct World {
    system: System,
    dynamics: Box<dyn Dynamics>,
    limit: SpeedLimit,
    /// The field in snapshots.
    field: Option<Field>,
    /// The diagnostics in snapshots.
    wanted: Vec<Diagnostic>,
    state: State,
}

impl Clone for World {
    fn clone(&self) -> Self {
        let Self { system, dynamics, limit, field, wanted, state, .. } = self;
        Self {
            system: System { crew: Arc::default(), ..system.clone() },
            dynamics: dynamics.copy(),
            limit: *limit,
            field: *field,
            wanted: wanted.clone(),
            state: state.clone(),
        }
    }
}

impl World {
    /// A world of one body, with the initial positions and velocities `initial`.
    ///
    /// # Panics
    /// If `initial` has not one position and one velocity per node.
    pub fn new(
        body: &Arc<Body>,
        initial: State,
        model: &dyn ElasticModel,
        surroundings: Surroundings,
        stepping: Stepping,
    ) -> Self {
        Self::of_parts(&[(Arc::clone(body), model)], initial, surroundings, stepping)
    }

    /// A world of several bodies, each with its model, which are advanced together. `initial` has the nodes of the
    /// first body, then the nodes of the second, and so on; grips number nodes in this order.
    ///
    /// # Panics
    /// If `initial` has not one position and one velocity per node.
    pub fn of_parts(
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
        let Stepping { integrator, step, tolerance, kernel } = stepping;
        let projections: Vec<_> = bodies.iter().map(|(body, model)| model.projection(body)).collect();
        let is_projected = projections.iter().any(Option::is_some);
        let integrator = if is_projected { Integrator::SemiImplicitEuler } else { integrator };
        let scheme = Scheme::of(integrator).filter(|_| kernel == Kernel::Fast);
        let kernels = scheme.and_then(|scheme| {
            let kernels = ByKernel::compile(bodies, scheme, step)?;
            Some((kernels, scheme))
        });
        let mut parts = Vec::new();
        let (mut first_node, mut mass) = (0, Vec::with_capacity(nodes));
        let mut scales = Scales { length: 0.0, time: f64::INFINITY };
        for (number, ((body, model), projection)) in bodies.iter().zip(projections).enumerate() {
            let forces = Arc::from(model.prepare(body));
            let projection = projection.map(Arc::from);
            let nodes = first_node..first_node + body.len();
            let start = model.start(body, &state.position[nodes.clone()]);
            let first = state.memory.model.len();
            state.memory.model.extend(start);
            let memory = first..state.memory.model.len();
            let properties = model.properties(body);
            let counts_fallbacks = properties.counts_fallbacks;
            let diagnose = Arc::new(Diagnose::new(body));
            let (breaks, springs) = (Broken::new(*model, body).map(Arc::new), model.springs().len());
            let (own, period) = (Arc::clone(body), properties.shortest_period(body));
            let part = Part {
                number,
                body: own,
                forces,
                projection,
                nodes,
                memory,
                counts_fallbacks,
                breaks,
                period,
                springs,
                diagnose,
            };
            scales.length = scales.length.max(body.extent());
            scales.time = scales.time.min(period / std::f64::consts::TAU);
            mass.extend_from_slice(&body.mass);
            first_node = part.nodes.end;
            parts.push(part);
        }
        let dynamics: Box<dyn Dynamics> = match kernels {
            Some((kernels, scheme)) => Box::new(ByKernel::new(&parts, kernels, scheme)),
            None => Box::new(ByForces::new(integrator.method(tolerance, scales), &state)),
        };
        let (contact, impulses, work, crew) = Default::default();
        let is_fine = integrator.is_fine();
        let mut system = System { parts, mass, surroundings, contact, impulses, work, is_fine, step, crew };
        system.renew_contact();
        system.renew_work(vec![0.0; system.parts.len()], &state);
        system.work.iter().for_each(|work| work.store(&mut state.memory.loads));
        let (limit, wanted) = (system.speed_limit(&state), Diagnostic::ALL.to_vec());
        Self { system, dynamics, limit, field: None, wanted, state }
    }

    /// A world of bodies that moves as it was computed elsewhere, with moments at multiples of a `step` (s). Diagnostics that
    /// need a model are NaN.
    ///
    /// # Panics
    /// If `initial` has not one position and one velocity per node.
    pub fn recorded(
        bodies: &[Arc<Body>],
        initial: State,
        gravity: glam::DVec3,
        step: f64,
        recording: Box<dyn Recording>,
    ) -> Self {
        let parts: Vec<_> = bodies.iter().map(|body| (Arc::clone(body), &Unknown as &dyn ElasticModel)).collect();
        let surroundings = Surroundings { gravity, ..Surroundings::default() };
        let stepping = Stepping { kernel: Kernel::Reference, ..Stepping::new(Integrator::default(), step) };
        Self::of_parts(&parts, initial, surroundings, stepping).playing(recording)
    }

    /// Shows the states of a recording from now on, which has these bodies, moments and memory. Diagnostics are those of the
    /// models.
    pub fn playing(self, recording: Box<dyn Recording>) -> Self {
        Self { dynamics: Box::new(ByRecording::new(recording, self.dynamics)), ..self }
    }

    /// Takes steps by a method of another crate from now on, with forces of the reference code, also of models that move their nodes
    /// themselves otherwise.
    pub fn set_method(&mut self, method: Box<dyn Method>) {
        self.system.parts.iter_mut().for_each(|part| part.projection = None);
        self.settle();
        self.state.memory.integrator.clear();
        self.dynamics = Box::new(ByForces::new(method, &self.state));
    }

    /// Sets the threads for steps and for diagnostics, which use as many as the body is large enough for. They do not change any
    /// bit. By default one thread is used.
    pub fn set_crew(&mut self, crew: Crew) {
        self.system.crew = Arc::new(crew);
    }

    /// The threads for steps and for diagnostics.
    pub fn crew(&self) -> &Crew {
        &self.system.crew
    }

    /// Sets the field that snapshots contain from now on; `None` for no field.
    pub fn show(&mut self, field: Option<Field>) {
        self.field = field;
    }

    /// Sets the diagnostics that snapshots contain from now on, at first all. The others are zero and cost no
    /// time.
    pub fn want(&mut self, diagnostics: &[Diagnostic]) {
        self.wanted = diagnostics.to_vec();
    }

    /// Advances by a number of steps. After a divergence only the clock advances.
    pub fn advance(&mut self, steps: u64) {
        self.advance_steps(steps);
        self.settle();
    }

    /// Advances towards a moment by at most `most_steps` steps, and returns whether it has been reached. The states
    /// have the same bits however the steps are divided into calls.
    ///
    /// # Panics
    /// If the moment has passed.
    pub fn advance_towards(&mut self, moment: Moment, most_steps: u64) -> bool {
        let left = self.steps_at(moment).checked_sub(self.steps()).expect("moments are taken in rising order");
        // After a divergence only the clock advances, which takes no time.
        let most_steps = if self.state.status == Status::Ok { most_steps } else { u64::MAX };
        self.advance_steps(left.min(most_steps));
        let is_there = left <= most_steps;
        if is_there {
            self.settle();
        }
        is_there
    }

    /// The number of steps taken at a moment.
    pub fn steps_at(&self, moment: Moment) -> u64 {
        moment.step(self.system.step)
    }

    /// Makes [`Self::state`] the present state, also between moments. It changes no bit of later states.
    pub fn settle(&mut self) {
        let Self { system, dynamics, state, .. } = self;
        dynamics.settle(state);
        match &system.work {
            Some(_) if dynamics.is_recorded() => {}
            Some(work) => work.store(&mut state.memory.loads),
            None => state.memory.loads.clear(),
        }
        match &system.impulses {
            Some(_) if dynamics.is_recorded() => {}
            Some(impulses) => impulses.store(&mut state.memory.contact),
            None => state.memory.contact.clear(),
        }
    }

    fn advance_steps(&mut self, steps: u64) {
        let Self { system, dynamics, limit, state, .. } = self;
        if state.status == Status::Ok {
            let last = dynamics.steps(state).saturating_add(steps);
            let Err(runaway) = system.advance_intervals(&mut **dynamics, limit, state, steps) else { return };
            dynamics.settle(state);
            dynamics.restart();
            state.status = Status::Diverged(dynamics.divergence(system, state, runaway));
            state.steps = last;
        } else {
            state.steps = state.steps.saturating_add(steps);
        }
    }

    /// The first node above the speed limit when this world diverged, and the limit (m/s); `None` for a world that has not
    /// diverged.
    pub fn runaway(&mut self) -> Option<(usize, f64)> {
        let Status::Diverged(Divergence { step, .. }) = self.state.status else { return None };
        let Self { system, dynamics, limit, state, .. } = self;
        let mut before = State { steps: step - 1, status: Status::Ok, ..state.clone() };
        let impulses = system.impulses.take();
        dynamics.restart();
        let again = dynamics.advance(system, limit, &mut before, 1);
        dynamics.restart();
        system.impulses = impulses;
        Some((again.err()?.node, limit.at(system.interval(step - 1).end)))
    }

    /// Number of steps taken, also between moments.
    pub fn steps(&self) -> u64 {
        match self.state.status {
            Status::Ok => self.dynamics.steps(&self.state),
            Status::Diverged(_) => self.state.steps,
        }
    }

    /// The state when [`Self::advance`] returned, or when the last moment was reached.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Whether a state fits these bodies: its numbers of nodes and of memory, and the part, element and step of a divergence.
    pub fn takes(&self, state: &State) -> bool {
        let lengths = |state: &State| {
            let Memory { model, constraints, .. } = &state.memory;
            [state.position.len(), state.velocity.len(), model.len(), constraints.len()]
        };
        let place = match state.status {
            Status::Ok => true,
            Status::Diverged(Divergence { step, part, element, .. }) => {
                let elements = self.system.parts.get(part).map(|part| part.body.elements.len());
                step > 0 && elements.is_some_and(|elements| element.is_none_or(|element| element < elements))
            }
        };
        lengths(state) == lengths(&self.state) && place
    }

    /// Continues from another state of the same bodies under the same conditions. The time step has to be the same, as
    /// the time of a state is its number of steps times the time step.
    ///
    /// # Panics
    /// If the state does not have the numbers of nodes and of memory of these bodies.
    pub fn set_state(&mut self, state: State) {
        assert!(self.takes(&state), "a state of the same bodies");
        self.state = state;
        self.dynamics.restart();
        let State { memory, steps, position, .. } = &self.state;
        self.system.impulses.iter_mut().for_each(|impulses| impulses.load(&memory.contact, *steps));
        let System { work, surroundings, .. } = &self.system;
        if work.as_ref().is_some_and(|work| !work.load(surroundings, &memory.loads, position.len())) {
            self.system.renew_work(vec![0.0; self.system.parts.len()], &self.state);
        }
    }

    /// Whether the run has diverged.
    pub fn status(&self) -> Status {
        self.state.status
    }

    /// Energy of the present state, and the residual α of Eq. (18) with the rotations that the forces have in this
    /// state. Every integrator evaluates its forces at the state before a step. So if this is called before each step,
    /// it gives α at every evaluation, for velocity Verlet as for both Euler methods. It costs about one evaluation and
    /// changes nothing.
    ///
    /// # Panics
    /// If there is no such part.
    pub fn report(&self, part: usize) -> Report {
        self.dynamics.report(&self.system.parts[part], &self.state, None, &self.system.crew)
    }

    /// α of Eq. (18) of each element of a part (rad/s²) in the last step, which must be one of an Euler method
    /// that began with the nodes at `before` (m); empty for a model without rotations. It uses the rotations of the
    /// step itself, and so costs much less than [`Self::report`].
    ///
    /// # Panics
    /// If there is no such part.
    pub fn residuals(&self, part: usize, before: &[glam::DVec3]) -> Vec<f64> {
        let part = &self.system.parts[part];
        part.forces.residuals(&before[part.nodes.clone()], &self.state.memory.model[part.memory.clone()])
    }

    /// The internal forces on each node in the present state (N).
    pub fn forces(&self) -> Vec<glam::DVec3> {
        let Self { system, state, .. } = self;
        let (mut forces, mut scratch) = (vec![glam::DVec3::ZERO; state.position.len()], Scratch::default());
        for part in &system.parts {
            let memory = &state.memory.model[part.memory.clone()];
            let on_nodes = &mut forces[part.nodes.clone()];
            part.forces.add_forces(part.nodes_of(state.nodes()), memory, &mut memory.to_vec(), &mut scratch, on_nodes);
        }
        forces
    }

    /// The diagnostics of all bodies in the present state, without copying positions and velocities.
    pub fn diagnostics(&self) -> Diagnostics {
        self.some_diagnostics(Diagnostic::ALL)
    }

    /// The diagnostics in `wanted`. The others are zero and cost no time.
    pub fn some_diagnostics(&self, wanted: &[Diagnostic]) -> Diagnostics {
        self.diagnostics_by_body(wanted).0
    }

    /// The diagnostics in `wanted` of all bodies together, and those of each. The others are zero and cost no time.
    pub fn diagnostics_by_body(&self, wanted: &[Diagnostic]) -> (Diagnostics, Vec<Diagnostics>) {
        let outside = self.outside(wanted);
        let bodies = self.system.parts.iter().zip(outside).map(|(part, outside)| {
            let report = || self.dynamics.report(part, &self.state, None, &self.system.crew);
            self.facts(part, outside, report)
        });
        self.of_facts(&bodies.collect::<Vec<_>>(), wanted)
    }

    fn of_facts(&self, bodies: &[BodyFacts<'_>], wanted: &[Diagnostic]) -> (Diagnostics, Vec<Diagnostics>) {
        let of = |bodies: &[BodyFacts<'_>]| {
            Diagnostics::of(Facts { bodies, gravity: self.system.surroundings.gravity }, wanted)
        };
        let of_bodies: Vec<_> = bodies.iter().map(std::slice::from_ref).map(of).collect();
        let all = match of_bodies[..] {
            [alone] => alone,
            _ => of(bodies),
        };
        (all, of_bodies)
    }

    fn facts<'a>(&'a self, part: &'a Part, outside: Outside, report: impl FnOnce() -> Report + 'a) -> BodyFacts<'a> {
        let global_rotations = part.global_rotations(&self.state.memory.model);
        let broken = part.count_broken(&self.state.memory.model);
        let gone = part.broken_elements(&self.state.memory.model);
        part.diagnose.facts(
            part.nodes_of(self.state.nodes()),
            [global_rotations, broken],
            outside,
            gone,
            report,
            &self.system.crew,
        )
    }

    /// The present state of all bodies with its diagnostics.
    pub fn snapshot(&self) -> Snapshot {
        let Self { system, dynamics, state, field, wanted, .. } = self;
        let crew = &*system.crew;
        let (mut bodies, mut energies) = (Vec::new(), Vec::new());
        let outside = self.outside(wanted);
        for (part, outside) in system.parts.iter().zip(outside) {
            let mut of_nodes = Vec::new();
            let known = (*field == Some(Field::ElasticEnergy)).then(|| {
                of_nodes.resize(part.body.len(), 0.0);
                let mut share = |_: usize, nodes: &[u32], shares: &[f64]| {
                    nodes.iter().zip(shares).for_each(|(&node, share)| of_nodes[node as usize] += share);
                };
                let report = dynamics.report(part, state, Some(&mut share), crew);
                if report.energy.is_none() {
                    of_nodes.fill(f64::NAN);
                }
                report
            });
            let report = move || known.unwrap_or_else(|| dynamics.report(part, state, None, crew));
            bodies.push(self.facts(part, outside, report));
            energies.push(of_nodes);
        }
        let (diagnostics, of_bodies) = self.of_facts(&bodies, wanted);
        let placements: Vec<_> = bodies.iter().map(|body| *body.placement).collect();
        let (turned_over, flat) = (
            bodies.iter().flat_map(BodyFacts::turned_over).collect(),
            bodies.iter().flat_map(BodyFacts::flat).collect(),
        );
        let parts = system.parts.iter().zip(&placements).zip(energies);
        let values = |((part, placement), energies): ((&Part, _), _)| {
            field.map_or_else(Vec::new, |field| {
                field.values(&part.body, part.nodes_of(state.nodes()), placement, energies, crew)
            })
        };
        let field = parts.flat_map(values).collect();
        let (mut broken, mut broken_springs) = (Vec::new(), Vec::new());
        if system.parts.iter().any(|part| part.breaks.is_some()) {
            let springs_break = system.parts.iter().any(|part| part.breaks.is_some() && part.springs > 0);
            for (part, facts) in system.parts.iter().zip(&bodies) {
                broken.extend(&facts.gone);
                broken.resize(broken.len() + part.body.elements.len() - facts.gone.len(), false);
                if !springs_break {
                    continue;
                }
                let springs = part.broken_springs(&state.memory.model);
                broken_springs.extend(&springs);
                broken_springs.resize(broken_springs.len() + part.springs - springs.len(), false);
            }
        }
        Snapshot {
            step: state.steps,
            time: state.steps as f64 * system.step,
            position: state.position.clone(),
            velocity: state.velocity.clone(),
            turned_over,
            flat,
            broken,
            broken_springs,
            placements,
            field,
            diagnostics,
            of_bodies,
            reactions: self.reactions().unwrap_or_default(),
            contact_points: system.impulses.as_ref().map_or_else(Vec::new, |_| self.contact_points()),
            status: state.status,
            unsolved: dynamics.unsolved(state),
        }
    }
}
