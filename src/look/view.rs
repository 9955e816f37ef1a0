//! The view of a scene.

use super::camera::{Camera, CameraFile};
use super::file::{ColourFile, ColourMap, PanelsFile};
use super::font::{FontFile, FontFiles};
use super::palette::{Palette, Theme};
use super::plot::Plot;
use super::print::{Print, SizeFile, TextScaleFile};
use super::typed::TypedColour;
use crate::colour::Colour;
use crate::sim::{Body, Dimension, Field};
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The drawing of a scene. Plain data, kept also in builds without the renderer, so that every scene can be checked.
///
/// The `[view]` table of a scene file has these keys. Missing keys take defaults. Some defaults depend on the scene.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(default)]
#[schemars(deny_unknown_fields, rename = "ViewFile")]
pub struct View {
    /// Width and height of the picture (px), or for print, such as `{ mm = [180, 101] }`.
    #[schemars(with = "SizeFile")]
    pub size: [u32; 2],
    /// The size in print, if it was given.
    #[serde(skip)]
    pub print: Option<Print>,
    /// Colours and type.
    #[serde(flatten)]
    pub look: Style,
    /// The words below the time. Default: `after release`; in scenes with `hold`, `grab`, `load` or `states` `after the start`.
    #[serde(serialize_with = "open")]
    #[schemars(length(max = 80))]
    pub clock: String,
    /// The number of panels in a row, or all of them in a `"row"` or a `"column"`. Default: the number that makes bodies largest.
    #[serde(rename = "panels", serialize_with = "open")]
    #[schemars(with = "PanelsFile")]
    pub columns: Option<usize>,
    /// The drawn parts of the body. Without `surfaces` lines are drawn: springs if they are shown and exist, else the
    /// edges of elements. Edges of turned-over elements always stand out. Default: surfaces; in the plane also nodes,
    /// unless the body has more than 150.
    #[serde(rename = "show", serialize_with = "open")]
    #[schemars(with = "Vec<Part>", length(min = 1))]
    pub visible: Visible,
    /// A scalar field that colours the surfaces of the body, such as `{ by = "strain" }`, or its lines and nodes
    /// without surfaces. All panels share one colour bar, drawn below them. Springs without surfaces have a strain of
    /// their own, the change of length over the length at rest. It has a sign if the range begins below zero, such as
    /// `{ by = "strain", range = [-0.3, 0.3], map = "violet-green" }`. Default: none.
    #[serde(serialize_with = "open")]
    #[schemars(with = "ColourFile")]
    pub colour: Option<ColourScale>,
    /// Scale of the arrows of displacements, contacts and loads. At 1 an arrow of a displacement ends at its node, one of a force of contact as
    /// large as the mean weight of bodies on Earth is as long as half of the largest body, and that of the largest load is .4 of it.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub arrow_scale: f64,
    /// Length of an element's edge, the unit of the floor's grid and of soft distances in light and shadow (m).
    #[serde(skip)]
    pub side: f64,
    /// Whether `side` is the side of a lattice's cells, which the floor's grid then repeats; otherwise it is a mean of
    /// edges.
    #[serde(skip)]
    pub has_cells: bool,
    /// The names of the bodies by their places in runs, which the key explains; empty if no run has several bodies.
    #[serde(skip)]
    pub(crate) bodies: Vec<String>,
    /// A title above all panels, wrapped at the width of the picture. Default: none.
    #[schemars(length(max = 200))]
    pub title: String,
    /// A caption below all panels, wrapped at the width of the picture. `\n` begins a new line. Panels keep over a
    /// third of the picture: longer captions are cut off with an ellipsis. Default: none.
    #[schemars(length(max = 2000), extend("format" = "lines"))]
    pub caption: String,
    /// The words and signs in panels and below them.
    #[schemars(with = "Vec<Label>")]
    pub labels: Labels,
    /// Diagnostics plotted over the whole time of the scene, each in a chart below all panels, such as `["energy"]`,
    /// with the current time marked. In the first chart, numbered flags mark the moments when elements first turn over
    /// and when their count settles, or the extreme value; if nearly all its changes are early, that time has a larger
    /// scale. Also what is measured of one thing: `{ plot = "force", of = "hold[0]" }`, and against a displacement as in a
    /// test machine: `{ plot = "force", of = "grab[0]", against = "grab[0]" }`, in a chart below all others.
    /// The whole scene is simulated before the first frame is drawn. Default: none.
    #[schemars(length(max = 6))]
    pub charts: Vec<Plot>,
    /// A dashed outline over each body: `"rest"` for the rest shape in its best rigid fit, or the name of a run for its
    /// body at the same moment, in the colour of that run. All runs must have the same time step. Default: none.
    #[serde(serialize_with = "open")]
    #[schemars(with = "String", length(min = 1, max = 80))]
    pub ghost: Option<Ghost>,
    /// Points whose paths up to the present moment are drawn in the colours of runs: `"centre"` for the centre of mass,
    /// and nodes, counted from 0, such as `["centre", 26]`. The whole scene is simulated before the first frame is
    /// drawn. Default: none.
    #[serde(serialize_with = "open")]
    #[schemars(length(min = 1, max = 64))]
    pub paths: Vec<Traced>,
    /// Whether bodies and obstacles cast shadows, on the floor and on each other.
    pub shadow: bool,
    /// The drawing of floors. In the plane they have no grid.
    pub floor: FloorStyle,
    /// The lines on surfaces.
    pub edges: EdgeStyle,
    /// The camera. It follows the centre of mass of each run's body. All panels and frames have one scale, at which the
    /// body takes about 60 % of its panel's width at its widest moment, or up to a fifth less to show obstacles near it.
    /// Where all simulated runs hold or grab nodes throughout, it stands still and sees all that bodies reach, if they need no more than twice the space.
    /// The whole scene is simulated before the first frame is drawn. With a `target` or a `distance` the camera is fixed.
    #[serde(serialize_with = "open")]
    #[schemars(with = "CameraFile")]
    pub camera: Camera,
}

/// For the schema, which has no default for values that follow from the scene.
fn open<T, S: Serializer>(_: &T, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_none()
}

impl View {
    /// The runs that pictures of other runs need, each with the key that names it.
    pub fn compared(&self) -> [Option<(&'static str, usize)>; 2] {
        let ghost = if let Some(Ghost::Run(run)) = self.ghost { Some(run) } else { None };
        let to = self.colour.and_then(|scale| scale.to);
        [ghost.map(|run| ("ghost", run)), to.map(|run| ("colour.to", run))]
    }

    /// The names of the bodies whose surfaces have a colour of their own.
    #[cfg(feature = "render")]
    pub(crate) fn coloured_bodies(&self) -> &[String] {
        if self.visible.surfaces && self.colour.is_none() { &self.bodies } else { &[] }
    }

    /// Which overlays the key explains: displacements, loads, contacts, a ghost, and paths.
    #[cfg(feature = "render")]
    pub(crate) fn explained(&self) -> [bool; 5] {
        let Visible { displacements, loads, contacts, .. } = self.visible;
        [displacements, loads, contacts, self.ghost.is_some(), !self.paths.is_empty()]
    }

    /// Whether there is a key: of colours, lines or arrows.
    #[cfg(feature = "render")]
    pub(crate) fn has_key(&self) -> bool {
        let has_more = || self.colour.is_some() || !self.coloured_bodies().is_empty();
        self.labels.legend && (self.explained().contains(&true) || has_more())
    }
}

impl Default for View {
    /// The view of a scene without settings, from a metre before the origin.
    fn default() -> Self {
        Self {
            size: [1280, 720],
            print: None,
            look: Style::of(Theme::default()),
            camera: Camera {
                azimuth: 0.0,
                elevation: 0.0,
                field_of_view: 20.0 / 180.0 * std::f64::consts::PI,
                target: DVec3::ZERO,
                distance: 1.0,
                follow: false,
                turns: false,
            },
            clock: String::new(),
            columns: None,
            visible: Visible { surfaces: true, ..Visible::default() },
            colour: None,
            arrow_scale: 1.0,
            side: 1.0,
            has_cells: false,
            bodies: Vec::new(),
            title: String::new(),
            caption: String::new(),
            labels: Labels::default(),
            charts: Vec::new(),
            ghost: None,
            paths: Vec::new(),
            shadow: true,
            floor: FloorStyle::default(),
            edges: EdgeStyle::default(),
        }
    }
}

/// A set that files write as a list of words.
macro_rules! words {
    (
        $(#[$about:meta])* $set:ident,
        $(#[$about_word:meta])* $word:ident { $($(#[$doc:meta])* $name:ident,)* }
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub struct $set {
            $($(#[$doc])* pub $name: bool,)*
        }

        $(#[$about_word])*
        #[derive(Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(rename_all = "kebab-case")]
        #[allow(non_camel_case_types, reason = "words of files, which are also fields")]
        pub(super) enum $word { $($(#[$doc])* $name,)* }

        impl $set {
            /// Nothing.
            pub const NONE: Self = Self { $($name: false,)* };
        }

        impl<'de> Deserialize<'de> for $set {
            fn deserialize<D: Deserializer<'de>>(list: D) -> Result<Self, D::Error> {
                let words = Vec::<$word>::deserialize(list)?;
                Ok(Self { $($name: words.contains(&$word::$name),)* })
            }
        }

        impl Serialize for $set {
            fn serialize<S: Serializer>(&self, list: S) -> Result<S::Ok, S::Error> {
                let words = [$((self.$name, $word::$name),)*].into_iter();
                list.collect_seq(words.filter(|(is_there, _)| *is_there).map(|(_, word)| word))
            }
        }
    };
}

words! {
    /// The words and signs in panels and below them.
    Labels,
    /// The name of a label.
    Label {
        /// A letter before each name: a, b, c and so on.
        letters,
        /// The run's name.
        name,
        /// The model and its parameters.
        model,
        /// The time, in one panel only.
        clock,
        /// The number of turned-over elements, or of broken ones in runs that break. With springs that break, an element is in pieces when
        /// those that are left do not hold its nodes together; `broken` in charts and files counts the springs.
        count,
        /// The shape error; in the plane, the smallest area ratio. Divergence is always shown. Also the height (m) of the lowest body above
        /// the ground, if it is more than half a body's size or the ground is out of sight, and the camera follows.
        number,
        /// A scale bar (m), in the first panel; in space it holds at the distance of the camera's target.
        scale_bar,
        /// The meaning of colours and arrows, below all panels, if there is room.
        legend,
    }
}

impl Default for Labels {
    /// All labels except letters.
    fn default() -> Self {
        let [name, model, clock, count, number, scale_bar, legend] = [true; 7];
        Self { letters: false, name, model, clock, count, number, scale_bar, legend }
    }
}

/// The lines on surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum EdgeStyle {
    /// The outline and all edges. Hidden ones are faint, or left out if elements are many and small.
    #[default]
    All,
    /// The outline and visible edges.
    Visible,
    /// The outline, and edges of turned-over elements.
    Outline,
}

/// The drawing of floors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FloorStyle {
    /// With a grid in space, of the cells of a lattice, or of few cells for other bodies.
    #[default]
    Grid,
    /// Without a grid.
    Plain,
    /// Only the shadows on it.
    None,
}

words! {
    /// The drawn parts of a body.
    #[derive(Default)]
    Visible,
    /// A part of the body that can be drawn.
    Part {
        /// The faces of the elements, with their edges.
        surfaces,
        /// The nodes, as discs.
        nodes,
        /// The springs of mass-spring models, as lines, faint behind surfaces.
        springs,
        /// An arrow to each node from its place in the best-fitting rigid placement of the rest shape. Only for nodes on
        /// the surface that face the viewer, and for at most 500.
        displacements,
        /// Dots where bodies touch, and there hollow arrows for the mean force of each obstacle and body on each body, in the interval of the row
        /// of `diagnostics.csv`.
        contacts,
        /// An arrow for each force of a load, arrows on faces under pressure, and an arc for each torque.
        loads,
        /// The edges of the elements that carry a fine surface, as lines over it. Surfaces are drawn, too.
        cage,
    }
}

impl Visible {
    /// The drawn parts of a body with a number of nodes by default: surfaces, and in the plane also nodes, unless they
    /// are many.
    pub(crate) fn usual(dimension: Dimension, nodes: usize) -> Self {
        const MANY_NODES: usize = 150;
        Self { surfaces: true, nodes: dimension == Dimension::Plane && nodes <= MANY_NODES, ..Self::default() }
    }
}

/// The colours of a scalar field. They do not depend on the motion, so that any frame can be drawn alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourScale {
    /// The field.
    pub field: Field,
    /// The run to which [`Field::Distance`] is measured, by its index.
    pub to: Option<usize>,
    /// The values at the two ends of the scale, in the field's unit.
    pub range: [f64; 2],
    /// The colours.
    pub map: ColourMap,
}

/// The appearance of a picture apart from its content: colours and type.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(default)]
pub struct Style {
    /// The colours.
    pub theme: Theme,
    /// The background, hexadecimal or a CSS name such as `"ivory"`. The other theme is used if this one's text cannot be
    /// read on it. Default: the theme's.
    #[schemars(with = "Option<TypedColour>")]
    pub background: Option<Colour>,
    /// The font files, such as `{ regular = "NotoSansCJK.ttc" }`. Default: the built-in font, which has Latin and Greek
    /// letters.
    #[serde(serialize_with = "open")]
    #[schemars(with = "FontFile")]
    pub font: FontFiles,
    /// Scale of all text, or in pictures for print the size of most text, such as `{ pt = 7 }`. Long titles are
    /// wrapped. `localshape check` lists other words without room, which are shortened or left out. The smallest text
    /// is a fiftieth of the height of a wide picture, or smaller with a scale below 1. Above 1.5 times the usual size
    /// names and titles grow less than other text. Type below 5 pt is refused in pictures for print.
    #[schemars(with = "TextScaleFile")]
    pub text_scale: f64,
}

impl Style {
    /// The style of a theme without settings.
    pub fn of(theme: Theme) -> Self {
        Self { theme, background: None, font: FontFiles::default(), text_scale: 1.0 }
    }

    /// All colours of a picture.
    pub(crate) fn palette(&self) -> Palette {
        Palette::with(self.theme, self.background)
    }
}

impl Default for Style {
    fn default() -> Self {
        Self::of(Theme::default())
    }
}

/// The outline over each body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ghost {
    /// The rest shape, in its best rigid fit.
    Rest,
    /// The body of a run of the scene, by its index, at the same moment.
    Run(usize),
}

/// A point of a body with a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Traced {
    /// The centre of mass.
    Centre,
    /// A node, counted from 0.
    #[serde(untagged)]
    Node(u32),
}

impl Traced {
    /// Its place on a body with nodes at given positions (m).
    pub(crate) fn of(self, body: &Body, position: &[DVec3]) -> DVec3 {
        match self {
            Self::Centre => {
                let weighed = position.iter().zip(body.mass()).map(|(&at, &mass)| mass * at);
                weighed.sum::<DVec3>() / body.mass().iter().sum::<f64>()
            }
            Self::Node(node) => position[node as usize],
        }
    }
}
