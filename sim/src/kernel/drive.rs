//! Kernels as [`Dynamics`]: the choice of the kernel for a model and a body, and contact and grips between steps.

use super::general::{Constants, General};
use super::lattice::{self, LatticeStepper};
use super::report::{Elastic, Energy};
use super::springs::Stencil;
use super::stepper::{Rollback, Scheme, Stepper};
use super::{Around, PlaceNode, Rotation};
use crate::body::Body;
use crate::contact::{Bound, Floor, Obstacle, Placed};
use crate::crew::Crew;
use crate::dynamics::{Dynamics, Runaway, SpeedLimit};
use crate::element::Dimension;
use crate::lanes::Set;
use crate::model::mass_spring::MassSpring;
use crate::model::shape_based::{RotationReading, ShapeBased};
use crate::model::{Known, Report, Share};
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
    pub(crate) fn new(body: &Arc<Body>, model: Known<'_>, scheme: Scheme, gravity: DVec3, step: f64) -> Self {
        /// Relative to the size of the body. Round-off, 1e-15 of the distance from the origin, decides whether a node
        /// is on a surface, so this suffices for bodies that are nearer than a billion times their size.
        const MARGIN: f64 = 1e-3;
        let (stepper, stiffness, of) = match model {
            Known::ShapeBased(model) => {
                let rotation = rotation(body, model);
                let stepper = shape_based(body, model, rotation, scheme, gravity, step);
                (stepper, model.stiffness, Elastic::Elements(rotation))
            }
            Known::MassSpring(model) => {
                let springs = Arc::clone(&model.springs);
                (mass_spring(body, model, gravity, step), model.stiffness, Elastic::Springs(springs))
            }
        };
        let energy = Energy { set: Set::best(), body: Arc::clone(body), stiffness, of };
        Self { rollback: Rollback::new(stepper, scheme), energy, constraints: None, margin: MARGIN * body.extent() }
    }
}

fn rotation(body: &Body, model: &ShapeBased) -> Rotation {
    match model.rotation {
        // Eq. (9) is the optimum.
        _ if body.dimension == Dimension::Plane => Rotation::Optimum,
        RotationReading::Robust => Rotation::Optimum,
        _ => Rotation::Arctangent { passes: model.passes },
    }
}

fn shape_based(
    body: &Body,
    model: &ShapeBased,
    rotation: Rotation,
    scheme: Scheme,
    gravity: DVec3,
    step: f64,
) -> Box<dyn Stepper> {
    let &ShapeBased { stiffness, damping, .. } = model;
    let parameters = lattice::Parameters { stiffness, damping, rotation, gravity, step };
    if let Some(lattice) = LatticeStepper::new(body, parameters, scheme, Set::best()) {
        return Box::new(lattice);
    }
    Box::new(General::new(body, rotation, Constants { stiffness, damping, gravity, step }, Set::best()))
}

fn mass_spring(body: &Body, model: &MassSpring, gravity: DVec3, step: f64) -> Box<dyn Stepper> {
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
