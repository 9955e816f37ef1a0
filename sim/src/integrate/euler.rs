//! Eqs. (2) and (3): `V += F/m ΔT`, then `P += V ΔT` with the new velocity or, as printed, with the old one. Models that move their nodes
//! themselves then do so.
//!
//! With the old velocity the eigenvalues of an undamped oscillation are `1 ± iωΔT`, outside the unit circle for every step, so its energy
//! grows without bound. The results in the paper can only come from the new velocity.

use super::{Method, Runaway, Scratch, State, Step};

/// The methods with their buffer.
pub(super) struct Euler {
    /// Whether positions change by the old velocity.
    is_explicit: bool,
    scratch: Scratch,
}

impl Euler {
    pub(super) fn new(is_explicit: bool) -> Self {
        Self { is_explicit, scratch: Scratch::default() }
    }
}

impl Method for Euler {
    #[doc(alias = "Eq. 3")]
    fn step(&mut self, step: &Step<'_>, state: &State, next: &mut State) -> Result<(), Runaway> {
        step.velocities(state, next, &mut self.scratch)?;
        let velocities = if self.is_explicit { &state.velocity } else { &next.velocity };
        for ((position, &from), &velocity) in next.position.iter_mut().zip(&state.position).zip(velocities) {
            *position = from + velocity * step.interval.step;
        }
        if step.system.project(step.interval, state, next) {
            step.check(next)?;
        }
        step.constrain(state, next, None);
        Ok(())
    }

    fn copy(&self) -> Box<dyn Method> {
        Box::new(Self::new(self.is_explicit))
    }
}
