//! Whose folder it is: frames of different scenes never mix, and files of others are never removed.

use super::atomic::{remove, remove_leftovers};
use super::{DIAGNOSTICS_FILE, OutputError, STATES_FILE, SUMMARY_FILE, read_frame};
use crate::scene::Scene;
use std::fs;
use std::io;
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

/// What frames must have in common to be one sequence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Look {
    /// Width and height (px).
    pub size: [u32; 2],
    /// Names of the runs drawn, in the scene's order.
    pub runs: Vec<String>,
}

/// What may be replaced in a folder besides the files of the same scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Replace {
    /// Nothing.
    Nothing,
    /// What earlier versions of the same scene file made.
    Earlier,
    /// All that has the names of our files.
    All,
}

/// A folder for the output of one scene, looked at but not yet touched.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    /// Files of ours that belong to another scene or another sequence.
    stale: Vec<PathBuf>,
    /// What an earlier version of the scene file made of these, in words.
    earlier: Option<String>,
    /// States of this scene.
    states: Option<PathBuf>,
}

impl Folder {
    /// Looks at what is in a folder, which need not exist, before it is used for `scene`.
    ///
    /// A folder with files of another scene, or with files of others under the names of ours, is refused, unless these
    /// are what may be replaced. Files of the same scene are fine: they are replaced one by one, and its other frames stay, so that
    /// a scene can be drawn in parts. But if frames are to be drawn, those that are there must have the same `look`,
    /// or the folder would hold no sequence.
    ///
    /// # Errors
    /// If the folder cannot be read or is refused.
    pub fn inspect(path: &Path, scene: &Scene, look: Option<&Look>, replace: Replace) -> Result<Self, OutputError> {
        let found = Found::in_folder(path, scene, look)?;
        match found.describe(replace == Replace::Earlier) {
            Some(what) if replace != Replace::All => Err(OutputError::Occupied { path: path.to_owned(), what }),
            _ => Ok(Self {
                path: path.to_owned(),
                earlier: found.earlier(),
                // The summary goes last: until then it says whose all the others are.
                stale: [found.frames, found.earlier_frames, found.unlike, found.records, found.earlier_records]
                    .concat(),
                states: found.states,
            }),
        }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What is replaced of an earlier version of the scene file, in words: `31 frames made by an earlier version of
    /// sag.toml`.
    pub fn earlier(&self) -> Option<&str> {
        self.earlier.as_deref()
    }

    /// Makes the folder if there is none, and removes leftovers of killed programs and the files of another scene.
    /// Unless `states` are written anew, earlier ones go, too: they would not be those of the diagnostics beside them.
    ///
    /// # Errors
    /// If the folder cannot be made or written to.
    pub fn prepare(self, states: bool) -> Result<PathBuf, OutputError> {
        fs::create_dir_all(&self.path).map_err(OutputError::writing(&self.path))?;
        remove_leftovers(&self.path)?;
        for path in self.stale.iter().chain(self.states.iter().filter(|_| !states)) {
            remove(path)?;
        }
        Ok(self.path)
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
    /// Frames that an earlier version of this scene's file made.
    earlier_frames: Vec<PathBuf>,
    /// Its diagnostics, states and summary.
    earlier_records: Vec<PathBuf>,
    /// The name of that file.
    file: String,
    /// States of this scene.
    states: Option<PathBuf>,
    /// That other scene, if its summary is there.
    other: Option<Owner>,
    /// Title of this scene.
    title: String,
    /// Files of others under the names of ours.
    foreign: Vec<String>,
}

impl Found {
    fn in_folder(path: &Path, scene: &Scene, look: Option<&Look>) -> Result<Self, OutputError> {
        let digest = scene.digest.as_str();
        let name = scene.file.as_ref().and_then(|file| Some(file.file_name()?.to_string_lossy().into_owned()));
        let mut found = Self { title: scene.title.clone(), file: name.unwrap_or_default(), ..Self::default() };
        let entries = match fs::read_dir(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(found),
            entries => entries.map_err(OutputError::reading(path))?,
        };
        let owner = Owner::read(&path.join(SUMMARY_FILE))?;
        let is_same_file =
            |owner: &Owner| owner.file.is_some() && owner.file.as_deref().map(Path::new) == scene.file.as_deref();
        let earlier = owner.as_ref().filter(|owner| owner.digest != digest && is_same_file(owner));
        for entry in entries {
            let entry = entry.map_err(OutputError::reading(path))?;
            let name = entry.file_name();
            let Some(name) = name.to_str() else { continue };
            if names_frame(name) {
                match read_frame(&entry.path())? {
                    Some((size, tags)) if tags.scene == digest => {
                        let runs = tags.states.into_iter().map(|(_, run)| run).collect();
                        let own = Look { size, runs };
                        if look.is_some_and(|look| *look != own) {
                            found.unlike.push(entry.path());
                            found.unlike_look = own.describe();
                        }
                    }
                    Some((_, tags)) if earlier.is_some_and(|earlier| earlier.digest == tags.scene) => {
                        found.earlier_frames.push(entry.path());
                    }
                    Some(_) => found.frames.push(entry.path()),
                    None => found.foreign.push(name.to_owned()),
                }
            } else if [SUMMARY_FILE, DIAGNOSTICS_FILE, STATES_FILE].contains(&name) {
                match &owner {
                    Some(owner) if owner.digest == digest => {
                        if name == STATES_FILE {
                            found.states = Some(entry.path());
                        }
                    }
                    Some(_) if earlier.is_some() => found.earlier_records.push(entry.path()),
                    Some(_) => found.records.push(entry.path()),
                    None => found.foreign.push(name.to_owned()),
                }
            }
        }
        found.foreign.sort_unstable();
        // The summary last, see `inspect`.
        found.records.sort_by_key(|path| path.ends_with(SUMMARY_FILE));
        found.earlier_records.sort_by_key(|path| path.ends_with(SUMMARY_FILE));
        found.other = owner.filter(|owner| owner.digest != digest);
        Ok(found)
    }

    /// What an earlier version of the scene's file made, in words.
    fn earlier(&self) -> Option<String> {
        let what = match (self.earlier_frames.len(), self.earlier_records.is_empty()) {
            (0, true) => return None,
            (0, false) => "results".to_owned(),
            (1, _) => "a frame".to_owned(),
            (count, _) => format!("{count} frames"),
        };
        Some(format!("{what} made by an earlier version of {}", self.file))
    }

    /// What is in the way, in words; `None` if nothing is, or only what an earlier version made and that may go.
    fn describe(&self, may_replace_earlier: bool) -> Option<String> {
        let another = match &self.other {
            None => "another scene".to_owned(),
            Some(Owner { title, file: Some(file), .. }) => format!("another scene (“{title}”, {file})"),
            // Summaries of earlier versions of this program name no file.
            Some(Owner { title, .. }) if *title == self.title => {
                format!("another scene, or an earlier version of this one (“{title}”)")
            }
            Some(Owner { title, .. }) => format!("another scene (“{title}”)"),
        };
        let unlike = match self.unlike.len() {
            0 => None,
            1 => Some(format!("a frame of this scene of {}", self.unlike_look)),
            count => Some(format!("{count} frames of this scene of {}", self.unlike_look)),
        };
        match (self.frames.len(), self.records.is_empty(), self.foreign.as_slice()) {
            (0, true, []) => self.earlier().filter(|_| !may_replace_earlier).or(unlike),
            (0, true, [name]) => Some(format!("{name}, which was not written by localshape")),
            (0, true, [name, others @ ..]) => {
                Some(format!("{name} and {} more, which were not written by localshape", others.len()))
            }
            (0, false, _) => Some(format!("the results of {another}")),
            (1, ..) => Some(format!("a frame of {another}")),
            (count, ..) => Some(format!("{count} frames of {another}")),
        }
    }
}

/// The scene that a summary belongs to.
#[derive(Debug)]
struct Owner {
    digest: String,
    title: String,
    file: Option<String>,
}

impl Owner {
    /// Reads it from `run.json`; `None` if there is none or it is not one of ours.
    fn read(path: &Path) -> Result<Option<Self>, OutputError> {
        let bytes = match fs::read(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            bytes => bytes.map_err(OutputError::reading(path))?,
        };
        let Ok(summary) = serde_json::from_slice::<serde_json::Value>(&bytes) else { return Ok(None) };
        let text = |key: &str| summary["scene"][key].as_str().map(str::to_owned);
        let ours = summary.get("localshape").is_some();
        let title = text("title").unwrap_or_default();
        Ok(text("digest").filter(|_| ours).map(|digest| Self { digest, title, file: text("file") }))
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
