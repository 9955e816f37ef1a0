//! `schema`: what scene files and figure files may hold, for editors.

use super::console::print_json;
use super::failure::{Failure, Status};
use crate::scene;
use clap::Args;

const EXAMPLES: &str = "\
Examples:
  localshape schema > scene.schema.json
  localshape schema --figure > figure.schema.json

An editor that knows JSON Schema for TOML then completes and checks scene files that begin with the line
  #:schema ./scene.schema.json
and figure files likewise.";

/// Print the JSON Schema of scene files, or of figure files
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Schema {
    /// That of figure files instead
    #[arg(long)]
    figure: bool,
}

impl Schema {
    pub(super) fn run(self) -> Result<Status, Failure> {
        print_json(&if self.figure { scene::figure::schema() } else { scene::schema() })?;
        Ok(Status::Done)
    }
}
