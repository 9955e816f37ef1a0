//! Resolves a figure: reads its scenes, and finds the runs and moments that it names.

use super::file::{ColumnFile, FigureFile, ForcesFile, NumbersFile, RowFile, SheetFile};
use super::{Column, Content, Figure, Forces, Row, Sheet};
use crate::look::print::{unit, unit_of_sheet};
use crate::look::{self, Subject};
use crate::reading::collector::{Collector, PathPart, key_path};
use crate::reading::words::{list, quoted};
use crate::scene::structure::Checked;
use crate::scene::{Scene, SceneError};
use crate::sim::Diagnostic;
use serde::Deserialize;
use serde_json::Value;
use std::collections::HashMap;
use std::mem::take;
use std::path::{Path, PathBuf};

/// The shortest side of a figure (px).
const LEAST_SIDE: u32 = 64;

type Reader<'a> = &'a dyn Fn(&Path) -> Result<Scene, SceneError>;

/// The figure of a checked file.
pub(super) fn resolve(
    checked: Checked,
    name: &str,
    folder: &Path,
    scene: Reader<'_>,
    report: &mut Collector<'_>,
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
            report.at(&[], message, None);
            return Ok(None);
        }
    };
    let Some(content) = content else { return Ok(None) };
    let first = match &content {
        Content::Sheet(Sheet { scenes, .. }) | Content::Forces(Forces { scenes, .. }) => &scenes[0],
    };
    let Some((size, print)) = file.size.resolve(LEAST_SIDE, &key_path!["size"], report) else { return Ok(None) };
    if size.iter().any(|&side| side < LEAST_SIDE) {
        let [width, height] = size;
        let message = format!("`size` is {width} × {height}; expected {LEAST_SIDE} to 16384 pixels a side");
        report.at(&key_path!["size"], message, None);
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
        Some(typed) => match typed.resolve(print.as_ref(), unit, &key_path!["text_scale"], report) {
            None => return Ok(None),
            times => times,
        },
        None => None,
    };
    let look = super::look(first, file.theme, text_scale);
    Ok(Some(Figure {
        name: name.to_owned(),
        title: file.title.unwrap_or_default(),
        caption: file.caption.unwrap_or_default(),
        size,
        print,
        look,
        content,
    }))
}

/// The scenes of a figure, each read once.
struct Scenes<'a, 'r, 't> {
    folder: &'a Path,
    read: Reader<'a>,
    report: &'r mut Collector<'t>,
    scenes: Vec<Scene>,
    places: HashMap<PathBuf, usize>,
}

impl Scenes<'_, '_, '_> {
    /// The index of the scene named at `path` in the file; `None` after reporting a mistake.
    fn scene(&mut self, named: &str, path: &[PathPart<'_>]) -> Result<Option<usize>, SceneError> {
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
                self.report.at(path, error.to_string(), None);
                Ok(None)
            }
        }
    }

    /// The columns of a sheet; `None` after reporting a mistake.
    fn columns(&mut self, file: &mut SheetFile) -> Result<Option<Vec<Column>>, SceneError> {
        let at = |key: &'static str| key_path!["sheet", key];
        let before = self.report.total();
        let moment = |&time: &f64| ColumnFile { scene: None, time: Some(time), label: None };
        let wrong = match &file.moments {
            Some(_) if !file.column.is_empty() => "both `moments` and `column` are given; keep one of them",
            Some(_) if file.scene.is_none() => "the moments have no `scene`",
            _ => "",
        };
        if !wrong.is_empty() {
            self.report.at_key(&at("moments"), wrong, None);
            return Ok(None);
        }
        let moments = file.moments.iter().flatten().map(moment);
        let columns: Vec<_> = moments.chain(take(&mut file.column)).collect();
        if columns.is_empty() {
            self.report.at(&at(""), "the sheet has no columns: expected `moments` or `[[sheet.column]]`", None);
            return Ok(None);
        }
        let usual = match &file.scene {
            Some(named) => self.scene(named, &at("scene"))?,
            None => None,
        };
        let mut resolved = Vec::new();
        for (index, column) in columns.into_iter().enumerate() {
            let path = key_path!["sheet", "column", index, "scene"];
            let scene = match (&column.scene, &file.scene) {
                (Some(named), _) => self.scene(named, &path)?,
                (None, Some(_)) => usual,
                (None, None) => {
                    self.report.at(&path, "the column has no scene: expected `scene` here or in `[sheet]`", None);
                    None
                }
            };
            resolved.extend(scene.map(|scene| Column { scene, time: column.time, label: column.label }));
        }
        Ok(Some(resolved).filter(|_| self.report.total() == before))
    }

    fn sheet(mut self, mut file: SheetFile) -> Result<Option<Sheet>, SceneError> {
        let before = self.report.total();
        let Some(columns) = self.columns(&mut file)? else { return Ok(None) };
        let rows = if file.row.is_empty() {
            let all = self.scenes[0].runs.iter();
            all.map(|run| RowFile { run: run.name.clone(), time: None, label: None, note: None }).collect()
        } else {
            file.row
        };
        self.check_cells(&rows, &columns, file.moments.is_some());
        let ends: Vec<_> = self.scenes.iter().map(end).collect();
        if let Some(other) = ends.iter().position(|end| *end != ends[0]).filter(|_| !file.charts.is_empty()) {
            let [one, two] = [0, other].map(|at| format!("“{}” ends at {} s", self.scenes[at].title, ends[at]));
            let message = format!("charts over several scenes have one axis of time, but {one} and {two}");
            let help = "give the scenes the same duration and frame rate";
            self.report.at_key(&key_path!["sheet", "charts"], message, help);
        }
        Scene::check_charts(&file.charts, &self.scenes, "sheet", self.report);
        self.check_times(&file.charts, file.from, file.split, &columns);
        if let Some(index) = rows.iter().position(|row| row.time.is_some()).filter(|_| !file.charts.is_empty()) {
            let path = key_path!["sheet", "row", index, "time"];
            let message = "charts mark the moments of columns, but here a row has one of its own";
            self.report.at_key(&path, message, "leave out `sheet.charts`, or give the moments of columns");
        }
        let row = |row: RowFile| Row {
            label: row.label.unwrap_or_else(|| row.run.clone()),
            run: row.run,
            time: row.time,
            note: row.note.unwrap_or_default(),
        };
        let rows = rows.into_iter().map(row).collect();
        let Self { report, mut scenes, .. } = self;
        share_lines(&mut scenes);
        if let Some(typed) = &file.colour {
            let subjects: Vec<_> = scenes.iter().map(subject).collect();
            let scales = look::colour(typed, &subjects, "sheet", report).unwrap_or_default();
            scenes.iter_mut().zip(scales).for_each(|(scene, scale)| scene.view.colour = Some(scale));
        }
        let SheetFile { charts, number, from, split, .. } = file;
        let sheet = Sheet { scenes, columns, rows, charts, number, from: from.unwrap_or(0.0), split };
        Ok((report.total() == before).then_some(sheet))
    }

    /// Whether the time axis includes its start, the change of its scale, and the moments of columns.
    fn check_times(&mut self, charts: &[Diagnostic], from: Option<f64>, split: Option<f64>, columns: &[Column]) {
        let at = |key: &'static str| key_path!["sheet", key];
        for (key, _) in [("from", from), ("split", split)].iter().filter(|(_, time)| time.is_some()) {
            if charts.is_empty() {
                self.report.at_key(&at(key), format!("`sheet.{key}` is about charts, but there are none"), None);
                return;
            }
        }
        let end = end(&self.scenes[0]);
        let earliest = columns.iter().filter_map(|column| column.time).fold(end, f64::min);
        if let Some(from) = from.filter(|&from| from > earliest || from >= end) {
            let message = match earliest < end {
                true => format!("the axis of time begins at {from} s, but there is a moment at {earliest} s"),
                false => format!("the axis of time begins at {from} s, but the scene ends at {end} s"),
            };
            self.report.at(&at("from"), message, "expected an earlier one");
        } else if let Some(split) = split.filter(|&split| split >= end || split <= from.unwrap_or(0.0)) {
            let from = from.unwrap_or(0.0);
            let message =
                format!("the axis of time goes from {from} to {end} s; expected a moment between, found {split}");
            self.report.at(&at("split"), message, None);
        }
    }

    /// Whether each cell has a run and a moment.
    fn check_cells(&mut self, rows: &[RowFile], columns: &[Column], are_moments: bool) {
        for (index, row) in rows.iter().enumerate() {
            let path = |key: &'static str| key_path!["sheet", "row", index, key];
            for scene in &self.scenes {
                if !scene.runs.iter().any(|run| run.name == row.run) {
                    let (message, help) = scene.no_run(&row.run);
                    self.report.at(&path("run"), message, help);
                }
                if row.time.is_some_and(|time| time > end(scene)) {
                    self.report.at(&path("time"), too_late(scene), None);
                }
            }
        }
        let timed = rows.iter().position(|row| row.time.is_some());
        if let Some(index) = timed.filter(|_| columns.iter().any(|column| column.time.is_some())) {
            let path = key_path!["sheet", "row", index, "time"];
            let message = "both a row and a column give the moment of the same picture";
            self.report.at_key(&path, message, "keep the moments of either rows or columns");
        }
        let timeless = rows.iter().find(|row| row.time.is_none());
        for (index, column) in columns.iter().enumerate() {
            let scene = &self.scenes[column.scene];
            let path = |key: &'static str| key_path!["sheet", "column", index, key];
            if column.time.is_some_and(|time| time > end(scene)) {
                let moments = key_path!["sheet", "moments", index];
                let place: &[_] = if are_moments { &moments } else { &path("time") };
                self.report.at(place, too_late(scene), None);
            }
            if let Some(row) = timeless.filter(|_| column.time.is_none()) {
                let message = format!("the column has no `time`, and neither has the row “{}”", row.run);
                self.report.at(&path("time"), message, "give it in one of them");
            }
        }
    }

    fn forces(mut self, file: ForcesFile) -> Result<Option<Forces>, SceneError> {
        let before = self.report.total();
        for (index, named) in file.scenes.iter().enumerate() {
            if self.scene(named, &of_forces(index))?.is_some_and(|place| place < index) {
                self.report.at(&of_forces(index), "this scene is named a second time", None);
            }
        }
        if self.report.total() > before {
            return Ok(None);
        }
        let names = |scene: &Scene| scene.runs.iter().map(|run| run.name.clone()).collect::<Vec<_>>();
        let runs = names(&self.scenes[0]);
        for (index, _) in self.scenes.iter().enumerate().filter(|(_, scene)| names(scene) != runs) {
            let all = list(&runs, "and", |name| format!("“{name}”"));
            let message = format!("the runs of this scene differ from those of the first: {all}");
            self.report.at(&of_forces(index), message, None);
        }
        let compare = file.compare.as_ref().and_then(|name| self.compared(name, &runs));
        if file.notes.len() > runs.len() {
            let message = format!("there are more notes ({}) than runs ({})", file.notes.len(), runs.len());
            self.report.at(&key_path!["forces", "notes"], message, "expected one for each at most");
        }
        let recorded = |scene: &Scene| Some(quoted(&scene.runs.iter().find(|run| run.recording.is_some())?.name));
        if let Some((index, run)) = self.scenes.iter().enumerate().find_map(|(at, scene)| Some((at, recorded(scene)?)))
        {
            let message = format!("the run {run} is a recording, whose forces are not known");
            self.report.at(&of_forces(index), message, "give it a `model`, or leave it out");
            return Ok(None);
        }
        let numbers = file.numbers == NumbersFile::Force;
        if file.vectors && (numbers || runs.len() > 1) {
            let message = "vectors are drawn for one run, and without numbers";
            let help = "leave one run in the scenes, and write `numbers = \"none\"`".to_owned();
            self.report.at_key(&key_path!["forces", "vectors"], message, help);
        }
        self.check_units(numbers);
        let mut notes = file.notes;
        notes.resize(runs.len(), String::new());
        let Self { report, mut scenes, .. } = self;
        share_lines(&mut scenes);
        let forces = Forces { scenes, notes, compare, vectors: file.vectors, numbers };
        Ok((report.total() == before).then_some(forces))
    }

    /// The place of the run with which others are compared among all `runs`; `None` after reporting that there is none. Reports scenes
    /// in which another run has other bodies.
    fn compared(&mut self, name: &str, runs: &[String]) -> Option<usize> {
        let path = key_path!["forces", "compare"];
        let place = runs.iter().position(|run| run == name);
        if place.is_none() {
            let (message, help) = self.scenes[0].no_run(name);
            self.report.at(&path, message, help);
        }
        if runs.len() == 1 {
            self.report.at_key(&path, "there is a single run, and nothing to compare it with", None);
        }
        for (index, scene) in self.scenes.iter().enumerate() {
            let Some(compared) = place.and_then(|place| scene.runs.get(place)) else { continue };
            if let Some(other) = scene.runs.iter().find(|run| run.of != compared.of) {
                let [one, other] = [compared, other].map(|run| quoted(&run.name));
                let message = format!("{one} and {other} have different bodies, so their forces cannot be compared");
                self.report.at(&of_forces(index), message, "give both runs the same bodies, or remove `compare`");
            }
        }
        place
    }

    /// Reports scenes whose forces have another unit than those of the first, or are too many. With `numbers` their unit has a length.
    fn check_units(&mut self, numbers: bool) {
        let stiffness = self.scenes[0].runs[0].models[0].stiffness();
        for (index, scene) in self.scenes.iter().enumerate() {
            if scene.runs.iter().flat_map(|run| &run.models).any(|model| model.stiffness() != stiffness) {
                let message =
                    format!("a run has another stiffness than the first, {stiffness} N/m: forces would have two units");
                self.report.at(&of_forces(index), message, "give all runs the same stiffness");
            }
            let nodes = scene.runs.iter().map(|run| run.body().len()).max().unwrap_or_default();
            if nodes > MOST_NODES {
                let bodies = if scene.bodies.len() == 1 { "the body has" } else { "the bodies of a run have" };
                let message = format!("{bodies} {nodes} nodes, whose forces would hide each other");
                self.report.at(&of_forces(index), message, format!("expected at most {MOST_NODES}"));
            }
        }
        let side = self.scenes[0].view.side;
        let other = self.scenes.iter().position(|scene| (scene.view.side / side - 1.0).abs() > 1e-3);
        if let Some(index) = other.filter(|_| numbers) {
            let found = self.scenes[index].view.side;
            let message = format!(
                "the elements of this scene have sides of {found} m, but {side} m in the first: numbers in `k × side` would have two units"
            );
            self.report.at(&of_forces(index), message, "use bodies of one size, or `numbers = \"none\"`");
        }
    }
}

/// The place of a scene in a diagram of forces.
fn of_forces(index: usize) -> [PathPart<'static>; 3] {
    key_path!["forces", "scenes", index]
}

/// The scene's part of the input of views.
fn subject(scene: &Scene) -> Subject<'_> {
    crate::scene::subject(&scene.bodies, &scene.runs, scene.gravity, &scene.obstacles)
}

/// Runs of one name have the line of the first scene with such a run; runs of different names have different lines.
fn share_lines(scenes: &mut [Scene]) {
    let Some(first) = scenes.first() else { return };
    let palette = first.view.look.palette();
    let (mut numbers, mut chosen) = (HashMap::new(), Vec::new());
    for run in scenes.iter().flat_map(|scene| &scene.runs) {
        numbers.entry(run.name.clone()).or_insert_with(|| {
            chosen.push(run.colour);
            chosen.len() - 1
        });
    }
    let places = palette.places(&chosen);
    for run in scenes.iter_mut().flat_map(|scene| &mut scene.runs) {
        let number = numbers[&run.name];
        (run.place, run.colour) = (places[number], chosen[number]);
    }
}

/// The most nodes of a body whose forces are drawn.
const MOST_NODES: usize = 80;

/// The last moment of a scene (s).
fn end(scene: &Scene) -> f64 {
    scene.frame_time(scene.last_frame())
}

fn too_late(scene: &Scene) -> String {
    format!("the scene “{}” ends at {} s; expected a moment up to then", scene.title, end(scene))
}
