//! The simulation: double precision, no files, no clock, no device, and it cannot fail.

pub mod body;
pub mod contact;
pub mod integrate;
pub mod model;
pub mod rotation;
pub mod snapshot;
pub mod topology;
