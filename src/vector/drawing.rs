//! Items of pages in any format: filled and stroked paths, images and text.

use crate::picture::{Colour, TextRun};
use glam::Vec2;
use std::f32::consts::TAU;

/// An item of a page. Items are drawn in their order.
#[derive(Clone, Debug)]
pub(super) enum Item<'a> {
    /// The inside of a path (nonzero winding).
    Fill {
        /// Its outline.
        path: Path,
        /// Its colour.
        paint: Paint,
    },
    /// Lines along a path. Where lines of one item cross, they are painted once.
    Stroke {
        /// The middle of the lines.
        path: Path,
        /// The stroke.
        pen: Pen,
        /// Its colour.
        paint: Paint,
    },
    /// The inside of a path with a colour that changes evenly from one point to another.
    Blend {
        /// Its outline.
        path: Path,
        /// The points (px).
        ends: [Vec2; 2],
        colours: [Colour; 2],
    },
    /// Pixels.
    Image(Image),
    /// A line of text.
    Text(&'a TextRun),
    /// Limits the next items to the inside of a path, and inside of the clips before, until [`Item::Unclip`].
    Clip(Path),
    /// Ends the last clip.
    Unclip,
}

/// A colour with an opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Paint {
    pub(super) colour: Colour,
    /// The opacity, from 0 to 1.
    pub(super) alpha: f32,
}

impl From<Colour> for Paint {
    fn from(colour: Colour) -> Self {
        Self { colour, alpha: 1.0 }
    }
}

/// The stroke of lines.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Pen {
    /// Width (px).
    pub(super) width: f32,
    /// Lengths of dashes and gaps in turn (px); empty for a solid line.
    pub(super) dash: Vec<f32>,
    /// Whether ends are round. Joints always are.
    pub(super) round: bool,
}

impl Pen {
    /// A solid line with round ends.
    pub(super) fn solid(width: f32) -> Self {
        Self { width, dash: Vec::new(), round: true }
    }
}

/// Pixels on a parallelogram of the page.
#[derive(Clone, Debug)]
pub(super) struct Image {
    /// Width and height (px).
    pub(super) size: [u32; 2],
    /// Red, green and blue of each pixel, or these and opacity, in rows from the top left.
    pub(super) pixels: Vec<u8>,
    /// Its upper left corner, its upper side and its left side as vectors (px of the page).
    pub(super) place: [Vec2; 3],
}

/// Straight and curved lines.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Path(pub(super) Vec<Step>);

/// A part of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    /// Begins a new piece at a point (px).
    Move(Vec2),
    /// A straight line to a point.
    Line(Vec2),
    /// A cubic Bézier curve: two control points and its end.
    Cubic([Vec2; 3]),
    /// Back to the beginning of the piece.
    Close,
}

impl Path {
    /// A closed polygon.
    pub(super) fn polygon(points: &[Vec2]) -> Self {
        let mut path = Self::default();
        path.add_polygon(points);
        path
    }

    /// A line through points.
    pub(super) fn open(points: &[Vec2]) -> Self {
        let mut path = Self::default();
        path.add_line(points);
        path
    }

    /// An upright rectangle: its left upper corner and its size.
    pub(super) fn rectangle(corner: Vec2, size: Vec2) -> Self {
        let [x, y] = [Vec2::new(size.x, 0.0), Vec2::new(0.0, size.y)];
        Self::polygon(&[corner, corner + x, corner + size, corner + y])
    }

    pub(super) fn circle(middle: Vec2, radius: f32) -> Self {
        let mut path = Self::default();
        path.add_circle(middle, radius);
        path
    }

    pub(super) fn add_circle(&mut self, middle: Vec2, radius: f32) {
        self.add_arc(middle, radius, [0.0, TAU], true);
        self.0.push(Step::Close);
    }

    /// Adds a closed polygon.
    pub(super) fn add_polygon(&mut self, points: &[Vec2]) {
        self.add_line(points);
        if !points.is_empty() {
            self.0.push(Step::Close);
        }
    }

    /// Adds a line through points.
    pub(super) fn add_line(&mut self, points: &[Vec2]) {
        self.0.extend(points.iter().enumerate().map(|(at, &point)| match at {
            0 => Step::Move(point),
            _ => Step::Line(point),
        }));
    }

    /// Adds an arc of a circle from one angle to another (rad, from the right downwards). The arc begins a new piece,
    /// or is joined to the piece by a straight line.
    pub(super) fn add_arc(&mut self, middle: Vec2, radius: f32, [from, to]: [f32; 2], begins: bool) {
        let pieces = ((to - from).abs() / (TAU / 4.0) - 1e-4).ceil().max(1.0);
        let step = (to - from) / pieces;
        // The curve has the circle's direction at both ends, and its middle is on the circle.
        let reach = 4.0 / 3.0 * (step / 4.0).tan() * radius;
        let at = |angle: f32| middle + radius * Vec2::from_angle(angle);
        self.0.push(if begins { Step::Move(at(from)) } else { Step::Line(at(from)) });
        for piece in 0..pieces as u32 {
            let [a, b] = [piece, piece + 1].map(|piece| from + step * piece as f32);
            let along = |angle: f32| reach * Vec2::from_angle(angle).perp();
            self.0.push(Step::Cubic([at(a) + along(a), at(b) - along(b), at(b)]));
        }
    }

    /// Whether the path is empty.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}
