//! Vectorised steps. The plain code of [`model`](super::model) and [`integrate`](super::integrate) is their reference.

pub(in crate::sim) mod general;
mod lanes;
mod memory;
mod motion;
mod rotation;
pub(in crate::sim) mod springs;
