//! The display list: everything flat in a picture, as paths, images and text in the order in which they are drawn.
//! Each part of a picture makes its items; three writers turn the list into pixels, SVG and PDF.

use super::measures::BEAD_RIM;
use super::narrow::narrow;
use super::plane::around;
use super::{Colour, Rectangle, TextRun};
use crate::bins::Bins;
use glam::{DVec2, Vec2};
use std::f32::consts::TAU;

/// An item of a picture. Items are drawn in their order.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Item {
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
    /// The inside of a path with colours that change evenly from one point to another.
    Blend {
        /// Its outline.
        path: Path,
        /// The points (px).
        ends: [Vec2; 2],
        /// The colours, at equal distances; at least two.
        colours: Vec<Colour>,
    },
    /// Pixels.
    Image(Image),
    /// A line of text.
    Text(TextRun),
    /// Items inside a path, and inside the clips around this one.
    Clip {
        /// Its outline.
        path: Path,
        /// The items.
        items: Vec<Item>,
    },
    /// Items that show one thing.
    Part {
        /// The name of the thing, for people who read the list.
        name: &'static str,
        /// The items.
        items: Vec<Item>,
    },
}

impl Item {
    /// A filled shape.
    pub(crate) fn fill(path: Path, paint: impl Into<Paint>) -> Self {
        Self::Fill { path, paint: paint.into() }
    }

    /// Lines along a path.
    pub(crate) fn stroke(path: Path, pen: Pen, paint: impl Into<Paint>) -> Self {
        Self::Stroke { path, pen, paint: paint.into() }
    }

    /// Items that show one thing with a name.
    pub(crate) fn part(name: &'static str, items: impl Into<Vec<Self>>) -> Self {
        Self::Part { name, items: items.into() }
    }

    /// A filled upright rectangle: left, top, width and height (px).
    pub(super) fn rectangle([left, top, width, height]: [f64; 4], colour: Colour) -> Self {
        let [left, top, width, height] = [left, top, width, height].map(narrow);
        Self::fill(Path::rectangle(Vec2::new(left, top), Vec2::new(width, height)), colour)
    }

    /// Items inside a part of the picture.
    pub(crate) fn inside(room: Rectangle, items: Vec<Self>) -> Self {
        let [left, top, width, height] = room.map(|length| narrow(f64::from(length)));
        Self::Clip { path: Path::rectangle(Vec2::new(left, top), Vec2::new(width, height)), items }
    }

    /// A straight line with straight ends (px).
    pub(super) fn line(ends: [DVec2; 2], thickness: f64, colour: Colour) -> Self {
        let pen = Pen { round: false, ..Pen::solid(narrow(thickness)) };
        Self::stroke(Path::open(&ends.map(point)), pen, colour)
    }

    /// A filled disc (px).
    pub(super) fn disc(middle: [f64; 2], radius: f64, colour: Colour) -> Self {
        Self::fill(Path::circle(point(middle.into()), narrow(radius)), colour)
    }

    /// A line through points with round joints (px). Solid lines have round ends, too. `dash` has the lengths of dashes
    /// and gaps in turn, and is empty for a solid line.
    pub(super) fn curve(points: &[[f64; 2]], width: f64, dash: &[f64], paint: impl Into<Paint>) -> Self {
        let mut points: Vec<_> = points.iter().map(|&at| point(at.into())).collect();
        points.dedup();
        if let [dot] = points[..] {
            return Self::fill(Path::circle(dot, 0.5 * narrow(width)), paint);
        }
        let dash: Vec<_> = dash.iter().map(|&length| narrow(length)).collect();
        Self::stroke(Path::open(&points), Pen { width: narrow(width), round: dash.is_empty(), dash }, paint)
    }

    /// A disc with a rim inside its radius (px).
    pub(crate) fn rimmed(middle: DVec2, radius: f64, colour: Colour, rim: Colour) -> Self {
        let (middle, radius) = (point(middle), narrow(radius));
        let width = BEAD_RIM * radius;
        // Side by side, because both may be transparent.
        let inside = Self::fill(Path::circle(middle, radius - width), colour);
        let rim = Self::stroke(Path::circle(middle, radius - 0.5 * width), Pen::solid(width), rim);
        Self::part("node", [inside, rim])
    }

    /// The item with a part of the opacity of its paths, from 0 to 1; `None` if they would be invisible.
    pub(crate) fn faded(mut self, part: f64) -> Option<Self> {
        let part = narrow(part.clamp(0.0, 1.0));
        self.fade(part);
        (part >= 0.5 / 255.0).then_some(self)
    }

    fn fade(&mut self, part: f32) {
        match self {
            Self::Fill { paint, .. } | Self::Stroke { paint, .. } => paint.alpha *= part,
            Self::Clip { items, .. } | Self::Part { items, .. } => items.iter_mut().for_each(|item| item.fade(part)),
            Self::Blend { .. } | Self::Image(_) | Self::Text(_) => {}
        }
    }
}

/// A place (px), narrowed.
pub(super) fn point(at: DVec2) -> Vec2 {
    at.to_array().map(narrow).into()
}

/// Lines between pairs of points, joined to lines that are as long and straight as possible.
pub(super) fn joined(pairs: &[[u32; 2]], place: impl Fn(u32) -> Vec2) -> Vec<Vec<u32>> {
    let points = pairs.iter().flatten().max().map_or(0, |&last| last as usize + 1);
    let of_points = Bins::new(points, (0..).zip(pairs).flat_map(|(number, pair)| pair.map(|end| (end, number))));
    let (mut lines, mut is_used) = (Vec::new(), vec![false; pairs.len()]);
    for first in 0..pairs.len() {
        if std::mem::replace(&mut is_used[first], true) {
            continue;
        }
        let mut line = pairs[first].to_vec();
        // From one end, then from the other.
        for _ in 0..2 {
            while let [.., from, to] = line[..] {
                let other = |at: usize| if pairs[at][0] == to { pairs[at][1] } else { pairs[at][0] };
                let way = |from: u32, to: u32| (place(to) - place(from)).normalize_or_zero();
                let straight = |at: &usize| way(from, to).dot(way(to, other(*at)));
                let free = of_points.of(to as usize).iter().map(|&at: &u32| at as usize).filter(|&at| !is_used[at]);
                let Some(next) = free.max_by(|a, b| straight(a).total_cmp(&straight(b))) else { break };
                is_used[next] = true;
                line.push(other(next));
            }
            line.reverse();
        }
        lines.push(line);
    }
    lines
}

/// A colour with an opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Paint {
    pub(crate) colour: Colour,
    /// The opacity, from 0 to 1.
    pub(crate) alpha: f32,
}

impl From<Colour> for Paint {
    fn from(colour: Colour) -> Self {
        Self { colour, alpha: 1.0 }
    }
}

impl From<(Colour, f64)> for Paint {
    fn from((colour, alpha): (Colour, f64)) -> Self {
        Self { colour, alpha: narrow(alpha) }
    }
}

/// The stroke of lines.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pen {
    /// Width (px).
    pub(crate) width: f32,
    /// Lengths of dashes and gaps in turn (px); empty for a solid line.
    pub(crate) dash: Vec<f32>,
    /// Whether ends are round. Joints always are.
    pub(crate) round: bool,
}

impl Pen {
    /// A solid line with round ends.
    pub(crate) fn solid(width: f32) -> Self {
        Self { width, dash: Vec::new(), round: true }
    }
}

/// Pixels on a parallelogram of the page.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Image {
    /// Width and height (px).
    pub(crate) size: [u32; 2],
    /// Red, green and blue of each pixel, or these and opacity, in rows from the top left.
    pub(crate) pixels: Vec<u8>,
    /// Its upper left corner, its upper side and its left side as vectors (px of the page).
    pub(crate) place: [Vec2; 3],
}

/// Straight and curved lines.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Path(pub(crate) Vec<Step>);

/// A part of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Step {
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
    pub(crate) fn polygon(points: &[Vec2]) -> Self {
        let mut path = Self::default();
        path.add_polygon(points);
        path
    }

    /// A line through points.
    pub(crate) fn open(points: &[Vec2]) -> Self {
        let mut path = Self::default();
        path.add_line(points);
        path
    }

    /// Lines between pairs of points, joined to lines that are as long and straight as possible: painters add up the
    /// coverage of pixels where lines overlap, so that joints of single lines would be darker, and dashes would begin anew.
    pub(super) fn joined(pairs: &[[u32; 2]], points: &[Vec2]) -> Self {
        let place = |point: u32| points[point as usize];
        let mut path = Self::default();
        for line in joined(pairs, place) {
            path.add_line(&line.into_iter().map(place).collect::<Vec<_>>());
        }
        path
    }

    /// An upright rectangle: its left upper corner and its size.
    pub(crate) fn rectangle(corner: Vec2, size: Vec2) -> Self {
        let [x, y] = [Vec2::new(size.x, 0.0), Vec2::new(0.0, size.y)];
        Self::polygon(&[corner, corner + x, corner + size, corner + y])
    }

    pub(crate) fn circle(middle: Vec2, radius: f32) -> Self {
        let mut path = Self::default();
        path.add_arc(middle, radius, [0.0, TAU], true);
        path.0.push(Step::Close);
        path
    }

    /// Adds a closed polygon.
    pub(crate) fn add_polygon(&mut self, points: &[Vec2]) {
        self.add_line(points);
        if !points.is_empty() {
            self.0.push(Step::Close);
        }
    }

    /// Adds a line through points.
    pub(crate) fn add_line(&mut self, points: &[Vec2]) {
        self.0.extend(points.iter().enumerate().map(|(at, &point)| match at {
            0 => Step::Move(point),
            _ => Step::Line(point),
        }));
    }

    /// Adds an arc of a circle from one angle to another (rad, from the right downwards). The arc begins a new piece,
    /// or is joined to the piece by a straight line.
    pub(crate) fn add_arc(&mut self, middle: Vec2, radius: f32, [from, to]: [f32; 2], begins: bool) {
        let pieces = ((to - from).abs() / (TAU / 4.0) - 1e-4).ceil().max(1.0);
        let step = (to - from) / pieces;
        // The curve has the circle's direction at both ends, and its middle is on the circle.
        let reach = 4.0 / 3.0 * libm::tanf(step / 4.0) * radius;
        let at = |angle: f32| middle + radius * direction(angle);
        self.0.push(if begins { Step::Move(at(from)) } else { Step::Line(at(from)) });
        for piece in 0..pieces as u32 {
            let [a, b] = [piece, piece + 1].map(|piece| from + step * narrow(f64::from(piece)));
            let along = |angle: f32| reach * direction(angle).perp();
            self.0.push(Step::Cubic([at(a) + along(a), at(b) - along(b), at(b)]));
        }
    }

    /// Whether the path is empty.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The points of the path, without the control points of its curves.
    pub(crate) fn points(&self) -> Vec<Vec2> {
        let end = |step: &Step| match *step {
            Step::Move(at) | Step::Line(at) | Step::Cubic([_, _, at]) => Some(at),
            Step::Close => None,
        };
        self.0.iter().filter_map(end).collect()
    }
}

/// The unit vector at an angle (rad, from the right downwards). The system's sine could differ between systems.
pub(super) fn direction(angle: f32) -> Vec2 {
    let (sine, cosine) = libm::sincosf(angle);
    Vec2::new(cosine, sine)
}

/// Twice the area of a polygon, positive if it runs clockwise on the page.
pub(crate) fn winding(points: &[Vec2]) -> f32 {
    around(points).map(|(a, b)| a.perp_dot(*b)).sum()
}
