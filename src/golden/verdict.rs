//! Verdicts on two pictures: whether the simulation or the drawing changed.

use super::picture::{PictureError, Pixels};
use super::source::{Pair, Source};
use super::tolerance::Distance;
use crate::output::Tags;
use serde::{Serialize, Serializer};
use std::borrow::Cow;
use std::error::Error;
use std::fmt;
use std::sync::Arc;

/// The verdict on two pictures, from the best to the worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Verdict {
    /// All pixels and states are equal.
    Identical,
    /// The states are equal; pixels differ within the tolerance.
    WithinTolerance,
    /// Pixels differ by more than the tolerance, and one of the pictures does not record its state.
    NoState,
    /// The states are equal; pixels differ by more than the tolerance.
    DrawnDifferently,
    /// The expected picture does not exist.
    Extra,
    /// The actual picture does not exist.
    Missing,
    /// Positions or velocities differ.
    StateMoved,
    /// One of the files cannot be compared as a picture.
    Unreadable,
}

impl Verdict {
    /// Whether the picture passes.
    pub(crate) fn passes(self) -> bool {
        self <= Self::WithinTolerance
    }

    /// The verdict in words.
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::Identical => "identical",
            Self::WithinTolerance => "within tolerance",
            Self::NoState => "no state recorded",
            Self::DrawnDifferently => "drawn differently",
            Self::Extra => "extra",
            Self::Missing => "missing",
            Self::StateMoved => "state moved",
            Self::Unreadable => "unreadable",
        }
    }
}

impl Serialize for Verdict {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.words())
    }
}

/// The verdict on the pictures of one name.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Compared {
    /// Its file name.
    pub(crate) name: String,
    /// The frame that it shows, if it records one.
    pub(crate) frame: Option<u64>,
    pub(crate) verdict: Verdict,
    /// The runs whose states differ.
    pub(crate) runs: Vec<String>,
    /// The distance of the pixels; `None` if the sizes differ or a picture is missing.
    pub(crate) distance: Option<Distance>,
    /// A further difference or a fault.
    pub(crate) note: Option<String>,
    /// Whether both pictures record states.
    #[serde(skip)]
    pub(super) tags: [Option<Tags>; 2],
    #[serde(skip)]
    pub(super) sources: Pair,
}

impl Compared {
    /// Reads and compares the pictures of a name.
    pub(super) fn read(name: String, sources: Pair) -> Self {
        let [expected, actual] = sources.each_ref().map(|source| source.as_ref().map(Source::bytes));
        let decoded = |file: Result<Cow<'_, [u8]>, PictureError>| Pixels::from_bytes(&file?).map(Arc::new);
        // Most pairs that pass are equal files, which are decoded once.
        let are_equal = matches!((&expected, &actual), (Some(Ok(one)), Some(Ok(other))) if one == other);
        let expected = expected.map(decoded);
        let actual = match &expected {
            Some(Ok(pixels)) if are_equal => Some(Ok(Arc::clone(pixels))),
            _ => actual.map(decoded),
        };
        let read = [expected, actual];
        // Damage is reported even if there is only one picture.
        let damage = |at: usize| {
            let error = read[at].as_ref()?.as_ref().err()?;
            Some(damage(sources[at].as_ref()?, ["expected", "actual"][at], error))
        };
        let damages: Vec<String> = [0, 1].into_iter().filter_map(damage).collect();
        let pixels = read.map(|side| side.and_then(Result::ok));
        let alone = |verdict| (verdict, Vec::new(), None, None);
        let (verdict, runs, distance, note) = match &pixels {
            _ if !damages.is_empty() => (Verdict::Unreadable, Vec::new(), None, Some(damages.join("; "))),
            [Some(expected), Some(actual)] => compare(expected, actual),
            [None, Some(_)] => alone(Verdict::Extra),
            [_, None] => alone(Verdict::Missing),
        };
        let tags = pixels.map(|pixels| pixels?.label.clone());
        let frame = tags.iter().flatten().find_map(Tags::frame);
        Self { name, frame, verdict, runs, distance, note, tags, sources }
    }
}

/// The verdict on two pictures, the runs that moved, the distance of the pixels, and a further difference.
fn compare(expected: &Pixels, actual: &Pixels) -> (Verdict, Vec<String>, Option<Distance>, Option<String>) {
    let distance = Distance::new(expected, actual);
    let alike = match distance {
        Some(Distance { unequal: 0, .. }) => Some(Verdict::Identical),
        Some(distance) if distance.is_allowed() => Some(Verdict::WithinTolerance),
        _ => None,
    };
    let note = (expected.size != actual.size).then(|| {
        let [[a, b], [c, d]] = [expected.size, actual.size];
        format!("{c}×{d} pixels instead of {a}×{b}")
    });
    let (Some(before), Some(after)) = (&expected.label, &actual.label) else {
        return (alike.unwrap_or(Verdict::NoState), Vec::new(), distance, note);
    };
    let runs = moved(before, after);
    let frames = before.frame().zip(after.frame()).filter(|(before, after)| before != after);
    let other = frames.map(|(before, after)| format!("it shows frame {after} instead of frame {before}"));
    let verdict = if runs.is_empty() { alike.unwrap_or(Verdict::DrawnDifferently) } else { Verdict::StateMoved };
    (verdict, runs, distance, other.or(note))
}

/// The runs that differ, or are in one of the pictures only.
fn moved(before: &Tags, after: &Tags) -> Vec<String> {
    let absent = |from: &Tags, state: &(String, String)| !from.states.contains(state);
    let gone = before.states.iter().filter(|state| absent(after, state));
    let come = after.states.iter().filter(|state| absent(before, state));
    let mut runs: Vec<String> = Vec::new();
    for (_, run) in gone.chain(come) {
        if !runs.contains(run) {
            runs.push(run.clone());
        }
    }
    runs
}

fn damage(source: &Source, side: &str, error: &PictureError) -> String {
    let place = match source {
        Source::File(path) => path.display().to_string(),
        Source::Memory(_) => format!("the {side} picture"),
    };
    error.source().map_or_else(|| format!("{place}: {error}"), |cause| format!("{place}: {error}: {cause}"))
}

impl fmt::Display for Compared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.verdict.words())?;
        if self.verdict.passes() && self.tags.iter().any(Option::is_none) {
            f.write_str(" (no state recorded)")?;
        }
        let runs = (!self.runs.is_empty()).then(|| self.runs.join(", "));
        let pixels = self.distance.filter(|distance| distance.unequal > 0 && runs.is_none()).map(|one| one.to_string());
        let parts: Vec<String> = runs.into_iter().chain(pixels).chain(self.note.clone()).collect();
        if parts.is_empty() { Ok(()) } else { write!(f, ": {}", parts.join("; ")) }
    }
}

#[cfg(test)]
#[path = "../../tests/inside/verdict.rs"]
mod tests;
