//! How a scene is looked at, resolved.

use super::palette::Palette;
use crate::sim::body::Dimension;
use crate::sim::field::Field;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::Arc;

/// How a scene is drawn. Plain data, kept also by builds that cannot draw, so that every scene can be checked.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Width and height of the picture (px).
    pub size: [u32; 2],
    /// Its colours: those asked for, unless its text could not be read on the background.
    pub theme: Theme,
    /// What it looks like.
    pub look: Look,
    /// From where; the same for all panels.
    pub camera: Camera,
    /// What the clock counts from, shown under the time, such as `after first contact`.
    pub clock: String,
    /// How many panels stand beside each other before a new row begins.
    pub columns: usize,
    /// What is drawn of the body.
    pub visible: Visible,
    /// What its surface is coloured by, if not by what it is.
    pub colour: Option<ColourScale>,
    /// How many times longer than the displacements their arrows are drawn.
    pub arrow_scale: f64,
    /// Length of an element's edge, the unit of the floor's grid and of soft distances in light and shadow (m).
    pub side: f64,
}

/// What is drawn of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Visible {
    /// The faces of the elements, with their edges.
    pub surfaces: bool,
    /// The nodes, as discs.
    pub nodes: bool,
    /// The springs of models that have them, as lines.
    pub springs: bool,
    /// An arrow to each node from where the best rigid placement of the rest shape has it.
    pub displacements: bool,
}

impl Visible {
    /// What a scene that says nothing about it shows of a body of a number of nodes: its surfaces, and in the plane the
    /// nodes, too, unless they are many.
    pub fn usual(dimension: Dimension, nodes: usize) -> Self {
        const MANY_NODES: usize = 150;
        Self { surfaces: true, nodes: dimension == Dimension::Plane && nodes <= MANY_NODES, ..Self::default() }
    }
}

/// The colours of a scalar field. They do not depend on the motion, so that any frame can be drawn by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourScale {
    /// The field.
    pub field: Field,
    /// The values at the two ends of the scale, in the field's unit.
    pub range: [f64; 2],
    /// Its colours.
    pub map: ColourMap,
}

/// Named scales of colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ColourMap {
    /// From pale mint through teal to indigo, made for these pictures: never near to vermilion, and edges show on all of
    /// it. Large values are dark in the light theme and light in the dark one.
    #[default]
    MintIndigo,
    /// From dark violet through teal to yellow (matplotlib), in either theme.
    Viridis,
    /// From dark blue to yellow, alike to all eyes (Nuñez, Anderton, Renslow 2018), in either theme.
    Cividis,
    /// From black through crimson to pale yellow (matplotlib), in either theme. On the way it is orange, near to the
    /// colour of turned-over elements: give these another one, `colours.turned_over`, if both matter.
    Magma,
    /// From light to dark grey in the light theme, from dark to light in the dark one.
    Greys,
    /// From purple through white to green (ColorBrewer PRGn), in either theme: for values on both sides of a middle.
    PurpleGreen,
}

/// What a picture looks like besides what it shows: colours, type and lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// All colours.
    pub palette: Palette,
    /// Whether the background is left out, so that whatever a picture is laid on shows.
    pub transparent: bool,
    /// The font.
    pub font: FontFiles,
    /// How many times larger than usual type is.
    pub text_scale: f64,
    /// How many times thicker than usual lines are.
    pub line_scale: f64,
}

impl Look {
    /// What pictures of a theme look like where a scene says nothing else.
    pub fn of(theme: Theme) -> Self {
        Self {
            palette: Palette::of(theme),
            transparent: false,
            font: FontFiles::default(),
            text_scale: 1.0,
            line_scale: 1.0,
        }
    }
}

/// The fonts that a scene brings with it, as the bytes of their files, which have been found to be fonts. Where there
/// is none the built-in font serves.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct FontFiles {
    /// For everything that explains.
    pub regular: Option<Arc<[u8]>>,
    /// For names and counts; the regular one serves if there is no other.
    pub semi_bold: Option<Arc<[u8]>>,
}

impl fmt::Debug for FontFiles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Millions of bytes tell nobody anything.
        let bytes = |font: &Option<Arc<[u8]>>| font.as_ref().map(|font| font.len());
        let [regular, semi_bold] = [bytes(&self.regular), bytes(&self.semi_bold)];
        f.debug_struct("FontFiles").field("regular", &regular).field("semi_bold", &semi_bold).finish()
    }
}

/// The colours of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Theme {
    /// Near-white ground, for papers.
    #[default]
    Light,
    /// Near-black ground, for talks.
    Dark,
}

/// A perspective camera that looks at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Turn to the right around the vertical, from looking along −z (rad).
    pub azimuth: f64,
    /// Height above the horizon (rad), less than a quarter turn either way.
    pub elevation: f64,
    /// Vertical field of view (rad).
    pub field_of_view: f64,
    /// The point looked at (m).
    pub target: DVec3,
    /// Distance from it (m).
    pub distance: f64,
    /// How much higher the body starts than it would stand, where target and distance were chosen to show both (m).
    pub rise: f64,
    /// How it goes along with the bodies shown, alike in all panels.
    pub follow: Follow,
}

/// How a camera goes along with the bodies shown. What it does is a function of the frame alone, so that any frame can
/// be drawn by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Follow {
    /// It stays where it is.
    #[default]
    Nothing,
    /// It rises and draws back with the highest body; without a level floor it sinks with the lowest.
    Height,
    /// It does that, and goes along level with the common middle of the bodies.
    Body,
}
