//! Velocity Verlet: `P += V ΔT + A ΔT²/2`, then `V += (A + A')/2 ΔT` with the accelerations `A'` at the new positions.
//!
//! Damping needs a velocity before the new one is known: `A'` is evaluated with `V + A ΔT`, which keeps the method of
//! second order. Without damping `A'` is used as `A` of the next step. With damping the next step evaluates `A` anew
//! with the final velocity. That makes the method stable for `dV/dt = −c V` up to `c ΔT < 2`; with the predicted
//! velocity the limit would be half of that.
//!
//! Contact and kinematic constraints act on the new positions and the predicted velocities `V + A ΔT`, before `A'` is
//! evaluated, so forces are never evaluated inside an obstacle.
//!
//! W. Swope, H. Andersen, P. Berens, K. Wilson, J. Chem. Phys. 76, 637 (1982).
//!
//! Its memory, without damping, is the evaluation at the present state: the accelerations, then the memory of the
//! models that belongs to them.

use super::{Interval, Runaway, State, System, Trial, check, evaluate, split};

/// Computes a step; `limit` (m/s) is the greatest speed.
pub(super) fn step(
    system: &System,
    interval: Interval,
    limit: f64,
    state: &State,
    trial: &mut Trial,
) -> Result<(), Runaway> {
    let Trial { next, evaluations: [at_start, at_end], scratch, .. } = trial;
    let step = interval.step;
    let known = &state.memory.integrator;
    // Anything else is the memory of another method.
    let is_known = known.len() == 3 * state.position.len() + state.memory.model.len();
    if !is_known {
        evaluate(system, state.nodes(), &state.memory.model, at_start, scratch);
    }
    let (acceleration, model) = split(if is_known { known } else { at_start }, system);
    next.memory.model.copy_from_slice(model);
    // The new positions, and the velocities predicted with constant acceleration.
    for (node, &acceleration) in acceleration.iter().enumerate() {
        let (from, old) = (state.position[node], state.velocity[node]);
        let predicted = old + acceleration * step;
        next.velocity[node] = predicted;
        next.position[node] = from + (old + predicted) * (0.5 * step);
    }
    check(&next.velocity, limit)?;
    system.constrain(interval, state, next, Some(acceleration));
    evaluate(system, next.nodes(), &next.memory.model, at_end, scratch);
    let (next_acceleration, _) = split(at_end, system);
    for ((velocity, &before), &after) in next.velocity.iter_mut().zip(acceleration).zip(next_acceleration) {
        *velocity += (after - before) * (0.5 * step);
    }
    system.hold(interval, next);
    check(&next.velocity, limit)?;
    if system.is_damped() {
        next.memory.integrator.clear();
    } else {
        std::mem::swap(&mut next.memory.integrator, at_end);
    }
    Ok(())
}
