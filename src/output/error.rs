//! What can go wrong with files.

use std::io;
use std::path::{Path, PathBuf};

/// A file or folder that could not be read, written or used. The cause, where there is one, is its source.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// Something could not be written.
    #[error("cannot write {}{}", path.display(), hint(source))]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Something could not be read.
    #[error("cannot read {}", path.display())]
    Read {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The folder holds files that belong to something else.
    #[error("{} holds {what}; choose another folder with -o, or replace what is there with --overwrite", path.display())]
    Occupied {
        /// The folder.
        path: PathBuf,
        /// What is in the way.
        what: String,
    },
}

/// What a full disk means for the files made so far.
fn hint(source: &io::Error) -> &'static str {
    match source.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            ": the disk is full; what was finished before is kept"
        }
        _ => "",
    }
}

impl OutputError {
    /// For `map_err`, when writing.
    pub fn writing(path: &Path) -> impl FnOnce(io::Error) -> Self + '_ {
        move |source| Self::Write { path: path.to_owned(), source }
    }

    /// For `map_err`, when reading.
    pub fn reading(path: &Path) -> impl FnOnce(io::Error) -> Self + '_ {
        move |source| Self::Read { path: path.to_owned(), source }
    }
}
