//! The files of a table or a study, in one folder, each written completely or not at all.

use super::{AtomicFile, FolderLock, OutputError, is_folder, read_file};
use std::fs;
use std::path::Path;

/// The first characters of the Markdown file of every table and study, before the rest of the command.
const BEGINNING: &str = "<!-- localshape ";

/// Files created in a folder under hidden names. If they are dropped unfinished, they are removed.
#[derive(Debug)]
pub(crate) struct SheetFiles {
    files: Vec<AtomicFile>,
    _lock: FolderLock,
}

impl SheetFiles {
    /// Inspects a folder, which need not exist, before the files `names` are written to it. The first of them is
    /// Markdown that begins with `mark` in a comment.
    ///
    /// Files of a table made in the same way may be replaced. A folder with a table made in another way, or with other
    /// files of these names, is refused unless `overwrite`.
    ///
    /// # Errors
    /// If the folder cannot be read, is refused or is not a folder, or another process writes to it.
    pub(crate) fn inspect(folder: &Path, names: &[&str], mark: &str, overwrite: bool) -> Result<(), OutputError> {
        if !is_folder(folder)? {
            return Ok(());
        }
        FolderLock::check(folder)?;
        Self::check(folder, names, mark, overwrite)
    }

    fn check(folder: &Path, names: &[&str], mark: &str, overwrite: bool) -> Result<(), OutputError> {
        let there: Vec<_> = names.iter().filter(|name| folder.join(name).symlink_metadata().is_ok()).collect();
        let (Some(first), false) = (there.first(), overwrite) else { return Ok(()) };
        let text = read_file(&folder.join(names[0]))?.unwrap_or_default();
        let line = String::from_utf8_lossy(text.split(|&byte| byte == b'\n').next().unwrap_or_default()).into_owned();
        let made_by = line.strip_prefix(BEGINNING).and_then(|rest| rest.strip_suffix(" -->"));
        let what = match made_by {
            Some(how) if mark.strip_prefix("localshape ") == Some(how) => return Ok(()),
            Some(how) => format!("what was made by `localshape {how}`"),
            None => format!("{first}, which was not written by localshape"),
        };
        Err(OutputError::Occupied { path: folder.to_owned(), what })
    }

    /// Creates the folder if necessary, locks it, removes leftovers of killed processes and creates the files `names`,
    /// so that errors are reported before the computation. The tests of [`Self::inspect`] are repeated because the
    /// folder may have changed before it was locked.
    ///
    /// # Errors
    /// If the folder cannot be created or written to, is refused, or another process writes to it.
    pub(crate) fn begin(folder: &Path, names: &[&str], mark: &str, overwrite: bool) -> Result<Self, OutputError> {
        fs::create_dir_all(folder).map_err(OutputError::writing(folder))?;
        let lock = FolderLock::alone(folder)?;
        Self::check(folder, names, mark, overwrite)?;
        let files = names.iter().map(|name| AtomicFile::create(&folder.join(name))).collect::<Result<_, _>>()?;
        Ok(Self { files, _lock: lock })
    }

    /// Writes the files, the contents of each, in their order.
    ///
    /// # Errors
    /// If one cannot be written; those before it are kept.
    pub(crate) fn finish(self, contents: &[Vec<u8>]) -> Result<(), OutputError> {
        assert_eq!(self.files.len(), contents.len(), "contents for each file");
        self.files.into_iter().zip(contents).try_for_each(|(mut file, bytes)| {
            file.append(bytes)?;
            file.commit()
        })
    }
}
