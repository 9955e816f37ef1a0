//! Vectorised steps. The plain code of [`model`](super::model) and [`integrate`](super::integrate) is their reference.

mod lanes;
mod rotation;
