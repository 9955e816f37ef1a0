//! Newton's method for the torque: Eq. (15) with the symmetric part of its matrix, `H w = Σ R × r` with
//! `H = tr(A) I − (A + Aᵀ)/2` and `A = Σ R rᵀ`, and ways to turn `w` into a rotation. `H` is the Hessian of the element's energy.
//!
//! Guarantee: cubic convergence near the optimum; fifth order for [`quintic`]. All but [`kugelstadt`] switch to the
//! optimum if `H` is not positive definite.

use glam::{DMat3, DQuat, DVec3};
use localshape::sim::rotation::linearised::{columns, cramer, iterate, rotation_by_arctangent};
use localshape::sim::rotation::torque;

/// By the angle `atan |w|`, as the paper's solver.
pub(super) fn symmetric(at_rest: DMat3, last: DQuat, passes: u32) -> DQuat {
    iterate(at_rest, last, passes, |a| rotation_by_arctangent(solve(a))).rotation
}

/// By the angle `2 atan(|w|/2)`, whose matrix is Cayley's transform of `[w]×/2`. It needs no root.
pub(super) fn cayley(at_rest: DMat3, last: DQuat, passes: u32) -> DQuat {
    let rotation = |w: DVec3| DQuat::from_xyzw(w.x, w.y, w.z, 2.0);
    iterate(at_rest, last, passes, |a| rotation(solve(a))).rotation
}

/// With `v₀ = (2H)⁻¹ g` and `g = Σ R × r`, by the quaternion `(v, 1)` of the vector part `v = v₀ − (g·v₀) (2H)⁻¹ v₀`, whose first
/// term is [`cayley`]: Davenport's eigenvalue problem to the next order.
pub(super) fn quintic(at_rest: DMat3, last: DQuat, passes: u32) -> DQuat {
    let increment = |a: DMat3| {
        let hessian = columns(a + a.transpose());
        let g = -torque(a);
        let first = cramer(hessian, g);
        let v = first - cramer(hessian, first) * g.dot(first);
        DQuat::from_xyzw(v.x, v.y, v.z, 1.0)
    };
    iterate(at_rest, last, passes, increment).rotation
}

/// The least determinant of `H` that counts as regular, for stretches of about 1.
const SINGULAR: f64 = 1e-9;

/// The analytic polar decomposition of T. Kugelstadt, D. Koschier, J. Bender, "Fast corotated FEM using operator
/// splitting", Computer Graphics Forum 37(8), 2018, p. 149, Algorithm 3: by the angle `4 atan(|w|/4)`. If the step
/// would go uphill, a step of steepest ascent replaces it. So it cannot settle on a minimum, but may need many passes.
/// At a half turn the torque is zero, and the rotation stays there.
pub(super) fn kugelstadt(at_rest: DMat3, last: DQuat, passes: u32) -> DQuat {
    // Stretches are scaled to about 1, as steps of steepest ascent require.
    let squares: f64 = at_rest.to_cols_array().iter().map(|entry| entry * entry).sum();
    let scaled = at_rest * (squares / 3.0).sqrt().recip();
    if !scaled.is_finite() {
        return last;
    }
    let increment = |a: DMat3| {
        let uphill = -torque(a);
        let [c0, c1, c2] = hessian(a);
        let is_singular = c0.dot(c1.cross(c2)).abs() < SINGULAR;
        let mut quarter = if is_singular { uphill } else { solve(a) * 0.25 };
        if quarter.dot(uphill) < 0.0 {
            quarter = uphill * 0.125;
        }
        let DVec3 { x, y, z } = quarter * 2.0;
        DQuat::from_xyzw(x, y, z, 1.0 - quarter.length_squared())
    };
    let pass = |rotation: DQuat, _| (increment(DMat3::from_quat(rotation) * scaled) * rotation).normalize();
    (0..passes).fold(last, pass)
}

/// The solution `w` of `H w = Σ R × r`.
fn solve(a: DMat3) -> DVec3 {
    cramer(hessian(a), -torque(a))
}

/// The columns of `H`.
fn hessian(a: DMat3) -> [DVec3; 3] {
    columns((a + a.transpose()) * 0.5)
}

#[cfg(test)]
#[path = "../../tests/inside/rotation_newton.rs"]
mod tests;
