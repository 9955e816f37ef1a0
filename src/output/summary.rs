//! `run.json`: the command, its files and its outcome.

use super::{Extremes, OutputError, Timings, state_digest, write_whole};
use crate::look::Plot;
use crate::runner::cause::Cause;
use crate::runner::{Frame, TableRow, TimeSeries};
use crate::scene::{AtRest, Rest, Run, Scene};
use crate::sim::{Chosen, Diagnostic, Diagnostics, Divergence, Reaction, Scope, Snapshot, Status, Unsolved};
use serde::Serialize;
use std::path::{Component, Path, PathBuf};

/// The name of the file in its folder.
pub(crate) const SUMMARY_FILE: &str = "run.json";

/// The contents of `run.json`, with its keys in this order.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Summary {
    /// Version of this crate.
    pub localshape: String,
    pub scene: SceneEntry,
    /// The command line, one entry for each argument.
    pub command: Vec<String>,
    /// Keys and values of `--set`, as typed; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<String>,
    pub outcome: Outcome,
    /// The requested and the written frames.
    pub frames: FrameSummary,
    /// The other files that were written; files of frames as a pattern, with the number of pictures in `frames.written`.
    pub files: Vec<String>,
    /// The graphics adapter; `null` without pictures.
    pub adapter: Option<String>,
    /// The requested runs, in the scene's order.
    pub runs: Vec<RunEntry>,
    /// A line on each animation.
    #[serde(skip)]
    pub films: Vec<String>,
    /// The time that all runs have reached, and the time of the last frame (s), if the user interrupted the command
    /// before.
    #[serde(skip)]
    pub reached: Option<[f64; 2]>,
    /// Times by stage (s); `null` before the end.
    pub times: Option<Timings>,
}

/// Identifies the scene.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct SceneEntry {
    pub title: String,
    /// Its file, as a full path; `null` if it was parsed from a text.
    pub file: Option<String>,
    /// The file relative to the folder of `run.json`; set by [`Summary::write`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relative_file: Option<String>,
    /// Digest of the scene's meaning.
    pub digest: String,
    /// The period T of the lightest node and the stiffest run (s), the unit of steps such as `T/70`.
    pub cycle: f64,
}

/// The outcome of a command for one scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Outcome {
    /// It is running, or was killed.
    Unfinished,
    /// All frames were made.
    Done,
    /// The user stopped it; all files made until then are complete.
    Interrupted,
    /// The frames are drawn in shards, and the tables are not written yet.
    Shards,
    /// Writing or drawing failed; all files made until then are complete.
    Failed,
}

/// Numbers of frames.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct FrameSummary {
    /// The number of requested frames.
    pub asked: usize,
    /// The number of simulated and recorded frames.
    pub recorded: usize,
    /// The number of written pictures; `null` without pictures.
    pub written: Option<usize>,
    /// The number of pictures of an earlier command that were kept (`--resume`); absent if there are none.
    #[serde(skip_serializing_if = "is_zero")]
    pub kept: usize,
    /// The number of pictures that equal the one before and were not drawn again; absent if there are none.
    #[serde(skip_serializing_if = "is_zero")]
    pub repeated: usize,
    /// Width and height of the pictures (px); `null` without pictures.
    pub size: Option<[u32; 2]>,
    /// The azimuth of the camera (rad); absent in the plane and without pictures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub azimuth: Option<f64>,
    /// The words without room in the pictures, each with the consequence.
    #[serde(skip)]
    pub left_out: Vec<String>,
}

/// The result of a run.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct RunEntry {
    pub name: String,
    /// The names of its bodies; absent if its only body has no name.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<String>,
    /// Time step (s).
    pub time_step: f64,
    /// The number of simulated steps, with those before an interruption; after a divergence steps are only counted.
    pub steps: u64,
    /// `ok`, `ended` or `diverged`.
    #[serde(flatten)]
    pub status: RunStatus,
    /// How near to rest it starts; absent if it does not start at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rest: Option<Rest>,
    /// When it comes to rest; absent if the scene does not end then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub comes_to_rest: Option<AtRest>,
    /// The cause of its divergence; absent if it did not diverge, or if its states are read from a file.
    #[serde(flatten)]
    pub cause: Option<Cause>,
    /// The steps until the last frame whose equation an implicit integrator has not solved; absent if it has solved all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unsolved: Option<Unsolved>,
    /// The frames drawn by this command in which a body leaves its panel; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cut: Vec<u64>,
    /// The last frame that this command recorded; `null` before the first.
    pub last: Option<LastState>,
    /// The least and the greatest values, with those before an interruption.
    #[serde(flatten)]
    pub extremes: Extremes,
}

/// The outcome of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(tag = "status", rename_all = "kebab-case")]
pub(crate) enum RunStatus {
    /// It has not diverged.
    #[default]
    Ok,
    /// Its recording has ended.
    Ended {
        /// Time of its last moment (s).
        time: f64,
    },
    /// It has diverged.
    Diverged {
        /// Time of the first step that was rejected (s).
        time: f64,
        /// Number of the rejected step.
        step: u64,
        /// The body of the node that exceeded the speed limit; absent if it has no name.
        #[serde(skip_serializing_if = "Option::is_none")]
        body: Option<String>,
        /// The first element of that body with the node.
        element: Option<usize>,
    },
}

/// The last recorded frame of a run.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct LastState {
    /// Number of the frame.
    pub frame: u64,
    /// Time (s).
    pub time: f64,
    /// All bodies together.
    #[serde(flatten)]
    pub all: Numbers,
    /// Each body, if there are several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<BodyNumbers>,
}

/// One of several bodies in the last recorded frame of its run.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct BodyNumbers {
    pub name: String,
    #[serde(flatten)]
    pub numbers: Numbers,
}

/// Numbers that describe a state.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Numbers {
    #[serde(flatten)]
    pub diagnostics: Chosen,
    /// A diagnostic that goldens do not record; `null` for a model without it.
    pub global_rotations: Option<u64>,
    /// Another one; absent for models whose parts never break.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub broken: Option<u64>,
    /// Digest of the state.
    pub state: String,
}

impl Numbers {
    fn new(diagnostics: &Diagnostics, state: String) -> Self {
        let count = |number: f64| Some(number).filter(|count| count.is_finite()).map(|count| count as u64);
        Self {
            diagnostics: Chosen::within(Scope::Summaries, diagnostics),
            global_rotations: count(diagnostics.global_rotations),
            broken: count(diagnostics.broken),
            state,
        }
    }
}

impl RunEntry {
    /// Records magnitudes of single things of a run at a time (s), and between its bodies.
    fn note_single(&mut self, time: f64, scene: &Scene, run: &Run, forces: &[Reaction], displaced: &[[f64; 6]]) {
        let all = scene.magnitudes(run, forces, displaced);
        all.iter().for_each(|(name, value)| self.extremes.note_one(name, time, *value));
        scene.between(run, forces).into_iter().for_each(|(name, value)| self.extremes.note_peak(name, time, value));
    }
}

impl Summary {
    /// The summary of `asked` frames of some of the scene's runs, before the first frame.
    pub(crate) fn new(scene: &Scene, runs: &[usize], asked: usize, command: &[String]) -> Self {
        let run = |&run: &usize| {
            let run = &scene.runs[run];
            RunEntry {
                name: run.name.clone(),
                bodies: run.body_names(scene).map(str::to_owned).collect(),
                time_step: run.step,
                rest: run.rest,
                comes_to_rest: run.comes_to_rest,
                ..RunEntry::default()
            }
        };
        Self {
            localshape: env!("CARGO_PKG_VERSION").to_owned(),
            scene: SceneEntry {
                title: scene.title.clone(),
                file: scene.file.as_ref().and_then(|file| Some(file.to_str()?.to_owned())),
                relative_file: None,
                digest: scene.digest.clone(),
                cycle: scene.cycle(),
            },
            command: command.to_vec(),
            set: Vec::new(),
            outcome: Outcome::Unfinished,
            frames: FrameSummary { asked, ..FrameSummary::default() },
            files: Vec::new(),
            adapter: None,
            runs: runs.iter().map(run).collect(),
            films: Vec::new(),
            reached: None,
            times: None,
        }
    }

    /// Records the values of a frame, and of the rows of each run before it.
    pub(crate) fn note(&mut self, scene: &Scene, frame: &Frame, between: &[Vec<TableRow>]) {
        for ((summary, rows), run) in self.runs.iter_mut().zip(between).zip(&frame.runs) {
            for TableRow { time, all, reactions, displaced, .. } in rows {
                summary.extremes.note(Diagnostic::ALL, *time, all);
                summary.note_single(*time, scene, &scene.runs[run.run], reactions, displaced);
            }
        }
        for (summary, run) in self.runs.iter_mut().zip(&frame.runs) {
            let Snapshot { time, status, diagnostics, reactions, position, .. } = &run.snapshot;
            let time = match status {
                Status::Ok => *time,
                // That of the last finite state, which the frame shows.
                Status::Diverged(divergence) => (divergence.step - 1) as f64 * summary.time_step,
            };
            summary.extremes.note(Diagnostic::ALL, time, diagnostics);
            let run = &scene.runs[run.run];
            summary.note_single(time, scene, run, reactions, &scene.all_displaced(run, position));
        }
    }

    /// Records the values of some charts over time in time series.
    pub(crate) fn note_series<'s>(&mut self, charts: &[Plot], series: impl IntoIterator<Item = &'s TimeSeries>) {
        let wanted: Vec<_> = charts.iter().filter_map(Plot::diagnostic).collect();
        for (summary, series) in self.runs.iter_mut().zip(series) {
            let moments = series.times.iter().zip(&series.diagnostics);
            moments.for_each(|(&time, all)| summary.extremes.note(&wanted, time, all));
            for (of, readings) in charts.iter().filter_map(Plot::of).zip(&series.readings) {
                // Along the path of what moves the direction has no name.
                let moments = series.times.iter().zip(readings).filter(|_| of.against.is_none());
                moments.for_each(|(&time, one)| summary.extremes.note_one(&of.key(), time, one.value));
            }
        }
    }

    /// Records the last frame.
    pub(crate) fn note_last(&mut self, scene: &Scene, frame: &Frame) {
        for (summary, run) in self.runs.iter_mut().zip(&frame.runs) {
            let (snapshot, run) = (&run.snapshot, &scene.runs[run.run]);
            summary.unsolved = snapshot.unsolved;
            summary.status = match snapshot.status {
                Status::Ok => RunStatus::Ok,
                Status::Diverged(Divergence { time, is_end: true, .. }) => RunStatus::Ended { time },
                Status::Diverged(Divergence { time, step, part, element, .. }) => {
                    RunStatus::Diverged { time, step, body: summary.bodies.get(part).cloned(), element }
                }
            };
            let of_body = |((name, nodes), diagnostics): ((&str, _), _)| {
                let numbers = Numbers::new(diagnostics, state_digest(snapshot, nodes));
                BodyNumbers { name: name.to_owned(), numbers }
            };
            summary.last = Some(LastState {
                frame: frame.index,
                time: snapshot.time,
                all: Numbers::new(&snapshot.diagnostics, state_digest(snapshot, 0..snapshot.position.len())),
                bodies: run.several(scene).zip(&snapshot.of_bodies).map(of_body).collect(),
            });
        }
    }

    /// Writes `run.json` into `folder`.
    pub(crate) fn write(&self, folder: &Path) -> Result<(), OutputError> {
        let mut summary = self.clone();
        summary.scene.relative_file = self.scene.file.as_ref().and_then(|file| relative(Path::new(file), folder));
        write_whole(&folder.join(SUMMARY_FILE), document(&summary).as_bytes())
    }
}

/// Plain data as a formatted JSON document.
pub(crate) fn document(value: &impl Serialize) -> String {
    serde_json::to_string_pretty(value).expect("plain data") + "\n"
}

/// Leaves zeros out of the summary.
fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// The relative path from a folder to a file with a full path; `None` if there is none, as between drives on Windows.
pub(crate) fn relative(file: &Path, folder: &Path) -> Option<String> {
    let folder = folder.canonicalize().ok()?;
    let shared = folder.components().zip(file.components()).take_while(|(one, other)| one == other).count();
    let up = folder.components().skip(shared).map(|_| Component::ParentDir);
    let way: PathBuf = up.chain(file.components().skip(shared)).collect();
    way.to_str().filter(|_| shared > 0).map(str::to_owned)
}
