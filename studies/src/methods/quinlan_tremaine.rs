//! The symmetric multistep method of eighth order for `d²P/dt² = F(P)/m`, with one evaluation a step:
//! `Σ α_j P(n + j) = ΔT² Σ β_j A(n + j)`, `j` from 0 to 8, with accelerations `A`.
//!
//! G. Quinlan, S. Tremaine, Astronomical Journal 100, 1694 (1990), table 1, where α and β are the same from both ends.
//!
//! The sum over positions is divided by `1 − (shift by a step)`: the mean velocities of steps, `W = ΔP/ΔT`, are stored
//! instead of positions, and round-off grows much more slowly. Velocities do not enter the method; each is computed from the
//! last `W` and the accelerations, with an error of eighth order that does not accumulate.
//!
//! The first seven steps are taken by a composition of eighth order. Where a node meets an obstacle, or a kinematic
//! constraint begins or ends to hold nodes, the method starts anew.
//!
//! Its memory is one vector for each node of `A` at the start of the first step known, `W` of that step, `A` at its end, `W`
//! of the next step, and so on up to the present `A`: the last seven of each, once there are so many.

use super::KAHAN_LI;
use glam::DVec3;
use localshape::sim::State;
use localshape::sim::integrate::{ByComposition, Evaluation, Method, Runaway, Step};

/// The weights α divided by `1 − (shift by a step)`: of `W` of the last seven steps, oldest first.
const OLD: [f64; 7] = [1.0, -1.0, 1.0, 0.0, 0.0, -1.0, 1.0];
/// The weights β of `A`, oldest first.
const FORCE: [f64; 7] = [
    17671.0 / 12096.0,
    -23622.0 / 12096.0,
    61449.0 / 12096.0,
    -50516.0 / 12096.0,
    61449.0 / 12096.0,
    -23622.0 / 12096.0,
    17671.0 / 12096.0,
];
/// The velocity at the end of a step is `W` of that step plus the sum of `A ΔT` with these weights, oldest first: exact for
/// polynomials of degree 8.
const VELOCITY: [f64; 7] = [
    28549.0 / 120_960.0,
    -200_838.0 / 120_960.0,
    606_783.0 / 120_960.0,
    -1_022_324.0 / 120_960.0,
    1_041_699.0 / 120_960.0,
    -650_982.0 / 120_960.0,
    257_593.0 / 120_960.0,
];
/// The weight of the seventh difference of `A`, with that at the end of the step: exact for degree 9.
const CORRECTION: f64 = 416_173.0 / 1_814_400.0;
/// The weights of a seventh difference, oldest first, without that of the last value, which is 1.
const DIFFERENCE: [f64; 7] = [-1.0, 7.0, -21.0, 35.0, -35.0, 21.0, -7.0];

/// The method with its buffers.
pub(crate) struct QuinlanTremaine {
    /// Takes the first steps.
    first: ByComposition,
    evaluation: Evaluation,
    /// Positions, then velocities, before contact.
    before_contact: Vec<DVec3>,
}

impl QuinlanTremaine {
    pub(crate) fn new() -> Self {
        Self { first: ByComposition::new(KAHAN_LI), evaluation: Evaluation::default(), before_contact: Vec::new() }
    }
}

impl Method for QuinlanTremaine {
    fn step(&mut self, step: &Step<'_>, state: &State, next: &mut State) -> Result<(), Runaway> {
        let Self { first: composition, evaluation, before_contact } = self;
        let (nodes, time) = (state.position.len(), step.interval().step);
        let known: &[DVec3] = if goes_on(step, state) { bytemuck::cast_slice(&state.memory.integrator) } else { &[] };
        let is_full = known.len() == FULL * nodes;
        let mut first = Vec::new();
        if is_full {
            predict(known, time, state, next);
        } else {
            if known.is_empty() {
                step.evaluate(state.nodes(), &state.memory.model, evaluation);
                first.extend_from_slice(&evaluation.acceleration);
            }
            composition.fly(step, state, next);
        }
        // Placed before, a held node counts only if an obstacle moves it, too.
        step.place_held(1.0, next);
        before_contact.clear();
        before_contact.extend(next.position.iter().chain(&next.velocity));
        step.finish(state, next)?;
        if !next.position.iter().chain(&next.velocity).eq(&*before_contact) {
            return Ok(());
        }
        step.evaluate(next.nodes(), &next.memory.model, evaluation);
        let Evaluation { acceleration, memory, .. } = evaluation;
        next.memory.model.copy_from_slice(memory);
        if is_full {
            for (node, velocity) in next.velocity.iter_mut().enumerate() {
                let before =
                    (0..7).fold(DVec3::ZERO, |sum, at| sum + known[(2 * at + 1) * nodes + node] * DIFFERENCE[at]);
                *velocity += (before + acceleration[node]) * (CORRECTION * time);
            }
            step.hold(next);
            step.check(next)?;
        }
        let memory = &mut next.memory.integrator;
        let mut push = |vector: DVec3| memory.extend_from_slice(&vector.to_array());
        let dropped = if known.len() < (FULL - 1) * nodes { 0 } else { known.len() - (FULL - 2) * nodes };
        known[dropped..].iter().chain(&first).copied().for_each(&mut push);
        next.position.iter().zip(&state.position).for_each(|(&to, &from)| push((to - from) / time));
        acceleration.iter().copied().for_each(&mut push);
        Ok(())
    }
}

/// How many vectors the full memory has for each node.
const FULL: usize = 14;

/// Whether the memory is one of this method, and this step continues the motion of those before.
fn goes_on(step: &Step<'_>, state: &State) -> bool {
    let (length, width) = (state.memory.integrator.len(), 3 * state.position.len());
    let count = length / width.max(1);
    let is_own = count * width == length && (count == FULL || count < FULL && count % 2 == 1);
    is_own && !step.changes_holds()
}

/// Positions at the end of a step, and velocities without the acceleration there.
fn predict(known: &[DVec3], step: f64, state: &State, next: &mut State) {
    let nodes = state.position.len();
    next.memory.model.copy_from_slice(&state.memory.model);
    for node in 0..nodes {
        let (mut way, mut force, mut change) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
        for at in 0..7 {
            way += known[2 * at * nodes + node] * OLD[at];
            let acceleration = known[(2 * at + 1) * nodes + node];
            force += acceleration * FORCE[at];
            change += acceleration * VELOCITY[at];
        }
        let mean = way + force * step;
        next.position[node] = state.position[node] + mean * step;
        next.velocity[node] = mean + change * step;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Exact for polynomials: positions up to degree 9, velocities up to 8 and, corrected, 9.
    #[test]
    fn the_weights_are_of_eighth_order() {
        // Around the middle of the eight points before the new one, which keeps the numbers small.
        let at = |point: usize| point as f64 - 3.5;
        for degree in 0..=10 {
            let power = |point: usize, exponent: i32| if exponent < 0 { 0.0 } else { at(point).powi(exponent) };
            let position = |point: usize| power(point, degree);
            let speed = f64::from(degree) * power(8, degree - 1);
            let force = |point: usize| f64::from(degree * (degree - 1)) * power(point, degree - 2);
            let sum = |weights: [f64; 7]| (0..7).map(|point| weights[point] * force(point + 1)).sum::<f64>();
            let way: f64 = (0..7).map(|point| OLD[point] * (position(point + 1) - position(point))).sum();
            let size = 1.0 + position(8).abs() * 100.0;
            let off = [
                (way + sum(FORCE) - (position(8) - position(7))) / size,
                (position(8) - position(7) + sum(VELOCITY) - speed) / size,
                (position(8) - position(7) + sum(VELOCITY) + CORRECTION * (sum(DIFFERENCE) + force(8)) - speed) / size,
            ];
            let exact = [9, 8, 9].map(|last| degree <= last);
            for (off, exact) in off.into_iter().zip(exact) {
                assert_eq!(off.abs() < 1e-13, exact, "degree {degree}: {off:e}");
            }
        }
        let is_symmetric = |weights: [f64; 7], sign: f64| (0..7).all(|at| weights[at] == sign * weights[6 - at]);
        assert!(is_symmetric(FORCE, 1.0));
        // 1 for the new step, and the weights of the others with their sign changed: the same from both ends.
        let steps: Vec<f64> = OLD.iter().map(|weight| -weight).chain([1.0]).collect();
        assert!((0..8).all(|at| steps[at] == -steps[7 - at]), "{steps:?}");
    }
}
