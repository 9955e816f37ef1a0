//! Flat marks and curves as paths.

use super::drawing::{Image, Item, Paint, Path, Pen};
use crate::picture::{Curve, Mark, MarkShape};
use glam::Vec2;
use std::f32::consts::{SQRT_2, TAU};

/// The ring arrow, relative to its mark's radius: radius and thickness, start and end of its line (rad,
/// counter-clockwise from the right), length and half width of its head.
const RING: f32 = 0.80;
const THICKNESS: [f32; 2] = [0.14, 0.22];
const ENDS: [f32; 2] = [0.9, TAU - 0.25];
const HEAD: [f32; 2] = [0.72, 0.42];
/// A long arrow in widths of its head: length and notch of the head, thickness of the shaft, the halo and the share of
/// its room that it fills. The last number is the head of a short arrow, in lengths of the arrow.
const ARROW_HEAD: [f32; 2] = [1.235, 0.2];
const ARROW_SHAFT: f32 = 0.247;
const ARROW_HALO: f32 = 0.17647;
const ARROW_HALO_FILLED: f32 = 0.83333;
const ARROW_SHORT: f32 = 0.62;
/// Opacity of the halo of an arrow and of other marks.
const ARROW_HALO_ALPHA: f32 = 0.92;
const HALO_ALPHA: f32 = 0.75;
/// Opacity of soft marks where they are strongest.
const FADING: f32 = 0.75;
const SHADOW: f32 = 0.42;

/// Half a pixel: the smooth border of a mark, and the overlap at the seam between two marks.
const HALF: f32 = 0.5;

/// The place of a mark on the page.
struct TurnedRectangle {
    corner: Vec2,
    size: Vec2,
    along: Vec2,
}

impl TurnedRectangle {
    /// A point of the mark (px from its left upper corner, before it is turned).
    fn at(&self, x: f32, y: f32) -> Vec2 {
        self.corner + x * self.along + y * self.along.perp()
    }

    fn polygon<const N: usize>(&self, points: [[f32; 2]; N]) -> Path {
        Path::polygon(&points.map(|[x, y]| self.at(x, y)))
    }

    fn middle(&self) -> Vec2 {
        self.at(0.5 * self.size.x, 0.5 * self.size.y)
    }

    /// A part of the mark, as a rectangle.
    fn part(&self, [left, top, right, bottom]: [f32; 4]) -> Path {
        self.polygon([[left, top], [right, top], [right, bottom], [left, bottom]])
    }

    /// Pixels with an opacity that depends on their place, from 0 to 1 to the right and down.
    fn soft(&self, mark: &Mark, columns: u32, opacity: impl Fn(f32, f32) -> f32) -> Item<'static> {
        let size = [columns, self.size.y.ceil().max(1.0) as u32];
        let mut pixels = Vec::with_capacity(4 * (size[0] * size[1]) as usize);
        for y in 0..size[1] {
            for x in 0..size[0] {
                let [u, v] = [(x as f32 + HALF) / size[0] as f32, (y as f32 + HALF) / size[1] as f32];
                let alpha = opacity(u, v).clamp(0.0, 1.0) * f32::from(mark.opacity);
                pixels.extend(mark.colour);
                pixels.push(alpha.round() as u8);
            }
        }
        let sides = [self.size.x * self.along, self.size.y * self.along.perp()];
        Item::Image(Image { size, pixels, place: [self.corner, sides[0], sides[1]] })
    }
}

/// Adds a mark to a page, below the mark `next`.
pub(super) fn mark<'a>(mark: &Mark, next: Option<&Mark>, items: &mut Vec<Item<'a>>) {
    let [left, top, width, height] = mark.rectangle;
    if width <= 0.0 || height <= 0.0 || mark.opacity == 0 {
        return;
    }
    let place =
        TurnedRectangle { corner: Vec2::new(left, top), size: Vec2::new(width, height), along: Vec2::from(mark.along) };
    let opacity = f32::from(mark.opacity) / 255.0;
    let paint = Paint { colour: mark.colour, alpha: opacity };
    let second = |part: f32| Paint { colour: mark.second, alpha: part * opacity };
    let mut fill = |path, paint| items.push(Item::Fill { path, paint });
    let radius = 0.5 * width;
    match mark.shape {
        MarkShape::Filled => fill(place.part([0.0, 0.0, width, height]), paint),
        MarkShape::Smooth => {
            let inset = HALF.min(0.25 * height);
            fill(place.part([inset, inset, width - inset, height - inset]), paint);
        }
        MarkShape::Struck => {
            fill(place.part([0.0, 0.0, width, height]), paint);
            // Half the line's width, relative to the distance from the diagonal to a corner.
            let part = 0.045 * (width + height) * (width.recip().hypot(height.recip()));
            let [x, y] = [width * part.min(1.0), height * part.min(1.0)];
            let line = [[width - x, 0.0], [width, 0.0], [width, y], [x, height], [0.0, height], [0.0, height - y]];
            fill(place.polygon(line), second(1.0));
        }
        MarkShape::Node => {
            // Side by side, because both may be transparent.
            let rim = 0.16 * width;
            fill(Path::circle(place.middle(), radius - if mark.colour == mark.second { 0.0 } else { rim }), paint);
            if mark.colour != mark.second {
                let path = Path::circle(place.middle(), radius - 0.5 * rim);
                items.push(Item::Stroke { path, pen: Pen::solid(rim), paint: second(1.0) });
            }
        }
        MarkShape::CounterClockwise => fill(ring_arrow(place.middle(), radius, THICKNESS[0], 1.0), paint),
        MarkShape::Clockwise => fill(ring_arrow(place.middle(), radius, THICKNESS[1], -1.0), paint),
        MarkShape::Fading => items.push(place.soft(mark, 1, |_, down| FADING * (1.0 - down).powi(2))),
        MarkShape::Shadow => {
            let across = |x: f32| {
                let share = ((1.0 - (2.0 * x - 1.0).abs()) / 0.45).clamp(0.0, 1.0);
                share * share * (3.0 - 2.0 * share)
            };
            let columns = width.ceil().max(1.0) as u32;
            items.push(place.soft(mark, columns, |x, down| SHADOW * across(x) * (1.0 - down).powi(2)));
        }
        MarkShape::Arrow => arrow(&place, paint, second(ARROW_HALO_ALPHA), items),
        MarkShape::Blend => {
            // Extends under the next mark, so that no seam is seen.
            let meets = next.is_some_and(|next| next.shape == MarkShape::Blend);
            let path = place.part([0.0, 0.0, if meets { width + HALF } else { width }, height]);
            let ends = [place.at(0.0, 0.0), place.at(width, 0.0)];
            items.push(Item::Blend { path, ends, colours: [mark.colour, mark.second] });
        }
        MarkShape::Point => fill(place.polygon([[0.0, 0.0], [width, 0.5 * height], [0.0, height]]), paint),
        MarkShape::Pin => {
            let [x, y] = [width, height].map(|length| 0.5 * length);
            // The halo has sharp corners, too.
            for (reach, paint) in [(0.74 + 0.17 * SQRT_2, second(HALO_ALPHA)), (0.74, paint)] {
                let reach = reach * radius;
                fill(place.polygon([[x - reach, y], [x, y - reach], [x + reach, y], [x, y + reach]]), paint);
            }
        }
        MarkShape::Hand => {
            let middle = place.middle();
            let [disc, ring] = [0.36, 0.76].map(|part| Path::circle(middle, part * radius));
            let [thickness, halo] = [0.22 * radius, 0.12 * radius];
            let mut both = |more: f32, paint: Paint| {
                items.push(Item::Fill { path: Path::circle(middle, 0.36 * radius + more), paint });
                let pen = Pen::solid(thickness + 2.0 * more);
                items.push(Item::Stroke { path: ring.clone(), pen, paint });
            };
            both(halo, second(HALO_ALPHA));
            items.push(Item::Fill { path: disc, paint });
            items.push(Item::Stroke { path: ring, pen: Pen::solid(thickness), paint });
        }
    }
}

/// A ring arrow that runs counter-clockwise if `way` is 1, clockwise if it is −1.
fn ring_arrow(middle: Vec2, radius: f32, thickness: f32, way: f32) -> Path {
    // Angles count counter-clockwise in a frame whose y-axis points up; mirrored, the arrow runs clockwise.
    let turned = |angle: f32| if way > 0.0 { -angle } else { TAU / 2.0 + angle };
    let [from, to] = ENDS.map(turned);
    let [outer, inner] = [0.5, -0.5].map(|part| (RING + part * thickness) * radius);
    let mut path = Path::default();
    path.add_arc(middle, outer, [from, to], true);
    path.add_arc(middle, inner, [to, from], false);
    path.0.push(super::drawing::Step::Close);
    let at = |x: f32, y: f32| middle + radius * Vec2::new(way * x, -y);
    let out = Vec2::new(ENDS[1].cos(), ENDS[1].sin());
    let along = out.perp();
    let corners = [RING * out + HEAD[1] * out, RING * out + HEAD[0] * along, RING * out - HEAD[1] * out];
    let mut corners = corners.map(|corner| at(corner.x, corner.y));
    // The head winds like the ring: otherwise both would cancel where they overlap.
    if winding(&corners) * winding(&ends_of(&path)) < 0.0 {
        corners.reverse();
    }
    path.add_polygon(&corners);
    path
}

/// Twice the area of a polygon, positive if it runs clockwise on the page.
pub(super) fn winding(points: &[Vec2]) -> f32 {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum()
}

/// The points of a path.
pub(super) fn ends_of(path: &Path) -> Vec<Vec2> {
    use super::drawing::Step;
    let end = |step: &Step| match *step {
        Step::Move(at) | Step::Line(at) | Step::Cubic([_, _, at]) => Some(at),
        Step::Close => None,
    };
    path.0.iter().filter_map(end).collect()
}

fn arrow(place: &TurnedRectangle, paint: Paint, halo: Paint, items: &mut Vec<Item<'_>>) {
    let wide = place.size.y / (1.0 + 2.0 * ARROW_HALO);
    let pad = wide * ARROW_HALO;
    let tip = place.size.x - 2.0 * pad;
    let head = (ARROW_HEAD[0] * wide).min(ARROW_SHORT * tip);
    let part = head / (ARROW_HEAD[0] * wide);
    let [barb, shaft] = [0.5 * wide * part, 0.5 * ARROW_SHAFT * wide * part];
    let back = tip - head;
    let joint = back + ARROW_HEAD[1] * wide * part * (1.0 - shaft / barb.max(1e-6));
    let half = [[0.0, shaft], [joint, shaft], [back, barb], [tip, 0.0]];
    let middle = 0.5 * place.size.y;
    let above = half.iter().map(|&[x, y]| place.at(pad + x, middle - y));
    let below = half.iter().rev().skip(1).map(|&[x, y]| place.at(pad + x, middle + y));
    let path = Path::polygon(&above.chain(below).collect::<Vec<_>>());
    let width = 2.0 * ARROW_HALO_FILLED * pad * part.max(0.5);
    items.push(Item::Stroke { path: path.clone(), pen: Pen::solid(width), paint: halo });
    items.push(Item::Fill { path, paint });
}

/// Adds a curve to a page.
pub(super) fn curve(curve: &Curve, items: &mut Vec<Item<'_>>) {
    let mut points: Vec<_> = curve.points.iter().copied().map(Vec2::from).collect();
    points.dedup();
    let paint = Paint { colour: curve.colour, alpha: curve.alpha.clamp(0.0, 1.0) };
    match points[..] {
        [] => {}
        [dot] => items.push(Item::Fill { path: Path::circle(dot, 0.5 * curve.width), paint }),
        _ => {
            let pen = Pen { width: curve.width, dash: curve.dash.clone(), round: curve.dash.is_empty() };
            items.push(Item::Stroke { path: Path::open(&points), pen, paint });
        }
    }
}
