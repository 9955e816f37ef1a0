//! Comparing pictures so that a difference says what moved: the simulation, or the drawing of it.
//!
//! Frames carry digests of the states that they show, so two of them are told apart by physics first and by pixels then.
//!
//! ```no_run
//! use localshape::golden::Comparison;
//!
//! let comparison = Comparison::of("expected".as_ref(), "actual".as_ref())?;
//! assert!(comparison.passes(), "{comparison}");
//! # Ok::<(), localshape::golden::ComparisonError>(())
//! ```

mod picture;
pub mod report;
mod verdict;

pub use picture::{PictureError, Pixels};
pub use verdict::{Distance, Verdict};

use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// What keeps a comparison from being made at all.
#[derive(Debug, thiserror::Error)]
pub enum ComparisonError {
    /// A file or folder is not there or cannot be read.
    #[error("cannot read {}", path.display())]
    Read {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// One side is a folder, and the other one is not.
    #[error("{} is a folder and {} is a file; expected two pictures or two folders of pictures", folder.display(), file.display())]
    Unlike {
        /// The folder.
        folder: PathBuf,
        /// The file.
        file: PathBuf,
    },
    /// There is nothing to compare.
    #[error("neither {} nor {} holds a PNG picture", expected.display(), actual.display())]
    Empty {
        /// The folder with what was expected.
        expected: PathBuf,
        /// The other folder.
        actual: PathBuf,
    },
}

/// Two pictures, or two folders of them, beside each other.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// One for each picture on either side, in the order of their names.
    pub pictures: Vec<Compared>,
}

/// The verdict on one picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Compared {
    /// Its file's name.
    pub name: String,
    /// What is said of it.
    #[serde(flatten)]
    pub verdict: Verdict,
    /// Whether both say that they come from the same scene; `None` if they do not say. Another scene with the same states is
    /// no difference of physics or drawing.
    pub same_scene: Option<bool>,
}

/// So many pictures are told one by one.
const MOST_TOLD: usize = 12;

impl Comparison {
    /// Compares a picture, or a folder of pictures, with what was expected. Pictures of folders belong together by name.
    ///
    /// # Errors
    /// If there is nothing to compare on one of the sides. What is wrong with single pictures is told in their verdicts.
    pub fn of(expected: &Path, actual: &Path) -> Result<Self, ComparisonError> {
        let is_folder = |path: &Path| match path.metadata() {
            Ok(found) => Ok(found.is_dir()),
            Err(source) => Err(ComparisonError::Read { path: path.into(), source }),
        };
        let pictures = match (is_folder(expected)?, is_folder(actual)?) {
            (false, false) => {
                let name = actual.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
                vec![compare(name, Some(expected), Some(actual))]
            }
            (true, true) => {
                let mut pairs: BTreeMap<String, [Option<PathBuf>; 2]> = BTreeMap::new();
                for (side, folder) in [expected, actual].into_iter().enumerate() {
                    for path in pictures_in(folder)? {
                        let name =
                            path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
                        pairs.entry(name).or_default()[side] = Some(path);
                    }
                }
                if pairs.is_empty() {
                    return Err(ComparisonError::Empty { expected: expected.into(), actual: actual.into() });
                }
                let compared = |(name, [before, after]): (String, [Option<PathBuf>; 2])| {
                    compare(name, before.as_deref(), after.as_deref())
                };
                pairs.into_iter().map(compared).collect()
            }
            (true, false) => return Err(ComparisonError::Unlike { folder: expected.into(), file: actual.into() }),
            (false, true) => return Err(ComparisonError::Unlike { folder: actual.into(), file: expected.into() }),
        };
        Ok(Self { pictures })
    }

    /// Whether nothing is wrong.
    pub fn passes(&self) -> bool {
        self.pictures.iter().all(|picture| picture.verdict.passes())
    }

    /// The first picture whose state moved.
    pub fn first_moved(&self) -> Option<&Compared> {
        self.pictures.iter().find(|picture| matches!(picture.verdict, Verdict::StateMoved { .. }))
    }
}

fn compare(name: String, expected: Option<&Path>, actual: Option<&Path>) -> Compared {
    let (Some(expected), Some(actual)) = (expected, actual) else {
        let verdict = if actual.is_none() { Verdict::Missing } else { Verdict::Extra };
        return Compared { name, verdict, same_scene: None };
    };
    match (Pixels::read(expected), Pixels::read(actual)) {
        (Ok(expected), Ok(actual)) => {
            let scenes = expected.tags.as_ref().zip(actual.tags.as_ref());
            let same_scene = scenes.map(|(before, after)| before.scene == after.scene);
            Compared { name, verdict: Verdict::new(&expected, &actual), same_scene }
        }
        (Err(error), _) | (_, Err(error)) => {
            Compared { name, verdict: Verdict::Unreadable { message: told(&error) }, same_scene: None }
        }
    }
}

/// An error with its cause.
fn told(error: &PictureError) -> String {
    use std::error::Error;
    error.source().map_or_else(|| error.to_string(), |cause| format!("{error}: {cause}"))
}

/// The PNG files in a folder.
fn pictures_in(folder: &Path) -> Result<Vec<PathBuf>, ComparisonError> {
    let failed = |source| ComparisonError::Read { path: folder.into(), source };
    let paths: io::Result<Vec<PathBuf>> =
        std::fs::read_dir(folder).map_err(failed)?.map(|entry| Ok(entry?.path())).collect();
    let is_picture = |path: &PathBuf| {
        let is_hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        !is_hidden && path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"))
    };
    Ok(paths.map_err(failed)?.into_iter().filter(is_picture).collect())
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let wrong: Vec<_> = self.pictures.iter().filter(|picture| !picture.verdict.passes()).collect();
        for Compared { name, verdict, .. } in wrong.iter().take(MOST_TOLD) {
            writeln!(f, "{name}: {verdict}")?;
        }
        if wrong.len() > MOST_TOLD {
            writeln!(f, "and {} more", wrong.len() - MOST_TOLD)?;
        }
        if let [only] = &self.pictures[..] {
            // A single picture that passes is told, too.
            return if wrong.is_empty() { writeln!(f, "{}: {}", only.name, only.verdict) } else { Ok(()) };
        }
        let visible = |verdict: &Verdict| match verdict {
            Verdict::WithinTolerance(distance) | Verdict::NoState { distance: Some(distance) } => distance.visible,
            _ => 0,
        };
        let nearest = self.pictures.iter().map(|picture| visible(&picture.verdict)).max().unwrap_or(0);
        match wrong.len() {
            0 => writeln!(
                f,
                "{} pictures, nothing moved; at most {nearest} pixels of one differ visibly",
                self.pictures.len()
            )?,
            count => writeln!(f, "{count} of {} pictures are not as expected", self.pictures.len())?,
        }
        if let Some(first) = self.first_moved() {
            writeln!(f, "the first whose state moved is {}", first.name)?;
        }
        if self.pictures.iter().any(|picture| picture.same_scene == Some(false)) {
            writeln!(f, "the scene files are not the same")?;
        }
        Ok(())
    }
}
