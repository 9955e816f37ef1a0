//! Turns a frame of the simulation into a [`Picture`]: lit bodies as meshes and lines, and all that is flat as one list of
//! items, as plain data. Nothing here needs a graphics device, so everything can be tested without one.
//!
//! ```text
//! Scene ─▶ Composer ─ compose(Frame) ─▶ Picture ─▶ render
//! ```
//!
//! A [`Composer`] computes once the data that all frames of a scene share. Any frame can be composed alone: the result
//! depends only on the scene and the frame. Charts ([`crate::look::View::charts`]) and paths show time series of the
//! whole scene, which the composer gets beforehand; these depend only on the scene, too.

mod arrows;
mod camera;
mod caption;
mod chart;
mod compose;
mod cut;
mod description;
mod diagram;
mod ears;
mod field;
mod flat;
mod framing;
mod ghost;
mod key_map;
mod layout;
mod legend;
pub(crate) mod measures;
mod narrow;
mod number;
mod order;
mod page;
mod plane;
mod shadow;
mod shell;
mod tally;
mod text;
mod wrap;

pub(crate) use crate::colour::Colour;
pub(crate) use crate::look::{Palette, SHADES};
pub(crate) use camera::Framing;
pub use chart::{Annotation, Axis, Chart, Layer, Name};
pub use compose::Composer;
pub(crate) use compose::{compose_figure, left_out, type_left_out};
pub use diagram::{Diagram, TextStyle, colours, dashes};
pub(crate) use ears::newell;
pub(crate) use layout::Rectangle;
#[cfg(test)]
pub(crate) use page::winding;
pub(crate) use page::{Image, Item, Paint, Path, Pen, Step};
pub(crate) use plane::{around, clipped, sides};
pub(crate) use shadow::{CELLS, Shade};
pub(crate) use text::{Face, Fonts, Glyph, TextRun, Weight};

use glam::{Mat4, Vec2, Vec3};
use narrow::narrow;

/// A whole frame, ready to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width and height (px).
    pub(crate) size: [u32; 2],
    /// Its colours.
    pub(crate) palette: Palette,
    /// The fonts of its text.
    pub(crate) fonts: Fonts,
    /// The colours of a scalar field from the lowest to the highest value, [`SHADES`] of them; empty if no panel shows one.
    pub(crate) ramp: Vec<Colour>,
    /// A panel for each run shown.
    pub(crate) panels: Vec<Panel>,
    /// Flat items below the marks: bodies in the plane and their surroundings.
    pub(crate) under: Vec<Item>,
    /// Flat items above the bodies: marks, then curves, then text.
    pub(crate) above: Vec<Item>,
}

/// One run, seen by one camera. Lengths are in sides ([`crate::look::View::side`]), from the panel's origin.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Panel {
    /// The part of the picture that belongs to it.
    pub viewport: Rectangle,
    /// The part of the viewport that the body and its lines may cover. Its width or height is 0 if there is none.
    pub region: Rectangle,
    /// Camera and light.
    pub sight: Sight,
    /// The floor, if it is drawn.
    pub floor: Option<Floor>,
    /// The boundary of the elements that have not turned over.
    pub sound: Mesh,
    /// The boundary of the elements that have turned over.
    pub turned_over: Mesh,
    /// Whether some elements of `sound` are flat, and so dotted.
    pub dotted: bool,
    /// Whether the body is grey, because its run diverges or has diverged.
    pub greyed: bool,
    /// Edges and contours of both surfaces, and of solid obstacles.
    pub lines: Vec<Line>,
    /// Lines at which the colours of surfaces may change, drawn or not: pixels that they cross are smoothed.
    pub borders: Vec<Line>,
    /// The obstacles besides the floor.
    pub obstacles: Obstacles,
    /// Coloured lines, such as springs, above the surfaces, in the order in which they are drawn.
    pub strokes: Vec<Stroke>,
    /// Nodes, above the strokes, in the order in which they are drawn.
    pub beads: Vec<Bead>,
    /// Whether the body leaves the viewport.
    pub is_cut: bool,
}

/// The obstacles of a panel.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Obstacles {
    /// Opaque obstacles; in the plane the nearest is the last.
    pub solids: Vec<Solid>,
    /// The faces of transparent obstacles towards the viewer, from the farthest to the nearest.
    pub panes: Vec<Pane>,
    /// The edges of plates, which are drawn over all panes.
    pub edges: Vec<[[f32; 3]; 2]>,
    /// In space, the obstacles near the body, which occlude its ambient light; at most [`MOST_OCCLUDERS`].
    pub occluders: Vec<Occluder>,
    /// The fading of its solids at the sides of their room; `None` if none leaves it.
    pub fade: Option<Fading>,
}

/// The fading of solid obstacles at the sides of a room: left, top, right and bottom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fading {
    /// The sides (px).
    pub(crate) room: [f32; 4],
    /// The distances of the fading, across and up (px).
    pub(crate) distance: [f32; 2],
    /// The strength of the fading, from 0 to 1.
    pub(crate) strength: [f32; 4],
}

/// The largest number of obstacles that occlude the ambient light of a body.
pub(crate) const MOST_OCCLUDERS: usize = 5;

/// An obstacle that occludes the ambient light of a body near it: all points within a distance of a box. It is a
/// rounded box, a capsule or a sphere; a plate or a wall is a very large one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Occluder {
    /// The middle of the box.
    pub centre: Vec3,
    /// Half of its sides.
    pub half: Vec3,
    /// Its rotation, as a quaternion.
    pub rotation: [f32; 4],
    /// The distance.
    pub radius: f32,
    /// Whether it is transparent.
    pub is_clear: bool,
}

/// A closed surface of one colour.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Solid {
    /// The surface; in the plane the corners of a polygon alone.
    pub mesh: Mesh,
    /// Its colour, before lighting.
    pub colour: Colour,
}

impl Panel {
    /// Whether the box around a pane may lie over a part of the picture: left, top, right and bottom (px).
    pub(crate) fn has_pane_at(&self, [left, top, right, bottom]: [f32; 4]) -> bool {
        let [x, y, width, height] = self.viewport.map(|length| narrow(length.into()));
        let is_at = |pane: &Pane| {
            let corners = pane.corners.iter().map(|corner| self.sight.clip * Vec3::from(corner.position).extend(1.0));
            let corners: Vec<_> = corners.collect();
            // A corner behind the viewer may be anywhere.
            let is_ahead = corners.iter().all(|at| at.w > self.sight.near);
            let places = corners.iter().map(|at| Vec2::new(at.x, -at.y) / at.w);
            let places = places.map(|at| Vec2::new(x, y) + Vec2::new(width, height) * (0.5 + 0.5 * at));
            let [low, high] =
                places.fold([Vec2::INFINITY, Vec2::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)]);
            !is_ahead || low.x < right && high.x > left && low.y < bottom && high.y > top
        };
        self.obstacles.panes.iter().any(is_at)
    }
}

/// A transparent convex polygon.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Pane {
    /// Its corners, around it.
    pub corners: Vec<PaneCorner>,
    /// Its colour.
    pub colour: Colour,
    /// Its opacity.
    pub alpha: f32,
    /// Whether it has a grid, like the floor.
    pub grid: bool,
}

/// A corner of a pane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PaneCorner {
    /// Its position.
    pub position: [f32; 3],
    /// Its coordinates on the grid, whose lines are at whole numbers.
    pub grid: [f32; 2],
    /// Its coordinates in the unit circle at which the pane has faded out. A pane with all corners at zero does not
    /// fade.
    pub from_middle: [f32; 2],
}

/// Camera and light of a panel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sight {
    /// From the panel's coordinates to clip space of its viewport. Depth is `near` over the distance.
    pub clip: Mat4,
    /// The position of the eye.
    pub eye: Vec3,
    /// Distance of the near plane.
    pub near: f32,
    /// Pixels of the picture for a slope of one; in the plane, for one side.
    pub focal: f32,
    /// Unit vector towards the key light.
    pub key: Vec3,
    /// From the panel's coordinates to the box in which surfaces cast shadows on each other, seen from the key light: from −1 to 1 across and
    /// up, and from 0 to 1 towards the light. `None` if there are none.
    pub key_map: Option<Mat4>,
    /// Whether faces have flat colours without light, seen without perspective.
    pub flat: bool,
    /// Thickness of lines, relative to the reference picture.
    pub line_scale: f32,
    /// Length of an element's edge at the body's distance (px).
    pub element: f32,
    /// Width of the body's contours, from 0 to 1: below 1 if the body is small.
    pub contour_share: f32,
    /// The strength of folds inside the turned-over set, from 0 to 1: below 1 if elements are small, 0 if they are many.
    pub folds: f32,
    /// The pixel of the body's middle, to which the hatch of flat bodies is fixed.
    pub middle: [f32; 2],
    /// Unit of soft distances in light and of steps in depth: a side, or more for bodies of many small elements.
    pub soft: f32,
}

/// The floor of a panel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Floor {
    /// Unit vector out of it.
    pub normal: Vec3,
    /// Unit vectors along its grid.
    pub axes: [Vec3; 2],
    /// Its place along the normal.
    pub height: f32,
    /// Distance of the grid's lines.
    pub cell: f32,
    /// The shift of coordinates by which the grid's lines come to whole cells.
    pub grid: [f32; 2],
    /// The distances from the origin of its axes at which it begins and ends to fade.
    pub fade: [f32; 2],
    /// The heights below the upper side and above the lower side of the viewport over which it fades (px).
    pub fade_at_words: [f32; 2],
    /// Whether it has a colour of its own, besides shadows and grid.
    pub is_filled: bool,
    /// Whether its grid is drawn.
    pub has_grid: bool,
    /// The shadows of key light and sky on it.
    pub shades: [Shade; 2],
}

/// A closed surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Mesh {
    /// Its corners.
    pub vertices: Vec<Vertex>,
    /// Its triangles, counter-clockwise from outside the set that it bounds.
    pub triangles: Vec<[u32; 3]>,
    /// Further triangles, which turn away from the viewer and are not drawn, but cast shadows on other surfaces.
    pub unseen: Vec<[u32; 3]>,
    /// The place of each corner on the scale of a field, from 0 to 1; −1 without a value, and −1 minus the number of its body
    /// if bodies have colours of their own. Empty if there is neither.
    pub shades: Vec<f32>,
    /// Coordinates of each corner that are 0 or 255 at the edges of its element. Empty if edges are lines.
    pub edges: Vec<[u8; 4]>,
}

/// A corner of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct Vertex {
    /// Its position.
    pub position: [f32; 3],
    /// Normal of the face, of any length.
    pub normal: [f32; 3],
    /// On turned-over elements: its place in the hatch, which is fixed to the material, in periods. On others: 1 if the
    /// element is flat, and so dotted, else 0. On solid obstacles in space: the share of ambient light that the body
    /// occludes, 1 where they touch face to face.
    pub hatch: f32,
}

/// A straight line in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    /// One end.
    pub from: [f32; 3],
    /// The other end.
    pub to: [f32; 3],
    /// Its kind.
    pub kind: LineKind,
    /// From 0 to 1: the opacity of a contour, or of an edge of a sound element behind a surface.
    pub strength: f32,
}

/// The kind of a line, which determines its look.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum LineKind {
    /// An edge of an element that is not turned over.
    Edge,
    /// An edge of a turned-over element.
    AlarmEdge,
    /// A place where the surface of the elements that are not turned over turns away from the viewer.
    Contour,
    /// A place where the surface of the turned-over elements turns away from the viewer.
    AlarmContour,
    /// An edge of an element without faces.
    Bar,
    /// A place where a carried surface turns away from the viewer. It continues the line before it that ends where it begins.
    FineContour,
    /// An edge of a solid obstacle.
    ObstacleEdge,
    /// A place where the surface of a solid obstacle turns away from the viewer or ends at the floor.
    ObstacleContour,
}

impl LineKind {
    /// Whether it belongs to turned-over elements.
    pub(crate) fn is_alarm(self) -> bool {
        matches!(self, Self::AlarmEdge | Self::AlarmContour)
    }

    /// The kind of the contours of surfaces with edges of this kind.
    pub(crate) fn contour(self) -> Self {
        if self.is_alarm() { Self::AlarmContour } else { Self::Contour }
    }
}

/// A straight coloured line in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stroke {
    /// Its ends.
    pub ends: [[f32; 3]; 2],
    /// The colours at its ends.
    pub colours: [Colour; 2],
    /// Its second colour, if it has one.
    pub second: Second,
    /// Opacity of its parts behind a surface.
    pub behind: u8,
    /// Its width (px).
    pub width: f32,
}

/// The second colour of a stroke.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Second {
    /// No second colour.
    None,
    /// A colour that replaces the first ones over surfaces.
    OnBody(Colour),
    /// A casing along both sides, which makes light colours visible on light ground.
    Casing(Colour),
}

/// A node: a disc that always faces the viewer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bead {
    /// Its middle.
    pub at: [f32; 3],
    /// Its radius (px).
    pub radius: f32,
    /// Its colour.
    pub colour: Colour,
    /// The colour of its rim.
    pub rim: Colour,
}

impl Picture {
    /// Width and height (px), for its [`Renderer`](crate::Renderer).
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Its lines of text.
    pub(crate) fn words(&self) -> impl Iterator<Item = &TextRun> {
        self.above.iter().filter_map(|item| if let Item::Text(run) = item { Some(run) } else { None })
    }
}
