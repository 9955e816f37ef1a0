//! Scenes, from typed files to resolved values: every number is in SI units, every index is in range, and no field says
//! "use the default".

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

//!
//! `load` reads a scene file, `structure` checks it against the `schema` made from the types in `file`, and `resolve`
//! resolves it. All of them report mistakes to one `report`. Bodies come from `generate`, from the scene's own lists,
//! from a NumPy archive, read by `npz`, or from a `mesh`. Fonts are read by `font`.

mod builder;
mod digest;
#[cfg(feature = "render")]
mod drawn;
mod error;
pub(crate) mod figure;
mod file;
mod generate;
mod limits;
mod load;
pub(crate) mod mesh;
pub(crate) mod npy;
pub(crate) mod npz;
mod plausible;
mod recording;
pub(crate) mod reference;
mod resolve;
mod schema;
mod sequence;
mod stability;
mod step;
mod structure;
mod summary;
mod turning;

pub use crate::reading::captions::description;
pub use crate::reading::{Mistake, Mistakes};
pub use builder::{BodyBuilder, NodeSet, ObstacleBuilder, RunBuilder, SceneBuilder};
pub use error::SceneError;
pub use file::{Cells, Coordinates, Lattice, MotionPath, Rotation, Side, Start, StartShape, Swing, Up};
pub use limits::Limits;
#[cfg(feature = "render")]
pub(crate) use load::is_figure_file;
pub use recording::Recorded;
pub(crate) use recording::{Archive, COURSE, Course, Flaw, Origin, StoredRun};
pub use schema::schema;
pub use summary::{BodySummary, PartSummary, RunSummary, SceneSummary};

use crate::colour::Colour;
use crate::look::{Subject, SubjectBody, SubjectRun, View};
use crate::reading::captions::typed;
use crate::reading::collector::{Collector, key_path};
use crate::reading::words::{list, nearest, quoted};
use crate::sim::geometry;
use crate::sim::model::{ElasticModel, Report};
use crate::sim::{Assembly, Body, Dimension, Grip, Integrator, Obstacle, Shape};
use crate::sim::{Diagnostic, Kernel, Moment, State};
use glam::DVec3;
use localshape_mesh::Group;
#[cfg(feature = "render")]
use std::io;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

/// A resolved scene: bodies, their surroundings, and several runs.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The title; the file's stem by default.
    pub title: String,
    /// Stem of the scene file, and name of the default output folder.
    pub name: String,
    /// Full path of the scene file; `None` for a scene from a text.
    pub file: Option<PathBuf>,
    /// Digest of the scene's meaning: 64 hexadecimal digits. Comments, layout and order of keys do not count. Empty if
    /// a run has a model of its own ([`RunBuilder::own`]).
    pub digest: String,
    /// Acceleration of gravity (m/s²).
    pub gravity: DVec3,
    /// Simulated time (s).
    pub duration: f64,
    /// Frames per second of simulated time (1/s).
    pub frames_per_second: f64,
    /// Time between rows of `diagnostics.csv` (s), if it has rows between frames.
    pub every: Option<f64>,
    /// The bodies.
    pub bodies: Vec<SceneBody>,
    /// The runs, one for each panel.
    pub runs: Vec<Run>,
    /// The obstacles, in the order in which they act.
    pub obstacles: Vec<Obstacle>,
    /// The view.
    pub view: View,
    /// Warnings: allowed, but probably mistakes.
    pub warnings: Vec<Mistake>,
}

/// The name of all bodies of a run together in files. No body has it.
pub(crate) const ALL_BODIES: &str = "all";

/// A body of a scene.
#[derive(Clone, Debug)]
pub struct SceneBody {
    /// Its name, unique in its scene; empty if it is the only body and has none.
    pub name: String,
    /// The body at rest.
    pub body: Arc<Body>,
    /// Its initial positions and velocities.
    pub initial: State,
    /// Mean length of its elements' edges (m).
    pub side: f64,
    /// Whether this length is the side of a lattice's cells.
    pub has_cells: bool,
    /// Springs listed by hand.
    pub(crate) springs: Option<Vec<[u32; 2]>>,
    /// Sets of nodes with a name.
    pub(crate) groups: Vec<Group>,
}

impl SceneBody {
    /// The body in messages.
    fn in_words(&self) -> String {
        in_words(&self.name)
    }
}

/// A body with this name in messages.
fn in_words(name: &str) -> String {
    if name.is_empty() { "the body".to_owned() } else { format!("the body {}", quoted(name)) }
}

/// Bodies and runs in their surroundings, as the view sees them.
fn subject<'a>(bodies: &'a [SceneBody], runs: &'a [Run], gravity: DVec3, obstacles: &'a [Obstacle]) -> Subject<'a> {
    let body = |one: &'a SceneBody| {
        let SceneBody { name, body, initial, side, has_cells, .. } = one;
        SubjectBody { name, body, initial, side: *side, has_cells: *has_cells }
    };
    let run = |one: &'a Run| {
        let Run { name, of, bodies, models, step, .. } = one;
        SubjectRun { name, step: *step, of, nodes: bodies.whole().len(), models, is_gripped: !one.grips.is_empty() }
    };
    Subject { bodies: bodies.iter().map(body).collect(), gravity, obstacles, runs: runs.iter().map(run).collect() }
}

/// Bodies of the scene with their models, and one panel of the picture.
#[derive(Clone, Debug)]
pub struct Run {
    /// Unique in its scene.
    pub name: String,
    /// The places of its bodies in [`Scene::bodies`].
    pub of: Vec<usize>,
    /// Its bodies. Runs of the same bodies share them.
    pub bodies: Arc<Assembly>,
    /// The initial state of all its bodies.
    pub initial: State,
    /// The elastic model of each body; empty for a recording.
    pub models: Vec<Arc<dyn ElasticModel>>,
    /// The recording that it shows.
    pub recording: Option<Arc<Recorded>>,
    /// Kinematic constraints: nodes that are held or dragged, counted over all its bodies.
    pub grips: Vec<Grip>,
    /// The integrator.
    pub integrator: Integrator,
    /// Time step ΔT (s); the time between frames for an integrator that chooses its steps.
    pub step: f64,
    /// The error allowed in each step of an integrator that chooses its steps, as a share of the body's size; `None`
    /// for others.
    pub tolerance: Option<f64>,
    /// The code that computes a step.
    pub kernel: Kernel,
    /// The run's place in the palette, which gives its line ([`Self::line`]). In a figure of several scenes, runs of
    /// one name have one place.
    pub(crate) place: usize,
    /// A chosen colour of the run's lines. Other runs get different colours.
    pub colour: Option<Colour>,
}

impl Scene {
    /// The diagnostics whose time series pictures need; `None` if pictures do not show the course of the whole scene.
    /// Charts, paths, cameras that follow, and the drawn sizes of plates and walls show it.
    pub(crate) fn time_series(&self) -> Option<&[Diagnostic]> {
        let view = &self.view;
        let is_flat = self.dimension() == Dimension::Plane;
        let ground = geometry::ground(&self.obstacles, 0.0);
        let has_size = |one: &Obstacle| match one.shape {
            Shape::Plate { .. } => true,
            Shape::Floor { .. } => one.floor(0.0) != ground,
            _ => false,
        };
        let needed = !view.charts.is_empty()
            || !view.paths.is_empty()
            || view.camera.follow
            || (!is_flat && self.obstacles.iter().any(has_size));
        needed.then_some(&view.charts[..])
    }

    /// Reports charts that no run of these scenes has, and charts that are there already, in a table of a file.
    fn check_charts(charts: &[Diagnostic], scenes: &[Self], table: &'static str, report: &mut Collector<'_>) {
        for (index, chart) in charts.iter().enumerate() {
            let (path, found) = (key_path![table, "charts", index], quoted(&typed(chart)));
            if let Some(first) = charts[..index].iter().position(|other| other == chart) {
                let message = format!("`{table}.charts[{index}]` is {found}, as is `{table}.charts[{first}]`");
                report.at(&path, message, "expected each diagnostic once; remove one".to_owned());
            } else if let Some(why) = scenes.iter().map(|scene| scene.lacks(*chart)).reduce(Option::and).flatten() {
                report.at(&path, format!("`{table}.charts[{index}]` is {found}, which no run has"), why);
            }
        }
    }

    /// The message for a diagnostic that no run has, with the diagnostics that charts can show; `None` if a run may
    /// have it.
    fn lacks(&self, diagnostic: Diagnostic) -> Option<&'static str> {
        let has = |has: &dyn Fn(&dyn ElasticModel, &SceneBody) -> bool| {
            self.runs.iter().any(|run| run.parts(self).any(|(model, body)| has(model, body)))
        };
        // Only the model can tell, from its forces.
        let has_residual = |model: &dyn ElasticModel, SceneBody { body, initial, .. }: &SceneBody| {
            let (forces, memory) = (model.prepare(body), model.start(body, &initial.position));
            let report = forces.report(initial.nodes(), &memory, &mut |_, _, _| ());
            report.residual(Report::ROTATION).is_some()
        };
        let (exists, why) = match diagnostic {
            Diagnostic::Elastic | Diagnostic::Energy => {
                (has(&|_, _| true), "recordings have none; plot another diagnostic, such as \"kinetic\"")
            }
            Diagnostic::GlobalRotations => (
                has(&|model, of| model.counts_global(&of.body)),
                "only shape-based models in space count them; plot another diagnostic, such as \"turned_over\"",
            ),
            Diagnostic::Broken => (
                has(&|model, of| model.breaks(&of.body).is_some()),
                "only models with `breaks_at` break; give it, or plot another diagnostic, such as \"turned_over\"",
            ),
            Diagnostic::Residual => (
                has(&has_residual),
                "models without rotations, such as springs, have none; plot another diagnostic, such as \"turned_over\"",
            ),
            _ => return None,
        };
        (!exists).then_some(why)
    }
}

impl Run {
    /// All its bodies as one.
    pub fn body(&self) -> &Arc<Body> {
        self.bodies.whole()
    }

    /// The names of its bodies in order; none if its only body has no name.
    pub(crate) fn body_names<'a>(&'a self, scene: &'a Scene) -> impl Iterator<Item = &'a str> {
        self.of.iter().map(|&body| &*scene.bodies[body].name).filter(|name| !name.is_empty())
    }

    /// The name and the nodes of each of its bodies, if it has several.
    pub(crate) fn several<'a>(&'a self, scene: &'a Scene) -> impl Iterator<Item = (&'a str, Range<usize>)> + Clone {
        let bodies = if self.of.len() > 1 { self.of.len() } else { 0 };
        (0..bodies).map(|body| (&*scene.bodies[self.of[body]].name, self.bodies.nodes(body)))
    }

    /// Each model with its body.
    pub(crate) fn parts<'a>(&'a self, scene: &'a Scene) -> impl Iterator<Item = (&'a dyn ElasticModel, &'a SceneBody)> {
        self.models.iter().map(|model| &**model).zip(self.of.iter().map(|&body| &scene.bodies[body]))
    }

    /// Each model with its body at rest.
    pub(crate) fn models_and_bodies(&self) -> impl Iterator<Item = (&dyn ElasticModel, &Body)> {
        self.models.iter().map(|model| &**model).zip(self.bodies.bodies().iter().map(|body| &**body))
    }

    /// The shortest period of a node of any of its bodies (s).
    pub(crate) fn shortest_period(&self) -> f64 {
        self.models_and_bodies().map(|(model, body)| model.shortest_period(body)).fold(f64::INFINITY, f64::min)
    }
}

impl Scene {
    /// Whether its pictures need a graphics device: bodies in space are lit.
    #[cfg(feature = "render")]
    pub(crate) fn is_lit(&self) -> bool {
        self.dimension() == Dimension::Space
    }

    /// Fails if a row of a recording could not be read since the scene was loaded. The states shown are then wrong.
    #[cfg(feature = "render")]
    pub(crate) fn check_recordings(&self) -> io::Result<()> {
        self.runs.iter().filter_map(|run| run.recording.as_ref()).try_for_each(|recording| match recording.fault() {
            Some(what) => {
                Err(io::Error::new(io::ErrorKind::InvalidData, format!("{}: {what}", recording.path.display())))
            }
            None => Ok(()),
        })
    }

    /// Whether its bodies are in the plane or in space.
    pub(crate) fn dimension(&self) -> Dimension {
        self.bodies[0].body.dimension
    }

    /// Gives the runs their places, and the view the names of their bodies.
    fn place_runs(&mut self) {
        let chosen: Vec<_> = self.runs.iter().map(|run| run.colour).collect();
        let places = self.view.look.palette().places(&chosen);
        self.runs.iter_mut().zip(places).for_each(|(run, place)| run.place = place);
        self.view.bodies = self.names_of_bodies();
    }

    /// The names of the bodies by their places in runs; empty if no run has several bodies. Bodies of other runs at the same
    /// place are named, too.
    fn names_of_bodies(&self) -> Vec<String> {
        let most = self.runs.iter().map(|run| run.of.len()).max().filter(|&most| most > 1).unwrap_or(0);
        let at = |place: usize| {
            let mut names: Vec<&str> = Vec::new();
            for body in self.runs.iter().filter_map(|run| run.of.get(place)) {
                let name = self.bodies[*body].name.as_str();
                if !names.contains(&name) {
                    names.push(name);
                }
            }
            names.join(" / ")
        };
        (0..most).map(at).collect()
    }

    /// The message and help for an unknown run.
    pub(crate) fn no_run(&self, name: &str) -> (String, Option<String>) {
        let names: Vec<_> = self.runs.iter().map(|run| run.name.as_str()).collect();
        let all = list(&names, "and", |name| format!("“{name}”"));
        let help = nearest(name, &names).map(|near| format!("did you mean “{near}”?"));
        (format!("the scene “{}” has no run “{name}”; its runs are {all}", self.title), help)
    }

    /// The number of the last frame within the duration, `floor(duration · frames_per_second)`; frame 0 is the start. A frame that is later
    /// by round-off is within it: 0.1 s have six intervals at 60 frames a second.
    pub fn last_frame(&self) -> u64 {
        /// The error of durations that were computed, as a share.
        const ROUND_OFF: f64 = 1e-12;
        (self.duration * self.frames_per_second * (1.0 + ROUND_OFF)).floor() as u64
    }

    /// The nominal time of a frame (s).
    pub fn frame_time(&self, frame: u64) -> f64 {
        frame as f64 / self.frames_per_second
    }

    /// The moment that a frame shows.
    pub fn moment(&self, frame: u64) -> Moment {
        Moment { count: frame as f64, rate: self.frames_per_second }
    }

    /// The moment of the first row of `diagnostics.csv` after some steps of a run; `None` if there are only rows of frames.
    pub(crate) fn next_row(&self, run: usize, steps: u64) -> Option<Moment> {
        let step = self.runs[run].step;
        let every = self.every?.max(step);
        let row = |number: u64| Moment::at(number as f64 * every);
        // Of the first number with a later step, round-off may be on either side.
        let near = ((steps as f64 + 0.5) * step / every) as u64;
        (near..).map(row).find(|moment| moment.step(step) > steps)
    }

    /// The step of a run that a frame shows: `round(n / (frames_per_second · ΔT))`.
    pub fn frame_step(&self, run: usize, frame: u64) -> u64 {
        self.moment(frame).step(self.runs[run].step)
    }
}
