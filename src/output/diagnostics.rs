//! `diagnostics.csv`: one row for each run and frame.

use super::{AtomicFile, OutputError, exact};
use crate::scene::Scene;
use crate::sim::snapshot::{Frame, Snapshot, Status};
use std::path::Path;

/// The name of the file in its folder.
pub const DIAGNOSTICS_FILE: &str = "diagnostics.csv";

/// The heads of the columns. SI units; see [`crate::sim::snapshot::Diagnostics`] for what each one says.
const COLUMNS: [&str; 17] = [
    "run",
    "frame",
    "time",
    "kinetic",
    "elastic",
    "gravitational",
    "momentum_x",
    "momentum_y",
    "momentum_z",
    "angular_momentum_x",
    "angular_momentum_y",
    "angular_momentum_z",
    "residual",
    "turned_over",
    "volume_ratio",
    "shape_error",
    "status",
];

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
        writer.append(&rows([COLUMNS.map(str::to_owned)]))?;
        Ok(writer)
    }

    /// Appends the rows of one frame, one for each run in it.
    ///
    /// # Errors
    /// If they cannot be written; rows written before stay.
    pub fn write(&mut self, frame: &Frame) -> Result<(), OutputError> {
        let names = &self.names;
        let text = rows(frame.runs.iter().map(|run| row(&names[run.run], frame.index, &run.snapshot)));
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

fn row(name: &str, frame: u64, snapshot: &Snapshot) -> [String; 17] {
    let d = &snapshot.diagnostics;
    let status = match snapshot.status {
        Status::Ok => "ok",
        Status::Diverged(_) => "diverged",
    };
    [
        name.to_owned(),
        frame.to_string(),
        exact(snapshot.time),
        exact(d.kinetic),
        exact(d.elastic),
        exact(d.gravitational),
        exact(d.momentum.x),
        exact(d.momentum.y),
        exact(d.momentum.z),
        exact(d.angular_momentum.x),
        exact(d.angular_momentum.y),
        exact(d.angular_momentum.z),
        exact(d.residual),
        d.turned_over.to_string(),
        exact(d.volume_ratio),
        exact(d.shape_error),
        status.to_owned(),
    ]
}

/// Rows as text, with quotation marks where a name needs them.
fn rows(rows: impl IntoIterator<Item = [String; 17]>) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.write_record(&row).expect("rows of equal length into memory");
    }
    writer.into_inner().expect("memory takes all")
}
