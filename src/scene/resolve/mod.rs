//! Resolves a scene: fills in defaults, compares lengths, checks indices. Every mistake is reported. Parts with
//! mistakes are not used.

mod body;
mod elements;
mod grips;
pub(super) mod lists;
mod motion;
mod obstacles;
mod runs;

use super::digest::{FileDigests, digest};
use super::file::{BodyFile, Coordinates, GrabFile, HoldFile, ObstacleFile, RunFile, SceneFile, TimeFile};
use super::generate::Generator;
use super::limits::Limits;
use super::structure::ValidFile;
use super::{Run, Scene, SceneBody};
use crate::look::{self, FontFiles, TypedView, View, font};
use crate::reading::collector::{Collector, PathPart, key_path};
use crate::reading::coordinates::{direction, vector};
use crate::reading::words::{count, short};
use crate::sim::{Grip, Obstacle};
use body::ResolvedBody;
use glam::DVec3;
use lists::Lists;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value as Json};
use std::collections::BTreeSet;
use std::path::Path;
use std::slice;

/// The parts of a scene file without mistakes in their structure.
#[derive(Debug, Serialize)]
pub(super) struct SceneParts {
    title: Option<String>,
    gravity: Option<Coordinates>,
    time: Option<TimeFile>,
    body: Option<BodyFile>,
    /// The lists in the body's own file, if it has no mistakes.
    #[serde(skip)]
    beside: Option<Lists>,
    /// Top-level keys with mistakes in or below them.
    #[serde(skip)]
    flawed: BTreeSet<String>,
    #[serde(rename = "run")]
    runs: Vec<Option<RunFile>>,
    #[serde(rename = "obstacle")]
    obstacles: Vec<Option<ObstacleFile>>,
    #[serde(rename = "hold")]
    holds: Vec<Option<HoldFile>>,
    #[serde(rename = "grab")]
    grabs: Vec<Option<GrabFile>>,
    view: Option<TypedView>,
    /// The fonts of the view; `None` after a mistake in them.
    #[serde(skip)]
    font: Option<FontFiles>,
}

impl SceneParts {
    /// The valid parts of a checked file. A body's own file is searched in `folder`.
    pub(super) fn new(checked: &ValidFile, folder: &Path, limits: &Limits, report: &mut Collector<'_>) -> Self {
        let file = &checked.valid;
        let body: Option<BodyFile> = part(file, "body", report).map(|mut body: BodyFile| {
            // Lists beside a generator or a file are a mistake, which was reported.
            if body.file.is_some() || Generator::of(&body).is_some() {
                (body.nodes, body.elements, body.springs, body.faces) = (None, None, None, None);
                (body.positions, body.velocities, body.masses) = (None, None, None);
            }
            body
        });
        let read_lists = |body: &BodyFile| Lists::read(folder, body.file.as_ref()?, limits, report);
        let beside = body.as_ref().filter(|body| Generator::of(body).is_none()).and_then(read_lists);
        let view: Option<TypedView> =
            if file.contains_key("view") { part(file, "view", report) } else { Some(TypedView::default()) };
        let font = match view.as_ref().and_then(|view| view.get("font")) {
            Some(typed) => {
                read(typed, &key_path!["view", "font"], report).and_then(|typed| font::read(folder, &typed, report))
            }
            None => Some(FontFiles::default()),
        };
        Self {
            title: part(file, "title", report),
            gravity: part(file, "gravity", report),
            time: part(file, "time", report),
            body,
            beside,
            flawed: checked.flawed.clone(),
            runs: several(file, "run", report),
            obstacles: several(file, "obstacle", report),
            holds: several(file, "hold", report),
            grabs: several(file, "grab", report),
            view,
            font,
        }
    }

    /// The valid parts of a scene made in code. `flawed` tells whether its separately checked long lists had a mistake.
    pub(super) fn of(file: SceneFile, checked: &ValidFile, flawed: bool) -> Self {
        fn entries<T>(entries: Vec<T>, key: &str, checked: &ValidFile) -> Vec<Option<T>> {
            let is_sound = |at: usize| !checked.valid.get(key).is_some_and(|valid| valid[at].is_null());
            entries.into_iter().enumerate().map(|(at, entry)| Some(entry).filter(|_| is_sound(at))).collect()
        }
        let is_sound = |key: &str| !checked.flawed.contains(key);
        let lists = if flawed { BTreeSet::from(["body".to_owned()]) } else { BTreeSet::new() };
        Self {
            title: file.title,
            gravity: file.gravity.filter(|_| is_sound("gravity")),
            time: Some(file.time).filter(|_| is_sound("time")),
            body: Some(file.body).filter(|_| is_sound("body")),
            beside: None,
            flawed: &checked.flawed | &lists,
            runs: entries(file.run, "run", checked),
            obstacles: entries(file.obstacle, "obstacle", checked),
            holds: entries(file.hold, "hold", checked),
            grabs: entries(file.grab, "grab", checked),
            view: Some(file.view).filter(|_| is_sound("view")),
            font: Some(FontFiles::default()),
        }
    }

    /// The scene, or `None` after any mistake.
    pub(super) fn scene(mut self, name: &str, limits: &Limits, report: &mut Collector<'_>) -> Option<Scene> {
        let has_own_models = self.runs.iter().flatten().any(|run| run.model.is_own());
        let has_digest = report.total() == 0 && !has_own_models;
        let digest = if has_digest { self.digest() } else { String::new() };
        let scene = resolve(self, name, &digest, limits, report)?;
        Some(Scene { warnings: report.warnings(), ..scene })
    }

    /// The digest of the scene's meaning, if there are no mistakes.
    fn digest(&mut self) -> String {
        let [regular, semi_bold] = match &self.font {
            Some(font) => [&font.regular, &font.semi_bold].map(|font| font.as_ref().map(|bytes| font::digest(bytes))),
            None => [None, None],
        };
        let files = FileDigests { body: self.beside.as_ref().map(Lists::digest), regular, semi_bold };
        let mut lists = BodyFile::default();
        self.body.iter_mut().for_each(|body| body.swap_lists(&mut lists));
        let digest = digest(self, &lists, files);
        self.body.iter_mut().for_each(|body| body.swap_lists(&mut lists));
        digest
    }
}

fn part<T: DeserializeOwned>(file: &Map<String, Json>, key: &str, report: &mut Collector<'_>) -> Option<T> {
    read(file.get(key)?, &key_path![key], report)
}

fn several<T: DeserializeOwned>(file: &Map<String, Json>, key: &str, report: &mut Collector<'_>) -> Vec<Option<T>> {
    let entries = file.get(key).and_then(Json::as_array).into_iter().flatten().enumerate();
    entries.map(|(at, entry)| read(entry, &key_path![key, at], report)).collect()
}

fn read<T: DeserializeOwned>(json: &Json, path: &[PathPart<'_>], report: &mut Collector<'_>) -> Option<T> {
    if json.is_null() {
        return None;
    }
    let known = report.total();
    let read = T::deserialize(json);
    // A required key may be missing after a mistake. Otherwise the schema has accepted the value, and an error of the
    // types is unexpected.
    read.map_err(|error| {
        if known == 0 {
            report.at(path, error.to_string(), None)
        }
    })
    .ok()
}

/// The most frames a scene may have: at 60 a second nearly two days of film.
const MOST_FRAMES: f64 = 1e7;

/// The physics. A part is `None` if it has a mistake, or depends on a part with one.
struct Physics {
    gravity: Option<DVec3>,
    body: Option<ResolvedBody>,
    obstacles: Option<Vec<Obstacle>>,
    grips: Option<Vec<Grip>>,
    runs: Option<Vec<Run>>,
}

/// The scene, or `None` after any mistake: first the physics, then the view.
fn resolve(
    mut parts: SceneParts,
    name: &str,
    digest: &str,
    limits: &Limits,
    report: &mut Collector<'_>,
) -> Option<Scene> {
    let beside = parts.beside.take();
    let physics = physics(&parts, beside, limits, report);
    let view = view(&parts, &physics, report);
    if let (0, Some(runs)) = (report.total(), &physics.runs) {
        let fixed = runs.iter().filter(|run| run.tolerance.is_none());
        let longest = fixed.fold(0.0, |longest: f64, run| longest.max(run.step));
        obstacles::check_steps(&parts.obstacles, longest, report);
        grips::check_steps(&parts.holds, &parts.grabs, longest, report);
    }
    if report.total() > 0 {
        return None;
    }
    let (time, body) = (parts.time.as_ref()?, physics.body?);
    let mut scene = Scene {
        title: parts.title.clone().unwrap_or_else(|| name.into()),
        name: name.into(),
        file: None,
        digest: digest.into(),
        gravity: physics.gravity?,
        duration: time.duration,
        frames_per_second: time.frames_per_second,
        bodies: vec![SceneBody { name: String::new(), body: body.body, initial: body.initial }],
        runs: physics.runs?,
        obstacles: physics.obstacles?,
        view: view?,
        warnings: Vec::new(),
    };
    scene.place_runs();
    Scene::check_charts(&scene.view.charts, slice::from_ref(&scene), "view", report);
    warn_of_time(&scene, report);
    warn_of_steps(&scene, report);
    Some(scene)
}

fn physics(parts: &SceneParts, beside: Option<Lists>, limits: &Limits, report: &mut Collector<'_>) -> Physics {
    let dimension = parts.body.as_ref().and_then(|file| body::dimension(file, beside.as_ref()));
    let read_body = |file| body::resolve(file, beside, parts.flawed.contains("body"), &parts.runs, limits, report);
    let body = parts.body.as_ref().and_then(read_body);
    let gravity = match (&parts.gravity, dimension) {
        (Some(typed), Some(dimension)) => vector(typed, dimension, &key_path!["gravity"], report),
        _ => Some(DVec3::ZERO),
    };
    let obstacles = obstacles::resolve(&parts.obstacles, dimension, body.as_ref(), report);
    let grips = body.as_ref().and_then(|body| grips::resolve(&parts.holds, &parts.grabs, body, report));
    if let Some(time) = parts.time.as_ref().filter(|_| !parts.flawed.contains("time")) {
        check_frames(time, report);
    }
    let runs = runs::resolve(&parts.runs, parts.time.as_ref(), body.as_ref(), grips.as_deref(), report);
    Physics { gravity, body, obstacles, grips, runs }
}

/// The view, which `look` resolves.
fn view(parts: &SceneParts, physics: &Physics, report: &mut Collector<'_>) -> Option<View> {
    let Physics { gravity, body, obstacles, grips, runs } = physics;
    let (body, obstacles) = (body.as_ref()?, obstacles.as_ref()?);
    let around = look::Subject {
        body: &body.body,
        initial: &body.initial,
        side: body.side,
        has_cells: body.has_cells,
        gravity: gravity.unwrap_or_default(),
        obstacles,
        grips: grips.as_deref().unwrap_or_default(),
        runs: runs.iter().flatten().map(|run| (run.name.as_str(), run.step)).collect(),
        models: runs.iter().flatten().map(|run| &*run.models[0]).collect(),
    };
    let view = View::read(parts.view.as_ref()?, &around, parts.font.clone().unwrap_or_default(), report)?;
    let chosen: Vec<_> = parts.runs.iter().map(|run| Some(run.as_ref()?.colour?.0)).collect();
    look::check_runs(&chosen, &view.look.palette(), report);
    Some(view)
}

/// Warns of a scene with one frame, and of a very long computation.
fn warn_of_time(scene: &Scene, report: &mut Collector<'_>) {
    /// Computation time for one corner of an element and one step (s), measured on one cube.
    const CORNER: f64 = 3e-8;
    const LONG: f64 = 7200.0;
    let last = scene.last_frame();
    if last == 0 && scene.duration > 0.0 {
        let (duration, rate) = (short(scene.duration), short(scene.frames_per_second));
        let message = format!("at {rate} frames per second, {duration} s have only one frame, the start");
        report.warn(
            &key_path!["time", "frames_per_second"],
            message,
            format!("use at least {} to show the end", short(1.0 / scene.duration)),
        );
    }
    let steps = (0..scene.runs.len()).fold(0, |all: u64, run| all.saturating_add(scene.frame_step(run, last)));
    let corners = scene.runs[0].body().elements.indices().len().max(8);
    let seconds = steps as f64 * corners as f64 * CORNER;
    if seconds > LONG {
        let hours = seconds / 3600.0;
        let long = match hours {
            ..48.0 => format!("{hours:.0} hours"),
            ..10_000.0 => format!("{:.0} days", hours / 24.0),
            _ => format!("{:.0} years", hours / 8766.0),
        };
        let (steps, elements) = (count(steps.into()), scene.runs[0].body().elements.len());
        let message = format!(
            "{steps} steps of all runs × {} element{} take about {long} on one processor",
            count(elements as u128),
            if elements == 1 { "" } else { "s" }
        );
        let help = "make `duration` shorter, `step` larger or the body smaller, unless you can wait".to_owned();
        report.warn(&key_path!["time", "duration"], message, help);
    }
}

/// Warns of steps near or above the largest stable one, and of integrators that are never stable.
fn warn_of_steps(scene: &Scene, report: &mut Collector<'_>) {
    for run in 0..scene.runs.len() {
        if let Some((_, [message, help])) = scene.near_limit(run) {
            let own = key_path!["run", run, "step"];
            let path = if report.is_typed(&own) { own.to_vec() } else { key_path!["time", "step"].to_vec() };
            report.warn(&path, message, help);
        }
        if let Some([message, help]) = scene.never_stable(run) {
            let own = key_path!["run", run, "integrator"];
            let path = if report.is_typed(&own) { &own[..] } else { &key_path!["time", "integrator"] };
            report.warn(path, message, help);
        }
    }
}

fn check_frames(time: &TimeFile, report: &mut Collector<'_>) {
    let frames = time.duration * time.frames_per_second;
    if frames > MOST_FRAMES {
        let message = format!(
            "{} s at {} frames per second make {frames:.3e} frames; the most is {}",
            time.duration,
            time.frames_per_second,
            count(MOST_FRAMES as u128)
        );
        let help = "make `duration` or `frames_per_second` smaller".to_owned();
        report.at(&key_path!["time", "duration"], message, help);
    }
}
