//! `simulate`: numbers without pictures.

use super::failure::{Failure, Status};
use super::options::{RunOptions, SceneOptions};
use super::record;
use super::scenes::Wish;
use clap::Args;
use std::ffi::OsString;

const EXAMPLES: &str = "\
Examples:
  localshape simulate scenes/fig4b.toml
  localshape simulate scenes/fig4b.toml --states -o results
  localshape simulate scenes/*.toml --json > results.json
  localshape simulate scenes/fig4b.toml --set 'run[0].model.stiffness=1e5' -o stiff    with another value in the scene
  localshape render scenes/fig4b.toml --from-states results/states.npz -o pictures   draws the states of the second example

The folder then has diagnostics.csv (energies, momenta, turned-over elements and more, for each run and frame), run.json \
(command, outcome and files) and, with --states, states.npz. A run that diverges is a result, not an error.

A folder belongs to one scene: results of another one are replaced only with --overwrite. output/NAME follows its scene file, so that \
results of another version of that file are replaced.";

/// Simulate scenes without drawing them; needs no graphics adapter
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
        let options = &self.options;
        options.threads.start()?;
        let jobs = options.jobs(self.scenes.load_all(options.printing.quiet)?, Wish::default(), words)?;
        record::run_all(jobs, options, &self.scenes.set, words, false, None)
    }
}
