//! Single precision, for formats that have no other.

use glam::DVec3;

/// A number in single precision; numbers beyond its range become its greatest ones, as not every reader takes infinities.
pub(super) fn single(number: f64) -> f32 {
    number.clamp(f32::MIN.into(), f32::MAX.into()) as f32
}

/// A vector in single precision.
pub(super) fn singles(vector: DVec3) -> [f32; 3] {
    vector.to_array().map(single)
}
