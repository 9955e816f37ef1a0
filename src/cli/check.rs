//! `check`: what scenes contain, or every mistake in them.

use super::console::{print, print_json};
use super::failure::{Failure, Status, complain, warn, with_causes};
use super::options::{PrintOptions, SceneOptions};
use super::scenes::{status_of, worse};
use clap::Args;
use serde_json::{Value, json};

const EXAMPLES: &str = "\
Examples:
  localshape check scenes/fig4b.toml
  localshape check scenes/*.toml --quiet && echo all right";

/// Check scenes and print what they contain, or every mistake in them
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Check {
    #[command(flatten)]
    scenes: SceneOptions,

    #[command(flatten)]
    printing: PrintOptions,
}

impl Check {
    pub(super) fn run(self) -> Result<Status, Failure> {
        let mut failed = None;
        let mut documents = Vec::new();
        for (number, path) in self.scenes.scenes.iter().enumerate() {
            let file = path.to_string_lossy();
            match self.scenes.load(path) {
                Ok(scene) if self.printing.json => {
                    let (scene, warnings) = (scene.summary(), &scene.warnings);
                    documents.push(json!({ "file": file, "ok": true, "scene": scene, "warnings": warnings }));
                }
                Ok(_) if self.printing.quiet => {}
                Ok(scene) => {
                    let blank = if number > 0 { "\n" } else { "" };
                    print(&format!("{blank}{}\n", scene.summary().to_string().trim_end()))?;
                    warn(path, &scene);
                }
                Err(error) => {
                    failed = Some(worse(failed, status_of(&error)));
                    if self.printing.json {
                        let (message, mistakes) = (with_causes(&error), error.mistakes());
                        documents.push(json!({ "file": file, "ok": false, "error": message, "mistakes": mistakes }));
                    } else {
                        complain(&with_causes(&error));
                    }
                }
            }
        }
        if self.printing.json {
            print_json(&json!({ "scenes": Value::from(documents) }))?;
        }
        Ok(failed.unwrap_or(Status::Done))
    }
}
