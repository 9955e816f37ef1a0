//! Pictures with their lists read back as marks, curves and words.

use glam::Vec2;
use localshape::picture::{self, Item, Paint, Path, Pen, Picture, Step, TextRun};
use localshape::runner::Frame;
use localshape::runner::history::History;
use localshape::runner::moments::Moments;
use localshape::scene::Scene;
use localshape::scene::figure::Figure;
use std::ops::{Deref, DerefMut};

/// A picture and what its list shows.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Listed {
    picture: Picture,
    /// Marks below the bodies.
    pub(super) floors: Vec<Mark>,
    /// Marks above the bodies.
    pub(super) marks: Vec<Mark>,
    /// Lines and dots above the bodies.
    pub(super) curves: Vec<Curve>,
    /// Text.
    pub(super) words: Vec<TextRun>,
}

/// A shape: a rectangle, or a part with a name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mark {
    /// The name of the part; `rectangle`, `line` or `colours` for other shapes.
    pub(super) shape: &'static str,
    /// Left, top, width and height of its box (px); of an arrow or a line its start, length and thickness; of a floor
    /// the box that is turned around its left upper corner.
    pub(super) rectangle: [f32; 4],
    /// The direction of an arrow or a line.
    pub(super) along: [f32; 2],
    /// Its colour.
    pub(super) colour: [u8; 3],
    /// Its opacity (of 255).
    pub(super) opacity: u8,
}

impl Mark {
    pub(super) const UPRIGHT: [f32; 2] = [1.0, 0.0];
}

/// A line, or a dot of one point.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve {
    pub(super) points: Vec<[f32; 2]>,
    pub(super) width: f32,
    pub(super) dash: Vec<f32>,
    pub(super) colour: [u8; 3],
    pub(super) alpha: f32,
    /// The rectangle outside of which it is not drawn: left, top, width and height (px).
    pub(super) room: Option<[f32; 4]>,
}

impl From<Picture> for Listed {
    fn from(picture: Picture) -> Self {
        let ([mut floors, mut marks], mut curves) = ([Vec::new(), Vec::new()], Vec::new());
        for item in &picture.under {
            match item {
                Item::Clip { items, .. } if !parts(items, "floor").is_empty() => {
                    items.iter().for_each(|item| read(item, &mut floors, &mut curves));
                }
                item => read(item, &mut floors, &mut curves),
            }
        }
        for item in &picture.above {
            let (items, room) = match item {
                Item::Clip { path, items } => (&items[..], Some(bounds(path))),
                item => (std::slice::from_ref(item), None),
            };
            let first = curves.len();
            items.iter().for_each(|item| read(item, &mut marks, &mut curves));
            let room = room.map(|[low, high]| [low.x, low.y, high.x - low.x, high.y - low.y]);
            curves[first..].iter_mut().for_each(|curve| curve.room = room);
        }
        let words = picture.words().cloned().collect();
        Self { picture, floors, marks, curves, words }
    }
}

impl Listed {
    /// Removes its text from its list.
    pub(super) fn mute(&mut self) {
        self.picture.above.retain(|item| !matches!(item, Item::Text(_)));
    }
}

impl Deref for Listed {
    type Target = Picture;

    fn deref(&self) -> &Picture {
        &self.picture
    }
}

impl DerefMut for Listed {
    fn deref_mut(&mut self) -> &mut Picture {
        &mut self.picture
    }
}

/// Adds what an item shows.
fn read(item: &Item, marks: &mut Vec<Mark>, curves: &mut Vec<Curve>) {
    let mark = |shape, bounds: [Vec2; 2], paint: &Paint| Mark {
        shape,
        rectangle: [bounds[0].x, bounds[0].y, bounds[1].x - bounds[0].x, bounds[1].y - bounds[0].y],
        along: Mark::UPRIGHT,
        colour: paint.colour,
        opacity: (255.0 * paint.alpha).round() as u8,
    };
    let curve = |points: Vec<Vec2>, width: f32, dash: &[f32], paint: &Paint| Curve {
        points: points.into_iter().map(|at| at.to_array()).collect(),
        width,
        dash: dash.to_vec(),
        colour: paint.colour,
        alpha: paint.alpha,
        room: None,
    };
    match item {
        Item::Fill { path, paint } => {
            let [low, high] = bounds(path);
            match path.0.iter().any(|step| matches!(step, Step::Cubic(_))) {
                true => curves.push(curve(vec![low.midpoint(high)], high.x - low.x, &[], paint)),
                false => marks.push(mark("rectangle", [low, high], paint)),
            }
        }
        Item::Stroke { path, pen, paint } => match (&path.points()[..], pen.round || !pen.dash.is_empty()) {
            (&[from, to], false) => {
                let along = (to - from).normalize_or_zero().to_array();
                let rectangle = [from.x, from.y, from.distance(to), pen.width];
                marks.push(Mark { along, rectangle, ..mark("line", bounds(path), paint) });
            }
            (points, _) => curves.push(curve(points.to_vec(), pen.width, &pen.dash, paint)),
        },
        Item::Blend { path, colours, .. } => marks.push(mark("colours", bounds(path), &colours[0].into())),
        Item::Part { name, items } => marks.push(part(name, items, &mark)),
        Item::Image(_) | Item::Text(_) | Item::Clip { .. } => {}
    }
}

fn part(name: &'static str, items: &[Item], mark: &dyn Fn(&'static str, [Vec2; 2], &Paint) -> Mark) -> Mark {
    let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
    let mut paints = Vec::new();
    for item in items {
        let ([from, to], out) = match item {
            Item::Fill { path, paint } => {
                paints.push(*paint);
                (bounds(path), 0.0)
            }
            Item::Stroke { path, pen, paint } => {
                paints.push(*paint);
                (bounds(path), 0.5 * pen.width)
            }
            Item::Image(image) => {
                paints.push([image.pixels[0], image.pixels[1], image.pixels[2]].into());
                let [corner, right, down] = image.place;
                ([corner.min(corner + right + down), corner.max(corner + right + down)], 0.0)
            }
            other => panic!("{other:?}"),
        };
        (low, high) = (low.min(from - out), high.max(to + out));
    }
    // Halos come first, rims and diagonals last.
    let is_rimmed = matches!(name, "node" | "struck");
    let paint = if is_rimmed { paints[0] } else { paints[paints.len() - 1] };
    let whole = mark(name, [low, high], &paint);
    match items {
        [Item::Stroke { pen, .. }, Item::Fill { path, .. }] if name == "arrow" => {
            let points = path.points();
            let (from, to) = (points[0].midpoint(points[6]), points[3]);
            let along = (to - from).normalize();
            // With its halo.
            let height = points[2].distance(points[4]) + pen.width;
            let rectangle = [from.x, from.y, from.distance(to), height];
            Mark { rectangle, along: along.to_array(), ..whole }
        }
        [Item::Fill { path, .. }] if name == "floor" => {
            let points = path.points();
            turned(whole, [points[0], points[1] - points[0], points[3] - points[0]])
        }
        [Item::Image(image)] => turned(whole, image.place),
        _ => whole,
    }
}

/// A mark with its turned rectangle, from a corner along two sides.
fn turned(mark: Mark, [corner, along, down]: [Vec2; 3]) -> Mark {
    let rectangle = [corner.x, corner.y, along.length(), down.length()];
    Mark { rectangle, along: along.normalize().to_array(), ..mark }
}

/// The items of all parts with a name.
pub(super) fn parts<'i>(items: &'i [Item], wanted: &str) -> Vec<&'i [Item]> {
    let of_item = |item: &'i Item| match item {
        Item::Part { name, items } if *name == wanted => vec![&items[..]],
        Item::Part { items, .. } | Item::Clip { items, .. } => parts(items, wanted),
        _ => Vec::new(),
    };
    items.iter().flat_map(of_item).collect()
}

/// The numbers at the lines from bodies down to the ground.
pub(super) fn heights(picture: &Picture) -> Vec<&TextRun> {
    let two = picture.above.windows(2);
    two.filter_map(|two| match two {
        [Item::Part { name: "height", .. }, Item::Text(run)] => Some(run),
        _ => None,
    })
    .collect()
}

/// Removes all parts with a name.
pub(super) fn remove(items: &mut Vec<Item>, unwanted: &str) {
    items.retain(|item| !matches!(item, Item::Part { name, .. } if *name == unwanted));
    for item in items {
        if let Item::Part { items, .. } | Item::Clip { items, .. } = item {
            remove(items, unwanted);
        }
    }
}

/// The points of the paths in all parts with a name.
pub(super) fn corners(items: &[Item], wanted: &str) -> Vec<Vec2> {
    let of_item = |item: &Item| match item {
        Item::Fill { path, .. } | Item::Stroke { path, .. } => path.points(),
        _ => Vec::new(),
    };
    parts(items, wanted).into_iter().flatten().flat_map(of_item).collect()
}

/// The corners of the box of a path.
fn bounds(path: &Path) -> [Vec2; 2] {
    let points = path.points();
    let fold = |start, pick: fn(Vec2, Vec2) -> Vec2| points.iter().copied().fold(start, pick);
    [fold(Vec2::INFINITY, Vec2::min), fold(Vec2::NEG_INFINITY, Vec2::max)]
}

/// A composer of pictures with their lists read back.
pub(super) struct Composer<'a>(picture::Composer<'a>);

impl<'a> Composer<'a> {
    pub(super) fn new(scene: &'a Scene, history: &History) -> Self {
        Self(picture::Composer::new(scene, history))
    }

    pub(super) fn compose(&self, frame: &Frame) -> Listed {
        self.0.compose(frame).into()
    }
}

/// A figure with its list read back.
pub(super) fn compose_figure(figure: &Figure, moments: &Moments) -> Result<Listed, impl std::fmt::Debug> {
    picture::compose_figure(figure, moments).map(|(picture, _)| Listed::from(picture))
}

/// Makes items larger, with their places. Text stands where it stands at its usual size.
pub(super) fn enlarge(items: &mut [Item], times: f32) {
    let path = |path: &mut Path| {
        for step in &mut path.0 {
            match step {
                Step::Move(at) | Step::Line(at) => *at *= times,
                Step::Cubic(points) => points.iter_mut().for_each(|at| *at *= times),
                Step::Close => {}
            }
        }
    };
    for item in items {
        match item {
            Item::Fill { path: outline, .. } => path(outline),
            Item::Stroke { path: middle, pen, .. } => {
                path(middle);
                pen.width *= times;
                pen.dash.iter_mut().for_each(|length| *length *= times);
            }
            Item::Blend { path: outline, ends, .. } => {
                path(outline);
                ends.iter_mut().for_each(|at| *at *= times);
            }
            Item::Image(image) => image.place.iter_mut().for_each(|at| *at *= times),
            Item::Text(run) => {
                run.size *= times;
                run.baseline = run.baseline.round() * times;
                run.span = run.span.map(|at| at * times);
                run.glyphs.iter_mut().for_each(|glyph| glyph.x = (glyph.x * 4.0).round() / 4.0 * times);
            }
            Item::Clip { path: outline, items } => {
                path(outline);
                enlarge(items, times);
            }
            Item::Part { items, .. } => enlarge(items, times),
        }
    }
}

/// A line, or a dot at a single point.
pub(super) fn line(points: &[[f32; 2]], width: f32, dash: &[f32], (colour, alpha): ([u8; 3], f32)) -> Item {
    let points: Vec<_> = points.iter().copied().map(Vec2::from).collect();
    match points[..] {
        [dot] => Item::Fill { path: Path::circle(dot, 0.5 * width), paint: Paint { colour, alpha } },
        _ => {
            let pen = Pen { width, dash: dash.to_vec(), round: dash.is_empty() };
            Item::Stroke { path: Path::open(&points), pen, paint: Paint { colour, alpha } }
        }
    }
}
