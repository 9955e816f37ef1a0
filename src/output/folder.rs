//! Whose folder it is: frames of different scenes never mix, and files of others are never removed.

use super::atomic::remove;
use super::error::kind_of;
use super::{DIAGNOSTICS_FILE, FolderLock, OutputError, STATES_FILE, SUMMARY_FILE, is_folder, read_file, read_frame};
use crate::scene::Scene;
use std::fs;
use std::path::{Path, PathBuf};

/// The file name of frame `index`: `frame_00000.png`.
pub fn frame_file_name(index: u64) -> String {
    format!("frame_{index:05}.png")
}

/// The names of all frames as a pattern, for `run.json`.
pub const FRAME_FILES: &str = "frame_*.png";

/// Whether a file has the name of a frame.
fn names_frame(name: &str) -> bool {
    let digits = name.strip_prefix("frame_").and_then(|rest| rest.strip_suffix(".png"));
    digits.is_some_and(|digits| digits.parse().is_ok_and(|index| frame_file_name(index) == name))
}

/// The numbers and paths of all frames in a folder by their names, rising.
///
/// # Errors
/// If the folder cannot be read.
pub fn frame_files(folder: &Path) -> Result<Vec<(u64, PathBuf)>, OutputError> {
    let mut frames = Vec::new();
    for entry in fs::read_dir(folder).map_err(OutputError::reading(folder))? {
        let entry = entry.map_err(OutputError::reading(folder))?;
        let name = entry.file_name();
        if let Some(index) = name
            .to_str()
            .filter(|name| names_frame(name))
            .and_then(|name| name.strip_prefix("frame_")?.strip_suffix(".png")?.parse().ok())
        {
            frames.push((index, entry.path()));
        }
    }
    frames.sort_unstable();
    Ok(frames)
}

/// What frames must have in common to be one sequence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Look {
    /// Width and height (px).
    pub size: [u32; 2],
    /// Names of the runs drawn, in the scene's order.
    pub runs: Vec<String>,
}

/// A folder for the output of one scene, looked at but not yet touched.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    digest: String,
    look: Option<Look>,
    overwrite: bool,
}

impl Folder {
    /// Looks at what is in a folder, which need not exist, before it is used for `scene`.
    ///
    /// A folder with files of another scene, or with files of others under the names of ours, is refused unless
    /// `overwrite`. Files of the same scene are fine: they are replaced one by one, and its other frames stay, so that
    /// a scene can be drawn in parts. But if frames are to be drawn, those that are there must have the same `look`,
    /// or the folder would hold no sequence. A folder that another program writes in is refused in any case.
    ///
    /// # Errors
    /// If the folder cannot be read, is refused or is none.
    pub fn inspect(path: &Path, scene: &Scene, look: Option<Look>, overwrite: bool) -> Result<Self, OutputError> {
        let folder = Self { path: path.to_owned(), digest: scene.digest.clone(), look, overwrite };
        if is_folder(path)? {
            FolderLock::look(path)?;
            folder.find()?;
        }
        Ok(folder)
    }

    /// What is in the folder, unless it is in the way.
    fn find(&self) -> Result<Found, OutputError> {
        let found = Found::in_folder(&self.path, &self.digest, self.look.as_ref())?;
        match found.describe() {
            Some(what) if !self.overwrite => Err(OutputError::Occupied { path: self.path.clone(), what }),
            _ => Ok(found),
        }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Makes the folder if there is none, locks it, and removes leftovers of killed programs and the files of another
    /// scene. Unless `states` are written anew, earlier ones go, too: they would not be those of the diagnostics
    /// beside them.
    ///
    /// # Errors
    /// If the folder cannot be made or written to; or as [`Self::inspect`], for only now nobody else can change what is
    /// there.
    pub fn prepare(self, states: bool) -> Result<Claimed, OutputError> {
        fs::create_dir_all(&self.path).map_err(OutputError::writing(&self.path))?;
        let lock = FolderLock::alone(&self.path)?;
        let Found { frames, unlike, records, states: earlier, .. } = self.find()?;
        for path in [frames, unlike, records].iter().flatten().chain(earlier.iter().filter(|_| !states)) {
            remove(path)?;
        }
        Ok(Claimed { path: self.path, _lock: lock })
    }
}

/// A folder in which nobody else writes until this is dropped.
#[derive(Debug)]
pub struct Claimed {
    path: PathBuf,
    _lock: FolderLock,
}

impl Claimed {
    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Look {
    fn describe(&self) -> String {
        let [width, height] = self.size;
        let runs: Vec<_> = self.runs.iter().map(|run| format!("“{run}”")).collect();
        format!("{width}×{height} pixels with {}", runs.join(", "))
    }
}

/// What is in the way in a folder.
#[derive(Debug, Default)]
struct Found {
    /// Frames of another scene.
    frames: Vec<PathBuf>,
    /// Frames of this scene that cannot stand beside new ones.
    unlike: Vec<PathBuf>,
    /// What one of these is, in words.
    unlike_look: String,
    /// Diagnostics, states and summary of another scene.
    records: Vec<PathBuf>,
    /// States of this scene.
    states: Option<PathBuf>,
    /// Title of that scene, if its summary is there.
    title: Option<String>,
    /// Names of ours that others have; and what has them, if it is no file.
    foreign: Vec<(String, Option<&'static str>)>,
}

impl Found {
    fn in_folder(path: &Path, digest: &str, look: Option<&Look>) -> Result<Self, OutputError> {
        let mut found = Self::default();
        let owner = Owner::read(&path.join(SUMMARY_FILE))?;
        for entry in fs::read_dir(path).map_err(OutputError::reading(path))? {
            let entry = entry.map_err(OutputError::reading(path))?;
            let name = entry.file_name();
            let Some(name) = name.to_str() else { continue };
            let is_record = [SUMMARY_FILE, DIAGNOSTICS_FILE, STATES_FILE].contains(&name);
            if !is_record && !names_frame(name) {
                continue;
            }
            let kind = fs::metadata(entry.path()).map_err(OutputError::reading(&entry.path()))?;
            if !kind.is_file() {
                found.foreign.push((name.to_owned(), Some(kind_of(&kind))));
            } else if !is_record {
                match read_frame(&entry.path())? {
                    Some((size, tags)) if tags.scene == digest => {
                        let runs = tags.states.into_iter().map(|(_, run)| run).collect();
                        let own = Look { size, runs };
                        if look.is_some_and(|look| *look != own) {
                            found.unlike.push(entry.path());
                            found.unlike_look = own.describe();
                        }
                    }
                    Some(_) => found.frames.push(entry.path()),
                    None => found.foreign.push((name.to_owned(), None)),
                }
            } else {
                match &owner {
                    Some(owner) if owner.digest == digest => {
                        if name == STATES_FILE {
                            found.states = Some(entry.path());
                        }
                    }
                    Some(_) => found.records.push(entry.path()),
                    None => found.foreign.push((name.to_owned(), None)),
                }
            }
        }
        found.title = owner.filter(|owner| owner.digest != digest).map(|owner| owner.title);
        found.foreign.sort_unstable();
        Ok(found)
    }

    /// What is in the way, in words; `None` if nothing is.
    fn describe(&self) -> Option<String> {
        let title = self.title.as_ref().map(|title| format!(" (“{title}”)")).unwrap_or_default();
        let unlike = match self.unlike.len() {
            0 => None,
            1 => Some(format!("a frame of this scene of {}", self.unlike_look)),
            count => Some(format!("{count} frames of this scene of {}", self.unlike_look)),
        };
        match (self.frames.len(), self.records.is_empty(), self.foreign.as_slice()) {
            (0, true, []) => unlike,
            (0, true, [(name, None)]) => Some(format!("{name}, which was not written by localshape")),
            (0, true, [(name, Some(kind))]) => Some(format!("{name}, which is {kind}")),
            (0, true, [(name, _), others @ ..]) => {
                Some(format!("{name} and {} more, which were not written by localshape", others.len()))
            }
            (0, false, _) => Some(format!("the results of another scene{title}")),
            (1, ..) => Some(format!("a frame of another scene{title}")),
            (count, ..) => Some(format!("{count} frames of another scene{title}")),
        }
    }
}

/// The scene that a summary belongs to.
struct Owner {
    digest: String,
    title: String,
}

impl Owner {
    /// Reads it from `run.json`; `None` if there is none or it is not one of ours.
    fn read(path: &Path) -> Result<Option<Self>, OutputError> {
        let Some(bytes) = read_file(path)? else { return Ok(None) };
        let Ok(summary) = serde_json::from_slice::<serde_json::Value>(&bytes) else { return Ok(None) };
        let text = |key: &str| summary["scene"][key].as_str().map(str::to_owned);
        let ours = summary.get("localshape").is_some();
        Ok(text("digest").filter(|_| ours).map(|digest| Self { digest, title: text("title").unwrap_or_default() }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_names() {
        assert_eq!(frame_file_name(7), "frame_00007.png");
        assert_eq!(frame_file_name(123_456), "frame_123456.png");
        for name in ["frame_00000.png", "frame_99999.png", "frame_100000.png"] {
            assert!(names_frame(name), "{name}");
        }
        for name in ["frame_0.png", "frame_000000.png", "frame_.png", "frame_+0001.png", "frame_00000.jpg", "a.png"] {
            assert!(!names_frame(name), "{name}");
        }
    }
}
