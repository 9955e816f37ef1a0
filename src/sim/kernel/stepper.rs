//! Steps as passes over all nodes, and a body that takes them.

use super::motion::Stage;
use super::{Around, Lost};
use crate::sim::crew::Crew;
use crate::sim::dynamics::Runaway;
use glam::DVec3;
use std::ops::Range;

/// How positions and velocities move from one step to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::sim) enum Scheme {
    /// Eq. (2), then Eq. (3) with the new velocity.
    SemiImplicitEuler,
    /// Eq. (3) with the old velocity.
    ExplicitEuler,
    /// Velocity Verlet.
    VelocityVerlet,
}

/// One motion of all nodes, with one evaluation of the forces unless they are known.
#[derive(Clone, Copy, Debug)]
pub(in crate::sim) struct Pass {
    /// What is done.
    pub(in crate::sim) stage: Stage,
    /// In which step.
    pub(in crate::sim) number: u64,
    /// Whether the rotations that it finds are those from which the next evaluation starts.
    pub(in crate::sim) commit: bool,
}

/// The passes of some steps.
///
/// Without damping the forces at the end of a step of velocity Verlet serve the next step, too. Those at the end of the last
/// step do not keep their rotations: the next call finds both again from the same rotations, with the same bits. So positions,
/// velocities and rotations are all that is remembered, and however steps are cut up, they have the same bits.
#[derive(Clone, Copy, Debug)]
pub(in crate::sim) struct Passes {
    pub(in crate::sim) scheme: Scheme,
    /// Whether forces depend on velocities.
    pub(in crate::sim) is_damped: bool,
    /// Whether grips place nodes after each pass.
    pub(in crate::sim) is_held: bool,
    /// The number of the first step.
    pub(in crate::sim) first: u64,
    pub(in crate::sim) steps: u64,
}

impl Passes {
    /// How many there are.
    #[inline(always)]
    pub(in crate::sim) fn len(&self) -> u64 {
        match self.scheme {
            Scheme::VelocityVerlet if self.is_damped || self.is_held => 2 * self.steps,
            Scheme::VelocityVerlet if self.steps > 0 => self.steps + 1,
            _ => self.steps,
        }
    }

    /// One of them.
    #[inline(always)]
    pub(in crate::sim) fn get(&self, pass: u64) -> Pass {
        let is_last = pass + 1 == self.len();
        let (stage, step, commit) = match self.scheme {
            Scheme::SemiImplicitEuler => (Stage::SemiImplicitEuler, pass, true),
            Scheme::ExplicitEuler => (Stage::ExplicitEuler, pass, true),
            Scheme::VelocityVerlet if self.is_damped || self.is_held => match pass % 2 {
                0 if self.is_damped || pass == 0 => (Stage::Drift, pass / 2, true),
                0 => (Stage::Coast, pass / 2, true),
                _ => (Stage::Finish, pass / 2, !self.is_damped && !is_last),
            },
            Scheme::VelocityVerlet if pass == 0 => (Stage::Drift, 0, true),
            Scheme::VelocityVerlet if is_last => (Stage::Finish, pass - 1, false),
            Scheme::VelocityVerlet => (Stage::FinishDrift, pass, true),
        };
        Pass { stage, number: self.first + step, commit }
    }
}

/// Forces and motion of a body in lanes. It holds positions, velocities and rotations in arrays of its own.
pub(in crate::sim) trait Stepper: Send + Sync {
    /// Takes over a state: positions (m), velocities (m/s), and what the model remembers.
    fn load(&mut self, position: &[DVec3], velocity: &[DVec3], memory: &[f64]);
    /// Hands the state out.
    fn store(&mut self, position: &mut [DVec3], velocity: &mut [DVec3], memory: &mut [f64]);
    /// The position (m) and velocity (m/s) of a node.
    fn node(&mut self, node: usize) -> (DVec3, DVec3);
    /// Puts a node somewhere else.
    fn set_node(&mut self, node: usize, position: DVec3, velocity: DVec3);
    /// Whether forces depend on velocities.
    fn is_damped(&self) -> bool;
    /// Copies the state.
    fn keep(&mut self);
    /// Puts the copy in the state's place.
    fn restore(&mut self);
    /// Carries out some of the passes, until a node has become too fast. A crew of one finds the first such node, a larger one
    /// any. The state is of no use then.
    fn run(&mut self, passes: Passes, some: Range<u64>, around: &Around<'_>, crew: &mut Crew) -> Option<Lost>;
}

/// A body on its way from step to step.
pub(in crate::sim) struct Way {
    pub(in crate::sim) stepper: Box<dyn Stepper>,
    scheme: Scheme,
    /// Steps taken.
    steps: u64,
    /// How many it had taken when the state was copied, if that copy may be returned to.
    kept: Option<u64>,
}

impl Way {
    /// The steps after which the state is copied anew. A copy costs a small part of them.
    const KEPT: u64 = 32;

    pub(in crate::sim) fn new(stepper: Box<dyn Stepper>, scheme: Scheme) -> Self {
        Self { stepper, scheme, steps: 0, kept: None }
    }

    /// Takes over a state after so many steps.
    pub(in crate::sim) fn load(&mut self, steps: u64, position: &[DVec3], velocity: &[DVec3], memory: &[f64]) {
        self.stepper.load(position, velocity, memory);
        (self.steps, self.kept) = (steps, None);
    }

    /// Steps taken.
    pub(in crate::sim) fn steps(&self) -> u64 {
        self.steps
    }

    /// The first of the steps that may be taken again.
    pub(in crate::sim) fn earliest(&self) -> u64 {
        self.kept.filter(|kept| self.steps < kept + Self::KEPT).unwrap_or(self.steps)
    }

    /// Takes no step again that was taken so far.
    pub(in crate::sim) fn arrive(&mut self) {
        self.kept = None;
    }

    /// Goes on until so many steps are taken. `around` knows all steps from [`Self::earliest`] on.
    ///
    /// # Errors
    /// When a node would become faster than the limit: it then stands before that step.
    pub(in crate::sim) fn advance(&mut self, until: u64, around: &Around<'_>, crew: &mut Crew) -> Result<(), Runaway> {
        while self.steps < until {
            let from = self.earliest();
            if self.kept != Some(from) {
                self.stepper.keep();
                self.kept = Some(from);
            }
            let mut end = until.min(from + Self::KEPT);
            if self.run(self.steps..end, around, crew).is_none() {
                self.steps = end;
                continue;
            }
            // Threads are not always in the same step, and steps overlap: an earlier one may have been lost, which shows when
            // one thread takes only those before.
            let mut node = 0;
            loop {
                self.stepper.restore();
                match self.run(from..end, around, &mut Crew::new(1)) {
                    Some(lost) => (end, node) = (lost.step, lost.node),
                    None => break,
                }
            }
            self.steps = end;
            return Err(Runaway { node });
        }
        Ok(())
    }

    fn run(&mut self, steps: Range<u64>, around: &Around<'_>, crew: &mut Crew) -> Option<Lost> {
        let Self { stepper, scheme, .. } = self;
        let is_damped = stepper.is_damped();
        let (first, steps) = (steps.start, steps.end - steps.start);
        let passes = Passes { scheme: *scheme, is_damped, is_held: around.grips.is_some(), first, steps };
        let Some(grips) = around.grips else { return stepper.run(passes, 0..passes.len(), around, crew) };
        (0..passes.len()).find_map(|pass| {
            let lost = stepper.run(passes, pass..pass + 1, around, crew);
            grips(passes.get(pass).number, &mut |node, position, velocity| {
                stepper.set_node(node, position, velocity);
            });
            lost
        })
    }
}
