//! Symmetric compositions of drifts, `P += a V ΔT`, and kicks, `V += b F/m ΔT`: symplectic methods of higher order for
//! forces that depend on positions alone.
//!
//! Kinematic constraints place their nodes after every drift. Contact acts at the end of the step: when a node
//! rebounds, every method is of first order.

use super::{Evaluation, Method, Runaway, State, Step};

/// The shares of the step of drifts and of kicks. Both sequences are palindromes, given by their first halves, and each adds up to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Composition {
    /// With an even number of kicks the middle drift is the last.
    pub drifts: &'static [f64],
    /// With an odd number of kicks the middle kick is the last.
    pub kicks: &'static [f64],
}

/// I. Omelyan, I. Mryglod, R. Folk, Computer Physics Communications 146, 188 (2002), Eq. (20): ξ, λ and χ.
pub(crate) const PEFRL: Composition =
    Composition { drifts: &[XI, CHI, 1.0 - 2.0 * (CHI + XI)], kicks: &[0.5 - LAMBDA, LAMBDA] };
const XI: f64 = 0.178_617_895_844_809_1;
const LAMBDA: f64 = -0.212_341_831_062_605_4;
const CHI: f64 = -0.066_264_582_669_818_5;

impl Composition {
    /// The number of kicks in each step. Each kick needs one evaluation of the forces.
    pub fn evaluations(&self) -> usize {
        self.drifts.len() + self.kicks.len() - 1
    }

    /// The share of the step of a drift; there is one more than kicks.
    pub(crate) fn drift(&self, at: usize) -> f64 {
        self.drifts[at.min(self.evaluations() - at)]
    }

    /// The share of the step of a kick.
    pub(crate) fn kick(&self, at: usize) -> f64 {
        self.kicks[at.min(self.evaluations() - 1 - at)]
    }

    /// The share of the step that has passed after a drift.
    pub(crate) fn share(&self, at: usize) -> f64 {
        if at == self.evaluations() { 1.0 } else { (0..=at).map(|at| self.drift(at)).sum() }
    }
}

/// A composition as a [`Method`].
#[derive(Debug)]
pub struct ByComposition {
    composition: Composition,
    evaluation: Evaluation,
}

impl ByComposition {
    /// The method.
    pub fn new(composition: Composition) -> Self {
        Self { composition, evaluation: Evaluation::default() }
    }
}

impl Method for ByComposition {
    fn step(&mut self, step: &Step<'_>, state: &State, next: &mut State) -> Result<(), Runaway> {
        let Self { composition, evaluation } = self;
        let time = step.interval.step;
        next.position.copy_from_slice(&state.position);
        next.velocity.copy_from_slice(&state.velocity);
        next.memory.model.copy_from_slice(&state.memory.model);
        for at in 0..=composition.evaluations() {
            let drift = composition.drift(at) * time;
            for (position, &velocity) in next.position.iter_mut().zip(&next.velocity) {
                *position += velocity * drift;
            }
            if at == composition.evaluations() {
                break;
            }
            step.system.feel_grips(step.interval, next);
            step.place_held(composition.share(at), next);
            step.evaluate(composition.share(at), next.nodes(), &next.memory.model, evaluation);
            next.memory.model.copy_from_slice(&evaluation.memory);
            let kick = composition.kick(at) * time;
            for (velocity, &acceleration) in next.velocity.iter_mut().zip(&evaluation.acceleration) {
                *velocity += acceleration * kick;
            }
        }
        step.finish(state, next)
    }

    fn copy(&self) -> Box<dyn Method> {
        Box::new(Self::new(self.composition))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Drifts and kicks add up to one step each.
    #[test]
    fn shares_add_up_to_the_step() {
        let count = PEFRL.evaluations();
        let drift: f64 = (0..=count).map(|at| PEFRL.drift(at)).sum();
        let kick: f64 = (0..count).map(|at| PEFRL.kick(at)).sum();
        assert!((drift - 1.0).abs() < 1e-14 && (kick - 1.0).abs() < 1e-14, "{drift} {kick}");
        assert_eq!((PEFRL.drifts.len(), PEFRL.kicks.len()), (count / 2 + 1, count.div_ceil(2)));
    }
}
