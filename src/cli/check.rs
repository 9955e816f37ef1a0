//! `check`: what scenes and meshes contain, or every mistake in them.

use super::console::{print, print_json};
use super::failure::{Failure, Status, complain, note, warn, with_causes};
#[cfg(feature = "render")]
use super::options::size;
use super::options::{PrintOptions, SceneOptions};
use super::scenes::{status_of, worse};
use crate::reading::Mistake;
#[cfg(feature = "render")]
use crate::runner::Runner;
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

/// Why a scene cannot be printed in its size.
#[cfg(feature = "render")]
fn too_small(scene: &Scene) -> Option<String> {
    super::still::too_small(scene, &(0..scene.runs.len()).collect::<Vec<_>>())
}
#[cfg(not(feature = "render"))]
fn too_small(_: &Scene) -> Option<String> {
    None
}

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
            let loaded = self.scenes.load(path).map(|scene| self.resized(scene));
            let refused = loaded.as_ref().ok().and_then(too_small);
            match loaded {
                Ok(_) if refused.is_some() => {
                    failed = Some(worse(failed, Status::Usage));
                    let message = refused.unwrap_or_default();
                    if self.printing.json {
                        documents.push(json!({ "file": file, "ok": false, "error": message, "mistakes": [] }));
                    } else {
                        complain(&message);
                    }
                }
                Ok(scene) if self.printing.quiet && !self.printing.json => {
                    for message in scene.too_large_steps() {
                        failed = failed.or(Some(Status::Difference));
                        complain(&format!("{file}: {message}"));
                    }
                }
                Ok(mut scene) => {
                    if !scene.too_large_steps().is_empty() {
                        failed = failed.or(Some(Status::Difference));
                    }
                    scene.warnings.extend(cut(&scene));
                    if self.printing.json {
                        let no_room = no_room(&scene);
                        let (scene, warnings) = (scene.summary(), &scene.warnings);
                        documents.push(
                            json!({ "file": file, "ok": true, "scene": scene, "warnings": warnings, "no_room": no_room }),
                        );
                        continue;
                    }
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

    /// Checks a mesh file, and prints what it contains unless a document does.
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

    /// A scene in the requested size.
    #[cfg(feature = "render")]
    fn resized(&self, mut scene: Scene) -> Scene {
        if let Some(size) = self.size {
            (scene.view.size, scene.view.print) = (size, None);
        }
        scene
    }
    #[cfg(not(feature = "render"))]
    fn resized(&self, scene: Scene) -> Scene {
        scene
    }
}

/// A warning if a body leaves its panel at the start, before a camera that stands still.
#[cfg(feature = "render")]
fn cut(scene: &Scene) -> Option<Mistake> {
    if scene.view.camera.follow {
        return None;
    }
    let runs: Vec<_> = (0..scene.runs.len()).collect();
    let mut runner = Runner::new(scene, &runs).with_diagnostics(&scene.frame_diagnostics());
    let picture = crate::picture::Composer::new(scene, &Default::default()).compose(&runner.frame(0));
    picture.panels.iter().any(|panel| panel.is_cut).then(|| Mistake {
        line: 0,
        column: 0,
        place: "view.camera".to_owned(),
        message: "the body leaves its panel at the start".to_owned(),
        help: Some("move the camera back, or let it follow: leave out `target` and `distance`".to_owned()),
        excerpt: String::new(),
        marked: 0..0,
    })
}

#[cfg(not(feature = "render"))]
fn cut(_: &Scene) -> Option<Mistake> {
    None
}

/// The parts that have no room in the pictures of a scene.
fn no_room(scene: &Scene) -> Vec<String> {
    #[cfg(feature = "render")]
    return crate::picture::left_out(scene);
    #[cfg(not(feature = "render"))]
    {
        let _ = scene;
        Vec::new()
    }
}
