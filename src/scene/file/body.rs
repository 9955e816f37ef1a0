//! The body as typed.

use super::{Coordinates, Positive};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::mem::swap;

/// The body: a `lattice`, a `polygon`, a `fan`, a `disc` or `bars`, or `nodes` and `elements` listed one by one, here or in
/// a `file`.
///
/// It starts as given, is turned by `rotation`, moved by `offset`, set down by `lowest` and thrown with `velocity`,
/// in this order. At rest it is never turned nor moved.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend(
    "oneOf" = [
        { "required": ["lattice"] }, { "required": ["polygon"] }, { "required": ["fan"] }, { "required": ["disc"] },
        { "required": ["bars"] }, { "required": ["nodes", "elements"] }, { "required": ["file"] }
    ],
    "allOf" = [
        { "not": { "required": ["mass", "masses"] } }, { "not": { "required": ["velocity", "velocities"] } },
        { "not": { "required": ["positions", "start"] } }
    ],
    "dependentRequired" = {
        "elements": ["nodes"], "springs": ["nodes"], "faces": ["nodes"],
        "positions": ["nodes"], "velocities": ["nodes"], "masses": ["nodes"]
    }
))]
pub(in crate::scene) struct BodyFile {
    /// A block of equal cubes, or of equal squares in the plane, whole or cut into other elements. It stands on y = 0, and
    /// its middle is at x = 0 and z = 0.
    pub(in crate::scene) lattice: Option<Lattice>,
    /// One regular polygon in the plane as a single element. It stands with a side on y = 0, its middle above the origin.
    pub(in crate::scene) polygon: Option<PolygonFile>,
    /// A regular polygon in the plane, cut into triangles around a node in its middle. It stands like a `polygon`.
    pub(in crate::scene) fan: Option<PolygonFile>,
    /// A disc in the plane: triangles around its middle, and rings of quadrilaterals around them. It stands like a
    /// `polygon`.
    pub(in crate::scene) disc: Option<DiscFile>,
    /// Two-node elements end to end, beginning at the origin.
    pub(in crate::scene) bars: Option<BarsFile>,
    /// Rest position of each node (m). Two coordinates make a body in the plane, three one in space.
    #[schemars(length(min = 1))]
    pub(in crate::scene) nodes: Option<Vec<Coordinates>>,
    /// The nodes of each element, two or more, counted from 0. In the plane polygons, counter-clockwise; in space
    /// tetrahedra and pyramids (the base counter-clockwise seen from the last node), wedges (two triangles, both
    /// counter-clockwise seen from the second), hexahedra (corners in bit order: x fastest, then y, then z) or, with any
    /// other number of nodes in any order, whatever their convex hull is; see also `convex`.
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
    /// A shape without depth, turned inside out or at random in which the body starts instead of its own. Default: its
    /// own.
    pub(in crate::scene) start: Option<Start>,
    /// Initial velocity of each node (m/s), instead of one `velocity` for all. It is not turned by `rotation`.
    pub(in crate::scene) velocities: Option<Vec<Coordinates>>,
    /// Mass of each node (kg), instead of one `mass` for all.
    pub(in crate::scene) masses: Option<Vec<Positive>>,
    /// A NumPy archive (.npz) beside the scene, with the arrays `nodes` and `elements` and, if wanted, `springs`, `faces`,
    /// `positions`, `velocities` and `masses`, which mean what these keys do. Coordinates and masses are float64 or
    /// float32; the indices are whole numbers, with -1 in places that a short element or face does not use.
    #[schemars(length(min = 1))]
    pub(in crate::scene) file: Option<String>,
    /// Whether elements in space are the convex hulls of their nodes, listed in any order: octahedra, bipyramids, flat
    /// quadrilaterals of a cloth. Otherwise elements of four, five, six and eight nodes are tetrahedra, pyramids, wedges
    /// and hexahedra.
    #[serde(default)]
    pub(in crate::scene) convex: bool,
    /// Mass of every node (kg). Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(in crate::scene) mass: Option<f64>,
    /// A turn about the mean of the nodes before the start. Default: none.
    pub(in crate::scene) rotation: Option<Rotation>,
    /// A shift after the turn (m). Default: none.
    pub(in crate::scene) offset: Option<Coordinates>,
    /// Height (m) at which the lowest node starts, along y, after turn and shift. Default: wherever those left it.
    pub(in crate::scene) lowest: Option<f64>,
    /// Initial velocity of all nodes (m/s). Default: at rest.
    pub(in crate::scene) velocity: Option<Coordinates>,
    /// A rigid spin at the start about the mean of the nodes, on top of all other velocities. Default: none.
    pub(in crate::scene) spin: Option<SpinFile>,
}

impl BodyFile {
    /// Exchanges all lists with those of another body.
    pub(in crate::scene) fn swap_lists(&mut self, other: &mut Self) {
        swap(&mut self.nodes, &mut other.nodes);
        swap(&mut self.elements, &mut other.elements);
        swap(&mut self.springs, &mut other.springs);
        swap(&mut self.faces, &mut other.faces);
        swap(&mut self.positions, &mut other.positions);
        swap(&mut self.velocities, &mut other.velocities);
        swap(&mut self.masses, &mut other.masses);
    }

    /// Takes all lists out. A single valid entry stands for each that has any.
    pub(in crate::scene) fn take_lists(&mut self) -> Self {
        fn short<T>(list: &Option<Vec<T>>, entry: T) -> Option<Vec<T>> {
            list.as_ref().map(|list| list.first().map(|_| entry).into_iter().collect())
        }
        let point = || Coordinates(vec![0.0; 2]);
        let mut lists = Self {
            nodes: short(&self.nodes, point()),
            elements: short(&self.elements, vec![0; 2]),
            springs: short(&self.springs, [0; 2]),
            faces: short(&self.faces, vec![0; 3]),
            positions: short(&self.positions, point()),
            velocities: short(&self.velocities, point()),
            masses: short(&self.masses, Positive(1.0)),
            ..Self::default()
        };
        self.swap_lists(&mut lists);
        lists
    }
}

/// A start from which bodies seldom come back, around the middle of the nodes at rest.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Start {
    /// Whether all nodes are at a `point`, on a `line` or in a `plane`, each as near as can be to where it is at rest; or
    /// in a `mirror-image`; or at random places in the box around the body, a `cloud`.
    pub(in crate::scene) shape: StartShape,
    /// Where the line leads, or where plane and mirror face, at any length but zero. Points and clouds have none.
    /// Default: along x.
    pub(in crate::scene) direction: Option<Coordinates>,
    /// Chooses among random clouds; nothing else has one. The same seed makes the same cloud everywhere.
    #[serde(default = "first", skip_serializing_if = "is_first")]
    #[schemars(range(min = 0, max = 4_294_967_295_u32))]
    pub(in crate::scene) seed: u32,
}

/// What a body becomes at its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum StartShape {
    /// All nodes at one place.
    Point,
    /// All nodes on a straight line.
    Line,
    /// All nodes in a plane.
    Plane,
    /// Turned inside out.
    MirrorImage,
    /// Random places.
    Cloud,
}

impl StartShape {
    /// As scenes call it.
    pub(in crate::scene) fn name(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Line => "line",
            Self::Plane => "plane",
            Self::MirrorImage => "mirror-image",
            Self::Cloud => "cloud",
        }
    }

    /// Whether it leads or faces anywhere.
    pub(in crate::scene) fn has_direction(self) -> bool {
        matches!(self, Self::Line | Self::Plane | Self::MirrorImage)
    }

    /// Whether there are many of it.
    pub(in crate::scene) fn is_random(self) -> bool {
        self == Self::Cloud
    }
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

/// A block of equal cells. It stands on y = 0, and its middle is at x = 0 and z = 0: six cells of 0.1 m along x reach from
/// -0.3 m to 0.3 m. Nodes are numbered with x fastest, then y, then z.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Lattice {
    /// How many cells along x, y and z; two numbers make squares in the plane.
    #[schemars(length(min = 2, max = 3), inner(range(min = 1, max = 4_000_000_000_u32)))]
    pub(in crate::scene) cells: Vec<u32>,
    /// Length of a cell's edge (m): one number, or one for each axis.
    pub(in crate::scene) side: SideFile,
    /// What the cells are: the elements themselves, or cut or joined to others.
    #[serde(default)]
    pub(in crate::scene) elements: Cells,
    /// Nodes are moved at random by up to this part of a cell's shortest side. Those on the outside move only within it
    /// and the corners not at all, so that the block keeps its shape; less far where an element would come out flat.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 0.4))]
    pub(in crate::scene) irregular: f64,
    /// Chooses among the random blocks that `irregular` and `mixed` allow. The same seed makes the same block everywhere.
    #[serde(default = "first")]
    #[schemars(range(min = 0, max = 4_294_967_295_u32))]
    pub(in crate::scene) seed: u32,
}

fn first() -> u32 {
    1
}

fn is_first(seed: &u32) -> bool {
    *seed == first()
}

/// The sides of a cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(in crate::scene) enum SideFile {
    /// All alike (m).
    Equal(#[schemars(extend("exclusiveMinimum" = 0))] f64),
    /// One for each axis (m).
    PerAxis(#[schemars(length(min = 2, max = 3))] Vec<Positive>),
}

/// What becomes of the cells of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Cells {
    /// Each is an element.
    #[default]
    Cells,
    /// In the plane: each is cut in two, with diagonals that alternate.
    Triangles,
    /// In space: each is cut in five, and neighbours match.
    Tetrahedra,
    /// Elements of many kinds in a random order: triangles, quadrilaterals, pentagons and hexagons in the plane;
    /// hexahedra, wedges, pyramids and tetrahedra in space.
    Mixed,
}

/// A regular polygon. Its lowest side lies on y = 0, its middle is above the origin; its corners are numbered
/// counter-clockwise from the left end of that side, after the node in the middle if there is one.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct PolygonFile {
    /// How many sides it has.
    #[schemars(range(min = 3, max = 4_000_000_000_u32))]
    pub(in crate::scene) sides: u32,
    /// Distance of its corners from its middle (m).
    pub(in crate::scene) radius: Positive,
}

/// A disc. It stands like a polygon of as many sides as it has sectors; its nodes are numbered from the middle outwards,
/// in each ring like those of a polygon.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct DiscFile {
    /// Distance of the outermost nodes from the middle (m).
    pub(in crate::scene) radius: Positive,
    /// How many rings of elements there are, all of the same width: the inner one triangles, the others quadrilaterals.
    #[schemars(range(min = 1, max = 4_000_000_000_u32))]
    pub(in crate::scene) rings: u32,
    /// How many elements there are in each ring.
    #[schemars(range(min = 3, max = 4_000_000_000_u32))]
    pub(in crate::scene) sectors: u32,
}

/// A straight chain.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct BarsFile {
    /// How many bars there are.
    #[schemars(range(min = 1, max = 4_000_000_000_u32))]
    pub(in crate::scene) count: u32,
    /// Length of one bar (m).
    pub(in crate::scene) length: Positive,
    /// Where the chain leads, at any length but zero. Two coordinates make it one in the plane, three one in space.
    pub(in crate::scene) direction: Coordinates,
}

/// A turn.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rotation {
    /// The axis, of any length but zero, about which the turn is counter-clockwise when it points at the viewer. In
    /// the plane there is none.
    pub(in crate::scene) axis: Option<Coordinates>,
    /// The angle (rad).
    pub(in crate::scene) angle: f64,
}
