//! `diagnostics.csv`: one row for each run and frame.

use super::{AtomicFile, OutputError, exact};
use crate::scene::Scene;
use crate::sim::snapshot::{Frame, Snapshot, Status};
use std::path::Path;

/// The name of the file in its folder.
pub const DIAGNOSTICS_FILE: &str = "diagnostics.csv";

/// Writes the diagnostics of frames as they come. The file appears with [`Self::finish`].
#[derive(Debug)]
pub struct DiagnosticsWriter {
    file: AtomicFile,
    names: Vec<String>,
    /// Length of the rows that were written whole (bytes).
    length: u64,
}

impl DiagnosticsWriter {
    /// Begins the file in `folder`.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn create(folder: &Path, scene: &Scene) -> Result<Self, OutputError> {
        let file = AtomicFile::create(&folder.join(DIAGNOSTICS_FILE))?;
        let names = scene.runs.iter().map(|run| run.name.clone()).collect();
        let mut writer = Self { file, names, length: 0 };
        writer.append(&rows([cells("", 0, &Snapshot::default()).map(|(head, _)| head.to_owned())]))?;
        Ok(writer)
    }

    /// Appends the rows of one frame, one for each run in it.
    ///
    /// # Errors
    /// If they cannot be written; rows written before stay.
    pub fn write(&mut self, frame: &Frame) -> Result<(), OutputError> {
        let names = &self.names;
        let text =
            rows(frame.runs.iter().map(|run| cells(&names[run.run], frame.index, &run.snapshot).map(|(_, cell)| cell)));
        self.append(&text)
    }

    fn append(&mut self, text: &[u8]) -> Result<(), OutputError> {
        self.file.append(text)?;
        self.length += text.len() as u64;
        Ok(())
    }

    /// Gives the file its name. Also after a failed [`Self::write`]: then it ends with the last whole frame.
    ///
    /// # Errors
    /// If it cannot be renamed.
    pub fn finish(mut self) -> Result<(), OutputError> {
        let length = self.length;
        self.file.file().set_len(length).map_err(OutputError::writing(self.file.path()))?;
        self.file.commit()
    }
}

/// The cells of a row, each with the head of its column; `docs/files.md` says what they mean.
fn cells(name: &str, frame: u64, snapshot: &Snapshot) -> [(&'static str, String); 18] {
    let d = &snapshot.diagnostics;
    let status = match snapshot.status {
        Status::Ok => "ok",
        Status::Diverged(_) => "diverged",
    };
    [
        ("run", name.to_owned()),
        ("frame", frame.to_string()),
        ("time", exact(snapshot.time)),
        ("kinetic", exact(d.kinetic)),
        ("elastic", exact(d.elastic)),
        ("gravitational", exact(d.gravitational)),
        ("momentum_x", exact(d.momentum.x)),
        ("momentum_y", exact(d.momentum.y)),
        ("momentum_z", exact(d.momentum.z)),
        ("angular_momentum_x", exact(d.angular_momentum.x)),
        ("angular_momentum_y", exact(d.angular_momentum.y)),
        ("angular_momentum_z", exact(d.angular_momentum.z)),
        ("residual", exact(d.residual)),
        ("turned_over", d.turned_over.to_string()),
        ("volume_ratio", exact(d.volume_ratio)),
        ("shape_error", exact(d.shape_error)),
        ("energy", exact(d.energy())),
        ("status", status.to_owned()),
    ]
}

/// Rows as text, with quotation marks where a name needs them.
fn rows(rows: impl IntoIterator<Item = [String; 18]>) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.write_record(&row).expect("rows of equal length into memory");
    }
    writer.into_inner().expect("memory takes all")
}
