//! Corotational finite elements: Hooke's law for the strain without the rotation.
//!
//! With `R` the rotation nearest to `F`: `ψ = μ |F − R|² + λ/2 tr²(RᵀF − I)`, `P = 2 μ (F − R) + λ tr(RᵀF − I) R`. (E. Sifakis, J. Barbič, "FEM
//! simulation of 3D deformable solids", SIGGRAPH courses 2012, section 3.4; T. Kim, D. Eberle, "Dynamic deformables", SIGGRAPH courses 2022;
//! the idea: M. Müller, M. Gross, "Interactive virtual materials", Graphics Interface 2004.) Each point of an element has a rotation of its own,
//! so that forces are the gradient of the energy.
//!
//! With `λ = 0` on regular tetrahedra it is the paper's model. The rotation has the determinant 1 for mirrored elements, too, which then turn
//! back. In the plane it is that of Eq. (9).

#![expect(clippy::needless_range_loop, reason = "loops over the coordinates of several arrays, without closures")]

use super::Lanes;
use super::continuum::{Map, Stress, dot, of_law, with_nearest};

of_law!(Corotational);

/// Hooke's law for strains without rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Corotational;

impl Stress for Corotational {
    const NAME: &'static str = "corotational";

    /// `2μ F + (λ (s − d) − 2μ) R`, with `s = tr RᵀF`.
    #[inline(always)]
    fn stress<L: Lanes, const D: usize>([shear, lame]: [L; 2], f: &Map<L, D>) -> Map<L, D> {
        let twice = shear + shear;
        with_nearest(f, [twice, lame, -twice]).0
    }

    #[inline(always)]
    fn energy<L: Lanes, const D: usize>([shear, lame]: [L; 2], f: &Map<L, D>) -> L {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let (off, trace) = with_nearest(f, [one, zero, -one]);
        let mut squares = zero;
        for column in 0..D {
            squares = squares + dot(&off[column], &off[column]);
        }
        shear.mul_add(squares, L::splat(0.5) * lame * trace * trace)
    }
}
