//! `schema`: what a scene file may hold, for editors.

use super::console::print_json;
use super::failure::{Failure, Status};
use crate::scene;
use clap::Args;

const EXAMPLES: &str = "\
Example:
  localshape schema > scene.schema.json

An editor that knows JSON Schema for TOML then completes and checks scene files that begin with the line
  #:schema ./scene.schema.json";

/// Print the JSON Schema of scene files
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Schema {}

impl Schema {
    pub(super) fn run(self) -> Result<Status, Failure> {
        print_json(&scene::schema())?;
        Ok(Status::Done)
    }
}
