//! Backward Euler: `V' = V + A(P', V') ΔT`, `P' = P + V' ΔT`: of first order and implicit. It is stable for any step and
//! damps what it cannot resolve.
//!
//! The equation for `V'` is solved by Newton's method, and each linear system by conjugate gradients with products of
//! matrix and vector from differences of forces: no matrix is stored, and any model will do. Where the matrix is not positive,
//! conjugate gradients end with the direction found so far.
//!
//! Without damping the residual is the negative gradient of `Φ = m|V' − V|²/2 + E(P')` with respect to `V'`, in units of the masses.
//! The first search along Newton steps is cheap: each ends where the residual does not turn against it. Where that comes to no solution, the
//! [second](descent) makes the potential fall in each step. What neither solves is [told](Unsolved).
//!
//! D. Baraff, A. Witkin, SIGGRAPH 98, 43 (1998), with one Newton step; J. Nocedal, S. Wright, Numerical Optimization (2006),
//! chapter 7.1: inexact Newton steps.
//!
//! Kinematic constraints hold nodes where they are at the end of the step. Contact acts at its end.

mod descent;

use super::{Evaluation, Method, Nodes, Runaway, Scales, State, Step, Unsolved};
use glam::DVec3;

/// The most Newton steps of a search. Most time steps need three or four, those of many periods T or with strong damping more.
const MOST_NEWTON: usize = 200;
/// The most iterations of conjugate gradients in a Newton step of either search.
const MOST_LINEAR: [usize; 2] = [100, 1000];
/// The final residual of a linear system, as a share of its first.
const LINEAR: f64 = 1e-3;
/// Newton's method ends where the residual (m/s) times the step is less than this share of the size of the body.
const RESIDUAL: f64 = 1e-10;
/// The greatest displacement in a difference of forces, as a share of the size of the body.
const DIFFERENCE: f64 = 1e-7;
/// How often a Newton step is shortened.
const MOST_CUTS: usize = 10;
/// After this number of whole Newton steps that do not halve the residual, the first search ends.
const MOST_IDLE: usize = 3;
/// The round-off of positions after all operations, relative to the largest coordinate.
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;

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
    /// The forces at the end of the step, those next to it, and those there without velocities.
    evaluations: [Evaluation; 3],
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
        let start = self.start(step, state, next);
        self.search(step, state, next, start);
        let mut is_solved = self.is_solved(step, state, next);
        if !is_solved {
            self.descend(step, state, next);
            is_solved = self.is_solved(step, state, next);
        }
        next.memory.model.copy_from_slice(&self.evaluations[0].memory);
        if is_solved {
            self.balance(step, next);
        }
        self.let_go(step, state, next);
        step.check(next)?;
        let known = Unsolved::remembered(&state.memory.integrator);
        let unsolved = if is_solved { known } else { Some(Unsolved::after(known, step.interval.end, self.largest())) };
        next.memory.integrator.clear();
        next.memory.integrator.extend(unsolved.iter().flat_map(Unsolved::numbers));
        step.constrain(state, next, None);
        Ok(())
    }

    fn unsolved(&self, state: &State) -> Option<Unsolved> {
        Unsolved::remembered(&state.memory.integrator)
    }

    fn copy(&self) -> Box<dyn Method> {
        Box::new(Self::new(self.scales))
    }
}

impl BackwardEuler {
    /// Evaluates the residual of a start, and returns its size. A body at rest is the better one for steps in which it would turn or deform
    /// far.
    fn start(&mut self, step: &Step<'_>, state: &State, next: &mut State) -> f64 {
        next.velocity.fill(DVec3::ZERO);
        let still = self.residual(step, state, next);
        next.velocity.copy_from_slice(&state.velocity);
        let size = self.residual(step, state, next);
        if still < size || size.is_nan() {
            next.velocity.fill(DVec3::ZERO);
            return self.residual(step, state, next);
        }
        size
    }

    /// The largest residual of a node (m/s).
    fn largest(&self) -> f64 {
        // NaN is larger than any number.
        let larger = |most: f64, size: f64| if size <= most || most.is_nan() { most } else { size };
        self.residual.iter().map(|residual| residual.length_squared()).fold(0.0, larger).sqrt()
    }

    /// Whether the residual is small.
    fn is_small(&self, step: &Step<'_>) -> bool {
        self.largest() * step.interval.step <= RESIDUAL * self.scales.length
    }

    /// Whether the residual is small, or not more than what a change of all positions in their last bits, with signs as by chance, makes of
    /// it.
    fn is_solved(&mut self, step: &Step<'_>, state: &State, next: &State) -> bool {
        if self.is_small(step) {
            return true;
        }
        let sign = |number: usize| f64::from((number as u32).wrapping_mul(0x9e37_79b9) >> 31) * 2.0 - 1.0;
        let signs = |node: usize| DVec3::new(sign(3 * node + 1), sign(3 * node + 2), sign(3 * node + 3));
        self.linear[2].clear();
        self.linear[2].extend((0..self.residual.len()).map(signs));
        self.product(step, state, next, false);
        let stiffest = self.linear[3].iter().fold(0.0, |most: f64, product| most.max(product.length()));
        let farthest = next.position.iter().fold(0.0, |far: f64, at| far.max(at.abs().max_element()));
        self.largest() * step.interval.step <= ROUND_OFF * farthest * stiffest
    }

    /// Goes along Newton steps whose residual does not turn against them, from velocities whose residual has a size.
    fn search(&mut self, step: &Step<'_>, state: &State, next: &mut State, mut size: f64) {
        let (mut least, mut idle) = (size, 0);
        for _ in 0..MOST_NEWTON {
            // The check of the speeds finds NaN.
            if self.is_small(step) || idle == MOST_IDLE || !size.is_finite() {
                break;
            }
            let is_whole = self.solve(step, state, next, MOST_LINEAR[0], false);
            self.from.clone_from(&next.velocity);
            let first = dot(step, &self.residual, &self.linear[1]);
            let mut share = 1.0;
            for cut in 0..=MOST_CUTS {
                let (now, slope) = self.go(step, state, next, share);
                size = now;
                if slope >= -0.5 * first || cut == MOST_CUTS {
                    break;
                }
                // Where the residual would be across the step, if it changed linearly.
                share *= if slope.is_finite() { (first / (first - slope)).clamp(0.1, 0.5) } else { 0.1 };
            }
            idle = if size < 0.25 * least || !is_whole { 0 } else { idle + 1 };
            least = least.min(size);
        }
    }

    /// Moves each body as a whole by the mean of its residual. Its internal forces stay as they are, so its momentum is then that of its forces to
    /// round-off, however small the residual is. Bodies with nodes that are held have no such momentum.
    fn balance(&self, step: &Step<'_>, next: &mut State) {
        for nodes in step.system.parts.iter().map(|part| part.nodes.clone()) {
            if self.is_held[nodes.clone()].contains(&true) {
                continue;
            }
            let (mass, residual) = (&step.system.mass[nodes.clone()], &self.residual[nodes.clone()]);
            let momentum: DVec3 = mass.iter().zip(residual).map(|(&mass, &residual)| residual * mass).sum();
            let mean = momentum / mass.iter().sum::<f64>();
            next.velocity[nodes.clone()].iter_mut().for_each(|velocity| *velocity += mean);
            next.position[nodes].iter_mut().for_each(|position| *position += mean * step.interval.step);
        }
    }

    /// Gives nodes that are held the velocities that they would have if nothing held them, by their forces and by what is left of the residual
    /// of their body: what holds them then changes the momentum of the body by what its forces do not.
    fn let_go(&self, step: &Step<'_>, state: &State, next: &mut State) {
        for nodes in step.system.parts.iter().map(|part| part.nodes.clone()) {
            let mass = |node: usize| step.system.mass[node];
            let held = || nodes.clone().filter(|&node| self.is_held[node]);
            let momentum: DVec3 = nodes.clone().map(|node| self.residual[node] * mass(node)).sum();
            let left = momentum / held().map(mass).sum::<f64>();
            for node in held() {
                let change = self.evaluations[0].acceleration[node] * step.interval.step;
                next.velocity[node] = state.velocity[node] + change + left;
            }
        }
    }

    /// Goes a share of the way along the solution of the linear system. Returns the size of the residual, and how far it still points
    /// along the way.
    fn go(&mut self, step: &Step<'_>, state: &State, next: &mut State, share: f64) -> (f64, f64) {
        let starts = self.from.iter().zip(&self.linear[1]);
        for (velocity, (&from, &change)) in next.velocity.iter_mut().zip(starts) {
            *velocity = from + change * share;
        }
        let size = self.residual(step, state, next);
        (size, dot(step, &self.residual, &self.linear[1]))
    }

    /// Evaluates the forces at the end of a step with the velocities in `next`, and the residual (m/s). Returns the sum of
    /// its squares, weighted with the masses.
    fn residual(&mut self, step: &Step<'_>, state: &State, next: &mut State) -> f64 {
        for ((position, &from), &velocity) in next.position.iter_mut().zip(&state.position).zip(&next.velocity) {
            *position = from + velocity * step.interval.step;
        }
        step.place_held(1.0, next);
        step.evaluate(1.0, next.nodes(), &state.memory.model, &mut self.evaluations[0]);
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
    fn solve(&mut self, step: &Step<'_>, state: &State, next: &State, most: usize, is_still: bool) -> bool {
        let [rest, solution, direction, _] = &mut self.linear;
        let nodes = self.residual.len();
        rest.clone_from(&self.residual);
        direction.clone_from(&self.residual);
        solution.clear();
        solution.resize(nodes, DVec3::ZERO);
        let first = dot(step, rest, rest);
        let mut size = first;
        for iteration in 0..most {
            self.product(step, state, next, is_still);
            let [rest, solution, direction, product] = &mut self.linear;
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

    /// Writes the matrix times the direction of search to `self.linear[3]`; for a body that `is_still`, at the same places without velocities,
    /// where the matrix is symmetric with damping, too.
    fn product(&mut self, step: &Step<'_>, state: &State, next: &State, is_still: bool) {
        let Self { scales, is_held, linear: [_, _, direction, product], moved: [position, velocity], .. } = self;
        let [here, there, still] = &mut self.evaluations;
        let (time, nodes) = (step.interval.step, direction.len());
        let largest = direction.iter().map(|vector| vector.length_squared()).fold(0.0, f64::max).sqrt();
        let small = DIFFERENCE * scales.length / (largest * time);
        position.clear();
        position.extend((0..nodes).map(|node| next.position[node] + direction[node] * (small * time)));
        velocity.clear();
        let before = |node: usize| if is_still { DVec3::ZERO } else { next.velocity[node] };
        velocity.extend((0..nodes).map(|node| before(node) + direction[node] * small));
        step.evaluate(1.0, Nodes { position, velocity }, &state.memory.model, there);
        let (here, there) = (if is_still { &still.acceleration } else { &here.acceleration }, &there.acceleration);
        product.clear();
        product.extend((0..nodes).map(|node| {
            let change = (there[node] - here[node]) * (time / small);
            if is_held[node] { DVec3::ZERO } else { direction[node] - change }
        }));
    }
}

/// The sum of `m a·b` over all nodes, in their order.
fn dot(step: &Step<'_>, one: &[DVec3], other: &[DVec3]) -> f64 {
    step.masses().iter().zip(one).zip(other).map(|((mass, one), &other)| mass * one.dot(other)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_residual_that_is_no_number_is_the_largest() {
        let mut method = BackwardEuler::new(Scales { length: 1.0, time: 1.0 });
        for place in 0..3 {
            method.residual = vec![DVec3::X; 3];
            method.residual[place].y = f64::NAN;
            assert!(method.largest().is_nan(), "{place}");
        }
    }
}
