//! The rotation by relaxation of M. Müller, J. Bender, N. Chentanez, M. Macklin, "A robust method to extract the
//! rotational part of deformations", Motion in Games 2016, p. 55.
//!
//! Each pass rotates by `w = Σ R × r / |Σ R · r|`, a vector whose length is the angle. Guarantee: none of accuracy, as
//! it converges linearly, at a rate that depends on the strain (one pass is exact to third order for a rigid rotation
//! only); it never divides by zero and needs no inverse. Cost: one sine and cosine for each pass.

use glam::{DMat3, DQuat};
use localshape::sim::rotation::linearised::rotation_by_length;
use localshape::sim::rotation::torque;

/// Added to the divisor, relative to the size of the moments. The paper adds 1e-9 to moments of about 1.
const LEAST: f64 = 1e-9;

/// The rotation after a number of passes.
pub(super) fn relax(at_rest: DMat3, last: DQuat, passes: u32) -> DQuat {
    let least = LEAST * at_rest.to_cols_array().iter().map(|entry| entry.abs()).sum::<f64>();
    let mut rotation = last;
    for _ in 0..passes {
        let a = DMat3::from_quat(rotation) * at_rest;
        let divisor = (a.x_axis.x + a.y_axis.y + a.z_axis.z).abs() + least;
        let w = -torque(a) / divisor;
        // All corners at a point, or no numbers at all.
        if !w.is_finite() {
            break;
        }
        rotation = (rotation_by_length(w) * rotation).normalize();
    }
    rotation
}
