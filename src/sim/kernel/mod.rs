//! Vectorised steps. The plain code of [`model`](super::model) and [`integrate`](super::integrate) is their reference.

mod lanes;
mod memory;
mod motion;
pub(in crate::sim) mod springs;
