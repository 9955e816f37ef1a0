//! Errors of making animations.

use crate::golden::PictureError;
use crate::output::OutputError;
use std::io;
use std::path::{Path, PathBuf};

/// Why an animation could not be made.
#[derive(Debug, thiserror::Error)]
pub enum AnimationError {
    /// A file is not a picture, or cannot be read.
    #[error("{}", path.display())]
    Picture {
        /// The file.
        path: PathBuf,
        /// The error in it.
        source: PictureError,
    },
    /// The request cannot be met, or a frame is not as required.
    #[error("{0}")]
    Wrong(String),
    /// A file cannot be read or written.
    #[error(transparent)]
    File(#[from] OutputError),
    /// The disk has no room for a file.
    #[error("cannot write {}: the disk is full; this file is removed, and an earlier one of that name is kept", .0.display())]
    Full(PathBuf),
    /// The output of the animation cannot be written.
    #[error("cannot write the animation")]
    Out(#[source] io::Error),
    /// A program that the format needs is missing.
    #[error(
        "there is no `ffmpeg` on this machine, which {0} files are made with. Install it (apt install ffmpeg; brew install \
         ffmpeg; winget install ffmpeg), or choose a file that is made without it: .gif or .apng"
    )]
    NoFfmpeg(&'static str),
    /// That program failed.
    #[error("ffmpeg failed ({status}){told}")]
    Ffmpeg {
        /// Its exit status.
        status: String,
        /// The last lines of its standard error.
        told: String,
    },
    /// The user interrupted it.
    #[error("interrupted")]
    Stopped,
}

impl AnimationError {
    /// Adds the file that was being written.
    pub(super) fn in_file(self, path: &Path) -> Self {
        match self {
            Self::Out(source) | Self::File(OutputError::Write { source, .. }) => match source.kind() {
                io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => Self::Full(path.to_owned()),
                _ => OutputError::writing(path)(source).into(),
            },
            other => other,
        }
    }
}
