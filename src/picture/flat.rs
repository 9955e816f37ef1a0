//! Flat shading: panels of the plane as items. Devices shade the same panels of space.

use super::field::NOWHERE;
use super::layout::steps::{BOLD, THIN};
use super::measures::*;
use super::narrow::{narrow, narrow_count};
use super::page::{Image, Path, Pen, point, winding};
use super::plane::sides;
use super::{Colour, Fading, Item, LineKind, Mesh, Obstacles, Palette, Panel, Second, Solid, Stroke};
use crate::colour::mixed;
use crate::look::BODIES;
use glam::{DVec2, Vec2, Vec3};
use std::collections::HashMap;

/// The opacity of edges, which are fainter than on lit bodies.
const EDGE_ALPHA: f64 = 0.56;

/// A corner: its pixel, and a number that is linear in between.
type Corner = (Vec2, f32);

/// Shades one panel of the plane.
pub(super) struct Flat<'a> {
    pub(super) panel: &'a Panel,
    pub(super) palette: &'a Palette,
    /// The colours of a field; empty if none is shown.
    pub(super) ramp: &'a [Colour],
}

impl Flat<'_> {
    /// The obstacles, which fade where they leave their room.
    pub(super) fn obstacles(&self) -> Option<Item> {
        let Obstacles { solids, fade, .. } = &self.panel.obstacles;
        let outline = |solid: &Solid| solid.mesh.vertices.iter().map(|at| self.pixel(at.position)).collect::<Vec<_>>();
        let fill = |solid| Item::part("obstacle", [Item::fill(Path::polygon(&outline(solid)), solid.colour)]);
        let mut items: Vec<_> = solids.iter().map(fill).collect();
        items.extend(fade.iter().map(|fade| {
            let path = path_of(solids.iter().map(|solid| wider(&outline(solid))));
            Item::Clip { path, items: self.cover(fade).collect() }
        }));
        (!items.is_empty()).then(|| Item::inside(self.panel.region, items))
    }

    /// The background over what fades at the sides of the part of the panel that is covered.
    fn cover(&self, &Fading { distance, strength, .. }: &Fading) -> impl Iterator<Item = Item> {
        let [left, top, right, bottom] = sides(self.panel.region.map(f64::from));
        let (size, ground) = (DVec2::new(right - left, bottom - top), self.palette.background);
        (0..4).filter(move |&side| strength[side] > 0.0).map(move |side| {
            let corner = [[left, top], [left, top], [right, top], [left, bottom]][side].into();
            let inwards = [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y][side] * f64::from(distance[side % 2]);
            let along = size * if side.is_multiple_of(2) { DVec2::Y } else { DVec2::X };
            let opacity = |share: f32| strength[side] * (1.0 - share * share * (3.0 - 2.0 * share));
            soft([corner, along, inwards], 1, ground, |_, share| opacity(share))
        })
    }

    /// The body: its surfaces, and the lines on them.
    pub(super) fn body(&self) -> Item {
        let Panel { sound, turned_over, region, .. } = self.panel;
        let [sound, over] = [sound, turned_over].map(|mesh| self.triangles(mesh, |at| shade(mesh, at)));
        let parts = [
            ("elements", self.surface(&sound, self.palette.bodies_flat)),
            ("turned over", self.surface(&over, [self.palette.alarm; BODIES])),
            ("hatch", self.hatch()),
            ("edges", self.lines()),
            ("strokes", self.strokes([&sound, &over])),
        ];
        let drawn = parts.into_iter().filter(|(_, items)| !items.is_empty());
        Item::inside(*region, drawn.map(|(name, items)| Item::part(name, items)).collect())
    }

    /// The nodes.
    pub(super) fn nodes(&self) -> Option<Item> {
        let Panel { beads, viewport, .. } = self.panel;
        let node = beads
            .iter()
            .map(|bead| Item::rimmed(self.pixel(bead.at).as_dvec2(), bead.radius.into(), bead.colour, bead.rim));
        (!beads.is_empty()).then(|| Item::inside(*viewport, node.collect()))
    }

    fn pixel(&self, at: [f32; 3]) -> Vec2 {
        let [left, top, width, height] = self.panel.viewport.map(f64::from);
        let at = self.panel.sight.clip.as_dmat4() * Vec3::from(at).as_dvec3().extend(1.0);
        point(DVec2::new(left + (0.5 + 0.5 * at.x) * width, top + (0.5 - 0.5 * at.y) * height))
    }

    /// The triangles of a mesh, all clockwise, with a number at each corner.
    fn triangles(&self, mesh: &Mesh, number: impl Fn(usize) -> f32) -> Vec<[Corner; 3]> {
        let corners: Vec<_> =
            mesh.vertices.iter().enumerate().map(|(at, one)| (self.pixel(one.position), number(at))).collect();
        let clockwise = |three: &[u32; 3]| {
            let [a, b, c] = three.map(|at| corners[at as usize]);
            if winding(&[a.0, b.0, c.0]) < 0.0 { [b, a, c] } else { [a, b, c] }
        };
        mesh.triangles.iter().map(clockwise).collect()
    }

    /// The elements of each body in its colour, or in the colours of a field.
    fn surface(&self, triangles: &[[Corner; 3]], plain: [Colour; BODIES]) -> Vec<Item> {
        let body = |three: &[Corner; 3]| (-1.0 - three[0].1).max(0.0) as usize;
        let of_bodies = triangles.chunk_by(|one, other| body(one) == body(other));
        let mut items: Vec<_> = of_bodies.map(|all| Item::fill(whole(all), plain[body(&all[0])])).collect();
        let last = narrow_count(self.ramp.len().saturating_sub(1));
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

    /// The stripes on turned-over elements.
    fn hatch(&self) -> Vec<Item> {
        let mesh = &self.panel.turned_over;
        let stripes = self.triangles(mesh, |at| mesh.vertices[at].hatch).into_iter().flat_map(|three| {
            let phases = three.map(|(_, phase)| phase);
            let first = phases.into_iter().fold(f32::INFINITY, f32::min).floor() as i32;
            let last = phases.into_iter().fold(f32::NEG_INFINITY, f32::max).ceil() as i32;
            let middles = (first..last).map(|stripe| narrow(f64::from(stripe)) + 0.5);
            middles.map(move |middle| part(&three, middle - 0.5 * STRIPE, middle + 0.5 * STRIPE))
        });
        let path = path_of(stripes);
        // On the colours of a field, vermilion stands out more.
        let alpha = if self.ramp.is_empty() { STRIPE_ALPHA.into() } else { 1.0 };
        Vec::from_iter((!path.is_empty()).then(|| Item::fill(path, (self.alarm_line(), alpha))))
    }

    fn alarm_line(&self) -> Colour {
        if self.ramp.is_empty() { self.palette.alarm_line } else { self.palette.alarm }
    }

    /// Edges and contours.
    fn lines(&self) -> Vec<Item> {
        let Palette { edge, outline, outline_alpha, .. } = *self.palette;
        let (faint, alarm) = (f64::from(edging(self.panel.sight.element)), self.alarm_line());
        let all = [
            (LineKind::Edge, THIN, edge, EDGE_ALPHA * faint),
            (LineKind::Bar, BAR_WIDTH.into(), outline, BAR_ALPHA.into()),
            (LineKind::AlarmEdge, ALARM_EDGE_WIDTH.into(), alarm, f64::from(ALARM_EDGE_ALPHA) * faint),
            (LineKind::AlarmContour, BOLD, alarm, 1.0),
            (LineKind::Contour, BOLD, outline, outline_alpha.into()),
        ];
        let stroke = |(kind, width, colour, alpha)| {
            let path = self.joined(kind);
            let pen = Pen::solid(narrow(width) * self.panel.sight.line_scale);
            (!path.is_empty() && alpha > 0.0).then(|| Item::stroke(path, pen, (colour, alpha)))
        };
        all.into_iter().filter_map(stroke).collect()
    }

    /// The lines of a kind.
    fn joined(&self, kind: LineKind) -> Path {
        let (mut points, mut places) = (Vec::new(), HashMap::new());
        let mut place = |at: [f32; 3]| {
            *places.entry(at.map(f32::to_bits)).or_insert_with(|| {
                points.push(self.pixel(at));
                points.len() as u32 - 1
            })
        };
        let lines = self.panel.lines.iter().filter(|line| line.kind == kind);
        let pairs: Vec<_> = lines.map(|line| [line.from, line.to].map(&mut place)).collect();
        Path::joined(&pairs, &points)
    }

    /// Coloured lines, which may have another colour on the body.
    fn strokes(&self, sets: [&[[Corner; 3]]; 2]) -> Vec<Item> {
        let strokes = &self.panel.strokes;
        let mut items: Vec<_> = strokes.iter().flat_map(|stroke| self.stroke(stroke, None)).collect();
        let on_body = |stroke: &Stroke| if let Second::OnBody(colour) = stroke.second { Some(colour) } else { None };
        for set in sets.into_iter().filter(|set| !set.is_empty()) {
            let seen = strokes.iter().filter(|stroke| on_body(stroke).is_some());
            let seen: Vec<_> = seen.flat_map(|stroke| self.stroke(stroke, on_body(stroke))).collect();
            items.extend((!seen.is_empty()).then(|| Item::Clip { path: whole(set), items: seen }));
        }
        items
    }

    fn stroke(&self, stroke: &Stroke, other: Option<Colour>) -> Vec<Item> {
        let ends = stroke.ends.map(|end| self.pixel(end).as_dvec2());
        let colour = other.unwrap_or(mixed(stroke.colours[0], stroke.colours[1], 0.5));
        let width = f64::from(stroke.width);
        let Second::Casing(casing) = stroke.second else {
            return vec![Item::curve(&ends.map(DVec2::into), width, &[], colour)];
        };
        let inner = width - 2.0 * (f64::from(CASING) * width).max(LEAST_CASING.into());
        let widths = [(width, casing), (inner, colour)].into_iter().filter(|(width, _)| *width > 0.0);
        widths.map(|(width, colour)| Item::line(ends, width, colour)).collect()
    }
}

/// The place of a corner of a mesh on the scale of a field, or what it has instead.
fn shade(mesh: &Mesh, at: usize) -> f32 {
    mesh.shades.get(at).copied().unwrap_or(NOWHERE)
}

/// A convex polygon with corners farther out, so that it covers the outer half of the pixels on its sides.
fn wider(polygon: &[Vec2]) -> Vec<Vec2> {
    let (count, way) = (polygon.len(), winding(polygon).signum());
    let out = |from: Vec2, to: Vec2| way * (from - to).perp().normalize_or_zero();
    let moved = |at: usize| {
        let [before, here, after] = [count - 1, 0, 1].map(|step| polygon[(at + step) % count]);
        here + 1.5 * (out(before, here) + out(here, after)).normalize_or_zero()
    };
    (0..count).map(moved).collect()
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

/// The part of a triangle with numbers between two others.
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

/// Pixels from a corner along two sides (px), with an opacity that depends on their place, from 0 to 1 along each.
pub(super) fn soft(sides: [DVec2; 3], columns: u32, [r, g, b]: Colour, opacity: impl Fn(f32, f32) -> f32) -> Item {
    let place = sides.map(point);
    let size = [columns, place[2].length().ceil().max(1.0) as u32];
    let mut pixels = Vec::with_capacity(4 * (size[0] * size[1]) as usize);
    for y in 0..size[1] {
        for x in 0..size[0] {
            let [u, v] = [(x, size[0]), (y, size[1])].map(|(at, all)| narrow((f64::from(at) + 0.5) / f64::from(all)));
            pixels.extend([r, g, b, (255.0 * opacity(u, v).clamp(0.0, 1.0)).round() as u8]);
        }
    }
    Item::Image(Image { size, pixels, place })
}
