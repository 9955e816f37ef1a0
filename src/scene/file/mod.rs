//! The structs that scene files are read into. The schema made from them is the only list of keys: files are checked
//! against it, and `localshape schema` prints it with the documentation of their fields.
//!
//! A length is in metres, a time in seconds, a mass in kilograms, an angle in radians. Vectors have three coordinates
//! in space and two in the plane.

mod body;
mod motion;
mod obstacle;

pub(in crate::scene) use body::{
    BarsFile, BodyFile, DiscFile, FillFile, FillKind, LISTS, PolygonFile, SideFile, SpinFile,
};
pub use body::{Cells, Lattice, Rotation, Start, StartShape, Up};
pub(in crate::scene) use motion::{GrabFile, HoldFile, KeyFile, NodesFile, RegionFile};
pub use motion::{MotionPath, Side, Swing};
pub(in crate::scene) use obstacle::{ObstacleFile, ShapeFile};

use super::step::NamedStep;
use super::structure::Checked;
use crate::look::typed::TypedColour;
use crate::look::{TypedView, View};
use crate::reading::collector::{Collector, PathPart, key_path};
pub use crate::reading::coordinates::Coordinates;
use crate::sim::model::{ElasticModel, Misfit, ModelParameters};
use crate::sim::{Body, Integrator, Kernel};
use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize, Serializer};
use serde_json::{Map, Value as Json};
use std::collections::BTreeMap;
use std::slice;
use std::sync::Arc;

/// The largest accepted magnitude of a number (SI). Squares and volumes of larger ones leave the range of double
/// precision.
pub(super) const LARGEST: f64 = 1e30;

/// A scene: bodies, one world, and several runs. A part with a mistake is `None`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct SceneFile {
    /// The subject of the scene. Default: the file's name.
    #[schemars(length(max = 200))]
    pub(in crate::scene) title: Option<String>,
    /// Acceleration of gravity (m/s²), such as `[0, -9.8, 0]`. Default: none.
    pub(in crate::scene) gravity: Option<Coordinates>,
    /// Duration, time step and frame rate.
    #[schemars(with = "TimeFile")]
    pub(in crate::scene) time: Option<TimeFile>,
    /// The body, or several as `[[body]]`, each with a `name`. Several bodies are all in the plane or all in space. They go
    /// through each other. Their order is the order of rows in result files.
    #[serde(serialize_with = "body::written")]
    #[schemars(schema_with = "body::one_or_several")]
    pub(in crate::scene) body: Vec<Option<BodyFile>>,
    /// The runs, with one panel of the picture each.
    #[schemars(with = "Vec<RunFile>", length(min = 1, max = 256))]
    pub(in crate::scene) run: Vec<Option<RunFile>>,
    /// Obstacles that nodes collide with, in the order in which they act. Default: none.
    #[serde(default)]
    #[schemars(with = "Vec<ObstacleFile>")]
    pub(in crate::scene) obstacle: Vec<Option<ObstacleFile>>,
    /// Nodes that are held in place. Default: none.
    #[serde(default)]
    #[schemars(with = "Vec<HoldFile>")]
    pub(in crate::scene) hold: Vec<Option<HoldFile>>,
    /// Nodes that are grabbed, dragged along a path and released. Default: none.
    #[serde(default)]
    #[schemars(with = "Vec<GrabFile>")]
    pub(in crate::scene) grab: Vec<Option<GrabFile>>,
    /// How the scene is drawn.
    #[serde(default)]
    #[schemars(with = "View")]
    pub(in crate::scene) view: TypedView,
}

impl SceneFile {
    /// The parts of a checked file that have no mistakes.
    pub(in crate::scene) fn of(checked: &Checked, report: &mut Collector<'_>) -> Self {
        let parts = &checked.parts;
        let body = match parts.get("body") {
            Some(Json::Array(_)) => entries(parts, "body", report),
            _ => vec![part(parts, "body", report)],
        };
        Self {
            title: part(parts, "title", report),
            gravity: part(parts, "gravity", report),
            time: part(parts, "time", report),
            body,
            run: entries(parts, "run", report),
            obstacle: entries(parts, "obstacle", report),
            hold: entries(parts, "hold", report),
            grab: entries(parts, "grab", report),
            view: part(parts, "view", report).unwrap_or_default(),
        }
    }

    /// Leaves out the parts in which a check of this scene found mistakes.
    pub(in crate::scene) fn drop_mistakes(&mut self, checked: &Checked) {
        fn drop<T>(entries: &mut [Option<T>], key: &str, checked: &Checked) {
            for (at, entry) in entries.iter_mut().enumerate() {
                let is_flawed = match checked.parts.get(key) {
                    Some(Json::Array(parts)) => parts.get(at).is_none_or(Json::is_null),
                    _ => checked.flawed.contains(key),
                };
                *entry = entry.take().filter(|_| !is_flawed);
            }
        }
        drop(slice::from_mut(&mut self.time), "time", checked);
        drop(&mut self.body, "body", checked);
        drop(&mut self.run, "run", checked);
        drop(&mut self.obstacle, "obstacle", checked);
        drop(&mut self.hold, "hold", checked);
        drop(&mut self.grab, "grab", checked);
        self.gravity = self.gravity.take().filter(|_| !checked.flawed.contains("gravity"));
        if checked.flawed.contains("view") {
            self.view = TypedView::default();
        }
    }
}

/// The part of a file at a key.
fn part<T: DeserializeOwned>(parts: &Map<String, Json>, key: &str, report: &mut Collector<'_>) -> Option<T> {
    typed(parts.get(key)?, &key_path![key], report)
}

/// The entries of a list in a file.
fn entries<T: DeserializeOwned>(parts: &Map<String, Json>, key: &str, report: &mut Collector<'_>) -> Vec<Option<T>> {
    let entries = parts.get(key).and_then(Json::as_array).into_iter().flatten().enumerate();
    entries.map(|(at, entry)| typed(entry, &key_path![key, at], report)).collect()
}

/// A checked value at a path of a file as its type; `None` after a mistake in it.
pub(in crate::scene) fn typed<T: DeserializeOwned>(
    checked: &Json,
    path: &[PathPart<'_>],
    report: &mut Collector<'_>,
) -> Option<T> {
    let known = report.total();
    // A required key may be missing after a mistake. Otherwise the schema has accepted the value, and an error of the
    // types is unexpected.
    let unexpected = |error: serde_json::Error| {
        if known == 0 {
            report.at(path, error.to_string(), None)
        }
    };
    T::deserialize(checked).map_err(unexpected).ok().filter(|_| !checked.is_null())
}

/// A number greater than zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub(in crate::scene) struct Positive(#[schemars(extend("exclusiveMinimum" = 0))] pub(in crate::scene) f64);

/// Duration, time step and frame rate of a scene.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct TimeFile {
    /// Simulated time (s); 0 shows only the start.
    #[schemars(range(min = 0.0))]
    pub(in crate::scene) duration: f64,
    /// Time step ΔT: seconds, a fraction of the cycle T such as `"T/50"` or `"0.02 T"`, or `"auto"`. T = 2π√(m/k), with
    /// the mass of the lightest node and the largest stiffness of all bodies and runs; of `volume-springs` that of a spring or that of
    /// an element against changes of its volume. `"auto"` takes equal steps between two
    /// frames, at most half of the largest step that is predicted to be stable for every run without a step of its own.
    /// `localshape check` prints that prediction. `xpbd`, stable with any step, takes at most 1/1200 s.
    #[schemars(extend("default" = "T/50"))]
    pub(in crate::scene) step: Option<StepFile>,
    /// The error allowed in each step of `integrator = "dormand-prince"`, as a share of the size of the body, in place
    /// of `step`. Below 1e-11 round-off is larger. For a body at rest on an obstacle, a tenth of the tolerance takes three times as long. Default: 1e-6.
    #[schemars(range(min = 1e-11, max = 0.1))]
    pub(in crate::scene) tolerance: Option<f64>,
    /// Frames per second of simulated time (1/s). Frames lie within the duration: 1 s has frames 0 to 29 at 29.97 a second.
    #[serde(default = "sixty")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(in crate::scene) frames_per_second: f64,
    /// Time between rows of `diagnostics.csv` (s), which then has rows between frames, of the nearest steps. With the time
    /// step or less each step has a row, which takes several times as long as a step. Default: only frames have rows.
    pub(in crate::scene) every: Option<Positive>,
    /// The integrator, which advances positions and velocities by one step.
    #[serde(default)]
    pub(in crate::scene) integrator: Integrator,
}

fn sixty() -> f64 {
    60.0
}

/// A time step as typed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(in crate::scene) enum StepFile {
    /// A time step in seconds, or a fraction of the cycle T such as `"T/50"`.
    Seconds(#[schemars(extend("exclusiveMinimum" = 0))] f64),
    /// A fraction of the cycle T, or `auto`.
    Named(#[schemars(extend("format" = "fraction-of-T"))] NamedStep),
}

impl StepFile {
    /// The step of a scene that gives none.
    pub(in crate::scene) const DEFAULT: Self = Self::Named(NamedStep::Divided(50.0));
}

/// One run: bodies of the scene with their models.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [{ "required": ["model"] }, { "required": ["models"] }, { "required": ["states"] }]))]
#[schemars(extend("allOf" = [
    { "not": { "required": ["states", "step"] } },
    { "not": { "required": ["states", "tolerance"] } },
    { "not": { "required": ["states", "integrator"] } },
    { "not": { "required": ["states", "kernel"] } },
]), extend("dependentRequired" = { "scale": ["states"], "up": ["states"] }))]
pub(in crate::scene) struct RunFile {
    /// Unique name, shown above the panel and used by `--only` and in result files.
    #[schemars(length(min = 1, max = 80))]
    pub(in crate::scene) name: String,
    /// The names of the bodies of this run, such as `["coarse"]`. So the same thing in another discretisation stands beside
    /// it. The order of names does not matter. Default: all bodies of the scene.
    #[schemars(length(min = 1))]
    pub(in crate::scene) bodies: Option<Vec<String>>,
    /// The elastic model of all bodies of the run, and its parameters. Each run has `model` or `models`.
    #[serde(skip_serializing_if = "is_unwritten")]
    #[schemars(with = "Option<ModelParameters>")]
    pub(in crate::scene) model: Option<ModelFile>,
    /// The elastic model of each body of the run by its name, in place of `model`: `{ cube = { kind = "shape-based",
    /// stiffness = 1e4 }, ball = { kind = "mass-spring", stiffness = 1e4 } }`.
    #[serde(serialize_with = "write_models")]
    #[schemars(with = "Option<BTreeMap<String, ModelParameters>>")]
    pub(in crate::scene) models: Option<BTreeMap<String, ModelFile>>,
    /// States that another program computed, in place of `model`: a NumPy archive beside the scene, such as
    /// `"mujoco.npz"`, or `{ file = "states.npz", run = "Local shape" }` for one of several runs in it. Also ParaView's lists of files,
    /// such as `"soft.pvd"`, and numbered files, such as `"frames/*.obj"`. Between recorded
    /// moments nodes move linearly in time. The run ends with the recording. `docs/recordings.md` tells what is in the files.
    pub(in crate::scene) states: Option<StatesFile>,
    /// Length of the unit of `states` (m), such as 0.001 for millimetres. Velocities are scaled, too.
    #[schemars(extend("default" = 1.0))]
    pub(in crate::scene) scale: Option<Positive>,
    /// The axis of `states` that points up. Scenes have y up, and MuJoCo, Isaac and Newton have z. Velocities are turned, too.
    #[schemars(extend("default" = "y"))]
    pub(in crate::scene) up: Option<Up>,
    /// Time step of this run, with the T of `[time]`. `"auto"` uses the prediction of this run alone. Default: that of
    /// `[time]`.
    pub(in crate::scene) step: Option<StepFile>,
    /// Tolerance of this run, in place of `step`. Default: that of `[time]`.
    #[schemars(range(min = 1e-11, max = 0.1))]
    pub(in crate::scene) tolerance: Option<f64>,
    /// Integrator of this run. Default: that of `[time]`.
    pub(in crate::scene) integrator: Option<Integrator>,
    /// The code that computes a step. The choice moves states by round-off, which chaotic motion enlarges. Default:
    /// `fast` where the model has it, else `reference`.
    pub(in crate::scene) kernel: Option<Kernel>,
    /// The colour of the run's curves, paths, forces and line beside its name: hexadecimal such as `"#0072b2"`, or a CSS name
    /// such as `"teal"`. Its contrast with the background must be at least 3, and its difference from turned-over
    /// elements at least 20 (CIEDE2000), also with colour blindness. Several runs may share a colour: names stand
    /// at the ends of curves. Default: a colour for each of the first eight runs that differs from all others.
    pub(in crate::scene) colour: Option<TypedColour>,
}

/// The recorded states of a run.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(in crate::scene) enum StatesFile {
    /// An archive beside the scene.
    File(#[schemars(length(min = 1))] String),
    /// One of several runs in an archive.
    OfRun(ChosenStates),
}

/// One of several runs in an archive.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct ChosenStates {
    /// The archive beside the scene.
    #[schemars(length(min = 1))]
    pub(in crate::scene) file: String,
    /// The run: NAME of the arrays `NAME.position` and so on. Default: the arrays without a name, the only run, or the one
    /// called like the run that shows it.
    pub(in crate::scene) run: Option<String>,
}

/// What moves the bodies of a run.
#[derive(Clone, Copy, Debug)]
pub(in crate::scene) enum RunSource<'a> {
    /// One model for all of them.
    Model(&'a ModelFile),
    /// A model for each, by name.
    Models(&'a BTreeMap<String, ModelFile>),
    /// A recording.
    States,
}

impl RunFile {
    /// What moves its bodies; `None` after a mistake.
    pub(in crate::scene) fn source(&self) -> Option<RunSource<'_>> {
        let model = self.model.as_ref().map(RunSource::Model);
        let models = || self.models.as_ref().map(RunSource::Models);
        model.or_else(models).or_else(|| self.states.as_ref().map(|_| RunSource::States))
    }

    /// Whether it has a model of the caller's own.
    pub(in crate::scene) fn has_own_model(&self) -> bool {
        self.model.iter().chain(self.models.iter().flat_map(BTreeMap::values)).any(ModelFile::is_own)
    }
}

/// Whether a file would have no model: none is given, or one of the caller's own.
fn is_unwritten(model: &Option<ModelFile>) -> bool {
    model.as_ref().is_none_or(ModelFile::is_own)
}

/// Writes models by name, without those of the caller's own.
fn write_models<S: Serializer>(models: &Option<BTreeMap<String, ModelFile>>, to: S) -> Result<S::Ok, S::Error> {
    match models {
        None => to.serialize_none(),
        Some(models) => to.collect_map(models.iter().filter(|(_, model)| !model.is_own())),
    }
}

/// The elastic model of a body.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(untagged, from = "ModelParameters")]
pub(in crate::scene) enum ModelFile {
    /// A model of this crate.
    Typed(ModelParameters),
    /// A model of the caller's own, in a scene made in code.
    #[serde(skip)]
    Own(Arc<dyn ElasticModel>),
}

impl From<ModelParameters> for ModelFile {
    fn from(parameters: ModelParameters) -> Self {
        Self::Typed(parameters)
    }
}

impl ModelFile {
    /// Whether it is a model of the caller's own.
    pub(in crate::scene) fn is_own(&self) -> bool {
        matches!(self, Self::Own(_))
    }

    /// The most springs of the model on a body, by the number of elements with each number of nodes and of listed
    /// springs.
    pub(in crate::scene) fn most_springs(&self, elements: &BTreeMap<usize, u128>, listed: Option<u128>) -> u128 {
        match self {
            Self::Typed(parameters) => parameters.most_springs(elements, listed),
            Self::Own(model) => model.springs().len() as u128,
        }
    }

    /// The model for a body, with the springs that the scene lists.
    pub(in crate::scene) fn resolve(
        &self,
        body: &Body,
        springs: Option<&[[u32; 2]]>,
    ) -> Result<Arc<dyn ElasticModel>, Misfit> {
        match self {
            Self::Typed(parameters) => parameters.resolve(body, springs),
            Self::Own(model) => check_own(&**model, body).map(|()| Arc::clone(model)),
        }
    }
}

/// Checks the properties of a model of the caller's own.
fn check_own(model: &dyn ElasticModel, body: &Body) -> Result<(), Misfit> {
    let misfit = |key, message: String| Err(Misfit { key, message });
    let (stiffness, nodes) = (model.stiffness(), body.len());
    if !(stiffness > 0.0 && stiffness <= LARGEST) {
        let message =
            format!("the stiffness of the model is {stiffness}; expected a number greater than 0, up to {LARGEST:e}");
        return misfit("stiffness", message);
    }
    match model.springs().iter().position(|spring| spring.iter().any(|&node| node as usize >= nodes)) {
        Some(at) => {
            let [a, b] = model.springs()[at];
            let message =
                format!("spring {at} of the model joins the nodes {a} and {b}; the body has nodes 0 to {}", nodes - 1);
            misfit("springs", message)
        }
        None => Ok(()),
    }
}
