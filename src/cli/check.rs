//! `check`: what scenes contain, or every mistake in them.

use super::console::{print, print_json};
use super::failure::{Failure, Status, complain, warn, with_causes};
use super::options::{SceneOptions, Telling};
use super::scenes::{status_of, worse};
use crate::scene::Scene;
use clap::Args;
use serde_json::{Value, json};

const EXAMPLES: &str = "\
Examples:
  localshape check scenes/fig4b.toml
  localshape check scenes/*.toml --quiet && echo all right";

/// Why a scene for print cannot be drawn.
#[cfg(feature = "render")]
fn too_small(scene: &Scene) -> Option<String> {
    super::still::too_small(scene, &(0..scene.runs.len()).collect::<Vec<_>>())
}
#[cfg(not(feature = "render"))]
fn too_small(_: &Scene) -> Option<String> {
    None
}

/// Check scenes and print what they contain, or every mistake in them
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Check {
    #[command(flatten)]
    scenes: SceneOptions,

    #[command(flatten)]
    telling: Telling,
}

impl Check {
    pub(super) fn run(self) -> Result<Status, Failure> {
        let mut failed = None;
        let mut documents = Vec::new();
        for (number, path) in self.scenes.scenes.iter().enumerate() {
            let file = path.to_string_lossy();
            let loaded = self.scenes.load(path);
            let refused = loaded.as_ref().ok().and_then(too_small);
            match loaded {
                Ok(_) if refused.is_some() => {
                    failed = Some(worse(failed, Status::Usage));
                    let message = refused.unwrap_or_default();
                    if self.telling.json {
                        documents.push(json!({ "file": file, "ok": false, "error": message, "mistakes": [] }));
                    } else {
                        complain(&message);
                    }
                }
                Ok(scene) if self.telling.json => {
                    let (scene, warnings) = (scene.summary(), &scene.warnings);
                    documents.push(json!({ "file": file, "ok": true, "scene": scene, "warnings": warnings }));
                }
                Ok(_) if self.telling.quiet => {}
                Ok(scene) => {
                    let blank = if number > 0 { "\n" } else { "" };
                    print(&format!("{blank}{}\n", scene.summary().to_string().trim_end()))?;
                    warn(path, &scene);
                }
                Err(error) => {
                    failed = Some(worse(failed, status_of(&error)));
                    if self.telling.json {
                        let (message, mistakes) = (with_causes(&error), error.mistakes());
                        documents.push(json!({ "file": file, "ok": false, "error": message, "mistakes": mistakes }));
                    } else {
                        complain(&with_causes(&error));
                    }
                }
            }
        }
        if self.telling.json {
            print_json(&json!({ "scenes": Value::from(documents) }))?;
        }
        Ok(failed.unwrap_or(Status::Done))
    }
}
