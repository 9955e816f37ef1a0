//! `diagnostics.csv`: one row for each run and frame, further ones for each of several bodies, and on request rows between
//! frames.

use super::atomic::remove;
use super::{OutputError, exact, rows_as_csv};
use crate::runner::TableRow;
use crate::runner::growing::{Growing, Grown};
use crate::runner::{Frame, RunFrame};
use crate::scene::{ALL_BODIES, Run, Scene};
use crate::sim::{Diagnostic, Diagnostics, Reaction, Snapshot, Source, Status, Value};
use glam::DVec3;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The name of the file in its folder.
pub(crate) const DIAGNOSTICS_FILE: &str = "diagnostics.csv";

/// Its name until it is finished.
const UNFINISHED: &str = ".localshape-diagnostics.partial";

/// Writes the diagnostics of frames in order. The file gets its name in [`Self::finish`].
#[derive(Debug)]
pub(crate) struct DiagnosticsWriter<'a> {
    pub(super) scene: &'a Scene,
    file: Growing,
    hidden: PathBuf,
    pub(super) path: PathBuf,
}

impl<'a> DiagnosticsWriter<'a> {
    /// Creates the file in `folder`.
    pub(crate) fn create(folder: &Path, scene: &'a Scene) -> Result<Self, OutputError> {
        let [hidden, path] = [UNFINISHED, DIAGNOSTICS_FILE].map(|name| folder.join(name));
        let file = Growing::open(&hidden, None).map_err(OutputError::writing(&path))?;
        let mut writer = Self { scene, file, hidden, path };
        let heads = cells(["", ALL_BODIES], None, 0.0, Status::Ok, &Diagnostics::default());
        let exerted = Exerted { scene, run: None, forces: &[] }.cells(None);
        let heads = heads.into_iter().chain(exerted).map(|(head, _)| head);
        writer.append(&rows_as_csv([heads]))?;
        Ok(writer)
    }

    /// Continues after the rows of another process, whether it has finished the file or not.
    pub(crate) fn resume(folder: &Path, scene: &'a Scene, before: Grown) -> Result<Self, OutputError> {
        let [hidden, path] = [UNFINISHED, DIAGNOSTICS_FILE].map(|name| folder.join(name));
        // A finished file has lost its hidden name.
        let is_finished = !hidden.exists();
        if is_finished {
            fs::copy(&path, &hidden).map_err(OutputError::reading(&path))?;
        }
        match Growing::open(&hidden, Some(before)) {
            Ok(file) => Ok(Self { scene, file, hidden, path }),
            Err(error) if is_finished => {
                // The user may restore the finished file.
                remove(&hidden)?;
                Err(OutputError::reading(&path)(error))
            }
            Err(error) => Err(OutputError::reading(&hidden)(error)),
        }
    }

    /// Appends the rows of one frame: for each run in it one on all its bodies, then one on each if it has several. The rows
    /// of each run since the last frame come before, if there are any.
    ///
    /// # Errors
    /// If they cannot be written; rows written before stay.
    pub(crate) fn write(&mut self, frame: &Frame, between: &[Vec<TableRow>]) -> Result<(), OutputError> {
        let mut rows = Vec::new();
        for (place, RunFrame { run, snapshot, .. }) in frame.runs.iter().enumerate() {
            let run = &self.scene.runs[*run];
            let bodies: Vec<_> = run.several(self.scene).map(|(body, _)| body).collect();
            let mut add = |frame, time, status, all, of_bodies: &[Diagnostics], forces: &[Reaction]| {
                let exerted = Exerted { scene: self.scene, run: Some(run), forces };
                let own = (0..).zip(of_bodies).zip(&bodies).map(|((at, one), &body)| (Some(at), body, one));
                rows.extend(std::iter::once((None, ALL_BODIES, all)).chain(own).map(|(at, body, one)| {
                    let mut row = cells([&run.name, body], frame, time, status, one);
                    row.extend(exerted.cells(at));
                    row
                }));
            };
            // The step of a frame has the row of the frame.
            let between = between.get(place).into_iter().flatten().filter(|row| row.time < snapshot.time);
            for TableRow { time, all, of_bodies, reactions } in between {
                add(None, *time, Status::Ok, all, of_bodies, reactions);
            }
            let Snapshot { time, status, diagnostics, of_bodies, reactions, .. } = snapshot;
            add(Some(frame.index), *time, *status, diagnostics, of_bodies, reactions);
        }
        self.append(&rows_as_csv(rows.into_iter().map(|row| row.into_iter().map(|(_, cell)| cell))))
    }

    fn append(&mut self, text: &[u8]) -> Result<(), OutputError> {
        self.file.append(text).map_err(OutputError::writing(&self.path))
    }

    /// Makes the rows written so far survive a power failure.
    pub(crate) fn sync(&mut self) -> io::Result<Grown> {
        self.file.sync()
    }

    /// Renames the file to its final name. After a failed [`Self::write`] it ends with the last complete frame.
    pub(crate) fn finish(self) -> Result<(), OutputError> {
        let Self { file, hidden, path, .. } = self;
        let renamed = file.cut().and_then(|()| file.sync()).and_then(|_| fs::rename(hidden, &path));
        renamed.map_err(OutputError::writing(&path))
    }
}

/// What obstacles, constraints and bodies exert in a row of a run.
struct Exerted<'a> {
    scene: &'a Scene,
    /// `None` for headings.
    run: Option<&'a Run>,
    /// Empty if nothing is known.
    forces: &'a [Reaction],
}

impl Exerted<'_> {
    /// Force and torque of each obstacle, of each constraint and of each of several bodies, on a body of the run, or on all its bodies together,
    /// with the headings of their columns. There are none where forces are not kept.
    fn cells(&self, on: Option<usize>) -> Vec<(String, String)> {
        let Self { scene, run, forces } = *self;
        let obstacles = scene.obstacle_names.iter().enumerate();
        let obstacles = obstacles.map(|(at, name)| (vec![Source::Obstacle(at)], name));
        // A constraint on several bodies is one for each of them.
        let mut names: Vec<&String> = scene.runs.iter().flat_map(|run| &run.grip_names).collect();
        names.sort_unstable_by_key(|name| (name.starts_with("grab"), name.len(), *name));
        names.dedup();
        let gripping = |name: &String| {
            let named = run.into_iter().flat_map(|run| run.grip_names.iter().enumerate());
            named.filter(|(_, other)| *other == name).map(|(at, _)| Source::Grip(at)).collect()
        };
        let grips = names.into_iter().map(|name| (gripping(name), name));
        let own = |body: usize| run.and_then(|run| run.of.iter().position(|&of| of == body)).map(Source::Body);
        let several = scene.bodies.iter().enumerate().filter(|_| scene.bodies.len() > 1);
        let bodies = several.map(|(at, body)| (own(at).into_iter().collect(), &body.name));
        let of_source = |(from, name): (Vec<Source>, &String)| {
            let is_known = !from.is_empty() && !forces.is_empty();
            let found = forces.iter().filter(move |one| from.contains(&one.from) && on.is_none_or(|on| one.on == on));
            let name = name.clone();
            ["force", "torque"].into_iter().enumerate().flat_map(move |(at, key)| {
                let each = found.clone().map(|one| [one.force, one.torque][at]);
                let sum = if is_known { each.sum() } else { DVec3::NAN };
                let head = format!("{key} of {name}");
                ["x", "y", "z"]
                    .into_iter()
                    .zip(sum.to_array())
                    .map(move |(axis, one)| (format!("{head}_{axis}"), exact(one)))
            })
        };
        let sources = obstacles.chain(grips).chain(bodies);
        sources.filter(|_| scene.keeps_forces()).flat_map(of_source).collect()
    }
}

/// The cells of a row of a run and a body, each with the heading of its column; `docs/files.md` explains them. A row between
/// frames has no frame.
fn cells(
    [run, body]: [&str; 2],
    frame: Option<u64>,
    time: f64,
    status: Status,
    diagnostics: &Diagnostics,
) -> Vec<(String, String)> {
    let status = match status {
        Status::Ok => "ok",
        Status::Diverged(divergence) if divergence.is_end => "ended",
        Status::Diverged(_) => "diverged",
    };
    let plain = |head: &str, cell: String| (head.to_owned(), cell);
    let mut cells = vec![
        plain("run", run.to_owned()),
        plain("body", body.to_owned()),
        plain("frame", frame.map_or_else(String::new, |frame| frame.to_string())),
        plain("time", exact(time)),
    ];
    for diagnostic in Diagnostic::ALL {
        let key = diagnostic.key();
        match diagnostic.value(diagnostics) {
            Value::Count(count) => cells.push(plain(key, count.to_string())),
            Value::Number(number) => cells.push(plain(key, exact(number))),
            Value::Vector(vector) => {
                let axes = ["x", "y", "z"].into_iter().zip(vector.to_array());
                cells.extend(axes.map(|(axis, number)| (format!("{key}_{axis}"), exact(number))));
            }
        }
    }
    cells.push(plain("status", status.to_owned()));
    cells
}
