//! The folder of a study, which belongs to one command, and the notes from which an interrupted study continues.

use localshape::internals::{Failure, is_folder, read_file, write_whole};
use std::collections::HashMap;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The folder of a study.
pub(crate) struct Folder {
    path: PathBuf,
    /// The name of the study.
    name: &'static str,
    /// The first line of its Markdown file and of its notes: the command that makes them.
    mark: String,
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
        let mut is_known = false;
        for file in [format!("{}.md", self.name), format!("{}.unfinished", self.name)] {
            let Some(bytes) = read_file(&self.path.join(&file))? else { continue };
            let text = String::from_utf8_lossy(&bytes);
            let mark = text.lines().next().unwrap_or_default();
            if mark != self.mark {
                let other = mark.strip_prefix("<!-- ").and_then(|mark| mark.strip_suffix(" -->"));
                return Ok(Some(other.map_or_else(|| unknown(file), |other| format!("the study of `{other}`"))));
            }
            is_known = true;
        }
        let names = fs::read_dir(&self.path).into_iter().flatten();
        let names = names.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
        Ok(names.filter(|name| !is_known && !name.starts_with('.')).min().map(unknown))
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// The first line of the Markdown file.
    pub(crate) fn mark(&self) -> &str {
        &self.mark
    }

    /// Writes files, each completely or not at all.
    ///
    /// # Errors
    /// A file that cannot be written. The files before it are kept.
    pub(crate) fn write(&self, files: &[(String, Vec<u8>)]) -> Result<(), Failure> {
        Ok(files.iter().try_for_each(|(name, bytes)| write_whole(&self.path.join(name), bytes))?)
    }

    /// The notes of this study. They have the findings of an interrupted study with the same digest.
    pub(crate) fn notes(&self, digest: &str) -> Notes {
        let path = self.path.join(format!("{}.unfinished", self.name));
        Notes::new(path, format!("{}\n{} {digest}\n", self.mark, env!("CARGO_PKG_VERSION")))
    }
}

/// Notes of a study: a file with a line for each finding. After an interruption, the same command continues from it.
pub(crate) struct Notes {
    path: PathBuf,
    /// The first lines, which name the study.
    head: String,
    /// The findings before the interruption.
    known: HashMap<String, String>,
    /// Opened with the first finding.
    file: Mutex<Option<File>>,
}

impl Notes {
    fn new(path: PathBuf, head: String) -> Self {
        let known = fs::read(&path).unwrap_or_default();
        let known = String::from_utf8_lossy(&known);
        let known = known.strip_prefix(&head).unwrap_or_default();
        // The last line may be incomplete.
        let finding = |line: &str| {
            let (key, found) = line.strip_suffix(";\n")?.split_once('\t')?;
            Some((key.to_owned(), found.to_owned()))
        };
        let known = known.split_inclusive('\n').filter_map(finding).collect();
        Self { path, head, known, file: Mutex::new(None) }
    }

    /// The finding for a key before the interruption.
    pub(crate) fn known(&self, key: &str) -> Option<&str> {
        self.known.get(key).map(String::as_str)
    }

    /// Records a finding. Errors are ignored: a disk without room for notes may have room for the results.
    pub(crate) fn add(&self, key: &str, found: &str) {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let line = |(key, found): (&str, &str)| format!("{key}\t{found};\n");
        if file.is_none() {
            let known = self.known.iter().map(|(key, found)| line((key, found)));
            let text = [self.head.clone()].into_iter().chain(known).collect::<String>();
            *file = fs::write(&self.path, text).and_then(|()| File::options().append(true).open(&self.path)).ok();
        }
        if let Some(file) = file.as_mut() {
            let _ = file.write_all(line((key, found)).as_bytes());
        }
    }

    /// Whether there are any notes.
    pub(crate) fn are_kept(&self) -> bool {
        self.path.is_file()
    }

    /// Removes the notes of a finished study.
    pub(crate) fn remove(&self) {
        let _ = fs::remove_file(&self.path);
    }
}

#[cfg(test)]
#[path = "../tests/inside/folder.rs"]
mod tests;
