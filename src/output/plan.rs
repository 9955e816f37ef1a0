//! What a command writes, and of which scene.

use super::STATES_FILE;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Identifies the scene to which results belong.
#[derive(Clone, Debug)]
pub(crate) struct Whose {
    /// Digest of its meaning.
    pub digest: String,
    pub title: String,
    /// Its file, as a full path.
    pub file: Option<PathBuf>,
}

impl Whose {
    pub(crate) fn of(scene: &Scene) -> Self {
        Self { digest: scene.digest.clone(), title: scene.title.clone(), file: scene.file.clone() }
    }
}

/// What a command writes into the folder of a scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct Plan {
    /// Names of the runs, in the scene's order.
    pub runs: Vec<String>,
    /// Numbers of the frames, rising.
    pub frames: Vec<u64>,
    /// Whether there are states: they are written, or those in the folder are read.
    pub states: bool,
    /// Width and height of the pictures (px), if frames are drawn. All frames in a folder have the same size and runs.
    pub size: Option<[u32; 2]>,
}

impl Plan {
    /// What the diagnostics and states of the same scene at these paths have that the plan does not make again, in words.
    pub(super) fn lacks(&self, diagnostics: &Path, states: Option<&PathBuf>) -> Option<String> {
        // A table that cannot be read has nothing to lose.
        let rows: Vec<_> = rows_of(diagnostics).collect();
        let lost: BTreeSet<u64> = rows
            .iter()
            .filter(|(run, frame)| !self.runs.contains(run) || self.frames.binary_search(frame).is_err())
            .map(|&(_, frame)| frame)
            .collect();
        let lost_runs: BTreeSet<&str> =
            rows.iter().map(|(run, _)| run.as_str()).filter(|run| !self.runs.iter().any(|own| own == run)).collect();
        let of_runs = lost_runs.iter().map(|run| format!(" of “{run}”")).collect::<Vec<_>>().join(" and");
        let rows = match lost.len() {
            0 => None,
            1 => Some(format!("diagnostics of one frame{of_runs}")),
            count => Some(format!("diagnostics of {count} frames{of_runs}")),
        };
        let states = states.filter(|_| !self.states).map(|_| format!("{STATES_FILE} (written with --states)"));
        let lost: Vec<_> = rows.into_iter().chain(states).collect();
        (!lost.is_empty()).then(|| format!("{} of this scene, which this command does not make", lost.join(" and ")))
    }
}

/// Runs and frames of the diagnostics at a path.
fn rows_of(diagnostics: &Path) -> impl Iterator<Item = (String, u64)> + use<> {
    let rows = csv::Reader::from_path(diagnostics).into_iter().flat_map(csv::Reader::into_deserialize);
    rows.filter_map(Result::ok).map(|Row { run, frame }| (run, frame))
}

/// The columns that identify a row of the diagnostics.
#[derive(Deserialize)]
struct Row {
    run: String,
    frame: u64,
}
