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
  localshape simulate scenes/fig4b.toml --set run[0].model.stiffness=1e5 -o stiff    with another value in the scene
  localshape render scenes/fig4b.toml --from-states results/states.npz -o pictures   draws what the second one simulated

The folder then has diagnostics.csv (energies, momenta, turned-over elements and more, for each run and frame), run.json \
(command, outcome and files) and, with --states, states.npz. A run that diverges is a result, not an error.

Results in output/NAME of an earlier version of the scene file are replaced. With -o, results of \
another scene, or of another version of it, are replaced only with --overwrite, as are tables of the same scene with frames, \
runs or states that the command does not make, and checkpoints without --resume.";

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
        let jobs = options.jobs(self.scenes.load_all(options.printing.quiet)?, false, None, None, words)?;
        record::run_all(jobs, options, &self.scenes.set, words, false, None)
    }
}
