//! Deformable bodies that keep their local shapes (Miyazaki et al.), beside mass-spring models, for your own engine.
//!
//! A [`Body`] has nodes, masses and elements at rest. A [`World`] moves it by a model of [`model`] and a method of
//! [`integrate`], among [`Obstacle`]s, [`Grip`]s and forces, which may change between steps. Read positions from [`World::state`], or a
//! [`Snapshot`] with diagnostics.
//! Numbers are in SI units and double precision, with the same bits on every machine and for any number of threads. A world that
//! diverges stops and reports it as its [`Status`]. The crate uses no files, no clock and no device.
//!
//! ```
#![doc = include_str!("../examples/own_engine.rs")]
//! ```
//!
//! # Features
//!
//! `scene`: models as scene files have them, with their schema, and states and results that serde writes and reads.
//!
//! # Debug builds
//!
//! Optimise this crate in debug builds, too: `[profile.dev.package.localshape-sim]` with `opt-level = 1`. Otherwise steps are slow, and
//! with AVX-512 one frame of a kernel fills most of the stack of a thread.
//!
//! Eq. (15), the rotation of an element, is in [`rotation::linearised`]; Eq. (4), its forces, in [`model::shape_based`].

#![cfg_attr(not(test), warn(clippy::disallowed_methods, clippy::disallowed_types))]
#![warn(clippy::print_stdout, clippy::print_stderr)]

mod alike;
mod assembly;
mod body;
mod broken;
mod carried;
mod contact;
mod crew;
mod diagnose;
mod diagnostics;
mod dynamics;
mod element;
mod field;
mod fill;
mod gather;
pub mod geometry;
mod grip;
mod hull;
pub mod integrate;
mod kernel;
mod lanes;
mod law;
mod limit;
mod lists;
mod load;
mod material;
mod mode;
pub mod model;
mod motion;
mod new_body;
mod noise;
mod part;
mod placement;
mod recording;
mod rest;
pub mod rotation;
mod snapshot;
pub mod stability;
mod state;
mod surroundings;
mod system;
mod tally;
mod topology;
mod volume;
mod work;
mod world;

pub use assembly::Assembly;
pub use body::Body;
pub use carried::{Carried, Weights};
pub use contact::{
    BodyContact, Contact, ContactPoint, Contacts, FrictionOf, Obstacle, Overlap, PairContact, Placed, Reaction, Shape,
    Side, Source, Surfaces,
};
pub use crew::Crew;
pub use diagnostics::{Chosen, Diagnostic, Diagnostics, Scope, Value};
pub use element::{Dimension, ElementKind, Solids, around};
pub use field::{Field, Support};
pub use grip::Grip;
pub use integrate::Integrator;
pub use kernel::peak;
pub use lanes::vectors;
pub use lists::IndexLists;
pub use load::{Course, Load, Loading, Pull, Turning, for_each_area};
pub use material::Material;
pub use motion::{Ease, Key, Motion, Offset, Path, Pose};
pub use new_body::{BodyError, NewBody};
pub use placement::Placement;
pub use recording::Recording;
pub use rest::{Equilibrium, NoEquilibrium, equilibrium};
pub use snapshot::Snapshot;
pub use state::{Divergence, Memory, Nodes, State, Status, Unsolved};
pub use surroundings::{Surroundings, WrongSurroundings};
pub use topology::{Elements, Faces, Springs};
pub use world::{Kernel, Moment, Stepping, World};
