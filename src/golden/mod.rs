//! Compares pictures, and says whether the simulation or its drawing changed.
//!
//! Frames have digests of the states that they show. A golden, a folder with a few small pictures and a record of all states
//! of its scene, also has rounded positions of nodes. So states are compared first, and then pixels.
//!
//! `Suite` tests scenes against goldens in `cargo test` (with the feature `render`).

mod archive;
mod bless;
mod distance;
#[cfg(feature = "render")]
pub(crate) mod draw;
#[cfg(feature = "render")]
mod moved;
mod page;
mod pair;
mod picture;
#[cfg(feature = "render")]
mod plan;
mod record;
pub(crate) mod report;
mod side;
mod silhouettes;
mod states;
#[cfg(feature = "render")]
mod suite;
mod text;
mod verdict;

pub(crate) use bless::{BlessError, Blessed};
pub(crate) use picture::PictureError;
#[doc(hidden)]
pub use picture::Pixels;
pub(crate) use record::RECORD_FILE;
pub(crate) use side::Side;
pub(crate) use states::Moved;
#[doc(hidden)]
pub use states::{Displacement, FrameDifference, RunDifference};
#[cfg(feature = "render")]
pub use suite::Suite;
pub(crate) use verdict::{MovedHere, Verdict};

use crate::output::{Shown, Tags};
use crate::sim::words::rounded;
use pair::Pair;
use rayon::prelude::*;
use serde::Serialize;
use side::{Kind, Source, states_of};
use states::{States, moved, run_differences};
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};

/// Why no comparison can be made.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ComparisonError {
    #[error("{} does not exist; expected a picture or a folder of pictures", path.display())]
    Absent { path: PathBuf },
    #[error("cannot read {}", path.display())]
    Read { path: PathBuf, source: io::Error },
    #[error("{} is a folder and {} is a file; expected two pictures or two folders of pictures", folder.display(), file.display())]
    Unlike { folder: PathBuf, file: PathBuf },
    #[error("neither {} nor {} has a PNG picture", expected.display(), actual.display())]
    Empty { expected: PathBuf, actual: PathBuf },
    #[error(
        "{}: this record of a golden cannot be read: {what}; if nothing else helps, delete the folder and make the \
         golden again",
        path.join(RECORD_FILE).display()
    )]
    Record { path: PathBuf, what: String },
}

/// The result of comparing the pictures and states of two sides.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Comparison {
    /// One for each picture on either side, in the order of their names.
    pub pictures: Vec<Compared>,
    /// The runs whose states are not as expected, in any frame known on both sides, drawn or not.
    pub moved: Vec<Moved>,
    /// Runs that are known on both sides, frame by frame.
    #[serde(rename = "courses")]
    pub differences: Vec<RunDifference>,
    /// Whether both sides record the same scene; `None` if one of them records none. Another scene with the same states is
    /// not a difference.
    pub same_scene: Option<bool>,
    /// The last frame of the golden and that of its scene, if the scene ends earlier.
    pub ends_early: Option<[u64; 2]>,
    /// Recorded runs of which no state could be compared.
    pub unknown: Vec<String>,
    /// Further remarks.
    pub notes: Vec<String>,
    #[serde(skip)]
    sides: [Side; 2],
    /// The states of the actual side, for a record of them.
    #[serde(skip)]
    actual_states: States,
}

/// The verdict on one picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Compared {
    /// Its file's name.
    pub name: String,
    /// The frame that it shows, if it records one.
    pub frame: Option<u64>,
    /// Its verdict.
    #[serde(flatten)]
    pub verdict: Verdict,
}

impl Comparison {
    /// Compares a picture, or a folder of pictures, with an expected picture, folder or golden. Pictures in folders are
    /// paired by name. `may_be_absent`: what is expected is to be made.
    ///
    /// # Errors
    /// If one of the sides cannot be read or has nothing to compare. Errors of single pictures are verdicts.
    pub(crate) fn of(expected: &Path, actual: &Path, may_be_absent: bool) -> Result<Self, ComparisonError> {
        let expected = if may_be_absent { Side::read_or_absent(expected)? } else { Side::read(expected)? };
        Self::between(expected, Side::read(actual)?)
    }

    /// Compares two sides.
    pub(crate) fn between(expected: Side, actual: Side) -> Result<Self, ComparisonError> {
        let pairs = pairs(&expected, &actual)?;
        let read = |(name, sources)| Pair::read(name, sources);
        let read: Vec<Pair> = match pairs.len() {
            // Starting threads takes a tenth of the time of a pair.
            1 => pairs.into_iter().map(read).collect(),
            _ => pairs.into_par_iter().map(read).collect(),
        };
        // Frames that have no picture in the golden also record states.
        let beside = beside(&expected, &actual);
        let labels = [0, 1].map(|side| -> Vec<&Tags> {
            let more = beside.iter().filter_map(|(_, label)| label.as_ref().ok()?.as_ref()).filter(|_| side == 1);
            read.iter().filter_map(|read| read.labels[side].as_ref()).chain(more).collect()
        });
        let mut notes = Vec::new();
        let [before, after] = Self::states([&expected, &actual], &labels, &mut notes);
        let differences = run_differences(&before, &after);
        let moved = moved(&before, &after, &differences);
        let scenes = [(&expected, &labels[0]), (&actual, &labels[1])].map(|(side, labels)| scenes(side, labels));
        let same_scene = scenes.iter().all(|scenes| !scenes.is_empty()).then(|| scenes[0] == scenes[1]);
        let ends_early = ends(&expected, &actual).filter(|[recorded, end]| end < recorded);
        if let (Some(golden), Some(drawn)) = (&expected.record, &actual.record)
            && golden.subject != drawn.subject
        {
            notes.push(format!("the golden is of {}, and this is {}", golden.subject, drawn.subject));
        }
        notes.extend(other_moments(&read));
        if actual.kind == Kind::Folder && actual.pictures.is_empty() {
            let folder = actual.origin.display();
            notes.push(format!("{folder} has no PNG picture; to compare with a scene, name its file"));
        }
        notes.extend(actual.notes.iter().cloned());
        match ends(&expected, &actual) {
            Some([recorded, end]) if end < recorded => {
                notes.push(format!("the golden continues to frame {recorded}, the scene ends with frame {end}"));
            }
            Some([recorded, end]) if end > recorded => {
                notes.push(format!("the golden ends with frame {recorded}, the scene continues to frame {end}"));
            }
            _ => {}
        }
        let compared = |run: &&states::Run| !differences.iter().any(|difference| difference.run == run.name);
        let is_gone = |run: &&states::Run| moved.iter().any(|moved| moved.run == run.name);
        let recorded = expected.record.iter().flat_map(|record| &record.states.runs);
        let unknown: Vec<_> =
            recorded.filter(compared).filter(|run| !is_gone(run)).map(|run| run.name.clone()).collect();
        if !unknown.is_empty() {
            notes.push(format!("the golden records states of {}, of which none is known here", unknown.join(", ")));
        }
        let judged: Vec<Compared> = beside.iter().filter_map(|(name, label)| judge(name, label, &expected)).collect();
        let undrawn = beside.len() - judged.len();
        if undrawn > 0 {
            let frames = if undrawn == 1 { "1 more frame has" } else { &format!("{undrawn} more frames have") };
            notes.push(format!("{frames} no picture in the golden; only states were compared"));
        }
        let mut pictures: Vec<Compared> = read
            .into_iter()
            .map(|Pair { labels: [label, _], compared: mut picture }| {
                complete(&mut picture, label.as_ref(), &expected, &differences);
                picture
            })
            .chain(judged)
            .collect();
        pictures.sort_by(|one, other| one.name.cmp(&other.name));
        if actual.is_undrawn {
            // Errors in the golden itself are reported even without pictures.
            pictures.retain(|picture| matches!(picture.verdict, Verdict::Unreadable { .. }));
            notes.push("no graphics adapter: states were compared, pictures were not".to_owned());
        }
        let sides = [expected, actual];
        Ok(Self { pictures, moved, differences, same_scene, ends_early, unknown, notes, sides, actual_states: after })
    }

    /// The known states of both sides.
    fn states(sides: [&Side; 2], labels: &[Vec<&Tags>; 2], notes: &mut Vec<String>) -> [States; 2] {
        let has_record = sides.iter().any(|side| side.record.is_some());
        let of_labels = [0, 1].map(|side| states_of(&labels[side], has_record));
        let differs = !moved(&of_labels[0], &of_labels[1], &run_differences(&of_labels[0], &of_labels[1])).is_empty();
        let mut of_labels = of_labels.into_iter();
        [0, 1].map(|at| {
            let mut states = of_labels.next().unwrap_or_default();
            if let Some(record) = &sides[at].record {
                return record.states.clone();
            }
            // Archives can be large: they are read only for distances, or for states that pictures do not record.
            if has_record || differs {
                match sides[at].archive(&labels[at]) {
                    // It has the states of all pictures, and more of each.
                    Ok(Some(archive)) => states.extend(archive),
                    Ok(None) => {}
                    Err(note) => notes.push(note),
                }
                let steps = sides[at].steps(&labels[at]);
                states.set_steps(steps.iter().map(|(run, step)| (run.as_str(), *step)));
            }
            states
        })
    }

    /// Whether everything is as expected.
    pub(crate) fn passes(&self) -> bool {
        let is_there = self.sides[0].kind != Kind::Absent;
        let all_known = self.ends_early.is_none() && self.unknown.is_empty();
        is_there && all_known && self.moved.is_empty() && self.pictures.iter().all(|picture| picture.verdict.passes())
    }

    /// Whether states differ from the expected ones, or are fewer.
    pub(crate) fn state_moved(&self) -> bool {
        let moved = |picture: &Compared| matches!(picture.verdict, Verdict::StateMoved { .. });
        !self.moved.is_empty() || self.ends_early.is_some() || self.pictures.iter().any(moved)
    }

    /// The overall verdict: the most severe of all pictures.
    pub(crate) fn verdict(&self) -> &'static str {
        // From the most severe.
        const ORDER: [&str; 8] = [
            "unreadable",
            "state moved",
            "missing",
            "extra",
            "same state, drawn differently",
            "no state recorded",
            "same state, pixels within tolerance",
            "identical",
        ];
        let kinds = self.pictures.iter().map(|picture| picture.verdict.kind());
        let kinds = kinds.chain((!self.moved.is_empty()).then_some("state moved"));
        let kinds = kinds.chain((self.sides[0].kind == Kind::Absent || self.ends_early.is_some()).then_some("missing"));
        let kinds: BTreeSet<_> = kinds.chain((!self.unknown.is_empty()).then_some("no state recorded")).collect();
        ORDER.into_iter().find(|kind| kinds.contains(kind)).unwrap_or("identical")
    }

    /// Whether there is no golden yet.
    pub(crate) fn is_golden_missing(&self) -> bool {
        self.sides[0].kind == Kind::Absent
    }

    /// The first picture whose state moved.
    pub(crate) fn first_moved(&self) -> Option<&Compared> {
        self.pictures.iter().find(|picture| matches!(picture.verdict, Verdict::StateMoved { .. }))
    }

    /// The command that accepts the actual side; `None` if there is nothing to accept, or nothing that can be accepted.
    pub(crate) fn command_to_accept(&self) -> Option<String> {
        if self.passes() || self.unfit().is_some() || !self.has_something_to_accept() {
            return None;
        }
        Some(self.command())
    }

    fn command(&self) -> String {
        let [expected, actual] = &self.sides;
        let is_other = self.needs_state() && expected.kind != Kind::Absent;
        let option = if is_other { "--bless-state" } else { "--bless" };
        format!("localshape compare {option}{} {} {}", actual.options, expected.typed(), actual.typed())
    }

    /// The number of compared states.
    fn states_compared(&self) -> usize {
        self.differences.iter().map(|difference| difference.moments.len()).sum()
    }
}

/// Pictures paired by name.
type Pairs = Vec<(String, [Option<Source>; 2])>;

fn pairs(expected: &Side, actual: &Side) -> Result<Pairs, ComparisonError> {
    let unlike = |folder: &Side, file: &Side| {
        Err(ComparisonError::Unlike { folder: folder.origin.clone(), file: file.origin.clone() })
    };
    match (expected.kind, actual.kind) {
        (Kind::Picture, Kind::Picture) => {
            let source = |side: &Side| side.pictures.values().next().cloned();
            let name = actual.pictures.keys().next().cloned().unwrap_or_default();
            return Ok(vec![(name, [source(expected), source(actual)])]);
        }
        (Kind::Absent, Kind::Picture) if !expected.origin.is_dir() => {
            return Ok(actual
                .pictures
                .iter()
                .map(|(name, source)| (name.clone(), [None, Some(source.clone())]))
                .collect());
        }
        (Kind::Picture, _) => return unlike(actual, expected),
        (_, Kind::Picture) => return unlike(expected, actual),
        _ => {}
    }
    let mut pairs: BTreeMap<String, [Option<Source>; 2]> = BTreeMap::new();
    for (name, source) in &expected.pictures {
        pairs.entry(name.clone()).or_default()[0] = Some(source.clone());
    }
    // A picture in the record belongs to the golden, even if its file is missing.
    for drawn in expected.record.iter().flat_map(|record| &record.pictures) {
        pairs.entry(drawn.file.clone()).or_default();
    }
    for (name, source) in &actual.pictures {
        // A golden has a few pictures of many frames.
        if (expected.kind, actual.kind) != (Kind::Golden, Kind::Folder) || pairs.contains_key(name) {
            pairs.entry(name.clone()).or_default()[1] = Some(source.clone());
        }
    }
    if pairs.is_empty() && expected.record.is_none() && !actual.is_undrawn {
        return Err(ComparisonError::Empty { expected: expected.origin.clone(), actual: actual.origin.clone() });
    }
    Ok(pairs.into_iter().collect())
}

/// Frames of a folder that have no picture in the golden, with their metadata.
fn beside(expected: &Side, actual: &Side) -> Vec<(String, Result<Option<Tags>, PictureError>)> {
    if (expected.kind, actual.kind) != (Kind::Golden, Kind::Folder) {
        return Vec::new();
    }
    let recorded = |name: &String| {
        let drawn = expected.record.iter().flat_map(|record| &record.pictures);
        expected.pictures.contains_key(name) || drawn.into_iter().any(|drawn| drawn.file == *name)
    };
    let more = actual.pictures.iter().filter(|(name, _)| !recorded(name));
    let label = |source: &Source| match source {
        Source::File(path) => Pixels::read_label(path),
        Source::Memory(bytes) => Pixels::from_bytes(bytes).map(|pixels| pixels.label),
    };
    more.map(|(name, source)| (name.clone(), label(source))).collect()
}

/// The verdict on a frame that has no picture in the golden; `None` if its states are as recorded.
fn judge(name: &str, label: &Result<Option<Tags>, PictureError>, expected: &Side) -> Option<Compared> {
    let verdict = match label {
        Err(error) => Verdict::Unreadable { message: format!("{name}: {error}") },
        Ok(None) => Verdict::Extra,
        Ok(Some(label)) => {
            let frame = label.frame().unwrap_or(0);
            let runs = &expected.record.as_ref()?.states.runs;
            let is_other = |(digest, run): &&(String, String)| {
                let state = runs.iter().find(|known| known.name == *run).and_then(|run| run.states.get(&frame));
                state.is_some_and(|state| !digest.starts_with(&state.digest))
            };
            let moved = label.states.iter().filter(is_other);
            let runs: Vec<_> = moved.map(|(_, run)| MovedHere { run: run.clone(), displacement: None }).collect();
            if runs.is_empty() {
                return None;
            }
            Verdict::StateMoved { runs, distance: None }
        }
    };
    let frame = label.as_ref().ok().and_then(|label| label.as_ref()?.frame());
    Some(Compared { name: name.to_owned(), frame, verdict })
}

/// Adds to a verdict how far a state moved, and whether the golden contradicts itself.
fn complete(picture: &mut Compared, label: Option<&Tags>, expected: &Side, differences: &[RunDifference]) {
    if let Verdict::StateMoved { runs, .. } = &mut picture.verdict {
        for here in runs {
            let difference = differences.iter().find(|difference| difference.run == here.run);
            let frame = picture.frame.unwrap_or(0);
            let moment =
                difference.and_then(|difference| difference.moments.iter().find(|moment| moment.frame == frame));
            here.displacement = moment.and_then(|moment| moment.displacement);
        }
    }
    let Some(record) = &expected.record else { return };
    if !expected.pictures.contains_key(&picture.name) || matches!(picture.verdict, Verdict::Unreadable { .. }) {
        return;
    }
    let drawn = record.pictures.iter().find(|drawn| drawn.file == picture.name);
    let contradiction = match (drawn, label) {
        (None, _) => Some("does not know this picture"),
        (Some(_), None) => Some("knows its state, but this picture has lost its text chunks"),
        (Some(drawn), Some(label)) => {
            let is_other = label.states.iter().any(|(digest, run)| {
                let state = record.states.run(run).and_then(|run| run.states.get(&drawn.frame));
                state.is_none_or(|state| !digest.starts_with(&state.digest))
            });
            if is_other || label.frame().unwrap_or(0) != drawn.frame {
                Some("records another state than this picture shows")
            } else if label.adapter != drawn.adapter {
                Some("records that another adapter drew this picture")
            } else {
                None
            }
        }
    };
    if let Some(what) = contradiction {
        let path = expected.origin.join(&picture.name);
        let message = format!("{}: the golden contradicts itself: {RECORD_FILE} {what}", path.display());
        picture.verdict = Verdict::Unreadable { message };
    }
}

/// A message if pictures of one name show different frames or times.
fn other_moments(pairs: &[Pair]) -> Option<String> {
    let moment = |pair: &Pair| {
        let shown = |label: &Option<Tags>| match label.as_ref()?.shows {
            Shown::Frame { frame, time } => Some((frame, time)),
            Shown::Figure(_) => None,
        };
        let ((recorded, was), (frame, is)) = (shown(&pair.labels[0])?, shown(&pair.labels[1])?);
        let name = &pair.compared.name;
        if frame != recorded {
            return Some(format!("{name} shows frame {frame} instead of frame {recorded}"));
        }
        // With different steps, frames have slightly different times.
        let is_other = (is - was).abs() > 0.01 * is.abs().max(was.abs());
        is_other.then(|| {
            let [was, is] = [was, is].map(|time| rounded(time, 4));
            format!("{name} shows frame {frame} at {is} s instead of {was} s")
        })
    };
    let mut all = pairs.iter().filter_map(moment);
    let first = all.next()?;
    Some(match all.count() {
        0 => first,
        1 => format!("{first}, and so does 1 more picture"),
        more => format!("{first}, and so do {more} more pictures"),
    })
}

/// Digests of the scenes of a side.
fn scenes(side: &Side, labels: &[&Tags]) -> BTreeSet<String> {
    match &side.record {
        Some(record) => record.scenes.iter().cloned().collect(),
        None => labels.iter().flat_map(|label| label.scenes.iter().cloned()).collect(),
    }
}

/// The last frame that a golden records, and the last one of its scene.
fn ends(expected: &Side, actual: &Side) -> Option<[u64; 2]> {
    if actual.kind != Kind::Drawn || expected.kind != Kind::Golden {
        return None;
    }
    let last = |side: &Side| {
        let runs = side.record.iter().flat_map(|record| &record.states.runs);
        runs.filter_map(|run| run.states.keys().next_back()).max().copied()
    };
    Some([last(expected)?, last(actual)?])
}
