//! Simulates and draws a scene or figure, for comparing it with its golden or for making one.

use super::folder::{Drawn, Golden};
use super::record::{DIGITS, Record};
use super::said;
use super::states::{State, States};
use crate::gpu::{AdapterChoice, Gpu, InitError, adapter_name};
use crate::output::{Compression, Tags, encode, frame_file_name, recorded, state_digest};
use crate::picture::{Composer, compose_figure};
use crate::render::{RenderError, Renderer};
use crate::runner::growing::Growing;
use crate::runner::history::History;
use crate::runner::moments::Taking;
use crate::runner::{Frames, Next, Runner};
use crate::scene::figure::Figure;
use crate::scene::{Limits, Scene, SceneError, is_figure_file};
use crate::sim::{Divergence, Scope, Snapshot, Status};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Spaces between the frames whose positions are recorded.
const SPACES: u64 = 10;
/// Approximate maximum size of the digests of a golden (bytes).
const ROOM_FOR_DIGESTS: usize = 24 << 10;
/// Width of new goldens (px), unless their scene is smaller: small pictures detect as much and keep repositories small.
const WIDTH: u32 = 320;
/// Number of pictures in new goldens, unless there are fewer frames.
pub(crate) const PICTURES: u64 = 3;
/// Steps of each run between checks for interruption.
const SLICE: u64 = 100;

/// The subject of a golden.
#[derive(Clone, Debug)]
pub(crate) enum Subject {
    /// A scene: some of its frames are drawn, and the states of many more recorded.
    Scene(Box<Scene>),
    /// A figure: one picture, and the states that it shows.
    Figure(Box<Figure>),
}

impl Subject {
    /// Reads a scene file or a figure file.
    pub(crate) fn load(path: &Path, limits: &Limits) -> Result<Self, SceneError> {
        if is_figure_file(path, limits) {
            return Ok(Self::Figure(Box::new(Figure::load(path, limits)?)));
        }
        Ok(Self::Scene(Box::new(Scene::load(path, limits)?)))
    }

    /// Whether its pictures need a device.
    pub(crate) fn is_lit(&self) -> bool {
        match self {
            Self::Scene(scene) => scene.is_lit(),
            Self::Figure(figure) => figure.is_lit(),
        }
    }
}

/// Why a scene or figure could not be drawn.
#[derive(Debug, thiserror::Error)]
pub(crate) enum DrawError {
    #[error(transparent)]
    Render(#[from] RenderError),
    #[error("states cannot be stored in the folder for temporary files: {0}")]
    Disk(#[from] std::io::Error),
    #[error("{0}")]
    NoRoom(String),
}

/// The device for a golden: the kind of adapter that drew it if this machine has it, else a software driver.
pub(crate) fn usual_gpu(golden: &Golden) -> Result<Gpu, InitError> {
    // Versions follow in brackets.
    let kind = golden.adapter().map(|adapter| adapter.split(" (").next().unwrap_or_default().to_owned());
    let same = kind.filter(|kind| !kind.is_empty()).and_then(|kind| Gpu::new(&AdapterChoice::Named(kind)).ok());
    same.map_or_else(|| Gpu::new(&AdapterChoice::Cpu), Ok)
}

/// Simulates a scene or figure and draws the pictures that its golden has, or `pictures` of them for a new golden.
/// Lit bodies are drawn only with a device; without one, only their states are compared. If `go_on` returns `false`, there is no result.
///
/// # Errors
/// If the device fails, or a figure has no room in the size of its golden.
pub(crate) fn draw(
    path: &Path,
    subject: &Subject,
    golden: &Golden,
    pictures: u64,
    gpu: Option<&Gpu>,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Option<Drawn>, DrawError> {
    let drawn = match subject {
        Subject::Scene(scene) => draw_scene(scene, golden, pictures, gpu, go_on)?,
        Subject::Figure(figure) => draw_figure(path, figure, golden, gpu, go_on)?,
    };
    Ok(drawn.map(|mut drawn| {
        drawn.origin = path.to_owned();
        drawn.record.subject = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        drawn
    }))
}

fn draw_scene(
    scene: &Scene,
    golden: &Golden,
    pictures: u64,
    gpu: Option<&Gpu>,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Option<Drawn>, DrawError> {
    let last = scene.last_frame();
    let old: BTreeSet<u64> = golden.frames().into_iter().filter(|&frame| frame <= last).collect();
    let evenly = |at: u64| (u128::from(last) * u128::from(at) / u128::from(pictures.max(1))) as u64;
    let drawn = if old.is_empty() { (1..=pictures.max(1)).map(evenly).collect() } else { old };
    let with_positions = frames_with_positions(last);
    let mut scene = scene.clone();
    let size = size(scene.view.size, golden);
    scene.view.size = size;
    let runs: Vec<usize> = (0..scene.runs.len()).collect();
    let is_drawn = gpu.is_some() || !scene.is_lit();
    let mut renderer = is_drawn.then(|| Renderer::new(gpu, size)).transpose()?;
    let adapter = adapter_name(gpu.filter(|_| scene.is_lit()));
    let (mut states, mut files, mut stopped) = (States::default(), BTreeMap::new(), BTreeMap::new());
    // Charts, paths and cameras need the whole time series, which is simulated before the first frame is drawn.
    let wanted = scene.time_series().filter(|_| renderer.is_some());
    let runner = Runner::new(&scene, &runs).with_time_series(wanted);
    let digests = scene.runs.iter().map(|run| run.of.len()).sum();
    let frames: Vec<u64> = frames_with_digests(last, digests, &drawn).into_iter().collect();
    let waiting = wanted.map(|_| tempfile::tempfile().map(Growing::new)).transpose()?;
    let mut frames = Frames::new(runner, &frames, waiting);
    let (mut course, mut composer) = (History::default(), None);
    loop {
        if !go_on() {
            return Ok(None);
        }
        let frame = match frames.next(SLICE)? {
            Next::Working => continue,
            Next::TimeSeries(history) => {
                course = history;
                continue;
            }
            Next::Frame(frame) => frame,
            Next::Done => break,
        };
        let index = frame.index;
        for run in &frame.runs {
            let name = &scene.runs[run.run].name;
            add(&mut states, name, (&scene, run.run), index, &run.snapshot, with_positions.contains(&index));
            if let Status::Diverged(Divergence { time, step, part, is_end, .. }) = run.snapshot.status {
                let words = || match is_end {
                    true => format!("the recording of {name} ends at {time:.3e} s"),
                    false => {
                        let (name, _) = recorded(name, &scene, run.run).swap_remove(part);
                        format!("{name} diverged at {time:.3e} s (step {step}) and is not advanced from there on")
                    }
                };
                stopped.entry(run.run).or_insert_with(words);
            }
        }
        if let (Some(renderer), true) = (&mut renderer, drawn.contains(&index)) {
            let composer = composer.get_or_insert_with(|| Composer::new(&scene, &course));
            let pixels = renderer.draw(&composer.compose(&frame))?.into_raw();
            let texts = Tags::of_frame(&scene, &frame, &adapter).texts();
            files.insert(frame_file_name(index), encode(size, &pixels, &texts, Compression::Small));
        }
    }
    let record = Record { subject: String::new(), size, frames: drawn, keys: said::of_scene(&scene), states };
    Ok(Some(Drawn::new(record, files, is_drawn, stopped.into_values().collect())))
}

fn draw_figure(
    path: &Path,
    figure: &Figure,
    golden: &Golden,
    gpu: Option<&Gpu>,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Option<Drawn>, DrawError> {
    let mut figure = figure.clone();
    figure.size = size(figure.size, golden);
    let mut taking = Taking::new(&figure, Scope::Summaries);
    while taking.advance(SLICE).is_some() {
        if !go_on() {
            return Ok(None);
        }
    }
    let moments = taking.finish();
    let mut states = States::default();
    for (name, of, snapshot) in moments.runs_and_states(&figure) {
        add(&mut states, &name, of, 0, snapshot, true);
    }
    let mut files = BTreeMap::new();
    let is_drawn = gpu.is_some() || !figure.is_lit();
    if is_drawn {
        let [width, height] = figure.size;
        let no_room = |error| DrawError::NoRoom(format!("{}: at {width}×{height} {error}", figure.name));
        let (picture, _) = compose_figure(&figure, &moments).map_err(no_room)?;
        let image = Renderer::new(gpu, figure.size)?.draw(&picture)?;
        let texts = Tags::of_figure(&figure, &moments, &adapter_name(gpu.filter(|_| figure.is_lit()))).texts();
        files.insert(format!("{}.png", figure.name), encode(figure.size, image.as_raw(), &texts, Compression::Small));
    }
    let keys = said::of_figure(path, &figure);
    let record = Record { subject: String::new(), size: figure.size, frames: [0].into(), keys, states };
    Ok(Some(Drawn::new(record, files, is_drawn, Vec::new())))
}

/// Adds the states of a run's snapshot under a name, with their positions on request.
fn add(
    states: &mut States,
    name: &str,
    (scene, run): (&Scene, usize),
    frame: u64,
    snapshot: &Snapshot,
    with_positions: bool,
) {
    for (name, nodes) in recorded(name, scene, run) {
        let run = states.run_mut(&name);
        run.nodes = nodes.len();
        let positions = with_positions.then(|| snapshot.position[nodes.clone()].to_vec());
        run.states.insert(frame, State { digest: state_digest(snapshot, nodes), positions });
    }
}

/// The size to draw in (px): that of the golden, or a small one for a new golden.
fn size([width, height]: [u32; 2], golden: &Golden) -> [u32; 2] {
    golden.size().unwrap_or_else(|| {
        let small = WIDTH.min(width);
        [small, (u64::from(height) * u64::from(small) / u64::from(width.max(1))).max(16) as u32]
    })
}

/// The frames of a scene whose digests a record has, so many of each frame: as many as fit, and all of `others`.
fn frames_with_digests(last: u64, digests: usize, others: &BTreeSet<u64>) -> BTreeSet<u64> {
    let row = 5 + (DIGITS + 1) * digests;
    // With powers of two, a scene that becomes longer still has frames in common with its golden.
    let stride = ((last as usize + 1) * row).div_ceil(ROOM_FOR_DIGESTS).next_power_of_two();
    (0..=last).step_by(stride).chain(others.iter().copied()).chain(frames_with_positions(last)).collect()
}

/// The frames of a scene whose positions a record has: evenly spaced, independent of the drawn frames.
fn frames_with_positions(last: u64) -> BTreeSet<u64> {
    (0..=SPACES).map(|at| (u128::from(last) * u128::from(at) / u128::from(SPACES)) as u64).collect()
}

#[cfg(test)]
#[path = "../../tests/inside/draw.rs"]
mod tests;
