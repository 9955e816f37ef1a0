//! Square matrices in lanes.

#![expect(clippy::needless_range_loop, reason = "loops over the coordinates of several arrays, without closures")]

use crate::lanes::Lanes;

/// A square matrix, its columns, in every lane.
pub(in crate::model) type Map<L, const D: usize> = [[L; D]; D];

/// The product of two matrices.
#[inline(always)]
pub(in crate::model) fn product<L: Lanes, const D: usize>(a: &Map<L, D>, b: &Map<L, D>) -> Map<L, D> {
    let mut product = [[L::splat(0.0); D]; D];
    for column in 0..D {
        for row in 0..D {
            let mut sum = a[0][row] * b[column][0];
            for at in 1..D {
                sum = a[at][row].mul_add(b[column][at], sum);
            }
            product[column][row] = sum;
        }
    }
    product
}

#[inline(always)]
pub(in crate::model) fn dot<L: Lanes, const D: usize>(a: &[L; D], b: &[L; D]) -> L {
    let mut sum = a[0] * b[0];
    for at in 1..D {
        sum = a[at].mul_add(b[at], sum);
    }
    sum
}

/// The derivatives of the determinant by the entries of a matrix.
#[inline(always)]
pub(in crate::model) fn cofactors<L: Lanes, const D: usize>(m: &Map<L, D>) -> Map<L, D> {
    let mut cofactors = [[L::splat(0.0); D]; D];
    if D == 2 {
        (cofactors[0][0], cofactors[0][1]) = (m[1][1], -m[1][0]);
        (cofactors[1][0], cofactors[1][1]) = (-m[0][1], m[0][0]);
    } else {
        for column in 0..D {
            let (a, b) = (&m[(column + 1) % D], &m[(column + 2) % D]);
            for row in 0..D {
                let (j, k) = ((row + 1) % D, (row + 2) % D);
                cofactors[column][row] = a[j].mul_sub(b[k], a[k] * b[j]);
            }
        }
    }
    cofactors
}
