//! Linear elasticity in finite elements, the model of the paper's Ref. 5.
//!
//! Hooke's law for the small strain `ε = (F + Fᵀ)/2 − I`: `ψ = μ |ε|² + λ/2 tr²ε`, `P = 2 μ ε + λ tr(ε) I`. Forces are the product of a
//! constant matrix with displacements. (T. Hughes, "The finite element method", 1987, section 2.7; E. Sifakis, J. Barbič, "FEM simulation of 3D
//! deformable solids", SIGGRAPH courses 2012, section 3.2.)
//!
//! It is about small displacements from the place at rest: rotation by an angle φ counts as a strain `cos φ − 1` across its axis, so a body that
//! turns swells, and its forces have a torque.

#![expect(clippy::needless_range_loop, reason = "loops over the coordinates of several arrays, without closures")]

use super::Lanes;
use super::continuum::{Map, Stress, of_law};

of_law!(Linear);

/// Hooke's law for small strains.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Linear;

impl Stress for Linear {
    const NAME: &'static str = "linear";

    #[inline(always)]
    fn stress<L: Lanes, const D: usize>([shear, lame]: [L; 2], f: &Map<L, D>) -> Map<L, D> {
        let (twice, pressure) = (shear + shear, lame * stretch(f));
        let mut stress = *f;
        for column in 0..D {
            for row in 0..D {
                stress[column][row] = if column == row {
                    twice.mul_add(f[row][row] - L::splat(1.0), pressure)
                } else {
                    shear * (f[column][row] + f[row][column])
                };
            }
        }
        stress
    }

    #[inline(always)]
    fn energy<L: Lanes, const D: usize>([shear, lame]: [L; 2], f: &Map<L, D>) -> L {
        let (half, one, trace) = (L::splat(0.5), L::splat(1.0), stretch(f));
        let mut squares = L::splat(0.0);
        for column in 0..D {
            for row in 0..D {
                let mut strain = half * (f[column][row] + f[row][column]);
                if column == row {
                    strain = strain - one;
                }
                squares = strain.mul_add(strain, squares);
            }
        }
        shear.mul_add(squares, half * lame * trace * trace)
    }
}

/// `tr ε`.
#[inline(always)]
fn stretch<L: Lanes, const D: usize>(f: &Map<L, D>) -> L {
    let mut trace = L::splat(0.0);
    for row in 0..D {
        trace = trace + (f[row][row] - L::splat(1.0));
    }
    trace
}
