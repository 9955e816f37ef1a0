//! What can be wrong with a scene file, and how it is said.

use crate::reading::{Mistake, Mistakes};
use std::io;
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
        /// A file of this name in a folder beside, or the one of the most similar name in the same folder.
        nearest: Option<PathBuf>,
    },
    /// Its name has nothing before the ending that a folder of results could be called.
    #[error("{}: the name of the file without its extension is empty; rename the file", path.display())]
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
    pub(crate) fn is_unreadable(&self) -> bool {
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
        [only] => format!("; it contains {}", only.display()),
        [first, .., last] => {
            format!("; it contains {} scenes, {} to {}", scenes.len(), first.display(), last.display())
        }
    }
}
