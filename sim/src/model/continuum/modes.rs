//! The modes of quadrilaterals and hexahedra, and their derivatives at the points of Gauss.

#![expect(clippy::needless_range_loop, reason = "loops over the coordinates of several arrays, without closures")]

use super::map::Map;
use crate::lanes::Lanes;

/// `1/√3`: where the points of Gauss are.
pub(super) const GAUSS: f64 = 0.577_350_269_189_625_8;

/// The coordinates of a corner of a quadrilateral or hexahedron, a bit each: the corners of quadrilaterals are listed around.
#[inline(always)]
pub(super) fn bits<const D: usize>(corner: usize) -> usize {
    if D == 2 { corner ^ corner >> 1 } else { corner }
}

/// The bits of a point without that of an axis: at most two, so that no index into [`Slopes`] needs a test.
#[inline(always)]
pub(super) fn without(point: usize, axis: usize) -> usize {
    let below = (1 << axis) - 1;
    ((point & below) | (point >> 1 & !below)) & 3
}

/// From the corners of a box, by their bits, its modes: the coefficients, times 2ᵈ, of 1, ξ, η, ξη, ζ, ξζ, ηζ, ξηζ.
#[inline(always)]
pub(super) fn sums_and_differences<L: Lanes, const D: usize, const CORNERS: usize>(values: &mut [[L; D]; CORNERS]) {
    for axis in 0..D {
        for at in 0..CORNERS {
            if at >> axis & 1 == 0 {
                for row in 0..D {
                    let (low, high) = (values[at][row], values[at | 1 << axis][row]);
                    (values[at][row], values[at | 1 << axis][row]) = (low + high, high - low);
                }
            }
        }
    }
}

/// From forces on modes those on corners: the transpose of [`sums_and_differences`].
#[inline(always)]
pub(super) fn sums_and_differences_of_modes<L: Lanes, const D: usize, const CORNERS: usize>(
    values: &mut [[L; D]; CORNERS],
) {
    for axis in 0..D {
        for at in 0..CORNERS {
            if at >> axis & 1 == 0 {
                for row in 0..D {
                    let (even, odd) = (values[at][row], values[at | 1 << axis][row]);
                    (values[at][row], values[at | 1 << axis][row]) = (even - odd, even + odd);
                }
            }
        }
    }
}

/// The derivative along each axis, which does not depend on that axis, at the points of Gauss of the other axes.
pub(super) type Slopes<L, const D: usize> = [[[L; D]; 4]; D];

/// The derivatives at a point.
#[inline(always)]
pub(super) fn slope_at<L: Lanes, const D: usize>(slopes: &Slopes<L, D>, point: usize) -> Map<L, D> {
    let mut map = [[L::splat(0.0); D]; D];
    for axis in 0..D {
        map[axis] = slopes[axis][without(point, axis)];
    }
    map
}

/// The bits of the other axes, the lower first.
#[inline(always)]
pub(super) fn others(axis: usize) -> [usize; 2] {
    [[2, 4], [1, 4], [1, 2]][axis]
}

/// Derivatives from modes.
#[inline(always)]
pub(super) fn slopes<L: Lanes, const D: usize, const CORNERS: usize>(modes: &[[L; D]; CORNERS]) -> Slopes<L, D> {
    let g = L::splat(GAUSS);
    let mut slopes = [[[L::splat(0.0); D]; 4]; D];
    for axis in 0..D {
        let (own, [j, k]) = (1 << axis, others(axis));
        for row in 0..D {
            let (a, b) = (modes[own][row], modes[own | j][row]);
            let (low, high) = (g.neg_mul_add(b, a), g.mul_add(b, a));
            if D == 2 {
                (slopes[axis][0][row], slopes[axis][1][row]) = (low, high);
            } else {
                let (a, b) = (modes[own | k][row], modes[own | j | k][row]);
                let (of_low, of_high) = (g.neg_mul_add(b, a), g.mul_add(b, a));
                slopes[axis][0][row] = g.neg_mul_add(of_low, low);
                slopes[axis][1][row] = g.neg_mul_add(of_high, high);
                slopes[axis][2][row] = g.mul_add(of_low, low);
                slopes[axis][3][row] = g.mul_add(of_high, high);
            }
        }
    }
    slopes
}

/// Forces on modes from those on derivatives: the transpose of [`slopes`].
#[inline(always)]
pub(super) fn of_slopes<L: Lanes, const D: usize, const CORNERS: usize>(pulls: &Slopes<L, D>) -> [[L; D]; CORNERS] {
    let (zero, g) = (L::splat(0.0), L::splat(GAUSS));
    let mut modes = [[zero; D]; CORNERS];
    for axis in 0..D {
        let (own, [j, k]) = (1 << axis, others(axis));
        for row in 0..D {
            let of = [pulls[axis][0][row], pulls[axis][1][row], pulls[axis][2][row], pulls[axis][3][row]];
            if D == 2 {
                modes[own][row] = of[0] + of[1];
                modes[own | j][row] = g.mul_add(of[1] - of[0], modes[own | j][row]);
            } else {
                let (low, high) = (of[0] + of[2], of[1] + of[3]);
                let (of_low, of_high) = (of[2] - of[0], of[3] - of[1]);
                modes[own][row] = low + high;
                modes[own | j][row] = g.mul_add(high - low, modes[own | j][row]);
                modes[own | k][row] = g.mul_add(of_low + of_high, modes[own | k][row]);
                modes[own | j | k][row] = (g * g).mul_add(of_high - of_low, modes[own | j | k][row]);
            }
        }
    }
    modes
}
