//! The folder of a study, which belongs to one command.

use localshape::internals::{Failure, is_folder, read_file, write_whole};
use std::fs;
use std::path::PathBuf;

/// The folder of a study.
pub(crate) struct Folder {
    pub(crate) path: PathBuf,
    /// The name of the study.
    name: &'static str,
    /// The first line of its Markdown file: the command that makes it.
    pub(crate) mark: String,
}

impl Folder {
    /// A folder for the files of a command. It is new or empty, or the same command has made its study; with
    /// `overwrite` any folder is accepted.
    ///
    /// # Errors
    /// A folder that is refused, or cannot be written to.
    pub(crate) fn new(path: PathBuf, name: &'static str, command: &str, overwrite: bool) -> Result<Self, Failure> {
        is_folder(&path)?;
        let cannot_write = |error| Failure::files(format!("cannot write {}: {error}", path.display()));
        fs::create_dir_all(&path).and_then(|()| tempfile::tempfile_in(&path)).map_err(cannot_write)?;
        let folder = Self { mark: format!("<!-- {command} -->"), path, name };
        match folder.strange()?.filter(|_| !overwrite) {
            Some(what) => Err(Failure::usage(format!(
                "{} holds {what}; choose another folder with -o, or replace with --overwrite",
                folder.path.display()
            ))),
            None => Ok(folder),
        }
    }

    /// What the folder holds that this command did not write, in words.
    fn strange(&self) -> Result<Option<String>, Failure> {
        let unknown = |file: String| format!("{file}, which was not written by localshape-study");
        let file = format!("{}.md", self.name);
        let Some(bytes) = read_file(&self.path.join(&file))? else {
            let names = fs::read_dir(&self.path).into_iter().flatten();
            let names = names.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
            return Ok(names.filter(|name| !name.starts_with('.')).min().map(unknown));
        };
        let text = String::from_utf8_lossy(&bytes);
        let mark = text.lines().next().unwrap_or_default();
        let other = || mark.strip_prefix("<!-- ").and_then(|mark| mark.strip_suffix(" -->"));
        let strange = || other().map_or_else(|| unknown(file), |other| format!("the study of `{other}`"));
        Ok((mark != self.mark).then(strange))
    }

    /// Writes files, each completely or not at all.
    ///
    /// # Errors
    /// A file that cannot be written. The files before it are kept.
    pub(crate) fn write(&self, files: &[(String, Vec<u8>)]) -> Result<(), Failure> {
        Ok(files.iter().try_for_each(|(name, bytes)| write_whole(&self.path.join(name), bytes))?)
    }
}
