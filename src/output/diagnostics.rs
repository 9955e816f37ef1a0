//! `diagnostics.csv`: one row for each run and frame, and further ones for each of several bodies.

use super::atomic::open_growing;
use super::{OutputError, exact, rows_as_csv};
use crate::scene::{ALL_BODIES, Scene};
use crate::sim::{Diagnostic, Diagnostics, Frame, RunFrame, Snapshot, Status, Value};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Seek, Write};
use std::path::{Path, PathBuf};

/// The name of the file in its folder.
pub(crate) const DIAGNOSTICS_FILE: &str = "diagnostics.csv";

/// Its name until it is finished.
const UNFINISHED: &str = ".localshape-diagnostics.partial";

/// Writes the diagnostics of frames in order. The file gets its name in [`Self::finish`].
#[derive(Debug)]
pub(crate) struct DiagnosticsWriter<'a> {
    pub(super) scene: &'a Scene,
    file: File,
    hidden: PathBuf,
    pub(super) path: PathBuf,
    written: Rows,
    /// The digest of the written bytes.
    digest: Sha256,
}

/// Completely written rows, with the heading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Rows {
    /// Their length (bytes).
    length: u64,
    /// Their SHA-256.
    digest: [u8; 32],
}

impl<'a> DiagnosticsWriter<'a> {
    /// Creates the file in `folder`.
    pub(crate) fn create(folder: &Path, scene: &'a Scene) -> Result<Self, OutputError> {
        let mut writer = Self::open(folder, scene, Rows::default())?;
        let none = Snapshot::default();
        let heads = cells("", ALL_BODIES, 0, &none, &none.diagnostics).into_iter().map(|(head, _)| head);
        writer.append(&rows_as_csv([heads]))?;
        Ok(writer)
    }

    /// Continues after the rows of another process, whether it has finished the file or not.
    pub(crate) fn resume(folder: &Path, scene: &'a Scene, before: Rows) -> Result<Self, OutputError> {
        let [hidden, path] = [UNFINISHED, DIAGNOSTICS_FILE].map(|name| folder.join(name));
        // A finished file has lost its hidden name.
        if !hidden.metadata().is_ok_and(|found| found.len() >= before.length) {
            fs::copy(&path, &hidden).map_err(OutputError::reading(&path))?;
        }
        let mut writer = Self::open(folder, scene, before)?;
        writer.digest = digest_of(&mut writer.file).map_err(OutputError::reading(&path))?;
        match writer.written() == before {
            true => Ok(writer),
            false => Err(OutputError::reading(&path)(io::ErrorKind::InvalidData.into())),
        }
    }

    fn open(folder: &Path, scene: &'a Scene, before: Rows) -> Result<Self, OutputError> {
        let [hidden, path] = [UNFINISHED, DIAGNOSTICS_FILE].map(|name| folder.join(name));
        let file = open_growing(&hidden, before.length).map_err(OutputError::writing(&path))?;
        Ok(Self { scene, file, hidden, path, written: before, digest: Sha256::new() })
    }

    /// Appends the rows of one frame: for each run in it one on all its bodies, then one on each if it has several.
    ///
    /// # Errors
    /// If they cannot be written; rows written before stay.
    pub(crate) fn write(&mut self, frame: &Frame) -> Result<(), OutputError> {
        let scene = self.scene;
        let rows = frame.runs.iter().flat_map(|RunFrame { run, snapshot, .. }| {
            let run = &scene.runs[*run];
            let of_bodies = run.several(scene).map(|(body, _)| body).zip(&snapshot.of_bodies);
            let rows = std::iter::once((ALL_BODIES, &snapshot.diagnostics)).chain(of_bodies);
            rows.map(|(body, diagnostics)| cells(&run.name, body, frame.index, snapshot, diagnostics))
        });
        self.append(&rows_as_csv(rows.map(|row| row.into_iter().map(|(_, cell)| cell))))
    }

    fn append(&mut self, text: &[u8]) -> Result<(), OutputError> {
        self.file.write_all(text).map_err(OutputError::writing(&self.path))?;
        self.digest.update(text);
        self.written.length += text.len() as u64;
        Ok(())
    }

    /// The rows written so far.
    fn written(&self) -> Rows {
        Rows { digest: self.digest.clone().finalize().into(), ..self.written }
    }

    /// Makes the rows written so far survive a power failure.
    pub(crate) fn sync(&mut self) -> io::Result<Rows> {
        self.file.sync_data()?;
        Ok(self.written())
    }

    /// Renames the file to its final name. After a failed [`Self::write`] it ends with the last complete frame.
    pub(crate) fn finish(self) -> Result<(), OutputError> {
        let Self { file, hidden, path, written, .. } = self;
        let renamed =
            file.set_len(written.length).and_then(|()| file.sync_data()).and_then(|()| fs::rename(hidden, &path));
        renamed.map_err(OutputError::writing(&path))
    }
}

/// The digest of a whole file, leaving the position at its end.
fn digest_of(file: &mut File) -> io::Result<Sha256> {
    file.rewind()?;
    let (mut digest, mut reader) = (Sha256::new(), BufReader::new(file));
    loop {
        let bytes = reader.fill_buf()?;
        if bytes.is_empty() {
            return Ok(digest);
        }
        digest.update(bytes);
        let length = bytes.len();
        reader.consume(length);
    }
}

/// The cells of a row, each with the heading of its column; `docs/files.md` explains them.
fn cells(run: &str, body: &str, frame: u64, snapshot: &Snapshot, diagnostics: &Diagnostics) -> Vec<(String, String)> {
    let status = match snapshot.status {
        Status::Ok => "ok",
        Status::Diverged(divergence) if divergence.is_end => "ended",
        Status::Diverged(_) => "diverged",
    };
    let plain = |head: &str, cell: String| (head.to_owned(), cell);
    let mut cells = vec![
        plain("run", run.to_owned()),
        plain("body", body.to_owned()),
        plain("frame", frame.to_string()),
        plain("time", exact(snapshot.time)),
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
