//! `diagnostics.csv`: one row for each run and frame.

use super::{AtomicFile, OutputError, exact};
use crate::scene::Scene;
use crate::sim::diagnostics::{Diagnostic, Value};
use crate::sim::snapshot::{Frame, RunFrame, Snapshot, Status};
use std::path::Path;

/// The name of the file in its folder.
pub(crate) const DIAGNOSTICS_FILE: &str = "diagnostics.csv";

/// Writes the diagnostics of frames, one after the other. The file gets its name in [`Self::finish`].
#[derive(Debug)]
pub(crate) struct DiagnosticsWriter {
    file: AtomicFile,
    names: Vec<String>,
    /// Length of the completely written rows (bytes).
    length: u64,
}

impl DiagnosticsWriter {
    /// Creates the file in `folder`.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(crate) fn create(folder: &Path, scene: &Scene) -> Result<Self, OutputError> {
        let file = AtomicFile::create(&folder.join(DIAGNOSTICS_FILE))?;
        let names = scene.runs.iter().map(|run| run.name.clone()).collect();
        let mut writer = Self { file, names, length: 0 };
        writer.append(&rows([cells("", 0, &Snapshot::default()).into_iter().map(|(head, _)| head)]))?;
        Ok(writer)
    }

    /// Appends the rows of one frame, one for each run in it.
    ///
    /// # Errors
    /// If they cannot be written; rows written before stay.
    pub(crate) fn write(&mut self, frame: &Frame) -> Result<(), OutputError> {
        let names = &self.names;
        let row = |run: &RunFrame| cells(&names[run.run], frame.index, &run.snapshot).into_iter().map(|(_, cell)| cell);
        self.append(&rows(frame.runs.iter().map(row)))
    }

    fn append(&mut self, text: &[u8]) -> Result<(), OutputError> {
        self.file.append(text)?;
        self.length += text.len() as u64;
        Ok(())
    }

    /// Renames the file to its final name. Also after a failed [`Self::write`]: the file then ends with the last
    /// complete frame.
    ///
    /// # Errors
    /// If it cannot be renamed.
    pub(crate) fn finish(mut self) -> Result<(), OutputError> {
        let length = self.length;
        self.file.file().set_len(length).map_err(OutputError::writing(self.file.path()))?;
        self.file.commit()
    }
}

/// The cells of a row, each with the heading of its column; `docs/files.md` explains them.
fn cells(name: &str, frame: u64, snapshot: &Snapshot) -> Vec<(String, String)> {
    let status = match snapshot.status {
        Status::Ok => "ok",
        Status::Diverged(_) => "diverged",
    };
    let plain = |head: &str, cell: String| (head.to_owned(), cell);
    let mut cells =
        vec![plain("run", name.to_owned()), plain("frame", frame.to_string()), plain("time", exact(snapshot.time))];
    for diagnostic in Diagnostic::ALL {
        let key = diagnostic.key();
        match diagnostic.value(&snapshot.diagnostics) {
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

/// Rows as CSV, quoted where necessary.
fn rows(rows: impl IntoIterator<Item = impl Iterator<Item = String>>) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.write_record(row.collect::<Vec<_>>()).expect("rows of equal length into memory");
    }
    writer.into_inner().expect("memory takes all")
}
