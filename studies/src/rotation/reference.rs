//! Rotations of higher precision than any solver's, and solvers from libraries.

use glam::{DMat3, DQuat, DVec3};

/// The optimal rotation by the singular value decomposition of a library: `M = U diag(1, 1, ±1) Vᵀ` for
/// `Σ r R0ᵀ = U S Vᵀ`, with the sign that makes it a rotation (W. Kabsch, Acta Cryst. A 32, 1976, p. 922; K. Arun et al.,
/// IEEE PAMI 9(5), 1987, p. 698). `at_rest` is `Σ R0 rᵀ`. `None` if the library does not converge.
pub(super) fn by_svd(at_rest: DMat3) -> Option<DQuat> {
    let a = nalgebra::Matrix3::from_column_slice(&at_rest.transpose().to_cols_array());
    let svd = a.try_svd(true, true, f64::EPSILON, 1000)?;
    let (u, v) = (svd.u?, svd.v_t?);
    // The smallest singular value, which is the last one, gets the sign.
    let sign = nalgebra::Vector3::new(1.0, 1.0, (u * v).determinant().signum());
    let matrix = u * nalgebra::Matrix3::from_diagonal(&sign) * v;
    let rotation = DQuat::from_mat3(&DMat3::from_cols_slice(matrix.as_slice()));
    rotation.is_finite().then(|| rotation.normalize())
}

/// The optimal rotation, rounded once, if the optimum is unique.
///
/// Newton's method from a rotation near it, with the torque in twice the precision. The remaining error is the rounding
/// of the quaternion (1e-16). Errors of solvers in plain precision are this divided by the gap of the singular values.
pub(super) fn refined(at_rest: DMat3, near: DQuat) -> DQuat {
    let mut rotation = near;
    for _ in 0..8 {
        let a = DMat3::from_quat(rotation) * at_rest;
        let symmetric = (a + a.transpose()) * 0.5;
        let trace = a.x_axis.x + a.y_axis.y + a.z_axis.z;
        let hessian = DMat3::from_diagonal(DVec3::splat(trace)) - symmetric;
        let w = hessian.inverse() * (-torque(at_rest, rotation) / rotation.length_squared());
        let next = (DQuat::from_xyzw(w.x, w.y, w.z, 2.0) * rotation).normalize();
        if !next.is_finite() || next == rotation {
            break;
        }
        rotation = next;
    }
    rotation
}

/// `|q|² Σ r × R` for a nearly unit quaternion, correct to the last digits even if all of it cancels.
fn torque(at_rest: DMat3, q: DQuat) -> DVec3 {
    let DQuat { x, y, z, w } = q;
    let two = |a: f64, b: f64, c: f64, d: f64| Double::product(2.0 * a, b).plus(Double::product(2.0 * c, d));
    let square = |sign: [f64; 3]| {
        let squares = [x, y, z].into_iter().zip(sign).map(|(part, sign)| Double::product(sign * part, part));
        squares.fold(Double::product(w, w), Double::plus)
    };
    // The rows of the matrix of `q`, times |q|².
    let rows = [
        [square([1.0, -1.0, -1.0]), two(x, y, -z, w), two(x, z, y, w)],
        [two(x, y, z, w), square([-1.0, 1.0, -1.0]), two(y, z, -x, w)],
        [two(x, z, -y, w), two(y, z, x, w), square([-1.0, -1.0, 1.0])],
    ];
    let entry = |row: usize, column: usize| {
        let products = rows[row].iter().zip(at_rest.col(column).to_array());
        products.fold(Double(0.0, 0.0), |sum, (one, other)| sum.plus(one.times(other)))
    };
    let difference = |one: Double, other: Double| one.plus(Double(-other.0, -other.1)).0;
    DVec3::new(
        difference(entry(2, 1), entry(1, 2)),
        difference(entry(0, 2), entry(2, 0)),
        difference(entry(1, 0), entry(0, 1)),
    )
}

/// The sum of two doubles. The second is below the last digit of the first: T. Dekker, "A floating-point
/// technique for extending the available precision", Numer. Math. 18, 1971, p. 224.
#[derive(Clone, Copy)]
struct Double(f64, f64);

impl Double {
    fn product(a: f64, b: f64) -> Self {
        let product = a * b;
        Self(product, f64::mul_add(a, b, -product))
    }

    fn plus(self, other: Self) -> Self {
        let sum = self.0 + other.0;
        let part = sum - self.0;
        let rest = (self.0 - (sum - part)) + (other.0 - part) + self.1 + other.1;
        let whole = sum + rest;
        Self(whole, rest - (whole - sum))
    }

    fn times(self, factor: f64) -> Self {
        let Self(product, rest) = Self::product(self.0, factor);
        let rest = rest + self.1 * factor;
        let whole = product + rest;
        Self(whole, rest - (whole - product))
    }
}

/// The angle between two rotations (rad), accurate also if it is small.
pub(super) fn angle(one: DQuat, other: DQuat) -> f64 {
    let difference = one * other.conjugate();
    2.0 * libm::atan2(difference.xyz().length(), difference.w.abs())
}

#[cfg(test)]
#[path = "../../tests/inside/rotation_reference.rs"]
mod tests;
