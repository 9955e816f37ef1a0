//! Eqs. (2) and (3), the second with the new velocity of the first: `V += F/m ΔT`, then `P += V ΔT`.

use super::{Interval, Runaway, State, System, Trial};

/// Computes a step; `limit` (m/s) is the greatest speed.
#[doc(alias = "Eq. 3")]
pub(super) fn step(
    system: &System,
    interval: Interval,
    limit: f64,
    state: &State,
    trial: &mut Trial,
) -> Result<(), Runaway> {
    trial.velocities(system, interval, limit, state)?;
    let State { position, velocity, .. } = &mut trial.next;
    for ((position, &from), &velocity) in position.iter_mut().zip(&state.position).zip(&*velocity) {
        *position = from + velocity * interval.step;
    }
    system.constrain(interval, state, &mut trial.next, None);
    Ok(())
}
