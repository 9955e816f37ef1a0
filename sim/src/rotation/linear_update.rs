//! Eq. (16) as printed: `R ← R + w × R`, whose result is not a rotation. For comparison only.
//!
//! Components perpendicular to the axis grow by `√(1 + |w|²)` in each step, so a spinning element grows: by 22 % after
//! 1000 steps of 0.02 rad. After one pass the torque of Eq. (5) is exactly zero, as Eq. (15) is then solved exactly.

use super::{linearised, size};
use glam::{DMat3, DVec3};

/// The least determinant of the matrix of Eq. (15) that counts as regular, relative to the third power of its size.
const SINGULAR: f64 = 1e-12;

/// The matrix `M` of an element's equilibrium shape `R = M R0` from its last one: `passes` times Eq. (15), with each
/// solution inserted in Eq. (16).
///
/// `at_rest` is `Σ R0 rᵀ`. Where Eq. (15) has no solution (corners at a point or on a line) the last matrix is kept.
#[doc(alias = "Eq. 16")]
#[doc(alias = "Eq. 12")]
pub fn update(at_rest: DMat3, last: DMat3, passes: u32) -> DMat3 {
    let mut matrix = last;
    for _ in 0..passes {
        let a = matrix * at_rest;
        let size = size(a);
        if linearised::determinant(a).abs() <= SINGULAR * size * size * size {
            break;
        }
        matrix += cross(linearised::solve(a)) * matrix;
    }
    matrix
}

/// `[w]×`, the off-diagonal part of Eq. (12).
fn cross(w: DVec3) -> DMat3 {
    DMat3::from_cols_array(&[0.0, w.z, -w.y, -w.z, 0.0, w.x, w.y, -w.x, 0.0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rotation::{corners, moment, torque};
    use glam::DQuat;

    const SIDES: [f64; 3] = [1.0, 0.7, 0.4];

    #[test]
    fn one_pass_leaves_no_torque() {
        let rest = corners(SIDES);
        let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.5);
        let now: Vec<_> = rest.iter().map(|&r| turn * (r * DVec3::new(1.2, 0.8, 1.1))).collect();
        let at_rest = moment(&rest, now);
        let matrix = update(at_rest, DMat3::IDENTITY, 1);
        assert!(torque(matrix * at_rest).length() < 1e-15);
        assert!((matrix.determinant() - 1.0) > 0.1, "it is larger than the shape at rest");
    }

    #[test]
    fn a_spinning_element_swells_as_printed() {
        let rest = corners(SIDES);
        let mut matrix = DMat3::IDENTITY;
        for step in 1..=1000 {
            let turn = DQuat::from_axis_angle(DVec3::Z, 0.02 * f64::from(step));
            matrix = update(moment(&rest, rest.iter().map(|&r| turn * r)), matrix, 1);
        }
        // (1 + w²)^(1000/2) with w = tan 0.02 at the most: some 22 %.
        let growth = matrix.x_axis.length();
        assert!((growth - 1.2214).abs() < 1e-3, "{growth}");
        assert!((matrix.z_axis.length() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_has_no_axis_keeps_its_matrix() {
        let rest = corners(SIDES);
        for flatten in [DVec3::ZERO, DVec3::X] {
            let at_rest = moment(&rest, rest.iter().map(|&r| r * flatten));
            assert_eq!(update(at_rest, DMat3::IDENTITY, 3), DMat3::IDENTITY);
        }
    }
}
