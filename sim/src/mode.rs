//! One mode of vibration of a body.

/// Stiffness and damping of a mode, divided by its mass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mode {
    /// `a` (1/s²), the square of the angular frequency without damping.
    pub stiffness: f64,
    /// `c` (1/s).
    pub damping: f64,
}
