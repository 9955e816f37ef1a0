//! The body of a panel in the plane, as items straight from its elements.

use super::draft::Draft;
use crate::colour::mixed;
use crate::look::BODIES;
use crate::picture::ears::ears;
use crate::picture::layout::Rectangle;
use crate::picture::layout::steps::{BOLD, RING, THIN};
use crate::picture::measures::*;
use crate::picture::narrow::{narrow, narrow_count};
use crate::picture::page::{Path, Pen, point, winding};
use crate::picture::plane::sides;
use crate::picture::{Colour, Item, Second, Stroke};
use crate::sim::geometry::{around, ordered};
use glam::{DVec2, DVec3, Vec2};
use std::f32::consts::FRAC_1_SQRT_2;

/// The opacity of edges, which are fainter than on lit bodies.
const FLAT_EDGE_ALPHA: f64 = 0.56;

/// A corner: its pixel, and its place on the scale of a field.
type Corner = (Vec2, f32);

/// The sound elements, or the turned-over ones.
#[derive(Default)]
struct Set {
    /// Triangles that fill the elements, all clockwise, body after body.
    triangles: Vec<[Corner; 3]>,
    /// The number of triangles up to the end of each body.
    ends: Vec<usize>,
    /// The sides of all elements, as nodes.
    sides: Vec<[u32; 2]>,
    /// Elements without faces.
    bars: Path,
}

/// Draws the body of one panel inside a part of the picture (px).
pub(super) struct PlaneBody<'a> {
    draft: &'a Draft<'a>,
    /// The pixels of the nodes.
    pixels: Vec<Vec2>,
    room: Rectangle,
    /// The colours of a field, if one is shown.
    ramp: &'a [Colour],
}

impl<'a> PlaneBody<'a> {
    pub(super) fn new(draft: &'a Draft<'a>, room: Rectangle) -> Self {
        let pixel = |&at: &DVec3| draft.pixel(at).map_or(Vec2::ZERO, point);
        Self {
            draft,
            pixels: draft.position.iter().map(pixel).collect(),
            room,
            ramp: if draft.shades.is_some() { &draft.composer.ramp } else { &[] },
        }
    }

    pub(super) fn item(&self) -> Item {
        let mut items = Vec::new();
        let [sound, turned_over] = self.sets();
        let mut part =
            |name, of_part: Vec<Item>| items.extend((!of_part.is_empty()).then(|| Item::part(name, of_part)));
        part("elements", self.surface(&sound, self.draft.palette.bodies_flat));
        part("turned over", self.surface(&turned_over, [self.draft.palette.alarm; BODIES]));
        part("hatch", self.hatches(&turned_over));
        part("edges", self.lines(&sound, &turned_over));
        part("strokes", self.strokes([&sound, &turned_over]));
        Item::inside(self.room, items)
    }

    /// The sound elements and the turned-over ones.
    fn sets(&self) -> [Set; 2] {
        let Draft { bodies, body, run, shades, .. } = self.draft;
        let mut sets = [Set::default(), Set::default()];
        if self.pixels.is_empty() || !self.draft.scene.view.visible.surfaces {
            return sets;
        }
        let pixel = |node: u32| self.pixels[node as usize];
        let faces = body.faces();
        for of_body in bodies.faces() {
            for face in of_body {
                let (nodes, element) = (&faces.nodes[face], faces.inner[face].or(faces.outer[face]));
                let is = |flags: &[bool]| element.is_some_and(|at| flags.get(at as usize).copied().unwrap_or(false));
                if is(&run.snapshot.broken) {
                    continue;
                }
                let set = &mut sets[usize::from(is(&run.snapshot.turned_over))];
                let places =
                    shades.as_ref().map_or_else(|| vec![0.0; nodes.len()], |shades| shades.corners(nodes, element));
                let corners = nodes.iter().zip(places).map(|(&node, place)| (pixel(node), narrow(place)));
                set.triangles.extend(triangles(&corners.collect::<Vec<_>>()));
                set.sides.extend(around(nodes).map(ordered));
            }
            sets.iter_mut().for_each(|set| set.ends.push(set.triangles.len()));
        }
        // Coloured strokes replace them.
        if self.draft.of_nodes.is_empty() {
            for (ends, over) in self.draft.bare_lines() {
                let ends = ends.map(|at| self.draft.pixel(at).map_or(Vec2::ZERO, point));
                sets[usize::from(over)].bars.add_line(&ends);
            }
        }
        sets
    }

    /// The elements of each body in its colour, or in the colours of a field.
    fn surface(&self, set: &Set, plain: [Colour; BODIES]) -> Vec<Item> {
        let triangles = &set.triangles;
        if triangles.is_empty() {
            return Vec::new();
        }
        let last = narrow_count(self.ramp.len().saturating_sub(1));
        let plain = if self.ramp.is_empty() { plain } else { [self.draft.palette.bodies_flat[0]; BODIES] };
        let begins = std::iter::once(0).chain(set.ends.iter().copied());
        let of_bodies = begins.zip(&set.ends).zip(plain.into_iter().cycle()).filter(|((begin, end), _)| begin < *end);
        let fill = |((begin, &end), colour)| Item::fill(whole(&triangles[begin..end]), colour);
        let mut items: Vec<_> = of_bodies.map(fill).collect();
        for (band, &colour) in self.ramp.iter().enumerate() {
            // Values beyond the scale have the colours of its ends. Each band reaches under the next one, so that no seam
            // is seen between them.
            let [from, to] = [-0.5, 0.5].map(|half| narrow_count(band) + half);
            let seen = triangles.iter().map(|triangle| triangle.map(|(at, place)| (at, last * place)));
            let seen =
                seen.filter(|three| three.iter().any(|&(_, at)| at >= from) && three.iter().any(|&(_, at)| at < to));
            let path = path_of(seen.map(|triangle| part(&triangle, from, to + 1.0)));
            items.extend((!path.is_empty()).then(|| Item::fill(path, colour)));
        }
        items
    }

    /// The stripes on turned-over elements, fixed to each body.
    fn hatches(&self, set: &Set) -> Vec<Item> {
        let starts = std::iter::once(0).chain(set.ends.iter().copied());
        let of_bodies = starts.zip(&set.ends).zip(self.draft.bodies.nodes());
        let hatch = |((from, &to), nodes)| self.hatch(&set.triangles[from..to], self.draft.middle(nodes));
        of_bodies.flat_map(hatch).collect()
    }

    /// The stripes on some triangles, fixed to the middle of their body.
    fn hatch(&self, triangles: &[[Corner; 3]], middle: [f32; 2]) -> Vec<Item> {
        if triangles.is_empty() {
            return Vec::new();
        }
        let palette = &self.draft.palette;
        // On the colours of a field, vermilion stands out more.
        let colour =
            if self.ramp.is_empty() { (palette.alarm_line, STRIPE_ALPHA.into()) } else { (palette.alarm, 1.0) };
        let (path, middle) = (whole(triangles), Vec2::from(middle));
        let period = narrow(RING) * self.line_scale();
        let across = FRAC_1_SQRT_2 * period * Vec2::ONE;
        let [left, top, right, bottom] = sides(self.room.map(f64::from)).map(narrow);
        let inside = |at: Vec2| at.clamp(Vec2::new(left, top), Vec2::new(right, bottom)) - middle;
        let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for at in path.points().into_iter().map(inside) {
            let turned = Vec2::new(at.dot(across.perp()), at.dot(across)) / (period * period);
            (low, high) = (low.min(turned), high.max(turned));
        }
        let mut lines = Path::default();
        for stripe in low.y.floor() as i32..=high.y.ceil() as i32 {
            let on = middle + (narrow(f64::from(stripe)) + 0.5) * across;
            lines.add_line(&[low.x - 1.0, high.x + 1.0].map(|end| on + end * across.perp()));
        }
        let pen = Pen { round: false, ..Pen::solid(STRIPE * period) };
        vec![Item::Clip { path, items: vec![Item::stroke(lines, pen, colour)] }]
    }

    /// Edges and contours.
    fn lines(&self, sound: &Set, turned_over: &Set) -> Vec<Item> {
        let palette = &self.draft.palette;
        let faint = f64::from(edging(narrow(self.draft.element)));
        let alarm = if self.ramp.is_empty() { palette.alarm_line } else { palette.alarm };
        let [edges, outline] = sound.lines(&self.pixels);
        let [alarm_edges, alarm_outline] = turned_over.lines(&self.pixels);
        let edged = if self.draft.scene.view.edges.are_drawn()[0] { faint } else { 0.0 };
        let alarm_alpha = f64::from(ALARM_EDGE_ALPHA);
        let all = [
            (edges, THIN, palette.edge, FLAT_EDGE_ALPHA * edged),
            (sound.bars.clone(), BAR_WIDTH.into(), palette.edge, BAR_ALPHA.into()),
            (alarm_edges, ALARM_EDGE_WIDTH.into(), alarm, alarm_alpha * faint),
            (turned_over.bars.clone(), ALARM_EDGE_WIDTH.into(), alarm, alarm_alpha),
            (alarm_outline, BOLD, alarm, 1.0),
            (outline, BOLD, palette.outline, palette.outline_alpha.into()),
        ];
        let seen = all.into_iter().filter(|(path, _, _, alpha)| !path.is_empty() && *alpha > 0.0);
        let stroke = |(path, width, colour, alpha)| {
            Item::stroke(path, Pen::solid(narrow(width) * self.line_scale()), (colour, alpha))
        };
        seen.map(stroke).collect()
    }

    /// Coloured lines, which may have another colour on the body.
    fn strokes(&self, sets: [&Set; 2]) -> Vec<Item> {
        let strokes = self.draft.strokes();
        let mut items: Vec<_> = strokes.iter().flat_map(|stroke| self.stroke(stroke, None)).collect();
        let on_body = |stroke: &Stroke| if let Second::OnBody(colour) = stroke.second { Some(colour) } else { None };
        for set in sets.into_iter().filter(|set| !set.triangles.is_empty()) {
            let seen = strokes.iter().filter(|stroke| on_body(stroke).is_some());
            let seen: Vec<_> = seen.flat_map(|stroke| self.stroke(stroke, on_body(stroke))).collect();
            items.extend((!seen.is_empty()).then(|| Item::Clip { path: whole(&set.triangles), items: seen }));
        }
        items
    }

    fn stroke(&self, stroke: &Stroke, other: Option<Colour>) -> Vec<Item> {
        let ends = stroke.ends.map(|end| self.draft.pixel(self.draft.place(end)).unwrap_or_default());
        let colour = other.unwrap_or(mixed(stroke.colours[0], stroke.colours[1], 0.5));
        let width = f64::from(stroke.width);
        let Second::Casing(casing) = stroke.second else {
            return vec![Item::curve(&ends.map(DVec2::into), width, &[], colour)];
        };
        let inner = width - 2.0 * (f64::from(CASING) * width).max(LEAST_CASING.into());
        let widths = [(width, casing), (inner, colour)].into_iter().filter(|(width, _)| *width > 0.0);
        widths.map(|(width, colour)| Item::line(ends, width, colour)).collect()
    }

    fn line_scale(&self) -> f32 {
        narrow(self.draft.scale.line())
    }
}

impl Set {
    /// The sides of its elements, and those with the set on one side only.
    fn lines(&self, pixels: &[Vec2]) -> [Path; 2] {
        let mut sides = self.sides.clone();
        sides.sort_unstable();
        let (mut all, mut outer) = (Vec::new(), Vec::new());
        for same in sides.chunk_by(|one, other| one == other) {
            all.push(same[0]);
            outer.extend((same.len() == 1).then_some(same[0]));
        }
        [all, outer].map(|lines| Path::joined(&lines, pixels))
    }
}

/// Triangles that fill a polygon, all clockwise: its ears if it is not convex, else a fan around its middle.
fn triangles(corners: &[Corner]) -> Vec<[Corner; 3]> {
    let mut corners = corners.to_vec();
    if winding(&corners.iter().map(|(at, _)| *at).collect::<Vec<_>>()) < 0.0 {
        corners.reverse();
    }
    let points: Vec<_> = corners.iter().map(|(at, _)| DVec2::from(at.to_array().map(f64::from))).collect();
    let filled: Vec<[Corner; 3]> = match (&corners[..], ears(&points)) {
        (&[a, b, c], _) => vec![[a, b, c]],
        (_, Some(ears)) => ears.into_iter().map(|ear| ear.map(|at| corners[at as usize])).collect(),
        _ => {
            let sum = corners.iter().fold(Corner::default(), |sum, one| (sum.0 + one.0, sum.1 + one.1));
            let count = narrow_count(corners.len());
            let middle = (sum.0 / count, sum.1 / count);
            corners.iter().zip(corners.iter().cycle().skip(1)).map(|(&from, &to)| [from, to, middle]).collect()
        }
    };
    // Where sides cross, some are the other way round.
    let clockwise = |[a, b, c]: [Corner; 3]| if winding(&[a.0, b.0, c.0]) < 0.0 { [b, a, c] } else { [a, b, c] };
    filled.into_iter().map(clockwise).collect()
}

fn whole(triangles: &[[Corner; 3]]) -> Path {
    path_of(triangles.iter().map(|triangle| triangle.map(|(at, _)| at).to_vec()))
}

/// Polygons with an area as one path.
pub(super) fn path_of(polygons: impl Iterator<Item = Vec<Vec2>>) -> Path {
    let mut path = Path::default();
    polygons.filter(|polygon| polygon.len() > 2).for_each(|polygon| path.add_polygon(&polygon));
    path
}

/// The part of a triangle with values between two others.
fn part(triangle: &[Corner; 3], low: f32, high: f32) -> Vec<Vec2> {
    let mut polygon = triangle.to_vec();
    for (level, sign) in [(low, 1.0), (high, -1.0)] {
        let above = |value: f32| sign * (value - level);
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (at, &(from, start)) in polygon.iter().enumerate() {
            let (to, end) = polygon[(at + 1) % polygon.len()];
            if above(start) >= 0.0 {
                kept.push((from, start));
            }
            if above(start) * above(end) < 0.0 {
                kept.push((from.lerp(to, (level - start) / (end - start)), level));
            }
        }
        polygon = kept;
    }
    polygon.into_iter().map(|(at, _)| at).collect()
}
