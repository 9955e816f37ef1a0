//! Compares pictures, and tells whether the simulation or its drawing changed.
//!
//! Frames have digests of their states. A golden, a folder with a few small pictures and a record of its scene, also
//! has rounded positions of nodes. So states are compared first, and then pixels.
//!
//! `Suite` tests scenes against goldens in `cargo test` (with the feature `render`).

#[cfg(feature = "render")]
mod accept;
mod comparison;
#[cfg(feature = "render")]
pub(crate) mod device;
#[cfg(feature = "render")]
pub(crate) mod draw;
#[cfg(feature = "render")]
pub(crate) mod drawing;
mod error;
#[cfg(feature = "render")]
mod folder;
mod keys;
pub(crate) mod page;
mod picture;
mod record;
#[cfg(feature = "render")]
mod said;
#[cfg(feature = "render")]
mod simulated;
mod source;
mod states;
#[cfg(feature = "render")]
mod suite;
mod tolerance;
mod verdict;

pub(crate) use comparison::Comparison;
pub(crate) use error::ComparisonError;
#[cfg(feature = "render")]
pub(crate) use folder::Golden;
#[cfg(feature = "render")]
pub(crate) use picture::PictureError;
#[doc(hidden)]
pub use picture::Pixels;
pub(crate) use record::is_record;
#[cfg(feature = "render")]
pub use suite::Suite;
#[cfg(feature = "render")]
#[doc(hidden)]
pub use {
    device::TestDevice,
    simulated::{Outcome, Simulated, Told},
};
