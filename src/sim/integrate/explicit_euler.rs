//! Eqs. (2) and (3) as printed: `P += V ΔT` with the old velocity, and `V += F/m ΔT`.
//!
//! The eigenvalues of an undamped oscillation are `1 ± iωΔT`, outside the unit circle for every step: energy grows
//! without bound. The results that the paper shows need the new velocity.

use super::{Runaway, Step};
use crate::sim::body::State;
use glam::DVec3;

/// Takes a step; `forces` (N) become the new velocities (m/s).
pub(super) fn advance(step: &Step<'_>, state: &mut State, forces: &mut [DVec3]) -> Result<(), Runaway> {
    step.velocities(state, forces)?;
    for (position, &velocity) in state.position.iter_mut().zip(&state.velocity) {
        *position += velocity * step.step;
    }
    state.velocity.copy_from_slice(forces);
    Ok(())
}
