//! One mode of vibration of a body.

/// Stiffness and damping of a mode, divided by its mass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mode {
    /// `a` (1/s²), the square of the angular frequency without damping.
    pub stiffness: f64,
    /// `c` (1/s).
    pub damping: f64,
}

impl Mode {
    /// With more damping, of the masses (1/s): the same of all modes.
    pub(crate) fn damped_more(self, damping: f64) -> Self {
        Self { damping: self.damping + damping, ..self }
    }
}
