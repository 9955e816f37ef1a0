//! From scene files as typed to scenes that can be run.

use super::failure::{Failure, Status, complain, warn, with_causes};
use super::frames::{FrameRanges, Shard};
use super::options::{RunOptions, SceneOptions};
use crate::output::{Folder, OutputError, Plan, Replace, STATES_FILE, StoredStates, Whose};
use crate::scene::{Limits, Scene, SceneError};
use crate::shell;
use std::collections::HashMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

impl SceneOptions {
    /// Reads one scene.
    pub(super) fn load(&self, path: &Path) -> Result<Scene, SceneError> {
        let limits = if self.allow_large { Limits::NONE } else { Limits::default() };
        Scene::load(path, &limits)
    }

    /// Reads all scenes. The mistakes in all of them are reported before this fails; warnings unless `quiet`.
    pub(super) fn load_all(&self, quiet: bool) -> Result<Vec<Scene>, Failure> {
        let mut scenes = Vec::new();
        let mut failed = None;
        for path in &self.scenes {
            match self.load(path) {
                Ok(scene) => {
                    if !quiet {
                        warn(path, &scene);
                    }
                    scenes.push(scene);
                }
                Err(error) => {
                    complain(&with_causes(&error));
                    failed = Some(worse(failed, status_of(&error)));
                }
            }
        }
        match failed {
            Some(status) => Err(Failure::silent(status)),
            None => Ok(scenes),
        }
    }
}

/// Mistakes in a scene, unless it could not be read.
pub(super) fn status_of(error: &SceneError) -> Status {
    if error.is_unreadable() { Status::Files } else { Status::Usage }
}

/// A mistake of the user's comes before one of the system's.
pub(super) fn worse(one: Option<Status>, other: Status) -> Status {
    if one == Some(Status::Usage) { Status::Usage } else { other }
}

/// One scene with what is wanted of it, all checked; nothing is written yet.
#[derive(Debug)]
pub(super) struct Job {
    pub(super) scene: Scene,
    /// Indices into the scene's runs, in its order.
    pub(super) runs: Vec<usize>,
    /// Numbers of frames, rising.
    pub(super) frames: Vec<u64>,
    pub(super) folder: Folder,
    /// Which share of the frames that is, if it is not all.
    pub(super) shard: Option<Shard>,
    /// The states of the frames, if they were simulated before.
    pub(super) stored: Option<StoredStates>,
}

impl RunOptions {
    /// What is to be done for each scene, with or without `pictures`, for all frames or a share of them, by the command of
    /// these `words`, which may read the states in a file.
    pub(super) fn jobs(
        &self,
        scenes: Vec<Scene>,
        pictures: bool,
        shard: Option<Shard>,
        states_read: Option<&Path>,
        words: &[OsString],
    ) -> Result<Vec<Job>, Failure> {
        let states_read = states_read.and_then(|file| file.canonicalize().ok());
        let several = scenes.len() > 1;
        let mut folders: HashMap<PathBuf, String> = HashMap::new();
        let mut jobs = Vec::new();
        for scene in scenes {
            let path = match &self.out {
                Some(out) if several => out.join(&scene.name),
                Some(out) => out.clone(),
                // Shards that are drawn at the same time need folders of their own.
                None => match shard {
                    Some(Shard { number, of }) => Path::new("output").join(format!("{}-{number}-of-{of}", scene.name)),
                    None => Path::new("output").join(&scene.name),
                },
            };
            if let Some(first) = folders.insert(path.clone(), scene.title.clone()) {
                let (second, path) = (&scene.title, path.display());
                let message =
                    format!("“{first}” and “{second}” would both be written to {path}; run them one at a time with -o");
                return Err(Failure::usage(message));
            }
            let runs = self.runs(&scene)?;
            let mut frames = self.frames(&scene)?;
            if let Some(shard) = shard {
                frames = shard.select(&frames).map_err(|message| Failure::usage(format!("--shard: {message}")))?;
            }
            let names = runs.iter().map(|&run| scene.runs[run].name.clone()).collect();
            let size = pictures.then_some(scene.view.size);
            // States that are read are not replaced by their own pictures.
            let is_read = states_read.is_some() && path.join(STATES_FILE).canonicalize().ok() == states_read;
            let plan = Plan { runs: names, frames: frames.clone(), states: self.states || is_read, size };
            let folder = Folder::inspect(&path, Whose::of(&scene), plan, self.replace());
            let folder = folder.map_err(|error| occupied(error, words))?;
            jobs.push(Job { runs, frames, folder, scene, shard, stored: None });
        }
        Ok(jobs)
    }

    /// A folder named after the scene follows its file. A folder named by the user keeps its contents, which may be
    /// wanted for comparison.
    fn replace(&self) -> Replace {
        match (self.overwrite, &self.out) {
            (true, _) => Replace::All,
            (false, None) => Replace::Own,
            (false, Some(_)) => Replace::Nothing,
        }
    }

    pub(super) fn runs(&self, scene: &Scene) -> Result<Vec<usize>, Failure> {
        runs_of(&self.only, scene)
    }

    pub(super) fn frames(&self, scene: &Scene) -> Result<Vec<u64>, Failure> {
        let last = scene.last_frame();
        let ranges = self.frames.clone().unwrap_or_else(|| FrameRanges::all(last));
        ranges.select(last).map_err(|message| Failure::usage(format!("frames of “{}”: {message}", scene.title)))
    }
}

/// The numbers of a scene's runs with the names of `--only`, or of all of them.
pub(super) fn runs_of(only: &[String], scene: &Scene) -> Result<Vec<usize>, Failure> {
    let names: Vec<_> = scene.runs.iter().map(|run| run.name.as_str()).collect();
    if let Some(unknown) = only.iter().find(|wanted| !names.contains(&wanted.as_str())) {
        let (message, help) = scene.no_run(unknown);
        let help = help.map_or(String::new(), |help| format!("; {help}"));
        return Err(Failure::usage(format!("--only: {message}{help}")));
    }
    let is_wanted = |name: &str| only.is_empty() || only.iter().any(|only| only == name);
    Ok((0..names.len()).filter(|&run| is_wanted(names[run])).collect())
}

/// Why a folder cannot be used, with the command of these `words` that replaces what is there.
pub(super) fn occupied(error: OutputError, words: &[OsString]) -> Failure {
    match error {
        OutputError::Occupied { .. } => Failure::usage(format!("{error}: {}", overwriting(words))),
        error => error.into(),
    }
}

/// The same command with `--overwrite`, placed where it cannot be the value of another option.
fn overwriting(words: &[OsString]) -> String {
    let words: Vec<_> = words.iter().map(|word| shell::word(&word.to_string_lossy())).collect();
    let (program, rest) = words.split_at(words.len().min(2));
    [program, &["--overwrite".to_owned()], rest].concat().join(" ")
}
