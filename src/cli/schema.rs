//! `schema`: the format of scene files and figure files, for editors and for readers.

use super::console::{print, print_json};
use super::failure::{Failure, Status};
use crate::scene::{self, reference};
use clap::Args;

const EXAMPLES: &str = "\
Examples:
  localshape schema > scene.schema.json
  localshape schema --figure > figure.schema.json
  localshape schema --markdown | less

An editor that knows JSON Schema for TOML then completes and checks scene files that begin with the line
  #:schema ./scene.schema.json
and figure files likewise.";

/// Print the format of scene files, or of figure files, as JSON Schema or as text
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Schema {
    /// The format of figure files instead
    #[arg(long)]
    figure: bool,

    /// A reference to read (Markdown) instead of the JSON Schema
    #[arg(long)]
    markdown: bool,
}

impl Schema {
    pub(super) fn run(self) -> Result<Status, Failure> {
        match (self.markdown, self.figure) {
            (true, true) => print(&reference::figures())?,
            (true, false) => print(&reference::scenes())?,
            (false, true) => print_json(&scene::figure::schema())?,
            (false, false) => print_json(&scene::schema())?,
        }
        Ok(Status::Done)
    }
}
