//! The law of elements of a continuum: forces and energies in lanes.

#![expect(clippy::needless_range_loop, reason = "loops over the coordinates of several arrays, without closures")]

use super::Stress;
use super::map::{Map, cofactors, dot, product, pulled};
use super::modes::{bits, of_slopes, slope_at, slopes, sums_and_differences, sums_and_differences_of_modes, without};
use crate::body::Body;
use crate::element::Dimension;
use crate::kernel::rotation::{self, Moments, Optimum, Solver};
use crate::lanes::{Lanes, MOST, Work, each};
use crate::law::{Corners, Element, Law, Reader, Rigid, alike, off};
use glam::DVec3;
use std::marker::PhantomData;

/// The law of elements in `D` dimensions with so many corners at most: four in the plane; in space eight, or four if all are tetrahedra.
#[derive(Clone)]
pub(super) struct Elements<S, const D: usize, const CORNERS: usize> {
    /// `μ` (Pa).
    pub(super) shear: f64,
    /// `λ` (Pa).
    pub(super) lame: f64,
    /// `D` (N s/m).
    pub(super) damping: f64,
    /// Whether all elements are [affine](is_affine).
    pub(super) is_affine: bool,
    pub(super) of: PhantomData<S>,
}

impl<S: Stress, const D: usize, const CORNERS: usize> Elements<S, D, CORNERS> {
    /// Whether some elements are quadrilaterals or hexahedra.
    const HAS_BOXES: bool = CORNERS == 1 << D;
    /// How many numbers describe a rotation: a quaternion, or (cos θ, sin θ).
    const TURN: usize = if D == 3 { 4 } else { 2 };

    /// The inverse of the gradient of an element from its parent, and the weight of a point.
    #[inline(always)]
    fn inverse<L: Lanes>(gradient: &Map<L, D>, size: f64) -> (Map<L, D>, L) {
        let cofactors = cofactors(gradient);
        let determinant = dot(&gradient[0], &cofactors[0]);
        let over = L::splat(1.0) / determinant;
        let mut inverse = [[over; D]; D];
        for column in 0..D {
            for row in 0..D {
                inverse[column][row] = cofactors[row][column] * over;
            }
        }
        (inverse, determinant * L::splat(size))
    }

    /// The inverse and the weight from the constants of affine elements.
    #[inline(always)]
    fn affine<L: Lanes>(element: &Element<'_, L>) -> (Map<L, D>, L) {
        let weight = element.of_element(D * D);
        let mut inverse = [[weight; D]; D];
        for column in 0..D {
            for row in 0..D {
                inverse[column][row] = element.of_element(column * D + row);
            }
        }
        (inverse, weight)
    }

    /// The rotation nearest to `F` at a point, from the last one.
    #[inline(always)]
    fn rotation<L: Lanes>(element: &Element<'_, L>, point: usize, f: &Map<L, D>) -> Map<L, D> {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let mut r = [[zero; D]; D];
        if !S::TURNS {
            return r;
        }
        if D == 2 {
            let last = element.memory_from::<2>(2 * point);
            let turn = rotation::in_plane([f[0][0] + f[1][1], f[0][1] - f[1][0]], last);
            element.remember_from(2 * point, turn);
            (r[0][0], r[0][1], r[1][0], r[1][1]) = (turn[0], turn[1], -turn[1], turn[0]);
        } else {
            let a = each!(3, column => each!(3, row => f[column][row]));
            let of = Moments { a: &a, scale: L::splat(1.0 / 3.0), tally: None };
            let (turn, _) = Optimum.step(of, element.memory_from::<4>(4 * point), element.live(), true);
            element.remember_from(4 * point, turn);
            let matrix = rotation::matrix(turn, one);
            for column in 0..D {
                for row in 0..D {
                    r[column][row] = matrix[column][row];
                }
            }
        }
        r
    }

    /// The position of a corner (m).
    #[inline(always)]
    fn corner<L: Lanes>(element: &Element<'_, L>, corner: usize) -> [L; D] {
        let mut place = [L::splat(0.0); D];
        if D == 2 {
            let (p, _) = element.corner_in_plane(corner);
            (place[0], place[1]) = (p[0], p[1]);
        } else {
            let (p, _) = element.corner(corner);
            (place[0], place[1], place[2]) = (p[0], p[1], p[2]);
        }
        place
    }

    /// The elastic forces on the corners (N), or the energy (J) of the element.
    #[inline(always)]
    fn evaluate<L: Lanes, const ENERGY: bool>(&self, element: &Element<'_, L>) -> ([[L; D]; CORNERS], L) {
        let zero = L::splat(0.0);
        let moduli = [L::splat(self.shear), L::splat(self.lame)];
        let (mut forces, mut energy) = ([[zero; D]; CORNERS], zero);
        if element.corners() == D + 1 {
            let first = Self::corner(element, 0);
            let mut edges = [[zero; D]; D];
            for edge in 0..D {
                let end = Self::corner(element, edge + 1);
                for row in 0..D {
                    edges[edge][row] = end[row] - first[row];
                }
            }
            let (inverse, weight) = Self::affine(element);
            let f = product(&edges, &inverse);
            let r = Self::rotation(element, 0, &f);
            if ENERGY {
                energy = weight * S::energy(moduli, &f, &r);
            } else {
                let of = pulled(&S::stress([moduli[0] * weight, moduli[1] * weight], &f, &r), &inverse);
                for edge in 0..D {
                    for row in 0..D {
                        forces[0][row] = forces[0][row] + of[edge][row];
                        forces[edge + 1][row] = -of[edge][row];
                    }
                }
            }
        } else if Self::HAS_BOXES {
            let mut modes = [[zero; D]; CORNERS];
            for corner in 0..CORNERS {
                modes[bits::<D>(corner)] = Self::corner(element, corner);
            }
            sums_and_differences(&mut modes);
            let now = slopes(&modes);
            let mut rest = [[[zero; D]; 4]; D];
            let mut fixed = ([[zero; D]; D], zero);
            if self.is_affine {
                fixed = Self::affine(element);
            } else {
                let mut modes = [[zero; D]; CORNERS];
                for mode in 1..CORNERS {
                    for row in 0..D {
                        modes[mode][row] = element.of_element((mode - 1) * D + row);
                    }
                }
                rest = slopes(&modes);
            }
            let mut pulls = [[[zero; D]; 4]; D];
            // As many points as corners. Unrolled they are many times as long to compile, and no faster.
            for point in 0..element.corners() {
                let (inverse, weight) =
                    if self.is_affine { fixed } else { Self::inverse(&slope_at(&rest, point), Self::BOX) };
                let f = product(&slope_at(&now, point), &inverse);
                let r = Self::rotation(element, point, &f);
                if ENERGY {
                    energy = weight.mul_add(S::energy(moduli, &f, &r), energy);
                } else {
                    let of = pulled(&S::stress([moduli[0] * weight, moduli[1] * weight], &f, &r), &inverse);
                    for axis in 0..D {
                        let pull = &mut pulls[axis][without(point, axis)];
                        for row in 0..D {
                            pull[row] = pull[row] - of[axis][row];
                        }
                    }
                }
            }
            if !ENERGY {
                let mut of_modes = of_slopes::<L, D, CORNERS>(&pulls);
                sums_and_differences_of_modes(&mut of_modes);
                for corner in 0..CORNERS {
                    forces[corner] = of_modes[bits::<D>(corner)];
                }
            }
        }
        (forces, energy)
    }

    /// The weight of a point over the determinant of the slopes of a box, which are 2ᵈ times the gradient of its map from `[−1, 1]ᵈ`.
    const BOX: f64 = 1.0 / (1_u64 << (D * D)) as f64;
    /// The volume of a simplex over the determinant of its edges.
    const SIMPLEX: f64 = if D == 3 { 1.0 / 6.0 } else { 0.5 };
}

impl<S: Stress, const D: usize, const CORNERS: usize> Law for Elements<S, D, CORNERS> {
    /// Of an affine element the inverse of its gradient and the weight of a point; else its modes at rest, but the first (m).
    const OF_ELEMENT: usize = if Self::HAS_BOXES { (CORNERS - 1) * D } else { D * D + 1 };
    /// The rotation of each point.
    const MEMORY: usize = match (S::TURNS, Self::HAS_BOXES) {
        (false, _) => 0,
        (true, true) => CORNERS * Self::TURN,
        (true, false) => Self::TURN,
    };
    /// The forces on the corners (N).
    type Whole<L: Lanes> = [[L; D]; CORNERS];

    /// The modulus and the measures of an element decide its stiffness.
    fn relative_stiffness(&self, body: &Body) -> Option<Vec<f64>> {
        body.fill.clone()
    }

    fn is_damped(&self) -> bool {
        self.damping > 0.0
    }

    #[inline(always)]
    fn prepare<L: Lanes>(&self, rest: &Corners<'_, L>, of_element: &mut [L], _: &mut [L]) {
        let zero = L::splat(0.0);
        let mut gradient = [[zero; D]; D];
        let mut size = Self::SIMPLEX;
        if rest.count() == D + 1 {
            let first = rest.position(0);
            for edge in 0..D {
                let end = rest.position(edge + 1);
                for row in 0..D {
                    gradient[edge][row] = end[row] - first[row];
                }
            }
        } else if Self::HAS_BOXES {
            let mut modes = [[zero; D]; CORNERS];
            for corner in 0..CORNERS {
                let place = rest.position(corner);
                modes[bits::<D>(corner)].copy_from_slice(&place[..D]);
            }
            sums_and_differences(&mut modes);
            if !self.is_affine {
                for mode in 1..CORNERS {
                    for row in 0..D {
                        of_element[(mode - 1) * D + row] = modes[mode][row];
                    }
                }
                return;
            }
            for axis in 0..D {
                gradient[axis] = modes[1 << axis];
            }
            size = Self::BOX;
        }
        let (inverse, weight) = Self::inverse(&gradient, size);
        for column in 0..D {
            for row in 0..D {
                of_element[column * D + row] = inverse[column][row];
            }
        }
        of_element[D * D] = weight;
    }

    #[inline(always)]
    fn whole<L: Lanes>(&self, element: &Element<'_, L>) -> [[L; D]; CORNERS] {
        let (mut forces, _) = self.evaluate::<L, false>(element);
        if self.damping > 0.0 {
            let (rigid, d) = (Rigid::of(element), L::splat(self.damping));
            for corner in 0..element.corners() {
                let (p, v) = element.corner(corner);
                let off = off(rigid, p, v);
                for row in 0..D {
                    forces[corner][row] = d.neg_mul_add(off[row], forces[corner][row]);
                }
            }
        }
        forces
    }

    #[inline(always)]
    fn force<L: Lanes>(&self, _: &Element<'_, L>, corner: usize, forces: &[[L; D]; CORNERS]) -> [L; 3] {
        let (force, zero) = (&forces[corner], L::splat(0.0));
        [force[0], force[1], if D == 3 { force[D - 1] } else { zero }]
    }

    #[inline(always)]
    fn energy<L: Lanes>(&self, element: &Element<'_, L>, _: &Corners<'_, L>, shares: &mut [L]) -> L {
        let (_, energy) = self.evaluate::<L, true>(element);
        shares.fill(energy * L::splat(1.0 / element.corners() as f64));
        L::splat(0.0)
    }
}

/// Computes the memory of elements at the start, element by element.
pub(super) struct Start<'a, W> {
    pub(super) law: W,
    pub(super) body: &'a Body,
    pub(super) position: &'a [DVec3],
}

impl<W: Law> Work for Start<'_, W> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Vec<f64> {
        let Self { law, body, position } = self;
        let identity: &[f64] = if body.dimension == Dimension::Plane { &[1.0, 0.0] } else { &[0.0, 0.0, 0.0, 1.0] };
        let identity: Vec<f64> = identity.iter().copied().cycle().take(W::MEMORY).collect();
        let (mut reader, mut memory) = (Reader::<L>::new(), Vec::with_capacity(body.elements.len() * W::MEMORY));
        while memory.len() < body.elements.len() * W::MEMORY {
            let first = memory.len() / W::MEMORY;
            let (group, count) = alike::<L>(&body.elements, first..body.elements.len());
            reader.read(&group, body, position, None, &[1.0; MOST]);
            reader.prepare(&law);
            reader.recall(&identity, 0, 1, W::MEMORY);
            let (element, _) = reader.elements::<W>(count);
            law.whole(&element);
            for lane in 0..count {
                memory.extend(reader.memory.iter().map(|row| row[lane]));
            }
        }
        memory
    }
}
