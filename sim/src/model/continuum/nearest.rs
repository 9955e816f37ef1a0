//! The rotation nearest to a gradient, without a last one to start from.
//!
//! With the stretches `σ` of `F`, the last one negative where `F` is turned inside out, the sum `s = σ₁ + σ₂ + σ₃ = tr(RᵀF)` is the largest
//! root of `(s² − I₁)² − 4 I₂ − 8 J s`, with `I₁ = |F|²`, `I₂ = |cof F|²` and `J = det F`: all roots are `±σ₁ ± σ₂ ± σ₃` with an even number of
//! minus signs. Its gradient is the rotation: `R = ∂s/∂F = (½ (s² + I₁) F − F FᵀF + s cof F) / d`, with
//! `d = (σ₁ + σ₂)(σ₂ + σ₃)(σ₃ + σ₁) = ½ s (s² − I₁) − J`. (H. Lin, F. Chitalu, T. Komura, "Isotropic ARAP energy using Cauchy-Green invariants",
//! ACM Trans. Graph. 41(6), 2022, has the quartic.)
//!
//! All roots are real and `½ (3 + I₁) ≥ √(3 I₁) ≥ s`, so Halley's method falls from there to the largest without a test.

use super::map::{Map, cofactors, dot, product};
use crate::kernel::rotation::in_plane;
use crate::lanes::{Lanes, MOST, each};
use crate::rotation::davenport1968;
use glam::{DMat3, DQuat};

/// A step of this size relative to `s` is the last: the next one would be of the order of its cube.
const LAST: f64 = 3e-6;
/// Equal stretches up to 3e8 take no more steps; the global solver does the rest.
const MOST_STEPS: u32 = 40;
/// The least `d / s³`. The error of `R` grows as its inverse squared, and below that the global solver computes it.
const SOUND: f64 = 1e-3;

/// `a F + (b (s − d) + c) R`, with `R` the rotation nearest to `F`, of determinant 1, and `s = tr(RᵀF)` in `d` dimensions; and `s − d`. Where several
/// rotations are as near, `R` is the one nearest to the identity.
#[inline(always)]
pub(in crate::model) fn with_nearest<L: Lanes, const D: usize>(f: &Map<L, D>, [a, b, c]: [L; 3]) -> (Map<L, D>, L) {
    let (zero, one, half) = (L::splat(0.0), L::splat(1.0), L::splat(0.5));
    let mut of = [[zero; D]; D];
    if D == 2 {
        let sums = [f[0][0] + f[1][1], f[0][1] - f[1][0]];
        let [cosine, sine] = in_plane(sums, [one, zero]);
        let excess = cosine.mul_add(sums[0], sine.mul_sub(sums[1], L::splat(2.0)));
        let weight = b.mul_add(excess, c);
        let (cosine, sine) = (weight * cosine, weight * sine);
        (of[0][0], of[0][1]) = (a.mul_add(f[0][0], cosine), a.mul_add(f[0][1], sine));
        (of[1][0], of[1][1]) = (a.mul_add(f[1][0], -sine), a.mul_add(f[1][1], cosine));
        return (of, excess);
    }
    let f = each!(3, column => each!(3, row => f[column][row]));
    let cofactors = cofactors(&f);
    let determinant = dot(&f[0], &cofactors[0]);
    // FᵀF.
    let (xx, yy, zz) = (dot(&f[0], &f[0]), dot(&f[1], &f[1]), dot(&f[2], &f[2]));
    let (xy, xz, yz) = (dot(&f[0], &f[1]), dot(&f[0], &f[2]), dot(&f[1], &f[2]));
    let first = xx + yy + zz;
    let minors = xx.mul_sub(yy, xy * xy) + xx.mul_sub(zz, xz * xz) + yy.mul_sub(zz, yz * yz);
    let twice = determinant + determinant;
    let mut sum = half.mul_add(first, L::splat(1.5));
    let mut open = L::ALL;
    for _ in 0..MOST_STEPS {
        // A quarter of the polynomial and of its derivative, and an eighth of its second one.
        let square = sum * sum;
        let rest = square - first;
        let value = sum.neg_mul_add(twice, (L::splat(0.25) * rest).mul_sub(rest, minors));
        let slope = sum.mul_sub(rest, twice);
        let curvature = half.mul_add(rest, square);
        let step = (value * slope) / value.neg_mul_add(curvature, slope * slope);
        sum = (sum - step).select(L::mask(open), sum);
        open &= L::bits((L::splat(LAST) * sum).lt(step.abs()));
        if open == 0 {
            break;
        }
    }
    let square = sum * sum;
    let divisor = (half * sum).mul_sub(square - first, determinant);
    let sound = L::bits((L::splat(SOUND) * square * sum).lt(divisor)) & !open;
    let mut excess = sum - L::splat(3.0);
    let weight = b.mul_add(excess, c) / divisor;
    let (own, adjugate) = (weight.mul_add(half * (square + first), a), weight * sum);
    let (xx, yy, zz) = (xx.neg_mul_add(weight, own), yy.neg_mul_add(weight, own), zz.neg_mul_add(weight, own));
    let (xy, xz, yz) = (-(xy * weight), -(xz * weight), -(yz * weight));
    let mixed = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let own = product(&f, &mixed);
    let mut whole = each!(3, column => each!(3, row => adjugate.mul_add(cofactors[column][row], own[column][row])));
    if sound != L::ALL {
        (whole, excess) = globally(&f, [a, b, c], (whole, excess), L::ALL & !sound);
    }
    for column in 0..D {
        for row in 0..D {
            of[column][row] = whole[column][row];
        }
    }
    (of, excess)
}

/// Replaces the results in the lanes whose bits are set.
#[inline(always)]
fn globally<L: Lanes>(f: &Map<L, 3>, weights: [L; 3], of: (Map<L, 3>, L), lanes: u32) -> (Map<L, 3>, L) {
    let f = each!(3, column => each!(3, row => f[column][row].to_array()));
    let weights = each!(3, at => weights[at].to_array());
    let mut whole = each!(3, column => each!(3, row => of.0[column][row].to_array()));
    let mut excess = of.1.to_array();
    globally_in_arrays(&f, &weights, &mut whole, &mut excess, lanes);
    (each!(3, column => each!(3, row => L::from_array(whole[column][row]))), L::from_array(excess))
}

#[cold]
#[inline(never)]
fn globally_in_arrays(
    f: &Map<[f64; MOST], 3>,
    weights: &[[f64; MOST]; 3],
    whole: &mut Map<[f64; MOST], 3>,
    excess: &mut [f64; MOST],
    lanes: u32,
) {
    for lane in (0..MOST).filter(|lane| lanes >> lane & 1 == 1) {
        let f = DMat3::from_cols_array_2d(&f.map(|column| column.map(|entry| entry[lane])));
        let r = DMat3::from_quat(davenport1968::optimum(f.transpose(), DQuat::IDENTITY));
        excess[lane] = (0..3).map(|axis| r.col(axis).dot(f.col(axis))).sum::<f64>() - 3.0;
        let [a, b, c] = weights.map(|weight| weight[lane]);
        let found = f * a + r * (b * excess[lane] + c);
        for (column, found) in whole.iter_mut().zip(found.to_cols_array_2d()) {
            column.iter_mut().zip(found).for_each(|(entry, found)| entry[lane] = found);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Set, Work};
    use crate::noise::Noise;
    use glam::DVec3;

    /// `R` and `s − 3` of gradients, one vector after the other.
    struct Nearest<'a>(&'a [DMat3]);

    impl Work for Nearest<'_> {
        type Output = Vec<(DMat3, f64)>;
        #[inline(always)]
        fn run<L: Lanes>(self) -> Self::Output {
            let (zero, one) = (L::splat(0.0), L::splat(1.0));
            let mut all = Vec::new();
            for some in self.0.chunks(L::WIDTH) {
                let entry = |column: usize, row: usize| {
                    L::from_array(std::array::from_fn(|at| some.get(at).map_or(0.0, |f| f.col(column)[row])))
                };
                let f = [0, 1, 2].map(|column| [0, 1, 2].map(|row| entry(column, row)));
                let (r, excess) = with_nearest(&f, [zero, zero, one]);
                let r = r.map(|column| column.map(L::to_array));
                let excess = excess.to_array();
                all.extend((0..some.len()).map(|lane| {
                    (DMat3::from_cols_array_2d(&r.map(|column| column.map(|entry| entry[lane]))), excess[lane])
                }));
            }
            all
        }
    }

    /// Gradients with many kinds of stretches, turned by any angle.
    fn all_sorts() -> Vec<DMat3> {
        let mut noise = Noise(5);
        let stretches = [
            DVec3::ONE,
            DVec3::new(1.0 + 1e-9, 1.0, 1.0 - 1e-9),
            DVec3::new(1.1, 1.0, 0.9),
            DVec3::new(2.0, 0.5, 0.2),
            DVec3::new(1.0, 0.1, 0.1),
            DVec3::new(1.0, 1.0, -0.5),
            DVec3::new(1.0, 0.3, -0.25),
            DVec3::new(1.0, 0.9, -0.9),
            DVec3::new(1.0, 0.7, 0.0),
            DVec3::splat(1e4),
            DVec3::splat(1e90),
            DVec3::X,
            DVec3::ZERO,
            DVec3::ONE * 1e-120,
            DVec3::ONE * 1e-9,
        ];
        (0..3000)
            .map(|at| {
                let mut turn = || DMat3::from_quat(DQuat::from_vec4(noise.vector().extend(noise.next())).normalize());
                let axes = turn();
                turn() * axes * DMat3::from_diagonal(stretches[at % stretches.len()]) * axes.transpose()
            })
            .collect()
    }

    #[test]
    fn the_closed_form_is_the_best_rotation() {
        for f in all_sorts() {
            let (r, excess) = Set::best().run(Nearest(&[f]))[0];
            let best = DMat3::from_quat(davenport1968::optimum(f.transpose(), DQuat::IDENTITY));
            let sum = |r: DMat3| (0..3).map(|axis| r.col(axis).dot(f.col(axis))).sum::<f64>();
            let size = f.to_cols_array().iter().fold(1.0, |size: f64, entry| size.max(entry.abs()));
            assert!(sum(r) >= sum(best) - 1e-11 * size && (excess + 3.0 - sum(best)).abs() < 1e-14 * size, "{f} {r}");
            let off =
                (r.transpose() * r - DMat3::IDENTITY).to_cols_array().iter().fold(0.0, |a: f64, b| a.max(b.abs()));
            assert!(off < 1e-10 && r.determinant() > 0.0, "{f} {r}: {off}");
            // Σ σ − σ of the best rotation are the eigenvalues of its Hessian: it is decided where none is small.
            let s = best.transpose() * f;
            let hessian = DMat3::from_diagonal(DVec3::splat(sum(best))) - s;
            if hessian.determinant() > 1e-2 * sum(best).powi(3) {
                let error = (r - best).to_cols_array().iter().fold(0.0, |a: f64, b| a.max(b.abs()));
                assert!(error < 1e-13, "{f}: {error}");
            }
        }
    }

    #[test]
    fn neighbours_and_vector_sets_have_no_influence() {
        let all = all_sorts();
        let found = Set::best().run(Nearest(&all));
        for set in Set::all() {
            assert_eq!(set.run(Nearest(&all)), found, "{set:?}");
        }
        let backwards: Vec<_> = all.iter().rev().copied().collect();
        let mut again = Set::best().run(Nearest(&backwards));
        again.reverse();
        assert_eq!(again, found);
    }
}
