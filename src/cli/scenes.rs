//! Reads and checks the scenes on a command line.

use super::failure::{Failure, Status, complain, warn, with_causes};
use super::frames::{FrameRanges, Instants, Shard};
use super::options::{RunOptions, SceneOptions};
use crate::output::{Access, Folder, FramePictures, Manifest, OutputError, Whose, recorded};
use crate::output::{export, shell};
use crate::runner::Stored;
use crate::scene::{Limits, Scene, SceneError};
use std::collections::HashMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

impl SceneOptions {
    /// The limits on the size of scenes.
    pub(super) fn limits(&self) -> Limits {
        if self.allow_large { Limits::NONE } else { Limits::default() }
    }

    /// Reads one scene.
    pub(super) fn load(&self, path: &Path) -> Result<Scene, SceneError> {
        Scene::load_with(path, &self.set, &self.limits())
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

/// The status for mistakes in a scene, or for one that could not be read.
pub(super) fn status_of(error: &SceneError) -> Status {
    if matches!(error, SceneError::Unreadable { .. }) { Status::Files } else { Status::Usage }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::new(status_of(&error), &error)
    }
}

/// The more important of two statuses: a mistake of the user comes before an error of the system.
pub(super) fn worse(one: Option<Status>, other: Status) -> Status {
    if one == Some(Status::Usage) { Status::Usage } else { other }
}

/// One scene with the requested runs and frames, all checked; nothing is written yet.
#[derive(Debug)]
pub(super) struct Job {
    pub(super) scene: Scene,
    /// Indices into the scene's runs, in its order.
    pub(super) runs: Vec<usize>,
    /// Numbers of frames, rising.
    pub(super) frames: Vec<u64>,
    /// The frames of all shards together.
    pub(super) all: Vec<u64>,
    pub(super) folder: Folder,
    /// The graphics adapter that draws the scene, if pictures are made.
    pub(super) adapter: Option<String>,
    /// The states of the frames, if they are read from a file.
    pub(super) stored: Option<Stored>,
}

/// The differences between the commands that run scenes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wish<'a> {
    /// Whether drawn frames are kept; `None` if none are drawn.
    pub(super) keeps: Option<bool>,
    /// The shard of the frames, unless all are made.
    pub(super) shard: Option<Shard>,
    /// Whether states are read, so that no checkpoint is needed.
    pub(super) from_states: bool,
    /// The requested moments, if frames are chosen by `--at`.
    pub(super) at: Option<&'a Instants>,
}

impl RunOptions {
    /// The jobs for scenes, requested by the command with these `words`.
    pub(super) fn jobs(&self, scenes: Vec<Scene>, wish: Wish<'_>, words: &[OsString]) -> Result<Vec<Job>, Failure> {
        let several = scenes.len() > 1;
        let mut folders: HashMap<PathBuf, String> = HashMap::new();
        let mut jobs = Vec::new();
        for scene in scenes {
            let path = match &self.out {
                Some(out) if several => out.join(&scene.name),
                Some(out) => out.clone(),
                None => Path::new("output").join(&scene.name),
            };
            if let Some(first) = folders.insert(path.clone(), scene.title.clone()) {
                let (second, path) = (&scene.title, path.display());
                bail!("“{first}” and “{second}” would both be written to {path}; run them one at a time with -o");
            }
            jobs.push(self.job(scene, &path, wish, words)?);
        }
        Ok(jobs)
    }

    /// The job for one scene in a folder.
    fn job(&self, scene: Scene, path: &Path, wish: Wish<'_>, words: &[OsString]) -> Result<Job, Failure> {
        let Wish { keeps, shard, from_states, at } = wish;
        let runs = self.runs(&scene)?;
        let mut frames = self.frames(&scene, at)?;
        let all = frames.clone();
        if let Some(shard) = shard {
            frames = shard.select(&frames).map_err(|message| Failure::usage(format!("--shard: {message}")))?;
        }
        let names = runs.iter().flat_map(|&run| recorded(&scene.runs[run].name, &scene, run)).map(|(name, _)| name);
        let pictures = keeps.map(|are_kept| FramePictures { size: scene.view.size, are_kept });
        let files = export::files(&scene, &runs, &self.formats(), all.len());
        let files = files.map_err(|message| Failure::usage(format!("--write: in “{}” {message}", scene.title)))?;
        let (runs_of, states) = (names.collect(), self.states);
        let manifest = Manifest { runs: runs_of, frames: frames.clone(), states, files, pictures };
        let resume = self.resume && !from_states && shard.is_none();
        let access = Access { overwrite: self.overwrite, follows: self.out.is_none(), resume, shard: shard.is_some() };
        let folder = Folder::inspect(path, Whose::of(&scene), manifest, access).map_err(|error| match error {
            OutputError::Occupied { path, what } if shard.is_some() => Failure::usage(format!(
                "{} holds {what}, and a shard only adds frames; choose another folder with -o, or empty this one",
                path.display()
            )),
            OutputError::Occupied { .. } => Failure::usage(format!("{error}: {}", with_option(words, "--overwrite"))),
            error => error.into(),
        })?;
        Ok(Job { runs, frames, all, folder, scene, adapter: None, stored: None })
    }

    /// The numbers of a scene's runs with the names of `--only`, or of all of them.
    pub(super) fn runs(&self, scene: &Scene) -> Result<Vec<usize>, Failure> {
        let (only, names) = (&self.only, scene.runs.iter().map(|run| run.name.as_str()).collect::<Vec<_>>());
        if let Some(unknown) = only.iter().find(|wanted| !names.contains(&wanted.as_str())) {
            let (message, help) = scene.no_run(unknown);
            let help = help.map_or(String::new(), |help| format!("; {help}"));
            bail!("--only: {message}{help}");
        }
        let is_wanted = |name: &str| only.is_empty() || only.iter().any(|only| only == name);
        Ok((0..names.len()).filter(|&run| is_wanted(names[run])).collect())
    }

    /// The requested frames of a scene, in rising order.
    pub(super) fn frames(&self, scene: &Scene, at: Option<&Instants>) -> Result<Vec<u64>, Failure> {
        if let Some(at) = at {
            let mut frames: Vec<_> = nearest(at, scene)?.into_iter().map(|(_, frame)| frame).collect();
            frames.sort_unstable();
            frames.dedup();
            return Ok(frames);
        }
        let last = scene.last_frame();
        let ranges = self.frames.clone().unwrap_or_else(|| FrameRanges::all(last));
        ranges.select(last).map_err(|message| Failure::usage(format!("frames of “{}”: {message}", scene.title)))
    }
}

/// The nearest frame of a scene to each moment (s).
pub(super) fn nearest(at: &Instants, scene: &Scene) -> Result<Vec<(f64, u64)>, Failure> {
    let found = at.nearest(scene.last_frame(), scene.duration, scene.frames_per_second);
    found.map_err(|message| Failure::usage(format!("--at: in “{}” {message}", scene.title)))
}

/// The same command with another option, in a place where it is not taken for a value.
pub(super) fn with_option(words: &[OsString], option: &str) -> String {
    let mut words: Vec<_> = words.iter().map(|word| word.to_string_lossy().into_owned()).collect();
    if !words.iter().any(|word| word == option) {
        words.insert(words.len().min(2), option.to_owned());
    }
    shell::line(&words)
}
