//! Stable neo-Hookean finite elements.
//!
//! With `I_C = |F|²`, `J = det F` and `α = 1 + μ/(λ + μ)` in `d` dimensions: `ψ = ½ [μ (I_C − d) + (λ + μ)(J − α)²]` less its value at rest,
//! `P = μ F + (λ + μ)(J − α) cof F`. There is no stress at rest, where `cof F = I` and `(λ + μ)(1 − α) = −μ`, and the law of small strains is
//! Hooke's with the same `μ` and `λ`: `cof F` is `(1 + tr ε) I − ε` to first order. Both hold in the plane as in space. Everything is finite for
//! `J ≤ 0`, so mirrored elements turn back.
//!
//! It is the law to which B. Smith, F. de Goes, T. Kim, "Stable neo-Hookean flesh simulation", ACM Trans. Graph. 37(2), 2018, add a
//! logarithm, with their `λ` for `λ + μ`; so in M. Macklin, M. Müller, "A constraint-based formulation of stable neo-Hookean materials", MIG
//! 2021, and in SOFA's `StableNeoHookean`. The final Eq. (14) of Smith et al. also subtracts `½ μ ln(I_C + 1)`, with `α = 1 + 3μ/4λ`, and
//! replaces Lamé's `μ` and `λ` by `4μ/3` and `λ + 5μ/6` (section 3.4). With the logarithm an element that is crushed to a point opens again.
//! Without it `F = 0` is a second minimum in space, though not in the plane, and costs nothing if `ν = 0`.

#![expect(clippy::needless_range_loop, reason = "loops over the coordinates of several arrays, without closures")]

use super::Lanes;
use super::continuum::{Map, Stress, cofactors, dot, of_law};

of_law!(NeoHookean);

/// The stable neo-Hookean law.
#[derive(Clone, Copy, Debug, PartialEq)]
struct NeoHookean;

impl Stress for NeoHookean {
    const NAME: &'static str = "neo-hookean";

    #[inline(always)]
    fn stress<L: Lanes, const D: usize>([shear, lame]: [L; 2], f: &Map<L, D>) -> Map<L, D> {
        let cofactors = cofactors(f);
        let excess = dot(&f[0], &cofactors[0]) - L::splat(1.0);
        // (λ + μ)(J − α).
        let pressure = (lame + shear).mul_sub(excess, shear);
        let mut stress = *f;
        for column in 0..D {
            for row in 0..D {
                stress[column][row] = pressure.mul_add(cofactors[column][row], shear * f[column][row]);
            }
        }
        stress
    }

    /// From `G = F − I`, as differences of large numbers are not precise: `J − 1` is `tr G` and a rest of higher order, and `2ψ = μ (|G|² − 2
    /// rest) + (λ + μ)(J − 1)²`.
    #[inline(always)]
    fn energy<L: Lanes, const D: usize>([shear, lame]: [L; 2], f: &Map<L, D>) -> L {
        let (mut g, mut trace, mut squares) = (*f, L::splat(0.0), L::splat(0.0));
        for column in 0..D {
            g[column][column] = g[column][column] - L::splat(1.0);
            trace = trace + g[column][column];
            squares = squares + dot(&g[column], &g[column]);
        }
        let cofactors = cofactors(&g);
        let mut rest = dot(&g[0], &cofactors[0]);
        if D == 3 {
            for column in 0..D {
                rest = rest + cofactors[column][column];
            }
        }
        let excess = trace + rest;
        let volume = (lame + shear) * excess * excess;
        L::splat(0.5) * shear.mul_add(squares - (rest + rest), volume)
    }
}
