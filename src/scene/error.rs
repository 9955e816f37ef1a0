//! The errors of reading a scene file.

use crate::reading::beside::backslash;
use crate::reading::{Mistake, Mistakes};
use std::io;
use std::path::{Path, PathBuf};

/// A reason why a file gives no scene.
///
/// Each variant names the file and a remedy. Mistakes inside a file are collected and shown together; every other
/// variant ends the reading.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file does not exist.
    #[error("{}: there is no such file{}", path.display(), instead(path, nearest.as_deref()))]
    Missing {
        /// The path.
        path: PathBuf,
        /// A file of this name in a folder beside, or the most similar name in the same folder.
        nearest: Option<PathBuf>,
    },
    /// The file's name is only an extension, so that no folder of results can have it.
    #[error("{}: the name of the file without its extension is empty; rename the file", path.display())]
    Nameless {
        /// The path.
        path: PathBuf,
    },
    /// The path is a folder.
    #[error("{}: this is a folder, not a scene file{}", path.display(), inside(scenes))]
    Folder {
        /// The path.
        path: PathBuf,
        /// Files in the folder that may be scenes.
        scenes: Vec<PathBuf>,
    },
    /// The file is a mesh.
    #[error(
        "{}: this is a mesh, not a scene; see what it contains with `localshape check`, and name it as `mesh` in [body] of a scene",
        path.display()
    )]
    Mesh {
        /// The path.
        path: PathBuf,
    },
    /// The system refused to read the file.
    #[error("{}: the file cannot be read", path.display())]
    Unreadable {
        /// The path.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The file is too long for a scene.
    #[error("{}: the file has more than {limit} bytes, the most that a scene file may have", path.display())]
    TooLong {
        /// The path.
        path: PathBuf,
        /// The longest length (bytes).
        limit: u64,
    },
    /// The file is empty, or has only spaces and comments.
    #[error(
        "{file}: the file is empty; a scene needs at least [time], [body] and one [[run]], a figure [sheet] or [forces]"
    )]
    Empty {
        /// The file, as named by the caller.
        file: String,
    },
    /// The file is not UTF-8 text.
    #[error("{file}: {what} (byte {offset}); a scene is a TOML file in UTF-8")]
    NotText {
        /// The file, as named by the caller.
        file: String,
        /// The first byte that is not text, counted from 0.
        offset: usize,
        /// The byte's value, or the probable kind of the file.
        what: String,
    },
    /// The text is not TOML.
    #[error("{0}")]
    Syntax(Mistakes),
    /// The text is TOML, but not a scene.
    #[error("{0}")]
    Mistakes(Mistakes),
}

impl SceneError {
    /// The mistakes inside the file; empty for other errors.
    pub fn mistakes(&self) -> &[Mistake] {
        match self {
            Self::Syntax(mistakes) | Self::Mistakes(mistakes) => &mistakes.found,
            _ => &[],
        }
    }
}

fn instead(path: &Path, nearest: Option<&Path>) -> String {
    let similar = nearest.map(|path| format!("did you mean {}?", path.display()));
    backslash(path).or(similar).map_or(String::new(), |help| format!("; {help}"))
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
