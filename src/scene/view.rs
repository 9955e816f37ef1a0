//! How a scene is looked at, resolved.

use crate::sim::body::Dimension;
use crate::sim::field::Field;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a scene is drawn. Plain data, kept also by builds that cannot draw, so that every scene can be checked.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Width and height of the picture (px).
    pub size: [u32; 2],
    /// Its colours.
    pub theme: Theme,
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
