//! The second search of backward Euler: the potential `Φ` falls in each Newton step, so that none leads away from a solution.
//!
//! Damping forces are linear in velocities, `−B V'` with a symmetric `B` that depends on the places of nodes: with `B` as it is at the start of
//! a Newton step, `Φ + ΔT V'·B V'/2` has the residual as its negative gradient there, in units of the masses (M. Ortiz, L. Stainier, Computer
//! Methods in Applied Mechanics and Engineering 171, 419 (1999)). The fall is sufficient in the sense of L. Armijo (J. Nocedal, S. Wright,
//! Numerical Optimization (2006), chapter 3.1). Along directions without a least potential, on which conjugate gradients end, steps double for
//! as long as it falls.

use super::{BackwardEuler, MOST_LINEAR, MOST_NEWTON, Nodes, State, Step, dot};
use glam::DVec3;

/// The shortest share of a Newton step, and one over the longest.
const SHORTEST: f64 = 1e-8;
/// After this number of Newton steps in which the potential does not fall beyond round-off and the residual is not halved, the search ends.
const MOST_IDLE: usize = 10;
/// The least fall, as a share of what the slope of the potential promises.
const LEAST: f64 = 1e-4;

impl BackwardEuler {
    /// Goes along Newton steps as far as the potential falls enough; nowhere with a model that has no energy, or where the residual was less
    /// before. With damping each step has a potential of its own, so that only the residual tells whether it leads on.
    pub(super) fn descend(&mut self, step: &Step<'_>, state: &State, next: &mut State) {
        // Nor is there a potential of forces that change with positions.
        let changes = !step.system.surroundings.are_steady(step.interval);
        if changes || step.energy(&next.position, &state.memory.model).is_none() {
            return;
        }
        let (found, before) = (next.velocity.clone(), dot(step, &self.residual, &self.residual));
        let (mut least, mut idle, is_damped) = (self.start(step, state, next), 0, step.is_damped());
        for _ in 0..MOST_NEWTON {
            if self.is_solved(step, state, next) || idle == MOST_IDLE {
                break;
            }
            if is_damped {
                self.moved[1].fill(DVec3::ZERO);
                let at = Nodes { position: &next.position, velocity: &self.moved[1] };
                step.evaluate(1.0, at, &state.memory.model, &mut self.evaluations[2]);
            }
            self.solve(step, state, next, MOST_LINEAR[1], is_damped);
            self.from.clone_from(&next.velocity);
            let falls = self.fall(step, state, next);
            let size = dot(step, &self.residual, &self.residual);
            idle = if falls && !is_damped || size < 0.25 * least { 0 } else { idle + 1 };
            least = if idle == 0 { size } else { least };
        }
        let after = dot(step, &self.residual, &self.residual);
        if (after > before || after.is_nan()) && !self.is_solved(step, state, next) {
            next.velocity.copy_from_slice(&found);
            self.residual(step, state, next);
        }
    }

    /// Goes along the solution of the linear system until the potential has fallen enough. Returns whether it has, beyond round-off.
    fn fall(&mut self, step: &Step<'_>, state: &State, next: &mut State) -> bool {
        let (time, direction) = (step.interval.step, &self.linear[1]);
        let first = dot(step, &self.residual, direction);
        // The power of damping along the direction at the start, and for each unit of the way.
        let mut drag = [0.0; 2];
        if step.is_damped() {
            let [here, there, still] = &mut self.evaluations;
            let at = Nodes { position: &next.position, velocity: direction };
            step.evaluate(1.0, at, &state.memory.model, there);
            let power = |of: &[DVec3]| dot(step, direction, of);
            drag = [&here.acceleration, &there.acceleration].map(|of| power(of) - power(&still.acceleration));
        }
        let mut forces = vec![DVec3::ZERO; step.masses().len()];
        step.system.surroundings.push(step.interval.end, &next.position, &mut forces);
        let push = |node: usize| forces[node] / step.masses()[node];
        let free = |node: usize| state.velocity[node] + (step.system.surroundings.gravity + push(node)) * time;
        let gained: Vec<_> = self.from.iter().enumerate().map(|(node, &from)| from - free(node)).collect();
        let slope = dot(step, direction, &gained) - time * drag[0];
        let curvature = dot(step, direction, direction) - time * drag[1];
        let energy = |next: &State| step.energy(&next.position, &state.memory.model).unwrap_or(f64::NAN);
        let size = dot(step, &self.residual, &self.residual);
        let (before, mut share, mut best) = (energy(next), 1.0, None);
        while share > SHORTEST && share < 1.0 / SHORTEST {
            let (less, left) = self.go(step, state, next, share);
            if share == 1.0 && less < 0.25 * size && left.abs() < 0.5 * first {
                // Near the end the change of the potential is round-off, and the residual is more precise.
                return true;
            }
            let change = share * (slope + 0.5 * share * curvature) + (energy(next) - before);
            let falls = change <= -LEAST * share * first;
            match best {
                Some((_, least)) if !falls || change >= least => break,
                _ if falls && share >= 1.0 && left > 0.5 * first => {
                    best = Some((share, change));
                    share *= 2.0;
                }
                _ if falls => return true,
                // Where the potential would be least, if its slope changed linearly.
                _ if change.is_finite() => share *= (0.5 * share * first / (change + share * first)).clamp(0.1, 0.5),
                _ => share *= 0.1,
            }
        }
        self.go(step, state, next, best.map_or(0.0, |(share, _)| share));
        best.is_some()
    }
}
