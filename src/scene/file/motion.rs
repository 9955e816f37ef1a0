//! Paths and grips as typed.

use super::{Coordinates, Rotation};
use crate::sim::motion::Ease;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A path from key to key.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MotionPath {
    /// Where it is at which times, in rising order. Before the first key it is at the first, after the last at the last.
    #[schemars(length(min = 1))]
    pub(in crate::scene) keys: Vec<KeyFile>,
    /// How it runs between two keys: from rest to rest, so that it stops at every key, or at constant speed.
    #[serde(default)]
    pub(in crate::scene) ease: Ease,
    /// Whether the path begins again when its last key is reached, which must then be where the first one is.
    #[serde(default)]
    pub(in crate::scene) repeat: bool,
}

/// A place at a time, as a displacement from where the thing stands without a path.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct KeyFile {
    /// When (s).
    #[schemars(range(min = 0.0))]
    pub(in crate::scene) time: f64,
    /// The shift (m). Default: no shift, whatever the key before has.
    pub(in crate::scene) shift: Option<Coordinates>,
    /// The turn, about the middle unless `about` says otherwise. Angles beyond a whole turn go round more than once.
    /// Default: no turn, whatever the key before has.
    pub(in crate::scene) rotation: Option<Rotation>,
}

/// A motion to and fro: `sin(2π t / period + phase)` times a shift and a turn.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Swing {
    /// Duration of one swing to and fro (s).
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(in crate::scene) period: f64,
    /// Where in the swing it is at the start (rad).
    #[serde(default)]
    pub(in crate::scene) phase: f64,
    /// The farthest shift (m). Default: none.
    pub(in crate::scene) shift: Option<Coordinates>,
    /// The farthest turn, about the middle unless `about` says otherwise. Default: none.
    pub(in crate::scene) rotation: Option<Rotation>,
}

/// Nodes that are held where they are.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct HoldFile {
    /// The nodes.
    pub(in crate::scene) nodes: NodesFile,
    /// From when on (s).
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub(in crate::scene) from: f64,
    /// Until when (s). Default: for good.
    #[schemars(range(min = 0.0))]
    pub(in crate::scene) until: Option<f64>,
}

/// Nodes that are grabbed, dragged along a path and let go.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct GrabFile {
    /// The nodes.
    pub(in crate::scene) nodes: NodesFile,
    /// The way of the hand: it grabs the nodes at the time of the first key, wherever they are then, drags them as far
    /// as the hand has moved since, turning about their middle, and lets them go at the last key.
    pub(in crate::scene) path: MotionPath,
}

/// Some nodes of a body: a list, or those in a region at the start. `localshape check` prints where the body starts.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(in crate::scene) enum NodesFile {
    /// A list of nodes, counted from 0.
    List(#[schemars(length(min = 1))] Vec<u32>),
    /// Those that start in a region.
    Region(RegionFile),
}

/// A region of space: a ball, or a box along the axes. Nodes on its border belong to it, and so do those beyond it by no more
/// than round-off (1e-9 of the body's longest side).
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [{ "required": ["of", "within"] }, { "required": ["low", "high"] }]))]
pub(in crate::scene) struct RegionFile {
    /// The middle of a ball (m).
    pub(in crate::scene) of: Option<Coordinates>,
    /// The radius of the ball (m).
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(in crate::scene) within: Option<f64>,
    /// The lowest corner of a box (m).
    pub(in crate::scene) low: Option<Coordinates>,
    /// Its highest corner (m).
    pub(in crate::scene) high: Option<Coordinates>,
}
