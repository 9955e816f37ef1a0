//! Folders with frames and diagnostics, written by other programs.

use super::{DiagnosticsWriter, OutputError};
use crate::scene::Scene;
use crate::sim::Frame;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// A folder with the frames of a scene and their diagnostics, in the files of `localshape render`.
///
/// A file has its name only when it is complete. The folder is not locked: only one program may write to it.
#[derive(Debug)]
pub struct FrameFolder<'a> {
    path: PathBuf,
    scene: &'a Scene,
    diagnostics: DiagnosticsWriter,
}

impl<'a> FrameFolder<'a> {
    /// Creates the folder, if it does not exist, for frames of a scene.
    ///
    /// # Errors
    /// If it cannot be created or written to.
    pub fn create(path: impl AsRef<Path>, scene: &'a Scene) -> io::Result<Self> {
        let path = path.as_ref().to_owned();
        fs::create_dir_all(&path).map_err(OutputError::writing(&path)).map_err(io::Error::other)?;
        let diagnostics = DiagnosticsWriter::create(&path, scene).map_err(io::Error::other)?;
        Ok(Self { path, scene, diagnostics })
    }

    /// Adds a row for each run of a frame to `diagnostics.csv`.
    ///
    /// # Errors
    /// If they cannot be written; rows written before stay.
    pub fn write_diagnostics(&mut self, frame: &Frame) -> io::Result<()> {
        self.diagnostics.write(frame).map_err(io::Error::other)
    }

    /// Writes a drawn picture of a frame, with its metadata, and returns the path of the file, such as
    /// `frame_00030.png`.
    ///
    /// # Errors
    /// If it cannot be written.
    #[cfg(feature = "render")]
    pub fn write_picture(&self, frame: &Frame, image: &image::RgbImage, gpu: &crate::gpu::Gpu) -> io::Result<PathBuf> {
        use super::{Compression, Tags, encode_print, frame_file_name, write_whole};
        let path = self.path.join(frame_file_name(frame.index));
        let texts = Tags::of_frame(self.scene, frame, &gpu.description().to_string()).texts();
        let dpi = self.scene.view.print.as_ref().map(|print| print.dpi);
        let file = encode_print(image.dimensions().into(), image.as_raw(), &texts, Compression::Fast, dpi);
        write_whole(&path, &file).map_err(io::Error::other)?;
        Ok(path)
    }

    /// Gives `diagnostics.csv` its name.
    ///
    /// # Errors
    /// If it cannot be renamed.
    pub fn finish(self) -> io::Result<()> {
        self.diagnostics.finish().map_err(io::Error::other)
    }
}
