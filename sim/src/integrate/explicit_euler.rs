//! Eqs. (2) and (3) as printed: `P += V ΔT` with the old velocity, and `V += F/m ΔT`.
//!
//! The eigenvalues of an undamped oscillation are `1 ± iωΔT`, outside the unit circle for every step, so its energy
//! grows without bound. The results in the paper can only come from the new velocity.

use super::{Interval, Runaway, State, System, Trial};

/// Computes a step; `limit` (m/s) is the greatest speed.
pub(super) fn step(
    system: &System,
    interval: Interval,
    limit: f64,
    state: &State,
    trial: &mut Trial,
) -> Result<(), Runaway> {
    trial.velocities(system, interval, limit, state)?;
    for ((position, &from), &velocity) in trial.next.position.iter_mut().zip(&state.position).zip(&state.velocity) {
        *position = from + velocity * interval.step;
    }
    system.constrain(interval, state, &mut trial.next, None);
    Ok(())
}
