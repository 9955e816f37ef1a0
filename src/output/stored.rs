//! Reads `states.npz`, from which frames are drawn without simulating them.

use super::OutputError;
use super::states::{COURSE, Course, Origin};
use crate::runner::Stored;
use crate::runner::history::History;
use crate::scene::Scene;
use crate::scene::npz::{Array, Npz};
use crate::sim::{Memory, State, Status};
use glam::DVec3;
use sha2::{Digest, Sha256};
use std::io;
use std::path::{Path, PathBuf};

/// The states of some runs in the frames of a file, read one at a time.
#[derive(Debug)]
pub(crate) struct StoredStates {
    path: PathBuf,
    npz: Npz,
    course: Course,
    runs: Vec<RunArrays>,
}

/// The arrays of a run.
#[derive(Debug)]
struct RunArrays {
    /// Its index in the course.
    run: usize,
    /// Positions, velocities and memory.
    arrays: [Array; 3],
}

impl StoredStates {
    /// Opens the states of some frames and runs of a scene, if the file has everything that their pictures need.
    ///
    /// # Errors
    /// If the file cannot be read, is damaged, or has other states.
    pub(crate) fn open(path: &Path, scene: &Scene, runs: &[usize], frames: &[u64]) -> Result<Self, OutputError> {
        let open = || {
            let mut npz = Npz::open(path)?;
            let course = course(&mut npz, scene)?;
            let runs = runs.iter().map(|&run| place(&mut npz, &course, scene, run)).collect::<Result<_, _>>()?;
            has_frames(&course, frames)?;
            if scene.time_series().is_some() && course.history.is_none() {
                let help = "simulate it again with --states and all frames, or with --frames up to the last one";
                return Err(format!("lacks the course of the scene to its end, which its pictures show; {help}"));
            }
            Ok(Self { path: path.to_owned(), npz, course, runs })
        };
        let mut stored = open().map_err(|what| OutputError::States { path: path.to_owned(), what: what.into() })?;
        if let Some(history) = &mut stored.course.history {
            only(history, runs);
        }
        Ok(stored)
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

/// The stored course, if it belongs to the scene.
fn course(npz: &mut Npz, scene: &Scene) -> Result<Course, String> {
    let again = "simulate the scene again with --states";
    let bytes = match npz.array(COURSE) {
        None => return Err(format!("has no array `{COURSE}`, which `localshape simulate --states` writes; {again}")),
        Some(array) => {
            // Packed data could unfold to any size, and this program packs nothing.
            let fits = |array: Array| match npz.has_room_for(&array) {
                true => npz.values(&array),
                false => Err(format!("is packed, or longer than the file; {again}")),
            };
            array.and_then(fits).map_err(|what| format!("`{COURSE}` {what}"))?
        }
    };
    let damaged = |_| format!("is damaged: `{COURSE}` was not written by this program; {again}");
    let (origin, rest): (Origin, _) = postcard::take_from_bytes(bytes.bytes()).map_err(damaged)?;
    if let Some(why) = origin.refusal(&scene.digest, &scene.title) {
        return Err(format!("{why}; {again}"));
    }
    postcard::from_bytes(rest).map_err(damaged)
}

/// The arrays of a run of the scene.
fn place(npz: &mut Npz, course: &Course, scene: &Scene, run: usize) -> Result<RunArrays, String> {
    let (name, nodes) = (&scene.runs[run].name, scene.runs[run].body().len() as u64);
    let Some(run) = course.runs.iter().position(|stored| stored.name == *name) else {
        let names: Vec<_> = course.runs.iter().map(|run| format!("“{}”", run.name)).collect();
        return Err(format!("has no states of “{name}”, only of {}; choose among these with --only", names.join(", ")));
    };
    let stored = &course.runs[run];
    let frames = stored.digests.len() as u64;
    let mut array = |quantity: &str, is_row: &dyn Fn(&[u64]) -> bool| {
        let damaged = |what: &str| format!("is damaged: `{name}.{quantity}` {what}");
        let array = npz.array(&format!("{name}.{quantity}")).ok_or_else(|| damaged("is missing"))?;
        let array = array.map_err(|what| damaged(&what))?;
        if !npz.has_room_for(&array) {
            return Err(damaged("is packed, or longer than the file"));
        }
        let is_right = array.is_plain() && array.shape.strip_prefix(&[frames]).is_some_and(is_row);
        if is_right { Ok(array) } else { Err(damaged("has another shape or type")) }
    };
    let of_nodes = |row: &[u64]| *row == [nodes, 3];
    let of_memory = |row: &[u64]| matches!(*row, [length] if length >= stored.model as u64);
    let arrays = [array("position", &of_nodes)?, array("velocity", &of_nodes)?, array("memory", &of_memory)?];
    if stored.digests.len() != course.frames.len() {
        return Err(format!("is damaged: its entry for “{name}” does not fit its frames"));
    }
    Ok(RunArrays { run, arrays })
}

/// Refuses frames that the course does not have.
fn has_frames(course: &Course, frames: &[u64]) -> Result<(), String> {
    let Some(missing) = frames.iter().find(|frame| course.frames.binary_search(frame).is_err()) else { return Ok(()) };
    let there = match course.frames[..] {
        [] => "no frame".to_owned(),
        [frame] => format!("frame {frame} only"),
        [first, .., last] => format!("{} frames from {first} to {last}", course.frames.len()),
    };
    Err(format!(
        "lacks frame {missing}: it has {there}; choose among them with --frames, or simulate all with --states"
    ))
}

/// Keeps only the time series of some runs.
fn only(history: &mut History, runs: &[usize]) {
    history.series.retain(|series| runs.contains(&series.run));
}

impl Stored for StoredStates {
    fn state(&mut self, place: usize, frame: u64, steps: u64) -> io::Result<State> {
        let Self { npz, course, runs, .. } = self;
        let RunArrays { run, arrays } = &runs[place];
        let stored = &course.runs[*run];
        let damaged = |what: &str| {
            io::Error::new(io::ErrorKind::InvalidData, format!("frame {frame} of “{}” {what}", stored.name))
        };
        let row = course.frames.binary_search(&frame).map_err(|_| damaged("is missing"))?;
        let mut hash = Sha256::new();
        let mut read = |array: &Array| -> io::Result<Vec<f64>> {
            let length = array.shape[1..].iter().product::<u64>() * 8;
            let mut bytes = vec![0; length as usize];
            npz.part(array, row as u64 * length, &mut bytes).map_err(|what| damaged(&what))?;
            hash.update(&bytes);
            Ok(bytes.as_chunks::<8>().0.iter().map(|&number| f64::from_le_bytes(number)).collect())
        };
        let [position, velocity, mut model] = [read(&arrays[0])?, read(&arrays[1])?, read(&arrays[2])?];
        if hash.finalize()[..] != stored.digests[row] {
            return Err(damaged("is damaged: its numbers differ from the written ones"));
        }
        let vectors = |numbers: &[f64]| numbers.as_chunks::<3>().0.iter().map(|&v| DVec3::from_array(v)).collect();
        let constraints = model.split_off(stored.model);
        let reached = stored.divergence.filter(|divergence| divergence.step <= steps);
        Ok(State {
            position: vectors(&position),
            velocity: vectors(&velocity),
            steps,
            status: reached.map_or(Status::Ok, Status::Diverged),
            memory: Memory { model, constraints, integrator: Vec::new() },
        })
    }

    fn take_history(&mut self) -> Option<History> {
        self.course.history.take()
    }

    fn last_fit(&self, place: usize) -> Option<Option<(State, f64)>> {
        let found = self.course.runs[self.runs[place].run].last_fit.as_ref()?;
        let read = |(bytes, times_wider): &(Vec<u8>, f64)| Some((State::from_bytes(bytes)?, *times_wider));
        Some(found.as_ref().and_then(read))
    }
}
