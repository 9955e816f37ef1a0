//! Resolves a figure: reads its scenes, and finds the runs and moments that it names.

use super::file::FigureFile;
use super::{Content, Figure, Forces, Sheet};
use crate::look::Print;
use crate::look::print::{unit, unit_of_sheet};
use crate::reading::collector::{Collector, Here};
use crate::scene::load::stem;
use crate::scene::structure::Checked;
use crate::scene::{Scene, SceneError};
use serde::Deserialize;
use serde_json::Value;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// The shortest side of a figure (px).
const LEAST_SIDE: u32 = 64;

type Reader<'a> = &'a dyn Fn(&Path) -> Result<Scene, SceneError>;

/// The figure of a checked file with a name.
pub(super) fn resolve(
    checked: Checked,
    name: &str,
    folder: &Path,
    scene: Reader<'_>,
    report: &Collector<'_>,
) -> Result<Option<Figure>, SceneError> {
    if report.total() > 0 {
        return Ok(None);
    }
    let Ok(file) = FigureFile::deserialize(Value::Object(checked.parts)) else { return Ok(None) };
    let scenes = Scenes { folder, read: scene, report, scenes: Vec::new(), places: HashMap::new() };
    let content = match (file.sheet, file.forces) {
        (Some(sheet), None) => scenes.sheet(sheet)?.map(Content::Sheet),
        (None, Some(forces)) => scenes.forces(forces)?.map(Content::Forces),
        (found, _) => {
            let message = match found {
                Some(_) => "both `sheet` and `forces` are given; keep one of them",
                None => "the figure shows nothing: expected a table `[sheet]` or `[forces]`",
            };
            report.root().wrong(message, None);
            return Ok(None);
        }
    };
    let Some(content) = content else { return Ok(None) };
    let first = match &content {
        Content::Sheet(Sheet { scenes, .. }) | Content::Forces(Forces { scenes, .. }) => &scenes[0],
    };
    let Some((size, print)) = file.size.resolve(LEAST_SIDE, &report.to("size")) else { return Ok(None) };
    if size.iter().any(|&side| side < LEAST_SIDE) {
        let [width, height] = size;
        let message = format!("`size` is {width} × {height}; expected {LEAST_SIDE} to 16384 pixels a side");
        report.to("size").wrong(message, None);
        return Ok(None);
    }
    let unit = match &content {
        Content::Sheet(_) => unit_of_sheet(size),
        Content::Forces(Forces { scenes, .. }) => {
            let columns = if first.runs.len() > 1 { first.runs.len() } else { scenes.len() };
            unit(size, [size[0] / columns as u32, size[1]])
        }
    };
    let text_scale = match file.text_scale {
        Some(typed) => match typed.resolve(print.as_ref(), unit, &report.to("text_scale")) {
            None => return Ok(None),
            times => times,
        },
        None => None,
    };
    let look = super::look(first, file.theme, text_scale);
    Ok(Some(Figure {
        name: stem(Path::new(name)).unwrap_or_else(|| "figure".into()),
        title: file.title.unwrap_or_default(),
        caption: file.caption.unwrap_or_default(),
        size,
        print: print.map(|print| Print { file: name.to_owned(), ..print }),
        look,
        content,
    }))
}

/// The scenes of a figure, each read once.
pub(super) struct Scenes<'a> {
    folder: &'a Path,
    read: Reader<'a>,
    pub(super) report: &'a Collector<'a>,
    pub(super) scenes: Vec<Scene>,
    places: HashMap<PathBuf, usize>,
}

impl Scenes<'_> {
    /// The index of the scene named at a place in the file; `None` after reporting a mistake.
    pub(super) fn scene(&mut self, named: &str, here: &Here<'_>) -> Result<Option<usize>, SceneError> {
        let file = self.folder.join(named);
        if let Some(&place) = self.places.get(&file) {
            return Ok(Some(place));
        }
        match (self.read)(&file) {
            Ok(scene) => {
                self.scenes.push(scene);
                self.places.insert(file, self.scenes.len() - 1);
                Ok(Some(self.scenes.len() - 1))
            }
            // Mistakes inside a scene have positions there.
            Err(error @ (SceneError::Mistakes(_) | SceneError::Syntax(_))) => Err(error),
            Err(error) => {
                here.wrong(error.to_string(), None);
                Ok(None)
            }
        }
    }
}

/// Runs of one name have the line of the first scene with such a run; runs of different names have different lines.
pub(super) fn share_lines(scenes: &mut [Scene]) {
    let Some(first) = scenes.first() else { return };
    let palette = first.view.look.palette();
    let (mut numbers, mut lined) = (HashMap::new(), Vec::new());
    for run in scenes.iter().flat_map(|scene| &scene.runs) {
        numbers.entry(run.name.clone()).or_insert_with(|| {
            lined.push(run.lined());
            lined.len() - 1
        });
    }
    let places = palette.places(&lined);
    for run in scenes.iter_mut().flat_map(|scene| &mut scene.runs) {
        let number = numbers[&run.name];
        (run.place, run.colour) = (places[number], lined[number].chosen);
    }
}
