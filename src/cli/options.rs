//! Options that several commands share.

use super::frames::FrameRanges;
use clap::{Args, ValueHint};
use std::path::PathBuf;

/// What is run.
#[derive(Args, Clone, Debug)]
pub(super) struct SceneOptions {
    /// Scene files (TOML); all are read and checked before the first is run
    #[arg(value_name = "SCENE", required = true, value_hint = ValueHint::FilePath)]
    pub(super) scenes: Vec<PathBuf>,

    /// Accept scenes beyond the limits that guard against typing errors, as far as memory permits and up to 4294967295 nodes
    /// or elements
    #[arg(long)]
    pub(super) allow_large: bool,
}

/// Which part of it, and where the results go.
#[derive(Args, Clone, Debug)]
pub(super) struct RunOptions {
    /// Output folder [default: output/NAME, with NAME from the scene file]; with several scenes, the folder that
    /// holds one folder NAME for each
    #[arg(short, long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(super) out: Option<PathBuf>,

    /// Replace files in the output folder that belong to another scene, size or choice of runs, or, in a folder given with
    /// -o, to an earlier version of the scene file
    #[arg(long)]
    pub(super) overwrite: bool,

    /// Frames to make, inclusive: 0-119, every third as 0-119x3, or 5,9,40-60 [default: all]
    #[arg(long, value_name = "RANGE", allow_hyphen_values = true)]
    pub(super) frames: Option<FrameRanges>,

    /// Only this run of the scene; can be repeated [default: all]
    #[arg(long, value_name = "RUN")]
    pub(super) only: Vec<String>,

    /// Also write positions and velocities of every frame to states.npz, for numpy.load: `time`, `RUN.position` and
    /// `RUN.velocity` for each run, and `RUN.time` for a run with its own time step
    #[arg(long)]
    pub(super) states: bool,

    /// Number of threads, which does not change the results [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,

    /// Print errors only, neither progress nor summary
    #[arg(short, long)]
    pub(super) quiet: bool,

    /// Print the summary as one JSON document
    #[arg(long, conflicts_with = "quiet")]
    pub(super) json: bool,
}

impl RunOptions {
    /// How many threads to work with.
    pub(super) fn threads(&self) -> usize {
        self.threads.map_or_else(processors, usize::from)
    }
}

/// How many threads run at the same time on this machine.
pub(super) fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
