//! A golden in its folder.

use super::error::ComparisonError;
use super::record::{RECORD_FILE, Record};
use super::source::{Pictures, pictures_in};
use crate::output::{Tags, read_tags};
use crate::reading::beside::{entries, name_of};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The largest accepted record (bytes).
const LARGEST_RECORD: u64 = 4 << 20;

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
    /// Reads a golden; one that does not exist has no record and no pictures. One that is renewed may have an unreadable record.
    ///
    /// # Errors
    /// If the folder has other files, or it or the record cannot be read.
    pub(crate) fn read(folder: &Path, is_renewed: bool) -> Result<Self, ComparisonError> {
        let mut golden = Self { folder: folder.into(), record: None, damage: None, pictures: Pictures::new() };
        if folder.symlink_metadata().is_err() {
            return Ok(golden);
        }
        let told = |path: &Path, what: &str| Err(ComparisonError::Wrong(format!("{} {what}", path.display())));
        if !folder.is_dir() {
            return told(folder, "is not a golden; expected a folder with golden.toml, or the name of a new one");
        }
        golden.pictures = pictures_in(folder)?;
        match record_of(folder) {
            Ok(record) => golden.record = record,
            Err(what) if is_renewed => golden.damage = Some(what),
            Err(what) => {
                let what =
                    format!("cannot be read: {what}; renew the golden with --bless, or UPDATE_GOLDENS=1 cargo test");
                return told(&folder.join(RECORD_FILE), &what);
            }
        }
        if let (None, None, Some(other)) = (&golden.record, &golden.damage, other_file(folder)) {
            let what = format!(
                "is not a golden: it has no {RECORD_FILE}, but other files, such as {other}; name a folder that does not exist"
            );
            return told(folder, &what);
        }
        Ok(golden)
    }

    /// The sizes and metadata of its readable pictures.
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
    let names = entries(folder).ok()?.into_iter().map(|path| name_of(&path));
    names.filter(|name| !name.starts_with('.')).min()
}

/// A simulated scene or figure, drawn if there is a graphics adapter.
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

/// Reads the record of a golden's folder; `None` if there is none.
///
/// # Errors
/// Why it cannot be read.
fn record_of(folder: &Path) -> Result<Option<Record>, String> {
    let path = folder.join(RECORD_FILE);
    let told = |error: std::io::Error| format!("it cannot be read: {error}");
    let found = match path.symlink_metadata() {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        _ => path.metadata().map_err(told)?,
    };
    if !found.is_file() || found.len() > LARGEST_RECORD {
        return Err("it is not a file, or far too large: a record has some tens of kilobytes".to_owned());
    }
    let text = String::from_utf8(std::fs::read(&path).map_err(told)?).map_err(|_| "it is not text".to_owned())?;
    Record::parse(&text).map(Some)
}
