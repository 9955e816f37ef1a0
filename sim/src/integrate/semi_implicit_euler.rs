//! Eqs. (2) and (3), the second with the new velocity of the first: `V += F/m ΔT`, then `P += V ΔT`. Models that move their nodes
//! themselves then do so.

use super::{Method, Runaway, Scratch, State, Step};

/// The method with its buffer.
#[derive(Default)]
pub(super) struct SemiImplicitEuler(Scratch);

impl Method for SemiImplicitEuler {
    #[doc(alias = "Eq. 3")]
    fn step(&mut self, step: &Step<'_>, state: &State, next: &mut State) -> Result<(), Runaway> {
        step.velocities(state, next, &mut self.0)?;
        for ((position, &from), &velocity) in next.position.iter_mut().zip(&state.position).zip(&next.velocity) {
            *position = from + velocity * step.interval.step;
        }
        if step.system.project(step.interval, state, next) {
            step.check(next)?;
        }
        step.constrain(state, next, None);
        Ok(())
    }

    fn copy(&self) -> Box<dyn Method> {
        Box::<Self>::default()
    }
}
