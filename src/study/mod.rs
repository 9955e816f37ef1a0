//! Measurements, which a command writes down as tables and plots: errors against computation time on this machine, limits
//! of stability, and robustness.
//!
//! As in [`table`](crate::table), a measurement reports its progress to a callback that may stop it, and depends neither
//! on files nor on the command line nor on drawing. Clocks are here, and not in [`sim`](crate::sim).

pub(crate) mod rotation;
pub(crate) mod stability;
pub(crate) mod stress;
pub(crate) mod work_precision;
