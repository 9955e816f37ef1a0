//! Eqs. (2) and (3) as printed: `P += V ΔT` with the old velocity, and `V += F/m ΔT`.
//!
//! The eigenvalues of an undamped oscillation are `1 ± iωΔT`, outside the unit circle for every step, so its energy
//! grows without bound. The results in the paper can only come from the new velocity.

use super::{Method, Runaway, Scratch, State, Step};

/// The method with its buffer.
#[derive(Default)]
pub(super) struct ExplicitEuler(Scratch);

impl Method for ExplicitEuler {
    fn step(&mut self, step: &Step<'_>, state: &State, next: &mut State) -> Result<(), Runaway> {
        step.velocities(state, next, &mut self.0)?;
        for ((position, &from), &velocity) in next.position.iter_mut().zip(&state.position).zip(&state.velocity) {
            *position = from + velocity * step.interval.step;
        }
        step.constrain(state, next, None);
        Ok(())
    }

    fn copy(&self) -> Box<dyn Method> {
        Box::<Self>::default()
    }
}
