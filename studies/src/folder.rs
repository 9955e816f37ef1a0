//! The folder of a study, which belongs to one command, and the notes from which an interrupted study continues.

use crate::failure::Failure;
use std::collections::HashMap;
use std::fs::{self, File};
use std::io::{self, Write};
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
        if let Some(file) = path.ancestors().find(|path| path.is_file()) {
            let file = file.display();
            return Err(Failure::files(format!("{file} is a file, not a folder; choose another folder with -o")));
        }
        let probe = hidden(&path, name);
        fs::create_dir_all(&path)
            .and_then(|()| fs::write(&probe, ""))
            .and_then(|()| fs::remove_file(&probe))
            .map_err(|error| cannot_write(&path, &error))?;
        let folder = Self { mark: format!("<!-- {command} -->"), path, name };
        let refused = |what: String| {
            let path = folder.path.display();
            Err(Failure::usage(format!(
                "{path} holds {what}; choose another folder with -o, or replace with --overwrite"
            )))
        };
        let marks: Vec<_> = ["md", "unfinished"].iter().filter_map(|kind| folder.first_line(kind)).collect();
        match marks.iter().find(|mark| **mark != folder.mark) {
            _ if overwrite => Ok(folder),
            Some(mark) => match mark.strip_prefix("<!-- ").and_then(|mark| mark.strip_suffix(" -->")) {
                Some(other) => refused(format!("the study of `{other}`")),
                None => refused(format!("{name}.md, which was not written by localshape-study")),
            },
            None if !marks.is_empty() => Ok(folder),
            None => match folder.some_file() {
                Some(file) => refused(format!("{file}, which was not written by localshape-study")),
                None => Ok(folder),
            },
        }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// The first line of the Markdown file.
    pub(crate) fn mark(&self) -> &str {
        &self.mark
    }

    /// The first line of a file of the study, if there is one.
    fn first_line(&self, kind: &str) -> Option<String> {
        let path = self.path.join(format!("{}.{kind}", self.name));
        // Opening a pipe would block.
        let text = path.is_file().then(|| fs::read(path))?.ok()?;
        Some(String::from_utf8_lossy(text.split(|&byte| byte == b'\n').next()?).into_owned())
    }

    /// The first file in the folder by name, except hidden ones.
    fn some_file(&self) -> Option<String> {
        let names = fs::read_dir(&self.path).ok()?.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
        names.filter(|name| !name.starts_with('.')).min()
    }

    /// Writes files, each completely or not at all.
    ///
    /// # Errors
    /// A file that cannot be written. The files before it are kept.
    pub(crate) fn write(&self, files: &[(String, Vec<u8>)]) -> Result<(), Failure> {
        for (name, bytes) in files {
            let (part, path) = (hidden(&self.path, name), self.path.join(name));
            let written = fs::write(&part, bytes).and_then(|()| fs::rename(&part, &path));
            written.map_err(|error| cannot_write(&path, &error))?;
        }
        Ok(())
    }

    /// The notes of this study. They have the findings of an interrupted study with the same digest.
    pub(crate) fn notes(&self, digest: &str) -> Notes {
        let path = self.path.join(format!("{}.unfinished", self.name));
        Notes::new(path, format!("{}\n{} {digest}\n", self.mark, env!("CARGO_PKG_VERSION")))
    }
}

/// The name of an incomplete file.
fn hidden(folder: &Path, name: &str) -> PathBuf {
    folder.join(format!(".{name}.part"))
}

fn cannot_write(path: &Path, error: &io::Error) -> Failure {
    Failure::files(format!("cannot write {}: {error}", path.display()))
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
