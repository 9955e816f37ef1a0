//! The simulation: double precision, no files, no clock, no device, and it cannot fail.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub(crate) mod alike;
pub(crate) mod apart;
pub(crate) mod body;
pub(crate) mod contact;
pub(crate) mod crew;
pub(crate) mod diagnose;
pub(crate) mod diagnostics;
mod dynamics;
pub(crate) mod element;
pub(crate) mod field;
mod gather;
pub(crate) mod grip;
pub(crate) mod hull;
pub(crate) mod inside;
pub(crate) mod integrate;
mod kernel;
mod lanes;
pub(crate) mod lists;
pub(crate) mod mode;
pub mod model;
pub(crate) mod motion;
pub(crate) mod part;
pub(crate) mod rotation;
pub(crate) mod sleep;
pub(crate) mod snapshot;
pub(crate) mod stability;
pub(crate) mod state;
pub(crate) mod system;
pub(crate) mod topology;
pub(crate) mod words;
pub(crate) mod world;

pub use body::Body;
pub use contact::{FrictionOf, Obstacle, Shape};
pub use crew::Crew;
pub use diagnostics::Diagnostic;
pub use element::{Dimension, ElementKind};
pub use field::Field;
pub use grip::Grip;
pub use integrate::Integrator;
pub(crate) use kernel::floor;
pub use lists::IndexLists;
pub use motion::{Ease, Key, Motion, Offset, Pose};
pub use sleep::Sleep;
pub use snapshot::{Diagnostics, Divergence, Frame, LastFit, Placement, RunFrame, Snapshot, Status};
pub use state::{Memory, Nodes, State};
pub use topology::{Elements, Faces, Springs};
pub use world::{Kernel, Moment, World};
