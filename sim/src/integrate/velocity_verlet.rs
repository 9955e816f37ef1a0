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

use super::{Evaluation, Method, Runaway, State, Step};
use glam::DVec3;

/// The method with its buffers.
#[derive(Default)]
pub(super) struct VelocityVerlet {
    at_start: Evaluation,
    at_end: Evaluation,
}

impl Method for VelocityVerlet {
    fn step(&mut self, step: &Step<'_>, state: &State, next: &mut State) -> Result<(), Runaway> {
        let Self { at_start, at_end } = self;
        let (nodes, time, known) = (state.position.len(), step.interval.step, &state.memory.integrator);
        // Anything else is the memory of another method.
        let is_known = known.len() == 3 * nodes + state.memory.model.len();
        let (acceleration, model): (&[DVec3], _) = if is_known {
            let (acceleration, model) = known.split_at(3 * nodes);
            (bytemuck::cast_slice(acceleration), model)
        } else {
            step.evaluate(0.0, state.nodes(), &state.memory.model, at_start);
            (&at_start.acceleration, &at_start.memory[..])
        };
        next.memory.model.copy_from_slice(model);
        // The new positions, and the velocities predicted with constant acceleration.
        for (node, &acceleration) in acceleration.iter().enumerate() {
            let (from, old) = (state.position[node], state.velocity[node]);
            let predicted = old + acceleration * time;
            next.velocity[node] = predicted;
            next.position[node] = from + (old + predicted) * (0.5 * time);
        }
        step.check(next)?;
        step.constrain(state, next, Some(acceleration));
        step.evaluate(1.0, next.nodes(), &next.memory.model, at_end);
        for ((velocity, &before), &after) in next.velocity.iter_mut().zip(acceleration).zip(&at_end.acceleration) {
            *velocity += (after - before) * (0.5 * time);
        }
        step.check(next)?;
        next.memory.integrator.clear();
        if !step.is_damped() {
            next.memory.integrator.extend_from_slice(bytemuck::cast_slice(&at_end.acceleration));
            next.memory.integrator.extend_from_slice(&at_end.memory);
        }
        Ok(())
    }

    fn copy(&self) -> Box<dyn Method> {
        Box::<Self>::default()
    }
}
