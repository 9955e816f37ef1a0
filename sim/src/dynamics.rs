//! The interface of the codes that advance a state: the reference code with its integrators, the vectorised kernels, and
//! recordings.

use super::crew::Crew;
use super::limit::SpeedLimit;
use super::model::{Report, Share};
use super::part::Part;
use super::state::{Divergence, Runaway, State, Unsolved};
use super::system::System;

/// Advances a state. It may keep the nodes in its own arrays between calls.
pub(super) trait Dynamics: Send + Sync {
    /// Takes `count` steps from the present state, and counts them.
    ///
    /// # Errors
    /// When a node would become faster than the limit: the state is then the one before that step.
    fn advance(&mut self, system: &System, limit: &SpeedLimit, state: &mut State, count: u64) -> Result<(), Runaway>;

    /// Writes the state back, if it is kept elsewhere.
    fn settle(&mut self, _state: &mut State) {}

    /// Takes the positions and velocities of nodes from a state, and nothing else.
    fn place(&mut self, _state: &State) {}

    /// Writes the positions and velocities of nodes back, and nothing else.
    fn read(&mut self, _state: &mut State) {}

    /// Energy and residuals of a part in a state that is settled. Calls `share`, if given, as [`ForceModel::report`]
    /// does, which is the reference. It may use the threads of the crew.
    ///
    /// [`ForceModel::report`]: super::model::ForceModel::report
    fn report(&self, part: &Part, state: &State, share: Option<&mut Share<'_>>, _: &Crew) -> Report {
        let memory = &state.memory.model[part.memory.clone()];
        part.forces.report(part.nodes_of(state.nodes()), memory, share.unwrap_or(&mut |_, _, _| {}))
    }

    /// Where and when a run diverged whose next step was not taken.
    fn divergence(&self, system: &System, state: &State, runaway: Runaway) -> Divergence {
        system.divergence(state, runaway)
    }

    /// The steps that an implicit method has not solved.
    fn unsolved(&self, _: &State) -> Option<Unsolved> {
        None
    }

    /// Whether states were computed elsewhere.
    fn is_recorded(&self) -> bool {
        false
    }

    /// The number of steps taken. The state may be behind until [`Self::settle`] is called.
    fn steps(&self, state: &State) -> u64 {
        state.steps
    }

    /// A copy for another world in the same state.
    fn copy(&self) -> Box<dyn Dynamics>;

    /// Called after the state was replaced by another one: forgets everything derived from the old one.
    fn restart(&mut self) {}
}
