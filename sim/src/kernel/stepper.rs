//! Steps as passes over all nodes, and [`Rollback`], which finds the step in which a run diverges.

use super::update::Stage;
use super::{Around, Lost};
use crate::crew::Crew;
use crate::dynamics::Runaway;
use crate::integrate::Integrator;
use crate::integrate::composition::{self, Composition};
use glam::DVec3;
use std::ops::Range;

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

/// One pass over all nodes, with one evaluation of the forces unless they are known.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pass {
    /// What the pass computes.
    pub(crate) stage: Stage,
    /// The number of the step.
    pub(crate) number: u64,
    /// Whether the rotations of this pass are stored, so that the next evaluation starts from them.
    pub(crate) commit: bool,
    /// The share of the step after which positions are at its end.
    pub(crate) share: f64,
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
    /// Whether grips place nodes after each pass.
    pub(crate) is_held: bool,
    /// The number of the first step.
    pub(crate) first: u64,
    pub(crate) steps: u64,
}

impl Passes {
    /// The number of passes.
    #[inline(always)]
    pub(crate) fn len(&self) -> u64 {
        match self.scheme {
            Scheme::VelocityVerlet if self.is_damped || self.is_held => 2 * self.steps,
            Scheme::VelocityVerlet if self.steps > 0 => self.steps + 1,
            Scheme::Composition(composition) => (composition.evaluations() as u64 + 1) * self.steps,
            _ => self.steps,
        }
    }

    /// One pass.
    #[inline(always)]
    pub(crate) fn get(&self, pass: u64) -> Pass {
        let is_last = pass + 1 == self.len();
        let mut share = 1.0;
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
            Scheme::Composition(composition) => {
                let stages = composition.evaluations() as u64 + 1;
                let (step, at) = (pass / stages, (pass % stages) as usize);
                let drift = composition.drift(at);
                let stage = match at {
                    0 => Stage::Leave(drift),
                    _ if at < composition.evaluations() => Stage::Kick([composition.kick(at - 1), drift]),
                    _ => Stage::Arrive([composition.kick(at - 1), drift]),
                };
                share = composition.share(at);
                (stage, step, true)
            }
        };
        Pass { stage, number: self.first + step, commit, share }
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
    /// Sets the position and velocity of a node.
    fn set_node(&mut self, node: usize, position: DVec3, velocity: DVec3);
    /// Whether forces depend on velocities.
    fn is_damped(&self) -> bool;
    /// Keeps a copy of the state.
    fn keep(&mut self);
    /// Restores the state from the copy.
    fn restore(&mut self);
    /// Executes some of the passes, until a node is too fast. One thread returns the first such node, several threads any of
    /// them. The state is then undefined.
    fn run(&mut self, passes: Passes, some: Range<u64>, around: &Around<'_>, crew: &mut Crew) -> Option<Lost>;
}

/// A stepper with a copy of an earlier state, to which it goes back when a node has become too fast.
pub(crate) struct Rollback {
    pub(crate) stepper: Box<dyn Stepper>,
    scheme: Scheme,
    /// Steps taken.
    steps: u64,
    /// The number of steps of the copy, if steps since then may be repeated.
    kept: Option<u64>,
}

impl Rollback {
    /// Number of steps between copies of the state. A copy costs a small part of that many steps.
    const KEPT: u64 = 32;

    pub(crate) fn new(stepper: Box<dyn Stepper>, scheme: Scheme) -> Self {
        Self { stepper, scheme, steps: 0, kept: None }
    }

    /// Reads a state after `steps` steps.
    pub(crate) fn load(&mut self, steps: u64, position: &[DVec3], velocity: &[DVec3], memory: &[f64]) {
        self.stepper.load(position, velocity, memory);
        (self.steps, self.kept) = (steps, None);
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
    /// When a node would become faster than the limit: the state is then the one before that step.
    pub(crate) fn advance(&mut self, until: u64, around: &Around<'_>, crew: &mut Crew) -> Result<(), Runaway> {
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
            // Threads are not always in the same step, so another node may have exceeded the limit in an earlier step.
            // It is found by repeating the steps before with one thread.
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
        // In the second half of velocity Verlet the speed test comes before the grips, in the reference after them: here
        // it is part of the pass, which does not know the nodes that are held. So a node that is held is tested with
        // the velocity that its forces would give it. The limit is many times any speed of a run that does not diverge,
        // so that this decides only in which step a run stops that does.
        (0..passes.len()).find_map(|pass| {
            let lost = stepper.run(passes, pass..pass + 1, around, crew);
            let Pass { number, share, .. } = passes.get(pass);
            grips(number, share, &mut |node, position, velocity| {
                stepper.set_node(node, position, velocity);
            });
            lost
        })
    }
}
