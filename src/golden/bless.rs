//! Accepting the actual side as the expected one.

use super::picture::{PictureError, Pixels};
use super::record::{Drawn, RECORD_FILE, Record};
use super::side::{Kind, Source};
use super::states::States;
use super::{Comparison, Verdict};
use crate::output::{
    AtomicFile, Compression, DIAGNOSTICS_FILE, FolderLock, OutputError, STATES_FILE, SUMMARY_FILE, encode, folder_of,
    read_file,
};
use std::borrow::Cow;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// What was accepted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Blessed {
    /// Files that were written, in order.
    pub written: Vec<PathBuf>,
    /// Files of a golden that were removed because they are no longer drawn.
    pub removed: Vec<PathBuf>,
    /// Files that were kept, and why.
    pub left: Vec<String>,
}

/// Why nothing was accepted.
#[derive(Debug, thiserror::Error)]
pub(crate) enum BlessError {
    #[error("the state moved, so nothing was accepted; to accept it anyway: {command}")]
    StateMoved { command: String },
    #[error("the expected side is damaged, so nothing was accepted; to replace it: {command}")]
    Damaged { command: String },
    #[error("nothing was accepted: {0}")]
    Unfit(String),
    #[error(
        "nothing was accepted: the golden records {recorded} states, and {known} of them are known here. \
         Compare it with its scene file, or with frames that were drawn with --states"
    )]
    StatesUnknown { recorded: usize, known: usize },
    #[error("{source}; {blessed}")]
    Write { blessed: Blessed, source: OutputError },
}

impl Comparison {
    /// Whether accepting replaces states, or files that cannot be read.
    pub(super) fn needs_state(&self) -> bool {
        self.state_moved() || self.is_damaged()
    }

    /// Whether a picture cannot be read.
    fn is_damaged(&self) -> bool {
        self.pictures.iter().any(|picture| matches!(picture.verdict, Verdict::Unreadable { .. }))
    }

    /// Why the actual side cannot be accepted; `None` if it can.
    pub(super) fn unfit(&self) -> Option<String> {
        let [expected, actual] = &self.sides;
        if actual.is_undrawn {
            return Some("without a graphics adapter there are no pictures to accept".to_owned());
        }
        if expected.kind == Kind::Absent
            && actual.kind != Kind::Picture
            && let Some(other) = other_file(&expected.origin)
        {
            let folder = expected.origin.display();
            return Some(format!("{folder} has other files, such as {other}; name a folder that does not exist"));
        }
        if !self.unknown.is_empty() && actual.record.is_none() {
            return Some(format!("the states of {} are not known here", self.unknown.join(", ")));
        }
        let is_golden = expected.kind == Kind::Golden;
        let failed = self.pictures.iter().filter(|picture| !picture.verdict.passes());
        let mut wrong = failed.filter_map(|picture| {
            let unfit = |what: String| Some(format!("{}: {what}", picture.name));
            if !is_golden && !matches!(picture.verdict, Verdict::Unreadable { .. }) {
                // It was read before.
                return None;
            }
            match self.sides[1].source(&picture.name)?.pixels() {
                Err(error) => unfit(error.to_string()),
                Ok(pixels) if is_golden && pixels.label.is_none() => {
                    unfit("it has no recorded state and cannot belong to a golden".to_owned())
                }
                Ok(pixels) if is_golden && actual.record.is_none() => {
                    let size = expected.record.as_ref().map(|record| record.size);
                    let [width, height] = size.filter(|size| *size != pixels.size)?;
                    unfit(format!(
                        "a picture of this golden has {width}×{height} pixels; draw it so, or compare its scene"
                    ))
                }
                Ok(_) => None,
            }
        });
        wrong.next()
    }

    /// Whether moved states are accepted into a folder of frames, which may also have files of these states.
    fn brings_states(&self) -> bool {
        let are_folders = self.sides.iter().all(|side| side.kind == Kind::Folder);
        are_folders && self.needs_state()
    }

    /// Whether accepting would change anything.
    pub(super) fn has_something_to_accept(&self) -> bool {
        let [expected, _] = &self.sides;
        let Ok(record) = self.record_to_write() else { return false };
        let is_gone = |name: &String| {
            let is_known = |record: &Record| record.pictures.iter().any(|drawn| drawn.file == *name);
            expected.pictures.contains_key(name) && record.as_ref().is_some_and(|record| !is_known(record))
        };
        let mut failed = self.pictures.iter().filter(|picture| !picture.verdict.passes());
        let pictures = failed.any(|picture| self.sides[1].source(&picture.name).is_some() || is_gone(&picture.name));
        pictures || record.is_some() && record != expected.record
    }

    /// Replaces what failed on the expected side by the actual side. States are replaced only on request. All files are
    /// written under hidden names before the first one is renamed.
    ///
    /// # Errors
    /// If states moved and accepting them was not requested, if the actual side cannot be read, or a file cannot be written.
    pub(crate) fn bless(&self, with_states: bool) -> Result<Blessed, BlessError> {
        if self.passes() {
            return Ok(Blessed::default());
        }
        if let Some(message) = self.unfit() {
            return Err(BlessError::Unfit(message));
        }
        let [expected, actual] = &self.sides;
        let record = self.record_to_write()?;
        if self.needs_state() && !with_states && expected.kind != Kind::Absent {
            let command = self.command();
            return Err(match self.state_moved() {
                true => BlessError::StateMoved { command },
                false => BlessError::Damaged { command },
            });
        }
        let mut blessed = Blessed::default();
        let mut gone = Vec::new();
        let mut staged = Vec::new();
        let is_picture = expected.kind == Kind::Picture || actual.kind == Kind::Picture;
        let mut write = |target: &Path, bytes: &[u8]| -> Result<(), OutputError> {
            let mut file = AtomicFile::create(target)?;
            file.append(bytes)?;
            staged.push(file);
            Ok(())
        };
        let mut stage = || -> Result<FolderLock, OutputError> {
            if !is_picture {
                std::fs::create_dir_all(&expected.origin).map_err(OutputError::writing(&expected.origin))?;
            }
            let folder = if is_picture { folder_of(&expected.origin) } else { &expected.origin };
            let lock = FolderLock::beside_others(folder);
            for picture in self.pictures.iter().filter(|picture| !picture.verdict.passes()) {
                let target = if is_picture { expected.origin.clone() } else { expected.origin.join(&picture.name) };
                let is_drawn = |record: &Record| record.pictures.iter().any(|drawn| drawn.file == picture.name);
                let belongs = record.as_ref().is_none_or(is_drawn);
                match self.sides[1].source(&picture.name).filter(|_| belongs) {
                    Some(source) => {
                        let bytes = bytes(source, record.is_some()).map_err(OutputError::reading(&target))?;
                        write(&target, &bytes)?;
                    }
                    // A picture of the golden that does not exist any more on the actual side.
                    None if !belongs && expected.pictures.contains_key(&picture.name) => gone.push(target),
                    None if expected.kind == Kind::Golden && !belongs => {}
                    None => {
                        let (target, actual) = (target.display(), actual.origin.display());
                        blessed.left.push(format!("{target} is missing in {actual} and was left"));
                    }
                }
            }
            for name in BESIDE.into_iter().filter(|_| self.brings_states()) {
                let (target, source) = (expected.origin.join(name), actual.origin.join(name));
                let (old, new) = (read_file(&target).ok().flatten(), read_file(&source).ok().flatten());
                match (old, new) {
                    (old, Some(new)) if old.as_ref() != Some(&new) => write(&target, &new)?,
                    (Some(_), None) => {
                        let (target, actual) = (target.display(), actual.origin.display());
                        blessed.left.push(format!(
                            "{target} does not belong to these pictures any more, but {actual} has none"
                        ));
                    }
                    _ => {}
                }
            }
            if let Some(record) = &record {
                let target = expected.origin.join(RECORD_FILE);
                let text = record.text();
                if read_file(&target).ok().flatten().as_deref() != Some(text.as_bytes()) {
                    write(&target, text.as_bytes())?;
                }
            }
            Ok(lock)
        };
        // Kept until the files have their names.
        let _lock = stage().map_err(|source| BlessError::Write { blessed: Blessed::default(), source })?;
        for file in staged {
            let path = file.path().to_owned();
            match file.commit() {
                Ok(()) => blessed.written.push(path),
                Err(source) => return Err(BlessError::Write { blessed, source }),
            }
        }
        for path in gone {
            match std::fs::remove_file(&path).map_err(OutputError::writing(&path)) {
                Ok(()) => blessed.removed.push(path),
                Err(source) => return Err(BlessError::Write { blessed, source }),
            }
        }
        Ok(blessed)
    }

    /// The record of a golden after accepting; `None` if the side is not a golden.
    fn record_to_write(&self) -> Result<Option<Record>, BlessError> {
        let [expected, actual] = &self.sides;
        let old = match (expected.kind, &expected.record) {
            (Kind::Golden, Some(old)) => old,
            // A new golden has a record if its states are known.
            (Kind::Absent, _) => return Ok(actual.record.clone()),
            _ => return Ok(None),
        };
        let mut record = match &actual.record {
            // Only pictures and their adapters are updated.
            _ if !self.needs_state() => old.clone(),
            Some(record) => record.clone(),
            None => Record { states: self.states_for(old)?, ..old.clone() },
        };
        // Pictures that are kept keep their adapters.
        let passes = |name: &str| self.pictures.iter().any(|picture| picture.name == name && picture.verdict.passes());
        let label = |name: &str| self.sides[1].source(name).and_then(|source| source.pixels().ok()?.label);
        let names = actual.record.as_ref().unwrap_or(old).pictures.iter().map(|drawn| drawn.file.as_str());
        record.pictures = names
            .filter_map(|name| {
                let kept = old.pictures.iter().find(|drawn| drawn.file == name);
                match label(name).filter(|_| !passes(name)) {
                    Some(label) => Some(Drawn::new(name, &label)),
                    None => kept.cloned(),
                }
            })
            .collect();
        if let Some(drawn) = &actual.record {
            record.size = drawn.size;
            record.scenes.clone_from(&drawn.scenes);
        }
        Ok(Some(record))
    }

    /// The states of the actual side that a golden records.
    fn states_for(&self, old: &Record) -> Result<States, BlessError> {
        let count = |states: &States| states.runs.iter().map(|run| run.states.len()).sum::<usize>();
        let mut states = self.actual_states.clone();
        for run in &mut states.runs {
            let before = old.states.run(&run.name);
            run.states.retain(|frame, state| {
                let Some(known) = before.and_then(|before| before.states.get(frame)) else { return false };
                state.positions.take_if(|_| known.positions.is_none());
                known.positions.is_none() || state.positions.is_some()
            });
        }
        let (recorded, known) = (count(&old.states), count(&states));
        if known < recorded { Err(BlessError::StatesUnknown { recorded, known }) } else { Ok(states) }
    }
}

/// Files beside the frames of a folder that describe the same states.
const BESIDE: [&str; 3] = [STATES_FILE, DIAGNOSTICS_FILE, SUMMARY_FILE];

/// A file or folder in a folder, except hidden ones.
fn other_file(folder: &Path) -> Option<String> {
    let names = std::fs::read_dir(folder).ok()?.flatten();
    let names = names.map(|entry| entry.file_name().to_string_lossy().into_owned());
    names.filter(|name| !name.starts_with('.')).min()
}

/// The bytes of a picture, with the strongest compression for a golden.
fn bytes(source: &Source, is_golden: bool) -> io::Result<Cow<'_, [u8]>> {
    let bytes = source.bytes().map_err(|error| match error {
        PictureError::Read(error) => error,
        error => io::Error::new(io::ErrorKind::InvalidData, error),
    })?;
    let small = || {
        let pixels = Pixels::from_bytes(&bytes).ok()?;
        Some(encode(pixels.size, &pixels.bytes, &pixels.label?.texts(), Compression::High))
    };
    match (is_golden, source) {
        (true, Source::File(_)) => Ok(small().map_or(bytes, Cow::Owned)),
        _ => Ok(bytes),
    }
}

impl fmt::Display for Blessed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.written.is_empty() && self.removed.is_empty() && self.left.is_empty() {
            return writeln!(f, "nothing was accepted");
        }
        for path in &self.written {
            writeln!(f, "accepted {}", path.display())?;
        }
        for path in &self.removed {
            writeln!(f, "removed {}", path.display())?;
        }
        self.left.iter().try_for_each(|left| writeln!(f, "{left}"))
    }
}
