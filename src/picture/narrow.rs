//! Narrowing from double to single precision; nowhere else in `picture`.

use glam::{DVec3, DVec4, Mat4, Vec3};

/// The largest coordinate of a picture: far outside of any panel, but products of four coordinates are finite.
const FARTHEST: f64 = 1e6;

/// Rounds to single precision. NaN becomes 0, and huge values are clamped, so that a diverged run can be drawn like any
/// other.
#[expect(clippy::cast_possible_truncation, reason = "narrowing is the purpose of this function")]
pub(super) fn narrow(value: f64) -> f32 {
    if value.abs() <= FARTHEST {
        value as f32
    } else if value.is_nan() {
        0.0
    } else {
        FARTHEST.copysign(value) as f32
    }
}

/// A whole number.
pub(super) fn narrow_count(count: usize) -> f32 {
    narrow(count as f64)
}

/// A point or direction of three narrowed coordinates.
pub(super) fn narrow_point(point: DVec3) -> Vec3 {
    Vec3::new(narrow(point.x), narrow(point.y), narrow(point.z))
}

/// A matrix of rows. Its numbers may be much larger than coordinates, so that distant objects and the strongest lenses
/// are not distorted.
#[expect(clippy::cast_possible_truncation, reason = "the numbers are kept in range")]
pub(super) fn narrow_rows(rows: [DVec4; 4]) -> Mat4 {
    const LARGEST: f64 = 1e15;
    let one = |value: f64| if value.is_nan() { 0.0 } else { value.clamp(-LARGEST, LARGEST) as f32 };
    Mat4::from_cols_array_2d(&rows.map(|row| row.to_array().map(one))).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_comes_in_a_finite_number_comes_out() {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 5e-324] {
            assert!(narrow(value).is_finite(), "{value}");
        }
        assert_eq!(narrow(0.1), 0.1_f32);
    }
}
