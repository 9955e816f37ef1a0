//! Kernels as [`Dynamics`]: the choice of the kernel for a model and a body, and contact and grips between steps.

use super::report::Energy;
use super::stepper::{Rollback, Scheme};
use super::{Around, Compiled, Conditions, PlaceNode, Vectorised};
use crate::body::Body;
use crate::contact::{Bound, Floor, Obstacle, Placed};
use crate::crew::Crew;
use crate::dynamics::{Dynamics, Runaway, SpeedLimit};
use crate::lanes::Set;
use crate::model::{Report, Share};
use crate::part::Part;
use crate::state::{Memory, State};
use crate::system::System;
use glam::DVec3;
use std::ops::Range;
use std::sync::Arc;

/// A kernel that advances a simulation.
pub(crate) struct ByKernel {
    rollback: Rollback,
    energy: Energy,
    /// The memory of the constraints, while the kernel has the state.
    constraints: Option<Vec<f64>>,
    /// The margin (m) by which the bounds of obstacles are enlarged.
    margin: f64,
}

impl ByKernel {
    /// The kernel for a model on a body.
    pub(crate) fn new(body: &Arc<Body>, model: &dyn Vectorised, scheme: Scheme, gravity: DVec3, step: f64) -> Self {
        /// Relative to the size of the body. Round-off, 1e-15 of the distance from the origin, decides whether a node
        /// is on a surface, so this suffices for bodies that are nearer than a billion times their size.
        const MARGIN: f64 = 1e-3;
        let conditions = Conditions { scheme, gravity, step, set: Set::best() };
        let Compiled { stepper, energy } = model.compile(body, &conditions);
        Self { rollback: Rollback::new(stepper, scheme), energy, constraints: None, margin: MARGIN * body.extent() }
    }
}

impl Dynamics for ByKernel {
    fn advance(
        &mut self,
        system: &System,
        limit: &SpeedLimit,
        state: &mut State,
        count: u64,
        crew: &mut Crew,
    ) -> Result<(), Runaway> {
        /// Steps for which moving obstacles are placed at a time.
        const STRETCH: u64 = 256;
        let Self { rollback, constraints, margin, .. } = self;
        let constraints = constraints.get_or_insert_with(|| {
            rollback.load(state.steps, &state.position, &state.velocity, &state.memory.model);
            state.memory.constraints.clone()
        });
        let obstacles = system.contact.obstacles().unwrap_or_default();
        let is_still = obstacles.iter().all(Obstacle::is_still);
        let target = rollback.steps() + count;
        while rollback.steps() < target {
            let begin = rollback.steps();
            let mut taken = None;
            if system.takes(begin, constraints) {
                let (end, memory) = (system.interval(begin).end, taken.insert(constraints.clone()));
                system.change_grips(memory, |grip, memory| {
                    grip.reach(end, memory, |node| rollback.stepper.node(node as usize).0);
                });
            }
            let memory = taken.as_ref().unwrap_or(constraints);
            // Grips become active and inactive between stretches, and no step is repeated with other grips.
            let is_new = |step: u64| system.takes(step, memory) || system.holds(step) != system.holds(step - 1);
            if taken.is_some() || begin > 0 && is_new(begin) {
                rollback.arrive();
            }
            // Moving obstacles are placed in advance, for this many steps at a time.
            let until = match is_still && system.grips.is_empty() {
                true => target,
                false => {
                    let last = target.min(begin + STRETCH);
                    (begin + 1..last).find(|&step| is_new(step)).unwrap_or(last)
                }
            };
            let met = Met::new(obstacles, system, rollback.earliest()..until, *margin);
            let place = |step: u64, share: f64, place: &mut PlaceNode<'_>| {
                for (grip, memory) in system.grips(memory) {
                    grip.moved_by(system.interval(step), share, memory)
                        .for_each(|(node, to, speed)| place(node, to, speed));
                }
            };
            let around = Around {
                bounds: &met.bounds,
                row: &|step| met.row(step),
                resolve: &|step, position, velocity, acceleration| {
                    for obstacle in &met.placed[met.row(step)] {
                        obstacle.rebound(position, velocity, acceleration);
                    }
                },
                floor: met.floor(),
                grips: if system.holds(begin) { Some(&place) } else { None },
                speed_limit: &|step| limit.at(system.interval(step).end),
            };
            let outcome = rollback.advance(until, &around, crew);
            if let Some(taken) = taken.filter(|_| rollback.steps() > begin) {
                *constraints = taken;
            }
            outcome?;
        }
        Ok(())
    }

    fn settle(&mut self, state: &mut State) {
        if let Some(known) = &self.constraints {
            let State { position, velocity, memory: Memory { model, constraints, integrator }, steps, .. } = state;
            self.rollback.stepper.store(position, velocity, model);
            constraints.clone_from(known);
            // Only the reference code has a memory of the integrator.
            integrator.clear();
            *steps = self.rollback.steps();
        }
    }

    fn report(&self, part: &Part, state: &State, share: Option<&mut Share<'_>>, crew: &Crew) -> Report {
        self.energy.report(&state.position[part.nodes.clone()], &state.memory.model[part.memory.clone()], share, crew)
    }

    fn steps(&self, state: &State) -> u64 {
        self.constraints.as_ref().map_or(state.steps, |_| self.rollback.steps())
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
    fn new(obstacles: &'a [Obstacle], system: &System, mut steps: Range<u64>, margin: f64) -> Self {
        let (first, is_still) = (steps.start, obstacles.iter().all(Obstacle::is_still));
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

    fn floor(&self) -> Option<Floor> {
        match &self.placed[..] {
            [one] => one.still_floor(),
            _ => None,
        }
    }
}
