//! Ownership of output folders: frames of different scenes are never mixed, and files of other programs never removed.

use super::atomic::{remove, remove_leftovers};
use super::checkpoint::Checkpoint;
use super::error::kind_of;
use super::plan::{Plan, Whose};
use super::{DIAGNOSTICS_FILE, FolderLock, OutputError, STATES_FILE, SUMMARY_FILE, is_folder, read_file, read_tags};
use std::fs;
use std::ops::Deref;
use std::path::{Path, PathBuf};

/// The file name of frame `index`: `frame_00000.png`.
pub(crate) fn frame_file_name(index: u64) -> String {
    format!("frame_{index:05}.png")
}

/// The pattern of all frame names, for `run.json`.
pub(crate) const FRAME_FILES: &str = "frame_*.png";

/// The frame number from a file name.
fn frame_number(name: &str) -> Option<u64> {
    let index = name.strip_prefix("frame_")?.strip_suffix(".png")?.parse().ok()?;
    (frame_file_name(index) == name).then_some(index)
}

/// The numbers and paths of all frames in a folder, by their names, sorted.
pub(crate) fn frame_files(folder: &Path) -> Result<Vec<(u64, PathBuf)>, OutputError> {
    let mut frames = Vec::new();
    for entry in fs::read_dir(folder).map_err(OutputError::reading(folder))? {
        let entry = entry.map_err(OutputError::reading(folder))?;
        if let Some(index) = entry.file_name().to_str().and_then(frame_number) {
            frames.push((index, entry.path()));
        }
    }
    frames.sort_unstable();
    Ok(frames)
}

/// Which files in a folder may be replaced, in addition to those that are made again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Replace {
    /// None.
    Nothing,
    /// Tables of the same scene, and all results of earlier versions of its file.
    Own,
    /// All that have the names of output files.
    All,
}

/// A folder for the output of one scene, inspected but not yet changed.
#[derive(Debug)]
pub(crate) struct Folder {
    path: PathBuf,
    scene: Whose,
    plan: Plan,
    replace: Replace,
    /// Whether a checkpoint there is gone on from.
    resume: bool,
    /// What is replaced although the command does not make it again, in words.
    replaced: Option<String>,
}

impl Folder {
    /// Inspects a folder, which need not exist, before it is used for a scene.
    ///
    /// A folder with results of another scene, or with other files that have the names of output files, is refused
    /// unless `replace` permits their replacement. Something that has such a name but is not a file, such as a folder,
    /// is always refused. Results of the same scene are replaced one by one, and its other frames are kept, so that a
    /// scene can be drawn in parts. But the existing frames must have the size and runs of new ones, so that the folder
    /// has one sequence; and unless `replace` permits it, the tables must not have rows or states that the `plan` lacks.
    /// A checkpoint from which the command does not go on with `resume` counts as such a row. A folder to which another
    /// process writes is always refused.
    ///
    /// # Errors
    /// If the folder cannot be read, is refused or is not a folder.
    pub(crate) fn inspect(
        path: &Path,
        scene: Whose,
        plan: Plan,
        replace: Replace,
        resume: bool,
    ) -> Result<Self, OutputError> {
        let mut folder = Self { path: path.to_owned(), scene, plan, replace, resume, replaced: None };
        if is_folder(path)? {
            FolderLock::check(path)?;
            if resume {
                Checkpoint::read(path, &folder.scene, &folder.plan)?;
            }
            let found = folder.find()?;
            folder.replaced = found.earlier().or(found.lost);
        }
        Ok(folder)
    }

    /// The results in the folder, if they do not prevent its use.
    fn find(&self) -> Result<Found, OutputError> {
        let mut found = Found::in_folder(&self.path, &self.scene, &self.plan)?;
        if Checkpoint::is_in(&self.path) && self.resume {
            // One that fits the plan loses nothing, and another one is refused with the command that it is of.
            found.lost = None;
        } else if Checkpoint::is_in(&self.path) {
            let rows = found.lost.take().map_or(String::new(), |rows| format!("{rows}, and "));
            found.lost = Some(format!("{rows}the checkpoint of an interrupted command, from which --resume goes on"));
        }
        match found.describe(self.replace == Replace::Own) {
            Some(what) if self.replace != Replace::All => Err(OutputError::Occupied { path: self.path.clone(), what }),
            _ => Ok(found),
        }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// What is written there, and for which scene.
    pub(crate) fn contents(&self) -> (&Plan, &Whose) {
        (&self.plan, &self.scene)
    }

    /// What is replaced although the command does not make it again, in words: `31 frames made by an earlier version of
    /// sag.toml`.
    pub(crate) fn replaced(&self) -> Option<&str> {
        self.replaced.as_deref()
    }

    /// Creates the folder if necessary, locks it, and removes leftovers of killed processes and the results of another
    /// scene. Unless new states are written, earlier ones are removed, too, as they would not match the diagnostics. A
    /// checkpoint to go on from stays, and what belongs to it.
    ///
    /// # Errors
    /// If the folder cannot be created or written to, or has a checkpoint to resume that does not belong to the plan; and
    /// the errors of [`Self::inspect`], which is repeated because the folder may have changed before it was locked.
    pub(crate) fn prepare(self) -> Result<Claimed, OutputError> {
        fs::create_dir_all(&self.path).map_err(OutputError::writing(&self.path))?;
        let lock = FolderLock::alone_with_leftovers(&self.path)?;
        let read = || Checkpoint::read(&self.path, &self.scene, &self.plan);
        let checkpoint = if self.resume { read()? } else { None };
        let found = self.find()?;
        if checkpoint.is_none() {
            // First, so that no checkpoint is left without what belongs to it.
            Checkpoint::remove(&self.path)?;
            remove_leftovers(&self.path)?;
        }
        // The summary is removed last: until then it identifies the owner of the other files.
        let stale = [found.frames, found.earlier_frames, found.unlike, found.records, found.earlier_records].concat();
        for path in stale.iter().chain(found.states.iter().filter(|_| !self.plan.states)) {
            remove(path)?;
        }
        Ok(Claimed { folder: self, checkpoint, _lock: lock })
    }
}

/// A locked folder: no other process writes to it until this is dropped.
#[derive(Debug)]
pub(crate) struct Claimed {
    folder: Folder,
    checkpoint: Option<Checkpoint>,
    _lock: FolderLock,
}

impl Deref for Claimed {
    type Target = Folder;

    fn deref(&self) -> &Folder {
        &self.folder
    }
}

impl Claimed {
    /// Takes the checkpoint from which to go on, if there is one.
    pub(crate) fn take_checkpoint(&mut self) -> Option<Checkpoint> {
        self.checkpoint.take()
    }
}

/// Without a checkpoint, unfinished files are of no use.
impl Drop for Claimed {
    fn drop(&mut self) {
        if !Checkpoint::is_in(self.path()) {
            // The next command tries again.
            let _ = remove_leftovers(self.path());
        }
    }
}

/// Existing results in a folder.
#[derive(Debug, Default)]
struct Found {
    /// Frames of another scene.
    frames: Vec<PathBuf>,
    /// Frames of this scene that do not match new ones.
    unlike: Vec<PathBuf>,
    /// Size and runs of one of these, in words.
    unlike_words: String,
    /// Diagnostics, states and summary of another scene.
    records: Vec<PathBuf>,
    /// Frames that were made with an earlier version of this scene's file.
    earlier_frames: Vec<PathBuf>,
    /// Diagnostics, states and summary made with it.
    earlier_records: Vec<PathBuf>,
    /// The name of that file.
    file: String,
    /// States of this scene.
    states: Option<PathBuf>,
    /// What the tables of this scene have that would not be made again, in words.
    lost: Option<String>,
    /// That other scene, if its summary exists.
    other: Option<Owner>,
    /// Title of this scene.
    title: String,
    /// Names of output files that other programs' files have.
    foreign: Vec<String>,
}

impl Found {
    fn in_folder(path: &Path, scene: &Whose, plan: &Plan) -> Result<Self, OutputError> {
        // Scenes with models made in code have no digest, so their own results are not recognised.
        let is_own = |digest: &str| !digest.is_empty() && digest == scene.digest;
        let name = scene.file.as_ref().and_then(|file| Some(file.file_name()?.to_string_lossy().into_owned()));
        let mut found = Self { title: scene.title.clone(), file: name.unwrap_or_default(), ..Self::default() };
        let owner = Owner::read(&path.join(SUMMARY_FILE))?;
        // A scene file that was moved together with its output is still the same.
        let is_same_file = |owner: &Owner| {
            let moved = owner.relative_file.as_ref().and_then(|file| path.join(file).canonicalize().ok());
            let files = [owner.file.as_ref().map(PathBuf::from), moved];
            scene.file.is_some() && files.contains(&scene.file)
        };
        let earlier = owner.as_ref().filter(|owner| !is_own(&owner.digest) && is_same_file(owner));
        for entry in fs::read_dir(path).map_err(OutputError::reading(path))? {
            let entry = entry.map_err(OutputError::reading(path))?;
            let name = entry.file_name();
            let Some(name) = name.to_str() else { continue };
            let is_record = [SUMMARY_FILE, DIAGNOSTICS_FILE, STATES_FILE].contains(&name);
            if !is_record && frame_number(name).is_none() {
                continue;
            }
            let path = entry.path();
            match fs::metadata(&path) {
                Ok(kind) if !kind.is_file() => return Err(OutputError::NoFile { path, what: kind_of(&kind) }),
                Ok(_) => {}
                // A dangling link can be replaced like a file.
                Err(_) if path.is_symlink() => {
                    found.foreign.push(name.to_owned());
                    continue;
                }
                Err(error) => return Err(OutputError::reading(&path)(error)),
            }
            if !is_record {
                match read_tags(&entry.path())?.filter(|(_, tags)| tags.frame().is_some()) {
                    Some((size, tags)) if tags.scenes.iter().any(|scene| is_own(scene)) => {
                        let runs: Vec<String> = tags.states.into_iter().map(|(_, run)| run).collect();
                        if plan.size.is_some_and(|own| own != size || plan.runs != runs) {
                            found.unlike.push(entry.path());
                            let [width, height] = size;
                            let runs: Vec<_> = runs.iter().map(|run| format!("“{run}”")).collect();
                            found.unlike_words = format!("{width}×{height} pixels with {}", runs.join(", "));
                        }
                    }
                    Some((_, tags)) if earlier.is_some_and(|earlier| tags.scenes.contains(&earlier.digest)) => {
                        found.earlier_frames.push(entry.path());
                    }
                    Some(_) => found.frames.push(entry.path()),
                    None => found.foreign.push(name.to_owned()),
                }
            } else {
                match &owner {
                    Some(owner) if is_own(&owner.digest) => {
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
        if owner.as_ref().is_some_and(|owner| is_own(&owner.digest)) {
            found.lost = plan.lacks(&path.join(DIAGNOSTICS_FILE), found.states.as_ref());
        }
        found.foreign.sort_unstable();
        // The summary last, see `prepare`.
        found.records.sort_by_key(|path| path.ends_with(SUMMARY_FILE));
        found.earlier_records.sort_by_key(|path| path.ends_with(SUMMARY_FILE));
        found.other = owner.filter(|owner| !is_own(&owner.digest));
        Ok(found)
    }

    /// The results of an earlier version of the scene's file, in words.
    fn earlier(&self) -> Option<String> {
        let what = match (self.earlier_frames.len(), self.earlier_records.is_empty()) {
            (0, true) => return None,
            (0, false) => "results".to_owned(),
            (1, _) => "a frame".to_owned(),
            (count, _) => format!("{count} frames"),
        };
        Some(format!("{what} made by an earlier version of {}", self.file))
    }

    /// What prevents the use of the folder, in words; `None` if nothing does, or only what the same scene or an earlier
    /// version of it made and may be replaced.
    fn describe(&self, may_replace_own: bool) -> Option<String> {
        let another = match &self.other {
            None => "another scene".to_owned(),
            Some(Owner { title, file: Some(file), .. }) => format!("another scene (“{title}”, {file})"),
            // Summaries of earlier versions of this program have no file name.
            Some(Owner { title, .. }) if *title == self.title => {
                format!("another scene, or an earlier version of this one (“{title}”)")
            }
            Some(Owner { title, .. }) => format!("another scene (“{title}”)"),
        };
        let unlike = match self.unlike.len() {
            0 => None,
            1 => Some(format!("a frame of this scene of {}", self.unlike_words)),
            count => Some(format!("{count} frames of this scene of {}", self.unlike_words)),
        };
        match (self.frames.len(), self.records.is_empty(), self.foreign.as_slice()) {
            (0, true, []) => {
                let own = |what: Option<String>| what.filter(|_| !may_replace_own);
                own(self.earlier()).or(unlike).or_else(|| own(self.lost.clone()))
            }
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
    relative_file: Option<String>,
}

impl Owner {
    /// Reads it from `run.json`; `None` if there is none or another program wrote it.
    fn read(path: &Path) -> Result<Option<Self>, OutputError> {
        let Some(bytes) = read_file(path)? else { return Ok(None) };
        let Ok(summary) = serde_json::from_slice::<serde_json::Value>(&bytes) else { return Ok(None) };
        let text = |key: &str| summary["scene"][key].as_str().map(str::to_owned);
        let ours = summary.get("localshape").is_some();
        let title = text("title").unwrap_or_default();
        let (file, relative_file) = (text("file"), text("relative_file"));
        Ok(text("digest").filter(|_| ours).map(|digest| Self { digest, title, file, relative_file }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Summary;
    use crate::scene::{BodyBuilder, Limits, RunBuilder, Scene};
    use crate::sim::model::shape_based::ShapeBased;
    use std::sync::Arc;

    /// They have no digest by which they could be compared.
    #[test]
    fn scenes_with_models_of_their_own_are_never_taken_for_each_other() {
        let scene = |title: &str, side: f64| {
            let (rotation, damping_of) = Default::default();
            let model = ShapeBased { stiffness: 1e4, damping: 0.0, passes: 2, rotation, damping_of };
            let run = RunBuilder::own(Arc::new(model));
            let scene = Scene::builder(title, BodyBuilder::polygon(3, side)).run("run", run);
            scene.build(&Limits::default()).unwrap()
        };
        let (one, other) = (scene("one", 1.0), scene("other", 2.0));
        let place = tempfile::tempdir().unwrap();
        let plan = Plan { runs: Vec::new(), frames: Vec::new(), states: false, size: None };
        let inspect = |scene, replace| Folder::inspect(place.path(), Whose::of(scene), plan.clone(), replace, false);
        inspect(&one, Replace::Nothing).unwrap().prepare().unwrap();
        Summary::new(&one, &[0], 0, &[]).write(place.path()).unwrap();
        for replace in [Replace::Nothing, Replace::Own] {
            let message = inspect(&other, replace).unwrap_err().to_string();
            assert!(message.contains("the results of another scene (“one”)"), "{message}");
        }
        inspect(&other, Replace::All).unwrap();
    }

    #[test]
    fn frame_names() {
        assert_eq!(frame_file_name(7), "frame_00007.png");
        assert_eq!(frame_file_name(123_456), "frame_123456.png");
        for name in ["frame_00000.png", "frame_99999.png", "frame_100000.png"] {
            assert!(frame_number(name).is_some(), "{name}");
        }
        for name in ["frame_0.png", "frame_000000.png", "frame_.png", "frame_+0001.png", "frame_00000.jpg", "a.png"] {
            assert_eq!(frame_number(name), None, "{name}");
        }
    }
}
