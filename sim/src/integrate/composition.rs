//! Symmetric compositions of drifts, `P += a V ΔT`, and kicks, `V += b F/m ΔT`: symplectic methods of higher order for
//! forces that depend on positions alone.
//!
//! Kinematic constraints place their nodes after every drift. Contact acts at the end of the step: in a step in which a
//! node rebounds, every method is of first order.

use super::{Evaluation, Method, Runaway, State, Step};

/// The shares of the step of drifts and of kicks: two palindromes, of which the first halves are given. The shares of all drifts add
/// up to 1, and so do those of all kicks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Composition {
    /// With an even number of kicks the middle drift is the last.
    pub drifts: &'static [f64],
    /// With an odd number of kicks the middle kick is the last.
    pub kicks: &'static [f64],
}

/// E. Forest, R. Ruth, Physica D 43, 105 (1990), with `θ = 1/(2 − ∛2)`.
pub(crate) const FOREST_RUTH: Composition =
    Composition { drifts: &[0.5 * THETA, 0.5 - 0.5 * THETA], kicks: &[THETA, 1.0 - 2.0 * THETA] };
const THETA: f64 = 1.351_207_191_959_657_8;

/// I. Omelyan, I. Mryglod, R. Folk, Computer Physics Communications 146, 188 (2002), Eq. (20): ξ, λ and χ.
pub(crate) const PEFRL: Composition =
    Composition { drifts: &[XI, CHI, 1.0 - 2.0 * (CHI + XI)], kicks: &[0.5 - LAMBDA, LAMBDA] };
const XI: f64 = 0.178_617_895_844_809_1;
const LAMBDA: f64 = -0.212_341_831_062_605_4;
const CHI: f64 = -0.066_264_582_669_818_5;

/// S. Blanes, P. Moan, Journal of Computational and Applied Mathematics 142, 313 (2002), table 3: SRKN14a, of order 6.
pub(crate) const BLANES_MOAN: Composition = Composition {
    drifts: &[
        0.037_859_319_840_611_6,
        0.102_635_633_102_435,
        -0.025_867_888_266_558_7,
        0.314_241_403_071_447,
        -0.130_144_459_517_415,
        0.106_417_700_369_543,
        -0.008_794_243_128_510_58,
        // The sum of all shares is 1.
        0.207_305_069_056_895_36,
    ],
    kicks: &[
        0.091_719_152_624_461_65,
        0.183_983_170_005_006,
        -0.056_534_365_832_888_27,
        0.004_914_688_774_712_854,
        0.143_761_127_168_358,
        0.328_567_693_746_804,
        -0.196_411_466_486_454_23,
    ],
};

/// W. Kahan, R.-C. Li, Mathematics of Computation 66, 1089 (1997), table 1: s17odr8a, of order 8, as a composition of steps
/// of drift, kick and drift. It starts the method of [`quinlan_tremaine`](super::quinlan_tremaine).
pub(crate) const KAHAN_LI: Composition = Composition {
    drifts: &[
        0.5 * GAMMA[0],
        0.5 * (GAMMA[0] + GAMMA[1]),
        0.5 * (GAMMA[1] + GAMMA[2]),
        0.5 * (GAMMA[2] + GAMMA[3]),
        0.5 * (GAMMA[3] + GAMMA[4]),
        0.5 * (GAMMA[4] + GAMMA[5]),
        0.5 * (GAMMA[5] + GAMMA[6]),
        0.5 * (GAMMA[6] + GAMMA[7]),
        0.5 * (GAMMA[7] + GAMMA[8]),
    ],
    kicks: &GAMMA,
};
const GAMMA: [f64; 9] = [
    0.130_202_483_088_890_08,
    0.561_162_981_775_108_4,
    -0.389_474_962_644_847_3,
    0.158_841_906_555_155_6,
    -0.395_903_894_133_237_6,
    0.184_539_640_978_315_7,
    0.258_374_387_686_322_04,
    0.295_011_723_609_310_3,
    -0.605_508_533_830_034_5,
];

impl Composition {
    /// The number of kicks in each step, which is that of evaluations of the forces.
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

    /// Computes a step without its end: without limit, contact and kinematic constraints.
    pub fn fly(&mut self, step: &Step<'_>, state: &State, next: &mut State) {
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
            step.place_held(composition.share(at), next);
            step.evaluate(next.nodes(), &next.memory.model, evaluation);
            next.memory.model.copy_from_slice(&evaluation.memory);
            let kick = composition.kick(at) * time;
            for (velocity, &acceleration) in next.velocity.iter_mut().zip(&evaluation.acceleration) {
                *velocity += acceleration * kick;
            }
        }
    }
}

impl Method for ByComposition {
    fn step(&mut self, step: &Step<'_>, state: &State, next: &mut State) -> Result<(), Runaway> {
        self.fly(step, state, next);
        step.finish(state, next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Drifts and kicks add up to one step each.
    #[test]
    fn shares_add_up_to_the_step() {
        for method in [FOREST_RUTH, PEFRL, BLANES_MOAN, KAHAN_LI] {
            let count = method.evaluations();
            let drift: f64 = (0..=count).map(|at| method.drift(at)).sum();
            let kick: f64 = (0..count).map(|at| method.kick(at)).sum();
            assert!((drift - 1.0).abs() < 1e-14 && (kick - 1.0).abs() < 1e-14, "{drift} {kick}");
            assert_eq!((method.drifts.len(), method.kicks.len()), (count / 2 + 1, count.div_ceil(2)));
        }
    }
}
