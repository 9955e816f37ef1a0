//! Runs that were computed elsewhere: positions and velocities over time, in a file beside the scene; and the stored states
//! of an earlier simulation, which are drawn instead of simulating.
//!
//! Rows of the file are read when they are shown, so memory does not grow with the recording.

mod archive;
mod course;
mod flaw;
mod recorded;
mod rows;

pub(crate) use archive::Archive;
pub(super) use archive::full;
pub(crate) use course::{COURSE, Course, Origin, StoredRun};
pub(crate) use flaw::Flaw;
pub(super) use flaw::check_length;
pub use recorded::Recorded;
pub(super) use rows::Axes;
