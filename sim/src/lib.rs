//! The simulation: double precision, no files, no clock, no device, and it cannot fail.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod alike;
mod body;
mod contact;
mod crew;
mod diagnose;
mod diagnostics;
mod dynamics;
mod element;
mod field;
mod gather;
pub mod geometry;
mod grip;
mod hull;
pub mod integrate;
mod kernel;
mod lanes;
mod lists;
mod mode;
pub mod model;
mod motion;
mod part;
pub mod rotation;
mod snapshot;
pub mod stability;
mod state;
mod system;
mod topology;
pub mod words;
mod world;

pub use body::Body;
pub use contact::{Contact, FrictionOf, Obstacle, Placed, Shape};
pub use crew::Crew;
pub use diagnostics::{Chosen, Diagnostic, Diagnostics, Reach, Value};
pub use element::{Dimension, ElementKind, Solids};
pub use field::{Field, Support};
pub use grip::Grip;
pub use integrate::Integrator;
/// Measurements of the processor for benchmarks.
#[doc(hidden)]
pub use kernel::floor;
pub use lanes::vectors;
pub use lists::IndexLists;
pub use motion::{Ease, Key, Motion, Offset, Pose};
pub use snapshot::{Divergence, Frame, LastFit, Placement, RunFrame, Snapshot, Status};
pub use state::{Memory, Nodes, State};
pub use system::Surroundings;
pub use topology::{Elements, Faces, Springs};
pub use world::{Kernel, Moment, Stepping, World};
