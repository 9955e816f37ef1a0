//! Resolves a scene: fills in defaults, compares lengths, checks indices. Every mistake is reported. Parts with
//! mistakes are not used.

mod body;
mod choice;
mod elements;
mod grips;
pub(super) mod lists;
mod mass;
mod mesh;
mod motion;
mod obstacles;
mod recordings;
mod runs;

use super::digest::{FileDigests, digest};
use super::file::{BodyFile, Coordinates, GrabFile, HoldFile, ObstacleFile, Positive, RunFile, SceneFile, TimeFile};
use super::generate::Generator;
use super::limits;
use super::limits::{BodySize, Excess, Limits};
use super::mesh::{MeshFile, longest};
use super::structure::ValidFile;
use super::{ALL_BODIES, Run, Scene, SceneBody, subject};
use crate::look::{self, FontFiles, TypedView, View, font};
use crate::reading::collector::{Collector, PathPart, key_path, written};
use crate::reading::coordinates::{direction, vector};
use crate::reading::words::{count, ends, quoted, short};
use crate::sim::geometry::overlaps;
use crate::sim::{Dimension, Obstacle};
use body::{ResolvedBody, TypedBody};
use choice::Choice;
use glam::DVec3;
use lists::Lists;
use recordings::ReadRecording;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value as Json};
use std::collections::BTreeSet;
use std::mem::take;
use std::path::Path;
use std::slice;
use std::sync::Arc;

/// The place of a body in a file: `body`, or `body[1]` among several.
pub(super) type Place = Vec<PathPart<'static>>;

/// The parts of a scene file without mistakes in their structure.
#[derive(Debug, Serialize)]
pub(super) struct SceneParts {
    title: Option<String>,
    gravity: Option<Coordinates>,
    time: Option<TimeFile>,
    #[serde(rename = "body")]
    bodies: Vec<Option<BodyFile>>,
    /// The place of each body in the file.
    #[serde(skip)]
    places: Vec<Place>,
    /// The content of the own file of each body, if it has no mistakes.
    #[serde(skip)]
    beside: Vec<Option<Beside>>,
    /// Top-level keys with mistakes in or below them.
    #[serde(skip)]
    flawed: BTreeSet<String>,
    #[serde(rename = "run")]
    runs: Vec<Option<RunFile>>,
    /// The recording of each run, if it has one without mistakes.
    #[serde(skip)]
    recordings: Vec<Option<ReadRecording>>,
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

/// The content of the own file of a body.
#[derive(Debug)]
enum Beside {
    Lists(Box<Lists>),
    Mesh(MeshFile),
}

impl SceneParts {
    /// The valid parts of a checked file. A body's own file is searched in `folder`.
    pub(super) fn new(checked: &ValidFile, folder: &Path, limits: &Limits, report: &mut Collector<'_>) -> Self {
        let file = &checked.valid;
        let mut bodies: Vec<Option<BodyFile>> = match file.get("body") {
            Some(Json::Array(_)) => several(file, "body", report),
            _ => vec![part(file, "body", report)],
        };
        // Lists beside a generator or a file are a mistake, which was reported.
        let has_lists =
            |body: &&mut BodyFile| body.file.is_none() && body.mesh.is_none() && Generator::of(body).is_none();
        bodies
            .iter_mut()
            .flatten()
            .filter(|body| !has_lists(body))
            .for_each(|body| body.swap_lists(&mut BodyFile::default()));
        let places = places(bodies.len(), file.get("body").is_some_and(Json::is_array));
        let beside = beside(&bodies, &places, folder, limits, report);
        let view: Option<TypedView> =
            if file.contains_key("view") { part(file, "view", report) } else { Some(TypedView::default()) };
        let font = match view.as_ref().and_then(|view| view.get("font")) {
            Some(typed) => {
                read(typed, &key_path!["view", "font"], report).and_then(|typed| font::read(folder, &typed, report))
            }
            None => Some(FontFiles::default()),
        };
        let runs: Vec<Option<RunFile>> = several(file, "run", report);
        let time: Option<TimeFile> = part(file, "time", report);
        let rate = time.as_ref().map_or(1.0, |time| time.frames_per_second);
        let recording =
            |(at, run): (usize, &Option<RunFile>)| ReadRecording::read(folder, at, run.as_ref()?, rate, limits, report);
        let recordings = runs.iter().enumerate().map(recording).collect();
        Self {
            title: part(file, "title", report),
            gravity: part(file, "gravity", report),
            time,
            bodies,
            places,
            beside,
            flawed: checked.flawed.clone(),
            runs,
            recordings,
            obstacles: several(file, "obstacle", report),
            holds: several(file, "hold", report),
            grabs: several(file, "grab", report),
            view,
            font,
        }
    }

    /// The valid parts of a scene made in code. `flawed` tells whether its separately checked long lists had a mistake. Files of bodies
    /// are searched in the current directory.
    pub(super) fn of(
        mut file: SceneFile,
        checked: &ValidFile,
        flawed: bool,
        limits: &Limits,
        report: &mut Collector<'_>,
    ) -> Self {
        fn entries<T>(entries: Vec<T>, key: &str, checked: &ValidFile) -> Vec<Option<T>> {
            let is_sound = |at: usize| !checked.valid.get(key).is_some_and(|valid| valid[at].is_null());
            entries.into_iter().enumerate().map(|(at, entry)| Some(entry).filter(|_| is_sound(at))).collect()
        }
        let is_sound = |key: &str| !checked.flawed.contains(key);
        let places = places(file.body.len(), file.body.len() > 1);
        let bodies: Vec<_> = match &mut file.body[..] {
            [only] => vec![Some(take(only)).filter(|_| is_sound("body"))],
            _ => entries(take(&mut file.body), "body", checked),
        };
        let lists = if flawed { BTreeSet::from(["body".to_owned()]) } else { BTreeSet::new() };
        Self {
            title: file.title,
            gravity: file.gravity.filter(|_| is_sound("gravity")),
            time: Some(file.time).filter(|_| is_sound("time")),
            beside: beside(&bodies, &places, Path::new(""), limits, report),
            bodies,
            places,
            flawed: &checked.flawed | &lists,
            // Runs made in code have models.
            recordings: file.run.iter().map(|_| None).collect(),
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
        let has_own_models = self.runs.iter().flatten().any(|run| run.has_own_model());
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
        let beside = |beside: &Beside| match beside {
            Beside::Lists(lists) => ("file", lists.digest()),
            Beside::Mesh(mesh) => ("mesh", mesh.digest.clone()),
        };
        let bodies = self.beside.iter().map(|one| one.as_ref().map(beside)).collect();
        let runs = self.recordings.iter().map(|read| read.as_ref().map(ReadRecording::digest)).collect();
        let files = FileDigests { bodies, runs, regular, semi_bold };
        let mut lists = vec![BodyFile::default(); self.bodies.len()];
        let swap = |bodies: &mut [Option<BodyFile>], lists: &mut [BodyFile]| {
            bodies.iter_mut().flatten().zip(lists).for_each(|(body, lists)| body.swap_lists(lists));
        };
        swap(&mut self.bodies, &mut lists);
        let digest = digest(self, &lists, files);
        swap(&mut self.bodies, &mut lists);
        digest
    }
}

/// The content of the own file of each body, searched in a folder.
fn beside(
    bodies: &[Option<BodyFile>],
    places: &[Place],
    folder: &Path,
    limits: &Limits,
    report: &mut Collector<'_>,
) -> Vec<Option<Beside>> {
    let read = |(body, place): (&Option<BodyFile>, &Place)| {
        let body = body.as_ref().filter(|body| Generator::of(body).is_none())?;
        if let Some(file) = &body.file {
            return Lists::read(folder, file, place, limits, report).map(Box::new).map(Beside::Lists);
        }
        mesh::read(folder, body, place, limits, report).map(Beside::Mesh)
    };
    bodies.iter().zip(places).map(read).collect()
}

/// The places of bodies in a file, in a list or alone.
pub(super) fn places(count: usize, is_list: bool) -> Vec<Place> {
    (0..count).map(|at| if is_list { key_path!["body", at].to_vec() } else { key_path!["body"].to_vec() }).collect()
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
/// The most rows of `diagnostics.csv` between frames, of all runs and bodies: with charts or `--states` they stay in memory until the end.
const MOST_ROWS: f64 = 1e6;

/// The physics. A part is `None` if it has a mistake, or depends on a part with one.
struct Physics {
    gravity: Option<DVec3>,
    bodies: Option<Vec<ResolvedBody>>,
    obstacles: Option<Vec<Obstacle>>,
    runs: Option<Vec<Run>>,
    /// The own bodies of recordings, after all others.
    own: Vec<ResolvedBody>,
}

/// The scene, or `None` after any mistake: first the physics, then the view.
fn resolve(
    mut parts: SceneParts,
    name: &str,
    digest: &str,
    limits: &Limits,
    report: &mut Collector<'_>,
) -> Option<Scene> {
    let (beside, recordings) = (take(&mut parts.beside), take(&mut parts.recordings));
    let physics = physics(&parts, beside, recordings, limits, report);
    let view = view(&parts, &physics, report);
    if let (0, Some(runs)) = (report.total(), &physics.runs) {
        let fixed = runs.iter().filter(|run| run.tolerance.is_none() && run.recording.is_none());
        let longest = fixed.fold(0.0, |longest: f64, run| longest.max(run.step));
        obstacles::check_steps(&parts.obstacles, longest, report);
        grips::check_steps(&parts.holds, &parts.grabs, longest, report);
        parts.time.iter().for_each(|time| check_rows(time, runs, report));
    }
    if report.total() > 0 {
        return None;
    }
    let (time, mut bodies) = (parts.time.as_ref()?, physics.bodies?);
    bodies.extend(physics.own);
    let mut scene = Scene {
        title: parts.title.clone().unwrap_or_else(|| name.into()),
        name: name.into(),
        file: None,
        digest: digest.into(),
        gravity: physics.gravity?,
        duration: time.duration,
        frames_per_second: time.frames_per_second,
        every: time.every.map(|every| every.0),
        bodies: bodies.iter().map(scene_body).collect(),
        runs: physics.runs?,
        obstacles: physics.obstacles?,
        view: view?,
        warnings: Vec::new(),
    };
    scene.place_runs();
    Scene::check_charts(&scene.view.charts, slice::from_ref(&scene), "view", report);
    warn_of_time(&scene, report);
    warn_of_steps(&scene, report);
    warn_of_overlaps(&scene, &parts.places, report);
    warn_of_braked_rotation(&scene, report);
    warn_of_sizes(&scene, &parts, report);
    if let Some((run, [message, help])) = scene.too_soft() {
        report.warn(&key_path!["run", run, "model"], message, help);
    }
    Some(scene)
}

fn physics(
    parts: &SceneParts,
    beside: Vec<Option<Beside>>,
    recordings: Vec<Option<ReadRecording>>,
    limits: &Limits,
    report: &mut Collector<'_>,
) -> Physics {
    let flawed = parts.flawed.contains("body");
    let names = check_body_names(parts, report);
    let choices = choice::resolve(&parts.runs, parts.bodies.len(), names.as_deref(), report);
    let typed = parts.bodies.iter().zip(&parts.places).zip(beside);
    // All filled surfaces together have at most so many elements.
    let mut most = limits.nodes;
    let typed: Vec<_> = typed
        .map(|((file, place), beside)| {
            let body = TypedBody::new(file.as_ref()?, beside, place.clone(), flawed, most, report)?;
            most = most.saturating_sub(body.filled());
            Some(body)
        })
        .collect();
    let dimension = dimension(parts, &typed, report);
    let bodies = bodies(typed, &choices, limits, report);
    let gravity = match (&parts.gravity, dimension) {
        (Some(typed), Some(dimension)) => vector(typed, dimension, &key_path!["gravity"], report),
        _ => Some(DVec3::ZERO),
    };
    // Where bodies start is not known without all of their keys.
    let sound: Vec<_> = bodies.iter().flatten().filter(|_| !flawed).collect();
    let obstacles = obstacles::resolve(&parts.obstacles, dimension, &sound, report);
    let is_plural = bodies.len() > 1;
    let bodies: Option<Vec<_>> = bodies.into_iter().collect();
    let bodies = bodies.filter(|bodies| bodies.iter().all(|body| Some(body.body.dimension) == dimension));
    let grips = bodies.as_ref().and_then(|bodies| grips::resolve(&parts.holds, &parts.grabs, bodies, report));
    if let Some(time) = parts.time.as_ref().filter(|_| !parts.flawed.contains("time")) {
        check_frames(time, report);
    }
    let all = bodies.as_deref().zip(dimension);
    let around = runs::Around { choices: &choices, recordings, bodies: all, grips: grips.as_deref() };
    let runs = runs::resolve(&parts.runs, parts.time.as_ref(), around, report);
    let (runs, own) = runs.map_or_else(Default::default, |(runs, own)| (Some(runs), own));
    if let (true, Some(names), Some(runs)) = (is_plural, names, &runs) {
        choice::warn_of_unused(runs, &names, &parts.places, report);
    }
    Physics { gravity, bodies, obstacles, runs, own }
}

/// The names of the bodies, empty for one without; `None` if a name has a mistake, or may be left out because of one.
fn check_body_names<'a>(parts: &'a SceneParts, report: &mut Collector<'_>) -> Option<Vec<&'a str>> {
    let (known, name) = (report.total(), |body: &'a BodyFile| body.name.as_deref());
    let named = parts.places.iter().cloned().zip(parts.bodies.iter().map(|body| body.as_ref().and_then(name)));
    choice::check_names(["body", "bodies"], named, report);
    for (body, place) in parts.bodies.iter().zip(&parts.places) {
        if body.as_ref().and_then(name) == Some(ALL_BODIES) {
            let message = format!("a body is called {}, which means all bodies of a run in files", quoted(ALL_BODIES));
            report.at(&key_path![place; "name"], message, "expected another name");
        }
    }
    if parts.bodies.len() > 1 {
        for (body, place) in parts.bodies.iter().zip(&parts.places) {
            if body.as_ref().is_some_and(|body| body.name.is_none()) {
                let message = format!("`{}` has no `name`, which each of several bodies needs", written(place));
                report.at(place, message, "such as name = \"cube\"");
            }
        }
    }
    let is_table = parts.places.iter().any(|place| place.len() == 1);
    let are_known = report.total() == known && !(is_table && parts.flawed.contains("body"));
    let names = parts.bodies.iter().map(|body| body.as_ref().map(|body| name(body).unwrap_or_default()));
    names.collect::<Option<_>>().filter(|_| are_known)
}

/// Whether the bodies are in the plane or in space. Bodies that differ from the first are reported.
fn dimension(parts: &SceneParts, typed: &[Option<TypedBody<'_>>], report: &mut Collector<'_>) -> Option<Dimension> {
    let mut dimensions = typed.iter().enumerate().filter_map(|(at, body)| Some((at, body.as_ref()?.dimension())));
    let (first, dimension) = dimensions.next()?;
    let words = |dimension| if dimension == Dimension::Plane { "in the plane" } else { "in space" };
    for (at, other) in dimensions.filter(|(_, other)| *other != dimension) {
        let [one, two] = [first, at].map(|at| written(&parts.places[at]));
        let message = format!("`{two}` is {}, but `{one}` is {}", words(other), words(dimension));
        report.at(&parts.places[at], message, "expected all bodies of a scene in the plane, or all in space");
    }
    Some(dimension)
}

/// The bodies; `None` for one with a mistake. If they are too large together, none is made.
fn bodies<'a>(
    typed: Vec<Option<TypedBody<'_>>>,
    choices: &[Option<Choice<'a>>],
    limits: &Limits,
    report: &mut Collector<'_>,
) -> Vec<Option<ResolvedBody>> {
    let size = |body: &Option<TypedBody<'_>>| body.as_ref().map_or_else(|| BodySize::new(0, []), TypedBody::size);
    let sizes: Vec<_> = typed.iter().map(size).collect();
    let run = |choice: Option<&Choice<'a>>| match choice {
        Some(choice) => choice.of.iter().zip(&choice.models).map(|(&body, typed)| (body, Some(typed.model))).collect(),
        None => (0..sizes.len()).map(|body| (body, None)).collect(),
    };
    let runs: Vec<limits::Parts<'a>> = choices.iter().map(|choice| run(choice.as_ref())).collect();
    let less = |body: usize| typed[body].as_ref().map_or("", TypedBody::less);
    let Some(Excess { message, help, place }) = limits::excess(&sizes, &runs, limits, less) else {
        return typed.into_iter().map(|body| body?.resolve(report)).collect();
    };
    match place {
        limits::Place::Body(body) => {
            typed[body].iter().for_each(|body| body.too_large(message.clone(), help.clone(), report));
        }
        limits::Place::Model(run, at) => {
            let path = choices[run].as_ref().map(|choice| &choice.models[at].path);
            path.into_iter().for_each(|path| report.at(&key_path![path; "springs"], message.clone(), help.clone()));
        }
    }
    typed.iter().flatten().for_each(|body| body.check(report));
    typed.iter().map(|_| None).collect()
}

/// The view, which `look` resolves.
fn view(parts: &SceneParts, physics: &Physics, report: &mut Collector<'_>) -> Option<View> {
    let Physics { gravity, bodies, obstacles, runs, own } = physics;
    let bodies: Vec<_> = bodies.as_ref()?.iter().chain(own).map(scene_body).collect();
    let obstacles = obstacles.as_ref()?;
    let around = subject(&bodies, runs.as_deref().unwrap_or_default(), gravity.unwrap_or_default(), obstacles);
    let view = View::read(parts.view.as_ref()?, &around, parts.font.clone().unwrap_or_default(), report)?;
    let chosen: Vec<_> = parts.runs.iter().map(|run| Some(run.as_ref()?.colour?.0)).collect();
    look::check_runs(&chosen, &view.look.palette(), report);
    warn_of_missing_letters(&view, report);
    Some(view)
}

/// Warns of texts around panels with a character that no font has.
fn warn_of_missing_letters(view: &View, report: &mut Collector<'_>) {
    for (key, text) in [("title", &view.title), ("caption", &view.caption), ("clock", &view.clock)] {
        if let Some(missing) = font::missing(&view.look.font, text) {
            let (letter, number) = (quoted(&missing.to_string()), u32::from(missing));
            let message = format!("no font has {letter} (U+{number:04X}), so that a box is drawn in its place");
            let help = "write it in other letters, or give a `view.font` that has it";
            report.warn(&key_path!["view", key], message, help);
        }
    }
}

fn scene_body(of: &ResolvedBody) -> SceneBody {
    let ResolvedBody { name, body, initial, side, has_cells, .. } = of;
    SceneBody {
        name: name.clone(),
        body: Arc::clone(body),
        initial: initial.clone(),
        side: *side,
        has_cells: *has_cells,
    }
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
            // Rounded down, there would be one frame again.
            format!("use at least {} to show the end", ends([0.0, 1.0 / scene.duration])[1]),
        );
    }
    let simulated = || (0..).zip(&scene.runs).filter(|(_, run)| run.recording.is_none());
    let steps = |run| scene.frame_step(run, last);
    let elements = |run: &Run| run.body().elements.len();
    let corners = |run: &Run| run.body().elements.indices().len().max(8) as f64;
    let seconds: f64 = simulated().map(|(at, run)| steps(at) as f64 * corners(run) * CORNER).sum();
    if seconds > LONG {
        let hours = seconds / 3600.0;
        let long = match hours {
            ..48.0 => format!("{hours:.0} hours"),
            ..10_000.0 => format!("{:.0} days", hours / 24.0),
            _ => format!("{:.0} years", hours / 8766.0),
        };
        let steps = count(simulated().map(|(at, _)| steps(at)).fold(0, u64::saturating_add).into());
        let (least, most) =
            simulated().map(|(_, run)| elements(run)).fold((usize::MAX, 0), |(a, b), one| (a.min(one), b.max(one)));
        let [fewest, elements] = [least, most].map(|elements| count(elements as u128));
        let elements = match most {
            1 => "1 element".to_owned(),
            _ if least < most => format!("{fewest} to {elements} elements"),
            _ => format!("{elements} elements"),
        };
        let message = format!("{steps} steps of all runs × {elements} take about {long} on one processor");
        let help = "make `duration` shorter, `step` larger or the body smaller, unless you can wait".to_owned();
        report.warn(&key_path!["time", "duration"], message, help);
    }
}

/// Warns of steps near or above the largest stable one, or with which bodies are soft, and of integrators that are never stable.
fn warn_of_steps(scene: &Scene, report: &mut Collector<'_>) {
    for run in 0..scene.runs.len() {
        for [message, help] in scene.near_limit(run).into_iter().chain(scene.softened(run)) {
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

/// Warns of damping that also brakes rotation where bodies turn, unless it is asked for by name.
fn warn_of_braked_rotation(scene: &Scene, report: &mut Collector<'_>) {
    for run in 0..scene.runs.len() {
        if let Some([message, help]) = scene.brakes_rotation(run) {
            let own = key_path!["run", run, "model"];
            let names = scene.runs[run].of.iter().map(|&body| scene.bodies[body].name.as_str());
            let by_name = names.map(|name| key_path!["run", run, "models", name, "damping_of"]);
            let is_named = by_name.into_iter().any(|path| report.is_typed(&path))
                || report.is_typed(&key_path![own; "damping_of"]);
            let path = if report.is_typed(&own) { own } else { key_path!["run", run, "models"] };
            if !is_named {
                report.warn(&path, message, help);
            }
        }
    }
}

/// Warns of bodies that overlap at the start of a run.
fn warn_of_overlaps(scene: &Scene, places: &[Place], report: &mut Collector<'_>) {
    let mut found = BTreeSet::new();
    let mut known: BTreeSet<&[usize]> = BTreeSet::new();
    let simulated = scene.runs.iter().filter(|run| run.recording.is_none());
    for run in simulated.filter(|run| known.insert(run.of.as_slice())) {
        let pairs = overlaps(&run.bodies, &run.initial.position, |_| true);
        found.extend(pairs.map(|pair| pair.map(|body| run.of[body])));
    }
    let Some(&[first, second]) = found.first() else { return };
    let [one, other] = [first, second].map(|body| quoted(&scene.bodies[body].name));
    let more = match found.len() - 1 {
        0 => String::new(),
        1 => ", and so does another pair".to_owned(),
        pairs => format!(", and so do {} other pairs", count(pairs as u128)),
    };
    let message = format!("{one} and {other} overlap at the start{more}: bodies go through each other");
    report.warn(&places[second], message, "move one of them, with `offset` or `lowest`, unless they may overlap");
}

/// Warns of sizes far from metres, unless a `scale` is given, and of recordings of another size.
fn warn_of_sizes(scene: &Scene, parts: &SceneParts, report: &mut Collector<'_>) {
    /// Longer bodies are rarely meant to be that long (m).
    const LONG: f64 = 50.0;
    let typed = parts.bodies.iter().flatten().zip(&parts.places);
    let length =
        |SceneBody { body, .. }: &SceneBody| longest(body.carried.as_ref().map_or(&body.rest, |fine| &fine.rest));
    let sizes = scene.bodies.iter().map(length).zip(typed);
    let long: Vec<_> = sizes.filter(|(length, (file, _))| *length >= LONG && file.scale.is_none()).collect();
    if let Some(&(length, (file, place))) = long.first() {
        let more = if long.len() > 1 { ", as are others" } else { "" };
        let length = short(length);
        match &file.mesh {
            Some(name) => report.warn(
                &key_path![place; "mesh"],
                format!("`{name}` is {length} m long{more}, as no `scale` is given"),
                "write scale = 0.001 if its unit is the millimetre, scale = 1 if it is the metre",
            ),
            None => report.warn(
                place,
                format!("{} is {length} m long{more}", body::in_words(file.name.as_deref().unwrap_or_default())),
                "lengths are in metres: divide those of the body by 1000 if they are in millimetres, unless it is that long",
            ),
        }
    }
    for run in 0..scene.runs.len() {
        // Whoever gives a scale means it.
        if !report.is_typed(&key_path!["run", run, "scale"])
            && let Some([message, help]) = scene.misfits(run)
        {
            report.warn(&key_path!["run", run, "states"], message, help);
        }
    }
}

fn check_frames(time: &TimeFile, report: &mut Collector<'_>) {
    let TimeFile { duration, frames_per_second: rate, .. } = time;
    let number = duration * rate;
    if number > MOST_FRAMES {
        let most = count(MOST_FRAMES as u128);
        let message = format!("{duration} s at {rate} frames per second make {number:.3e} frames; the most is {most}");
        report.at(&key_path!["time", "duration"], message, "make `duration` or `frames_per_second` smaller");
    }
}

/// Each step has one row at most for all bodies of a run, and one for each of several.
fn check_rows(time: &TimeFile, runs: &[Run], report: &mut Collector<'_>) {
    let (duration, Some(Positive(every))) = (time.duration, time.every) else { return };
    let together = |run: &Run| if run.of.len() > 1 { 1.0 + run.of.len() as f64 } else { 1.0 };
    let number: f64 = runs.iter().map(|run| together(run) * duration / every.max(run.step)).sum();
    if number > MOST_ROWS {
        let (most, all) = (count(MOST_ROWS as u128), runs.iter().map(together).sum::<f64>());
        let message = format!(
            "{duration} s with a row every {every} s make {number:.3e} rows of all runs and bodies; the most is {most}"
        );
        let help = format!("write every = {:.3e} or more, or make `duration` smaller", duration * all / MOST_ROWS);
        report.at(&key_path!["time", "every"], message, help);
    }
}
