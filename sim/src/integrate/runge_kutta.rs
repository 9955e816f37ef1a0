//! The classical Runge–Kutta method of fourth order for `dP/dt = V`, `dV/dt = F(P, V)/m`.
//!
//! W. Kutta, Zeitschrift für Mathematik und Physik 46, 435 (1901).
//!
//! Kinematic constraints place their nodes at the time of each stage, contact acts at the end of the step.

use super::{Interval, Runaway, State, System, Trial, evaluate, finish, split};
use glam::DVec3;

/// Computes a step; `limit` (m/s) is the greatest speed.
pub(super) fn step(
    system: &System,
    interval: Interval,
    limit: f64,
    state: &State,
    trial: &mut Trial,
) -> Result<(), Runaway> {
    let Trial { next, evaluations: [evaluation, sums], scratch, .. } = trial;
    let (nodes, step) = (state.position.len(), interval.step);
    sums.clear();
    sums.resize(6 * nodes, 0.0);
    let (velocities, accelerations) = bytemuck::cast_slice_mut::<f64, DVec3>(sums).split_at_mut(nodes);
    next.position.copy_from_slice(&state.position);
    next.velocity.copy_from_slice(&state.velocity);
    next.memory.model.copy_from_slice(&state.memory.model);
    // The share of the step at which the stage after this one is evaluated, and the weight of this one.
    for (share, weight) in [(0.5, 1.0), (0.5, 2.0), (1.0, 2.0), (1.0, 1.0)] {
        evaluate(system, next.nodes(), &next.memory.model, evaluation, scratch);
        let (acceleration, model) = split(evaluation, system);
        next.memory.model.copy_from_slice(model);
        for node in 0..nodes {
            let (velocity, acceleration) = (next.velocity[node], acceleration[node]);
            velocities[node] += velocity * weight;
            accelerations[node] += acceleration * weight;
            next.position[node] = state.position[node] + velocity * (share * step);
            next.velocity[node] = state.velocity[node] + acceleration * (share * step);
        }
        system.place_held(interval, share, next);
    }
    for node in 0..nodes {
        next.position[node] = state.position[node] + velocities[node] * (step / 6.0);
        next.velocity[node] = state.velocity[node] + accelerations[node] * (step / 6.0);
    }
    finish(system, interval, limit, state, next, sums)
}
