//! Compares two sides: pictures, folders of pictures, or a scene and its golden.

use super::error::ComparisonError;
use super::keys::ChangedKey;
use super::record::RECORD_FILE;
use super::source::{Pair, Pictures, Source, pictures_in};
use super::states::{Moved, State, States, moved};
use super::verdict::{Compared, Verdict};
use crate::output::{OutputError, Shown, Tags};
use crate::reading::beside::name_of;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::io::ErrorKind;
use std::path::Path;

/// Number of pictures that are listed one by one.
const MOST_LISTED: usize = 12;

/// The result of comparing the pictures and states of two sides.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Comparison {
    /// One for each picture on either side, in the order of their names.
    pub(crate) pictures: Vec<Compared>,
    /// The runs with unexpected states, in any frame known on both sides, drawn or not.
    pub(crate) moved: Vec<Moved>,
    /// The keys of the scene that changed, compared with its golden.
    pub(crate) keys: Vec<ChangedKey>,
    /// The last frame of the golden and that of its scene, if the scene ends earlier.
    pub(crate) ends_early: Option<[u64; 2]>,
    /// Whether the golden does not exist yet.
    pub(crate) golden_is_missing: bool,
    /// Further remarks.
    pub(crate) notes: Vec<String>,
    /// The number of states known on both sides, if there is a golden.
    pub(crate) states: Option<usize>,
    /// The title of its page.
    #[serde(skip)]
    pub(super) title: String,
    /// The command that makes or renews the golden.
    #[serde(skip)]
    pub(super) command: Option<String>,
}

impl Comparison {
    /// Compares two pictures, or two folders of pictures, which are paired by name.
    ///
    /// # Errors
    /// If one of the sides cannot be read or has nothing to compare. Errors of single pictures are verdicts.
    pub(crate) fn of_pictures(expected: &Path, actual: &Path) -> Result<Self, ComparisonError> {
        let sides = [expected, actual];
        let is_folder = |path: &Path| match path.metadata() {
            Ok(found) => Ok(found.is_dir()),
            Err(source) if source.kind() == ErrorKind::NotFound => Err(ComparisonError::Absent { path: path.into() }),
            Err(source) => Err(OutputError::reading(path)(source).into()),
        };
        let are_folders = [is_folder(expected)?, is_folder(actual)?];
        let pairs = match are_folders {
            [false, false] => [(name_of(actual), sides.map(|path| Some(Source::File(path.into()))))].into(),
            [true, true] => {
                if let Some(path) = sides.into_iter().find(|path| path.join(RECORD_FILE).exists()) {
                    let path = path.display();
                    return Err(ComparisonError::Wrong(format!(
                        "{path} is a golden, which is compared with its scene: localshape compare {path} SCENE"
                    )));
                }
                paired(pictures_in(expected)?, pictures_in(actual)?)
            }
            [is_folder, _] => {
                let [folder, file] = if is_folder { sides } else { [actual, expected] }.map(Path::display);
                return Err(ComparisonError::Wrong(format!(
                    "{folder} is a folder and {file} is a file; expected two pictures or two folders of pictures"
                )));
            }
        };
        if pairs.is_empty() {
            let [expected, actual] = sides.map(Path::display);
            return Err(ComparisonError::Wrong(format!("neither {expected} nor {actual} has a PNG picture")));
        }
        let mut comparison = Self::of_pairs(pairs, actual);
        let tags = [0, 1].map(|side| -> Vec<&Tags> {
            comparison.pictures.iter().filter_map(|picture| picture.tags[side].as_ref()).collect()
        });
        let scenes = tags.each_ref().map(|tags| tags.iter().flat_map(|tags| &tags.scenes).collect::<BTreeSet<_>>());
        let are_other = scenes.iter().all(|scenes| !scenes.is_empty()) && scenes[0] != scenes[1];
        // A single picture has a verdict, which includes its states.
        let moved = if are_folders[0] { moved(&states_of(&tags[0]), &states_of(&tags[1])) } else { Vec::new() };
        comparison.moved = moved;
        comparison.notes.extend(are_other.then(|| "the scenes are not the same".to_owned()));
        Ok(comparison)
    }

    /// Compares pairs of pictures. The name of the actual side is the title.
    pub(super) fn of_pairs(pairs: BTreeMap<String, Pair>, actual: &Path) -> Self {
        let read = |(name, pair)| Compared::read(name, pair);
        let pictures = match pairs.len() {
            // Starting threads takes a tenth of the time of a pair.
            1 => pairs.into_iter().map(read).collect(),
            _ => pairs.into_par_iter().map(read).collect(),
        };
        let title = actual.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Self { pictures, title, ..Self::default() }
    }

    /// Whether everything is as expected.
    pub(crate) fn passes(&self) -> bool {
        let is_whole = !self.golden_is_missing && self.ends_early.is_none();
        is_whole && self.moved.is_empty() && self.failures() == 0
    }

    /// The overall verdict: the worst one.
    pub(crate) fn verdict(&self) -> Verdict {
        let moved = (!self.moved.is_empty()).then_some(Verdict::StateMoved);
        let missing = (self.golden_is_missing || self.ends_early.is_some()).then_some(Verdict::Missing);
        let pictures = self.pictures.iter().map(|picture| picture.verdict);
        pictures.chain(moved).chain(missing).max().unwrap_or(Verdict::Identical)
    }

    /// The command that makes or renews the golden, if it differs from its scene.
    pub(crate) fn command_to_accept(&self) -> Option<&str> {
        self.command.as_deref().filter(|_| !self.passes())
    }

    /// The findings and verdicts, line by line, and the command that makes or renews the golden.
    pub(crate) fn advised(&self) -> String {
        let what = if self.golden_is_missing { "make it with" } else { "accept with" };
        let advice = self.command_to_accept().map(|command| format!("{what}: {command}\n"));
        self.to_string() + &advice.unwrap_or_default()
    }

    fn failures(&self) -> usize {
        self.pictures.iter().filter(|picture| !picture.verdict.passes()).count()
    }

    /// The result of all pictures in words.
    pub(super) fn summary(&self) -> String {
        let all = match self.pictures.len() {
            1 => "1 picture".to_owned(),
            all => format!("{all} pictures"),
        };
        match self.failures() {
            0 => {
                let mut counts: BTreeMap<Verdict, usize> = BTreeMap::new();
                for picture in &self.pictures {
                    *counts.entry(picture.verdict).or_default() += 1;
                }
                let counts: Vec<_> =
                    counts.iter().map(|(verdict, count)| format!("{count} {}", verdict.words())).collect();
                format!("{all}: {}", counts.join(", "))
            }
            1 => format!("1 of {all} is not as expected"),
            failed => format!("{failed} of {all} are not as expected"),
        }
    }

    /// All findings but the verdicts on single pictures, line by line.
    pub(super) fn findings(&self) -> Vec<String> {
        let moved = self.moved.iter().map(|moved| format!("state moved: {moved}"));
        let keys = self.keys.iter().map(|key| format!("changed: {key}"));
        moved.chain(keys).chain(self.notes.iter().cloned()).collect()
    }
}

/// Pictures of two folders by name.
pub(super) fn paired(expected: Pictures, actual: Pictures) -> BTreeMap<String, Pair> {
    let mut pairs: BTreeMap<String, Pair> = BTreeMap::new();
    for (side, pictures) in [expected, actual].into_iter().enumerate() {
        for (name, source) in pictures {
            pairs.entry(name).or_default()[side] = Some(source);
        }
    }
    pairs
}

/// The states that pictures record; none if the pictures show several scenes, whose frames cannot be compared.
fn states_of(tags: &[&Tags]) -> States {
    let mut states = States::default();
    let scenes: BTreeSet<_> = tags.iter().flat_map(|tags| &tags.scenes).collect();
    for tags in tags.iter().filter(|_| scenes.len() <= 1) {
        let Shown::Frame { frame, .. } = tags.shows else { continue };
        for (digest, run) in &tags.states {
            states.run_mut(run).states.insert(frame, State { digest: digest.clone(), positions: None });
        }
    }
    states
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.findings().iter().try_for_each(|finding| writeln!(f, "{finding}"))?;
        if self.golden_is_missing {
            return Ok(());
        }
        let wrong: Vec<_> = self.pictures.iter().filter(|picture| !picture.verdict.passes()).collect();
        // A single picture that passes is listed, too.
        let listed = if self.pictures.len() == 1 { self.pictures.iter().collect() } else { wrong };
        for picture in listed.iter().take(MOST_LISTED) {
            writeln!(f, "{}: {picture}", picture.name)?;
        }
        if listed.len() > MOST_LISTED {
            writeln!(f, "and {} more", listed.len() - MOST_LISTED)?;
        }
        if self.pictures.len() > 1 {
            writeln!(f, "{}", self.summary())?;
        }
        match self.states {
            Some(states) if self.moved.is_empty() => writeln!(f, "{states} states are the same"),
            _ => Ok(()),
        }
    }
}
