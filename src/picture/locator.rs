//! The overview in a corner of a panel whose camera follows: floor, silhouette and path of the body, and what the panel
//! shows, flat and seen level from the side. It stands still and is the same in all panels, so that heights compare.

use super::caption::Writer;
use super::layout::{self, Rectangle, Scale};
use super::narrow::narrow;
use super::tracking::Tracking;
use super::{Curve, Mark, MarkShape};
use crate::colour::Colour;
use crate::look::axes;
use crate::scene::Scene;
use crate::sim::body::Dimension;
use crate::sim::contact;
use glam::{DVec2, DVec3};

/// Its width, and its height at the most, in parts of a panel's width and of the height that words leave free.
const WIDTH: f64 = 0.22;
pub(super) const HEIGHT: f64 = 0.42;
/// It is no narrower or lower than this part of its longer side, and nothing is drawn that is shorter than this (px).
const SLENDEREST: f64 = 0.42;
const LEAST: f64 = 36.0;
/// The shorter side of a usual one, in parts of the longer one.
const USUAL: f64 = 0.6;
/// Free inside its frame (px in the reference picture).
const INSIDE: f64 = 5.0;
/// The floor is shown if it lies no deeper below the path than this (parts of the body's width).
const DEEP: f64 = 1.5;
/// Widths of the frame and of the border of what the panel shows, of the floor, of the path, and of elements without faces
/// (px in the reference picture).
const FRAME: f64 = 1.0;
const SHOWN: f64 = 1.4;
const FLOOR: f64 = 1.4;
const PATH: f64 = 1.5;
const BAR: f64 = 2.2;
/// Opacity of the ground below it, and of the floor's fill (of 255).
const GROUND: u8 = 224;
const DEPTH: u8 = 90;
/// Points of a path nearer to each other than this are one (px).
const APART: f64 = 0.7;
/// Each pixel of a silhouette is cut into so many parts along each side.
const PARTS: usize = 4;

/// What the overviews of all panels share.
#[derive(Debug)]
pub(super) struct Locator {
    /// Horizontally across what it shows.
    right: DVec3,
    /// What it shows: to the right and up (m).
    low: DVec2,
    high: DVec2,
    /// The floor as a line (m).
    floor: Option<[DVec2; 2]>,
}

/// What the overview of one panel shows.
pub(super) struct Located<'a> {
    /// Points of the body's surface (m).
    pub(super) points: Vec<DVec3>,
    /// The triangles between them.
    pub(super) triangles: &'a [[u32; 3]],
    /// Elements without faces as lines (m).
    pub(super) bars: Vec<[DVec3; 2]>,
    /// The middle of what the panel shows (m), and how wide and high that is (m).
    pub(super) shown: (DVec3, [f64; 2]),
    /// The colour of the path.
    pub(super) colour: Colour,
}

/// Whether one of a usual shape has room in a panel (px).
pub(super) fn fits(view: &crate::look::View, viewport: Rectangle, scale: Scale) -> bool {
    let [_, _, width, height] = layout::clear_of_words(viewport, view, scale).map(f64::from);
    USUAL * (WIDTH * width).min(HEIGHT * height) >= LEAST
}

impl Locator {
    /// For a scene and the paths of its runs; `None` if no place of a body is known.
    pub(super) fn new(scene: &Scene, tracking: &Tracking) -> Option<Self> {
        let right = match scene.body.dimension {
            Dimension::Space => axes(scene.view.camera.azimuth, 0.0)[0],
            Dimension::Plane => DVec3::X,
        };
        let seen = |point: DVec3| DVec2::new(point.dot(right), point.y);
        let centres = tracking.paths.iter().flat_map(|path| &path.centres).map(|&centre| seen(centre));
        let none = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (low, high) = centres.fold(none, |(low, high), at| (low.min(at), high.max(at)));
        if !(low.is_finite() && high.is_finite()) {
            return None;
        }
        let pad = 0.6 * tracking.widest;
        let (mut low, high) = (low - pad, high + pad);
        let middle = scene.initial.position.first().copied().unwrap_or_default();
        let away = middle - seen(middle).x * right - middle.y * DVec3::Y;
        let floor = contact::ground(&scene.obstacles, 0.0).map(|(normal, height)| {
            let level = |x: f64| (height - normal.dot(x * right + away)) / normal.y;
            [low.x, high.x].map(|x| DVec2::new(x, level(x)))
        });
        let floor = floor.filter(|ends| ends.iter().all(|end| end.y > low.y - DEEP * tracking.widest));
        for end in floor.into_iter().flatten() {
            low.y = low.y.min(end.y - 0.1 * tracking.widest);
        }
        Some(Self { right, low, high, floor })
    }

    /// Where it stands in a panel (px: left, top, width and height); `None` where it would be too small.
    pub(super) fn place(&self, view: &crate::look::View, viewport: Rectangle, scale: Scale) -> Option<[f64; 4]> {
        let [left, top, width, height] = layout::clear_of_words(viewport, view, scale).map(f64::from);
        let most = [WIDTH * f64::from(viewport[2]), HEIGHT * height];
        let inside = 2.0 * INSIDE * scale.unit;
        let shape = self.high - self.low;
        let pixels = ((most[0] - inside) / shape.x).min((most[1] - inside) / shape.y);
        let sides = [shape.x, shape.y].map(|length| length * pixels + inside);
        let least = SLENDEREST * sides[0].max(sides[1]);
        let sides = [0, 1].map(|axis| sides[axis].max(least).min(most[axis]).round());
        let is_seen = pixels.is_finite() && sides.iter().all(|&side| side >= LEAST);
        is_seen.then(|| [left + width - sides[0], top, sides[0], sides[1]])
    }

    /// Draws it at its place for a run.
    pub(super) fn draw(
        &self,
        writer: &mut Writer<'_>,
        place: [f64; 4],
        tracking: &Tracking,
        (run, time): (usize, f64),
        located: &Located<'_>,
    ) {
        let Writer { palette, scale, .. } = *writer;
        let line = scale.unit.max(0.6);
        let [left, top, width, height] = place;
        let inside = INSIDE * scale.unit;
        let shape = self.high - self.low;
        let pixels = ((width - 2.0 * inside) / shape.x).min((height - 2.0 * inside) / shape.y);
        let middle = self.low.midpoint(self.high);
        let pixel = |at: DVec2| {
            DVec2::new(left + 0.5 * width + pixels * (at.x - middle.x), top + 0.5 * height - pixels * (at.y - middle.y))
        };
        let seen = |point: DVec3| pixel(DVec2::new(point.dot(self.right), point.y));
        let ends = [DVec2::new(left, top), DVec2::new(left + width, top + height)];

        let ground = Mark::upright(place, MarkShape::Filled, palette.background);
        writer.marks.push(Mark { opacity: GROUND, ..ground });
        if let Some([from, to]) = self.floor.map(|floor| floor.map(pixel)) {
            // To the sides of the frame.
            let slope = (to.y - from.y) / (to.x - from.x).max(f64::MIN_POSITIVE);
            let at = |x: f64| DVec2::new(x, from.y + slope * (x - from.x));
            let line_of_floor = [at(ends[0].x), at(ends[1].x)];
            if slope == 0.0 {
                let below = [left, from.y, width, (ends[1].y - from.y).max(0.0)];
                writer.marks.push(Mark { opacity: DEPTH, ..Mark::upright(below, MarkShape::Filled, palette.hairline) });
            }
            writer.curves.extend(polyline(&line_of_floor, ends, FLOOR * line, palette.axis, 1.0));
        }
        silhouette(located, &seen, ends, palette.sound_flat, &mut writer.marks);
        let bars =
            located.bars.iter().filter_map(|bar| polyline(&bar.map(&seen), ends, BAR * line, palette.sound_flat, 1.0));
        writer.curves.extend(bars);
        for path in tracking.paths.iter().filter(|path| path.run == run) {
            let past: Vec<_> = thinned(path.until(time).map(&seen));
            writer.curves.extend(polyline(&past, ends, PATH * line, located.colour, 1.0));
        }
        let (target, [across, along]) = located.shown;
        let (at, half) = (seen(target), 0.5 * pixels * DVec2::new(across, along));
        let corner = |x: f64, y: f64| at + DVec2::new(x * half.x, y * half.y);
        let around = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        let around = around.map(|at| at.clamp(ends[0] + 0.5 * line, ends[1] - 0.5 * line));
        let closed: Vec<_> = around.iter().chain(around.first()).copied().collect();
        writer.curves.extend(polyline(&closed, ends, SHOWN * line, palette.second_text, 1.0));
        let frame = [ends[0], DVec2::new(ends[1].x, ends[0].y), ends[1], DVec2::new(ends[0].x, ends[1].y), ends[0]];
        writer.curves.extend(polyline(&frame, ends, FRAME * line, palette.hairline, 1.0));
    }
}

/// A curve through points within two corners (px); what lies outside is moved to the border.
fn polyline(points: &[DVec2], [low, high]: [DVec2; 2], width: f64, colour: Colour, alpha: f32) -> Option<Curve> {
    let points: Vec<_> = points.iter().map(|at| at.clamp(low, high)).map(|at| [at.x, at.y].map(narrow)).collect();
    (points.len() > 1).then(|| Curve { points, width: narrow(width), dash: Vec::new(), colour, alpha })
}

/// Points without those that are too near to the one before (px).
fn thinned(points: impl Iterator<Item = DVec2>) -> Vec<DVec2> {
    let mut kept: Vec<DVec2> = Vec::new();
    let mut last = None;
    for at in points {
        if kept.last().is_none_or(|before| before.distance(at) >= APART) {
            kept.push(at);
            last = None;
        } else {
            last = Some(at);
        }
    }
    kept.extend(last);
    kept
}

/// The silhouette of a body within two corners (px): for each row, marks for runs of pixels that it covers alike.
fn silhouette(
    body: &Located<'_>,
    seen: &impl Fn(DVec3) -> DVec2,
    [low, high]: [DVec2; 2],
    colour: Colour,
    marks: &mut Vec<Mark>,
) {
    let points: Vec<_> = body.points.iter().map(|&point| seen(point)).collect();
    let none = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let (first, last) = points.iter().fold(none, |(low, high), &at| (low.min(at), high.max(at)));
    let (first, last) = (first.max(low).floor(), last.min(high).ceil());
    if !(first.cmplt(last).all() && (last - first).is_finite()) {
        return;
    }
    let size = (last - first).to_array().map(|length| length as usize);
    let mut cells = vec![false; size[0] * size[1] * PARTS * PARTS];
    let (columns, rows) = (size[0] * PARTS, size[1] * PARTS);
    for triangle in body.triangles {
        let corners = triangle.map(|at| (points[at as usize] - first) * PARTS as f64);
        let [a, b, c] = corners;
        let range = |from: f64, to: f64, most: usize| {
            (from - 0.5).ceil().max(0.0) as usize..((to - 0.5).floor() + 1.0).clamp(0.0, most as f64) as usize
        };
        for row in range(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y), rows) {
            let y = row as f64 + 0.5;
            let crossings = [(a, b), (b, c), (c, a)].into_iter().filter(|(a, b)| (a.y > y) != (b.y > y));
            let crossings = crossings.map(|(a, b)| a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y));
            let (from, to) =
                crossings.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
            if from < to {
                range(from, to, columns).for_each(|column| cells[row * columns + column] = true);
            }
        }
    }
    let covered = |column: usize, row: usize| {
        let parts =
            (0..PARTS * PARTS).filter(|at| cells[(row * PARTS + at / PARTS) * columns + column * PARTS + at % PARTS]);
        parts.count()
    };
    for row in 0..size[1] {
        let mut column = 0;
        while column < size[0] {
            let share = covered(column, row);
            let end = (column + 1..size[0]).find(|&at| covered(at, row) != share).unwrap_or(size[0]);
            if share > 0 {
                let rectangle = [first.x + column as f64, first.y + row as f64, (end - column) as f64, 1.0];
                let mark = Mark::upright(rectangle, MarkShape::Filled, colour);
                marks.extend(mark.faded(share as f64 / (PARTS * PARTS) as f64));
            }
            column = end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_silhouette_covers_as_many_pixels_as_its_body() {
        let points = vec![DVec3::new(1.3, 2.0, 0.0), DVec3::new(9.8, 3.1, 1.0), DVec3::new(4.0, 12.4, 0.0)];
        let area = 0.5 * (points[1] - points[0]).truncate().perp_dot((points[2] - points[0]).truncate());
        for triangles in [&[[0, 1, 2]][..], &[[2, 1, 0], [0, 1, 2]]] {
            let shown = (DVec3::ZERO, [1.0; 2]);
            let body = Located { points: points.clone(), triangles, bars: Vec::new(), shown, colour: [0; 3] };
            let mut marks = Vec::new();
            silhouette(&body, &|at| at.truncate(), [DVec2::ZERO, DVec2::splat(20.0)], [0; 3], &mut marks);
            let covered =
                |mark: &Mark| f64::from(mark.rectangle[2] * mark.rectangle[3]) * f64::from(mark.opacity) / 255.0;
            let sum: f64 = marks.iter().map(covered).sum();
            assert!((sum - area).abs() < 0.05 * area, "{sum} of {area}");
        }
    }

    #[test]
    fn paths_are_thinned_and_end_where_the_body_is() {
        let path: Vec<_> = (0..100).map(|at| DVec2::new(0.1 * f64::from(at), 0.0)).collect();
        let kept = thinned(path.iter().copied());
        assert!(kept.len() < 20 && kept[0] == path[0] && kept.last() == path.last());
    }
}
