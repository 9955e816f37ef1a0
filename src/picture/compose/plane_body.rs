//! The body and the obstacles of a panel in the plane, as items.

use super::draft::Draft;
use crate::colour::{encoded, encoded_exactly, linear, luminance};
use crate::look::Palette;
use crate::picture::layout::Rectangle;
use crate::picture::measures::*;
use crate::picture::narrow::{narrow, narrow_count};
use crate::picture::page::{Image, Paint, Path, Pen, point, winding};
use crate::picture::{Colour, Fading, Item, Line, LineKind, Mesh, Second, Stroke};
use glam::{DVec2, DVec3, Vec2};

/// Widths (px in the reference picture) and opacity of edges and contours.
const EDGE_WIDTH: f32 = 1.5;
const EDGE_ALPHA: f32 = 0.75;
const CONTOUR_WIDTH: f32 = 2.5;
/// The distance of the stripes of turned-over elements (px in the reference picture).
const PERIOD: f32 = 9.0;
/// The number of pieces of a line of changing colour.
const PIECES: u32 = 8;

/// What is drawn of one panel, from the back to the front.
pub(super) struct PlaneBody<'a> {
    pub(super) draft: &'a Draft<'a>,
    /// The outlines of obstacles, of their insides, and of all that they touch (m); the first obstacle lies in front.
    pub(super) obstacles: Vec<[Vec<DVec3>; 3]>,
    pub(super) fading: Option<Fading>,
    pub(super) sound: Mesh,
    pub(super) turned_over: Mesh,
    pub(super) lines: Vec<Line>,
    pub(super) strokes: Vec<Stroke>,
}

impl PlaneBody<'_> {
    /// Its items in a part of the picture.
    pub(super) fn item(self, region: Rectangle) -> Item {
        let mut drawn = Vec::new();
        let items = &mut drawn;
        let [left, top, width, height] = region.map(|length| narrow(f64::from(length)));
        self.solids([left, top, left + width, top + height], items);
        let mut part = |name, draw: &dyn Fn(&mut Vec<Item>)| {
            let mut of_part = Vec::new();
            draw(&mut of_part);
            items.extend((!of_part.is_empty()).then(|| Item::part(name, of_part)));
        };
        part("elements", &|items| self.surface(&self.sound, false, items));
        part("dots", &|items| self.dots([left, top, width, height], items));
        part("turned over", &|items| self.surface(&self.turned_over, true, items));
        part("hatch", &|items| self.hatch([left, top, width, height], items));
        part("edges", &|items| self.lines(items));
        part("strokes", &|items| self.strokes(items));
        Item::Clip { path: Path::rectangle(Vec2::new(left, top), Vec2::new(width, height)), items: drawn }
    }

    fn palette(&self) -> &Palette {
        &self.draft.palette
    }

    fn line_scale(&self) -> f32 {
        narrow(self.draft.scale.line())
    }

    fn middle(&self) -> Vec2 {
        self.draft.middle().into()
    }

    fn project(&self, at: DVec3) -> Vec2 {
        self.draft.lens.project(at).map_or(Vec2::ZERO, |(pixel, _)| point(DVec2::from(pixel)))
    }

    fn pixel(&self, at: [f32; 3]) -> Vec2 {
        self.project(self.draft.place(at))
    }

    /// The triangles of a mesh, all counter-clockwise or all clockwise, with a value at each corner.
    fn triangles(&self, mesh: &Mesh, value: impl Fn(usize) -> f32) -> Vec<[(Vec2, f32); 3]> {
        let corner = |at: u32| (self.pixel(mesh.vertices[at as usize].position), value(at as usize));
        let one = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(corner);
            if winding(&[a.0, b.0, c.0]) < 0.0 { [a, c, b] } else { [a, b, c] }
        };
        mesh.triangles.iter().map(one).collect()
    }

    fn whole(&self, mesh: &Mesh) -> Path {
        path_of(self.triangles(mesh, |_| 0.0).iter().map(|triangle| triangle.map(|(at, _)| at).to_vec()))
    }

    /// Obstacles: their rims, then their insides. They fade out at the sides of their room, covered with the background
    /// within the region (left, top, right and bottom, px).
    fn solids(&self, region: [f32; 4], items: &mut Vec<Item>) {
        let [colour, rim] = self.draft.composer.palette.obstacle_flat;
        let background = self.palette().background;
        let mut all = Path::default();
        for solid in self.obstacles.iter().rev() {
            let [whole, inside, around] =
                solid.each_ref().map(|outline| outline.iter().map(|&at| self.project(at)).collect::<Vec<_>>());
            all.add_polygon(&around);
            let parts = [(whole, rim), (inside, colour)].into_iter().filter(|(outline, _)| outline.len() > 2);
            let fills: Vec<_> = parts.map(|(outline, colour)| Item::fill(Path::polygon(&outline), colour)).collect();
            items.push(Item::part("obstacle", fills));
        }
        let Some(Fading { room, distance, strength }) = self.fading else { return };
        let mut covers = Vec::new();
        let [left, top, right, bottom] = region;
        let corner = [[left, top], [left, top], [right, top], [left, bottom]].map(Vec2::from);
        for side in 0..4 {
            // A row of pixels from the side of the region inwards, as wide as that side.
            let (inwards, far) = (if side < 2 { 1.0 } else { -1.0 }, distance[side % 2]);
            let outside = inwards * (room[side] - region[side]);
            let length = (outside + far).ceil().max(0.0) as u32;
            let pixel = |at: u32| {
                let share = ((narrow(f64::from(at)) + 0.5 - outside) / far).clamp(0.0, 1.0);
                let gone = strength[side] * (1.0 - share * share * (3.0 - 2.0 * share));
                let [r, g, b] = background;
                [r, g, b, (255.0 * self.alpha(gone, background, colour)).round() as u8]
            };
            let (along, across) = (inwards * narrow(f64::from(length)), Vec2::new(right - left, bottom - top));
            let sides = match side % 2 {
                0 => [along * Vec2::X, across.y * Vec2::Y],
                _ => [along * Vec2::Y, across.x * Vec2::X],
            };
            if strength[side] > 0.0 && length > 0 {
                let (pixels, place) = ((0..length).flat_map(pixel).collect(), [corner[side], sides[0], sides[1]]);
                covers.push(Item::Image(Image { size: [length, 1], pixels, place }));
            }
        }
        items.push(Item::Clip { path: all, items: covers });
    }

    /// The surface of elements, in the colour of their kind or in the colours of a field.
    fn surface(&self, mesh: &Mesh, is_alarm: bool, items: &mut Vec<Item>) {
        if mesh.triangles.is_empty() {
            return;
        }
        let palette = self.palette();
        let has_field = !mesh.shades.is_empty() && self.draft.composer.ramp.len() > 1;
        let plain = if is_alarm && !has_field { palette.alarm } else { palette.sound_flat };
        items.push(Item::fill(self.whole(mesh), plain));
        if !has_field {
            return;
        }
        let ramp = &self.draft.composer.ramp;
        let bands = ramp.len() - 1;
        let triangles = self.triangles(mesh, |at| mesh.shades[at] * narrow_count(bands));
        if triangles.iter().all(|[a, b, c]| a.1 == b.1 && b.1 == c.1) {
            // Each element has one value. Where a body is folded over itself, its first triangle lies on top.
            for same in triangles.chunk_by(|one, other| one[0].1 == other[0].1).rev() {
                let path = path_of(same.iter().map(|triangle| triangle.map(|(at, _)| at).to_vec()));
                let value = same[0][0].1;
                let band = (value.max(0.0) as usize).min(bands - 1);
                let shade = mixed(ramp[band], ramp[band + 1], (value - narrow_count(band)).clamp(0.0, 1.0));
                let colour = if value > -0.5 * narrow_count(bands) { shade } else { palette.sound_flat };
                items.push(Item::fill(path, colour));
            }
            return;
        }
        for band in 0..bands {
            let [low, high] = [band, band + 1].map(narrow_count);
            // Values beyond the scale have the colours of its ends.
            let [from, to] = [
                if band == 0 { -0.5 * narrow_count(bands) } else { low },
                if band + 1 == bands { f32::INFINITY } else { high },
            ];
            let values = |triangle: &[(Vec2, f32); 3]| triangle.map(|(_, value)| value);
            let seen = triangles.iter().filter(|triangle| {
                let values = values(triangle);
                values.iter().any(|&value| value >= from) && values.iter().any(|&value| value < to)
            });
            // Each band reaches under the next one, so that no seam is seen between them.
            let path = path_of(seen.map(|triangle| part(triangle, from, to + 1.0)));
            if !path.is_empty() {
                let colour = mixed(ramp[band], ramp[band + 1], 0.5);
                items.push(Item::fill(path, colour));
            }
        }
    }

    /// The mean colour of the corners of a surface.
    fn mean_colour(&self, mesh: &Mesh, is_alarm: bool) -> Colour {
        let plain = if is_alarm && mesh.shades.is_empty() { self.palette().alarm } else { self.palette().sound_flat };
        let ramp = &self.draft.composer.ramp;
        if mesh.shades.is_empty() || ramp.is_empty() {
            return plain;
        }
        let colour =
            |&shade: &f32| if shade < -0.5 { plain } else { ramp[(shade * narrow_count(ramp.len() - 1)) as usize] };
        let sum = mesh
            .shades
            .iter()
            .map(colour)
            .fold([0; 3], |sum: [usize; 3], one| std::array::from_fn(|at| sum[at] + usize::from(one[at])));
        sum.map(|sum| (sum / mesh.shades.len()) as u8)
    }

    /// Flat elements: grey, unless a field colours them, with dots that are fixed to the body, in the room of the panel.
    fn dots(&self, [left, top, width, height]: [f32; 4], items: &mut Vec<Item>) {
        let mesh = &self.sound;
        let is_flat = |triangle: &&[u32; 3]| mesh.vertices[triangle[0] as usize].hatch > 0.5;
        let triangles: Vec<_> = mesh.triangles.iter().filter(is_flat).copied().collect();
        if !self.draft.run.snapshot.flat.contains(&true) || triangles.is_empty() {
            return;
        }
        let flat = self.whole(&Mesh { triangles, ..mesh.clone() });
        let mut ground = self.mean_colour(mesh, false);
        if mesh.shades.is_empty() {
            ground = encoded([luminance(ground); 3]);
            items.push(Item::fill(flat.clone(), ground));
        }
        // Rows at 45°.
        let apart = DOTS_APART * self.line_scale();
        let turn = Vec2::splat(std::f32::consts::FRAC_1_SQRT_2);
        let back = Vec2::new(turn.x, -turn.y);
        let room = [Vec2::new(left, top), Vec2::new(left + width, top + height)];
        let inside = |at: Vec2| at.clamp(room[0], room[1]);
        // The rows of the box that the elements fill in the room: its corners, since rows are turned.
        let (from, to) =
            flat.points().into_iter().map(inside).fold((room[1], room[0]), |(from, to), at| (from.min(at), to.max(at)));
        let corners = [from, Vec2::new(to.x, from.y), to, Vec2::new(from.x, to.y)];
        let points = corners.into_iter().map(|at| back.rotate(at - self.middle()) / apart);
        let (low, high) = points.fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(a, b), at| (a.min(at), b.max(at)));
        let mut path = Path::default();
        for row in low.y.floor() as i32 - 1..=high.y.ceil() as i32 {
            for column in low.x.floor() as i32 - 1..=high.x.ceil() as i32 {
                let at = turn.rotate((Vec2::from([column, row].map(|at| narrow(f64::from(at)))) + 0.5) * apart);
                path.add_circle(self.middle() + at, DOT * self.line_scale());
            }
        }
        let colour = self.palette().edge;
        let paint = Paint { colour, alpha: self.alpha(DOT_ALPHA, colour, ground) };
        items.push(Item::Clip { path: flat, items: vec![Item::fill(path, paint)] });
    }

    /// The stripes on turned-over elements, fixed to the body.
    fn hatch(&self, [left, top, width, height]: [f32; 4], items: &mut Vec<Item>) {
        if self.turned_over.triangles.is_empty() {
            return;
        }
        let palette = self.palette();
        // On the colours of a field, vermilion stands out more.
        let (colour, alpha) = match self.turned_over.shades.is_empty() {
            true => (palette.alarm_line, self.alpha(STRIPE_ALPHA, palette.alarm_line, palette.alarm)),
            false => (palette.alarm, 1.0),
        };
        let period = PERIOD * self.line_scale();
        let slant = Vec2::splat(std::f32::consts::FRAC_1_SQRT_2);
        let middle = self.middle();
        let room = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]];
        let corners = room.map(|[x, y]| Vec2::new(left + x, top + y));
        let triangles = self.triangles(&self.turned_over, |_| 0.0);
        let inside = |at: Vec2| at.clamp(corners[0], corners[2]);
        let points = triangles.iter().flatten().map(|(at, _)| slant.dot(inside(*at) - middle) / period);
        let (low, high) = points.fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), at| (a.min(at), b.max(at)));
        let reach = Vec2::new(slant.x, -slant.y) * (width + height);
        let mut path = Path::default();
        for stripe in low.floor() as i32 - 1..=high.ceil() as i32 {
            let on = middle + slant * (narrow(f64::from(stripe)) + 0.5) * period;
            // The line is centred in the room, so that it crosses all of it.
            let across = on + reach.normalize() * reach.normalize().dot(0.5 * (corners[0] + corners[2]) - on);
            path.add_line(&[across - reach, across + reach]);
        }
        // Stripes finer than three pixels per period would only flicker: towards that, their mean replaces them.
        let fine = ((period.recip() - 0.2) / 0.25).clamp(0.0, 1.0);
        let fine = fine * fine * (3.0 - 2.0 * fine);
        let whole = self.whole(&self.turned_over);
        if fine > 0.0 {
            let paint = Paint { colour, alpha: alpha * STRIPE * fine };
            items.push(Item::fill(whole.clone(), paint));
        }
        let pen = Pen { round: false, ..Pen::solid(STRIPE * period) };
        let stripes = Item::stroke(path, pen, Paint { colour, alpha: alpha * (1.0 - fine) });
        items.push(Item::Clip { path: whole, items: vec![stripes] });
    }

    /// Edges and contours. Lines of one kind are one path, so that joints are even.
    fn lines(&self, items: &mut Vec<Item>) {
        let palette = self.palette();
        let strength = edging(narrow(self.draft.element));
        let body = self.mean_colour(&self.sound, false);
        let alarm_body = self.mean_colour(&self.turned_over, true);
        let is_plain = self.draft.composer.ramp.is_empty();
        let alarm = if is_plain { palette.alarm_line } else { palette.alarm };
        let kinds: [(LineKind, [f32; 2], Colour, Colour); 5] = [
            (LineKind::Edge, [EDGE_WIDTH, EDGE_ALPHA * strength], palette.edge, body),
            (LineKind::Bar, [BAR_WIDTH, BAR_ALPHA], palette.edge, palette.background),
            (LineKind::AlarmEdge, [ALARM_EDGE_WIDTH, ALARM_EDGE_ALPHA * strength], alarm, alarm_body),
            (LineKind::AlarmContour, [CONTOUR_WIDTH, 1.0], alarm, alarm_body),
            (LineKind::Contour, [CONTOUR_WIDTH, palette.outline_alpha], palette.outline, body),
        ];
        for (kind, [width, alpha], colour, ground) in kinds {
            let lines = self.lines.iter().filter(|line| line.kind == kind);
            let mut path = Path::default();
            lines.for_each(|line: &Line| path.add_line(&[line.from, line.to].map(|end| self.pixel(end))));
            if !path.is_empty() && alpha > 0.0 {
                let paint = Paint { colour, alpha: self.alpha(alpha, colour, ground) };
                items.push(Item::stroke(path, Pen::solid(width * self.line_scale()), paint));
            }
        }
    }

    /// Coloured lines.
    fn strokes(&self, items: &mut Vec<Item>) {
        self.strokes.iter().for_each(|stroke| self.stroke(stroke, stroke.colours, items));
        let on_body = |stroke: &&Stroke| matches!(stroke.second, Second::OnBody(_));
        if !self.strokes.iter().any(|stroke| on_body(&stroke)) {
            return;
        }
        for mesh in [&self.sound, &self.turned_over] {
            if !mesh.triangles.is_empty() {
                let mut seen = Vec::new();
                for stroke in self.strokes.iter().filter(on_body) {
                    if let Second::OnBody(colour) = stroke.second {
                        self.stroke(stroke, [colour; 2], &mut seen);
                    }
                }
                items.push(Item::Clip { path: self.whole(mesh), items: seen });
            }
        }
    }

    fn stroke(&self, stroke: &Stroke, [first, last]: [Colour; 2], items: &mut Vec<Item>) {
        let [from, to] = stroke.ends.map(|end| self.pixel(end));
        let mut width = stroke.width;
        // Pieces of one line fit together only with straight ends.
        let mut round = true;
        if let Second::Casing(casing) = stroke.second {
            let pen = Pen { round: false, ..Pen::solid(width) };
            items.push(Item::stroke(Path::open(&[from, to]), pen, casing));
            width -= 2.0 * (CASING * width).max(LEAST_CASING);
            round = false;
        }
        if width <= 0.0 {
            return;
        }
        let pieces = if first == last { 1 } else { PIECES };
        let at = |piece: u32| narrow(f64::from(piece) / f64::from(pieces));
        for piece in 0..pieces {
            // Each piece extends to the end of the line, below the next piece: no seams.
            let begin = from.lerp(to, at(piece));
            let colour = mixed(first, last, at(piece) + 0.5 / narrow(f64::from(pieces)));
            let pen = Pen { round: round && pieces == 1, ..Pen::solid(width) };
            items.push(Item::stroke(Path::open(&[begin, to]), pen, colour));
        }
    }

    /// The opacity that looks the same in blended bytes as a given opacity in blended light.
    fn alpha(&self, alpha: f32, above: Colour, below: Colour) -> f32 {
        let seen = encoded_exactly(mixed_light(below, above, alpha));
        let [whole, part] = [above.map(f64::from), seen].map(|colour| {
            narrow(colour.iter().zip(below).map(|(&one, other)| (one - f64::from(other)).abs()).sum::<f64>())
        });
        if whole > 0.0 { (part / whole).clamp(0.0, 1.0) } else { alpha }
    }
}

/// Polygons with an area as one path.
pub(super) fn path_of(polygons: impl Iterator<Item = Vec<Vec2>>) -> Path {
    let mut path = Path::default();
    polygons.filter(|polygon| polygon.len() > 2).for_each(|polygon| path.add_polygon(&polygon));
    path
}

/// The part of a triangle with values between two others.
fn part(triangle: &[(Vec2, f32); 3], low: f32, high: f32) -> Vec<Vec2> {
    let mut polygon = triangle.to_vec();
    for (level, sign) in [(low, 1.0), (high, -1.0)] {
        if !level.is_finite() {
            continue;
        }
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

/// A mix of two colours, as light mixes.
fn mixed(from: Colour, to: Colour, share: f32) -> Colour {
    encoded(mixed_light(from, to, share))
}

fn mixed_light(from: Colour, to: Colour, share: f32) -> [f64; 3] {
    let ([a, b], share) = ([from, to].map(linear), f64::from(share));
    std::array::from_fn(|at| a[at] + (b[at] - a[at]) * share)
}
