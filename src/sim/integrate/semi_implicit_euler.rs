//! Eqs. (2) and (3), the second with the velocity of the first: `V += F/m ΔT`, then `P += V ΔT`.

use super::{Runaway, Step};
use crate::sim::body::State;
use glam::DVec3;

/// Takes a step; `forces` (N) become the new velocities (m/s).
#[doc(alias = "Eq. 3")]
pub(super) fn advance(step: &Step<'_>, state: &mut State, forces: &mut [DVec3]) -> Result<(), Runaway> {
    step.velocities(state, forces)?;
    state.velocity.copy_from_slice(forces);
    for (position, &velocity) in state.position.iter_mut().zip(&state.velocity) {
        *position += velocity * step.step;
    }
    Ok(())
}
