//! `simulate`: numbers without pictures.

use super::failure::{Failure, Status};
use super::frames::Shard;
use super::options::{RunOptions, SceneOptions};
use super::record;
use super::sweep::Sweep;
use crate::scene::Scene;
use clap::Args;
use std::ffi::OsString;

const EXAMPLES: &str = "\
Examples:
  localshape simulate scenes/fig4b.toml
  localshape simulate scenes/fig4b.toml --states -o results
  localshape simulate scenes/*.toml --json > results.json
  localshape simulate scenes/fig4b.toml --sweep stiffness.csv    one folder for each line of the table
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

    /// Run only a share of the variants of a sweep: 2/4 the second one and every fourth one after it
    #[arg(long, value_name = "I/N", requires = "sweep")]
    shard: Option<Shard>,
}

impl Simulate {
    pub(super) fn run(self, words: &[OsString]) -> Result<Status, Failure> {
        let options = &self.options;
        if let Some(file) = &options.sweep {
            let check = |scene: &Scene| options.runs(scene).and_then(|_| options.frames(scene)).map(drop);
            let sweep = Sweep::read(file, &self.scenes, options, self.shard, check)?;
            let jobs = options.variants(&sweep, false, |_| {}, words)?;
            let status = record::run_all(jobs, options, words, false, None)?;
            return sweep.end(status, options.printing);
        }
        let jobs = options.jobs(self.scenes.load_all(options.printing.quiet)?, false, None, None, words)?;
        record::run_all(jobs.into_iter().map(Ok), options, words, false, None)
    }
}
