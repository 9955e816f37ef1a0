//! `simulate`: numbers without pictures.

use super::failure::{Failure, Status};
use super::options::{RunOptions, SceneOptions};
use super::record;
use clap::Args;
use std::ffi::OsString;

const EXAMPLES: &str = "\
Examples:
  localshape simulate scenes/fig4b.toml
  localshape simulate scenes/fig4b.toml --states -o results
  localshape simulate scenes/*.toml --json > results.json

The folder then holds diagnostics.csv (energies, momenta, turned-over elements and more, for each run and frame), \
run.json (what was run, how it went, and which files it wrote) and, with --states, states.npz. A run that diverges is a result, not an error.

output/NAME follows its scene file: what an earlier version of that file made there is replaced. A folder named with -o, \
and one with results of another scene, is left as it is unless --overwrite is given.";

/// Simulate scenes without drawing them; touches no graphics device
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Simulate {
    #[command(flatten)]
    scenes: SceneOptions,
    #[command(flatten)]
    options: RunOptions,
}

impl Simulate {
    pub(super) fn run(self, words: &[OsString]) -> Result<Status, Failure> {
        let jobs = self.options.jobs(self.scenes.load_all(self.options.telling.quiet)?, false, words)?;
        record::run_all(jobs, &self.options, words, false, None)
    }
}
