//! Files that appear whole or not at all.

use super::OutputError;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

const PREFIX: &str = ".localshape-";
const SUFFIX: &str = ".partial";

/// A file under a hidden name until [`Self::commit`] gives it its own. Dropped before that, it leaves nothing.
#[derive(Debug)]
pub(crate) struct AtomicFile {
    path: PathBuf,
    temporary: NamedTempFile,
}

impl AtomicFile {
    /// Begins the file `path`, whose folder exists. Where the folder is not locked ([`super::FolderLock`]), others may take
    /// it for a leftover.
    ///
    /// # Errors
    /// If the folder cannot be written to.
    pub(crate) fn create(path: &Path) -> Result<Self, OutputError> {
        let folder = folder_of(path);
        // Made by the standard library, results are as open to others as any file; tempfile's own are their owner's.
        let open = |hidden: &Path| File::options().read(true).write(true).create_new(true).open(hidden);
        let made = tempfile::Builder::new().prefix(PREFIX).suffix(SUFFIX).make_in(folder, open);
        Ok(Self { path: path.to_owned(), temporary: made.map_err(OutputError::writing(path))? })
    }

    /// The name that the file will have.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// The name that it has until then, for programs that write it themselves.
    #[cfg(feature = "render")]
    pub(crate) fn hidden_path(&self) -> &Path {
        self.temporary.path()
    }

    /// The open file.
    pub(crate) fn file(&mut self) -> &mut File {
        self.temporary.as_file_mut()
    }

    /// Appends bytes.
    ///
    /// # Errors
    /// If they cannot be written; some of them may have been.
    pub(crate) fn append(&mut self, bytes: &[u8]) -> Result<(), OutputError> {
        self.temporary.as_file_mut().write_all(bytes).map_err(OutputError::writing(&self.path))
    }

    /// Gives the file its own name, in place of what had that name before, once the disk has its contents: so a name
    /// never stands for less than the whole, even when the power fails.
    ///
    /// Waiting for the disk took 4 ms for a file of 300 kB (median of 100). For frames it is done by the threads that
    /// compress them, while others are drawn: rendering took as long as without.
    ///
    /// # Errors
    /// If it cannot be written or renamed; then it is removed.
    pub(crate) fn commit(self) -> Result<(), OutputError> {
        let Self { path, temporary } = self;
        temporary.as_file().sync_data().map_err(OutputError::writing(&path))?;
        temporary.persist(&path).map_err(|error| error.error).map_err(OutputError::writing(&path))?;
        Ok(())
    }
}

/// Writes a whole file at once.
///
/// # Errors
/// If it cannot be written; then an earlier file of that name is as it was.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    let mut file = AtomicFile::create(path)?;
    file.append(bytes)?;
    file.commit()
}

/// Removes what programs have left unfinished in a folder; nothing else. Nobody else may be writing in it.
///
/// # Errors
/// If the folder cannot be read or a leftover cannot be removed.
pub(super) fn remove_leftovers(folder: &Path) -> Result<(), OutputError> {
    for entry in fs::read_dir(folder).map_err(OutputError::reading(folder))? {
        let entry = entry.map_err(OutputError::reading(folder))?;
        let hidden = |name: &str| name.starts_with(PREFIX) && name.ends_with(SUFFIX);
        if entry.file_name().to_str().is_some_and(hidden) && entry.file_type().is_ok_and(|found| found.is_file()) {
            remove(&entry.path())?;
        }
    }
    Ok(())
}

/// Removes a file, or finds it gone already.
pub(super) fn remove(path: &Path) -> Result<(), OutputError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(OutputError::writing(path)(error)),
        _ => Ok(()),
    }
}

/// The folder that a file is in.
pub(crate) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn appears_only_when_committed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("whole.txt");
        let mut file = AtomicFile::create(&path).unwrap();
        file.append(b"text").unwrap();
        assert!(!path.exists());
        file.commit().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"text");

        drop(AtomicFile::create(&path).unwrap());
        assert_eq!(fs::read(&path).unwrap(), b"text");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn leftovers_go_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let leftover = folder.path().join(".localshape-abc123.partial");
        let other = folder.path().join(".localshape-notes");
        fs::write(&leftover, "").unwrap();
        fs::write(&other, "").unwrap();
        remove_leftovers(folder.path()).unwrap();
        assert!(!leftover.exists() && other.exists());
    }

    #[cfg(unix)]
    #[test]
    fn as_readable_as_any_other_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (ours, plain) = (folder.path().join("ours"), folder.path().join("plain"));
        write_whole(&ours, b"").unwrap();
        fs::write(&plain, "").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }
}
