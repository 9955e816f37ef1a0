//! What a scene file says, as typed. The field documentation below is what `localshape schema` prints, and the
//! schema made from these types is what files are checked against: there is no second list of keys.
//!
//! A length is in metres, a time in seconds, a mass in kilograms, an angle in radians. Vectors have three
//! coordinates in space and two in the plane.

use super::view::Theme;
use crate::sim::integrate::Integrator;
use crate::sim::model::ModelParameters;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A scene: one body, one world and several runs, each of which is one elastic model on that body.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneFile {
    /// What the scene shows, in a few words. Default: the file's name.
    #[schemars(length(max = 200))]
    pub(super) title: Option<String>,
    /// Acceleration of gravity (m/s²), such as `[0, -9.8, 0]`. Default: none.
    pub(super) gravity: Option<Coordinates>,
    /// How long, in which steps, and how often a frame is shown.
    pub(super) time: TimeFile,
    /// The body, the same in all runs.
    pub(super) body: BodyFile,
    /// The runs, at least one: each is one panel of the picture.
    #[schemars(length(min = 1, max = 256))]
    pub(super) run: Vec<RunFile>,
    /// What the body bounces off, in the order in which they act. Default: nothing.
    #[serde(default)]
    pub(super) obstacle: Vec<ObstacleFile>,
    /// How the scene is drawn.
    #[serde(default)]
    pub(super) view: ViewFile,
}

/// A point or a vector: three coordinates in space, two in the plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub(super) struct Coordinates(#[schemars(length(min = 2, max = 3))] pub(super) Vec<f64>);

/// A number greater than zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub(super) struct Positive(#[schemars(extend("exclusiveMinimum" = 0))] pub(super) f64);

/// How long a scene lasts and how its time is cut up.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct TimeFile {
    /// Simulated time (s); 0 shows the start alone.
    #[schemars(range(min = 0.0))]
    pub(super) duration: f64,
    /// Time step ΔT: seconds, or a fraction of the cycle T such as `"T/50"` or `"0.02 T"`. T = 2π√(m/k), with the
    /// smallest mass of a node and the largest stiffness of all runs, so that one step serves every run.
    #[serde(default)]
    pub(super) step: StepFile,
    /// Frames per second of simulated time (1/s).
    #[serde(default = "sixty")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(super) frames_per_second: f64,
    /// How positions and velocities move from one step to the next.
    #[serde(default)]
    pub(super) integrator: Integrator,
}

fn sixty() -> f64 {
    60.0
}

/// A time step as typed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(super) enum StepFile {
    /// A number of seconds.
    Seconds(#[schemars(extend("exclusiveMinimum" = 0))] f64),
    /// A fraction of the cycle T.
    Cycles(#[schemars(extend("format" = "fraction-of-T"))] super::step::FractionOfCycle),
}

impl Default for StepFile {
    fn default() -> Self {
        Self::Cycles(super::step::FractionOfCycle::Divided(50.0))
    }
}

/// The body: either a `lattice`, or `nodes` and `elements` listed one by one.
///
/// It starts as given, is turned by `rotation`, moved by `offset`, set down by `lowest` and thrown with `velocity`,
/// in this order. At rest it is never turned nor moved.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend(
    "oneOf" = [{ "required": ["lattice"] }, { "required": ["nodes", "elements"] }],
    "allOf" = [{ "not": { "required": ["mass", "masses"] } }, { "not": { "required": ["velocity", "velocities"] } }],
    "dependentRequired" = {
        "elements": ["nodes"], "springs": ["nodes"], "faces": ["nodes"],
        "positions": ["nodes"], "velocities": ["nodes"], "masses": ["nodes"]
    }
))]
pub(super) struct BodyFile {
    /// A block of equal cubes, or of equal squares in the plane.
    pub(super) lattice: Option<LatticeFile>,
    /// Rest position of each node (m). Two coordinates make a body in the plane, three one in space.
    #[schemars(length(min = 1))]
    pub(super) nodes: Option<Vec<Coordinates>>,
    /// The nodes of each element, two or more, counted from 0. In the plane polygons, counter-clockwise; in space
    /// tetrahedra, pyramids, wedges, hexahedra (corners in bit order: x fastest, then y, then z) or anything else.
    #[schemars(length(min = 1), inner(length(min = 2)))]
    pub(super) elements: Option<Vec<Vec<u32>>>,
    /// Pairs of nodes, for mass-spring models without a named topology.
    #[schemars(length(min = 1))]
    pub(super) springs: Option<Vec<[u32; 2]>>,
    /// The nodes of each face to draw, counter-clockwise from outside. Default: the faces of the elements.
    #[schemars(inner(length(min = 3)))]
    pub(super) faces: Option<Vec<Vec<u32>>>,
    /// Initial position of each node (m), before `rotation`, `offset` and `lowest`. Default: the rest positions.
    pub(super) positions: Option<Vec<Coordinates>>,
    /// Initial velocity of each node (m/s), instead of one `velocity` for all. It is not turned by `rotation`.
    pub(super) velocities: Option<Vec<Coordinates>>,
    /// Mass of each node (kg), instead of one `mass` for all.
    pub(super) masses: Option<Vec<Positive>>,
    /// Mass of every node (kg). Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(super) mass: Option<f64>,
    /// A turn about the mean of the nodes before the start.
    pub(super) rotation: Option<RotationFile>,
    /// A shift after the turn (m). Default: none.
    pub(super) offset: Option<Coordinates>,
    /// Height (m) at which the lowest node starts, along y, after turn and shift. Default: wherever those left it.
    pub(super) lowest: Option<f64>,
    /// Initial velocity of all nodes (m/s). Default: at rest.
    pub(super) velocity: Option<Coordinates>,
}

/// A block of equal cells standing on the level of the origin, its middle above (in the plane: at) the origin.
/// Nodes are numbered with x fastest, then y, then z.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct LatticeFile {
    /// How many cells along x, y and z; two numbers make squares in the plane.
    #[schemars(length(min = 2, max = 3), inner(range(min = 1, max = 4_000_000_000_u32)))]
    pub(super) cells: Vec<u32>,
    /// Length of a cell's edge (m).
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(super) side: f64,
}

/// A turn.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RotationFile {
    /// The axis, of any length but zero, about which the turn is counter-clockwise when it points at the viewer. In
    /// the plane there is none.
    pub(super) axis: Option<Coordinates>,
    /// The angle (rad).
    pub(super) angle: f64,
}

/// One run: a model on the scene's body.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RunFile {
    /// Its name, shown over its panel and used by `--only` and in result files: different from all others.
    #[schemars(length(min = 1, max = 80))]
    pub(super) name: String,
    /// The elastic model and its parameters.
    pub(super) model: ModelParameters,
    /// Time step of this run alone, written like that of `[time]` and with the same T. Default: that of `[time]`.
    pub(super) step: Option<StepFile>,
    /// Integrator of this run alone. Default: that of `[time]`.
    pub(super) integrator: Option<Integrator>,
}

/// Something rigid that nodes bounce off.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub(super) enum ObstacleFile {
    /// A plane with everything behind it filled.
    Floor(FloorFile),
}

/// A plane with everything behind it filled.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FloorFile {
    /// Direction out of the floor, of any length but zero. Default: up, along y.
    pub(super) normal: Option<Coordinates>,
    /// Distance of the surface from the origin along `normal` (m).
    #[serde(default)]
    pub(super) height: f64,
    /// Restitution coefficient e: the part of the normal velocity that a rebound gives back.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub(super) restitution: f64,
    /// Friction coefficient μ.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub(super) friction: f64,
}

/// How a scene is drawn.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ViewFile {
    /// Width and height of the picture (px).
    #[schemars(inner(range(min = 16, max = 16384)))]
    pub(super) size: [u32; 2],
    /// The colours.
    pub(super) theme: Theme,
    /// What the clock counts from, in the words shown under the time.
    #[schemars(length(max = 80))]
    pub(super) clock: String,
    /// How many panels stand beside each other. Default: all of them, up to 3; never more than there are runs.
    #[schemars(range(min = 1, max = 64))]
    pub(super) columns: Option<u32>,
    /// From where the scene is seen.
    pub(super) camera: CameraFile,
}

impl Default for ViewFile {
    fn default() -> Self {
        Self {
            size: [1280, 720],
            theme: Theme::default(),
            clock: "after release".into(),
            columns: None,
            camera: CameraFile::default(),
        }
    }
}

/// A perspective camera that looks at a point. A body in the plane is looked at straight from the front.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct CameraFile {
    /// Turn to the right around the vertical, from looking along −z (rad). Default: 0.541, which is 31°. Not in the
    /// plane.
    pub(super) azimuth: Option<f64>,
    /// Height above the horizon (rad), less than a quarter turn (1.57) either way. Default: 0.297, which is 17°. Not in
    /// the plane.
    #[schemars(extend("exclusiveMinimum" = -1.57, "exclusiveMaximum" = 1.57))]
    pub(super) elevation: Option<f64>,
    /// Vertical field of view (rad). Default: 0.349, which is 20°.
    #[schemars(range(min = 0.001, max = 3.0))]
    pub(super) field_of_view: Option<f64>,
    /// The point looked at (m). Default: the middle of the body as it would stand on the first floor below it, or
    /// where it starts if there is none.
    pub(super) target: Option<Coordinates>,
    /// Distance from that point (m). Default: 8.5 times the largest side of the box around the body at the start, and
    /// more if the body starts higher than that shows.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(super) distance: Option<f64>,
    /// Whether the camera rises and draws back with the highest body shown, alike in all panels. Where there is no
    /// floor to stand on, it sinks with the lowest.
    pub(super) follow: bool,
}
