//! The body as typed.

use super::{Coordinates, Positive};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
pub(in crate::scene) struct BodyFile {
    /// A block of equal cubes, or of equal squares in the plane.
    pub(in crate::scene) lattice: Option<LatticeFile>,
    /// Rest position of each node (m). Two coordinates make a body in the plane, three one in space.
    #[schemars(length(min = 1))]
    pub(in crate::scene) nodes: Option<Vec<Coordinates>>,
    /// The nodes of each element, two or more, counted from 0. In the plane polygons, counter-clockwise; in space
    /// tetrahedra, pyramids, wedges, hexahedra (corners in bit order: x fastest, then y, then z) or anything else.
    #[schemars(length(min = 1), inner(length(min = 2)))]
    pub(in crate::scene) elements: Option<Vec<Vec<u32>>>,
    /// Pairs of nodes, for mass-spring models without a named topology.
    #[schemars(length(min = 1))]
    pub(in crate::scene) springs: Option<Vec<[u32; 2]>>,
    /// The nodes of each face to draw, counter-clockwise from outside. Default: the faces of the elements.
    #[schemars(inner(length(min = 3)))]
    pub(in crate::scene) faces: Option<Vec<Vec<u32>>>,
    /// Initial position of each node (m), before `rotation`, `offset` and `lowest`. Default: the rest positions.
    pub(in crate::scene) positions: Option<Vec<Coordinates>>,
    /// Initial velocity of each node (m/s), instead of one `velocity` for all. It is not turned by `rotation`.
    pub(in crate::scene) velocities: Option<Vec<Coordinates>>,
    /// Mass of each node (kg), instead of one `mass` for all.
    pub(in crate::scene) masses: Option<Vec<Positive>>,
    /// Mass of every node (kg). Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(in crate::scene) mass: Option<f64>,
    /// A turn about the mean of the nodes before the start.
    pub(in crate::scene) rotation: Option<RotationFile>,
    /// A shift after the turn (m). Default: none.
    pub(in crate::scene) offset: Option<Coordinates>,
    /// Height (m) at which the lowest node starts, along y, after turn and shift. Default: wherever those left it.
    pub(in crate::scene) lowest: Option<f64>,
    /// Initial velocity of all nodes (m/s). Default: at rest.
    pub(in crate::scene) velocity: Option<Coordinates>,
    /// A rigid spin at the start about the mean of the nodes, on top of all other velocities. Default: none.
    pub(in crate::scene) spin: Option<SpinFile>,
}

/// A rigid spin.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct SpinFile {
    /// The axis, of any length but zero, about which the spin is counter-clockwise when it points at the viewer. In
    /// the plane there is none.
    pub(in crate::scene) axis: Option<Coordinates>,
    /// The angular velocity (rad/s).
    pub(in crate::scene) rate: f64,
}

/// A block of equal cells standing on the level of the origin, its middle above (in the plane: at) the origin.
/// Nodes are numbered with x fastest, then y, then z.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct LatticeFile {
    /// How many cells along x, y and z; two numbers make squares in the plane.
    #[schemars(length(min = 2, max = 3), inner(range(min = 1, max = 4_000_000_000_u32)))]
    pub(in crate::scene) cells: Vec<u32>,
    /// Length of a cell's edge (m).
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(in crate::scene) side: f64,
}

/// A turn.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct RotationFile {
    /// The axis, of any length but zero, about which the turn is counter-clockwise when it points at the viewer. In
    /// the plane there is none.
    pub(in crate::scene) axis: Option<Coordinates>,
    /// The angle (rad).
    pub(in crate::scene) angle: f64,
}
