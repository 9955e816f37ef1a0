//! Stored states of a scene: recordings of its runs, from which frames are drawn without simulating, and its time series.

use super::{History, TableRow};
use crate::scene::{Archive, COURSE, Course, Flaw, Recorded, Scene};
use std::collections::{BTreeMap, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The stored states of some runs.
#[derive(Debug)]
pub(crate) struct Stored {
    /// The file.
    pub(crate) path: PathBuf,
    pub(super) recordings: Vec<Arc<Recorded>>,
    pub(super) history: Option<History>,
    /// The rows between frames of each run, by its number in the scene.
    pub(super) rows: BTreeMap<usize, VecDeque<TableRow>>,
}

impl Stored {
    /// Opens the states of some frames and runs of a scene, if the file has everything that their pictures need.
    ///
    /// # Errors
    /// If the file cannot be read, is damaged, or has other states; the message is the rest of a sentence about it.
    pub(crate) fn open(path: &Path, scene: &Scene, runs: &[usize], frames: &[u64]) -> Result<Self, String> {
        let read = || -> Result<_, Flaw> {
            let (course, rest) = Course::of_scene(path, &scene.digest, &scene.title)?;
            let recorded = |&run: &usize| {
                let name = &scene.runs[run].name;
                let archive = Archive::open(path, Some(name), name);
                let archive = archive.map_err(|flaw| flaw.with_help("choose among these with --only"));
                archive?.stored(&course).map(Arc::new)
            };
            let recordings = runs.iter().map(recorded).collect::<Result<_, _>>()?;
            course.check_frames(frames)?;
            let again = "simulate the scene again with --states";
            let damaged = |_| Flaw::new(COURSE, "was not written by this program").with_help(again);
            Ok((recordings, postcard::from_bytes(&rest).map_err(damaged)?))
        };
        let (recordings, (mut history, rows)): (_, (Option<History>, _)) = read().map_err(|flaw| flaw.to_string())?;
        if scene.time_series().is_some() && history.is_none() {
            let help = "simulate it again with --states and all frames, or with --frames up to the last one";
            return Err(format!("lacks the course of the scene to its end, which its pictures show; {help}"));
        }
        history.iter_mut().for_each(|history| history.series.retain(|series| runs.contains(&series.run)));
        Ok(Self { path: path.to_owned(), recordings, history, rows })
    }
}
