//! Velocity Verlet: `P += V ΔT + A ΔT²/2`, then `V += (A + A')/2 ΔT` with the accelerations `A'` at the new place.
//!
//! Damping needs a velocity before the new one is known: `A'` is evaluated at `V + A ΔT`, which keeps the method of
//! second order. Without damping `A'` serves the next step as `A`. With damping the next step evaluates `A` at the
//! velocity that came out, which is what makes the method stable as far as `c ΔT < 2` for `dV/dt = −c V`; the
//! prediction would halve that.
//!
//! Collisions and hands act on the new place and the predicted velocity `V + A ΔT`, before `A'` is evaluated, so that no
//! force is ever evaluated inside an obstacle.
//!
//! W. Swope, H. Andersen, P. Berens, K. Wilson, J. Chem. Phys. 76, 637 (1982).

use super::{Acting, Runaway, Step};
use crate::sim::body::State;
use glam::DVec3;

/// What lasts from one step to the next.
pub(in crate::sim) struct Memory {
    /// The accelerations at the present state (m/s²), if they are known.
    acceleration: Vec<DVec3>,
    known: bool,
    next: State,
    next_acceleration: Vec<DVec3>,
}

impl Memory {
    pub(super) fn new(nodes: usize) -> Self {
        let zeros = || vec![DVec3::ZERO; nodes];
        Self { acceleration: zeros(), known: false, next: State::at_rest(zeros()), next_acceleration: zeros() }
    }
}

/// Takes a step.
pub(super) fn advance(
    step: &Step<'_>,
    state: &mut State,
    memory: &mut Memory,
    acting: &mut dyn Acting,
) -> Result<(), Runaway> {
    let Memory { acceleration, known, next, next_acceleration } = memory;
    let accelerate = |acting: &mut dyn Acting, state: &State, out: &mut [DVec3]| {
        acting.forces(state, out);
        out.iter_mut().zip(step.mass).for_each(|(force, &mass)| *force /= mass);
    };
    if !*known {
        accelerate(acting, state, acceleration);
    }
    acting.commit();
    // The way, and the velocity at its end if the acceleration stays.
    for (node, &acceleration) in acceleration.iter().enumerate() {
        let (from, old) = (state.position[node], state.velocity[node]);
        let predicted = old + acceleration * step.step;
        next.velocity[node] = predicted;
        next.position[node] = from + (old + predicted) * (0.5 * step.step);
    }
    step.check(&next.velocity)?;
    acting.constrain(next, Some(acceleration));
    accelerate(acting, next, next_acceleration);
    for ((velocity, &before), &after) in next.velocity.iter_mut().zip(&*acceleration).zip(&*next_acceleration) {
        *velocity += (after - before) * (0.5 * step.step);
    }
    acting.hold(next);
    step.check(&next.velocity)?;
    std::mem::swap(state, next);
    std::mem::swap(acceleration, next_acceleration);
    *known = !acting.is_damped();
    Ok(())
}
