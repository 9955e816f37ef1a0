//! The paper's solver in space: Eq. (15), solved a fixed number of times, starting from the last rotation.

use super::{Followed, torque};
use glam::{DMat3, DQuat, DVec3};

/// Eq. (15): `(tr(A) I − A) w = Σ R × r`, the rotation vector that balances the torque to first order.
///
/// The matrix must be regular; see [`is_well_posed`].
#[doc(alias = "Eq. 15")]
pub fn solve(a: DMat3) -> DVec3 {
    cramer(columns(a), -torque(a))
}

/// The solution of three equations, given by the columns of their matrix, by Cramer's rule, as three triple products.
pub fn cramer([c0, c1, c2]: [DVec3; 3], right: DVec3) -> DVec3 {
    let c12 = c1.cross(c2);
    let determinant = c0.dot(c12);
    DVec3::new(right.dot(c12), c0.dot(right.cross(c2)), c0.dot(c1.cross(right))) / determinant
}

/// The determinant of Eq. (15)'s matrix.
pub(crate) fn determinant(a: DMat3) -> f64 {
    let [c0, c1, c2] = columns(a);
    c0.dot(c1.cross(c2))
}

/// The columns of `tr(A) I − A`, the matrix of Eq. (15).
pub fn columns(a: DMat3) -> [DVec3; 3] {
    let trace = a.x_axis.x + a.y_axis.y + a.z_axis.z;
    [DVec3::X * trace - a.x_axis, DVec3::Y * trace - a.y_axis, DVec3::Z * trace - a.z_axis]
}

/// The rotation with axis `u = w/|w|` and angle `θ = atan |w|`, which is Eq. (9) about that axis.
///
/// `tan(θ/2) = |w| / (1 + √(1 + w²))` gives a quaternion without trigonometric functions. It is not normalised.
#[doc(alias = "Eq. 10")]
pub fn rotation_by_arctangent(w: DVec3) -> DQuat {
    DQuat::from_xyzw(w.x, w.y, w.z, 1.0 + (1.0 + w.length_squared()).sqrt())
}

/// The rotation with axis `u = w/|w|` and angle `θ = |w|`, the other reading of the paper. It overshoots and can make a
/// free body spin faster and faster. For comparison only.
pub fn rotation_by_length(w: DVec3) -> DQuat {
    let angle = w.length();
    if angle == 0.0 {
        return DQuat::IDENTITY;
    }
    // With the same bits on every machine: this library uses basic arithmetic only.
    let (sine, cosine) = libm::sincos(0.5 * angle);
    let axis = w * (sine / angle);
    DQuat::from_xyzw(axis.x, axis.y, axis.z, cosine)
}

/// The least value of the leading minors of the Hessian that counts as positive, relative to the size of `A`.
///
/// Below it the three rows of Eq. (15) no longer determine an axis: corners on a line give zero up to round-off
/// (1e-16), corners in a plane 2 or more. The exact solver has no such limit, so the value selects the
/// method but hardly affects the result.
const WELL_POSED: f64 = 1e-9;

/// Whether Eq. (15) has one solution and it leads to the equilibrium: the Hessian `H = tr(A) I − (A + Aᵀ)/2` of the
/// element's energy is positive definite (its leading minors are positive).
///
/// Then the matrix of Eq. (15), whose symmetric part is `H`, is regular as well.
pub fn is_well_posed(a: DMat3) -> bool {
    let (xx, yy, zz) = (a.x_axis.x, a.y_axis.y, a.z_axis.z);
    let xy = -0.5 * (a.y_axis.x + a.x_axis.y);
    let xz = -0.5 * (a.z_axis.x + a.x_axis.z);
    let yz = -0.5 * (a.z_axis.y + a.y_axis.z);
    let (hx, hy, hz) = (yy + zz, xx + zz, xx + yy);
    let size = hx.abs() + hy.abs() + hz.abs() + xy.abs() + xz.abs() + yz.abs();
    let minor = hx * hy - xy * xy;
    let determinant = hx * (hy * hz - yz * yz) - xy * (xy * hz - yz * xz) + xz * (xy * yz - hy * xz);
    hx > WELL_POSED * size && minor > WELL_POSED * size * size && determinant > WELL_POSED * size * size * size
}

/// The rotation of an element from its last one: `passes` times Eq. (15), with each solution converted to a rotation
/// and accumulated (Eq. (10) instead of Eq. (16), whose result is not a rotation). `rotation_of` solves for `A` and
/// converts, such as `|a| rotation_by_arctangent(solve(a))`.
///
/// `at_rest` is `Σ R0 rᵀ`. Where Eq. (15) is not well posed (turned inside out, flattened to a line or a point, more
/// than a quarter turn away) the exact optimum nearest to `last` is used instead.
pub fn iterate(at_rest: DMat3, last: DQuat, passes: u32, rotation_of: impl Fn(DMat3) -> DQuat) -> Followed {
    let mut rotation = last;
    for _ in 0..passes {
        let a = DMat3::from_quat(rotation) * at_rest;
        if !is_well_posed(a) {
            return Followed::global(at_rest, rotation);
        }
        rotation = (rotation_of(a) * rotation).normalize();
    }
    rotation.into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rotation::{corners, moment};

    fn angle_error(true_turn: DQuat, found: DQuat) -> f64 {
        // 2 asin of the vector part: accurate for small angles, where acos of the scalar part is not.
        let difference = found * true_turn.inverse();
        2.0 * difference.xyz().length().min(1.0).asin()
    }

    /// How Eq. (15) is read as a rotation.
    type Reading = fn(DMat3) -> DQuat;
    const ARCTANGENT: Reading = |a| rotation_by_arctangent(solve(a));
    const LENGTH: Reading = |a| rotation_by_length(solve(a));

    /// The error of the rotation (rad) of a box that is turned by an angle (degrees), after some passes.
    fn error(sides: [f64; 3], axis: DVec3, degrees: f64, passes: u32, reading: Reading) -> f64 {
        let rest = corners(sides);
        let turned = DQuat::from_axis_angle(axis.normalize(), degrees.to_radians());
        let a = moment(&rest, rest.iter().map(|&r| turned * r));
        angle_error(turned, iterate(a, DQuat::IDENTITY, passes, reading).rotation)
    }

    /// The independent values are for another axis, so only magnitudes can agree. They tell the two readings, and the symmetric matrix
    /// (0.033, 1.9e-6, 1e-16 at 40°), apart.
    #[test]
    fn errors_after_each_pass_are_those_of_an_independent_implementation() {
        for (reading, degrees, independent) in [
            (ARCTANGENT, 10.0, [4.2e-3, 1.8e-6, 4e-13]),
            (ARCTANGENT, 40.0, [0.075, 5.7e-4, 5e-8]),
            (LENGTH, 10.0, [4.7e-3, 3.4e-6, 1e-12]),
            (LENGTH, 40.0, [0.16, 4.9e-3, 1e-6]),
        ] {
            for (passes, expected) in (1..).zip(independent) {
                let error = error([1.0, 0.7, 0.4], DVec3::new(1.0, 2.0, 3.0), degrees, passes, reading);
                // Each pass squares the error, so a factor in the first one is squared as well.
                let factor = 2f64.powi(1 << (passes - 1));
                assert!((expected / factor..expected * factor).contains(&error), "{degrees}°, {passes}: {error:e}");
            }
        }
        for (passes, expected) in [(1, 1.8e-3), (2, 1.9e-9)] {
            let error = error([1.0; 3], DVec3::Y, 10.0, passes, LENGTH);
            assert!((error / expected - 1.0).abs() < 0.05, "a cube, {passes}: {error:e}");
        }
    }

    /// The axis of turns that have no plane or axis in common with boxes.
    const OBLIQUE: DVec3 = DVec3::new(0.3, -0.5, 0.7);

    #[test]
    fn one_pass_is_exact_for_a_rigidly_turned_cube_below_a_quarter_turn() {
        for degrees in [1.0, 10.0, 45.0, 80.0, 89.0] {
            let error = error([1.0; 3], OBLIQUE, degrees, 1, ARCTANGENT);
            assert!(error < 1e-13, "{degrees}°: {error:e}");
        }
    }

    #[test]
    fn corners_nearly_on_a_line_are_where_the_exact_optimum_takes_over() {
        // The least minor of the Hessian is 2δ, of rows whose absolute entries sum to 2 + 4δ: the limit is at δ = 4e-9.
        let moments = |delta: f64| DMat3::from_diagonal(DVec3::new(1.0, delta, delta));
        for size in [1e-6, 1.0, 1e6] {
            assert!(is_well_posed(moments(4.01e-9) * size), "{size}");
            assert!(!is_well_posed(moments(3.99e-9) * size), "{size}");
        }
        let quarter = |degrees: f64| DMat3::from_rotation_z(degrees.to_radians()) * moments(1.0);
        assert!(is_well_posed(quarter(89.999)) && !is_well_posed(quarter(90.001)));
    }

    #[test]
    fn beyond_a_quarter_turn_the_exact_optimum_takes_over() {
        for degrees in [91.0, 120.0, 179.0, 180.0] {
            let error = error([1.0, 0.7, 0.4], OBLIQUE, degrees, 4, ARCTANGENT);
            assert!(error < 1e-9, "{degrees}°: {error:e}");
        }
    }

    #[test]
    fn a_printed_system_and_the_vector_form_agree() {
        // Eq. (15) written out as printed, against the matrix form.
        let rest = corners([1.0, 0.7, 0.4]);
        let now: Vec<_> =
            rest.iter().map(|r| DVec3::new(r.x * 1.1 + 0.2 * r.y, r.y - 0.1 * r.z, r.z + 0.3 * r.x)).collect();
        let sum =
            |f: &dyn Fn(DVec3, DVec3) -> f64| rest.iter().zip(&now).map(|(&big, &small)| f(big, small)).sum::<f64>();
        let (xx, yy, zz) = (sum(&|b, s| b.x * s.x), sum(&|b, s| b.y * s.y), sum(&|b, s| b.z * s.z));
        let rows = [
            DVec3::new(yy + zz, -sum(&|b, s| b.x * s.y), -sum(&|b, s| b.x * s.z)),
            DVec3::new(-sum(&|b, s| b.y * s.x), zz + xx, -sum(&|b, s| b.y * s.z)),
            DVec3::new(-sum(&|b, s| b.z * s.x), -sum(&|b, s| b.z * s.y), xx + yy),
        ];
        let right = DVec3::new(
            sum(&|b, s| b.y * s.z - b.z * s.y),
            sum(&|b, s| b.z * s.x - b.x * s.z),
            sum(&|b, s| b.x * s.y - b.y * s.x),
        );
        let w = solve(moment(&rest, now.iter().copied()));
        for (row, right) in rows.iter().zip(right.to_array()) {
            assert!((row.dot(w) - right).abs() < 1e-15);
        }
    }
}
