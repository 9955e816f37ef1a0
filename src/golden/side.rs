//! One side of a comparison: pictures by name, and their known states.

use super::ComparisonError;
use super::archive;
use super::picture::{self, PictureError, Pixels};
use super::record::{RECORD_FILE, Record};
use super::states::{State, States, Step};
use crate::output::shell;
use crate::output::{SUMMARY_FILE, Shown, Tags, folder_of};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The largest summary that is read (bytes).
const LARGEST_SUMMARY: u64 = 16 << 20;

/// The kind of a side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Picture,
    /// A folder of pictures.
    Folder,
    /// A folder with pictures and a record of states.
    Golden,
    /// A golden that does not exist yet.
    Absent,
    /// A scene or figure, drawn for this comparison.
    Drawn,
}

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
            Self::File(path) => picture::file(path).map(Cow::Owned),
            Self::Memory(bytes) => Ok(Cow::Borrowed(bytes)),
        }
    }
}

/// One side of a comparison.
#[derive(Clone, Debug)]
pub(crate) struct Side {
    /// As it was typed.
    pub(super) origin: PathBuf,
    pub(super) kind: Kind,
    pub(super) pictures: BTreeMap<String, Source>,
    pub(super) record: Option<Record>,
    /// Whether nothing could be drawn, so that states alone are compared.
    pub(super) is_undrawn: bool,
    /// The options of the command line by which it was drawn.
    pub(crate) options: String,
    /// PNG files by the name of the picture: its state, coloured by how far it moved.
    pub(super) distances: BTreeMap<String, Vec<u8>>,
    /// Remarks on it.
    pub(super) notes: Vec<String>,
}

impl Side {
    /// A picture, a folder of pictures or a golden.
    pub(crate) fn read(path: &Path) -> Result<Self, ComparisonError> {
        let found = path.metadata().map_err(|source| match source.kind() {
            ErrorKind::NotFound => ComparisonError::Absent { path: path.into() },
            _ => ComparisonError::Read { path: path.into(), source },
        })?;
        if !found.is_dir() {
            return Ok(Self::picture(path));
        }
        let pictures = pictures_in(path)?;
        let file = path.join(RECORD_FILE);
        let record = match file.symlink_metadata() {
            Err(_) => None,
            Ok(_) => Some(match Record::read(path) {
                Err(source) => return Err(ComparisonError::Read { path: file, source }),
                Ok(Err(what)) => return Err(ComparisonError::Record { path: path.into(), what }),
                Ok(Ok(record)) => record,
            }),
        };
        let kind = if record.is_some() { Kind::Golden } else { Kind::Folder };
        Ok(Self { kind, pictures, record, ..Self::picture(path) })
    }

    /// As [`Self::read`]; if nothing exists, a golden to be made.
    pub(crate) fn read_or_absent(path: &Path) -> Result<Self, ComparisonError> {
        let absent = || Self { kind: Kind::Absent, pictures: BTreeMap::new(), ..Self::picture(path) };
        if path.symlink_metadata().is_err() {
            return Ok(absent());
        }
        // A folder without pictures and record counts as missing.
        let side = Self::read(path)?;
        Ok(if side.kind == Kind::Folder && side.pictures.is_empty() { absent() } else { side })
    }

    fn picture(path: &Path) -> Self {
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        Self {
            origin: path.into(),
            kind: Kind::Picture,
            pictures: BTreeMap::from([(name, Source::File(path.into()))]),
            record: None,
            is_undrawn: false,
            options: String::new(),
            distances: BTreeMap::new(),
            notes: Vec::new(),
        }
    }

    /// Where the picture of a name is.
    pub(super) fn source(&self, name: &str) -> Option<&Source> {
        match self.kind {
            Kind::Picture => self.pictures.values().next(),
            _ => self.pictures.get(name),
        }
    }

    /// The folder with the pictures, and perhaps with an archive of their states.
    fn folder(&self) -> &Path {
        match self.kind {
            Kind::Picture => folder_of(&self.origin),
            _ => &self.origin,
        }
    }

    /// The exact states in the folder's archive, if it belongs to these pictures.
    pub(super) fn archive(&self, labels: &[&Tags]) -> Result<Option<States>, String> {
        if !matches!(self.kind, Kind::Picture | Kind::Folder) {
            return Ok(None);
        }
        let told = |what: String| format!("{}: {what}", self.folder().display());
        let Some(mut states) = archive::read(self.folder()).map_err(told)? else { return Ok(None) };
        for label in labels {
            let Some(frame) = label.frame() else { continue };
            for (digest, run) in &label.states {
                let state = states.run(run).and_then(|run| run.states.get(&frame));
                if state.is_some_and(|state| state.digest != *digest) {
                    return Err(told(format!(
                        "states.npz does not belong to these pictures; frame {frame} shows another state"
                    )));
                }
            }
        }
        if self.kind == Kind::Picture {
            // Only this picture is compared, not the rest of its folder.
            let frames: BTreeSet<u64> = labels.iter().filter_map(|label| label.frame()).collect();
            states.runs.iter_mut().for_each(|run| run.states.retain(|frame, _| frames.contains(frame)));
        }
        Ok(Some(states))
    }

    /// The time step of each run, from the folder's summary, if it belongs to these pictures.
    pub(super) fn steps(&self, labels: &[&Tags]) -> Vec<(String, Step)> {
        let read = || -> Option<Vec<(String, Step)>> {
            let path = self.folder().join(SUMMARY_FILE);
            let found = path.metadata().ok()?;
            if !matches!(self.kind, Kind::Picture | Kind::Folder) || !found.is_file() || found.len() > LARGEST_SUMMARY {
                return None;
            }
            let summary: serde_json::Value = serde_json::from_slice(&std::fs::read(path).ok()?).ok()?;
            let scene = &summary["scene"];
            let digest = scene["digest"].as_str()?;
            if labels.iter().flat_map(|label| &label.scenes).any(|other| other != digest) {
                return None;
            }
            let cycle = scene["cycle"].as_f64()?;
            let step = |run: &serde_json::Value| {
                Some((run["name"].as_str()?.to_owned(), Step { step: run["time_step"].as_f64()?, cycle }))
            };
            summary["runs"].as_array()?.iter().map(step).collect()
        };
        // Earlier versions of this program did not write it.
        read().unwrap_or_default()
    }

    /// Whether it is a golden, or does not exist yet.
    pub(crate) fn is_golden(&self) -> bool {
        matches!(self.kind, Kind::Golden | Kind::Absent)
    }

    /// Its path, quoted for the command line.
    pub(super) fn typed(&self) -> String {
        let path = self.origin.to_string_lossy();
        // Prefixed so that a name which begins with - is not taken for an option.
        let path = if path.starts_with('-') { format!("./{path}").into() } else { path };
        shell::word(&path)
    }
}

/// The states recorded in pictures. None if the pictures are of several scenes, whose frames are unrelated, unless they are
/// compared with a golden.
pub(super) fn states_of(labels: &[&Tags], beside_golden: bool) -> States {
    let mut states = States::default();
    let scenes: BTreeSet<_> = labels.iter().flat_map(|label| &label.scenes).collect();
    if scenes.len() > 1 && !beside_golden {
        return states;
    }
    for label in labels {
        let Shown::Frame { frame, time } = label.shows else { continue };
        for (digest, run) in &label.states {
            let state = State { time: Some(time), digest: digest.clone(), ..State::default() };
            states.add(run, frame, state);
        }
    }
    states
}

/// The PNG files in a folder by name.
fn pictures_in(folder: &Path) -> Result<BTreeMap<String, Source>, ComparisonError> {
    let failed = |source| ComparisonError::Read { path: folder.into(), source };
    let mut pictures = BTreeMap::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let Some(name) = path.file_name() else { continue };
        let is_picture = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
        let Some(name) = name.to_str().map(str::to_owned) else {
            if is_picture {
                let source = std::io::Error::new(ErrorKind::InvalidData, "its name is not UTF-8; rename it");
                return Err(ComparisonError::Read { path, source });
            }
            continue;
        };
        if !name.starts_with('.') && is_picture {
            pictures.insert(name, Source::File(path));
        }
    }
    Ok(pictures)
}
