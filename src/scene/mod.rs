//! Scenes, from typed files to resolved values: every number is in SI units, every index is in range, and no field says
//! "use the default".

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

//!
//! `load` reads a scene file, `structure` checks it against the `schema` made from the types in `file`, and `resolve`
//! resolves it. All of them report mistakes to one `report`. Bodies come from `generate`, from the scene's own lists,
//! from a NumPy archive, read by `npz`, or from a `mesh`. Fonts are read by `font`.

mod builder;
mod charts;
mod digest;
#[cfg(feature = "render")]
mod drawn;
mod error;
pub(crate) mod figure;
mod file;
pub(crate) mod generate;
mod keys;
mod limits;
mod load;
pub(crate) mod measure;
pub(crate) mod mesh;
pub(crate) mod npy;
pub(crate) mod npz;
mod plausible;
mod recording;
pub(crate) mod reference;
mod resolve;
mod run;
mod schema;
mod sequence;
mod stability;
mod step;
mod structure;
mod summary;
mod syntax;
mod turning;
mod typed;
mod view;
mod world;

pub use crate::reading::captions::description;
pub use crate::reading::setting::Setting;
pub use crate::reading::{Mistake, Mistakes};
pub use builder::{
    BodyBuilder, ContactBuilder, LoadBuilder, NodeSet, ObstacleBuilder, PairBuilder, RegionBuilder, RunBuilder,
    SceneBuilder,
};
pub use error::SceneError;
pub use file::{Cells, Coordinates, Lattice, MotionPath, Rotation, Side, Start, StartShape, Swing, Up};
pub use keys::{BodyLists, SceneKeys};
pub use limits::Limits;
#[cfg(feature = "render")]
pub(crate) use load::{is_figure_file, keys_in_memory, keys_of};
pub use measure::{Probe, Reading};
pub use recording::Recorded;
pub(crate) use recording::{Archive, COURSE, Course, Flaw, Origin, StoredRun};
pub use run::{AtRest, Rest, Run};
pub use schema::schema;
pub use summary::{BodySummary, PartSummary, RunSummary, SceneSummary};
#[cfg(feature = "render")]
pub(crate) use turning::brakes_rotation;

use crate::look::View;
use crate::reading::words::{list, nearest, quoted};
use crate::sim::{Body, Contacts, Dimension, Moment, Obstacle, State};
use glam::DVec3;
use localshape_mesh::Group;
use std::io;
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
    /// Damping in proportion to masses (1/s); see [`Surroundings::mass_damping`](crate::sim::Surroundings::mass_damping).
    pub mass_damping: f64,
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
    /// The name of each obstacle; its place in the file, such as `obstacle[0]`, of one without a name.
    pub obstacle_names: Vec<String>,
    /// How surfaces meet, with bodies counted as in the scene; `None` if nodes meet obstacles and nothing else meets.
    pub contacts: Option<Contacts>,
    /// Nodes whose displacement is measured.
    pub probes: Vec<Probe>,
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
    /// The way (m) by which it was moved apart from what it overlapped (`contact.separate`).
    pub separated: DVec3,
    /// Mean length of its elements' edges (m).
    pub side: f64,
    /// Whether this length is the side of a lattice's cells.
    pub has_cells: bool,
    /// Springs listed by hand.
    pub(crate) springs: Option<Vec<[u32; 2]>>,
    /// Sets of nodes with a name.
    pub(crate) groups: Vec<Group>,
    /// Sets of points with a name, of the surface that it carries.
    pub(crate) surface_groups: Vec<Group>,
    /// Regions with a material of their own.
    pub regions: Vec<Region>,
}

/// A region of a body with a material of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Its name, unique in its body.
    pub name: String,
    /// Its elements in rising order.
    pub elements: Vec<u32>,
    /// Its modulus relative to that of the models, if it has one of its own.
    pub modulus: Option<f64>,
    /// Its density (kg/m³, in the plane kg/m²), if it has one of its own.
    pub density: Option<f64>,
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

/// Names without repetitions, in their order.
fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut distinct = Vec::new();
    names.for_each(|name| distinct.extend((!distinct.contains(&name)).then_some(name)));
    distinct
}

impl Scene {
    /// Whether its pictures need a graphics device: bodies in space are lit.
    #[cfg(feature = "render")]
    pub(crate) fn is_lit(&self) -> bool {
        self.dimension() == Dimension::Space
    }

    /// Fails if a row of a recording could not be read since the scene was loaded. The states shown are then wrong.
    pub fn check_recordings(&self) -> io::Result<()> {
        self.runs.iter().filter_map(|run| run.recording.as_ref()).try_for_each(|recording| match recording.fault() {
            Some(what) => {
                Err(io::Error::new(io::ErrorKind::InvalidData, format!("{}: {what}", recording.path.display())))
            }
            None => Ok(()),
        })
    }

    /// Whether its bodies are in the plane or in space.
    pub(crate) fn dimension(&self) -> Dimension {
        self.bodies[0].body.dimension()
    }

    /// Gives the runs their places, and the view the names of their bodies.
    fn place_runs(&mut self) {
        let lined: Vec<_> = self.runs.iter().map(Run::lined).collect();
        let places = self.view.look.palette().places(&lined);
        self.runs.iter_mut().zip(places).for_each(|(run, place)| run.place = place);
        self.view.bodies = self.names_of_bodies();
    }

    /// The names of the bodies by their places in runs, then of regions; empty if no run has several bodies and there are no regions. Bodies of
    /// other runs at the same place are named, too.
    fn names_of_bodies(&self) -> Vec<String> {
        let regions = self.names_of_regions();
        let most = self.most_bodies();
        if most == 1 && regions.is_empty() {
            return Vec::new();
        }
        let at = |place: usize| {
            let bodies = self.runs.iter().filter_map(|run| run.of.get(place));
            distinct(bodies.map(|&body| &*self.bodies[body].name)).join(" / ")
        };
        (0..most).map(at).chain(regions.into_iter().map(str::to_owned)).collect()
    }

    /// The number of bodies in the run with most of them.
    pub(crate) fn most_bodies(&self) -> usize {
        self.runs.iter().map(|run| run.of.len()).max().unwrap_or(1)
    }

    /// The names of the regions of all bodies. Regions of one name have one colour.
    pub(crate) fn names_of_regions(&self) -> Vec<&str> {
        distinct(self.bodies.iter().flat_map(|body| &body.regions).map(|region| &*region.name))
    }

    /// Whether an obstacle has an extent: all but half-spaces have one.
    fn has_solids(&self) -> bool {
        self.obstacles.iter().any(|one| !one.shape.is_half_space())
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

    /// The intervals over which forces of a run are averaged (s): between rows of `diagnostics.csv`, or else between frames.
    #[cfg(feature = "render")]
    pub(crate) fn interval(&self, run: usize) -> f64 {
        self.every.unwrap_or(1.0 / self.frames_per_second).max(self.runs[run].step)
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
