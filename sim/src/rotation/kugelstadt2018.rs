//! The analytic polar decomposition of T. Kugelstadt, D. Koschier, J. Bender, "Fast corotated FEM using operator
//! splitting", Computer Graphics Forum 37(8), 2018, p. 149, Algorithm 3.
//!
//! Newton's method with the symmetric matrix `H` of Eq. (15), as in
//! [`solve_symmetric`](super::linearised::solve_symmetric), where `w = H⁻¹ Σ R × r` is a rotation by `4 atan(|w|/4)`.
//! Guarantee: cubic convergence near the optimum; where the step would go uphill, one of steepest ascent is taken
//! instead, so that it cannot settle on a minimum but may need many passes. At a half turn the torque is zero, and it
//! stays there. Cost: one division and one square root for each pass.

use super::linearised::{solve_symmetric, symmetric_determinant};
use super::torque;
use glam::{DMat3, DQuat, DVec3};

/// The least determinant of `H` that counts as regular, for stretches of about 1.
const SINGULAR: f64 = 1e-9;

/// The rotation of an element from its last one, after a number of passes. `at_rest` is `Σ R0 rᵀ`.
pub(crate) fn iterate(at_rest: DMat3, last: DQuat, passes: u32) -> DQuat {
    // To stretches of about 1, for which the paper's steps of steepest ascent are meant.
    let squares: f64 = at_rest.to_cols_array().iter().map(|entry| entry * entry).sum();
    let scaled = at_rest * (squares / 3.0).sqrt().recip();
    if !scaled.is_finite() {
        return last;
    }
    let mut rotation = last;
    for _ in 0..passes {
        rotation = (increment(DMat3::from_quat(rotation) * scaled) * rotation).normalize();
    }
    rotation
}

/// One step for stretches of about 1, as a quaternion of any length.
fn increment(a: DMat3) -> DQuat {
    let uphill = -torque(a);
    let mut quarter = if symmetric_determinant(a).abs() < SINGULAR { uphill } else { solve_symmetric(a) * 0.25 };
    if quarter.dot(uphill) < 0.0 {
        quarter = uphill * 0.125;
    }
    let DVec3 { x, y, z } = quarter * 2.0;
    DQuat::from_xyzw(x, y, z, 1.0 - quarter.length_squared())
}
