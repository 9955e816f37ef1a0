//! Accepting what is there as what is expected from now on.

use super::record::{Drawn, RECORD_FILE, Record};
use super::side::{Kind, Source, frame_of};
use super::{Comparison, Verdict};
use crate::output::{Label, OutputError, write_whole};
use std::fmt;
use std::io;
use std::path::PathBuf;

/// What was accepted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Blessed {
    /// Files that were written, in order.
    pub written: Vec<PathBuf>,
    /// Files of a golden that were removed because nothing stands for them any more.
    pub removed: Vec<PathBuf>,
    /// What was left as it is, and why.
    pub left: Vec<String>,
}

/// Why nothing was accepted.
#[derive(Debug, thiserror::Error)]
pub enum BlessError {
    /// The simulation gave other states, and accepting that was not asked for.
    #[error("the state moved, so nothing was accepted; if that is meant: {command}")]
    StateMoved {
        /// What would accept it.
        command: String,
    },
    /// What should be accepted is no picture.
    #[error("nothing was accepted: {0}")]
    Unreadable(String),
    /// The golden records more states than the other side knows.
    #[error(
        "nothing was accepted: the golden records {recorded} states, and {known} of them are known here. \
         Compare it with its scene file, or with frames that were drawn with --states"
    )]
    StatesUnknown {
        /// States in the record.
        recorded: usize,
        /// Those that could be renewed.
        known: usize,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] OutputError),
}

impl Comparison {
    /// Whether accepting means to accept other states, or states instead of what cannot be read.
    pub(super) fn needs_state(&self) -> bool {
        let is_unreadable = |verdict: &Verdict| matches!(verdict, Verdict::Unreadable { .. });
        self.state_moved() || self.pictures.iter().any(|picture| is_unreadable(&picture.verdict))
    }

    /// What is wrong with a picture that would have to be accepted.
    pub(super) fn unreadable_actual(&self) -> Option<String> {
        let unreadable = self.pictures.iter().filter(|picture| matches!(picture.verdict, Verdict::Unreadable { .. }));
        let mut wrong = unreadable.filter_map(|picture| {
            let source = self.actual_source(&picture.name)?;
            source.pixels().err().map(|error| format!("{}: {error}", picture.name))
        });
        wrong.next()
    }

    fn actual_source(&self, name: &str) -> Option<&Source> {
        self.sides[1].pictures.get(name)
    }

    /// Replaces what was expected by what is there, as far as it failed. States are replaced only if that is asked for.
    ///
    /// # Errors
    /// If states moved and that was not to be accepted, if what is there cannot be read, or a file cannot be written.
    pub fn bless(&self, with_states: bool) -> Result<Blessed, BlessError> {
        let mut blessed = Blessed::default();
        if self.passes() {
            return Ok(blessed);
        }
        if let Some(message) = self.unreadable_actual() {
            return Err(BlessError::Unreadable(message));
        }
        let [expected, actual] = &self.sides;
        if actual.is_undrawn {
            return Err(BlessError::Unreadable(
                "without a graphics adapter there are no pictures to accept".to_owned(),
            ));
        }
        if self.needs_state() && !with_states && expected.kind != Kind::Absent {
            return Err(BlessError::StateMoved { command: self.command_to_accept().unwrap_or_default() });
        }
        let record = self.record_to_write()?;
        let is_golden = record.is_some();
        let is_picture = expected.kind == Kind::Picture || actual.kind == Kind::Picture;
        if !is_picture {
            std::fs::create_dir_all(&expected.origin).map_err(OutputError::writing(&expected.origin))?;
        }
        for picture in self.pictures.iter().filter(|picture| !picture.verdict.passes()) {
            let target = if is_picture { expected.origin.clone() } else { expected.origin.join(&picture.name) };
            let Some(source) = self.actual_source(&picture.name) else {
                let is_known = record
                    .as_ref()
                    .is_some_and(|record| record.pictures.iter().any(|drawn| drawn.file == picture.name));
                if is_golden && !is_known && target.exists() {
                    std::fs::remove_file(&target).map_err(OutputError::writing(&target))?;
                    blessed.removed.push(target);
                } else {
                    blessed.left.push(format!(
                        "{} is missing in {} and was left",
                        target.display(),
                        actual.origin.display()
                    ));
                }
                continue;
            };
            write_whole(&target, &bytes(source, is_golden).map_err(OutputError::reading(&target))?)?;
            blessed.written.push(target);
        }
        if let Some(record) = record {
            let target = expected.origin.join(RECORD_FILE);
            let text = record.text();
            if std::fs::read(&target).ok().as_deref() != Some(text.as_bytes()) {
                write_whole(&target, text.as_bytes())?;
                blessed.written.push(target);
            }
        }
        Ok(blessed)
    }

    /// The record that a golden has after blessing; `None` if it is no golden.
    fn record_to_write(&self) -> Result<Option<Record>, BlessError> {
        let [expected, actual] = &self.sides;
        let label = |name: &str| self.actual_source(name).and_then(|source| source.pixels().ok()?.label);
        let drawn = |name: &str, label: &Label| Drawn {
            file: name.to_owned(),
            frame: frame_of(label).unwrap_or(0),
            adapter: label.adapter().to_owned(),
            version: label.version().to_owned(),
        };
        let old = match (expected.kind, &expected.record) {
            (Kind::Golden, Some(old)) => old,
            // A new golden has a record if its states are known.
            (Kind::Absent, _) => return Ok(actual.record.clone()),
            _ => return Ok(None),
        };
        let is_same = !self.needs_state();
        let mut record = match &actual.record {
            // Only pictures are renewed, and with them who drew them.
            _ if is_same => old.clone(),
            Some(record) => record.clone(),
            None => {
                let count =
                    |states: &super::states::States| states.runs.iter().map(|run| run.states.len()).sum::<usize>();
                let mut states = self.actual_states.clone();
                for run in &mut states.runs {
                    let before = old.states.run(&run.name);
                    run.states.retain(|frame, _| before.is_some_and(|before| before.states.contains_key(frame)));
                    for (frame, state) in &mut run.states {
                        let is_placed =
                            before.and_then(|run| run.states.get(frame)).is_some_and(|state| state.places.is_some());
                        state.places.take_if(|_| !is_placed);
                        if is_placed && state.places.is_none() {
                            return Err(BlessError::StatesUnknown { recorded: count(&old.states), known: 0 });
                        }
                    }
                }
                let (recorded, known) = (count(&old.states), count(&states));
                if known < recorded {
                    return Err(BlessError::StatesUnknown { recorded, known });
                }
                Record { states, ..old.clone() }
            }
        };
        // The adapters of pictures that stay are those that drew them.
        let passes = |name: &str| self.pictures.iter().any(|picture| picture.name == name && picture.verdict.passes());
        let mut pictures = Vec::new();
        for (name, _) in actual.pictures.iter().filter(|(name, _)| record_names(old, actual.record.as_ref(), name)) {
            let kept = old.pictures.iter().find(|drawn| drawn.file == *name).filter(|_| passes(name)).cloned();
            pictures.extend(kept.or_else(|| label(name).map(|label| drawn(name, &label))));
        }
        if actual.record.is_none() {
            let missing = old.pictures.iter().filter(|drawn| !actual.pictures.contains_key(&drawn.file));
            pictures.extend(missing.cloned());
        }
        pictures.sort_by(|one, other| one.file.cmp(&other.file));
        record.pictures = pictures;
        if let Some(record_of_actual) = &actual.record {
            (record.size, record.samples) = (record_of_actual.size, record_of_actual.samples);
            record.scenes.clone_from(&record_of_actual.scenes);
        }
        Ok(Some(record))
    }
}

/// Whether a golden has a picture of that name: as it had, or as it would have now.
fn record_names(old: &Record, new: Option<&Record>, name: &str) -> bool {
    let names = |record: &Record| record.pictures.iter().any(|drawn| drawn.file == name);
    new.map_or_else(|| names(old), names)
}

/// The bytes of a picture, for a golden as few as can be had.
fn bytes(source: &Source, is_golden: bool) -> io::Result<Vec<u8>> {
    let small = || {
        let pixels = source.pixels().ok()?;
        Some(pixels.label?.encode(pixels.size, &pixels.bytes))
    };
    match (is_golden, source) {
        (true, Source::File(_)) => small().map_or_else(|| source.bytes(), Ok),
        _ => source.bytes(),
    }
}

impl fmt::Display for Blessed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.written.is_empty() && self.removed.is_empty() && self.left.is_empty() {
            return writeln!(f, "nothing to accept");
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
