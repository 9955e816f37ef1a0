//! The default: the optimal rotation for every input, at the cost of one short iteration where all is well.
//!
//! From the last rotation, passes of ninth order with the Hessian `H = tr(A) I − (A + Aᵀ)/2` of the energy. The
//! increment is the quaternion `(v, 1)`, up to its length, with `(2H + μ) v = g`, `μ = g·v` and `g = Σ R × r`: the
//! eigenvalue problem of [`davenport1968`](super::davenport1968), relative to the last rotation. With `v₀ = (2H)⁻¹ g`, `x = (2H)⁻¹ v₀`,
//! `y = (2H)⁻¹ x`, `z = (2H)⁻¹ y` and `m = g·v₀` the series for small `μ` are `μ = m (1 − |v₀|² + |v₀|⁴ + m v₀·x)` and
//! `v = v₀ − μ x + μ² y − μ³ z`, up to terms of ninth order in the angle. They diverge above 45°, where `|v₀| = ½`; there the pass
//! is `v₀ (1 + |v₀|²)/(1 + 2|v₀|²)`, within a tenth of the right angle for a cube turned by up to 63°.
//!
//! Guarantee: where `H` is positive definite at a point without torque, that point is the only maximum of
//! `tr(M Σ R0 rᵀ)`. So a pass is taken only where `H` is positive definite by a margin, and is the last only where it is
//! so short that the ninth power of its angle is far below round-off. In all other cases, which [`Followed::is_global`] reports,
//! the eigenvector is computed: the result is the true maximiser for every input, and the one nearest to the last
//! rotation where there are several. It is never NaN, and a unit quaternion to round-off.
//!
//! Cost: one division and one square root for each pass; one pass for increments up to 1/80 rad, two up to about 0.3.
//! `Optimum` in `sim/src/kernel/rotation.rs` is this method in lanes.

use super::{Followed, torque, trace};
use glam::{DMat3, DQuat, DVec3};

/// A pass is valid where `H` is positive definite and `det H` is at least this times `(tr H)³`; for a cube at rest the
/// ratio is 1/27.
pub(crate) const SOUND: f64 = 1e-5;

/// The series are used where `|v₀|²` is at most this.
pub(crate) const SERIES: f64 = 0.25;

/// A pass is the last where `|v₀|²` is at most this, times the margin `m = 27 det H / (tr H)³`.
///
/// `|v₀|` is half the angle, about. From an angle of `τ √m` a pass leaves an error of at most `0.06 τ⁹` (rad; the worst of
/// many, with m from 0.005 to 1), so after the last one it is less than 1e-18. It has to be far below round-off: in a
/// spinning body it has the same sign in every element and every step, and its torque adds up.
pub(crate) const SHORT: f64 = 4e-5;

/// The eigenvector is computed after so many passes. Most valid inputs converge in three.
pub(crate) const MOST_PASSES: u32 = 4;

/// The range of `(tr 2H)³` in which all intermediate results are normal numbers.
const RANGE: std::ops::Range<f64> = 1e-200..1e200;

/// The rotation that maximises `tr(M Σ R0 rᵀ)`, starting from the last one. `at_rest` is `Σ R0 rᵀ`.
pub fn follow(at_rest: DMat3, last: DQuat) -> Followed {
    let mut rotation = last;
    for _ in 0..MOST_PASSES {
        let Some((v, is_last)) = pass(DMat3::from_quat(rotation) * at_rest) else { break };
        rotation = (DQuat::from_xyzw(v.x, v.y, v.z, 1.0) * rotation).normalize();
        if is_last {
            return rotation.into();
        }
    }
    Followed::global(at_rest, rotation)
}

/// The vector part `v` of the increment `(v, 1)`, and whether this pass is the last; `None` where a pass is not valid.
fn pass(a: DMat3) -> Option<(DVec3, bool)> {
    // 2H and its adjugate, both symmetric.
    let twice = 2.0 * trace(a);
    let (hx, hy, hz) = (twice - 2.0 * a.x_axis.x, twice - 2.0 * a.y_axis.y, twice - 2.0 * a.z_axis.z);
    let (xy, xz, yz) = (-(a.x_axis.y + a.y_axis.x), -(a.x_axis.z + a.z_axis.x), -(a.y_axis.z + a.z_axis.y));
    let (axx, ayy, azz) = (hy * hz - yz * yz, hx * hz - xz * xz, hx * hy - xy * xy);
    let (axy, axz, ayz) = (xz * yz - xy * hz, xy * yz - xz * hy, xy * xz - yz * hx);
    let determinant = hx * axx + xy * axy + xz * axz;
    let sum = hx + hy + hz;
    let cube = sum * sum * sum;
    if !(hx > 0.0 && azz > 0.0 && determinant > SOUND * cube && RANGE.contains(&cube)) {
        return None;
    }
    let adjugate = DMat3::from_cols_array(&[axx, axy, axz, axy, ayy, ayz, axz, ayz, azz]);
    let inverse = adjugate * determinant.recip();
    let g = -torque(a);
    let v0 = inverse * g;
    let square = v0.length_squared();
    let is_last = square * cube <= 27.0 * SHORT * determinant;
    if square > SERIES {
        return Some((v0 * ((1.0 + square) / (1.0 + 2.0 * square)), is_last));
    }
    let x = inverse * v0;
    let y = inverse * x;
    let z = inverse * y;
    let m = g.dot(v0);
    let mu = m * (1.0 - square + square * square + m * v0.dot(x));
    Some((v0 - (x - (y - z * mu) * mu) * mu, is_last))
}
