//! Steps as passes over the nodes of each part, and [`Rollback`], which advances all parts and finds the step in which a
//! run diverges.

use super::update::Stage;
use super::{Around, Forces, Lost, Meeting};
use crate::contact::Timing;
use crate::crew::Crew;
use crate::integrate::Integrator;
use crate::integrate::composition::{self, Composition};
use crate::state::Runaway;
use crate::state::State;
use glam::DVec3;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// How positions and velocities are advanced by a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Scheme {
    /// Eq. (2), then Eq. (3) with the new velocity.
    SemiImplicitEuler,
    /// Eq. (3) with the old velocity.
    ExplicitEuler,
    /// Velocity Verlet.
    VelocityVerlet,
    /// Drifts and kicks.
    Composition(Composition),
}

impl Scheme {
    /// The velocities that matter for contact of surfaces.
    pub(crate) fn timing(self) -> Timing {
        match self {
            Self::SemiImplicitEuler | Self::ExplicitEuler => Timing::End,
            Self::VelocityVerlet | Self::Composition(_) => Timing::Start,
        }
    }

    /// Whether nodes keep an acceleration from one pass to the next.
    pub(crate) fn keeps_acceleration(self) -> bool {
        matches!(self, Self::VelocityVerlet | Self::Composition(_))
    }

    /// The scheme of an integrator; `None` for an integrator without vectorised steps.
    pub(crate) fn of(integrator: Integrator) -> Option<Self> {
        match integrator {
            Integrator::SemiImplicitEuler => Some(Self::SemiImplicitEuler),
            Integrator::ExplicitEuler => Some(Self::ExplicitEuler),
            Integrator::VelocityVerlet => Some(Self::VelocityVerlet),
            Integrator::Pefrl => Some(Self::Composition(composition::PEFRL)),
            Integrator::RungeKutta | Integrator::DormandPrince | Integrator::BackwardEuler => None,
        }
    }
}

/// One pass over all nodes of a part, with one evaluation of the forces unless they are known.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pass {
    /// What the pass computes.
    pub(crate) stage: Stage,
    /// The number of the step.
    pub(crate) number: u64,
    /// Whether the rotations of this pass are stored, so that the next evaluation starts from them.
    pub(crate) commit: bool,
    /// The shares of the step after which positions are at its start and at its end.
    pub(crate) shares: [f64; 2],
}

/// The passes of a number of steps.
///
/// Without damping, velocity Verlet uses the forces at the end of a step in the next step, too. The last pass does not
/// store its rotations: the next call evaluates the same forces again, from the same rotations, with the same bits. So
/// positions, velocities and rotations are the whole state, and the bits do not depend on how steps are divided into
/// calls.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passes {
    pub(crate) scheme: Scheme,
    /// Whether forces depend on velocities.
    pub(crate) is_damped: bool,
    /// Whether grips, contact with other nodes or forces that change act between passes.
    pub(crate) is_interrupted: bool,
    /// The number of the first step.
    pub(crate) first: u64,
    pub(crate) steps: u64,
}

impl Passes {
    /// The number of passes.
    #[inline(always)]
    pub(crate) fn len(&self) -> u64 {
        match self.scheme {
            Scheme::VelocityVerlet if self.is_damped || self.is_interrupted => 2 * self.steps,
            Scheme::VelocityVerlet if self.steps > 0 => self.steps + 1,
            Scheme::Composition(composition) => (composition.evaluations() as u64 + 1) * self.steps,
            _ => self.steps,
        }
    }

    /// One pass.
    #[inline(always)]
    pub(crate) fn get(&self, pass: u64) -> Pass {
        let is_last = pass + 1 == self.len();
        let mut shares = [0.0, 1.0];
        let (stage, step, commit) = match self.scheme {
            Scheme::SemiImplicitEuler => (Stage::SemiImplicitEuler, pass, true),
            Scheme::ExplicitEuler => (Stage::ExplicitEuler, pass, true),
            Scheme::VelocityVerlet if self.is_damped || self.is_interrupted => match pass % 2 {
                0 if self.is_damped || pass == 0 => (Stage::Drift, pass / 2, true),
                0 => (Stage::Coast, pass / 2, true),
                _ => (Stage::Finish, pass / 2, !self.is_damped && !is_last),
            },
            Scheme::VelocityVerlet if pass == 0 => (Stage::Drift, 0, true),
            Scheme::VelocityVerlet if is_last => (Stage::Finish, pass - 1, false),
            Scheme::VelocityVerlet => (Stage::FinishDrift, pass, true),
            Scheme::Composition(composition) => {
                let stages = composition.evaluations() as u64 + 1;
                let (step, at) = (pass / stages, (pass % stages) as usize);
                let drift = composition.drift(at);
                let stage = match at {
                    0 => Stage::Leave(drift),
                    _ if at < composition.evaluations() => Stage::Kick([composition.kick(at - 1), drift]),
                    _ => Stage::Arrive([composition.kick(at - 1), drift]),
                };
                shares = [at.checked_sub(1).map_or(0.0, |before| composition.share(before)), composition.share(at)];
                (stage, step, true)
            }
        };
        if stage == Stage::Finish {
            shares[0] = 1.0;
        }
        Pass { stage, number: self.first + step, commit, shares }
    }
}

/// Forces and motion of a body in lanes, with positions, velocities and rotations in arrays of their own.
pub(crate) trait Stepper: Send + Sync {
    /// Reads a state: positions (m), velocities (m/s), and the memory of the model.
    fn load(&mut self, position: &[DVec3], velocity: &[DVec3], memory: &[f64]);
    /// Writes the state.
    fn store(&mut self, position: &mut [DVec3], velocity: &mut [DVec3], memory: &mut [f64]);
    /// The position (m) and velocity (m/s) of a node.
    fn node(&mut self, node: usize) -> (DVec3, DVec3);
    /// Appends the positions and velocities of some nodes of the body, whose first node has the number `first` there.
    fn read_some(&mut self, some: &[u32], first: usize, state: &mut State) {
        for &node in some {
            let (position, velocity) = self.node(node as usize - first);
            state.position.push(position);
            state.velocity.push(velocity);
        }
    }
    /// Sets the position and velocity of a node.
    fn set_node(&mut self, node: usize, position: DVec3, velocity: DVec3);
    /// Sets the positions (m) and velocities (m/s) of all nodes.
    fn place(&mut self, position: &[DVec3], velocity: &[DVec3]) {
        for (node, (&position, &velocity)) in position.iter().zip(velocity).enumerate() {
            self.set_node(node, position, velocity);
        }
    }
    /// Writes the positions and velocities of all nodes.
    fn read(&mut self, position: &mut [DVec3], velocity: &mut [DVec3]) {
        for (node, (position, velocity)) in position.iter_mut().zip(velocity).enumerate() {
            (*position, *velocity) = self.node(node);
        }
    }
    /// Whether forces depend on velocities.
    fn is_damped(&self) -> bool;
    /// A copy with the state.
    fn copy(&self) -> Box<dyn Stepper>;
    /// Keeps a copy of the state.
    fn keep(&mut self);
    /// Restores the state from the copy.
    fn restore(&mut self);
    /// Executes some of the passes, until a node is too fast. One thread returns the first such node, several threads any of
    /// them. The state is then undefined.
    fn run(&mut self, passes: Passes, some: Range<u64>, around: &Around<'_>, crew: &Crew) -> Option<Lost>;
}

impl Clone for Box<dyn Stepper> {
    fn clone(&self) -> Self {
        self.copy()
    }
}

/// The stepper of a part, and which nodes and which memory are its own.
#[derive(Clone)]
pub(crate) struct PartStepper {
    pub(crate) stepper: Box<dyn Stepper>,
    pub(crate) nodes: Range<usize>,
    pub(crate) memory: Range<usize>,
}

impl PartStepper {
    fn passes(&self, scheme: Scheme, steps: &Range<u64>, around: &Around<'_>) -> Passes {
        let is_held = around.grips.is_some_and(|grips| grips.hold(&self.nodes));
        Passes {
            scheme,
            is_damped: self.stepper.is_damped() || around.mass_damping > 0.0,
            is_interrupted: is_held || around.meeting.is_some() || around.push.is_some(),
            first: steps.start,
            steps: steps.end - steps.start,
        }
    }

    /// Executes some of the passes; see [`Stepper::run`]. Grips place nodes after each of them.
    fn run(&mut self, passes: Passes, some: Range<u64>, around: &Around<'_>, crew: &Crew) -> Option<Lost> {
        let Self { stepper, nodes, .. } = self;
        let first = nodes.start;
        let forces = around.forces.map(|of| of.get(nodes.clone()).unwrap_or_default());
        let resolve = |step: u64, node: usize, position: &mut DVec3, velocity: &mut DVec3, acceleration: DVec3| {
            (around.resolve)(step, first + node, position, velocity, acceleration);
        };
        let around = &Around { forces, resolve: &resolve, ..*around };
        let free = Around { bounds: &[], row: &|_| 0..0, floor: None, ..*around };
        let around = if around.apart.contains(nodes) { &free } else { around };
        let held = around.grips.and_then(|grips| Some((grips, grips.mask(nodes)?)));
        let lost = match held {
            None => stepper.run(passes, some, around, crew),
            Some((grips, mask)) => {
                let around = Around { held: &mask, ..*around };
                some.into_iter().find_map(|pass| {
                    let lost = stepper.run(passes, pass..pass + 1, &around, crew);
                    let Pass { number, shares: [_, share], .. } = passes.get(pass);
                    grips.place(nodes, number, share, |grip, node, position, velocity| {
                        if grips.is_felt() {
                            let (at, speed) = stepper.node(node);
                            grips.feel(number, [grip, first + node], [at, speed], [position, velocity]);
                        }
                        stepper.set_node(node, position, velocity);
                    });
                    lost
                })
            }
        };
        lost.map(|Lost { step, node }| Lost { step, node: nodes.start + node })
    }
}

/// The steppers of all parts with copies of an earlier state, to which all parts go back when a node has become too fast.
///
/// Until nodes of different parts meet, each part takes many steps alone, which keeps its data in the caches.
#[derive(Clone)]
pub(crate) struct Rollback {
    parts: Vec<PartStepper>,
    scheme: Scheme,
    /// Steps taken.
    steps: u64,
    /// The number of steps of the copy, if steps since then may be repeated.
    kept: Option<u64>,
    /// The nodes that may meet, before and after a step.
    buffers: [State; 2],
    /// The numbers among them of those that contact has changed.
    changed: Vec<u32>,
    /// Places of all nodes (m), of which those with loads are up to date.
    loaded: State,
}

impl Rollback {
    /// Number of steps between copies of the state. A copy costs a small part of that many steps.
    const KEPT: u64 = 32;

    /// Parts in the order of their nodes.
    pub(crate) fn new(parts: Vec<PartStepper>, scheme: Scheme) -> Self {
        let buffers = [(); 2].map(|()| State::default());
        Self { parts, scheme, steps: 0, kept: None, buffers, changed: Vec::new(), loaded: State::default() }
    }

    /// Reads a state after `steps` steps.
    pub(crate) fn load(&mut self, steps: u64, position: &[DVec3], velocity: &[DVec3], memory: &[f64]) {
        for PartStepper { stepper, nodes, memory: own } in &mut self.parts {
            stepper.load(&position[nodes.clone()], &velocity[nodes.clone()], &memory[own.clone()]);
        }
        (self.steps, self.kept) = (steps, None);
    }

    /// Writes the state.
    pub(crate) fn store(&mut self, position: &mut [DVec3], velocity: &mut [DVec3], memory: &mut [f64]) {
        for PartStepper { stepper, nodes, memory: own } in &mut self.parts {
            stepper.store(&mut position[nodes.clone()], &mut velocity[nodes.clone()], &mut memory[own.clone()]);
        }
    }

    /// Sets positions (m) and velocities (m/s), without the memory of models.
    pub(crate) fn place(&mut self, position: &[DVec3], velocity: &[DVec3]) {
        for PartStepper { stepper, nodes, .. } in &mut self.parts {
            stepper.place(&position[nodes.clone()], &velocity[nodes.clone()]);
        }
    }

    /// Writes positions and velocities.
    pub(crate) fn nodes(&mut self, position: &mut [DVec3], velocity: &mut [DVec3]) {
        for PartStepper { stepper, nodes, .. } in &mut self.parts {
            stepper.read(&mut position[nodes.clone()], &mut velocity[nodes.clone()]);
        }
    }

    /// The position (m) and velocity (m/s) of a node.
    pub(crate) fn node(&mut self, node: usize) -> (DVec3, DVec3) {
        let part = self.parts.partition_point(|part| part.nodes.end <= node);
        let PartStepper { stepper, nodes, .. } = &mut self.parts[part];
        stepper.node(node - nodes.start)
    }

    /// How positions and velocities are advanced.
    pub(crate) fn scheme(&self) -> Scheme {
        self.scheme
    }

    /// Steps taken.
    pub(crate) fn steps(&self) -> u64 {
        self.steps
    }

    /// The first step that may be repeated.
    pub(crate) fn earliest(&self) -> u64 {
        self.kept.filter(|kept| self.steps < kept + Self::KEPT).unwrap_or(self.steps)
    }

    /// Drops the copy, so that no step taken so far is repeated.
    pub(crate) fn arrive(&mut self) {
        self.kept = None;
    }

    /// Advances until `until` steps are taken. `around` must be valid for all steps from [`Self::earliest`] on.
    ///
    /// # Errors
    /// When a node would become faster than the limit: the state of all parts is then the one before that step.
    pub(crate) fn advance(&mut self, until: u64, around: &Around<'_>, crew: &Crew) -> Result<(), Runaway> {
        while self.steps < until {
            let from = self.earliest();
            if self.kept != Some(from) {
                self.parts.iter_mut().for_each(|part| part.stepper.keep());
                self.kept = Some(from);
                around.impulses.inspect(|impulses| impulses.keep());
                around.work.inspect(|work| work.keep());
            }
            let mut end = until.min(from + Self::KEPT);
            if let Some(count) = self.run_alone(end - self.steps, around, crew) {
                self.steps += count;
                continue;
            }
            if self.run(self.steps..end, around, crew).is_none() {
                self.steps = end;
                continue;
            }
            // Threads and parts are not always in the same step, so another node may have exceeded the limit in an earlier
            // step. It is found by repeating the steps before with one thread.
            let mut node = 0;
            loop {
                self.restore(around);
                match self.run(from..end, around, &Crew::new(1)) {
                    Some(lost) => (end, node) = (lost.step, lost.node),
                    None => break,
                }
            }
            self.steps = end;
            return Err(Runaway { node });
        }
        Ok(())
    }

    /// Takes as many of some steps as nodes can take without meeting, and returns their number; `None` if they may meet. The steps since the
    /// copy are then taken again, if nodes have become so fast that they might have met.
    fn run_alone(&mut self, most: u64, around: &Around<'_>, crew: &Crew) -> Option<u64> {
        let meeting = around.meeting?;
        let mut after = std::mem::take(&mut self.buffers[1]);
        self.read(meeting.nodes, &mut after);
        let found = (meeting.alone)(self.steps, after.nodes(), most);
        self.buffers[1] = after;
        let (count, speed) = found?;
        let limit = |step| (around.speed_limit)(step).min(speed);
        let apart = Around { meeting: None, speed_limit: &limit, ..*around };
        if self.run(self.steps..self.steps + count, &apart, crew).is_none() {
            return Some(count);
        }
        self.restore(around);
        let from = self.kept?;
        let lost = self.run(from..self.steps, around, crew);
        debug_assert!(lost.is_none(), "steps that were taken before");
        None
    }

    /// Goes back to the copy.
    fn restore(&mut self, around: &Around<'_>) {
        self.parts.iter_mut().for_each(|part| part.stepper.restore());
        around.impulses.inspect(|impulses| impulses.forget(0));
        around.work.inspect(|work| work.restore());
    }

    /// Takes steps, until a node is too fast. The state is then undefined.
    fn run(&mut self, steps: Range<u64>, around: &Around<'_>, crew: &Crew) -> Option<Lost> {
        let (scheme, count) = (self.scheme, self.parts.last()?.nodes.end);
        if around.meeting.is_none() && around.push.is_none() {
            return self.each(crew, |part, crew| {
                let passes = part.passes(scheme, &steps, around);
                part.run(passes, 0..passes.len(), around, crew)
            });
        }
        // Passes that are interrupted have the same numbers and contact in all parts.
        let outline = self.parts[0].passes(scheme, &steps, around);
        let mut buffers = std::mem::take(&mut self.buffers);
        let [before, after] = &mut buffers;
        let mut changed = std::mem::take(&mut self.changed);
        let (mut begun, mut is_read) = (None, false);
        let mut forces = Forces::zero(if around.push.is_some() { count } else { 0 });
        let mut lost = None;
        for pass in 0..outline.len() {
            let Pass { number, stage, shares, .. } = outline.get(pass);
            if let Some(Meeting { nodes, .. }) = around.meeting.filter(|_| begun.replace(number) != Some(number)) {
                // What contact has left is the start of the next step.
                if is_read { std::mem::swap(before, after) } else { self.read(nodes, before) }
            }
            if let Some(push) = around.push {
                self.loaded.position.resize(count, DVec3::ZERO);
                self.loaded.velocity.resize(count, DVec3::ZERO);
                for node in around.work.map_or(&[][..], |work| work.nodes()).iter().map(|&node| node as usize) {
                    (self.loaded.position[node], self.loaded.velocity[node]) = self.node(node);
                }
                push(number, shares[0], self.loaded.nodes(), &mut forces);
            }
            let around = if around.push.is_some() { &Around { forces: forces.columns(), ..*around } } else { around };
            lost = self.each(crew, |part, crew| {
                let passes = part.passes(scheme, &steps, around);
                part.run(passes, pass..pass + 1, around, crew)
            });
            if lost.is_some() {
                break;
            }
            if let Some(Meeting { meet, nodes, .. }) = around.meeting.filter(|_| stage.has_contact()) {
                self.read(nodes, after);
                changed.clear();
                meet(number, before.nodes(), after, &mut changed);
                self.write(nodes, &changed, after);
                is_read = true;
            } else {
                is_read = false;
            }
        }
        (self.buffers, self.changed) = (buffers, changed);
        lost
    }

    /// Calls `advance` with each part and its threads, and returns the first of all nodes that are too fast. A part that
    /// can be divided among threads at least as well as the parts of its size has all threads of the crew. The others have
    /// one thread each, several of them at the same time.
    fn each(&mut self, crew: &Crew, advance: impl Fn(&mut PartStepper, &Crew) -> Option<Lost> + Sync) -> Option<Lost> {
        /// The least number of nodes for each thread.
        const LEAST: usize = 2000;
        let (all, threads) = (self.parts.last()?.nodes.end, crew.threads());
        let is_divided = |part: &PartStepper| {
            let nodes = part.nodes.len().max(1);
            (nodes / LEAST).clamp(1, threads) >= (all / nodes).min(threads)
        };
        let divided = self.parts.iter_mut().filter(|part| is_divided(part));
        let first = divided.filter_map(|part| advance(part, crew)).min();
        if self.parts.iter().all(is_divided) {
            return first;
        }
        let mut whole: Vec<_> = self.parts.iter_mut().filter(|part| !is_divided(part)).collect();
        let (alone, found) = (Crew::new(1), Mutex::new(first));
        crew.each(&mut whole, |_, part| {
            if let Some(lost) = advance(part, &alone) {
                let mut found = found.lock().unwrap_or_else(PoisonError::into_inner);
                *found = Some(found.map_or(lost, |found| found.min(lost)));
            }
        });
        found.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reads some nodes, which are sorted.
    fn read(&mut self, mut some: &[u32], state: &mut State) {
        state.position.clear();
        state.velocity.clear();
        for PartStepper { stepper, nodes, .. } in &mut self.parts {
            let (own, others) = some.split_at(some.partition_point(|&node| (node as usize) < nodes.end));
            stepper.read_some(own, nodes.start, state);
            some = others;
        }
    }

    /// Writes those of some nodes that have changed, by their numbers among them.
    fn write(&mut self, some: &[u32], changed: &[u32], state: &State) {
        for &number in changed {
            let (node, number) = (some[number as usize] as usize, number as usize);
            let part = self.parts.partition_point(|part| part.nodes.end <= node);
            let PartStepper { stepper, nodes, .. } = &mut self.parts[part];
            stepper.set_node(node - nodes.start, state.position[number], state.velocity[number]);
        }
    }
}
