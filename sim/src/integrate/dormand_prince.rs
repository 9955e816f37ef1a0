//! The Runge–Kutta pair of Dormand and Prince for `dP/dt = V`, `dV/dt = F(P, V)/m`: of fifth order, with an error estimated
//! by a method of fourth order from the same seven evaluations. The last one is the first of the next substep.
//!
//! J. Dormand, P. Prince, Journal of Computational and Applied Mathematics 6, 19 (1980), table 2: RK5(4)7M.
//!
//! Each step is divided into substeps with errors within the tolerance; the last substep ends with the step. Contact and
//! kinematic constraints act at the end of each substep. A substep in which a node goes deep into an obstacle is repeated, shorter,
//! so that it ends when the node is there: rebounds are as exact as the motion between them.
//!
//! Its memory is the length of the next substep (s) and, unless a node has just met an obstacle, the present accelerations.

use super::{Evaluation, Interval, Method, Runaway, Scales, State, Step, swap};
use glam::DVec3;

/// The weights of the stages before each stage. The weights of the last stage give the solution.
const STAGES: [[f64; 6]; 7] = [
    [0.0; 6],
    [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
/// The share of the substep at which each stage is evaluated.
const SHARES: [f64; 7] = [0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0];
/// The weights of the estimated error: the solution minus that of fourth order.
const ERROR: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339_200.0, 22.0 / 525.0, -1.0 / 40.0];

/// A substep is made at most so many times as long as the last one.
const GROWTH: f64 = 5.0;
/// How often a substep is shortened to find a rebound.
const MOST_SEARCHES: usize = 8;

/// Buffers, and the scales of errors.
pub(super) struct DormandPrince {
    scales: Scales,
    /// The error allowed in a substep, as a share of the size of the body.
    tolerance: f64,
    /// The state at the beginning of a substep.
    now: State,
    evaluation: Evaluation,
    /// Velocities, then accelerations, of each stage.
    slopes: Vec<DVec3>,
    /// The mean acceleration of each node that is held, by its forces.
    held: Vec<DVec3>,
    /// Positions, then velocities, before contact.
    before_contact: Vec<DVec3>,
}

impl Method for DormandPrince {
    fn step(&mut self, step: &Step<'_>, state: &State, next: &mut State) -> Result<(), Runaway> {
        let mut now = std::mem::take(&mut self.now);
        now.clone_from(state);
        let mut time = step.interval.begin;
        let result = loop {
            match self.substep(step, time, &now, next) {
                Ok(end) if end == step.interval.end => break Ok(()),
                Ok(end) => time = end,
                Err(runaway) => break Err(runaway),
            }
            swap(&mut now, next);
        };
        self.now = now;
        result
    }

    fn copy(&self) -> Box<dyn Method> {
        Box::new(Self::new(self.scales, self.tolerance))
    }
}

impl DormandPrince {
    pub(super) fn new(scales: Scales, tolerance: f64) -> Self {
        let (now, evaluation, slopes, held, before_contact) = Default::default();
        Self { scales, tolerance, now, evaluation, slopes, held, before_contact }
    }

    /// Computes a substep from a time (s), and returns its end (s).
    fn substep(&mut self, whole: &Step<'_>, time: f64, state: &State, next: &mut State) -> Result<f64, Runaway> {
        let interval = whole.interval;
        let left = interval.end - time;
        let (wish, known) = self.remembered(whole, state);
        let mut step = if wish < 0.5 * left { wish } else { left.min(if wish < left { 0.5 * left } else { left }) };
        let (mut growth, mut searches) = (GROWTH, 0);
        loop {
            let end = if step == left { interval.end } else { time + step };
            let part = Step { interval: Interval { begin: time, end, step }, ..*whole };
            part.begin(state, next);
            let (error, node) = self.evaluate(&part, state, known, next);
            // The error is of fifth order in the substep. A margin keeps most substeps from being repeated.
            let factor = 0.9 * libm::pow(error, -0.2);
            if error > 1.0 {
                step *= factor.clamp(0.2, 0.9);
                growth = 1.0;
                if time + step == time {
                    return Err(Runaway { node });
                }
                continue;
            }
            let impulses = part.system.impulses.as_ref().map(|impulses| (impulses, impulses.waiting()));
            // As if nothing held them.
            for (_, node, ..) in part.system.held(part.interval, &next.memory.constraints) {
                next.velocity[node] = state.velocity[node] + self.held[node] * step;
            }
            let has_met = part.finish_and_tell(state, next, &mut self.before_contact)?;
            if has_met
                && searches < MOST_SEARCHES
                && let Some(shorter) = self.until_contact(step, next)
            {
                if let Some((impulses, waiting)) = impulses {
                    impulses.forget(waiting);
                }
                step = shorter;
                searches += 1;
                continue;
            }
            let mut next_wish = step * factor.clamp(0.2, growth);
            // A substep that ends early because the step does says nothing against longer ones.
            if step < wish && growth == GROWTH && searches == 0 {
                next_wish = next_wish.max(wish);
            }
            let memory = &mut next.memory.integrator;
            memory.push(next_wish);
            if !has_met {
                memory.extend(self.slopes[13 * state.position.len()..].iter().flat_map(|vector| vector.to_array()));
            }
            return Ok(end);
        }
    }

    /// The length of the next substep (s), and the present accelerations, if they are known.
    fn remembered<'a>(&self, step: &Step<'_>, state: &'a State) -> (f64, Option<&'a [DVec3]>) {
        let accelerations = 3 * state.position.len();
        match state.memory.integrator.split_first() {
            Some((&wish, [])) => (wish, None),
            // Accelerations of held nodes are not kept.
            Some((&wish, known)) if known.len() == accelerations => {
                (wish, step.system.surroundings.grips.is_empty().then(|| bytemuck::cast_slice(known)))
            }
            // Anything else is the memory of another method.
            _ => (0.1 * self.scales.time, None),
        }
    }

    /// Writes the positions and velocities at the end of a substep, without contact. Returns the estimated error, 1 for the
    /// greatest allowed, and the node that has it.
    fn evaluate(&mut self, part: &Step<'_>, state: &State, known: Option<&[DVec3]>, next: &mut State) -> (f64, usize) {
        let (nodes, step) = (state.position.len(), part.interval.step);
        next.memory.model.copy_from_slice(&state.memory.model);
        self.slopes.resize(14 * nodes, DVec3::ZERO);
        self.held.clear();
        self.held.resize(nodes, DVec3::ZERO);
        for stage in 0..7 {
            let (before, slopes) = self.slopes.split_at_mut(2 * stage * nodes);
            let sum = |first: usize| {
                let weights = STAGES[stage][..stage.min(6)].iter().enumerate();
                weights.fold(DVec3::ZERO, |sum, (at, &weight)| sum + before[2 * at * nodes + first] * weight)
            };
            for node in 0..nodes {
                next.position[node] = state.position[node] + sum(node) * step;
                next.velocity[node] = state.velocity[node] + sum(nodes + node) * step;
            }
            part.place_held(SHARES[stage], next);
            let (velocities, accelerations) = slopes[..2 * nodes].split_at_mut(nodes);
            velocities.copy_from_slice(&next.velocity);
            match known.filter(|_| stage == 0) {
                Some(known) => accelerations.copy_from_slice(known),
                None => {
                    part.evaluate(SHARES[stage], next.nodes(), &next.memory.model, &mut self.evaluation);
                    accelerations.copy_from_slice(&self.evaluation.acceleration);
                    next.memory.model.copy_from_slice(&self.evaluation.memory);
                }
            }
            let weight = STAGES[6].get(stage).copied().unwrap_or_default();
            part.for_each_held(next, |node| {
                self.held[node] += std::mem::take(&mut accelerations[node]) * weight;
            });
        }
        let unit = self.tolerance * self.scales.length;
        let mut worst = (0.0, 0);
        for node in 0..nodes {
            let sum =
                |first: usize| {
                    ERROR.iter().enumerate().fold(DVec3::ZERO, |sum, (at, &weight)| {
                        sum + self.slopes[2 * at * nodes + first + node] * weight
                    }) * step
                };
            let error = sum(0).length().max(sum(nodes).length() * self.scales.time) / unit;
            if error.is_nan() {
                return (f64::INFINITY, node);
            }
            if error > worst.0 {
                worst = (error, node);
            }
        }
        worst
    }

    /// A shorter substep (s), at the end of which the node that was first to meet an obstacle is about half the tolerance
    /// inside; `None` if no node is deeper than the tolerance.
    fn until_contact(&self, step: f64, next: &State) -> Option<f64> {
        let (positions, velocities) = self.before_contact.split_at(next.position.len());
        let unit = self.tolerance * self.scales.length;
        let mut longest: f64 = 0.0;
        for node in 0..next.position.len() {
            // Both changed by the same factor: the depth, and the speed with which the node became so deep.
            let moved = next.position[node].distance(positions[node]);
            let changed = next.velocity[node].distance(velocities[node]);
            if moved > unit && changed > 0.0 {
                longest = longest.max((moved - 0.5 * unit) / changed);
            }
        }
        (longest > 0.0).then_some(if longest < 0.999 * step { step - longest } else { 0.5 * step })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The weights of each stage add up to its share of the step, those of the solution integrate polynomials of degree 4,
    /// and those of the error polynomials of degree 3 to zero.
    #[test]
    fn the_weights_are_of_their_orders() {
        for (weights, share) in STAGES.iter().zip(SHARES) {
            assert!((weights.iter().sum::<f64>() - share).abs() < 1e-14);
        }
        for power in 0..5 {
            let sum = |weights: &[f64]| weights.iter().zip(SHARES).map(|(w, share)| w * share.powi(power)).sum::<f64>();
            assert!((sum(&STAGES[6]) - 1.0 / f64::from(power + 1)).abs() < 1e-14);
            assert_eq!(sum(&ERROR).abs() < 1e-14, power < 4, "{power}");
        }
    }
}
