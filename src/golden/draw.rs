//! Simulates and draws a scene or figure, for comparing it with its golden or for making one.

use super::drawing::{Drawing, add, size};
use super::folder::{Drawn, Golden};
use super::record::Record;
use super::said;
use super::source::Source;
use super::states::States;
use crate::gpu::{Gpu, adapter_name};
use crate::output::{Compression, Tags, encode};
use crate::picture::{Composer, compose_figure};
use crate::reading::beside::name_of;
use crate::render::{RenderError, Renderer};
use crate::runner::growing::Growing;
use crate::runner::history::History;
use crate::runner::moments::Taking;
use crate::runner::{Frames, Next, Runner};
use crate::scene::figure::Figure;
use crate::scene::{Limits, Scene, SceneError, is_figure_file};
use crate::sim::Scope;
use std::path::Path;

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
    match subject {
        Subject::Scene(scene) => draw_scene(path, scene, golden, pictures, gpu, go_on),
        Subject::Figure(figure) => draw_figure(path, figure, golden, gpu, go_on),
    }
}

fn draw_scene(
    path: &Path,
    scene: &Scene,
    golden: &Golden,
    pictures: u64,
    gpu: Option<&Gpu>,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Option<Drawn>, DrawError> {
    let mut scene = scene.clone();
    scene.view.size = size(scene.view.size, golden);
    let runs: Vec<usize> = (0..scene.runs.len()).collect();
    let mut drawing = Drawing::new(&scene, golden, pictures, gpu)?;
    // Charts, paths and cameras need the whole time series, which is simulated before the first frame is drawn.
    let wanted = scene.time_series().filter(|_| drawing.is_drawn());
    let runner = Runner::new(&scene, &runs).with_time_series(wanted);
    let waiting = wanted.map(|_| tempfile::tempfile().map(Growing::new)).transpose()?;
    let mut frames = Frames::new(runner, &drawing.frames(), waiting);
    let (mut course, mut composer) = (History::default(), None);
    loop {
        if !go_on() {
            return Ok(None);
        }
        match frames.next(SLICE)? {
            Next::Working => {}
            Next::TimeSeries(history) => course = history,
            Next::Frame(frame) => {
                drawing
                    .add(&frame, || composer.get_or_insert_with(|| Composer::new(&scene, &course)).compose(&frame))?;
            }
            Next::Done => break,
        }
    }
    Ok(Some(drawing.finish(path, name_of(path), said::of_scene(&scene, None, &[]))))
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
    let mut pictures = None;
    if gpu.is_some() || !figure.is_lit() {
        let [width, height] = figure.size;
        let no_room = |error| DrawError::NoRoom(format!("{}: at {width}×{height} {error}", figure.name));
        let (picture, _) = compose_figure(&figure, &moments).map_err(no_room)?;
        let image = Renderer::new(gpu, figure.size)?.draw(&picture)?;
        let texts = Tags::of_figure(&figure, &moments, &adapter_name(gpu.filter(|_| figure.is_lit()))).texts();
        let file = encode(figure.size, image.as_raw(), &texts, Compression::Small);
        pictures = Some([(format!("{}.png", figure.name), Source::Memory(file))].into());
    }
    let keys = said::of_figure(path, &figure);
    let record = Record { subject: name_of(path), size: figure.size, frames: [0].into(), keys, states };
    Ok(Some(Drawn { origin: path.to_owned(), record, pictures, notes: Vec::new() }))
}
