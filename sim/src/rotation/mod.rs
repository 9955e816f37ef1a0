//! The rotation of an element (paper, Eqs. 6–16): pure functions of one 3×3 matrix of moments.
//!
//! | symbol | meaning |
//! |---|---|
//! | `R0` | corners at rest, relative to their mean (m) |
//! | `r` | corners now, relative to their mean (m) |
//! | `M` | the rotation sought; `R = M R0` is the equilibrium shape |
//! | `A` | `Σ R rᵀ` (m²), the moments in Eq. (15) |
//! | `w` | `θ u`, axis times angle (rad) |
//!
//! Rotating the equilibrium shape by `L` turns `A` into `L A`, so the corners are read only once for any number of
//! passes. Except for [`linearised::rotation_by_length`], for comparison, no function here uses a sine, a cosine or an arctangent: square
//! roots and divisions are rounded identically on every machine.
//!
//! All methods in space are behind [`RotationReading::follow`]. The program `localshape-study rotation` measures their errors and
//! their cost; `docs/accuracy.md` has the results, and why [`robust`] is the default.

pub mod davenport1968;
pub mod linear_update;
pub mod linearised;
pub(crate) mod planar;
mod reading;
pub mod robust;

pub use reading::RotationReading;

use super::element::Dimension;
use glam::{DMat3, DQuat, DVec2, DVec3};

/// A rotation that a method has found, and whether it needed the [global solver](davenport1968).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Followed {
    /// The rotation.
    pub rotation: DQuat,
    /// Whether the global solver computed it.
    pub is_global: bool,
}

impl Followed {
    /// The optimum nearest to the `last` rotation, by the global solver. `at_rest` is `Σ R0 rᵀ` (m²).
    fn global(at_rest: DMat3, last: DQuat) -> Self {
        Self { rotation: davenport1968::optimum(at_rest, last), is_global: true }
    }
}

impl From<DQuat> for Followed {
    /// Found without the global solver.
    fn from(rotation: DQuat) -> Self {
        Self { rotation, is_global: false }
    }
}

/// `A = Σ R rᵀ` of an element: `shape` has its equilibrium (or rest) corners, `now` its present ones (m), both relative
/// to their own mean.
pub fn moment(shape: &[DVec3], now: impl IntoIterator<Item = DVec3>) -> DMat3 {
    let mut a = DMat3::ZERO;
    for (shape, now) in shape.iter().zip(now) {
        a.x_axis += *shape * now.x;
        a.y_axis += *shape * now.y;
        a.z_axis += *shape * now.z;
    }
    a
}

/// The rotation that minimises `Σ |r − M R0|²`, exactly, for `at_rest` = `Σ R0 rᵀ`; if there are several, the one
/// nearest to the identity.
pub(crate) fn best(dimension: Dimension, at_rest: DMat3) -> DMat3 {
    match dimension {
        Dimension::Plane => planar::matrix(planar::solve(at_rest, DVec2::X)),
        Dimension::Space => DMat3::from_quat(davenport1968::optimum(at_rest, DQuat::IDENTITY)),
    }
}

/// The corners of a box about the origin with these sides (m).
#[cfg(test)]
fn corners(sides: [f64; 3]) -> Vec<DVec3> {
    let share = |corner: u32| DVec3::from_array([0, 1, 2].map(|axis| f64::from(corner >> axis & 1) - 0.5));
    (0..8).map(|corner| DVec3::from(sides) * share(corner)).collect()
}

/// `tr A`.
fn trace(a: DMat3) -> f64 {
    a.x_axis.x + a.y_axis.y + a.z_axis.z
}

/// The sum of the absolute values of all entries.
fn size(a: DMat3) -> f64 {
    a.to_cols_array().iter().fold(0.0, |size: f64, entry| size + entry.abs())
}

/// Eq. (5): `Σ r × R`, the torque of the elastic forces over `k` (m²). It is zero at an equilibrium shape.
#[doc(alias = "Eq. 5")]
pub fn torque(a: DMat3) -> DVec3 {
    // A[i][j] = Σ R_i r_j; glam stores columns: a.y_axis.z is row z, column y.
    DVec3::new(a.y_axis.z - a.z_axis.y, a.z_axis.x - a.x_axis.z, a.x_axis.y - a.y_axis.x)
}
