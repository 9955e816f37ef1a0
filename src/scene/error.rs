//! What can be wrong with a scene file, and how it is said.

use serde::Serialize;
use std::fmt;
use std::io;
use std::ops::Range;
use std::path::PathBuf;

/// Why a scene could not be had from a file.
///
/// Each variant names the file and what to do. Mistakes inside a file are collected and shown together; the other
/// variants end the reading.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// There is no such file.
    #[error("{}: there is no such file{}", path.display(), similar(nearest.as_deref()))]
    Missing {
        /// The path asked for.
        path: PathBuf,
        /// The most similar name of a file in the same folder.
        nearest: Option<PathBuf>,
    },
    /// Its name has nothing before the ending that a folder of results could be called.
    #[error("{}: a scene has the name of its file without the ending, and this leaves none; rename the file", path.display())]
    Nameless {
        /// The path asked for.
        path: PathBuf,
    },
    /// The path is a folder.
    #[error("{}: this is a folder, not a scene file{}", path.display(), inside(scenes))]
    Folder {
        /// The path asked for.
        path: PathBuf,
        /// Files in it that may be scenes.
        scenes: Vec<PathBuf>,
    },
    /// The system did not let it be read.
    #[error("{}: the file cannot be read", path.display())]
    Unreadable {
        /// The path asked for.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// It holds more text than a scene may.
    #[error("{}: the file has more than {limit} bytes, the most that a scene file may have", path.display())]
    TooLong {
        /// The path asked for.
        path: PathBuf,
        /// The most that is read (bytes).
        limit: u64,
    },
    /// It holds nothing, or only spaces and comments.
    #[error(
        "{file}: the file is empty; a scene needs at least [time], [body] and one [[run]], a figure [sheet] or [forces]"
    )]
    Empty {
        /// The file, as named by the caller.
        file: String,
    },
    /// It is not text.
    #[error("{file}: {what} (byte {offset}); a scene is a TOML file in UTF-8")]
    NotText {
        /// The file, as named by the caller.
        file: String,
        /// The first byte that no text has, counted from 0.
        offset: usize,
        /// What was found there, or what the file seems to be.
        what: String,
    },
    /// It is not TOML.
    #[error("{0}")]
    Syntax(Mistakes),
    /// It is TOML, but no scene.
    #[error("{0}")]
    Mistakes(Mistakes),
}

impl SceneError {
    /// Whether the system refused to read the file, so that nothing is known of what is in it.
    pub fn is_unreadable(&self) -> bool {
        matches!(self, Self::Unreadable { .. })
    }

    /// The mistakes found inside the file; none when it was not read so far.
    pub fn mistakes(&self) -> &[Mistake] {
        match self {
            Self::Syntax(mistakes) | Self::Mistakes(mistakes) => &mistakes.found,
            _ => &[],
        }
    }
}

fn similar(nearest: Option<&std::path::Path>) -> String {
    nearest.map_or(String::new(), |path| format!("; did you mean {}?", path.display()))
}

fn inside(scenes: &[PathBuf]) -> String {
    match scenes {
        [] => String::new(),
        [only] => format!("; it holds {}", only.display()),
        [first, .., last] => format!("; it holds {} scenes, {} to {}", scenes.len(), first.display(), last.display()),
    }
}

/// One mistake and its place. It prints as one line; see [`Mistakes`] for the picture with the source.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Mistake {
    /// Line, counted from 1.
    pub line: usize,
    /// Column in characters, counted from 1.
    pub column: usize,
    /// What was found and what was expected.
    pub message: String,
    /// What to do, if there is more to say than the message does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub help: Option<String>,
    /// The source line, or the part of it around the place.
    pub excerpt: String,
    /// Which characters of the excerpt are meant.
    #[serde(skip)]
    pub marked: Range<usize>,
}

/// All mistakes of one file in the order in which they stand there.
///
/// They print with the source line and a mark under the place:
///
/// ```text
/// drop.toml:12:33: unknown key `stifness` in `run[0].model`
///    12 | model = { kind = "shape-based", stifness = 1e4 }
///       |                                 ^^^^^^^^ did you mean `stiffness`?
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Mistakes {
    /// The file, as named by the caller.
    pub file: String,
    /// The mistakes, up to a thousand.
    pub found: Vec<Mistake>,
    /// How many there are in all.
    pub total: usize,
}

/// How many mistakes are printed: what fits on a screen or two. More follow from the same cause, as a rule.
const SHOWN: usize = 20;

impl fmt::Display for Mistakes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (number, mistake) in self.found.iter().take(SHOWN).enumerate() {
            if number > 0 {
                writeln!(f)?;
            }
            let Mistake { line, column, message, help, excerpt, marked } = mistake;
            writeln!(f, "{}:{line}:{column}: {message}", self.file)?;
            let gutter = line.to_string().len() + 2;
            writeln!(f, "{line:>gutter$} | {excerpt}")?;
            let (before, mark) = (" ".repeat(marked.start), "^".repeat(marked.len()));
            write!(f, "{:gutter$} | {before}{mark}", "")?;
            if let Some(help) = help {
                // Under the mark when it stands far right or the help is long.
                if marked.end + help.chars().count() > 90 {
                    write!(f, "\n{:gutter$} = {help}", "")?;
                } else {
                    write!(f, " {help}")?;
                }
            }
        }
        match self.total - self.found.len().min(SHOWN) {
            0 => Ok(()),
            more => write!(f, "\n{}: and {more} more", self.file),
        }
    }
}
