//! The classical Runge–Kutta method of fourth order for `dP/dt = V`, `dV/dt = F(P, V)/m`.
//!
//! W. Kutta, Zeitschrift für Mathematik und Physik 46, 435 (1901).
//!
//! Kinematic constraints place their nodes at the time of each stage, contact acts at the end of the step.

use super::{Evaluation, Method, Runaway, State, Step};
use glam::DVec3;

/// The method with its buffers.
#[derive(Default)]
pub(super) struct RungeKutta {
    evaluation: Evaluation,
    /// Weighted sums over the stages of velocities, then of accelerations.
    sums: [Vec<DVec3>; 2],
}

impl Method for RungeKutta {
    fn step(&mut self, step: &Step<'_>, state: &State, next: &mut State) -> Result<(), Runaway> {
        let Self { evaluation, sums } = self;
        let (nodes, time) = (state.position.len(), step.interval.step);
        for sums in &mut *sums {
            sums.clear();
            sums.resize(nodes, DVec3::ZERO);
        }
        let [velocities, accelerations] = sums;
        next.position.copy_from_slice(&state.position);
        next.velocity.copy_from_slice(&state.velocity);
        next.memory.model.copy_from_slice(&state.memory.model);
        // The shares of the step at which this stage and the one after it are evaluated, and the weight of this one.
        for (from, share, weight) in [(0.0, 0.5, 1.0), (0.5, 0.5, 2.0), (0.5, 1.0, 2.0), (1.0, 1.0, 1.0)] {
            step.evaluate(from, next.nodes(), &next.memory.model, evaluation);
            next.memory.model.copy_from_slice(&evaluation.memory);
            for node in 0..nodes {
                let (velocity, acceleration) = (next.velocity[node], evaluation.acceleration[node]);
                velocities[node] += velocity * weight;
                accelerations[node] += acceleration * weight;
                next.position[node] = state.position[node] + velocity * (share * time);
                next.velocity[node] = state.velocity[node] + acceleration * (share * time);
            }
            step.place_held(share, next);
        }
        for node in 0..nodes {
            next.position[node] = state.position[node] + velocities[node] * (time / 6.0);
            next.velocity[node] = state.velocity[node] + accelerations[node] * (time / 6.0);
        }
        step.finish(state, next)
    }

    fn copy(&self) -> Box<dyn Method> {
        Box::<Self>::default()
    }
}
