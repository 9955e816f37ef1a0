//! A scene or figure, simulated and drawn to be compared with its golden, or to become one.

use super::distance::kind;
use super::moved::{distances_of, draw_distances};
use super::plan::Plan;
use super::record::{Drawn, Record};
use super::side::{Kind, Side, Source};
use super::states::{State, States, Step};
use crate::artist::{Artist, FigureError, draw_figure as draw_figure_on};
use crate::gpu::{AdapterChoice, Gpu, InitError};
use crate::output::{Compression, Tags, encode, frame_file_name};
use crate::render::RenderError;
use crate::runner::moments::Taking;
use crate::runner::{Frames, Next, Runner};
use crate::scene::figure::Figure;
use crate::scene::{Limits, Scene, SceneError, is_figure_file};
use crate::sim::diagnostics::Reach;
use crate::sim::snapshot::{Divergence, Status};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Width of new goldens (px), unless their scene is smaller: small pictures detect as much and keep repositories small.
const WIDTH: u32 = 320;
/// Number of pictures in new goldens, if there are so many frames.
const PICTURES: u64 = 3;
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
}

/// Options for drawing a golden. `None` means as the existing golden, or the default for new ones.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct DrawOptions {
    /// The frames to draw, rising.
    pub(crate) frames: Option<Vec<u64>>,
    /// How many frames a new golden has.
    pub(crate) pictures: Option<u64>,
    /// Width and height (px).
    pub(crate) size: Option<[u32; 2]>,
    /// Width of a new golden (px).
    pub(crate) width: Option<u32>,
    /// Whether states that moved are drawn once more, coloured by how far their nodes have moved.
    pub(crate) distances: bool,
}

impl DrawOptions {
    /// The same as options of the command line, each with a space before it.
    fn command_line(&self) -> String {
        let mut options = String::new();
        if let Some(frames) = &self.frames {
            let frames: Vec<_> = frames.iter().map(u64::to_string).collect();
            options += &format!(" --frames {}", frames.join(","));
        }
        if let Some([width, height]) = self.size {
            options += &format!(" --size {width}x{height}");
        }
        options
    }
}

/// Why it could not be drawn.
#[derive(Debug, thiserror::Error)]
pub(crate) enum DrawError {
    #[error(transparent)]
    Render(#[from] RenderError),
    #[error("states cannot be stored in the folder for temporary files: {0}")]
    Disk(#[from] std::io::Error),
    #[error("{0}")]
    Options(String),
}

/// The device for a golden: the kind of adapter that drew it if this machine has it, else a software driver.
pub(crate) fn usual_gpu(golden: &Side) -> Result<Gpu, InitError> {
    let drawn = golden.record.iter().flat_map(|record| &record.pictures).map(|drawn| kind(&drawn.adapter));
    let same = drawn.filter(|kind| !kind.is_empty()).find_map(|kind| Gpu::new(&AdapterChoice::Named(kind.into())).ok());
    same.map_or_else(|| Gpu::new(&AdapterChoice::Cpu), Ok)
}

/// Simulates a scene or figure and draws the pictures that its golden has, or those of the options. Without a device
/// nothing is drawn, and states alone can be compared. If `go_on` returns `false`, there is no result.
///
/// # Errors
/// A device that fails, or an option that cannot be met.
pub(crate) fn draw(
    path: &Path,
    subject: &Subject,
    options: &DrawOptions,
    old: &Side,
    gpu: Option<&Gpu>,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Option<Side>, DrawError> {
    let drawn = match subject {
        Subject::Scene(scene) => draw_scene(scene, options, old.record.as_ref(), gpu, go_on)?,
        Subject::Figure(figure) => draw_figure(figure, options, old.record.as_ref(), gpu, go_on)?,
    };
    Ok(drawn.map(|Made { mut record, pictures, distances, notes }| {
        record.subject = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let pictures: BTreeMap<_, _> =
            pictures.into_iter().map(|(name, bytes)| (name, Source::Memory(bytes))).collect();
        Side {
            origin: path.into(),
            kind: Kind::Drawn,
            pictures,
            record: Some(record),
            is_undrawn: gpu.is_none(),
            options: options.command_line(),
            distances,
            notes,
        }
    }))
}

/// The result of simulating and drawing.
struct Made {
    record: Record,
    /// PNG files by name.
    pictures: BTreeMap<String, Vec<u8>>,
    /// The same of states that moved, coloured by how far.
    distances: BTreeMap<String, Vec<u8>>,
    notes: Vec<String>,
}

fn draw_scene(
    scene: &Scene,
    options: &DrawOptions,
    old: Option<&Record>,
    gpu: Option<&Gpu>,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Option<Made>, DrawError> {
    let last = scene.last_frame();
    let frames: BTreeSet<u64> = match (&options.frames, old) {
        (Some(frames), _) => frames.iter().copied().collect(),
        (None, Some(old)) if old.pictures.iter().any(|drawn| drawn.frame <= last) => {
            old.pictures.iter().map(|drawn| drawn.frame).filter(|&frame| frame <= last).collect()
        }
        (None, old) => {
            let count = old.map_or(options.pictures.unwrap_or(PICTURES), |old| old.pictures.len() as u64).max(1);
            (1..=count).map(|at| (u128::from(last) * u128::from(at) / u128::from(count)) as u64).collect()
        }
    };
    let mut scene = scene.clone();
    let size = size(scene.view.size, options, old);
    scene.view.size = size;
    let runs: Vec<usize> = (0..scene.runs.len()).collect();
    let mut plan = Plan::new(last, runs.len(), scene.body.len(), &frames);
    if let Some(old) = old {
        plan = plan.with(old, last);
    }
    let mut artist = gpu.map(|gpu| Artist::new(gpu, &scene)).transpose()?;
    let adapter = gpu.map_or_else(String::new, |gpu| gpu.description().to_string());
    let (mut states, mut pictures, mut drawn) = (States::default(), BTreeMap::new(), Vec::new());
    let (mut stopped, mut distances, mut course) = (BTreeMap::new(), BTreeMap::new(), None);
    // Charts, paths and cameras need the whole time series, which is simulated before the first frame is drawn.
    let wanted = scene.time_series().filter(|_| artist.is_some());
    let runner = Runner::new(&scene, &runs);
    let runner = match wanted {
        Some(wanted) => runner.with_time_series(wanted),
        None => runner,
    };
    let frames: Vec<_> = plan.frames().into_iter().collect();
    let waiting = wanted.map(|_| tempfile::tempfile()).transpose()?;
    let mut frames = Frames::new(runner, &frames, waiting);
    loop {
        if !go_on() {
            return Ok(None);
        }
        let frame = match frames.next(SLICE)? {
            Next::Working => continue,
            Next::TimeSeries(history) => {
                artist.iter_mut().for_each(|artist| artist.set_history(&history));
                course = Some(history);
                continue;
            }
            Next::Frame(frame) => frame,
            Next::Done => break,
        };
        let index = frame.index;
        for run in &frame.runs {
            let state = State::of(&run.snapshot, plan.positions.contains(&index));
            let name = &scene.runs[run.run].name;
            states.add(name, index, state);
            if let Status::Diverged(Divergence { time, step, .. }) = run.snapshot.status {
                let words =
                    || format!("{name} diverged at {time:.3e} s (step {step}) and is not advanced from there on");
                stopped.entry(run.run).or_insert_with(words);
            }
        }
        if let (Some(artist), true) = (&mut artist, plan.pictures.contains(&index)) {
            let composed = artist.compose(&frame);
            let begun = artist.begin(composed)?;
            let pixels = artist.finish(begun)?;
            let label = Tags::of_frame(&scene, &frame, &adapter);
            let bytes = encode(size, &pixels, &label.texts(), Compression::High);
            let file = frame_file_name(index);
            drawn.push(Drawn::new(&file, &label));
            let moved = old.filter(|_| options.distances).and_then(|old| distances_of(&scene, &frame, old));
            if let (Some(gpu), Some(moved)) = (gpu, moved) {
                let larger = size.map(|side| (2 * side).min(gpu.longest_side()));
                let pixels = draw_distances(gpu, &scene, larger, &frame, &moved, course.as_ref())?;
                distances.insert(file.clone(), encode(larger, &pixels, &[], Compression::High));
            }
            pictures.insert(file, bytes);
        }
    }
    let cycle = scene.cycle();
    states.set_steps(scene.runs.iter().map(|run| (run.name.as_str(), Step { step: run.step, cycle })));
    let scenes = vec![scene.digest.clone()];
    let record = Record { subject: String::new(), scenes, size, pictures: drawn, states };
    Ok(Some(Made { record, pictures, distances, notes: stopped.into_values().collect() }))
}

fn draw_figure(
    figure: &Figure,
    options: &DrawOptions,
    old: Option<&Record>,
    gpu: Option<&Gpu>,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Option<Made>, DrawError> {
    let mut figure = figure.clone();
    if options.frames.as_ref().is_some_and(|frames| frames != &[0]) {
        return Err(DrawError::Options(format!("{} is a figure and has no frames to choose from", figure.name)));
    }
    figure.size = size(figure.size, options, old);
    let mut taking = Taking::new(&figure, Reach::Goldens);
    while !taking.advance(SLICE) {
        if !go_on() {
            return Ok(None);
        }
    }
    let moments = taking.finish();
    let mut states = States::default();
    for (name, (scene, run), snapshot) in moments.runs_and_states(&figure) {
        states.add(&name, 0, State::of(snapshot, true));
        states.set_steps([(name.as_str(), Step { step: scene.runs[run].step, cycle: scene.cycle() })]);
    }
    let (mut pictures, mut drawn) = (BTreeMap::new(), Vec::new());
    if let Some(gpu) = gpu {
        let image = draw_figure_on(gpu, &figure, &moments).map_err(|error| match error {
            FigureError::Render(error) => DrawError::Render(error),
            FigureError::NoRoom(error) => {
                let [width, height] = figure.size;
                DrawError::Options(format!("{}: at {width}×{height} {error}; ask for another --size", figure.name))
            }
        })?;
        let label = Tags::of_figure(&figure, &moments, &gpu.description().to_string());
        let file = format!("{}.png", figure.name);
        drawn.push(Drawn::new(&file, &label));
        pictures.insert(file, encode(figure.size, image.as_raw(), &label.texts(), Compression::High));
    }
    let scenes = figure.scenes().iter().map(|scene| scene.digest.clone()).collect();
    let record = Record { subject: String::new(), scenes, size: figure.size, pictures: drawn, states };
    Ok(Some(Made { record, pictures, distances: BTreeMap::new(), notes: Vec::new() }))
}

/// The size to draw in (px).
fn size(own: [u32; 2], options: &DrawOptions, old: Option<&Record>) -> [u32; 2] {
    if let Some(size) = options.size.or(old.map(|old| old.size)) {
        return size;
    }
    let [width, height] = own;
    let small = options.width.unwrap_or(WIDTH).min(width);
    [small, (u64::from(height) * u64::from(small) / u64::from(width.max(1))).max(16) as u32]
}

#[cfg(test)]
mod tests {
    use super::super::Comparison;
    use super::*;
    use std::path::PathBuf;

    /// Every scene that ships.
    fn shipped() -> Vec<PathBuf> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let files = ["scenes", "scenes/elements"].map(|folder| std::fs::read_dir(root.join(folder)).expect("scenes"));
        let paths = files.into_iter().flatten().map(|entry| entry.expect("an entry").path());
        let mut scenes: Vec<_> = paths.filter(|path| path.extension().is_some_and(|ending| ending == "toml")).collect();
        scenes.sort();
        scenes
    }

    /// Some frames of a scene from its start on, with one run as if its body had started elsewhere.
    fn record(scene: &Scene, moved: &Scene, moved_run: usize) -> Record {
        let mut states = States::default();
        for (number, run) in scene.runs.iter().enumerate() {
            let scene = if number == moved_run { moved } else { scene };
            let mut runner = Runner::new(scene, &[number]);
            for frame in (0..=scene.last_frame()).take(4) {
                let snapshot = &runner.frame(frame).runs[0].snapshot;
                states.add(&run.name, frame, State::of(snapshot, true));
            }
        }
        let [file, adapter, version] = ["a.png", "", ""].map(str::to_owned);
        let pictures = vec![Drawn { file, frame: 0, adapter, version }];
        Record { subject: String::new(), scenes: Vec::new(), size: [320, 200], pictures, states }
    }

    fn side(record: Record, kind: Kind) -> Side {
        let (origin, pictures) = ("golden".into(), BTreeMap::new());
        let is_undrawn = kind == Kind::Drawn;
        let (options, distances, notes) = Default::default();
        Side { origin, kind, pictures, record: Some(record), is_undrawn, options, distances, notes }
    }

    /// A small scene, its golden, and both compared after a change of its states.
    fn changed(change: impl Fn(&mut States)) -> Comparison {
        let text = "
            time = { duration = 0.05, step = 0.01, frames_per_second = 60 }
            body = { lattice = { cells = [1, 1, 1], side = 1 } }
            run = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1 } }]
        ";
        let scene = Scene::parse(text, "one", &Limits::default()).unwrap_or_else(|error| panic!("{error}"));
        let golden = record(&scene, &scene, 0);
        let mut actual = golden.clone();
        change(&mut actual.states);
        Comparison::between(side(golden, Kind::Golden), side(actual, Kind::Drawn)).expect("two records")
    }

    /// Fewer states are other ones, also where no picture shows it.
    #[test]
    fn a_scene_that_became_shorter_never_passes() {
        assert!(changed(|_| ()).passes());
        let shorter = changed(|states| drop(states.runs[0].states.remove(&3)));
        assert_eq!((shorter.passes(), shorter.verdict(), shorter.ends_early), (false, "missing", Some([3, 2])));
        assert!(shorter.moved.is_empty() && shorter.state_moved());
    }

    /// A relative error of 1e-9 of one node of one run is physics, whatever the scene, and of that run alone.
    #[test]
    fn the_smallest_errors_of_a_node_are_seen_in_every_scene() {
        let shipped = shipped();
        assert!(shipped.len() >= 25, "{}", shipped.len());
        for path in shipped {
            let scene = Scene::load(&path, &Limits::default()).expect("a scene that ships");
            // As it is read from its file, with all that is lost there.
            let golden = Record::parse(&record(&scene, &scene, 0).text()).expect("a record");
            let compare = |moved: &Scene, run: usize| {
                let actual = side(record(&scene, moved, run), Kind::Drawn);
                Comparison::between(side(golden.clone(), Kind::Golden), actual).expect("a golden and its scene")
            };
            assert!(compare(&scene, 0).passes(), "{}: {}", path.display(), compare(&scene, 0));
            let run = scene.runs.len() - 1;
            let mut moved = scene.clone();
            let node = moved.initial.position.iter().rposition(|at| at.length() > 0.0);
            match node {
                Some(node) => moved.initial.position[node] *= 1.0 + 1e-9,
                // All nodes start at the origin, where no error is relative: a thousand-millionth of the element's side.
                None => moved.initial.position[0].x = 1e-10,
            }
            let found = compare(&moved, run);
            assert_eq!(found.verdict(), "state moved", "{}", path.display());
            let runs: Vec<_> = found.moved.iter().map(|moved| (&moved.run, moved.first)).collect();
            assert_eq!(runs, [(&scene.runs[run].name, Some(0))], "{}", path.display());
        }
    }
}
