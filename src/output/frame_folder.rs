//! Folders with frames and diagnostics, written by other programs.

use super::{DiagnosticsWriter, OutputError};
use crate::runner::Frame;
use crate::scene::Scene;
use std::fs;
use std::io;
use std::path::Path;

/// A folder with the frames of a scene and their diagnostics, in the files of `localshape render`.
///
/// A file has its name only when it is complete. The folder is not locked: only one program may write to it.
#[derive(Debug)]
pub struct FrameFolder<'a> {
    pub(super) diagnostics: DiagnosticsWriter<'a>,
}

impl<'a> FrameFolder<'a> {
    /// Creates the folder, if it does not exist, for frames of a scene.
    ///
    /// # Errors
    /// If it cannot be created or written to.
    pub fn create(path: impl AsRef<Path>, scene: &'a Scene) -> io::Result<Self> {
        let path = path.as_ref();
        fs::create_dir_all(path).map_err(OutputError::writing(path)).map_err(io::Error::other)?;
        Ok(Self { diagnostics: DiagnosticsWriter::create(path, scene).map_err(io::Error::other)? })
    }

    /// Adds a row for each run of a frame to `diagnostics.csv`.
    ///
    /// # Errors
    /// If they cannot be written; rows written before stay.
    pub fn write_diagnostics(&mut self, frame: &Frame) -> io::Result<()> {
        self.diagnostics.write(frame, &[]).map_err(io::Error::other)
    }

    /// Gives `diagnostics.csv` its name.
    ///
    /// # Errors
    /// If it cannot be renamed.
    pub fn finish(self) -> io::Result<()> {
        self.diagnostics.finish().map_err(io::Error::other)
    }
}
