//! `check`: what scenes contain, or every mistake in them.

use super::console::{print, print_json};
use super::failure::{Failure, Status, complain, note, warn, with_causes};
use super::options::{SceneOptions, Telling};
use super::scenes::{status_of, worse};
use crate::scene::Scene;
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
    telling: Telling,
}

impl Check {
    pub(super) fn run(self) -> Result<Status, Failure> {
        let mut failed = None;
        let mut documents = Vec::new();
        for (number, path) in self.scenes.scenes.iter().enumerate() {
            let file = path.to_string_lossy();
            match self.scenes.load(path) {
                Ok(scene) if self.telling.json => {
                    let no_room = no_room(&scene);
                    let (scene, warnings) = (scene.summary(), &scene.warnings);
                    documents.push(
                        json!({ "file": file, "ok": true, "scene": scene, "warnings": warnings, "no_room": no_room }),
                    );
                }
                Ok(_) if self.telling.quiet => {}
                Ok(scene) => {
                    let blank = if number > 0 { "\n" } else { "" };
                    print(&format!("{blank}{}\n", scene.summary().to_string().trim_end()))?;
                    warn(path, &scene);
                    let no_room = no_room(&scene);
                    if !no_room.is_empty() {
                        let [width, height] = scene.view.size;
                        note(&format!("{file}: not everything has room in {width}×{height}: {}", no_room.join("; ")));
                    }
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

/// What finds no room in the pictures of a scene.
fn no_room(scene: &Scene) -> Vec<String> {
    #[cfg(feature = "render")]
    return crate::picture::left_out(scene);
    #[cfg(not(feature = "render"))]
    {
        let _ = scene;
        Vec::new()
    }
}
