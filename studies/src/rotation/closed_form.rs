//! The optimal rotation in closed form, without a last rotation, up to Newton's method for one root.
//!
//! `λ = tr(M Σ R0 rᵀ)` at the optimum is the largest root of `λ⁴ − 2 I₁ λ² − 8 J λ + I₁² − 4 I₂`, the characteristic
//! polynomial of Davenport's matrix, with `I₁ = tr AᵀA`, `I₂` the second invariant of `AᵀA` and `J = det A`. Then
//! `M = (λ cof A + ½ (λ² + I₁) A − A AᵀA) / (½ λ (λ² − I₁) − J)` with `A = Σ r R0ᵀ`: B. Horn, H. Hilden,
//! S. Negahdaripour, "Closed-form solution of absolute orientation using orthonormal matrices", J. Opt. Soc. Am. A
//! 5(7), 1988, p. 1127; the root as in F. Markley, D. Mortari, "Quaternion attitude estimation using vector
//! observations", J. Astronaut. Sci. 48(2), 2000, p. 359.
//!
//! Guarantee: the true optimum from any start. Errors grow with the inverse square of the gap `s₂ ± s₃` of the singular
//! values. The divisor is the product of the sums of two of them; if it is too small, the [`optimum`] by eigenvectors
//! is used. Cost: some three steps for the root, then matrices and one quaternion, for any last rotation.

use glam::{DMat3, DQuat};
use localshape::sim::rotation::davenport1968::optimum;

/// The least divisor, relative to `λ³`; it is 8/27 for a cube at rest.
const SOUND: f64 = 1e-3;
/// Newton's method converges in three to seven steps if the divisor is sound, and slowly next to a double root.
const MOST_STEPS: u32 = 12;
/// It has converged if a step is at most this part of the root: the next one would be round-off.
const SHORT: f64 = 1e-9;

/// The optimum; `last` is used only if the divisor is too small.
pub(super) fn rotation(at_rest: DMat3, last: DQuat) -> DQuat {
    regular(at_rest).unwrap_or_else(|| optimum(at_rest, last))
}

fn regular(at_rest: DMat3) -> Option<DQuat> {
    let size = at_rest.to_cols_array().iter().map(|entry| entry.abs()).sum::<f64>();
    if !(size > 0.0 && size.is_finite()) {
        return None;
    }
    let a = at_rest.transpose() * size.recip();
    let [x, y, z] = [a.x_axis, a.y_axis, a.z_axis];
    // The columns of the cofactor matrix; its squares are the second invariant of AᵀA.
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    let determinant = x.dot(cofactors.x_axis);
    let squares = |m: DMat3| m.x_axis.length_squared() + m.y_axis.length_squared() + m.z_axis.length_squared();
    let (first, second) = (squares(a), squares(cofactors));
    let constant = first * first - 4.0 * second;
    // No root is larger, so the iteration falls towards the largest one.
    let mut root = (3.0 * first).sqrt();
    let mut steps = 0;
    loop {
        let square = root * root;
        let slope = 4.0 * root * (square - first) - 8.0 * determinant;
        let step = (square * (square - 2.0 * first) - 8.0 * determinant * root + constant) / slope;
        steps += 1;
        if steps > MOST_STEPS || !step.is_finite() {
            return None;
        }
        root -= step;
        if step.abs() <= SHORT * root {
            break;
        }
    }
    let divisor = 0.5 * root * (root * root - first) - determinant;
    let is_sound = divisor > SOUND * root * root * root;
    let matrix = cofactors * root + a * (0.5 * (root * root + first)) - a * (a.transpose() * a);
    is_sound.then(|| DQuat::from_mat3(&(matrix * divisor.recip())).normalize())
}
