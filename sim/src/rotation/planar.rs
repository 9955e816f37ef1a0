//! The rotation in the plane by Eq. (9), which is exact.

use glam::{DMat3, DVec2};

/// Eq. (9): `(cos θ, sin θ)` is proportional to `(Σ X x + Y y, Σ X y − Y x)`, which is the four-quadrant arctangent.
///
/// `at_rest` is `Σ R0 rᵀ`. If both sums are zero all angles are equally good, and `last` is returned.
#[doc(alias = "Eq. 9")]
pub(crate) fn solve(at_rest: DMat3, last: DVec2) -> DVec2 {
    let cosine = at_rest.x_axis.x + at_rest.y_axis.y;
    let sine = at_rest.y_axis.x - at_rest.x_axis.y;
    DVec2::new(cosine, sine).try_normalize().unwrap_or(last)
}

/// Eq. (8): the matrix of `(cos θ, sin θ)`, a rotation about the z-axis.
#[doc(alias = "Eq. 8")]
pub(crate) fn matrix(rotation: DVec2) -> DMat3 {
    let (cosine, sine) = (rotation.x, rotation.y);
    DMat3::from_cols_array(&[cosine, sine, 0.0, -sine, cosine, 0.0, 0.0, 0.0, 1.0])
}
