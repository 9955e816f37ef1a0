//! Marks of bodies in the plane: nodes, ring arrows for the orientation of elements, and floors seen from the side.

use super::Item;
use super::camera::Lens;
use super::chart::spread;
use super::ears::Ears;
use super::layout::{Rectangle, Scale};
use super::narrow::narrow;
use super::obstacle::half_space;
use super::page::{Image, Path, Step, direction, point, winding};
use super::tracking::NEARER;
use crate::colour::Colour;
use crate::look::Palette;
use crate::sim::{Body, Obstacle};
use glam::{DVec2, DVec3, Vec2};
use std::f64::consts::TAU;

/// Floors whose normal rises more than this are level.
pub(super) const LEVEL: f64 = 1.0 - 1e-9;
/// Radius of a node (px in the reference picture).
const NODE: f64 = 5.2;
/// Radius of a ring arrow, and of the disc behind the arrow of a turned-over element (px in the reference picture).
const RING: [f64; 2] = [13.0, 17.0];
/// A ring arrow, relative to its radius: radius and thickness, the latter for sound and turned-over elements, start and
/// end of its line (rad, counter-clockwise from the right), length and half width of its head.
const ARROW_RING: f32 = 0.80;
const THICKNESS: [f32; 2] = [0.14, 0.22];
const ENDS: [f32; 2] = [0.9, std::f32::consts::TAU - 0.25];
const HEAD: [f32; 2] = [0.72, 0.42];
/// Opacity of a floor and of the shadow on it where they are strongest.
const FADING: f32 = 0.75;
const SHADOW: f32 = 0.42;
/// Elements whose middle is nearer to a side than this get smaller arrows (px in the reference picture), down to this
/// part of their size.
const ROOMY: f64 = 18.0;
const SMALLEST_SIGN: f64 = 0.35;
const SMALLEST_ALARM: f64 = 0.7;
/// Above these sizes signs fade in over this part of their whole size, so that none appears suddenly.
const FADING_SIGN: f64 = 0.2;
/// Signs near the disc of another one, or near a turned-over element, fade over this distance (px in the reference
/// picture).
const FADING_BESIDE: f64 = 6.0;
/// A sign that would cover its turned-over element stands beside the body instead, at this distance; its leader has
/// this width and ends in a dot of this radius (px in the reference picture).
const BESIDE: f64 = 20.0;
const LEADER: f64 = 1.3;
const LEADER_DOT: f64 = 2.6;
/// The leader fades in between these radii of the circle inside its element, relative to a disc's radius.
const FADING_LEADER: [f64; 2] = [0.04, 0.12];
/// Bodies of more elements have no signs, which would hide the elements.
const MOST_SIGNS: usize = 16;
/// The largest radius of nodes in lengths of an element's edge, and the least radius (px).
const CROWDED: f64 = 0.14;
const SMALLEST_NODE: f64 = 1.4;
/// Thickness of the floor's line (px in the reference picture).
const FLOOR_LINE: f64 = 1.6;
/// Depth of the floor below its line (px in the reference picture).
const FLOOR_DEPTH: f64 = 50.0;
/// Floors whose normal rises or falls less than this are walls.
const STEEP: f64 = 0.5;
/// The margin between walls and the sides of the panel (px in the reference picture).
const WALL_MARGIN: f64 = 4.0;
/// Depth of the soft shadow on the floor (px in the reference picture).
const SHADOW_DEPTH: f64 = 16.0;

/// The centre and radius of a circle inside a polygon (px).
type Circle = (DVec2, f64);

/// One panel in the plane.
pub(super) struct PlaneMarks<'a> {
    pub(super) body: &'a Body,
    pub(super) ears: &'a Ears,
    pub(super) position: &'a [DVec3],
    pub(super) turned_over: &'a [bool],
    pub(super) lens: &'a Lens,
    /// Whether the camera moves between frames.
    pub(super) moves: bool,
    pub(super) viewport: Rectangle,
    /// The part of the viewport without words.
    pub(super) clear: Rectangle,
    /// Whether floors, and the shadows on them, are drawn.
    pub(super) floors: [bool; 2],
    pub(super) scale: Scale,
    pub(super) palette: &'a Palette,
}

impl PlaneMarks<'_> {
    /// All floors, below the body.
    pub(super) fn floors(&self, obstacles: &[Obstacle], time: f64, marks: &mut Vec<Item>) {
        for obstacle in obstacles {
            let Some((normal, height)) = half_space(obstacle, time) else { continue };
            if normal.y > LEVEL {
                self.level(height, self.alignment(obstacle), marks);
            } else {
                self.slope(normal, height, marks);
            }
        }
    }

    /// A floor at any angle, also a wall or a ceiling: a line between the words, soft on its solid side.
    fn slope(&self, normal: DVec3, height: f64, marks: &mut Vec<Item>) {
        let unit = self.scale.unit;
        // The point of the floor nearest to the middle of the picture.
        let middle = DVec3::new(self.lens.eye.x, self.lens.eye.y, 0.0);
        let Some(start) = self.pixel(middle + (height - normal.dot(middle)) * normal) else { return };
        let along = DVec2::new(normal.y, normal.x);
        let [left, top, width, height] = self.viewport.map(f64::from);
        let mut clear = self.clear.map(f64::from);
        if normal.y.abs() < STEEP {
            // Walls may stand beside the text.
            (clear[0], clear[2]) = (left + WALL_MARGIN * unit, width - 2.0 * WALL_MARGIN * unit);
        }
        let Some([from, to]) = clipped(start, along, sides(clear), WHOLE) else { return };
        // The floor does not extend into the neighbouring panel.
        let inward = along.perp();
        let ends = [from, to].map(|at| start + at * along);
        let reaches = ends.iter().flat_map(|end| {
            [(end.x - left, inward.x, width), (end.y - top, inward.y, height)]
                .map(|(at, step, length)| if step < 0.0 { at / -step } else { (length - at) / step.max(1e-9) })
        });
        let depth = reaches.fold(FLOOR_DEPTH * unit, f64::min).max(0.0);
        let sides =
            |[from, to]: [f64; 2], depth: f64| [start + from * along, (to - from) * along, depth * along.perp()];
        let [has_floor, has_shadow] = self.floors;
        if has_floor {
            marks.push(fading(sides([from, to], depth), self.palette.hairline));
        }
        let room = 40.0 * unit;
        let pixels = self.position.iter().filter_map(|&point| self.pixel(point));
        let near = pixels.filter(|&pixel| along.perp_dot(pixel - start) > -room).map(|pixel| along.dot(pixel - start));
        let (low, high) = near.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), at| (a.min(at), b.max(at)));
        let (low, high) = ((low - room).max(from), (high + room).min(to));
        if high > low && has_shadow {
            marks.push(shadow(sides([low, high], (SHADOW_DEPTH * unit).min(depth)), self.palette.shadow));
        }
        let thickness = (FLOOR_LINE * unit).round().max(1.0);
        if !has_floor {
            return;
        }
        marks.push(line(sides([from, to], thickness), self.palette.axis));
    }

    /// The shift of a level floor (px) by which it lies on whole pixels, unless the floor or the camera moves. It is
    /// the same in all frames, so that motion is even.
    fn alignment(&self, obstacle: &Obstacle) -> f64 {
        let start = half_space(obstacle, 0.0).filter(|(normal, _)| normal.y > LEVEL && !self.moves);
        let pixel = start.and_then(|(_, level)| self.lens.project(DVec3::new(self.lens.eye.x, level, 0.0)));
        pixel.map_or(0.0, |([_, y], _)| y.round() - y)
    }

    /// A level floor.
    fn level(&self, level: f64, alignment: f64, marks: &mut Vec<Item>) {
        let Some((pixel, _)) = self.lens.project(DVec3::new(self.lens.eye.x, level, 0.0)) else { return };
        let [left, top, width, height] = self.viewport.map(f64::from);
        let (y, unit) = (sharpened(pixel[1] + alignment), self.scale.unit);
        // Without words it extends to the border.
        let margin = if self.clear == self.viewport { 0.0 } else { self.scale.margin() };
        let length = width - 2.0 * margin;
        // Below the captions it would look like an underline, so it is drawn only below a body.
        let [_, clear, _, room] = self.clear.map(f64::from);
        if y < top || y > clear + room + NEARER[1] * unit || length <= 0.0 {
            return;
        }
        let depth = (FLOOR_DEPTH * unit).min(top + height - y);
        let sides = |left: f64, length: f64, depth: f64| [DVec2::new(left, y), length * DVec2::X, depth * DVec2::Y];
        let [has_floor, has_shadow] = self.floors;
        if has_floor {
            marks.push(fading(sides(left + margin, length, depth), self.palette.hairline));
        }
        let pixels = self.position.iter().filter_map(|&point| self.lens.project(point)).map(|(pixel, _)| pixel);
        let lowest = pixels.clone().map(|pixel| pixel[1]).fold(f64::NEG_INFINITY, f64::max);
        let room = 40.0 * unit;
        if lowest > y - room && has_shadow {
            // The shadow of the part of the body near the floor.
            let near = pixels.filter(|pixel| pixel[1] > y - room).map(|pixel| pixel[0]);
            let (low, high) = near.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
            let low = (low - room).max(left + margin);
            let high = (high + room).min(left + width - margin);
            if high > low {
                let depth = (SHADOW_DEPTH * unit).min(depth);
                marks.push(shadow(sides(low, high - low, depth), self.palette.shadow));
            }
        }
        if !has_floor {
            return;
        }
        let thickness = (FLOOR_LINE * unit).round().max(1.0);
        marks.push(line(sides(left + margin, length, thickness), self.palette.axis));
    }

    /// Ring arrows for the orientation of elements, above the body.
    pub(super) fn signs(&self, marks: &mut Vec<Item>) {
        if self.body.elements.len() > MOST_SIGNS || self.position.is_empty() {
            return;
        }
        let mut sound = Vec::new();
        let mut turned_over = Vec::new();
        for (element, nodes) in self.body.elements.iter().enumerate() {
            let corners: Vec<_> = nodes.iter().filter_map(|&node| self.pixel(self.position[node as usize])).collect();
            if corners.len() == nodes.len() && nodes.len() > 2 {
                let over = self.turned_over.get(element).copied().unwrap_or(false);
                let place = self.place(nodes, &corners);
                if over { turned_over.push((corners, place)) } else { sound.push(place) }
            }
        }
        for &place in &sound {
            self.sound_arrow(place, &turned_over, marks);
        }
        let disc = RING[1] * self.scale.line();
        let (covered, roomy): (Vec<_>, Vec<_>) =
            turned_over.iter().map(|(_, place)| *place).partition(|place| place.1 < disc);
        for left in self.callouts(covered, marks).into_iter().chain(roomy) {
            self.alarm_arrow(left, 1.0, marks);
        }
    }

    /// Nodes, above the arrows. `element` is the length of an element's edge (px); `colours` are the colours of nodes,
    /// if they have any.
    pub(super) fn nodes(&self, element: f64, colours: &dyn Fn(usize) -> Option<Colour>, marks: &mut Vec<Item>) {
        let radius = node_radius(self.scale, element);
        for (node, &point) in self.position.iter().enumerate() {
            let Some(pixel) = self.pixel(point) else { continue };
            let disc = Item::rimmed(pixel, radius, colours(node).unwrap_or(self.palette.node), self.palette.edge);
            self.add(disc, pixel, radius, marks);
        }
    }

    /// The place of an element's arrow: in the roomiest of its triangles if it is not convex.
    fn place(&self, nodes: &[u32], corners: &[DVec2]) -> Circle {
        let Some(ears) = self.ears.of(nodes) else { return roomiest(corners) };
        let places = ears.iter().map(|ear| roomiest(&ear.map(|at| corners[at as usize])));
        places.max_by(|one, other| one.1.total_cmp(&other.1)).unwrap_or((DVec2::ZERO, 0.0))
    }

    /// The arrow of an element that is not turned over, unless a turned-over one covers it.
    fn sound_arrow(&self, (middle, room): Circle, turned_over: &[(Vec<DVec2>, Circle)], marks: &mut Vec<Item>) {
        let unit = self.scale.line();
        // The distance to a turned-over element, or to the disc of its arrow.
        let beside = |(polygon, (disc, _)): &(Vec<DVec2>, Circle)| {
            outside(polygon, middle).min(disc.distance(middle) - (RING[0] + RING[1]) * unit)
        };
        let free = turned_over.iter().map(beside).fold(f64::INFINITY, f64::min) / (FADING_BESIDE * unit);
        // The arrow is smaller in a small element, so it grows gradually as the camera approaches.
        let size = (room / (ROOMY * unit)).min(1.0);
        let grown = ((size - SMALLEST_SIGN) / FADING_SIGN).min(1.0);
        let radius = size * RING[0] * unit;
        let path = ring_arrow(point(middle), narrow(radius), THICKNESS[0], 1.0);
        let sign = Item::part("ring arrow", [Item::fill(path, self.palette.sign())]);
        if let Some(sign) = sign.faded(grown.min(free)) {
            self.add(sign, middle, radius, marks);
        }
    }

    /// Signs that would cover their elements stand left or right of the body, with leaders to the elements. Returns the
    /// elements whose signs have no room.
    fn callouts(&self, mut places: Vec<Circle>, marks: &mut Vec<Item>) -> Vec<Circle> {
        let disc = RING[1] * self.scale.line();
        let pixels = self.position.iter().filter_map(|&point| self.pixel(point));
        let none = [DVec2::INFINITY, DVec2::NEG_INFINITY];
        let [low, high] = pixels.fold(none, |[low, high], at| [low.min(at), high.max(at)]);
        let [_, top, _, bottom] = sides(self.viewport.map(f64::from));
        let away = BESIDE * self.scale.line() + disc;
        // Each sign is on the nearer side. Signs that would touch are above each other, and none is below the body, on
        // the floor.
        places.sort_by(|one, other| one.0.y.total_cmp(&other.0.y));
        let is_right = |place: &Circle| place.0.x >= low.x.midpoint(high.x);
        let (right, left): (Vec<_>, Vec<_>) = places.into_iter().partition(is_right);
        let mut without_room = Vec::new();
        for (places, x) in [(left, low.x - away), (right, high.x + away)] {
            let heights: Vec<_> = places.iter().map(|(middle, _)| middle.y).collect();
            let ends = [(low.y - disc).max(top + disc), (high.y - disc).min(bottom - disc)];
            for (place, y) in places.into_iter().zip(spread(&heights, 2.2 * disc, ends)) {
                let sign = DVec2::new(x, y);
                if !self.holds(sign, disc) {
                    without_room.push(place);
                    continue;
                }
                let (middle, room) = place;
                let [from, to] = FADING_LEADER.map(|part| part * disc);
                let grown = (room - from) / (to - from);
                let end = sign + disc * (middle - sign).normalize_or_zero();
                let unit = self.scale.line();
                let colour = self.palette.alarm_text;
                let leader = Item::line([middle, end], LEADER * unit, colour);
                let dot = Item::rimmed(middle, LEADER_DOT * unit, colour, self.palette.background);
                marks.extend([leader, dot].into_iter().filter_map(|mark| mark.faded(grown)));
                self.alarm_arrow((sign, disc), grown, marks);
            }
        }
        without_room
    }

    /// The arrow of a turned-over element on a disc, with at most a part of its opacity.
    fn alarm_arrow(&self, (middle, room): Circle, most: f64, marks: &mut Vec<Item>) {
        let [ring, disc] = RING.map(|radius| radius * self.scale.line());
        // A disc must not hide its element.
        let size = (room / (0.55 * disc)).min(1.0);
        let grown = ((size - SMALLEST_ALARM) / FADING_SIGN).min(most);
        let path = ring_arrow(point(middle), narrow(size * ring), THICKNESS[1], -1.0);
        let ground = Item::disc(middle.to_array(), size * disc, [255; 3]);
        let sign = Item::part("alarm arrow", [ground, Item::fill(path, self.palette.alarm_on_white)]);
        if let Some(sign) = sign.faded(grown) {
            self.add(sign, middle, size * disc, marks);
        }
    }

    /// Adds a mark of a radius around a pixel (px), unless it would extend into a neighbouring panel.
    fn add(&self, mark: Item, middle: DVec2, radius: f64, marks: &mut Vec<Item>) {
        marks.extend(self.holds(middle, radius).then_some(mark));
    }

    /// Whether a circle lies inside the panel (px).
    fn holds(&self, middle: DVec2, radius: f64) -> bool {
        let [left, top, right, bottom] = sides(self.viewport.map(f64::from));
        left + radius <= middle.x
            && middle.x <= right - radius
            && top + radius <= middle.y
            && middle.y <= bottom - radius
    }

    fn pixel(&self, point: DVec3) -> Option<DVec2> {
        self.lens.project(point).map(|(pixel, _)| DVec2::from(pixel))
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

/// Pixels from a corner along two sides (px), with an opacity that depends on their place, from 0 to 1 along each.
fn soft(sides: [DVec2; 3], columns: u32, [r, g, b]: Colour, opacity: impl Fn(f32, f32) -> f32) -> Item {
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

/// A place near a given one (px), closer to the border of pixels, where a line is sharp.
fn sharpened(place: f64) -> f64 {
    place - libm::sin(TAU * place) / TAU
}

/// The radius of a node for elements with edges of a length (px), smaller than usual if they are short.
pub(super) fn node_radius(scale: Scale, element: f64) -> f64 {
    (NODE * scale.line()).min((CROWDED * element).max(SMALLEST_NODE))
}

/// The part of a straight line inside a rectangle, which is given by its four sides, as a range of multiples of a
/// direction from a point of the line (Liang and Barsky).
pub(super) fn clipped(
    start: DVec2,
    along: DVec2,
    [left, top, right, bottom]: [f64; 4],
    [mut from, mut to]: [f64; 2],
) -> Option<[f64; 2]> {
    for (at, step, low, high) in [(start.x, along.x, left, right), (start.y, along.y, top, bottom)] {
        if step.abs() < 1e-12 {
            // The line is parallel to these two sides, outside or between them.
            if at < low || at > high {
                return None;
            }
        } else {
            let [one, other] = [low, high].map(|side| (side - at) / step);
            (from, to) = (from.max(one.min(other)), to.min(one.max(other)));
        }
    }
    (to > from).then_some([from, to])
}

/// The left, top, right and bottom side of a rectangle of a width and a height (px).
pub(super) fn sides([left, top, width, height]: [f64; 4]) -> [f64; 4] {
    [left, top, left + width, top + height]
}

/// The whole line.
const WHOLE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// Whether a polygon winds around a point.
pub(super) fn is_inside(polygon: &[DVec2], point: DVec2) -> bool {
    let sides = polygon.iter().zip(polygon.iter().cycle().skip(1));
    let crossed = sides.filter(|(a, b)| {
        (a.y > point.y) != (b.y > point.y) && point.x < a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y)
    });
    crossed.count() % 2 == 1
}

/// The distance of a point from a polygon; 0 inside it.
fn outside(polygon: &[DVec2], point: DVec2) -> f64 {
    if is_inside(polygon, point) {
        return 0.0;
    }
    let sides = polygon.iter().zip(polygon.iter().cycle().skip(1));
    sides.map(|(&a, &b)| from_side(point, a, b)).fold(f64::INFINITY, f64::min)
}

/// The distance of a point from the straight line between two others.
pub(super) fn from_side(point: DVec2, a: DVec2, b: DVec2) -> f64 {
    let share = (point - a).dot(b - a) / (b - a).length_squared().max(f64::MIN_POSITIVE);
    point.distance(a.lerp(b, share.clamp(0.0, 1.0)))
}

/// Among some points inside a polygon, the one farthest from all its sides, and its distance.
fn roomiest(corners: &[DVec2]) -> Circle {
    let centroid = corners.iter().sum::<DVec2>() / corners.len() as f64;
    let next = corners.iter().cycle().skip(1);
    let room = corners
        .iter()
        .zip(next.clone())
        .map(|(&a, &b)| {
            let along = (b - a).normalize_or_zero();
            along.perp_dot(centroid - a).abs()
        })
        .fold(f64::INFINITY, f64::min);
    if corners.len() != 3 {
        return (centroid, room);
    }
    // A triangle's roomiest point is the middle of its inscribed circle.
    let [a, b, c] = [corners[0], corners[1], corners[2]];
    let lengths = [(b - c).length(), (c - a).length(), (a - b).length()];
    let around: f64 = lengths.iter().sum();
    if around <= 0.0 {
        return (centroid, 0.0);
    }
    let middle = (a * lengths[0] + b * lengths[1] + c * lengths[2]) / around;
    (middle, (b - a).perp_dot(c - a).abs() / around)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arrow_stands_where_a_triangle_is_widest() {
        let corners = [DVec2::new(0.0, 0.0), DVec2::new(4.0, 0.0), DVec2::new(0.0, 3.0)];
        let (middle, room) = roomiest(&corners);
        assert!((middle - DVec2::ONE).length() < 1e-12 && (room - 1.0).abs() < 1e-12, "{middle} {room}");
    }

    #[test]
    fn lines_are_cut_to_their_rectangle() {
        let (rectangle, slant) = (sides([10.0, 20.0, 40.0, 30.0]), DVec2::ONE.normalize());
        let clip = |start, along| clipped(start, along, rectangle, WHOLE);
        assert_eq!(clip(DVec2::new(0.0, 30.0), DVec2::X), Some([10.0, 50.0]));
        assert_eq!(clip(DVec2::new(0.0, 10.0), DVec2::X), None);
        assert_eq!(clip(DVec2::new(30.0, 0.0), -DVec2::Y), Some([-50.0, -20.0]));
        let [from, to] = clip(DVec2::new(10.0, 20.0), slant).unwrap();
        assert!(from.abs() < 1e-12 && (to - 30.0 * 2.0_f64.sqrt()).abs() < 1e-12, "{from} {to}");
        assert_eq!(clip(DVec2::new(60.0, 0.0), slant), None);
    }

    #[test]
    fn points_are_told_inside_from_outside() {
        let square = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        assert!(is_inside(&square, DVec2::splat(0.5)));
        assert!(!is_inside(&square, DVec2::new(1.5, 0.5)) && !is_inside(&square, DVec2::new(-0.5, 0.5)));
    }

    #[test]
    fn collapsed_elements_have_no_room() {
        assert_eq!(roomiest(&[DVec2::ONE; 3]).1, 0.0);
        assert_eq!(roomiest(&[DVec2::ONE; 4]).1, 0.0);
    }
}
