//! `diagnostics.csv`: one row for each run and frame, further ones for each of several bodies, and on request rows between
//! frames.

use super::atomic::remove;
use super::{OutputError, exact, rows_as_csv};
use crate::runner::TableRow;
use crate::runner::growing::{Growing, Grown};
use crate::runner::{Frame, RunFrame};
use crate::scene::measure::{Forces, SIZES};
use crate::scene::{ALL_BODIES, Scene};
use crate::sim::{Diagnostic, Diagnostics, Reaction, Snapshot, Status, Value};
use glam::DVec3;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The name of the file in its folder.
pub(crate) const DIAGNOSTICS_FILE: &str = "diagnostics.csv";

/// Its name until it is finished.
const UNFINISHED: &str = ".localshape-diagnostics.partial";

/// Forces and displacements of a row.
type Known<'a> = (&'a [Reaction], &'a [[f64; 6]]);

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
        let measured = Measured { scene, forces: Forces::new(scene, None, &[]), displaced: &[] }.cells(None);
        let heads = heads.into_iter().chain(measured).map(|(head, _)| head);
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
            let mut add = |frame, time, status, all, of_bodies: &[Diagnostics], (forces, displaced): Known<'_>| {
                let forces = Forces::new(self.scene, Some(run), forces);
                let measured = Measured { scene: self.scene, forces, displaced };
                let own = (0..).zip(of_bodies).zip(&bodies).map(|((at, one), &body)| (Some(at), body, one));
                rows.extend(std::iter::once((None, ALL_BODIES, all)).chain(own).map(|(at, body, one)| {
                    let mut row = cells([&run.name, body], frame, time, status, one);
                    row.extend(measured.cells(at));
                    row
                }));
            };
            // The step of a frame has the row of the frame.
            let between = between.get(place).into_iter().flatten().filter(|row| row.time < snapshot.time);
            for TableRow { time, all, of_bodies, reactions, displaced } in between {
                add(None, *time, Status::Ok, all, of_bodies, (&reactions[..], &displaced[..]));
            }
            let Snapshot { time, status, diagnostics, of_bodies, reactions, position, .. } = snapshot;
            let displaced = self.scene.all_displaced(run, position);
            add(Some(frame.index), *time, *status, diagnostics, of_bodies, (&reactions[..], &displaced[..]));
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

/// What obstacles, constraints and bodies exert in a row of a run, and how far probes have moved.
struct Measured<'a> {
    scene: &'a Scene,
    forces: Forces<'a>,
    /// The displacements of probes; empty for headings.
    displaced: &'a [[f64; 6]],
}

impl Measured<'_> {
    /// Force and torque of each obstacle, of each constraint and of each of several bodies, on a body of the run, or on all its bodies together,
    /// with the headings of their columns, where forces are kept; then the displacement of each probe.
    fn cells(&self, on: Option<usize>) -> Vec<(String, String)> {
        let Self { scene, forces, displaced } = self;
        let of_source = |(name, sums): (&str, [DVec3; 2])| {
            let both = ["force", "torque"].into_iter().zip(sums);
            both.flat_map(|(key, sum)| axes(&format!("{key} of {name}"), sum)).collect::<Vec<_>>()
        };
        let mut cells: Vec<_> = forces.on(on).filter(|_| scene.keeps_forces()).flat_map(of_source).collect();
        let first = on.map_or(0, |on| on + 1) * scene.probes.len();
        for (at, probe) in scene.probes.iter().enumerate() {
            let [x, y, z, sizes @ ..] = displaced.get(first + at).copied().unwrap_or([f64::NAN; 6]);
            let head = format!("displacement of {}", probe.name);
            cells.extend(axes(&head, DVec3::new(x, y, z)));
            let sizes = SIZES.into_iter().zip(sizes);
            cells.extend(sizes.map(|(key, size)| (format!("{head}_{key}"), exact(size))));
        }
        cells
    }
}

/// The cells of a vector, with the headings of their columns.
fn axes(head: &str, vector: DVec3) -> [(String, String); 3] {
    let cell = |(axis, number): (&str, f64)| (format!("{head}_{axis}"), exact(number));
    [("x", vector.x), ("y", vector.y), ("z", vector.z)].map(cell)
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
            Value::Vector(vector) => cells.extend(axes(key, vector)),
        }
    }
    cells.push(plain("status", status.to_owned()));
    cells
}
