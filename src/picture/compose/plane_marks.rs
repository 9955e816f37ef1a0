//! Marks of bodies in the plane: ring arrows for the orientation of elements, and floors seen from the side.

use super::draft::{Draft, PixelBox};
use crate::colour::Colour;
use crate::look::FloorStyle;
use crate::picture::Item;
use crate::picture::chart::spread;
use crate::picture::compose::obstacle::{HalfSpace, half_space};
use crate::picture::flat::soft;
use crate::picture::layout::steps::{BESIDE, CLOSE, FREE, GAP, MARGIN, RING, SHORT, STRONG, THIN};
use crate::picture::narrow::narrow;
use crate::picture::page::{Path, Step, direction, point, winding};
use crate::picture::plane::{WHOLE, around, clipped, from_side, is_inside, sides};
use crate::picture::shell::is_broken;
use crate::scene::Scene;
use crate::sim::{Dimension, Motion, Obstacle};
use glam::{DVec2, DVec3, Vec2};
use std::f64::consts::TAU;

/// Floors whose normal rises more than this are level.
const LEVEL: f64 = 1.0 - 1e-9;
/// A ring arrow, relative to its radius: radius and thickness, the latter for sound and turned-over elements, start and
/// end of its line (rad, counter-clockwise from the right), length and half width of its head.
const ARROW_RING: f32 = 0.80;
const THICKNESS: [f32; 2] = [0.14, 0.22];
const ENDS: [f32; 2] = [0.9, std::f32::consts::TAU - 0.25];
const HEAD: [f32; 2] = [0.72, 0.42];
/// Opacity of a floor and of the shadow on it where they are strongest.
const FADING: f32 = 0.75;
const SHADOW: f32 = 0.42;
/// Arrows are smaller in small elements, down to this part of their size. Above it they fade in over a part of their whole
/// size, so that none appears suddenly.
const SMALLEST_SIGN: f64 = 0.35;
const FADING_SIGN: f64 = 0.2;
/// Leaders fade in between these radii of the circle inside their element, relative to a disc's radius.
const FADING_LEADER: [f64; 2] = [0.04, 0.12];
/// Bodies of more elements have no signs, which would hide the elements.
const MOST_SIGNS: usize = 16;

/// The centre and radius of a circle inside a polygon (px).
type Circle = (DVec2, f64);

/// Whether a scene in the plane has slopes, walls or floors that move, which may run behind words.
pub(super) fn have_slopes(scene: &Scene) -> bool {
    let is_slope = |obstacle: &Obstacle| {
        let is_level = |(normal, _): HalfSpace| normal.y.abs() >= LEVEL && obstacle.motion == Motion::Still;
        half_space(obstacle, 0.0).is_some_and(|floor| !is_level(floor))
    };
    scene.dimension() == Dimension::Plane && scene.obstacles.iter().any(is_slope)
}

impl Draft<'_> {
    /// All floors, below the body.
    pub(super) fn floors(&self) -> impl Iterator<Item = Item> {
        self.scene.obstacles.iter().filter_map(|obstacle| {
            self.floor_in_plane(half_space(obstacle, self.snapshot.time)?, obstacle.motion == Motion::Still)
        })
    }

    /// A floor at any angle, also a wall or a ceiling: a line between the words or, of a slope and a wall, to the borders of the panel, soft on its
    /// solid side.
    fn floor_in_plane(&self, (normal, height): HalfSpace, is_still: bool) -> Option<Item> {
        let unit = self.scale.unit;
        // The point of the floor nearest to the middle of the picture.
        let middle = DVec3::new(self.lens.eye.x, self.lens.eye.y, 0.0);
        let mut start = self.pixel(middle + (height - normal.dot(middle)) * normal)?;
        if normal.y > LEVEL {
            // On whole pixels a line is sharp; a moving one must move evenly.
            start.y = if is_still && !self.framing.moves { start.y.round() } else { sharpened(start.y) };
        }
        let along = DVec2::new(normal.y, normal.x);
        let mut clear = sides(self.clear.map(f64::from));
        if normal.y > LEVEL {
            // Only below a body: below the captions it would look like an underline.
            clear[3] = (clear[3] + RING * unit).min(sides(self.viewport.map(f64::from))[3]);
        }
        if normal.y.abs() < LEVEL {
            // They are cut there, so that their ends are not seen.
            let [left, top, right, bottom] = sides(self.viewport.map(f64::from));
            let more = MARGIN * unit;
            clear = [left - more, top - more, right + more, bottom + more];
        }
        let [from, to] = clipped(start, along, clear, WHOLE)?;
        let (inward, depth) = (along.perp(), MARGIN * unit);
        let mut drawn = Vec::new();
        let sides = |[from, to]: [f64; 2], depth: f64| [start + from * along, (to - from) * along, depth * inward];
        let view = &self.scene.view;
        let [has_floor, has_shadow] = [view.floor != FloorStyle::None, view.shadow];
        if has_floor {
            drawn.push(fading(sides([from, to], depth), self.palette.hairline));
        }
        // The shadow of the part of the body near the floor.
        let room = MARGIN * unit;
        let pixels = self.position.iter().filter_map(|&point| self.pixel(point));
        let near = pixels.filter(|&pixel| along.perp_dot(pixel - start) > -room).map(|pixel| along.dot(pixel - start));
        let (low, high) = near.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), at| (a.min(at), b.max(at)));
        let (low, high) = ((low - room).max(from), (high + room).min(to));
        if high > low && has_shadow {
            drawn.push(shadow(sides([low, high], GAP * unit), self.palette.shadow));
        }
        if has_floor {
            let thickness = (STRONG * unit).round().max(1.0);
            drawn.push(line(sides([from, to], thickness), self.palette.axis));
        }
        // The floor does not extend into the neighbouring panel.
        (!drawn.is_empty()).then(|| Item::inside(self.viewport, drawn))
    }

    /// Ring arrows for the orientation of elements, above the body.
    pub(super) fn signs(&self, marks: &mut Vec<Item>) {
        if self.diverged
            || !self.scene.view.visible.surfaces
            || self.body.elements().len() > MOST_SIGNS
            || self.position.is_empty()
        {
            return;
        }
        let (mut sound, mut turned_over) = (Vec::new(), Vec::new());
        let has_sign =
            |&(element, nodes): &(usize, &[u32])| nodes.len() > 2 && !is_broken(&self.snapshot.broken, element as u32);
        for (element, nodes) in self.body.elements().iter().enumerate().filter(has_sign) {
            let corners: Vec<_> = nodes.iter().filter_map(|&node| self.pixel(self.position[node as usize])).collect();
            let over = self.snapshot.turned_over.get(element).copied().unwrap_or(false);
            let set = if over { &mut turned_over } else { &mut sound };
            set.push((roomiest(&corners), corners));
        }
        marks.extend(sound.iter().filter_map(|&(place, _)| self.sound_arrow(place, &turned_over)));
        let disc = GAP * self.scale.line();
        let (covered, roomy): (Vec<_>, Vec<_>) =
            turned_over.iter().map(|(place, _)| *place).partition(|place| place.1 < disc);
        self.callouts(covered, marks);
        marks.extend(roomy.into_iter().filter_map(|(middle, _)| self.alarm_arrow(middle, 1.0)));
    }

    /// The arrow of an element that is not turned over, unless a turned-over one covers it.
    fn sound_arrow(&self, (middle, room): Circle, turned_over: &[(Circle, Vec<DVec2>)]) -> Option<Item> {
        let unit = self.scale.line();
        // The distance to a turned-over element, or to the disc of its arrow.
        let beside = |((disc, _), polygon): &(Circle, Vec<DVec2>)| {
            outside(polygon, middle).min(disc.distance(middle) - (BESIDE + GAP) * unit)
        };
        let free = turned_over.iter().map(beside).fold(f64::INFINITY, f64::min) / (CLOSE * unit);
        // The arrow is smaller in a small element, so it grows gradually as the camera approaches.
        let size = (room / (SHORT * unit)).min(1.0);
        let grown = ((size - SMALLEST_SIGN) / FADING_SIGN).min(1.0);
        let radius = size * BESIDE * unit;
        let path = ring_arrow(point(middle), narrow(radius), THICKNESS[0], 1.0);
        let sign = Item::part("ring arrow", [Item::fill(path, self.palette.sign())]);
        sign.faded(grown.min(free)).filter(|_| self.holds(middle, radius))
    }

    /// Signs that would cover their elements stand left or right of the body, with leaders to the elements, if they have
    /// room there.
    fn callouts(&self, mut places: Vec<Circle>, marks: &mut Vec<Item>) {
        let (unit, colour) = (self.scale.line(), self.palette.alarm_text);
        let disc = GAP * unit;
        let [low, high] = PixelBox::new(&self.lens, &*self.position).corners;
        let [_, top, _, bottom] = sides(self.viewport.map(f64::from));
        let away = SHORT * unit + disc;
        // Each sign is on the nearer side. Signs that would touch are above each other, and none is below the body, on
        // the floor.
        places.sort_by(|one, other| one.0.y.total_cmp(&other.0.y));
        let is_right = |place: &Circle| place.0.x >= low.x.midpoint(high.x);
        let (right, left): (Vec<_>, Vec<_>) = places.into_iter().partition(is_right);
        let ends = [(low.y - disc).max(top + disc), (high.y - disc).min(bottom - disc)];
        for (places, x) in [(left, low.x - away), (right, high.x + away)] {
            let heights: Vec<_> = places.iter().map(|(middle, _)| middle.y).collect();
            for ((middle, room), y) in places.into_iter().zip(spread(&heights, 2.2 * disc, ends)) {
                let sign = DVec2::new(x, y);
                let [from, to] = FADING_LEADER.map(|part| part * disc);
                let grown = (room - from) / (to - from);
                let end = sign + disc * (middle - sign).normalize_or_zero();
                let leader = Item::line([middle, end], THIN * unit, colour);
                let dot = Item::rimmed(middle, FREE * unit, colour, self.palette.background);
                if self.holds(sign, disc) {
                    marks.extend([leader, dot].into_iter().filter_map(|mark| mark.faded(grown)));
                    marks.extend(self.alarm_arrow(sign, grown));
                }
            }
        }
    }

    /// The arrow of a turned-over element on a disc, with an opacity.
    fn alarm_arrow(&self, middle: DVec2, opacity: f64) -> Option<Item> {
        let [ring, disc] = [BESIDE, GAP].map(|radius| radius * self.scale.line());
        let path = ring_arrow(point(middle), narrow(ring), THICKNESS[1], -1.0);
        let ground = Item::disc(middle.to_array(), disc, [255; 3]);
        let sign = Item::part("alarm arrow", [ground, Item::fill(path, self.palette.alarm_on_white)]);
        sign.faded(opacity).filter(|_| self.holds(middle, disc))
    }

    /// Whether a circle lies inside the panel (px).
    pub(super) fn holds(&self, middle: DVec2, radius: f64) -> bool {
        let [left, top, right, bottom] = sides(self.viewport.map(f64::from));
        let inside = |at: f64, low: f64, high: f64| (low + radius..=high - radius).contains(&at);
        inside(middle.x, left, right) && inside(middle.y, top, bottom)
    }
}

/// A ring arrow that runs counter-clockwise if `way` is 1, clockwise if it is −1.
fn ring_arrow(middle: Vec2, radius: f32, thickness: f32, way: f32) -> Path {
    // Angles count counter-clockwise in a frame whose y-axis points up; mirrored, the arrow runs clockwise.
    let turned = |angle: f32| if way > 0.0 { -angle } else { std::f32::consts::PI + angle };
    let [from, to] = ENDS.map(turned);
    let [outer, inner] = [0.5, -0.5].map(|part| (ARROW_RING + part * thickness) * radius);
    let mut path = Path::default();
    path.add_arc(middle, outer, [from, to], true);
    path.add_arc(middle, inner, [to, from], false);
    path.0.push(Step::Close);
    let out = direction(ENDS[1]);
    let corners =
        [ARROW_RING * out + HEAD[1] * out, ARROW_RING * out + HEAD[0] * out.perp(), ARROW_RING * out - HEAD[1] * out];
    let mut corners = corners.map(|corner| middle + radius * Vec2::new(way * corner.x, -corner.y));
    // The head winds like the ring: otherwise both would cancel where they overlap.
    if winding(&corners) * winding(&path.points()) < 0.0 {
        corners.reverse();
    }
    path.add_polygon(&corners);
    path
}

/// The line of a floor, from its corner along two sides (px).
fn line([corner, along, down]: [DVec2; 3], colour: Colour) -> Item {
    let corners = [corner, corner + along, corner + along + down, corner + down];
    Item::part("floor", [Item::fill(Path::polygon(&corners.map(point)), colour)])
}

/// A floor that fades out downwards.
fn fading(sides: [DVec2; 3], colour: Colour) -> Item {
    Item::part("ground", [soft(sides, 1, colour, |_, down| FADING * (1.0 - down).powi(2))])
}

/// The lower half of a soft disc.
fn shadow(sides: [DVec2; 3], colour: Colour) -> Item {
    let across = |x: f32| {
        let share = ((1.0 - (2.0 * x - 1.0).abs()) / 0.45).clamp(0.0, 1.0);
        share * share * (3.0 - 2.0 * share)
    };
    let columns = narrow(sides[1].length()).ceil().max(1.0) as u32;
    Item::part("shadow", [soft(sides, columns, colour, |x, down| SHADOW * across(x) * (1.0 - down).powi(2))])
}

/// A place near a given one (px), closer to the border of pixels, where a line is sharp.
fn sharpened(place: f64) -> f64 {
    place - libm::sin(TAU * place) / TAU
}

/// The distance of a point from a polygon; 0 inside it.
fn outside(polygon: &[DVec2], point: DVec2) -> f64 {
    if is_inside(polygon, point) {
        return 0.0;
    }
    around(polygon).map(|(&a, &b)| from_side(point, a, b)).fold(f64::INFINITY, f64::min)
}

/// A place inside a polygon far from all its sides, and its distance from them: the middle of a triangle's inscribed
/// circle, or the centroid of the corners of another polygon.
fn roomiest(corners: &[DVec2]) -> Circle {
    let mut middle = corners.iter().sum::<DVec2>() / corners.len() as f64;
    if let &[a, b, c] = corners {
        let lengths = [b.distance(c), c.distance(a), a.distance(b)];
        let around: f64 = lengths.iter().sum();
        middle = (a * lengths[0] + b * lengths[1] + c * lengths[2]) / around.max(f64::MIN_POSITIVE);
    }
    let room = around(corners).map(|(&a, &b)| from_side(middle, a, b)).fold(f64::INFINITY, f64::min);
    (middle, if is_inside(corners, middle) { room } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arrow_stands_where_a_triangle_is_widest() {
        let corners = [DVec2::new(0.0, 0.0), DVec2::new(4.0, 0.0), DVec2::new(0.0, 3.0)];
        let (middle, room) = roomiest(&corners);
        assert!((middle - DVec2::ONE).length() < 1e-12 && (room - 1.0).abs() < 1e-12, "{middle} {room}");
        assert_eq!(roomiest(&[DVec2::ONE; 3]).1, 0.0);
        assert_eq!(roomiest(&[DVec2::ONE; 4]).1, 0.0);
    }
}
