//! The simulation: double precision, no files, no clock, no device, and it cannot fail.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod body;
pub mod census;
pub mod contact;
pub mod diagnose;
pub mod field;
pub mod grip;
pub mod hull;
pub mod integrate;
#[cfg_attr(not(test), expect(dead_code, unused_imports, reason = "no simulation steps by it yet"))]
mod kernel;
pub mod lists;
pub mod model;
pub mod motion;
pub mod rotation;
pub mod snapshot;
pub mod topology;
pub mod words;
pub mod world;

pub use body::{Body, State};
pub use snapshot::{Frame, Snapshot};
pub use world::World;
