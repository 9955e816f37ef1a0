//! Errors of reading and writing files.

use std::fs::{self, Metadata};
use std::io;
use std::path::{Path, PathBuf};

/// A file or folder that could not be read, written or used. The source is the cause, if there is one.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    #[error("cannot write {}{}", path.display(), hint(source))]
    Write { path: PathBuf, source: io::Error },
    #[error("cannot read {}", path.display())]
    Read { path: PathBuf, source: io::Error },
    #[error(
        "{} is in use: another process is writing there; wait until that has ended, or choose another folder with -o",
        path.display()
    )]
    InUse { path: PathBuf },
    #[error("{} is {what}, not a folder; choose another folder with -o", path.display())]
    NoFolder { path: PathBuf, what: &'static str },
    #[error("{} is {what}, not a file; move it away, or choose another folder with -o", path.display())]
    NoFile { path: PathBuf, what: &'static str },
    #[error("{} {what}", path.display())]
    States { path: PathBuf, what: Box<str> },
    #[error("the checkpoint in {} {what}; to begin anew, leave out --resume and add --overwrite", path.display())]
    Checkpoint { path: PathBuf, what: Box<str> },
    #[error("{} holds {what}; choose another folder with -o, or replace its contents with --overwrite", path.display())]
    Occupied { path: PathBuf, what: String },
}

/// An addition to the message if the disk is full, or the file too large for the system.
fn hint(source: &io::Error) -> &'static str {
    match source.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => ": the disk is full; finished files are kept",
        io::ErrorKind::FileTooLarge => ": it is larger than the system permits (`ulimit -f`); finished files are kept",
        _ => "",
    }
}

/// The kind of a file, for messages.
pub(super) fn kind_of(found: &Metadata) -> &'static str {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if found.file_type().is_fifo() {
            return "a pipe";
        }
    }
    match (found.is_file(), found.is_dir()) {
        (true, _) => "a file",
        (_, true) => "a folder",
        _ => "a device or socket",
    }
}

/// Whether a folder exists. If not, nothing at its path prevents its creation.
///
/// # Errors
/// If the path, or a part of it, is something else than a folder.
pub fn is_folder(path: &Path) -> Result<bool, OutputError> {
    let nearest = path.ancestors().find_map(|above| Some((above, fs::metadata(above).ok()?)));
    match nearest {
        Some((above, found)) if !found.is_dir() => {
            Err(OutputError::NoFolder { path: above.to_owned(), what: kind_of(&found) })
        }
        Some((above, _)) => Ok(above == path),
        None => Ok(false),
    }
}

/// Reads a whole file; `None` if there is none, or if it is not a file: opening a pipe would block.
pub fn read_file(path: &Path) -> Result<Option<Vec<u8>>, OutputError> {
    match fs::metadata(path) {
        Ok(found) if found.is_file() => fs::read(path).map(Some).map_err(OutputError::reading(path)),
        Ok(_) => Ok(None),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(OutputError::reading(path)(error)),
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
