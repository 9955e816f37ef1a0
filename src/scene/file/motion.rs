//! Paths and kinematic constraints as typed.

use super::{Coordinates, Rotation};
use crate::sim::Ease;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A path of keyframes.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MotionPath {
    /// Keyframes with rising times, such as `[{ time = 0.2 }, { time = 0.5, shift = [0, -0.2, 0] }]`. The first pose
    /// holds before the first key, the last pose after the last.
    #[schemars(length(min = 1))]
    pub(in crate::scene) keys: Vec<KeyFile>,
    /// Interpolation between two keys.
    #[serde(default)]
    pub(in crate::scene) ease: Ease,
    /// Whether the path begins again at its last key, whose pose must be that of the first.
    #[serde(default)]
    pub(in crate::scene) repeat: bool,
}

/// A pose at a time, relative to the pose without a path.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct KeyFile {
    /// Time (s).
    #[schemars(range(min = 0.0))]
    pub(in crate::scene) time: f64,
    /// Translation (m). It does not carry over from the previous key. Default: none.
    pub(in crate::scene) shift: Option<Coordinates>,
    /// Rotation, about the centre unless `about` is given. Angles beyond 2π are several turns. It does not carry over
    /// from the previous key. Default: none.
    pub(in crate::scene) rotation: Option<Rotation>,
}

/// An oscillation: `sin(2π t / period + phase)` times a translation and a rotation.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Swing {
    /// Period (s).
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(in crate::scene) period: f64,
    /// Phase at the start (rad).
    #[serde(default)]
    pub(in crate::scene) phase: f64,
    /// Amplitude of the translation (m). Default: none.
    pub(in crate::scene) shift: Option<Coordinates>,
    /// Amplitude of the rotation, about the centre unless `about` is given. Default: none.
    pub(in crate::scene) rotation: Option<Rotation>,
}

/// Nodes that are held in place.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct HoldFile {
    /// The name of their body. Default: all bodies.
    pub(in crate::scene) body: Option<String>,
    /// The nodes: a list, which needs a `body` if there are several; a side of the rest shape of each body, `"left"` (least
    /// x), `"right"`, `"bottom"` (least y), `"top"`, `"back"` (least z) or `"front"`; a group of a mesh file by its name; or all
    /// nodes that start in a ball or an axis-aligned box. Nodes on the border belong to side and region, to 1e-9 of the body's
    /// longest side. `localshape check` prints where bodies start, and the groups of a mesh file.
    pub(in crate::scene) nodes: NodesFile,
    /// Start (s).
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub(in crate::scene) from: f64,
    /// End (s). Default: never.
    #[schemars(range(min = 0.0))]
    pub(in crate::scene) until: Option<f64>,
}

/// Nodes that are grabbed, dragged along a path and released.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct GrabFile {
    /// The name of their body. Default: all bodies.
    pub(in crate::scene) body: Option<String>,
    /// The nodes: a list, which needs a `body` if there are several; a side of the rest shape of each body, `"left"` (least
    /// x), `"right"`, `"bottom"` (least y), `"top"`, `"back"` (least z) or `"front"`; a group of a mesh file by its name; or all
    /// nodes that start in a ball or an axis-aligned box. Nodes on the border belong to side and region, to 1e-9 of the body's
    /// longest side. `localshape check` prints where bodies start, and the groups of a mesh file.
    pub(in crate::scene) nodes: NodesFile,
    /// The path along which the nodes are dragged. They are grabbed at the time of the first key, wherever they are.
    /// They follow the path's motion since that key, rotate about their centre, and are released at the last key.
    pub(in crate::scene) path: MotionPath,
}

/// Nodes whose displacement from where they are placed is measured: columns of `diagnostics.csv`, peaks in `run.json`.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct ProbeFile {
    /// Its name, which charts and columns use. No other probe, obstacle or body has it.
    #[schemars(length(min = 1, max = 80))]
    pub(in crate::scene) name: String,
    /// The name of their body. Default: all bodies.
    pub(in crate::scene) body: Option<String>,
    /// The nodes, as in `[[hold]]`.
    pub(in crate::scene) nodes: NodesFile,
}

/// Some nodes of bodies.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(in crate::scene) enum NodesFile {
    /// A list of nodes, counted from 0.
    List(#[schemars(length(min = 1))] Vec<u32>),
    /// The nodes of a side of the rest shape, or of a group of a mesh file.
    Named(#[schemars(length(min = 1))] String),
    /// All nodes that start in a region.
    Region(RegionFile),
}

/// A side of the rest shape of a body: the nodes with the least or greatest coordinate along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// The least x.
    Left,
    /// The greatest x.
    Right,
    /// The least y.
    Bottom,
    /// The greatest y.
    Top,
    /// The greatest z, towards the usual camera. Only in space.
    Front,
    /// The least z. Only in space.
    Back,
}

impl Side {
    /// All sides.
    pub(in crate::scene) const ALL: [Self; 6] =
        [Self::Left, Self::Right, Self::Bottom, Self::Top, Self::Front, Self::Back];
}

/// A region of space: a ball, or an axis-aligned box.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [{ "required": ["of", "within"] }, { "required": ["low", "high"] }]))]
pub(in crate::scene) struct RegionFile {
    /// Centre of a ball (m).
    pub(in crate::scene) of: Option<Coordinates>,
    /// Radius of the ball (m).
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(in crate::scene) within: Option<f64>,
    /// Lowest corner of a box (m).
    pub(in crate::scene) low: Option<Coordinates>,
    /// Highest corner of the box (m).
    pub(in crate::scene) high: Option<Coordinates>,
}
