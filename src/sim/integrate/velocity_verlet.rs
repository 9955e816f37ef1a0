//! Velocity Verlet: `P += V ΔT + F/m ΔT²/2`, then `V += (F + F')/2m ΔT` with the forces `F'` at the new place.
//!
//! Damping needs a velocity before the new one is known: `F'` is evaluated at `V + F/m ΔT`, which keeps the method of
//! second order. `F'` serves the next step as `F`, unless nodes were moved by something else in between.
//!
//! W. Swope, H. Andersen, P. Berens, K. Wilson, J. Chem. Phys. 76, 637 (1982).

use super::{Evaluate, Runaway, Step};
use crate::sim::body::State;
use glam::DVec3;

/// What lasts from one step to the next.
pub(in crate::sim) struct Memory {
    /// The forces at the present state (N), if they are known.
    forces: Vec<DVec3>,
    known: bool,
    next: State,
    next_forces: Vec<DVec3>,
}

impl Memory {
    pub(super) fn new(nodes: usize) -> Self {
        let zeros = || vec![DVec3::ZERO; nodes];
        Self { forces: zeros(), known: false, next: State::at_rest(zeros()), next_forces: zeros() }
    }

    pub(super) fn forget(&mut self) {
        self.known = false;
    }
}

/// Takes a step.
pub(super) fn advance(
    step: &Step<'_>,
    state: &mut State,
    memory: &mut Memory,
    evaluate: &mut Evaluate<'_>,
) -> Result<(), Runaway> {
    let Memory { forces, known, next, next_forces } = memory;
    if !*known {
        evaluate(state, forces);
    }
    next.velocity.copy_from_slice(forces);
    step.velocities(state, &mut next.velocity)?;
    for (((to, &from), &old), &new) in
        next.position.iter_mut().zip(&state.position).zip(&state.velocity).zip(&next.velocity)
    {
        // V ΔT + F/m ΔT²/2 is the way at the mean of both velocities.
        *to = from + (old + new) * (0.5 * step.step);
    }
    evaluate(next, next_forces);
    for ((((velocity, &old), &force), &next_force), &mass) in
        next.velocity.iter_mut().zip(&state.velocity).zip(&*forces).zip(&*next_forces).zip(step.mass)
    {
        *velocity = old + (force + next_force) * (0.5 * step.step / mass);
    }
    // What the model remembers is that of the new place now, and so are the forces if the step is taken.
    *known = false;
    step.check(&next.velocity)?;
    std::mem::swap(state, next);
    std::mem::swap(forces, next_forces);
    *known = true;
    Ok(())
}
