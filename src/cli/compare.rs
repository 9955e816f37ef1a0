//! `compare`: what differs between pictures, and whether physics or drawing moved.

use super::console;
use super::failure::{Failure, Status, with_causes};
use crate::golden::{Comparison, ComparisonError};
use clap::{Args, ValueHint};
use serde_json::json;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  localshape compare expected.png actual.png
  localshape compare golden/ output/fig4b/       all pictures of both folders, by name
  localshape compare golden/ output/fig4b/ --json

Frames know which states they show: so a difference is either of the state (`state moved`) or of the drawing (`same \
state, drawn differently`). Pictures drawn by one adapter must be equal in every byte; those of two may differ by more \
than 2 of 255 in at most 0.01 % of their pixels, or in 8. Pictures that were not drawn by this program have no state, and \
pixels alone are compared.";

/// Compare two pictures or two folders of frames
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Compare {
    /// A picture, or a folder of pictures: what was expected
    #[arg(value_name = "EXPECTED", value_hint = ValueHint::AnyPath)]
    expected: PathBuf,

    /// A picture, or a folder of pictures: what there is
    #[arg(value_name = "ACTUAL", value_hint = ValueHint::AnyPath)]
    actual: PathBuf,

    /// Only the exit status
    #[arg(short, long)]
    quiet: bool,

    /// Print all verdicts as one JSON document
    #[arg(long, conflicts_with = "quiet")]
    json: bool,
}

impl Compare {
    pub(super) fn run(self) -> Result<Status, Failure> {
        let comparison = Comparison::of(&self.expected, &self.actual).map_err(|error| match error {
            ComparisonError::Read { .. } => Failure::files(with_causes(&error)),
            ComparisonError::Unlike { .. } | ComparisonError::Empty { .. } => Failure::usage(error.to_string()),
        })?;
        if self.json {
            let first = comparison.first_moved().map(|picture| &picture.name);
            let (passes, pictures) = (comparison.passes(), &comparison.pictures);
            console::print_json(&json!({ "passes": passes, "first_moved": first, "pictures": pictures }))?;
        } else if !self.quiet {
            console::print(&comparison.to_string())?;
        }
        Ok(if comparison.passes() { Status::Done } else { Status::Difference })
    }
}
