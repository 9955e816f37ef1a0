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
    /// The background. If the theme's text cannot be read on it, the other theme is used. Default: the theme's.
    pub(crate) background: Option<TypedColour>,
    /// Colours that replace those of the theme, and shades derived from them, such as `{ body = "steelblue" }`. Default: the
    /// theme's.
    pub(crate) colours: ColoursFile,
    /// The font files, such as `{ regular = "NotoSansCJK.ttc" }`. Default: the built-in font, which has Latin and Greek letters.
    pub(crate) font: Option<FontFile>,
    /// Scale of all text, or in pictures for print the size of most text, such as `{ pt = 7 }`. Long titles are wrapped;
    /// `localshape check` says what else finds no room and is shortened or left out. No text is smaller than a fiftieth of the
    /// height of a wide picture, times this scale if that is below 1; pictures for print with type below 5 pt are refused.
    pub(crate) text_scale: TextScaleFile,
    /// The words below the time, which say since when it counts. Default: `after release`; in scenes with `hold` or `grab`
    /// `after the start`.
    #[schemars(length(max = 80))]
    pub(crate) clock: Option<String>,
    /// Arrangement of the panels, or their number in a row. Default: as many in a row as make bodies largest.
    pub(crate) panels: Option<PanelsFile>,
    /// What is drawn of the body. Without `surfaces`, lines are drawn instead: springs if they are shown and the model
    /// has any, else the edges of the elements; edges of turned-over elements stand out in either case. Default: surfaces,
    /// and in the plane nodes, too, unless there are more than 150.
    #[schemars(length(min = 1))]
    pub(crate) show: Option<Vec<ShowFile>>,
    /// A scalar field that colours the body, such as `{ by = "strain" }`: its surfaces, or its lines and nodes if surfaces are
    /// not shown. Springs without surfaces have a strain of their own, the change of length over the length at rest; it has a
    /// sign if the range begins below zero, such as `{ by = "strain", range = [-0.3, 0.3], map = "violet-green" }`. All panels
    /// share one colour bar, drawn below them. Default: none.
    pub(crate) colour: Option<ColourFile>,
    /// Scale of the arrows of displacements. Each begins where the best-fitting rigid placement has its node; at 1 it ends
    /// at the node.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) arrow_scale: f64,
    /// A title above all panels, wrapped at the width of the picture. Default: none.
    #[schemars(length(max = 200))]
    pub(crate) title: String,
    /// A caption below all panels, wrapped at the width of the picture; `\n` begins a new line. Panels keep at least half of
    /// the picture: a longer caption is cut off with an ellipsis. Default: none.
    #[schemars(length(max = 2000), extend("format" = "lines"))]
    pub(crate) caption: String,
    /// What is written in panels and below them.
    #[schemars(with = "Vec<Label>")]
    pub(crate) labels: Labels,
    /// A diagnostic plotted over the whole time of the scene in one chart below all panels, with the current time
    /// marked. The whole scene is simulated before the first frame is drawn. Names are written at the ends of curves as
    /// far as there is room, or the letters of their panels where there is none; numbered flags, also in the panels,
    /// say when elements first turn over and when their count settles, or the extreme value; and where nearly
    /// everything happens early, that part of the time has a larger scale. Default: none.
    pub(crate) strip: Option<Diagnostic>,
    /// A dashed outline over each body: `"rest"` for the rest shape in its best rigid fit, or the name of a run for its body at the
    /// same moment, in the colour of that run. All runs then have the time step of that one. Default: none.
    #[schemars(length(min = 1, max = 80))]
    pub(crate) ghost: Option<String>,
    /// Points of the body whose paths are drawn up to the present moment, in the colours of runs: `"centre"` for the centre of mass,
    /// and nodes, counted from 0, such as `["centre", 26]`. The whole scene is simulated before the first frame is drawn. Default: none.
    #[schemars(length(min = 1, max = 64))]
    pub(crate) paths: Option<Vec<PathFile>>,
    /// Whether bodies and obstacles cast shadows on the floor.
    pub(crate) shadow: bool,
    /// How floors are drawn. In the plane they never have a grid.
    pub(crate) floor: FloorStyle,
    /// Which lines are drawn on surfaces.
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

/// A point of the body that leaves a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum PathFile {
    /// A node, counted from 0.
    Node(u32),
    /// A point that is no node.
    Point(PathPointFile),
}

/// A point of the body that is no node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum PathPointFile {
    /// The centre of mass.
    Centre,
}

/// Which lines are drawn on surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum EdgesFile {
    /// The outline and all edges; hidden ones faintly.
    #[default]
    All,
    /// The outline and visible edges.
    Visible,
    /// Only the outline. Edges of turned-over elements are always drawn.
    Outline,
}

/// How panels are arranged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum PanelsFile {
    /// So many in a row.
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
    /// The springs of mass-spring models, as lines; faint where surfaces hide them.
    Springs,
    /// An arrow to each node from its place in the best-fitting rigid placement of the rest shape. Only for nodes on the
    /// surface, in space only for those that face the viewer, and for at most 500.
    Displacements,
}

/// A scalar field and its colour map.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ColourFile {
    /// The field.
    pub(crate) by: Field,
    /// The values at both ends of the colour bar, in the field's unit. Values beyond have the colours of the ends, and the
    /// bar then ends in a point. Default: from zero to an estimate for the scene: a
    /// strain of 0.5, a displacement of half an element's edge, the speed of a fall through the scene or at the start,
    /// the energy of an element with a strain of 0.5.
    pub(crate) range: Option<[f64; 2]>,
    /// The colour map.
    #[serde(default)]
    pub(crate) map: ColourMap,
}

/// A perspective camera. A body in the plane is seen from the front without perspective.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct CameraFile {
    /// Azimuth to the right, from looking along −z (rad). Default: 0.541, which is 31°. Not in the plane.
    pub(crate) azimuth: Option<f64>,
    /// Elevation above the horizon (rad), less than a quarter turn (1.57) either way, so that the camera does not look along
    /// its up-axis. Default: 0.297, which is 17°; under a plate that faces down 0.227, which is 13°. Not in the plane.
    #[schemars(extend("exclusiveMinimum" = -1.57, "exclusiveMaximum" = 1.57))]
    pub(crate) elevation: Option<f64>,
    /// Vertical field of view (rad). Default: 0.349, which is 20°.
    #[schemars(range(min = 0.001, max = 3.0))]
    pub(crate) field_of_view: Option<f64>,
    /// The point looked at (m) by a camera that stands still. Default: the centre of the body as it would stand on the first
    /// floor below it, or where it starts if there is none. If `distance` is not given either, the target is chosen so that
    /// plates, spheres, capsules, boxes and moved nodes near the body are in the picture, too.
    pub(crate) target: Option<Coordinates>,
    /// Distance (m) of a camera that stands still from its target; in the plane, `distance` and `field_of_view` together give
    /// the scale. Default: 8.5 times the longest side of the bounding box at the start, and more if the body starts higher
    /// than that shows. If `target` is not given either, the picture also shows all parts of plates, spheres, capsules, boxes
    /// and moved nodes that are at any time within 1.25 body sizes of where the body starts and stands.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) distance: Option<f64>,
    /// Whether the camera follows the centre of mass of each run's body. All panels and frames then have one scale, at which
    /// the body takes about 60 % of its panel's width at its widest moment. Where all runs stay in view at that scale, the
    /// camera stands still. The whole scene is simulated before the first frame is drawn. A camera with a `target` or a
    /// `distance` stands still.
    pub(crate) follow: bool,
}

impl Default for CameraFile {
    fn default() -> Self {
        Self { azimuth: None, elevation: None, field_of_view: None, target: None, distance: None, follow: true }
    }
}
