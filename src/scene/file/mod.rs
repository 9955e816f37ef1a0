//! The structs that scene files are read into. The schema made from them is the only list of keys: files are checked
//! against it, and `localshape schema` prints it with the documentation of their fields.
//!
//! A length is in metres, a time in seconds, a mass in kilograms, an angle in radians. Vectors have three coordinates
//! in space and two in the plane.

mod body;
mod contact;
mod load;
mod motion;
mod obstacle;
mod run;
mod time;

pub(in crate::scene) use body::{
    BarsFile, BodyFile, CellsFile, DiscFile, FillFile, FillKind, LISTS, PolygonFile, SideFile, SpinFile,
};
pub use body::{Cells, Lattice, Rotation, Start, StartShape, Up};
pub(in crate::scene) use contact::{ContactFile, ContactRule, PairFile};
pub(in crate::scene) use load::{AxialFile, LoadFile};
pub(in crate::scene) use motion::{GrabFile, HoldFile, KeyFile, NodesFile, ProbeFile, RegionFile};
pub use motion::{MotionPath, Side, Swing};
pub(in crate::scene) use obstacle::{ObstacleFile, ShapeFile};
pub(in crate::scene) use run::{ModelFile, RunFile, StatesFile};
pub(in crate::scene) use time::{EndFile, StartFile, StepFile, TimeFile};

use crate::look::View;
pub use crate::reading::coordinates::Coordinates;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// A `[view]` table as typed, of the right structure.
pub(in crate::scene) type TypedView = serde_json::Map<String, serde_json::Value>;

/// The largest accepted magnitude of a number (SI). Squares and volumes of larger ones leave the range of double
/// precision.
pub(super) const LARGEST: f64 = 1e30;

// A part with a mistake is `None`.
/// A scene: bodies, one world, and several runs.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct SceneFile {
    /// The subject of the scene. Default: the file's name.
    #[schemars(length(max = 200))]
    pub(in crate::scene) title: Option<String>,
    /// Acceleration of gravity (m/s²), such as `[0, -9.8, 0]`. Default: none.
    pub(in crate::scene) gravity: Option<Coordinates>,
    /// Damping in proportion to masses: Rayleigh's α (1/s), or a table with the damping ratio of an oscillation. The force on each node is `−α m V`,
    /// beside the damping of models. It brakes all motion, also that of a body as a whole. Default: none.
    pub(in crate::scene) mass_damping: Option<MassDamping>,
    /// Duration, time step and frame rate.
    #[schemars(with = "TimeFile")]
    pub(in crate::scene) time: Option<TimeFile>,
    /// The body, or several as `[[body]]`, each with a `name`. Several bodies are all in the plane or all in space. Their order is the order of rows in result files.
    #[serde(serialize_with = "body::written")]
    #[schemars(schema_with = "body::one_or_several")]
    pub(in crate::scene) body: Vec<Option<BodyFile>>,
    /// The runs, with one panel of the picture each.
    #[schemars(with = "Vec<RunFile>", length(min = 1, max = 256))]
    pub(in crate::scene) run: Vec<Option<RunFile>>,
    /// Obstacles that bodies collide with, in the order in which they act. Default: none.
    #[serde(default)]
    #[schemars(with = "Vec<ObstacleFile>")]
    pub(in crate::scene) obstacle: Vec<Option<ObstacleFile>>,
    /// How the surfaces of bodies meet. Default: as an empty table.
    pub(in crate::scene) contact: Option<ContactFile>,
    /// Nodes that are held in place. Default: none.
    #[serde(default)]
    #[schemars(with = "Vec<HoldFile>")]
    pub(in crate::scene) hold: Vec<Option<HoldFile>>,
    /// Nodes that are grabbed, dragged along a path and released. Default: none.
    #[serde(default)]
    #[schemars(with = "Vec<GrabFile>")]
    pub(in crate::scene) grab: Vec<Option<GrabFile>>,
    /// Forces on nodes and faces from outside. Default: none.
    #[serde(default)]
    #[schemars(with = "Vec<LoadFile>")]
    pub(in crate::scene) load: Vec<Option<LoadFile>>,
    /// Nodes with a name, whose displacement is in result files, and which charts can show. Default: none.
    #[serde(default)]
    #[schemars(with = "Vec<ProbeFile>")]
    pub(in crate::scene) probe: Vec<Option<ProbeFile>>,
    /// How the scene is drawn.
    #[serde(default)]
    #[schemars(with = "View")]
    pub(in crate::scene) view: TypedView,
}

/// A number greater than zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub(in crate::scene) struct Positive(#[schemars(extend("exclusiveMinimum" = 0))] pub(in crate::scene) f64);

/// Damping in proportion to masses as typed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(in crate::scene) enum MassDamping {
    /// `α` (1/s).
    Rate(#[schemars(range(min = 0.0))] f64),
    /// The damping ratio of an oscillation.
    Ratio(DampingRatio),
}

/// The damping ratio of an oscillation: `α = 4π ζ f`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct DampingRatio {
    /// The damping ratio `ζ`. With 1 the oscillation just vanishes.
    #[schemars(range(min = 0.0))]
    pub(in crate::scene) ratio: f64,
    /// The frequency `f` of the oscillation without damping (1/s).
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(in crate::scene) frequency: f64,
}

impl MassDamping {
    /// `α` (1/s).
    pub(in crate::scene) fn rate(self) -> f64 {
        match self {
            Self::Rate(rate) => rate,
            Self::Ratio(DampingRatio { ratio, frequency }) => 4.0 * PI * ratio * frequency,
        }
    }
}
