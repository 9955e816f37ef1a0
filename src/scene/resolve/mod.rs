//! Resolves a typed scene: fills in defaults, compares lengths, checks indices. Every mistake is reported. Parts with
//! mistakes are not used.

mod archive;
mod body;
mod choice;
mod contact;
mod disorder;
mod doubts;
mod elements;
mod faces;
mod grips;
mod lists;
mod loads;
mod mass;
mod mesh;
mod motion;
mod nodes;
mod obstacles;
mod probes;
mod recordings;
mod regions;
mod rest;
mod runs;
mod steps;
mod table;
mod until;

use super::digest::{FileDigests, digest};
use super::file::{BodyFile, Positive, SceneFile, TimeFile};
use super::limits;
use super::limits::{BodySize, Excess, Limits};
use super::typed::part;
use super::{ALL_BODIES, Run, Scene, SceneBody};
use crate::look::{self, FontFiles, View, font};
use crate::reading::collector::{Collector, Here};
use crate::reading::coordinates::{direction, vector};
use crate::reading::words::{count, quoted};
use crate::sim::Dimension;
use body::TypedBody;
use choice::Choice;
use glam::DVec3;
use recordings::ReadRecording;
use std::collections::BTreeSet;
use std::path::Path;
use std::slice;

/// The most frames a scene may have: at 60 a second nearly two days of film.
const MOST_FRAMES: f64 = 1e7;
/// The most rows of `diagnostics.csv` between frames, of all runs and bodies: with charts or `--states` they stay in memory until the end.
const MOST_ROWS: f64 = 1e6;

/// A typed scene, and where it comes from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Typed<'a> {
    pub(super) file: &'a SceneFile,
    /// Top-level keys with mistakes in or below them.
    pub(super) flawed: &'a BTreeSet<String>,
    /// Whether bodies are a list, even of one.
    pub(super) is_list: bool,
    /// The folder of the files that it names.
    pub(super) folder: &'a Path,
    pub(super) limits: &'a Limits,
    pub(super) report: &'a Collector<'a>,
}

impl<'a> Typed<'a> {
    /// The place of a body in the scene: `body`, or `body[1]` among several.
    fn place(&self, body: usize) -> Here<'a> {
        let all = self.report.to("body");
        if self.is_list { all.to(body) } else { all }
    }

    /// The place of a key of a run, or of that of `[time]` if the run has none of its own.
    fn of_run(&self, run: usize, key: &'static str) -> Here<'a> {
        let own = self.report.to("run").to(run).to(key);
        if own.is_typed() { own } else { self.report.to("time").to(key) }
    }

    /// The entries of a list that have no mistakes, each with its place.
    fn each<'e, T>(
        &self,
        key: &'static str,
        list: &'e [Option<T>],
    ) -> impl Iterator<Item = (Here<'a>, &'e T)> + use<'a, 'e, T> {
        let here = self.report.to(key);
        list.iter().enumerate().filter_map(move |(at, one)| Some((here.to(at), one.as_ref()?)))
    }

    /// The scene with this name, or `None` after any mistake: first the physics, then the view.
    pub(super) fn resolve(&self, name: &str) -> Option<Scene> {
        let Self { file, report, .. } = *self;
        let mut physics = self.physics(name);
        physics.iter_mut().for_each(|(scene, _)| rest::start(self, scene));
        let font = self.font().unwrap_or_default();
        let (mut scene, mut files) = physics?;
        let view = View::read(&file.view, &scene, font, report);
        if let Some(view) = &view {
            let chosen: Vec<_> = file.run.iter().map(|run| Some(run.as_ref()?.colour?.0)).collect();
            look::check_runs(&chosen, &view.look.palette(), report);
        }
        if report.total() == 0 {
            let fixed = scene.runs.iter().filter(|run| run.tolerance.is_none() && run.recording.is_none());
            let longest = fixed.fold(0.0, |longest: f64, run| longest.max(run.step));
            obstacles::check_steps(self, longest);
            grips::check_steps(self, longest);
            loads::check_steps(self, longest);
            file.time.iter().for_each(|time| check_rows(time, &scene.runs, report));
        }
        scene.view = view.filter(|_| report.total() == 0)?;
        let FontFiles { regular, semi_bold } = &scene.view.look.font;
        [files.regular, files.semi_bold] = [regular, semi_bold].map(|font| font.as_deref().map(font::digest));
        if !file.run.iter().flatten().any(|run| run.has_own_model()) {
            scene.digest = digest(file, files);
        }
        scene.place_runs();
        Scene::check_charts(&scene.view.charts, slice::from_ref(&scene), "view", report);
        if let Some(contacts) = &scene.contacts {
            contact::check_starts(&scene, contacts, self);
            contact::check_pairs(&scene, contacts, report);
            contact::check_idle_thickness(&scene, contacts, self);
        }
        doubts::warn(&scene, self);
        until::end(self, &mut scene);
        Some(Scene { warnings: report.warnings(), ..scene })
    }

    /// The scene without a view and a digest, and the digests of the files of its bodies and runs; `None` without bodies or obstacles because of
    /// mistakes. Other parts with mistakes are empty.
    fn physics(&self, name: &str) -> Option<(Scene, FileDigests)> {
        let Self { file, flawed, limits, report, .. } = *self;
        let names = self.body_names();
        let choices = choice::resolve(&file.run, file.body.len(), names.as_deref(), report);
        // All filled surfaces together have at most so many elements.
        let mut most = limits.nodes;
        let read = |at| {
            let body = TypedBody::read(self, at, most)?;
            most = most.saturating_sub(body.filled());
            Some(body)
        };
        let typed: Vec<_> = (0..file.body.len()).map(read).collect();
        let recordings: Vec<_> = (0..file.run.len()).map(|at| ReadRecording::read(self, at)).collect();
        let files = FileDigests {
            bodies: typed.iter().map(|body| body.as_ref()?.digest.clone()).collect(),
            runs: recordings.iter().map(|read| read.as_ref().map(ReadRecording::digest)).collect(),
            ..FileDigests::default()
        };
        let dimension = self.dimension(&typed);
        let bodies = bodies(typed, &choices, limits);
        let gravity = file.gravity.as_ref().zip(dimension);
        let gravity = gravity.and_then(|(typed, dimension)| vector(typed, dimension, &report.to("gravity")));
        // Where bodies start is not known without all of their keys.
        let sound: Vec<_> = bodies.iter().flatten().filter(|_| !flawed.contains("body")).collect();
        contact::check_obstacle_names(self);
        let obstacles = obstacles::resolve(self, dimension, &sound);
        let bodies: Option<Vec<_>> = bodies.into_iter().collect();
        let is_alike = |body: &SceneBody| Some(body.body.dimension()) == dimension;
        let mut bodies = bodies.filter(|bodies| !bodies.is_empty() && bodies.iter().all(is_alike));
        let contacts = bodies.as_ref().and_then(|bodies| contact::resolve(self, bodies));
        if let (Some(bodies), Some(obstacles), Some(contacts)) = (&mut bodies, &obstacles, &contacts) {
            contact::separate(self, bodies, obstacles, contacts, &choices);
        }
        let grips = bodies.as_ref().map(|bodies| grips::resolve(self, bodies)).unwrap_or_default();
        let loads = bodies.as_ref().map(|bodies| loads::resolve(self, bodies)).unwrap_or_default();
        let probes = bodies.as_ref().map(|bodies| probes::resolve(self, bodies)).unwrap_or_default();
        if let Some(time) = file.time.as_ref().filter(|_| !flawed.contains("time")) {
            check_frames(time, report);
        }
        choice::check_names(["run", "runs"], self.each("run", &file.run).map(|(here, run)| (here, Some(&*run.name))));
        let runs = bodies.as_ref().and_then(|bodies| {
            loads::warn_of_held(&loads, &grips);
            runs::Resolved { scene: self, choices: &choices, bodies, grips: &grips, loads: &loads }.runs(recordings)
        });
        let (runs, own) = runs.unzip();
        bodies.iter_mut().zip(own).for_each(|(bodies, own)| bodies.extend(own));
        let scene = Scene {
            gravity: gravity.unwrap_or_default(),
            bodies: bodies?,
            runs: runs.unwrap_or_default(),
            obstacles: obstacles?,
            contacts,
            probes,
            ..self.bare(name)
        };
        Some((scene, files))
    }

    /// The scene without the parts that are resolved.
    fn bare(&self, name: &str) -> Scene {
        let file = self.file;
        let time = file.time.clone().unwrap_or_default();
        Scene {
            title: file.title.clone().unwrap_or_else(|| name.into()),
            name: name.into(),
            file: None,
            digest: String::new(),
            gravity: DVec3::ZERO,
            mass_damping: file.mass_damping(),
            duration: time.duration,
            frames_per_second: time.frames_per_second,
            every: time.every.map(|every| every.0),
            bodies: Vec::new(),
            runs: Vec::new(),
            obstacles: Vec::new(),
            obstacle_names: obstacles::names(file),
            contacts: None,
            probes: Vec::new(),
            view: View::default(),
            warnings: Vec::new(),
        }
    }

    /// The names of the bodies, empty for one without; `None` if a name has a mistake, or may be left out because of one.
    fn body_names(&self) -> Option<Vec<&'a str>> {
        let (known, name) = (self.report.total(), |body: &'a BodyFile| body.name.as_deref());
        let bodies = || (0..).zip(&self.file.body).map(|(at, body)| (self.place(at), body.as_ref()));
        choice::check_names(["body", "bodies"], bodies().map(|(place, body)| (place, body.and_then(name))));
        for (place, body) in bodies() {
            if body.and_then(name) == Some(ALL_BODIES) {
                let message =
                    format!("a body is called {}, which means all bodies of a run in files", quoted(ALL_BODIES));
                place.to("name").wrong(message, "expected another name");
            }
            if self.file.body.len() > 1 && body.is_some_and(|body| body.name.is_none()) {
                let message = format!("`{place}` has no `name`, which each of several bodies needs");
                place.wrong(message, "such as name = \"cube\"");
            }
        }
        let are_known = self.report.total() == known && (self.is_list || !self.flawed.contains("body"));
        let names = bodies().map(|(_, body)| body.map(|body| name(body).unwrap_or_default()));
        names.collect::<Option<_>>().filter(|_| are_known)
    }

    /// Whether the bodies are in the plane or in space. Bodies that differ from the first are reported.
    fn dimension(&self, typed: &[Option<TypedBody<'_>>]) -> Option<Dimension> {
        let mut dimensions = typed.iter().enumerate().filter_map(|(at, body)| Some((at, body.as_ref()?.dimension())));
        let (first, dimension) = dimensions.next()?;
        let words = |dimension| if dimension == Dimension::Plane { "in the plane" } else { "in space" };
        for (at, other) in dimensions.filter(|(_, other)| *other != dimension) {
            let [one, two] = [first, at].map(|at| self.place(at));
            let message = format!("`{two}` is {}, but `{one}` is {}", words(other), words(dimension));
            two.wrong(message, "expected all bodies of a scene in the plane, or all in space");
        }
        Some(dimension)
    }

    /// The fonts of the view, or `None` after a mistake in them.
    fn font(&self) -> Option<FontFiles> {
        let report = self.report;
        if !self.file.view.contains_key("font") {
            return Some(FontFiles::default());
        }
        font::read(self.folder, &part(&self.file.view, "font", &report.to("view"))?, report)
    }
}

/// The bodies; `None` for one with a mistake. If they are too large together, none is made.
fn bodies<'a>(
    typed: Vec<Option<TypedBody<'_>>>,
    choices: &[Option<Choice<'a>>],
    limits: &Limits,
) -> Vec<Option<SceneBody>> {
    let size = |body: &Option<TypedBody<'_>>| body.as_ref().map_or_else(|| BodySize::new(0, []), TypedBody::size);
    let sizes: Vec<_> = typed.iter().map(size).collect();
    let run = |choice: Option<&Choice<'a>>| match choice {
        Some(choice) => choice.of.iter().zip(&choice.models).map(|(&body, typed)| (body, Some(typed.model))).collect(),
        None => (0..sizes.len()).map(|body| (body, None)).collect(),
    };
    let runs: Vec<limits::RunBodies<'a>> = choices.iter().map(|choice| run(choice.as_ref())).collect();
    let less = |body: usize| typed[body].as_ref().map_or("", |body| body.sized_by().1);
    let Some(Excess { message, help, of }) = limits::excess(&sizes, &runs, limits, less) else {
        let young = |at: usize| {
            let all = choices.iter().flatten().flat_map(|choice| choice.of.iter().zip(&choice.models));
            all.filter(|(of, _)| **of == at).map(|(_, typed)| typed.model.young()).collect::<Vec<_>>()
        };
        return typed.into_iter().enumerate().map(|(at, body)| body?.resolve(&young(at))).collect();
    };
    match of {
        limits::Largest::Body(body) => {
            typed[body].iter().for_each(|body| body.too_large(message.clone(), help.clone()));
        }
        limits::Largest::Model(run, at) => {
            let choice = choices[run].as_ref();
            choice.into_iter().for_each(|of| of.models[at].here.to("springs").wrong(message.clone(), help.clone()));
        }
    }
    typed.iter().flatten().for_each(TypedBody::check);
    typed.iter().map(|_| None).collect()
}

/// Reports more frames or rows than there may be.
fn check_frames(time: &TimeFile, report: &Collector<'_>) {
    let TimeFile { duration, frames_per_second: rate, .. } = time;
    let number = duration * rate;
    if number > MOST_FRAMES {
        let most = count(MOST_FRAMES as u128);
        let message = format!("{duration} s at {rate} frames per second make {number:.3e} frames; the most is {most}");
        report.to("time").to("duration").wrong(message, "make `duration` or `frames_per_second` smaller");
    }
}

/// Each step has one row at most for all bodies of a run, and one for each of several.
fn check_rows(time: &TimeFile, runs: &[Run], report: &Collector<'_>) {
    let (duration, Some(Positive(every))) = (time.duration, time.every) else { return };
    let together = |run: &Run| if run.of.len() > 1 { 1.0 + run.of.len() as f64 } else { 1.0 };
    let number: f64 = runs.iter().map(|run| together(run) * duration / every.max(run.step)).sum();
    if number > MOST_ROWS {
        let (most, all) = (count(MOST_ROWS as u128), runs.iter().map(together).sum::<f64>());
        let message = format!(
            "{duration} s with a row every {every} s make {number:.3e} rows of all runs and bodies; the most is {most}"
        );
        let help = format!("write every = {:.3e} or more, or make `duration` smaller", duration * all / MOST_ROWS);
        report.to("time").to("every").wrong(message, help);
    }
}
