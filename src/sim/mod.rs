//! The simulation: double precision, no files, no clock, no device, and it cannot fail.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod alike;
pub mod body;
pub mod contact;
pub mod crew;
pub mod diagnose;
pub mod diagnostics;
mod dynamics;
pub mod element;
pub mod field;
pub mod grip;
pub mod hull;
pub mod integrate;
mod kernel;
pub mod lists;
pub mod model;
pub mod motion;
pub mod part;
pub mod rotation;
pub mod snapshot;
pub mod state;
pub mod system;
pub mod topology;
pub mod words;
pub mod world;

pub use body::Body;
pub use kernel::floor;
pub use snapshot::{Frame, Snapshot};
pub use state::State;
pub use world::World;
