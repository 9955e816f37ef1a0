//! Springs of limited amplitude, by which the authors' earlier model (Ref. 4 of the paper: Miyazaki and others 1998) keeps masses from
//! disorder: "the amplitude has constraints to less than the natural length of the spring".
//!
//! **The formula is our own reading**, because the paper prints none: that of finitely extensible springs (FENE: Warner 1972, *Ind. Eng. Chem.
//! Fundam.* 11, 379; Kremer and Grest 1990, *J. Chem. Phys.* 92, 5057), about the natural length, as in the bonds of ESPResSo. With `x` the
//! elongation and `L` a share of the natural length, the [`limit`](LimitedSprings::limit), the tension is `k x / (1 − (x/L)²)` and the
//! energy `−½ k L² ln(1 − (x/L)²)`: the springs of Eq. (1) for small `x`, and a wall at `±L`.
//!
//! A step may carry a node through the wall. From `|x| = 0.999 L` on the denominator therefore stays as it is, as in a linear
//! spring of `k / (1 − 0.999²) ≈ 500 k`. The tension has no jump there, stays finite, and is the derivative of an energy everywhere; `|x| < L` holds
//! for all energies that a step can follow. Springs without a natural length have no limit. Damping is that of Eq. (1).

#[cfg(feature = "scene")]
use super::mass_spring;
use super::mass_spring::{MassSpring, length, natural_length};
use super::{ByLaw, Corners, ElasticModel, Element, ForceModel, Lanes, Law, Properties, Setting, Vectorised};
use crate::body::Body;
use crate::kernel::shapes::square;
use crate::lanes::each;
use crate::lists::IndexLists;
#[cfg(feature = "scene")]
use std::collections::BTreeMap;
use std::sync::Arc;

#[cfg(feature = "scene")]
mass_spring::parameters! {
    /// The greatest elongation, and shortening, of each spring as a share of its natural length.
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 1.0))]
    limit: f64,
}

/// The model with its parameters in SI units, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitedSprings {
    /// The springs for small elongations.
    pub springs: MassSpring,
    /// The greatest elongation as a share of the natural length, above 0 and at most 1.
    pub limit: f64,
}

#[cfg(feature = "scene")]
impl Parameters {
    /// A model with this elastic constant (N/m) and limit; the other parameters have their defaults.
    pub fn new(stiffness: f64, limit: f64) -> Self {
        Self { stiffness, limit, damping: None, damping_ratio: None, springs: None }
    }
}

#[cfg(feature = "scene")]
impl super::TypedModel for Parameters {
    fn resolve(&self, body: &Body, listed: Option<&[[u32; 2]]>) -> Result<Arc<dyn ElasticModel>, super::Misfit> {
        // The schema has the same bounds; scenes made in code pass them by.
        if !(self.limit > 0.0 && self.limit <= 1.0) {
            let message =
                format!("`limit` is {}; expected a share of the natural length above 0 and at most 1", self.limit);
            return Err(super::Misfit { key: "limit", message });
        }
        Ok(Arc::new(LimitedSprings { springs: self.of_springs().model(body, listed)?, limit: self.limit }))
    }

    fn most_springs(&self, elements: &BTreeMap<usize, u128>, listed: Option<u128>) -> u128 {
        self.of_springs().most(elements, listed)
    }
}

impl ElasticModel for LimitedSprings {
    fn properties(&self, _: &Body) -> Properties {
        self.springs.of_springs("limited-springs").with("limit", Setting::Number(self.limit, ""))
    }

    fn springs(&self) -> &[[u32; 2]] {
        &self.springs.springs
    }

    fn vectorised(&self) -> Option<&dyn Vectorised> {
        Some(self)
    }

    fn prepare(&self, body: &Arc<Body>) -> Box<dyn ForceModel> {
        Box::new(ByLaw::new(self.clone(), body))
    }
}

/// The part of the limit from which on springs are linear.
const HELD: f64 = 0.999;
/// `1 − (x/L)²` there.
const LEAST: f64 = 1.0 - HELD * HELD;

impl Law for LimitedSprings {
    /// The natural length (m), and `1/L` (1/m), which is 0 without a limit.
    const OF_ELEMENT: usize = 2;
    /// The force on the first node.
    type Whole<L: Lanes> = [L; 3];

    fn elements(&self, _: &Body) -> Option<IndexLists> {
        Some(self.springs.springs.iter().map(|ends| &ends[..]).collect())
    }

    fn is_damped(&self) -> bool {
        self.springs.damping > 0.0
    }

    #[inline(always)]
    fn prepare<L: Lanes>(&self, rest: &Corners<'_, L>, of_element: &mut [L], _: &mut [L]) {
        let (zero, one, natural) = (L::splat(0.0), L::splat(1.0), natural_length(rest));
        of_element[0] = natural;
        of_element[1] = (one / (L::splat(self.limit) * natural)).select(zero.lt(natural), zero);
    }

    #[inline(always)]
    fn whole<L: Lanes>(&self, spring: &Element<'_, L>) -> [L; 3] {
        let &MassSpring { stiffness, damping, .. } = &self.springs;
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let ((near, slow), (far, fast)) = (spring.corner(0), spring.corner(1));
        let p = each!(3, axis => far[axis] - near[axis]);
        let [vx, vy, vz] = each!(3, axis => fast[axis] - slow[axis]);
        let squared = square(p);
        let inverse = one / squared.sqrt();
        let stretch = squared.mul_sub(inverse, spring.of_element(0));
        let share = stretch * spring.of_element(1);
        let left = share.neg_mul_add(share, one).max(L::splat(LEAST));
        let stretching = vz.mul_add(p[2], vy.mul_add(p[1], vx * p[0])) * inverse;
        let tension = stretching.mul_add(L::splat(damping), L::splat(stiffness) * stretch / left);
        // A spring between coincident nodes has no direction.
        let pull = (tension * inverse).select(zero.lt(squared), zero);
        each!(3, axis => pull * p[axis])
    }

    #[inline(always)]
    fn force<L: Lanes>(&self, _: &Element<'_, L>, corner: usize, &force: &[L; 3]) -> [L; 3] {
        if corner == 0 { force } else { each!(3, axis => -force[axis]) }
    }

    #[inline(always)]
    fn energy<L: Lanes>(&self, spring: &Element<'_, L>, _: &Corners<'_, L>, shares: &mut [L]) -> L {
        let (zero, one, least) = (L::splat(0.0), L::splat(1.0), L::splat(LEAST));
        let (natural, inverse) = (spring.of_element(0), spring.of_element(1));
        let (is_limited, stretch) = (zero.lt(inverse), length(spring) - natural);
        let squared = (stretch * inverse) * (stretch * inverse);
        let beyond = (squared - (one - least)).max(zero);
        // Near 0 the logarithm of 1 − s is precise, that of a rounded difference is not.
        let share = (squared - beyond).to_array();
        let logarithm = L::from_array(each!(8, lane => libm::log1p(-share[lane])));
        let of_limit = (beyond / least - logarithm) / (inverse * inverse);
        let energy = L::splat(0.5 * self.springs.stiffness) * of_limit.select(is_limited, stretch * stretch);
        shares.fill(L::splat(0.5) * energy);
        zero
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crew::Crew;

    use crate::model::Scratch;
    use crate::state::State;
    use glam::DVec3;

    /// The tension (N) and the energy (J) of a spring of a length, with `k` = 7 N/m, that is 2 m long at rest.
    fn spring(limit: f64, length: f64) -> [f64; 2] {
        let rest = vec![DVec3::ZERO, 2.0 * DVec3::X];
        let elements = [&[0, 1][..]].into_iter().collect();
        let body = Arc::new(Body::builder(rest).elements(elements).build().expect("a body"));
        let springs = MassSpring { stiffness: 7.0, damping: 0.0, springs: [[0, 1]].into(), breaks_at: None };
        let state = State::at_rest(vec![DVec3::ONE, DVec3::ONE + length * DVec3::Y]);
        let (law, mut forces) = (ByLaw::new(LimitedSprings { springs, limit }, &body), vec![DVec3::ZERO; 2]);
        law.add_forces(state.nodes(), &[], &mut [], &mut Scratch::default(), &mut forces);
        let energy = crate::law::Energy::report(&law, &state.position, &[], None, &Crew::new(1)).energy;
        [forces[0].y, energy.expect("an energy")]
    }

    #[test]
    fn the_tension_is_linear_at_first_and_a_wall_at_the_limit() {
        for limit in [0.25, 1.0] {
            let whole = 2.0 * limit;
            for x in [0.5_f64, -0.5, 0.9, -0.99, 1e-9].map(|share| share * whole) {
                let share: f64 = x / whole;
                let [tension, energy] = spring(limit, 2.0 + x);
                let expected = 7.0 * x / (1.0 - share * share);
                assert!((tension - expected).abs() < 1e-6 * expected.abs(), "{x}: {tension} {expected}");
                let expected = -3.5 * whole * whole * libm::log1p(-share * share);
                assert!((energy - expected).abs() < 1e-6 * expected, "{x}: {energy:e} {expected:e}");
            }
        }
    }

    #[test]
    fn beyond_the_limit_the_tension_goes_on_as_the_derivative_of_an_energy() {
        let (limit, h) = (0.5, 1e-7);
        for length in [1.0, 1.002, 1.0005, 0.5, 2.99, 2.9995, 3.0, 3.7, 40.0] {
            let [tension, _] = spring(limit, length);
            let slope = (spring(limit, length + h)[1] - spring(limit, length - h)[1]) / (2.0 * h);
            assert!((tension - slope).abs() < 1e-5 * tension.abs(), "{length}: {tension} {slope}");
        }
    }

    #[test]
    fn springs_without_a_length_have_no_limit() {
        let rest = vec![DVec3::ZERO; 2];
        let elements = [&[0, 1][..]].into_iter().collect();
        let body = Arc::new(Body::builder(rest).elements(elements).build().expect("a body"));
        let springs = MassSpring { stiffness: 7.0, damping: 0.0, springs: [[0, 1]].into(), breaks_at: None };
        let law = ByLaw::new(LimitedSprings { springs, limit: 0.5 }, &body);
        let energy = crate::law::Energy::report(&law, &[DVec3::ZERO, 3.0 * DVec3::X], &[], None, &Crew::new(1)).energy;
        assert_eq!(energy, Some(31.5));
    }
}
