//! The body as typed.

use super::{Coordinates, NodesFile, Positive};
use localshape_mesh::Fill;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize, Serializer};

/// The keys of its lists.
pub(in crate::scene) const LISTS: [&str; 7] =
    ["nodes", "elements", "springs", "faces", "positions", "velocities", "masses"];

/// The most bodies of a scene.
const MOST: usize = 1000;

/// The schema of the bodies of a scene: one table, or a list of several.
pub(super) fn one_or_several(generator: &mut SchemaGenerator) -> Schema {
    let body = generator.subschema_for::<BodyFile>();
    json_schema!({ "anyOf": [body, { "type": "array", "items": body, "minItems": 1, "maxItems": MOST }] })
}

/// Writes the bodies of a scene: one as a table, several as a list.
pub(super) fn written<S: Serializer>(bodies: &[Option<BodyFile>], serializer: S) -> Result<S::Ok, S::Error> {
    match bodies {
        [only] => only.serialize(serializer),
        several => several.serialize(serializer),
    }
}

/// A body: exactly one of `lattice`, `polygon`, `fan`, `disc`, `bars`, `mesh` and `file`, or explicit `nodes` and `elements`.
///
/// At the start `rotation`, `offset`, `lowest`, `velocity` and `spin` are applied in this order. The rest shape stays
/// as it is.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend(
    "oneOf" = [
        { "required": ["lattice"] }, { "required": ["polygon"] }, { "required": ["fan"] }, { "required": ["disc"] },
        { "required": ["bars"] }, { "required": ["nodes", "elements"] }, { "required": ["mesh"] }, { "required": ["file"] }
    ],
    "allOf" = [
        { "not": { "required": ["mass", "masses"] } }, { "not": { "required": ["mass", "density"] } },
        { "not": { "required": ["mass", "mass_total"] } }, { "not": { "required": ["masses", "density"] } },
        { "not": { "required": ["masses", "mass_total"] } }, { "not": { "required": ["density", "mass_total"] } },
        { "not": { "required": ["velocity", "velocities"] } }, { "not": { "required": ["positions", "start"] } }
    ],
    "dependentRequired" = {
        "elements": ["nodes"], "springs": ["nodes"], "faces": ["nodes"],
        "positions": ["nodes"], "velocities": ["nodes"], "masses": ["nodes"],
        "fill": ["mesh"], "scale": ["mesh"], "up": ["mesh"], "weld": ["mesh"]
    }
))]
pub(in crate::scene) struct BodyFile {
    /// Unique name, which `bodies` and `models` of runs use, and result files. Each of several bodies needs one.
    #[schemars(length(min = 1, max = 80))]
    pub(in crate::scene) name: Option<String>,
    /// A block of equal cells: `{ cells = [3, 3, 3], side = 0.1 }` for cubes, `cells = [3, 3]` for squares in the
    /// plane. The block stands on y = 0, centred on x = 0 and z = 0. Nodes are numbered with x fastest, then y, then z.
    pub(in crate::scene) lattice: Option<Lattice>,
    /// A regular polygon in the plane as one element: `{ sides = 6, radius = 1.0 }`. The polygon stands with a side on y = 0,
    /// its centre above the origin. Corners are numbered counter-clockwise from the left end of that side.
    pub(in crate::scene) polygon: Option<PolygonFile>,
    /// A regular polygon in the plane, cut into triangles around a node in its centre: `{ sides = 6, radius = 1.0 }`.
    /// The fan stands like a `polygon`. The central node comes first.
    pub(in crate::scene) fan: Option<PolygonFile>,
    /// A disc in the plane: `{ radius = 1.0, rings = 3, sectors = 12 }`. The disc stands like a `polygon` with as many sides
    /// as sectors. Nodes are numbered from the centre outwards, in each ring like the corners of a polygon.
    pub(in crate::scene) disc: Option<DiscFile>,
    /// A chain of two-node elements that begins at the origin: `{ count = 8, length = 0.1, direction = [1, 0] }`.
    pub(in crate::scene) bars: Option<BarsFile>,
    /// Rest position of each node (m). Two coordinates make a body in the plane, three a body in space.
    #[serde(serialize_with = "begun")]
    #[schemars(length(min = 1))]
    pub(in crate::scene) nodes: Option<Vec<Coordinates>>,
    /// The nodes of each element, two or more, counted from 0. In the plane an element is a polygon, counter-clockwise.
    /// In space it is a tetrahedron or pyramid (the base counter-clockwise seen from the last node), a wedge (both
    /// triangles counter-clockwise seen from the second), a hexahedron (corners with x fastest, then y, then z), or the
    /// convex hull of any other number of nodes in any order. See also `convex`.
    #[serde(serialize_with = "begun")]
    #[schemars(length(min = 1), inner(length(min = 2)))]
    pub(in crate::scene) elements: Option<Vec<Vec<u32>>>,
    /// Pairs of nodes, for mass-spring models without a named topology.
    #[serde(serialize_with = "begun")]
    #[schemars(length(min = 1))]
    pub(in crate::scene) springs: Option<Vec<[u32; 2]>>,
    /// The nodes of each face to draw, counter-clockwise from outside. Default: the faces of the elements.
    #[serde(serialize_with = "begun")]
    #[schemars(inner(length(min = 3)))]
    pub(in crate::scene) faces: Option<Vec<Vec<u32>>>,
    /// Initial position of each node (m), before `rotation`, `offset` and `lowest`, for bodies with `nodes`. Default:
    /// the rest positions.
    #[serde(serialize_with = "begun")]
    pub(in crate::scene) positions: Option<Vec<Coordinates>>,
    /// A degenerate, inverted or random initial shape, such as `{ shape = "cloud", seed = 1 }`. Default: the rest
    /// shape.
    pub(in crate::scene) start: Option<Start>,
    /// Initial velocity of each node (m/s), instead of one `velocity`. `rotation` does not rotate it.
    #[serde(serialize_with = "begun")]
    pub(in crate::scene) velocities: Option<Vec<Coordinates>>,
    /// Mass of each node (kg), instead of one `mass`.
    #[serde(serialize_with = "begun")]
    pub(in crate::scene) masses: Option<Vec<Positive>>,
    /// A mesh file beside the scene. Cells become elements: Gmsh (.msh, 2.2 or 4.1), VTK (.vtk, .vtu), Abaqus and CalculiX (.inp),
    /// Medit (.mesh). A surface is filled with elements, which carry it: .obj, .stl, .ply, .off, .gltf, .glb, .vtp, and the formats
    /// of cells where a file has none. It then needs `density` or `mass_total`. `localshape check FILE` tells what a file contains.
    /// A .gltf may have its data in files beside it.
    #[schemars(length(min = 1))]
    pub(in crate::scene) mesh: Option<String>,
    /// The elements that fill the surface in `mesh`: `{ with = "cubes", cells = 20 }`.
    pub(in crate::scene) fill: Option<FillFile>,
    /// Length of the unit of the mesh file (m), such as 0.001 for millimetres.
    #[schemars(extend("default" = 1.0))]
    pub(in crate::scene) scale: Option<Positive>,
    /// The axis of the mesh file that points up. Scenes have y up.
    #[schemars(extend("default" = "y"))]
    pub(in crate::scene) up: Option<Up>,
    /// Points of the mesh that are nearer than this to an earlier one become that one (m, after `scale`): corners of a surface
    /// that differ in their last digits, or equal points of cells. Default: points of surfaces that only round-off sets apart.
    pub(in crate::scene) weld: Option<Positive>,
    /// A NumPy archive (.npz) beside the scene, written by `numpy.savez` or `numpy.savez_compressed`. Its arrays
    /// `nodes` and `elements`, and optionally `springs`, `faces`, `positions`, `velocities` and `masses`, mean the same
    /// as these keys. Coordinates and masses are float64 or float32. Indices are integers, with -1 at the end of
    /// shorter rows.
    #[schemars(length(min = 1))]
    pub(in crate::scene) file: Option<String>,
    /// Whether all elements in space are the convex hulls of their nodes, in any order: octahedra, bipyramids, flat
    /// quadrilaterals of a cloth. Otherwise elements of four, five, six and eight nodes are tetrahedra, pyramids,
    /// wedges and hexahedra.
    #[serde(default)]
    pub(in crate::scene) convex: bool,
    /// Whether its surface meets itself, so that it cannot be folded through itself.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    #[schemars(extend("default" = false))]
    pub(in crate::scene) self_contact: bool,
    /// The distance that its surface keeps from an obstacle, and half of that between two such bodies (m), at most a cell. Floors and plates
    /// meet nodes, unless the surface is carried. Default: the fortieth part of the mean length of the edges of its surface.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(in crate::scene) thickness: Option<f64>,
    /// Mass of every node (kg). Default: 1.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(in crate::scene) mass: Option<f64>,
    /// Density (kg/m³; in the plane kg/m²), instead of `mass`: the volume of each element at rest is shared equally by
    /// its nodes. Each node needs an element with a volume, in the plane with an area.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(in crate::scene) density: Option<f64>,
    /// Mass of the whole body (kg), instead of `mass`. It is shared as by `density`, or equally by all nodes if some have
    /// no element with a volume.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(in crate::scene) mass_total: Option<f64>,
    /// Regions with a material of their own, such as a stiff core: `[[body.region]]`. They have colours of their own in pictures, but for
    /// surfaces that a filled body carries. Default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(in crate::scene) region: Vec<CellsFile>,
    /// A rotation about the mean of the nodes. Default: none.
    pub(in crate::scene) rotation: Option<Rotation>,
    /// A translation after the rotation (m). Default: none.
    pub(in crate::scene) offset: Option<Coordinates>,
    /// Height of the lowest node (m), along y, after rotation and translation. Default: unchanged.
    pub(in crate::scene) lowest: Option<f64>,
    /// Initial velocity of all nodes (m/s). Default: at rest.
    pub(in crate::scene) velocity: Option<Coordinates>,
    /// A rigid spin about the mean of the nodes, added to all other velocities. Default: none.
    pub(in crate::scene) spin: Option<SpinFile>,
}

/// Writes in place of a list, which may have millions of entries, whether it has any.
fn begun<T, S: Serializer>(list: &Option<Vec<T>>, serializer: S) -> Result<S::Ok, S::Error> {
    list.as_ref().map(|list| &[true][..list.len().min(1)]).serialize(serializer)
}

/// A region of a body with a material of its own.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("not" = { "required": ["stiffness", "young"] }))]
pub(in crate::scene) struct CellsFile {
    /// Its name, for the key of pictures.
    #[schemars(length(min = 1, max = 80))]
    pub(in crate::scene) name: String,
    /// Its elements: those whose middle starts in a ball, `{ of = [0, 0.5, 0], within = 0.2 }`, or in a box, `{ low = [0, 0, 0], high = [1, 1, 1] }`;
    /// those with a corner on a side of the rest shape, such as `"top"`; those with all corners in a group of a mesh file; or a list of
    /// elements, counted from 0.
    pub(in crate::scene) cells: NodesFile,
    /// Its stiffness and its damping relative to those of the model.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(in crate::scene) stiffness: Option<f64>,
    /// Its Young's modulus (Pa; in the plane N/m), in place of `stiffness`, if all models of the body have the same `young`. Its damping is
    /// in proportion, its Poisson's ratio that of the model.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(in crate::scene) young: Option<f64>,
    /// Its density (kg/m³; in the plane kg/m²), if the body has a `density`.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(in crate::scene) density: Option<f64>,
}

/// The elements that fill a surface.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("not" = { "required": ["side", "cells"] }))]
pub(in crate::scene) struct FillFile {
    /// Their kind.
    #[serde(default)]
    pub(in crate::scene) with: FillKind,
    /// Length of the edges of their lattice (m). Default: that of `cells`.
    pub(in crate::scene) side: Option<Positive>,
    /// Number of lattice cells along the longest side of the surface, instead of `side`.
    #[schemars(range(min = 1, max = 4_000_000_000_u32), extend("default" = 20))]
    pub(in crate::scene) cells: Option<u32>,
}

/// The kind of elements that fill a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(in crate::scene) enum FillKind {
    /// Cubes that contain a part of the inside. Their stiffness and mass are in proportion to that part.
    #[default]
    Cubes,
    /// Cubes at the surface, and those of twice the side inside.
    Graded,
    /// Tetrahedra whose faces follow the surface.
    Tetrahedra,
    /// Cubes cut at the surface into polyhedra.
    Polyhedra,
}

impl FillKind {
    /// All kinds.
    pub(in crate::scene) const ALL: [Self; 4] = [Self::Cubes, Self::Graded, Self::Tetrahedra, Self::Polyhedra];

    /// Elements of this kind with edges of a length (m).
    pub(in crate::scene) fn with_side(self, side: f64) -> Fill {
        match self {
            Self::Cubes => Fill::Cubes { side },
            Self::Graded => Fill::Graded { side },
            Self::Tetrahedra => Fill::Tetrahedra { side },
            Self::Polyhedra => Fill::Polyhedra { side },
        }
    }
}

/// An axis of a mesh file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Up {
    /// The first coordinate.
    X,
    /// The second coordinate, as in glTF.
    #[default]
    Y,
    /// The third coordinate, as in most programs for construction and printing.
    Z,
}

/// A degenerate, inverted or random start, around the mean of the nodes at rest.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Start {
    /// The initial shape.
    pub(in crate::scene) shape: StartShape,
    /// Direction of the line, or normal of the plane or mirror, of any length but zero. Default: along x.
    pub(in crate::scene) direction: Option<Coordinates>,
    /// Seed of a cloud, which is the same on every machine.
    #[serde(default = "first", skip_serializing_if = "is_first")]
    #[schemars(range(min = 0, max = 4_294_967_295_u32), extend("default" = 1))]
    pub(in crate::scene) seed: u32,
}

/// The initial shape of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum StartShape {
    /// All nodes at one point.
    Point,
    /// All nodes projected to a straight line.
    Line,
    /// All nodes projected to a plane.
    Plane,
    /// Mirrored, so that all elements are turned inside out.
    MirrorImage,
    /// Nodes at random points of the box around the body.
    Cloud,
}

impl StartShape {
    /// Whether it has a direction.
    pub(in crate::scene) fn has_direction(self) -> bool {
        matches!(self, Self::Line | Self::Plane | Self::MirrorImage)
    }
}

/// A rigid spin.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct SpinFile {
    /// The axis, of any length but zero, in space. The spin is counter-clockwise when the axis points at the viewer.
    pub(in crate::scene) axis: Option<Coordinates>,
    /// The angular velocity (rad/s).
    pub(in crate::scene) rate: f64,
}

/// A block of equal cells.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Lattice {
    /// Number of cells along x, y and z; two numbers make squares in the plane.
    #[schemars(length(min = 2, max = 3), inner(range(min = 1, max = 4_000_000_000_u32)))]
    pub(in crate::scene) cells: Vec<u32>,
    /// Length of a cell's edges (m): one number, or one for each axis, such as `[0.1, 0.2, 0.1]` for bricks.
    pub(in crate::scene) side: SideFile,
    /// The elements of each cell.
    #[serde(default)]
    pub(in crate::scene) elements: Cells,
    /// Random displacement of nodes, in parts of a cell's shortest side. Nodes on the surface move only along it, and
    /// corners stay. Displacements are reduced where an element would be flattened or turned inside out.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 0.4))]
    pub(in crate::scene) irregular: f64,
    /// Seed of `irregular` and `mixed` blocks, which are the same on every machine.
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
    /// The same along all axes (m).
    Equal(#[schemars(extend("exclusiveMinimum" = 0))] f64),
    /// One for each axis (m).
    PerAxis(#[schemars(length(min = 2, max = 3))] Vec<Positive>),
}

/// The elements of each cell of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Cells {
    /// Each cell is one element.
    #[default]
    Cells,
    /// Each cell is cut in two, with alternating diagonals, in the plane.
    Triangles,
    /// Each cell is cut in five, in space. The faces of neighbours match.
    Tetrahedra,
    /// Elements of many kinds in random order: triangles to hexagons in the plane; hexahedra, wedges, pyramids and
    /// tetrahedra in space.
    Mixed,
}

/// A regular polygon.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct PolygonFile {
    /// Number of sides.
    #[schemars(range(min = 3, max = 4_000_000_000_u32))]
    pub(in crate::scene) sides: u32,
    /// Distance of the corners from the centre (m).
    pub(in crate::scene) radius: Positive,
}

/// A disc.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct DiscFile {
    /// Distance of the outermost nodes from the centre (m).
    pub(in crate::scene) radius: Positive,
    /// Number of rings of equal width. The inner one has triangles, the others have quadrilaterals.
    #[schemars(range(min = 1, max = 4_000_000_000_u32))]
    pub(in crate::scene) rings: u32,
    /// Number of elements in each ring.
    #[schemars(range(min = 3, max = 4_000_000_000_u32))]
    pub(in crate::scene) sectors: u32,
}

/// A straight chain.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct BarsFile {
    /// Number of bars.
    #[schemars(range(min = 1, max = 4_000_000_000_u32))]
    pub(in crate::scene) count: u32,
    /// Length of one bar (m).
    pub(in crate::scene) length: Positive,
    /// Direction of the chain, of any length but zero, with two coordinates in the plane and three in space.
    pub(in crate::scene) direction: Coordinates,
}

/// A rotation.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rotation {
    /// The axis, of any length but zero, in space. The rotation is counter-clockwise when the axis points at the
    /// viewer.
    pub(in crate::scene) axis: Option<Coordinates>,
    /// The angle (rad).
    pub(in crate::scene) angle: f64,
}
