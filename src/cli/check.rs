//! `check`: what scenes and meshes contain, or every mistake in them.

use super::console::{print, print_json};
use super::failure::{Failure, Status, complain, note_no_room, warn, with_causes};
use super::options::{PrintOptions, SceneOptions};
#[cfg(feature = "render")]
use super::options::{resize, size};
use super::scenes::{status_of, worse};
#[cfg(feature = "render")]
use super::still::doubts;
#[cfg(not(feature = "render"))]
use crate::reading::Mistake;
#[cfg(not(feature = "render"))]
use crate::scene::Scene;
use crate::scene::mesh::{MeshSummary, is_mesh};
use clap::Args;
use serde_json::{Value, json};
use std::path::Path;

const EXAMPLES: &str = "\
Examples:
  localshape check scenes/fig4b.toml
  localshape check scenes/*.toml --quiet && echo all right
  localshape check hare.ply";

/// Check scenes and print what they contain, or every mistake in them. A mesh file is checked alone: its size, its flaws, and
/// the elements that would fill it
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Check {
    #[command(flatten)]
    scenes: SceneOptions,

    #[command(flatten)]
    printing: PrintOptions,

    /// Check as if frames had this width and height (px) [default: that of the scene]
    #[cfg(feature = "render")]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
}

impl Check {
    pub(super) fn run(self) -> Result<Status, Failure> {
        let mut failed = None;
        let (mut documents, mut meshes) = (Vec::new(), Vec::new());
        for (number, path) in self.scenes.scenes.iter().enumerate() {
            let file = path.to_string_lossy();
            let blank = if number > 0 { "\n" } else { "" };
            if is_mesh(path) {
                let document = self.mesh(path, blank)?;
                if document["ok"] == false {
                    failed = Some(worse(failed, Status::Usage));
                }
                meshes.push(document);
                continue;
            }
            match self.scenes.load(path) {
                Ok(_) if self.printing.quiet && !self.printing.json => {}
                Ok(mut scene) => {
                    #[cfg(feature = "render")]
                    resize(&mut scene, self.size);
                    let (warnings, no_room) = doubts(&scene);
                    scene.warnings.extend(warnings);
                    if self.printing.json {
                        let (scene, warnings) = (scene.summary(), &scene.warnings);
                        documents.push(
                            json!({ "file": file, "ok": true, "scene": scene, "warnings": warnings, "no_room": no_room }),
                        );
                        continue;
                    }
                    print(&format!("{blank}{}\n", scene.summary().to_string().trim_end()))?;
                    warn(path, &scene);
                    note_no_room(&file, scene.view.size, &no_room);
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
            let mut all = json!({ "scenes": documents });
            if !meshes.is_empty() {
                all["meshes"] = meshes.into();
            }
            print_json(&all)?;
        }
        Ok(failed.unwrap_or(Status::Done))
    }

    /// Checks a mesh file, and prints its contents unless a document does.
    fn mesh(&self, path: &Path, blank: &str) -> Result<Value, Failure> {
        let file = path.to_string_lossy();
        let (is_text, limits) = (!self.printing.json, self.scenes.limits());
        let (document, error) = match MeshSummary::read(path, &limits) {
            Ok(mesh) => {
                if is_text && !self.printing.quiet {
                    print(&format!("{blank}  {:<10} {file}\n{mesh}", "mesh"))?;
                }
                let error = mesh.fault();
                (json!({ "file": file, "ok": error.is_none(), "error": error, "mesh": mesh }), error)
            }
            Err((message, help)) => {
                let error = help.map_or_else(|| message.clone(), |help| format!("{message}; {help}"));
                (json!({ "file": file, "ok": false, "error": error }), Some(error))
            }
        };
        if let Some(error) = error.filter(|_| is_text) {
            complain(&format!("{file} {error}"));
        }
        Ok(document)
    }
}

/// Builds that cannot draw have no doubts about pictures.
#[cfg(not(feature = "render"))]
fn doubts(_: &Scene) -> (Vec<Mistake>, Vec<String>) {
    Default::default()
}
