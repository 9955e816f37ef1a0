//! The view as typed.

use super::palette::Theme;
use super::typed::{BackgroundFile, ColoursFile, FontFile};
use super::view::{ColourMap, FloorStyle, Follow, Light};
use crate::reading::coordinates::Coordinates;
use crate::sim::field::Field;
use crate::sim::snapshot::Diagnostic;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a scene is drawn.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(extend("not" = { "required": ["columns", "panels"] }))]
pub(crate) struct ViewFile {
    /// Width and height of the picture (px).
    #[schemars(inner(range(min = 16, max = 16384)))]
    pub(crate) size: [u32; 2],
    /// The colours.
    pub(crate) theme: Theme,
    /// What is behind everything: a colour, or `"transparent"`. A colour on which the theme's text could not be read
    /// makes the other theme take its place. Transparent pictures are PNG files with opacities, to be laid on any page;
    /// they are drawn twice and have no floor but its lines and shadows. Default: the theme's.
    pub(crate) background: Option<BackgroundFile>,
    /// Colours that take the place of the theme's, each with what belongs to it. Default: the theme's.
    pub(crate) colours: ColoursFile,
    /// The files of the font. Default: the font that is built in, which has Latin and Greek letters.
    pub(crate) font: Option<FontFile>,
    /// How many times larger than usual all type is, with the rows it stands in. What has no room, or would be too small to
    /// be read, is left out.
    #[schemars(range(min = 0.5, max = 3.0))]
    pub(crate) text_scale: f64,
    /// How many times thicker than usual all lines are, and how many times larger nodes, the signs on elements in the
    /// plane and the marks of what moves or is held. Arrows of displacements become thicker, not longer; type stays as it
    /// is.
    #[schemars(range(min = 0.25, max = 4.0))]
    pub(crate) line_scale: f64,
    /// How many times as wide as usual the margins of the picture and of each panel are: 40 pixels in a picture 720 high.
    /// The body has what they leave. They are never narrower than a quarter of that times `text_scale`, whether anything is
    /// written or not: words must not touch.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub(crate) margin: f64,
    /// What the clock counts from, in the words shown under the time.
    #[schemars(length(max = 80))]
    pub(crate) clock: String,
    /// How many panels stand beside each other. Default: all of them, up to 3; never more than there are runs. Not
    /// together with `panels`.
    #[schemars(range(min = 1, max = 64))]
    pub(crate) columns: Option<u32>,
    /// How the panels stand: beside each other, below each other, or in as many rows as leave them most room. Not
    /// together with `columns`.
    pub(crate) panels: Option<ArrangementFile>,
    /// What is drawn of the body. Without `surfaces`, lines take their place: the springs if they are shown and the model
    /// has any, else the edges of the elements; edges of turned-over elements stand out in either case. Default: its
    /// surfaces, and in the plane its nodes, too, unless there are more than 150.
    #[schemars(length(min = 1))]
    pub(crate) show: Option<Vec<ShowFile>>,
    /// A scalar field that colours the body: its surfaces, or its lines and nodes if surfaces are not shown. All panels
    /// share one scale, drawn below them. Default: none.
    pub(crate) colour: Option<ColourFile>,
    /// How many times longer than the displacements their arrows are drawn. Each begins where the rigid placement has
    /// its node; at 1 it ends at the node.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) arrow_scale: f64,
    /// A title above all panels. Default: none.
    #[schemars(length(max = 200))]
    pub(crate) title: String,
    /// A caption below all panels, set in lines as wide as the picture; `\n` begins a new line. Panels keep half of the
    /// picture: what has no room is cut off and ends in an ellipsis. Default: none.
    #[schemars(length(max = 2000), extend("format" = "lines"))]
    pub(crate) caption: String,
    /// Whether each panel bears a letter before its name, a, b, c and so on, to speak of it in a text.
    pub(crate) letters: bool,
    /// What is written in each panel.
    pub(crate) labels: Vec<LabelFile>,
    /// Whether a bar says how long a round length is (m): in space, at the distance of the point looked at.
    pub(crate) scale_bar: bool,
    /// Whether keys say what colours and arrows mean, where there are any and room for them.
    pub(crate) legend: bool,
    /// A diagnostic drawn over time below each panel, with the present moment marked. The scene is then simulated once
    /// before the first frame is drawn, so that every frame shows the whole course. Up to 8 other runs are drawn
    /// faintly behind. Default: none.
    pub(crate) strip: Option<Diagnostic>,
    /// Opacity of sound elements: below 1, what lies behind and within the body is seen through them.
    #[schemars(range(min = 0.1, max = 1.0))]
    pub(crate) opacity: f64,
    /// How far elements are drawn apart, in parts of their distance from the body's middle, to show what is inside. Not
    /// together with springs and displacements.
    #[schemars(range(min = 0.0, max = 3.0))]
    pub(crate) explode: f64,
    /// Colours springs by their strain, the change of their length over their length at rest, instead of drawing them
    /// all alike. Default: no. Needs `"springs"` in `show`.
    pub(crate) spring_colour: Option<SpringColourFile>,
    /// From where the light falls, in space.
    pub(crate) light: LightFile,
    /// Whether bodies and obstacles throw shadows on the floor.
    pub(crate) shadow: bool,
    /// How floors are drawn: with a grid in space, without one, or not at all. In the plane none has a grid.
    pub(crate) floor: FloorStyle,
    /// Which lines are drawn on surfaces.
    pub(crate) edges: EdgesFile,
    /// Whether silhouettes are drawn: the outlines of sound elements and of solid obstacles, and where folds of these end
    /// before what is farther away. Without them `edges = "outline"` leaves sound elements no line at all. Those of
    /// turned-over elements are drawn in any case, unless elements drawn apart are too small for lines.
    pub(crate) outline: bool,
    /// Whether turned-over elements are hatched. Without it their colour tells of them; where a field colours surfaces
    /// they have it instead of the field's, which must then have a map that all eyes tell from it.
    pub(crate) hatch: bool,
    /// From where the scene is seen.
    pub(crate) camera: CameraFile,
}

impl Default for ViewFile {
    fn default() -> Self {
        Self {
            size: [1280, 720],
            theme: Theme::default(),
            background: None,
            colours: ColoursFile::default(),
            font: None,
            text_scale: 1.0,
            line_scale: 1.0,
            margin: 1.0,
            clock: "after release".into(),
            columns: None,
            panels: None,
            show: None,
            colour: None,
            arrow_scale: 1.0,
            title: String::new(),
            caption: String::new(),
            letters: false,
            labels: LabelFile::ALL.to_vec(),
            scale_bar: true,
            legend: true,
            strip: None,
            opacity: 1.0,
            explode: 0.0,
            spring_colour: None,
            light: LightFile::default(),
            shadow: true,
            floor: FloorStyle::default(),
            edges: EdgesFile::default(),
            outline: true,
            hatch: true,
            camera: CameraFile::default(),
        }
    }
}

/// Something that is written in a panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum LabelFile {
    /// The run's name.
    Name,
    /// The model and its parameters.
    Model,
    /// The time, in one panel for all.
    Clock,
    /// How many elements have turned over.
    Count,
    /// The shape error; in the plane, the smallest area ratio. That a run diverged is written in any case.
    Number,
}

impl LabelFile {
    const ALL: [Self; 5] = [Self::Name, Self::Model, Self::Clock, Self::Count, Self::Number];
}

/// Colours of springs.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct SpringColourFile {
    /// The strains at the ends of the scale. Default: −0.3 and 0.3.
    pub(crate) range: Option<[f64; 2]>,
    /// The colours of the scale. Default: `"violet-green"`, violet where springs are shortened, green where they are
    /// lengthened.
    pub(crate) map: ColourMap,
}

impl Default for SpringColourFile {
    fn default() -> Self {
        Self { range: None, map: ColourMap::VioletGreen }
    }
}

/// Where the light comes from, seen from the camera.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct LightFile {
    /// Turn to the left around the vertical, from straight behind the viewer (rad); negative to the right. Default: 62°.
    #[schemars(range(min = -3.15, max = 3.15))]
    pub(crate) azimuth: f64,
    /// Height above the horizon (rad). Default: 50°. It falls more steeply on bodies that fly high, or their shadows would
    /// leave the picture.
    #[schemars(range(min = 0.2, max = 1.57))]
    pub(crate) elevation: f64,
}

/// Which lines are drawn on surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum EdgesFile {
    /// The outline, unless `outline = false`, and all edges, those behind the body faintly.
    #[default]
    All,
    /// The outline, unless `outline = false`, and the edges in front.
    Visible,
    /// The outline alone, unless `outline = false`. Edges of turned-over elements are drawn in any case, unless elements
    /// drawn apart are too small for lines.
    Outline,
}

/// How panels stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum ArrangementFile {
    /// Beside each other.
    Row,
    /// Below each other.
    Column,
    /// In as many rows as leave them most room.
    Grid,
}

/// A part of the body that can be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum ShowFile {
    /// The faces of the elements, with their edges.
    Surfaces,
    /// The nodes, as discs.
    Nodes,
    /// The springs of models that have them, as lines; faint where surfaces hide them.
    Springs,
    /// An arrow to each node from where the rigid placement of the rest shape nearest to the body has it. Only nodes on
    /// the surface get one, in space those that face the viewer, and at most 500.
    Displacements,
}

impl Default for LightFile {
    fn default() -> Self {
        let Light { azimuth, elevation } = Light::default();
        Self { azimuth, elevation }
    }
}

/// A scalar field and its scale of colours.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ColourFile {
    /// The field.
    pub(crate) by: Field,
    /// The values at both ends of the scale, in the field's unit. Values beyond it have the colours of its ends, and the
    /// bar then ends in a point. Default: from zero to what the scene lets expect: a
    /// strain of 0.5, a displacement of half an element's edge, the speed of a fall through the scene or at the start,
    /// the energy of an element strained by 0.5.
    pub(crate) range: Option<[f64; 2]>,
    /// The colours of the scale.
    #[serde(default)]
    pub(crate) map: ColourMap,
}

/// A perspective camera that looks at a point. A body in the plane is looked at straight from the front without
/// perspective; `distance` and `field_of_view` then say together how large it is.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct CameraFile {
    /// Turn to the right around the vertical, from looking along −z (rad). Default: 0.541, which is 31°. Not in the
    /// plane.
    pub(crate) azimuth: Option<f64>,
    /// Height above the horizon (rad), less than a quarter turn (1.57) either way, or the camera would look along its
    /// up-axis. Default: 0.297, which is 17°; under a plate that faces down 0.227, which is 13°. Not in the plane.
    #[schemars(extend("exclusiveMinimum" = -1.57, "exclusiveMaximum" = 1.57))]
    pub(crate) elevation: Option<f64>,
    /// Vertical field of view (rad). Default: 0.349, which is 20°.
    #[schemars(range(min = 0.001, max = 3.0))]
    pub(crate) field_of_view: Option<f64>,
    /// The point looked at (m). Default: the middle of the body as it would stand on the first floor below it, or
    /// where it starts if there is none. If `distance` is not given either, it moves aside for plates, spheres,
    /// capsules, boxes and grips that come near, so that they are in the picture, too.
    pub(crate) target: Option<Coordinates>,
    /// Distance from that point (m). Default: 8.5 times the largest side of the box around the body at the start, and
    /// more if the body starts higher than that shows. If `target` is not given either, it is also so large that the
    /// picture shows whatever of plates, spheres, capsules, boxes and grips is at any time within 1.25 body sizes of
    /// where the body starts and stands; what is farther away moves nothing.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) distance: Option<f64>,
    /// Whether the camera goes along with the bodies shown, alike in all panels. With `true` or `"height"` it rises and
    /// draws back with the highest body; where there is no floor to stand on, it sinks with the lowest. With `"body"` it
    /// does that and also goes along level with the common middle of the bodies.
    pub(crate) follow: FollowFile,
}

/// How the camera follows, as typed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum FollowFile {
    /// `true` for the height, `false` for nothing.
    Switch(bool),
    /// What it follows.
    What(FollowedFile),
}

/// What the camera follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum FollowedFile {
    /// The height of the bodies.
    Height,
    /// Their height, and level their common middle.
    Body,
}

impl Default for FollowFile {
    fn default() -> Self {
        Self::Switch(false)
    }
}

impl From<FollowFile> for Follow {
    fn from(typed: FollowFile) -> Self {
        match typed {
            FollowFile::Switch(false) => Self::Nothing,
            FollowFile::Switch(true) | FollowFile::What(FollowedFile::Height) => Self::Height,
            FollowFile::What(FollowedFile::Body) => Self::Body,
        }
    }
}
