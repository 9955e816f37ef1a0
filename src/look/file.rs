//! Values of a view as typed, which the scene completes.

use crate::reading::coordinates::Coordinates;
use crate::sim::Field;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A point with a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum PathFile {
    /// A node, counted from 0.
    Node(u32),
    /// Another point.
    Point(PathPointFile),
}

/// A point of the body that is not a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum PathPointFile {
    /// The centre of mass.
    Centre,
}

/// The arrangement of panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum PanelsFile {
    /// The number of panels in a row.
    Columns(#[schemars(range(min = 1, max = 64))] u32),
    /// All panels in one direction.
    Along(ArrangementFile),
}

/// Arrangement of panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum ArrangementFile {
    /// Side by side.
    Row,
    /// One below the other.
    Column,
}

/// A part of the body that can be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum ShowFile {
    /// The faces of the elements, with their edges.
    Surfaces,
    /// The nodes, as discs.
    Nodes,
    /// The springs of mass-spring models, as lines, faint behind surfaces.
    Springs,
    /// An arrow to each node from its place in the best-fitting rigid placement of the rest shape. Only for nodes on
    /// the surface that face the viewer, and for at most 500.
    Displacements,
}

/// A scalar field and its colour map.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ColourFile {
    /// The field.
    pub(crate) by: Field,
    /// The run to which `distance` is measured. All runs must have the same time step.
    #[schemars(length(min = 1, max = 80))]
    pub(crate) to: Option<String>,
    /// The values at both ends of the colour bar, in the field's unit. Values beyond have the colours of the ends.
    /// Default: from zero to an estimate for the scene: a strain of 0.5, a displacement of half an element's edge, a
    /// distance of half the body, the speed of a fall or at the start, the energy of an element with a strain of 0.5.
    pub(crate) range: Option<[f64; 2]>,
    /// The colour map.
    #[serde(default)]
    pub(crate) map: ColourMap,
}

/// A perspective camera. A body in the plane is seen from the front without perspective.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct CameraFile {
    /// Azimuth to the right, from looking along −z (rad). Only in space. Default: 0.541, which is 31°.
    pub(crate) azimuth: Option<f64>,
    /// Elevation above the horizon (rad), below a quarter turn (1.57), so that the camera does not look along its
    /// up-axis. Only in space. Default: 0.297, which is 17°; under a plate that faces down 0.227, which is 13°.
    #[schemars(extend("exclusiveMinimum" = -1.57, "exclusiveMaximum" = 1.57))]
    pub(crate) elevation: Option<f64>,
    /// Vertical field of view (rad). Default: 0.349, which is 20°.
    #[schemars(range(min = 0.001, max = 3.0))]
    pub(crate) field_of_view: Option<f64>,
    /// The point (m) that a fixed camera looks at. Default: the centre of the body where it would stand on the first
    /// floor below it, or where it starts.
    pub(crate) target: Option<Coordinates>,
    /// Distance of a fixed camera from its target (m). In the plane it gives the scale together with `field_of_view`.
    /// Default: 8.5 times the longest side of the bounding box at the start. Without a `target`, more if that leaves out
    /// the body where it starts or stands, or parts of plates, spheres, capsules, boxes and moved nodes within 1.25 body
    /// sizes of it.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) distance: Option<f64>,
    /// Whether the camera follows the centre of mass of each run's body. All panels and frames then have one scale, at
    /// which the body takes about 60 % of its panel's width at its widest moment. The camera stands still where that
    /// keeps all runs in view, and if it has a `target` or a `distance`. The whole scene is simulated before the first
    /// frame is drawn.
    pub(crate) follow: bool,
}

impl Default for CameraFile {
    fn default() -> Self {
        Self { azimuth: None, elevation: None, field_of_view: None, target: None, distance: None, follow: true }
    }
}

/// Named colour maps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ColourMap {
    /// From pale mint through teal to indigo: far from the vermilion of turned-over elements, with visible edges
    /// everywhere. Large values are dark in the light theme and light in the dark one.
    #[default]
    MintIndigo,
    /// From dark violet through teal to yellow (matplotlib), in either theme.
    Viridis,
    /// From dark blue to yellow, the same with colour blindness (Nuñez, Anderton, Renslow 2018), in either theme.
    Cividis,
    /// From purple through crimson to pale yellow, in either theme: matplotlib's without its black end. Its orange
    /// resembles turned-over elements.
    Magma,
    /// From light to dark grey in the light theme, from dark to light in the dark one.
    Greys,
    /// From violet through grey to green, for lines: values near the middle recede, but stay visible.
    VioletGreen,
    /// From purple through white to green (ColorBrewer PRGn), in either theme: diverging, for values of both signs.
    PurpleGreen,
}
