//! The simulation: double precision, no files, no clock, no device, and it cannot fail.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod alike;
pub mod apart;
pub mod body;
pub mod contact;
pub mod crew;
pub mod diagnose;
pub mod diagnostics;
pub mod dynamics;
pub mod element;
pub mod field;
mod gather;
pub mod grip;
pub mod hull;
pub mod inside;
pub mod integrate;
mod kernel;
mod lanes;
pub mod lists;
pub mod mode;
pub mod model;
pub mod motion;
pub mod part;
pub mod rotation;
pub mod snapshot;
pub mod stability;
pub mod state;
pub mod system;
pub mod topology;
pub mod words;
pub mod world;

pub use body::Body;
pub use contact::{FrictionOf, Obstacle, Shape};
pub use crew::Crew;
pub use diagnostics::Diagnostic;
pub use element::{Dimension, ElementKind};
pub use field::Field;
pub use grip::Grip;
pub use integrate::Integrator;
/// Measurements of the processor for benchmarks.
#[doc(hidden)]
pub use kernel::floor;
pub use lanes::vectors;
pub use lists::IndexLists;
pub use motion::{Ease, Key, Motion, Offset, Pose};
pub use snapshot::{Diagnostics, Divergence, Frame, LastFit, Placement, RunFrame, Snapshot, Status};
pub use state::{Memory, Nodes, State};
pub use topology::{Elements, Faces, Springs};
pub use world::{Kernel, Moment, World};
