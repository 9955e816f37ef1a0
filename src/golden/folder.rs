//! A golden in its folder, and what is there instead.

use super::picture::{PictureError, Pixels, file};
use super::record::{RECORD_FILE, Record};
use super::{Comparison, ComparisonError};
use crate::output::{AtomicFile, FolderLock, OutputError, Tags, read_file, read_tags};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Where a picture is.
#[derive(Clone, Debug)]
pub(super) enum Source {
    File(PathBuf),
    /// The bytes of a PNG file.
    Memory(Vec<u8>),
}

impl Source {
    pub(super) fn pixels(&self) -> Result<Pixels, PictureError> {
        Pixels::from_bytes(&self.bytes()?)
    }

    /// The bytes of the file.
    pub(super) fn bytes(&self) -> Result<Cow<'_, [u8]>, PictureError> {
        match self {
            Self::File(path) => file(path).map(Cow::Owned),
            Self::Memory(bytes) => Ok(Cow::Borrowed(bytes)),
        }
    }
}

/// The pictures of a side by name.
pub(super) type Pictures = BTreeMap<String, Source>;

/// The PNG files in a folder.
pub(super) fn pictures_in(folder: &Path) -> Result<Pictures, ComparisonError> {
    let failed = |source| ComparisonError::Read { path: folder.into(), source };
    let mut pictures = Pictures::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let Some(name) = path.file_name() else { continue };
        if !path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png")) {
            continue;
        }
        let Some(name) = name.to_str().map(str::to_owned) else {
            let source = std::io::Error::new(ErrorKind::InvalidData, "its name is not UTF-8; rename it");
            return Err(ComparisonError::Read { path, source });
        };
        if !name.starts_with('.') {
            pictures.insert(name, Source::File(path));
        }
    }
    Ok(pictures)
}

/// A golden, or the folder in which one can be made.
#[derive(Clone, Debug)]
pub(crate) struct Golden {
    pub(super) folder: PathBuf,
    /// `None` if it does not exist, or cannot be read.
    pub(super) record: Option<Record>,
    /// Why the record cannot be read.
    pub(super) damage: Option<String>,
    pub(super) pictures: Pictures,
}

impl Golden {
    /// Reads a golden; one that does not exist has no record and no pictures.
    ///
    /// # Errors
    /// If the folder has other files, or cannot be read.
    pub(crate) fn read(folder: &Path) -> Result<Self, ComparisonError> {
        let mut golden = Self { folder: folder.into(), record: None, damage: None, pictures: Pictures::new() };
        if folder.symlink_metadata().is_err() {
            return Ok(golden);
        }
        let told = |what: String| Err(ComparisonError::NoGolden { path: folder.into(), what });
        if !folder.is_dir() {
            return told("is not a golden; expected a folder with golden.toml, or the name of a new one".to_owned());
        }
        golden.pictures = pictures_in(folder)?;
        match Record::read(folder) {
            Ok(record) => golden.record = record,
            Err(what) => golden.damage = Some(what),
        }
        if let (None, None, Some(other)) = (&golden.record, &golden.damage, other_file(folder)) {
            return told(format!(
                "is not a golden: it has no {RECORD_FILE}, but other files, such as {other}; name a folder that does not exist"
            ));
        }
        Ok(golden)
    }

    /// The same, refusing one whose record cannot be read.
    ///
    /// # Errors
    /// As [`Self::read`], and what is wrong with the record.
    pub(crate) fn read_whole(folder: &Path) -> Result<Self, ComparisonError> {
        let golden = Self::read(folder)?;
        match golden.damage {
            Some(what) => {
                let what =
                    format!("cannot be read: {what}; renew the golden with --bless, or UPDATE_GOLDENS=1 cargo test");
                Err(ComparisonError::NoGolden { path: folder.join(RECORD_FILE), what })
            }
            None => Ok(golden),
        }
    }

    /// The sizes and metadata of its pictures, as far as they can be read.
    fn tags(&self) -> impl Iterator<Item = ([u32; 2], Tags)> {
        let paths = self.pictures.keys().map(|name| self.folder.join(name));
        paths.filter_map(|path| read_tags(&path).ok()?)
    }

    /// The graphics adapter that drew it.
    pub(super) fn adapter(&self) -> Option<String> {
        self.tags().map(|(_, tags)| tags.adapter).next()
    }

    /// The frames that it shows.
    pub(super) fn frames(&self) -> BTreeSet<u64> {
        let shown = || self.tags().filter_map(|(_, tags)| tags.frame()).collect();
        self.record.as_ref().map_or_else(shown, |record| record.frames.clone())
    }

    /// Width and height of its pictures (px).
    pub(super) fn size(&self) -> Option<[u32; 2]> {
        self.record.as_ref().map(|record| record.size).or_else(|| self.tags().map(|(size, _)| size).next())
    }
}

/// A file or folder in a folder, except hidden ones.
fn other_file(folder: &Path) -> Option<String> {
    let names = std::fs::read_dir(folder).ok()?.flatten();
    let names = names.map(|entry| entry.file_name().to_string_lossy().into_owned());
    names.filter(|name| !name.starts_with('.')).min()
}

/// A scene or figure that was simulated, and drawn if there is a graphics adapter.
#[derive(Clone, Debug)]
pub(crate) struct Drawn {
    /// Its file.
    pub(super) origin: PathBuf,
    pub(super) record: Record,
    /// `None` without a graphics adapter.
    pub(super) pictures: Option<Pictures>,
    /// Runs that diverged.
    pub(super) notes: Vec<String>,
}

impl Drawn {
    /// A scene or figure with its PNG files by name, if it was drawn. The caller sets the file.
    pub(super) fn new(record: Record, files: BTreeMap<String, Vec<u8>>, is_drawn: bool, notes: Vec<String>) -> Self {
        let pictures = files.into_iter().map(|(name, bytes)| (name, Source::Memory(bytes))).collect();
        Self { origin: PathBuf::new(), record, pictures: is_drawn.then_some(pictures), notes }
    }
}

impl Comparison {
    /// Makes the golden, or replaces in it what is not as it was, and returns what was done, line by line. Pictures within the
    /// tolerance are kept. All files are written under hidden names before the first one is renamed.
    ///
    /// # Errors
    /// If there are no pictures, or a file cannot be written.
    pub(crate) fn accept(&self, golden: &Golden, drawn: &Drawn) -> Result<Vec<String>, AcceptError> {
        let pictures = drawn.pictures.as_ref().ok_or(AcceptError::Undrawn)?;
        let folder = &golden.folder;
        std::fs::create_dir_all(folder).map_err(OutputError::writing(folder))?;
        let _lock = FolderLock::beside_others(folder);
        let mut staged = Vec::new();
        let mut write = |path: &Path, bytes: &[u8]| -> Result<(), OutputError> {
            let mut file = AtomicFile::create(path)?;
            file.append(bytes)?;
            staged.push(file);
            Ok(())
        };
        let mut gone = Vec::new();
        for picture in self.pictures.iter().filter(|picture| !picture.verdict.passes()) {
            let path = folder.join(&picture.name);
            match pictures.get(&picture.name).map(Source::bytes) {
                Some(bytes) => write(&path, &bytes.expect("in memory"))?,
                None => gone.push(path),
            }
        }
        let (path, text) = (folder.join(RECORD_FILE), drawn.record.text());
        if read_file(&path).ok().flatten().as_deref() != Some(text.as_bytes()) {
            write(&path, text.as_bytes())?;
        }
        let mut told: Vec<String> = self.moved.iter().map(|moved| format!("accepted: state moved: {moved}")).collect();
        for file in staged {
            told.push(format!("accepted {}", file.path().display()));
            file.commit()?;
        }
        for path in gone {
            std::fs::remove_file(&path).map_err(OutputError::writing(&path))?;
            told.push(format!("removed {}", path.display()));
        }
        Ok(told)
    }
}

/// Why nothing was accepted.
#[derive(Debug, thiserror::Error)]
pub(crate) enum AcceptError {
    #[error("nothing was accepted: without a graphics adapter there are no pictures")]
    Undrawn,
    #[error(transparent)]
    Write(#[from] OutputError),
}
