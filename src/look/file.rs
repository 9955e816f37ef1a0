//! The view as typed.

use super::palette::Theme;
use super::print::{SizeFile, TextScaleFile};
use super::typed::{ColoursFile, FontFile, TypedColour};
use super::view::{ColourMap, FloorStyle, Label, Labels};
use crate::reading::coordinates::Coordinates;
use crate::sim::field::Field;
use crate::sim::snapshot::Diagnostic;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a scene is drawn.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct ViewFile {
    /// Width and height of the picture (px), or for print, such as `{ mm = [180, 101] }`.
    pub(crate) size: SizeFile,
    /// The colours.
    pub(crate) theme: Theme,
    /// The background. The other theme is used if this one's text cannot be read on it. Default: the theme's.
    pub(crate) background: Option<TypedColour>,
    /// Colours of the body, such as `{ body = "steelblue" }`, from which shades are derived. Default: the theme's.
    pub(crate) colours: ColoursFile,
    /// The font files, such as `{ regular = "NotoSansCJK.ttc" }`. Default: the built-in font, which has Latin and Greek letters.
    pub(crate) font: Option<FontFile>,
    /// Scale of all text, or in pictures for print the size of most text, such as `{ pt = 7 }`. Long titles are
    /// wrapped. `localshape check` lists other words without room, which are shortened or left out. The smallest text
    /// is a fiftieth of the height of a wide picture, or smaller with a scale below 1. Type below 5 pt is refused in
    /// pictures for print.
    pub(crate) text_scale: TextScaleFile,
    /// The words below the time. Default: `after release`; in scenes with `hold` or `grab` `after the start`.
    #[schemars(length(max = 80))]
    pub(crate) clock: Option<String>,
    /// Arrangement of the panels, or their number in a row. Default: the number that makes bodies largest.
    pub(crate) panels: Option<PanelsFile>,
    /// The drawn parts of the body. Without `surfaces` lines are drawn: springs if they are shown and exist, else the
    /// edges of elements. Edges of turned-over elements always stand out. Default: surfaces; in the plane also nodes,
    /// unless the body has more than 150.
    #[schemars(length(min = 1))]
    pub(crate) show: Option<Vec<ShowFile>>,
    /// A scalar field that colours the surfaces of the body, such as `{ by = "strain" }`, or its lines and nodes
    /// without surfaces. All panels share one colour bar, drawn below them. Springs without surfaces have a strain of
    /// their own, the change of length over the length at rest. It has a sign if the range begins below zero, such as
    /// `{ by = "strain", range = [-0.3, 0.3], map = "violet-green" }`. Default: none.
    pub(crate) colour: Option<ColourFile>,
    /// Scale of the arrows of displacements. At 1 an arrow ends at its node.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) arrow_scale: f64,
    /// A title above all panels, wrapped at the width of the picture. Default: none.
    #[schemars(length(max = 200))]
    pub(crate) title: String,
    /// A caption below all panels, wrapped at the width of the picture. `\n` begins a new line. Panels keep at least
    /// half of the picture: longer captions are cut off with an ellipsis. Default: none.
    #[schemars(length(max = 2000), extend("format" = "lines"))]
    pub(crate) caption: String,
    /// The words and signs in panels and below them.
    #[schemars(with = "Vec<Label>")]
    pub(crate) labels: Labels,
    /// A diagnostic plotted over the whole time of the scene in one chart below all panels, with the current time
    /// marked. Curves end with their names, or with the letters of their panels where names have no room. Numbered
    /// flags mark the moments when elements first turn over and when their count settles, or the extreme value. Where
    /// nearly everything happens early, that time has a larger scale. The whole scene is simulated before the first
    /// frame is drawn. Default: none.
    pub(crate) strip: Option<Diagnostic>,
    /// A dashed outline over each body: `"rest"` for the rest shape in its best rigid fit, or the name of a run for its
    /// body at the same moment, in the colour of that run. All runs then have that run's time step. Default: none.
    #[schemars(length(min = 1, max = 80))]
    pub(crate) ghost: Option<String>,
    /// Points whose paths up to the present moment are drawn in the colours of runs: `"centre"` for the centre of mass,
    /// and nodes, counted from 0, such as `["centre", 26]`. The whole scene is simulated before the first frame is
    /// drawn. Default: none.
    #[schemars(length(min = 1, max = 64))]
    pub(crate) paths: Option<Vec<PathFile>>,
    /// Whether bodies and obstacles cast shadows on the floor.
    pub(crate) shadow: bool,
    /// The drawing of floors. In the plane they have no grid.
    pub(crate) floor: FloorStyle,
    /// The lines on surfaces.
    pub(crate) edges: EdgesFile,
    /// The camera. Default: one that shows the body and what comes near it.
    pub(crate) camera: CameraFile,
}

impl Default for ViewFile {
    fn default() -> Self {
        Self {
            size: SizeFile::Pixels([1280, 720]),
            theme: Theme::default(),
            background: None,
            colours: ColoursFile::default(),
            font: None,
            text_scale: TextScaleFile::Times(1.0),
            clock: None,
            panels: None,
            show: None,
            colour: None,
            arrow_scale: 1.0,
            title: String::new(),
            caption: String::new(),
            labels: Labels::default(),
            strip: None,
            ghost: None,
            paths: None,
            shadow: true,
            floor: FloorStyle::default(),
            edges: EdgesFile::default(),
            camera: CameraFile::default(),
        }
    }
}

/// A point with a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum PathFile {
    /// A node, counted from 0.
    Node(u32),
    /// Another point.
    Point(PathPointFile),
}

/// A point of the body that is no node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum PathPointFile {
    /// The centre of mass.
    Centre,
}

/// The lines on surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum EdgesFile {
    /// The outline and all edges, hidden ones faintly.
    #[default]
    All,
    /// The outline and visible edges.
    Visible,
    /// The outline, and edges of turned-over elements.
    Outline,
}

/// The arrangement of panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum PanelsFile {
    /// Their number in a row.
    Columns(#[schemars(range(min = 1, max = 64))] u32),
    /// In one direction.
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
    /// The values at both ends of the colour bar, in the field's unit. Larger and smaller values have the colours of
    /// the ends. Default: from zero to an estimate for the scene: a strain of 0.5, a displacement of half an element's
    /// edge, the speed of a fall through the scene or at the start, the energy of an element with a strain of 0.5.
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
    /// floor below it, or where it starts. Without a `distance` the target also brings plates, spheres, capsules, boxes
    /// and moved nodes near the body into the picture.
    pub(crate) target: Option<Coordinates>,
    /// Distance of a fixed camera from its target (m). In the plane it gives the scale together with `field_of_view`.
    /// Default: 8.5 times the longest side of the bounding box at the start, and more if the body starts higher than
    /// that shows. Without a `target` the picture also shows all parts of plates, spheres, capsules, boxes and moved
    /// nodes that come within 1.25 body sizes of the body's start or stand.
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
