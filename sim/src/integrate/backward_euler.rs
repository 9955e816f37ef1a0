//! Backward Euler: `V' = V + A(P', V') ΔT`, `P' = P + V' ΔT`: of first order and implicit. It is stable for any step and
//! damps what it cannot resolve.
//!
//! The equation for `V'` is solved by Newton's method, and each linear system by conjugate gradients with products of
//! matrix and vector from differences of forces: no matrix is stored, and any model will do. The residual is the negative
//! gradient of `m|V' − V|²/2 + E(P')` with respect to `V'`, up to factors, and its minimum is sought: where that is not convex,
//! conjugate gradients end with the direction found so far, and a step along it ends where the residual turns against it.
//!
//! D. Baraff, A. Witkin, SIGGRAPH 98, 43 (1998), with one Newton step; J. Nocedal, S. Wright, Numerical Optimization (2006),
//! chapter 7.1: inexact Newton steps.
//!
//! Kinematic constraints hold nodes where they are at the end of the step. Contact acts at its end.

use super::{Evaluation, Method, Nodes, Runaway, Scales, State, Step};
use glam::DVec3;

/// The most Newton steps. Most time steps need three or four, those of many periods T or with strong damping more.
const MOST_NEWTON: usize = 200;
/// The most iterations of conjugate gradients in a Newton step.
const MOST_LINEAR: usize = 100;
/// The final residual of a linear system, as a share of its first.
const LINEAR: f64 = 1e-3;
/// Newton's method ends where the residual (m/s) times the step is less than this share of the size of the body.
const RESIDUAL: f64 = 1e-10;
/// The greatest displacement in a difference of forces, as a share of the size of the body.
const DIFFERENCE: f64 = 1e-7;
/// How often a Newton step is shortened.
const MOST_CUTS: usize = 10;
/// After this number of whole Newton steps that do not halve the residual, only round-off is left.
const MOST_IDLE: usize = 3;

/// Buffers, and the size of the body.
pub(super) struct BackwardEuler {
    scales: Scales,
    is_held: Vec<bool>,
    /// `V + A ΔT − V'` (m/s), where it is to become zero.
    residual: Vec<DVec3>,
    /// The residual of the linear system, its solution, the direction of search, and the matrix times it.
    linear: [Vec<DVec3>; 4],
    /// Velocities from which a Newton step starts (m/s).
    from: Vec<DVec3>,
    /// The forces at the end of the step, and those next to it.
    evaluations: [Evaluation; 2],
    /// Positions (m) and velocities (m/s) next to those at the end of the step.
    moved: [Vec<DVec3>; 2],
}

impl BackwardEuler {
    pub(super) fn new(scales: Scales) -> Self {
        let (is_held, residual, linear, from, evaluations, moved) = Default::default();
        Self { scales, is_held, residual, linear, from, evaluations, moved }
    }
}

impl Method for BackwardEuler {
    fn step(&mut self, step: &Step<'_>, state: &State, next: &mut State) -> Result<(), Runaway> {
        self.is_held.clear();
        self.is_held.resize(state.position.len(), false);
        step.for_each_held(next, |node| self.is_held[node] = true);
        // A body at rest is the better start for steps in which it would turn or deform far.
        next.velocity.fill(DVec3::ZERO);
        let still = self.residual(step, state, next);
        next.velocity.copy_from_slice(&state.velocity);
        let mut size = self.residual(step, state, next);
        if still < size || size.is_nan() {
            next.velocity.fill(DVec3::ZERO);
            size = self.residual(step, state, next);
        }
        let (mut least, mut idle) = (size, 0);
        for _ in 0..MOST_NEWTON {
            let largest = self.residual.iter().map(|residual| residual.length_squared()).fold(0.0, f64::max);
            let is_solved = largest.sqrt() * step.interval.step <= RESIDUAL * self.scales.length;
            // The check of the speeds finds NaN.
            if is_solved || idle == MOST_IDLE || !size.is_finite() {
                break;
            }
            let is_whole = self.solve(step, state, next);
            self.from.clone_from(&next.velocity);
            let first = dot(step, &self.residual, &self.linear[1]);
            let mut share = 1.0;
            for cut in 0..=MOST_CUTS {
                let starts = self.from.iter().zip(&self.linear[1]);
                for (velocity, (&from, &change)) in next.velocity.iter_mut().zip(starts) {
                    *velocity = from + change * share;
                }
                size = self.residual(step, state, next);
                let slope = dot(step, &self.residual, &self.linear[1]);
                if slope >= -0.5 * first || cut == MOST_CUTS {
                    break;
                }
                // Where the residual would be across the step, if it changed linearly.
                share *= if slope.is_finite() { (first / (first - slope)).clamp(0.1, 0.5) } else { 0.1 };
            }
            idle = if size < 0.25 * least || !is_whole { 0 } else { idle + 1 };
            least = least.min(size);
        }
        next.memory.model.copy_from_slice(&self.evaluations[0].memory);
        next.memory.integrator.clear();
        step.check(next)?;
        step.constrain(state, next, None);
        Ok(())
    }
}

impl BackwardEuler {
    /// Evaluates the forces at the end of a step with the velocities in `trial`, and the residual (m/s). Returns the sum of
    /// its squares, weighted with the masses.
    fn residual(&mut self, step: &Step<'_>, state: &State, next: &mut State) -> f64 {
        for ((position, &from), &velocity) in next.position.iter_mut().zip(&state.position).zip(&next.velocity) {
            *position = from + velocity * step.interval.step;
        }
        step.place_held(1.0, next);
        step.evaluate(next.nodes(), &state.memory.model, &mut self.evaluations[0]);
        let acceleration = &self.evaluations[0].acceleration;
        self.residual.clear();
        self.residual.extend((0..acceleration.len()).map(|node| {
            let residual = state.velocity[node] + acceleration[node] * step.interval.step - next.velocity[node];
            if self.is_held[node] { DVec3::ZERO } else { residual }
        }));
        dot(step, &self.residual, &self.residual)
    }

    /// Solves `(1 − ∂A/∂V' ΔT) x = residual` by conjugate gradients with the masses as weights, in which the matrix is
    /// symmetric. The solution is in `self.linear[1]`. Returns whether the iterations came to it before their end.
    fn solve(&mut self, step: &Step<'_>, state: &State, next: &State) -> bool {
        let Self { scales, is_held, residual, linear: [rest, solution, direction, product], .. } = self;
        let ([here, there], [position, velocity]) = (&mut self.evaluations, &mut self.moved);
        let time = step.interval.step;
        let nodes = residual.len();
        rest.clone_from(residual);
        direction.clone_from(residual);
        solution.clear();
        solution.resize(nodes, DVec3::ZERO);
        let first = dot(step, rest, rest);
        let mut size = first;
        for iteration in 0..MOST_LINEAR {
            let largest = direction.iter().map(|vector| vector.length_squared()).fold(0.0, f64::max).sqrt();
            let small = DIFFERENCE * scales.length / (largest * time);
            position.clear();
            position.extend((0..nodes).map(|node| next.position[node] + direction[node] * (small * time)));
            velocity.clear();
            velocity.extend((0..nodes).map(|node| next.velocity[node] + direction[node] * small));
            step.evaluate(Nodes { position, velocity }, &state.memory.model, there);
            let (here, there) = (&here.acceleration, &there.acceleration);
            product.clear();
            product.extend((0..nodes).map(|node| {
                let change = (there[node] - here[node]) * (time / small);
                if is_held[node] { DVec3::ZERO } else { direction[node] - change }
            }));
            let curvature = dot(step, direction, product);
            let is_convex = curvature > 0.0;
            if !is_convex {
                if iteration == 0 {
                    solution.clone_from(direction);
                }
                return true;
            }
            let length = size / curvature;
            for node in 0..nodes {
                solution[node] += direction[node] * length;
                rest[node] -= product[node] * length;
            }
            let last = std::mem::replace(&mut size, dot(step, rest, rest));
            if size <= LINEAR * LINEAR * first {
                return true;
            }
            for (direction, &rest) in direction.iter_mut().zip(&*rest) {
                *direction = rest + *direction * (size / last);
            }
        }
        false
    }
}

/// The sum of `m a·b` over all nodes, in their order.
fn dot(step: &Step<'_>, one: &[DVec3], other: &[DVec3]) -> f64 {
    step.masses().iter().zip(one).zip(other).map(|((mass, one), &other)| mass * one.dot(other)).sum()
}
