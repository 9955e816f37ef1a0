//! Kernels as [`Dynamics`]: the choice of the kernel for a model and a body, and contact and grips between steps.

use super::held::Held;
use super::stepper::{PartStepper, Rollback, Scheme};
use super::{Around, Compiled, Conditions, Forces, Meeting, Push};
use crate::body::Body;
use crate::contact::{Bound, End, Obstacle, Placed, Source};
use crate::crew::Crew;
use crate::dynamics::Dynamics;
use crate::lanes::Set;
use crate::law::Energy;
use crate::limit::SpeedLimit;
use crate::model::{ElasticModel, Report, Share};
use crate::part::Part;
use crate::state::{Memory, Nodes, Runaway, State};
use crate::surroundings::Surroundings;
use crate::system::System;
use crate::work::Work;
use glam::DVec3;
use std::ops::Range;
use std::sync::Arc;

/// Kernels that advance a simulation, one for each part.
#[derive(Clone)]
pub(crate) struct ByKernel {
    rollback: Rollback,
    /// Of each part.
    energies: Vec<Arc<dyn Energy>>,
    /// The memory of the constraints, while the kernels have the state.
    constraints: Option<Vec<f64>>,
    /// The margin (m) by which the bounds of obstacles are enlarged.
    margin: f64,
}

impl ByKernel {
    /// The kernels of models for their bodies; `None` if one of the models has none.
    pub(crate) fn compile(
        bodies: &[(Arc<Body>, &dyn ElasticModel)],
        scheme: Scheme,
        step: f64,
    ) -> Option<Vec<Compiled>> {
        let conditions = Conditions { scheme, step, set: Set::best() };
        let models: Option<Vec<_>> = bodies.iter().map(|(_, model)| model.vectorised()).collect();
        Some(models?.into_iter().zip(bodies).map(|(model, (body, _))| model.compile(body, &conditions)).collect())
    }

    /// The kernels of the parts.
    pub(crate) fn new(parts: &[Part], kernels: Vec<Compiled>, scheme: Scheme) -> Self {
        /// Relative to the size of the largest body. Round-off, 1e-15 of the distance from the origin, decides whether a
        /// node is on a surface, so this suffices for bodies that are nearer than a billion times their size.
        const MARGIN: f64 = 1e-3;
        let stepped = parts.iter().zip(kernels).map(|(Part { nodes, memory, .. }, Compiled { stepper, energy })| {
            (PartStepper { stepper, nodes: nodes.clone(), memory: memory.clone() }, Arc::from(energy))
        });
        let (steppers, energies) = stepped.unzip();
        let margin = parts.iter().fold(0.0, |most: f64, part| most.max(MARGIN * part.body.extent()));
        Self { rollback: Rollback::new(steppers, scheme), energies, constraints: None, margin }
    }

    /// Takes steps until a target, at most as many as have the same grips and the same kind of loads, of a world of so many nodes.
    fn stretch(&mut self, system: &System, limit: &SpeedLimit, nodes: usize, target: u64) -> Result<(), Runaway> {
        let Self { rollback, constraints, margin, .. } = self;
        let constraints = constraints.get_or_insert_default();
        let Surroundings { gravity, mass_damping, grips, .. } = &system.surroundings;
        let (work, impulses) = (system.work.as_ref(), system.impulses.as_ref());
        let (numbers, obstacles): (Vec<_>, Vec<_>) = system.met_by_nodes().into_iter().unzip();
        let begin = rollback.steps();
        let taken = take_nodes(system, constraints, rollback);
        let memory = taken.as_ref().unwrap_or(constraints);
        // Grips take and release nodes between stretches, and no step is repeated with other grips.
        let is_new = |step: u64| system.takes(step, memory) || system.releases(step) || loads_change(system, step);
        if taken.is_some() || begin > 0 && is_new(begin) {
            rollback.arrive();
        }
        // Moving obstacles are placed in advance, for this many steps at a time.
        let is_still = obstacles.iter().all(|obstacle| obstacle.is_still());
        let until = match is_still && grips.is_empty() && system.surroundings.loads.is_empty() {
            true => target,
            false => {
                let last = target.min(begin + STRETCH);
                (begin + 1..last).find(|&step| is_new(step)).unwrap_or(last)
            }
        };
        let timing = rollback.scheme().timing();
        let met = Met::new(&obstacles, system, rollback.earliest()..until, *margin);
        let unfeeling = system.unfeeling(system.interval(begin), memory);
        let held = Held::new(system, begin, memory);
        let meet = |step: u64, before: Nodes<'_>, after: &mut State, changed: &mut Vec<u32>| {
            let (interval, State { position, velocity, .. }) = (system.interval(step), after);
            system.meet(End { interval, before, position, velocity, timing, changed, impulses }, memory);
        };
        let alone = |step: u64, at: Nodes<'_>, most: u64| {
            // Constraints may take nodes anywhere.
            let stage = system.contact.as_ref().filter(|_| grips.is_empty())?;
            stage.alone(at, system.interval(step), most)
        };
        let push = |step: u64, share: f64, at: Nodes<'_>, forces: &mut Forces| push(system, step, share, at, forces);
        let is_steady = system.surroundings.are_steady(system.interval(begin));
        let steady = if is_steady { steady_forces(system, nodes, rollback) } else { Forces::default() };
        let around = Around {
            gravity: *gravity,
            mass_damping: *mass_damping,
            forces: steady.columns(),
            push: (!is_steady).then_some(&push as &Push<'_>),
            work,
            bounds: &met.bounds,
            row: &|step| met.row(step),
            resolve: &|step, node, position, velocity, acceleration| {
                // Grips place the nodes that they hold anyway, and then feel all that moves them.
                let placed = if unfeeling.get(node) == Some(&true) { 0..0 } else { met.row(step) };
                for (obstacle, &number) in met.placed[placed].iter().zip(&numbers) {
                    let before = [*position, *velocity];
                    obstacle.rebound(position, velocity, acceleration);
                    let (end, from) = (system.interval(step).end, Source::Obstacle(number));
                    system.feel(end, from, node, before, [*position, *velocity]);
                }
            },
            impulses,
            floor: met.floor().filter(|_| impulses.is_none()),
            apart: &system.apart(),
            grips: (!grips.is_empty()).then_some(&held),
            held: &[],
            meeting: system.contact.as_ref().map(|stage| Meeting { meet: &meet, alone: &alone, nodes: &stage.nodes }),
            speed_limit: &|step| limit.at(system.interval(step).end),
        };
        let outcome = rollback.advance(until, &around, &system.crew);
        if let Some(taken) = taken.filter(|_| rollback.steps() > begin) {
            *constraints = taken;
        }
        outcome
    }
}

/// Steps for which moving obstacles are placed at a time.
const STRETCH: u64 = 256;

/// The memory of the constraints with the nodes that grips take in the next step; `None` if they take none.
fn take_nodes(system: &System, constraints: &[f64], rollback: &mut Rollback) -> Option<Vec<f64>> {
    let begin = rollback.steps();
    system.takes(begin, constraints).then(|| {
        let (end, mut memory) = (system.interval(begin).end, constraints.to_vec());
        system.change_grips(&mut memory, |grip, memory| {
            grip.reach(end, memory, |node| rollback.node(node as usize).0);
        });
        memory
    })
}

/// Whether loads begin or end to change in a step.
fn loads_change(system: &System, step: u64) -> bool {
    let are_steady = |step: u64| system.surroundings.are_steady(system.interval(step));
    are_steady(step) != are_steady(step - 1)
}

/// The nodes with loads.
fn loaded(system: &System) -> impl Iterator<Item = usize> {
    system.work.as_ref().map_or(&[][..], Work::nodes).iter().map(|&node| node as usize)
}

/// Computes the forces of loads after a share of a step, and adds up their work at its start.
fn push(system: &System, step: u64, share: f64, at: Nodes<'_>, forces: &mut Forces) {
    loaded(system).for_each(|node| forces.vectors[node] = DVec3::ZERO);
    system.surroundings.push(system.interval(step).after(share), at.position, &mut forces.vectors);
    forces.spread(loaded(system));
    if let Some(work) = system.work.as_ref().filter(|_| share == 0.0) {
        work.add(&system.surroundings, system.interval(step).begin, at, &forces.vectors);
    }
}

/// The forces of loads on so many nodes where they are the same everywhere and stay so; empty without loads.
fn steady_forces(system: &System, nodes: usize, rollback: &mut Rollback) -> Forces {
    let Some(work) = &system.work else { return Forces::default() };
    let (begin, mut forces) = (rollback.steps(), Forces::zero(nodes));
    let mut now = State::new(vec![DVec3::ZERO; nodes], vec![DVec3::ZERO; nodes]);
    let time = system.interval(begin).begin;
    system.surroundings.push(time, &now.position, &mut forces.vectors);
    forces.spread(loaded(system));
    if system.adds_work(begin) {
        loaded(system).for_each(|node| (now.position[node], now.velocity[node]) = rollback.node(node));
        work.add(&system.surroundings, time, now.nodes(), &forces.vectors);
    }
    forces
}

impl Dynamics for ByKernel {
    fn advance(&mut self, system: &System, limit: &SpeedLimit, state: &mut State, count: u64) -> Result<(), Runaway> {
        let target = match self.constraints {
            Some(_) => self.rollback.steps() + count,
            None => {
                self.rollback.load(state.steps, &state.position, &state.velocity, &state.memory.model);
                self.constraints = Some(state.memory.constraints.clone());
                state.steps + count
            }
        };
        while self.rollback.steps() < target {
            self.stretch(system, limit, state.position.len(), target)?;
        }
        Ok(())
    }

    fn settle(&mut self, state: &mut State) {
        if let Some(known) = &self.constraints {
            let State { position, velocity, memory: Memory { model, constraints, integrator, .. }, steps, .. } = state;
            self.rollback.store(position, velocity, model);
            constraints.clone_from(known);
            // Only the reference code has a memory of the integrator.
            integrator.clear();
            *steps = self.rollback.steps();
        }
    }

    fn place(&mut self, state: &State) {
        if self.constraints.is_some() {
            self.rollback.place(&state.position, &state.velocity);
        }
    }

    fn read(&mut self, state: &mut State) {
        self.rollback.nodes(&mut state.position, &mut state.velocity);
    }

    fn report(&self, part: &Part, state: &State, share: Option<&mut Share<'_>>, crew: &Crew) -> Report {
        let energy = &self.energies[part.number];
        energy.report(&state.position[part.nodes.clone()], &state.memory.model[part.memory.clone()], share, crew)
    }

    fn steps(&self, state: &State) -> u64 {
        self.constraints.as_ref().map_or(state.steps, |_| self.rollback.steps())
    }

    fn copy(&self) -> Box<dyn Dynamics> {
        Box::new(self.clone())
    }

    fn restart(&mut self) {
        self.constraints = None;
    }
}

/// The obstacles in each of a number of steps.
struct Met<'a> {
    /// The obstacles, step by step.
    placed: Vec<Placed<'a>>,
    /// The bound of each of them.
    bounds: Vec<Bound>,
    first: u64,
    /// Whether all steps have the same obstacles.
    is_still: bool,
    /// The number of obstacles.
    count: usize,
}

impl<'a> Met<'a> {
    /// For the given steps.
    fn new(obstacles: &[&'a Obstacle], system: &System, mut steps: Range<u64>, margin: f64) -> Self {
        let (first, is_still) = (steps.start, obstacles.iter().all(|obstacle| obstacle.is_still()));
        if is_still {
            steps.end = first + 1;
        }
        let in_step = |step: u64| {
            let interval = system.interval(step);
            obstacles.iter().map(move |obstacle| obstacle.at(interval.end, interval.step))
        };
        let placed: Vec<_> = steps.flat_map(in_step).collect();
        let bounds = placed.iter().map(|obstacle| obstacle.bound(margin)).collect();
        Self { placed, bounds, first, is_still, count: obstacles.len() }
    }

    /// The range of the obstacles of a step.
    fn row(&self, step: u64) -> Range<usize> {
        let first = if self.is_still { 0 } else { (step - self.first) as usize * self.count };
        first..first + self.count
    }

    fn floor(&self) -> Option<&Placed<'a>> {
        self.placed.first().filter(|one| self.placed.len() == 1 && one.is_still_floor())
    }
}
