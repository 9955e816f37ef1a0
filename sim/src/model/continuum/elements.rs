//! The law of elements of a continuum: forces and energies in lanes.

#![expect(clippy::needless_range_loop, reason = "loops over the coordinates of several arrays, without closures")]

use super::Stress;
use super::map::{Map, cofactors, dot, product};
use super::modes::{bits, of_slopes, slope_at, slopes, sums_and_differences, sums_and_differences_of_modes, without};
use crate::body::Body;
use crate::fill;
use crate::lanes::Lanes;
use crate::law::{Corners, Element, Law, Rigid, off};
use crate::material::Damping;
use std::marker::PhantomData;

/// The law of elements in `D` dimensions with so many corners at most: four in the plane; in space eight, or four if all are tetrahedra.
#[derive(Clone)]
pub(super) struct Elements<S, const D: usize, const CORNERS: usize> {
    /// `μ` (Pa).
    pub(super) shear: f64,
    /// `λ` (Pa).
    pub(super) lame: f64,
    /// `D` of each element.
    pub(super) damping: Damping,
    /// Whether all elements are [affine](is_affine).
    pub(super) is_affine: bool,
    pub(super) of: PhantomData<S>,
}

impl<S: Stress, const D: usize, const CORNERS: usize> Elements<S, D, CORNERS> {
    /// Whether some elements are quadrilaterals or hexahedra.
    const HAS_BOXES: bool = CORNERS == 1 << D;
    /// How many numbers the different [`slopes`] of a box are.
    const SLOPES: usize = CORNERS / 2 * D * D;
    /// The place of `D` (N s/m) among the constants.
    const DAMPING: usize = if Self::HAS_BOXES { Self::SLOPES + CORNERS } else { D * D + 1 };

    /// The cofactors of the gradient of an element from its parent, and one over its determinant.
    #[inline(always)]
    fn parent<L: Lanes>(gradient: &Map<L, D>) -> (Map<L, D>, L) {
        let cofactors = cofactors(gradient);
        let determinant = dot(&gradient[0], &cofactors[0]);
        (cofactors, L::splat(1.0) / determinant)
    }

    /// These, from the constants of affine elements.
    #[inline(always)]
    fn affine<L: Lanes>(element: &Element<'_, L>) -> (Map<L, D>, L) {
        let over = element.of_element(D * D);
        let mut cofactors = [[over; D]; D];
        for column in 0..D {
            for row in 0..D {
                cofactors[column][row] = element.of_element(column * D + row);
            }
        }
        (cofactors, over)
    }

    /// These at a point, from the constants of other elements.
    #[inline(always)]
    fn parent_at<L: Lanes>(element: &Element<'_, L>, point: usize) -> (Map<L, D>, L) {
        let over = element.of_element(Self::SLOPES + point);
        let mut gradient = [[over; D]; D];
        for axis in 0..D {
            for row in 0..D {
                gradient[axis][row] = element.of_element((axis * CORNERS / 2 + without(point, axis)) * D + row);
            }
        }
        (cofactors(&gradient), over)
    }

    /// `F`, from the gradient now from the parent.
    #[inline(always)]
    fn gradient<L: Lanes>(now: &Map<L, D>, (cofactors, over): &(Map<L, D>, L)) -> Map<L, D> {
        let mut inverse = [[*over; D]; D];
        for column in 0..D {
            for row in 0..D {
                inverse[column][row] = cofactors[row][column] * *over;
            }
        }
        product(now, &inverse)
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
        let (mut forces, mut energy) = ([[zero; D]; CORNERS], zero);
        // The weight of a point is in proportion to the determinant, so that the stress times the cofactors is the pull on each edge of the
        // parent. An energy is divided by the inverse determinant.
        let size = if element.corners() == D + 1 { Self::SIMPLEX } else { Self::BOX };
        let moduli = [L::splat(self.shear * size), L::splat(self.lame * size)];
        if element.corners() == D + 1 {
            let first = Self::corner(element, 0);
            let mut edges = [[zero; D]; D];
            for edge in 0..D {
                let end = Self::corner(element, edge + 1);
                for row in 0..D {
                    edges[edge][row] = end[row] - first[row];
                }
            }
            let parent = Self::affine(element);
            let f = Self::gradient(&edges, &parent);
            if ENERGY {
                energy = S::energy(moduli, &f) / parent.1;
            } else {
                let stress = S::stress(moduli, &f);
                for edge in 0..D {
                    for row in 0..D {
                        let mut pull = stress[0][row] * parent.0[edge][0];
                        for at in 1..D {
                            pull = stress[at][row].mul_add(parent.0[edge][at], pull);
                        }
                        forces[0][row] = forces[0][row] + pull;
                        forces[edge + 1][row] = -pull;
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
            let mut pulls = [[[zero; D]; 4]; D];
            // As many points as corners. Unrolled they are many times as long to compile, and no faster.
            for point in 0..element.corners() {
                let parent = if self.is_affine { Self::affine(element) } else { Self::parent_at(element, point) };
                let f = Self::gradient(&slope_at(&now, point), &parent);
                if ENERGY {
                    energy = energy + S::energy(moduli, &f) / parent.1;
                } else {
                    let stress = S::stress(moduli, &f);
                    for axis in 0..D {
                        let pull = &mut pulls[axis][without(point, axis)];
                        for row in 0..D {
                            for at in 0..D {
                                pull[row] = stress[at][row].neg_mul_add(parent.0[axis][at], pull[row]);
                            }
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
    /// Of an affine element the cofactors of its gradient and one over its determinant; else its slopes (m), and one over the determinant at
    /// each point. Then its damping.
    const OF_ELEMENT: usize = Self::DAMPING + 1;
    /// The forces on the corners (N).
    type Whole<L: Lanes> = [[L; D]; CORNERS];

    /// The modulus and the measures of an element decide its stiffness.
    fn relative_stiffness(&self, body: &Body) -> Option<Vec<f64>> {
        fill::of_materials(body)
    }

    fn is_damped(&self) -> bool {
        self.damping.most > 0.0
    }

    #[inline(always)]
    fn prepare<L: Lanes>(&self, rest: &Corners<'_, L>, of_element: &mut [L], _: &mut [L]) {
        let zero = L::splat(0.0);
        let mut gradient = [[zero; D]; D];
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
                let (of_modes, mut volume) = (slopes(&modes), zero);
                for point in 0..CORNERS {
                    let gradient = slope_at(&of_modes, point);
                    for axis in 0..D {
                        let at = (axis * CORNERS / 2 + without(point, axis)) * D;
                        of_element[at..at + D].copy_from_slice(&gradient[axis]);
                    }
                    let over = Self::parent(&gradient).1;
                    of_element[Self::SLOPES + point] = over;
                    volume = volume + L::splat(Self::BOX) / over;
                }
                of_element[Self::DAMPING] = self.damping.of(rest, volume, D as f64);
                return;
            }
            for axis in 0..D {
                gradient[axis] = modes[1 << axis];
            }
        }
        let (cofactors, over) = Self::parent(&gradient);
        for column in 0..D {
            for row in 0..D {
                of_element[column * D + row] = cofactors[column][row];
            }
        }
        of_element[D * D] = over;
        let size = if rest.count() == D + 1 { Self::SIMPLEX } else { Self::BOX * CORNERS as f64 };
        of_element[Self::DAMPING] = self.damping.of(rest, L::splat(size) / over, D as f64);
    }

    #[inline(always)]
    fn whole<L: Lanes>(&self, element: &Element<'_, L>) -> [[L; D]; CORNERS] {
        let (mut forces, _) = self.evaluate::<L, false>(element);
        if self.damping.most > 0.0 {
            let (rigid, d) = (Rigid::of(element), element.of_element(Self::DAMPING));
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
