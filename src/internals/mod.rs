//! Functions for the program, the benchmarks and the tests that run the program. They may change at any time.

pub use crate::cli::{Failure, Status, ThreadOptions, listen, print, requested, run};
#[cfg(feature = "render")]
pub use crate::cli::{animate, check_animation, doubts, settle, unprintable, width_to_set};
pub use crate::colour::{ciede2000, lab, linear};
pub use crate::golden::Pixels;
pub use crate::golden::page::{Listed, Page, PicturePair, index};
#[cfg(feature = "render")]
pub use crate::golden::{Outcome, Simulated, TestDevice, Told};
pub use crate::output::{
    Clock, Compression, Shown, Spent, Tags, Timings, encode, encode_print, exact, is_folder, read_file, read_tags,
    rows_as_csv, shell::line as command_line, thread_time, write_whole,
};
pub use crate::reading::captions::typed;
pub use crate::scene::generate::random::unit as random_unit;
pub use crate::sim::peak::{lanes, limit_lanes, multiply_adds};
mod skipped;
pub mod untrusted;

pub use skipped::skipped;
