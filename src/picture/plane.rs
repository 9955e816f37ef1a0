//! What bodies in the plane have besides their surface: nodes, arrows that say which way round elements are, and a
//! floor seen from its side.

use super::camera::Lens;
use super::layout::{Rectangle, Scale};
use super::narrow::narrow;
use super::palette::{Colour, Palette};
use super::{Mark, MarkShape};
use crate::sim::body::Body;
use crate::sim::contact::{self, Obstacle};
use glam::{DVec2, DVec3};

/// Radius of a node (px in the reference picture).
const NODE: f64 = 5.2;
/// Radius of a ring arrow, and of the disc behind one of a turned-over element (px in the reference picture).
const RING: [f64; 2] = [13.0, 17.0];
/// Elements whose middle is nearer to a side than this get no arrow (px in the reference picture).
const LEAST_ROOM: f64 = 18.0;
/// Bodies of more nodes than this are drawn without nodes and arrows.
const MANY_NODES: usize = 150;
/// How far the floor reaches down (px in the reference picture).
const FLOOR_DEPTH: f64 = 50.0;
/// Depth of the soft shadow on the floor (px in the reference picture).
const SHADOW_DEPTH: f64 = 16.0;

/// One panel in the plane.
pub(super) struct Flat<'a> {
    pub(super) body: &'a Body,
    pub(super) position: &'a [DVec3],
    pub(super) turned_over: &'a [bool],
    pub(super) lens: &'a Lens,
    pub(super) viewport: Rectangle,
    pub(super) scale: Scale,
    pub(super) palette: &'a Palette,
}

impl Flat<'_> {
    /// The floor, below the body.
    pub(super) fn floor(&self, obstacles: &[Obstacle], marks: &mut Vec<Mark>) {
        // Slopes and walls have no marks of their own yet.
        let level = contact::ground(obstacles).filter(|(normal, _)| normal.y > 1.0 - 1e-9);
        let Some((_, level)) = level else { return };
        let Some((pixel, _)) = self.lens.project(DVec3::new(self.lens.eye.x, level, 0.0)) else { return };
        let [left, top, width, height] = self.viewport.map(f64::from);
        let (y, margin, unit) = (pixel[1].round(), self.scale.margin(), self.scale.unit);
        let length = width - 2.0 * margin;
        if y < top || y >= top + height || length <= 0.0 {
            return;
        }
        let depth = (FLOOR_DEPTH * unit).min(top + height - y);
        let mark = |rectangle: [f64; 4], colour, shape| Mark {
            rectangle: rectangle.map(narrow),
            colour,
            second: colour,
            shape,
        };
        marks.push(mark([left + margin, y, length, depth], self.palette.hairline, MarkShape::Fading));
        let pixels = self.position.iter().filter_map(|&point| self.lens.project(point)).map(|(pixel, _)| pixel);
        let lowest = pixels.clone().map(|pixel| pixel[1]).fold(f64::NEG_INFINITY, f64::max);
        let room = 40.0 * unit;
        if lowest > y - room {
            // The shadow of what is close to the floor.
            let near = pixels.filter(|pixel| pixel[1] > y - room).map(|pixel| pixel[0]);
            let (low, high) = near.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
            let low = (low - room).max(left + margin);
            let high = (high + room).min(left + width - margin);
            if high > low {
                let depth = (SHADOW_DEPTH * unit).min(depth);
                marks.push(mark([low, y, high - low, depth], self.palette.shadow, MarkShape::Shadow));
            }
        }
        let thickness = (1.6 * unit).round().max(1.0);
        marks.push(mark([left + margin, y, length, thickness], self.palette.axis, MarkShape::Filled));
    }

    /// Arrows and nodes, above the body.
    pub(super) fn signs(&self, marks: &mut Vec<Mark>) {
        if self.body.len() > MANY_NODES || self.position.is_empty() {
            return;
        }
        let mut sound = Vec::new();
        let mut turned_over = Vec::new();
        for (element, nodes) in self.body.elements.iter().enumerate() {
            let corners: Vec<_> = nodes.iter().filter_map(|&node| self.pixel(self.position[node as usize])).collect();
            if corners.len() == nodes.len() && nodes.len() > 2 {
                let over = self.turned_over.get(element).copied().unwrap_or(false);
                if over { turned_over.push(corners) } else { sound.push(corners) }
            }
        }
        for corners in &sound {
            self.sound_arrow(corners, &turned_over, marks);
        }
        for corners in &turned_over {
            self.alarm_arrow(corners, marks);
        }
        let unit = self.scale.line();
        for pixel in self.position.iter().filter_map(|&point| self.pixel(point)) {
            self.round(pixel, NODE * unit, self.palette.node, self.palette.edge, MarkShape::Node, marks);
        }
    }

    /// The arrow of a sound element, unless a turned-over one lies over it.
    fn sound_arrow(&self, corners: &[DVec2], turned_over: &[Vec<DVec2>], marks: &mut Vec<Mark>) {
        let unit = self.scale.line();
        let (middle, room) = roomiest(corners);
        if room > LEAST_ROOM * unit && !turned_over.iter().any(|polygon| is_inside(polygon, middle)) {
            let colour = self.palette.sign();
            self.round(middle, RING[0] * unit, colour, colour, MarkShape::CounterClockwise, marks);
        }
    }

    /// The arrow of a turned-over element, on a disc of its own.
    fn alarm_arrow(&self, corners: &[DVec2], marks: &mut Vec<Mark>) {
        let [ring, disc] = RING.map(|radius| radius * self.scale.line());
        let (middle, room) = roomiest(corners);
        if room > 0.55 * disc {
            let white = [255; 3];
            self.round(middle, disc, white, white, MarkShape::Node, marks);
            let colour = Palette::alarm_on_white();
            self.round(middle, ring, colour, colour, MarkShape::Clockwise, marks);
        }
    }

    /// A mark of a radius around a pixel.
    fn round(
        &self,
        middle: DVec2,
        radius: f64,
        colour: Colour,
        second: Colour,
        shape: MarkShape,
        marks: &mut Vec<Mark>,
    ) {
        // Nothing of one panel appears in its neighbour.
        let [left, top, width, height] = self.viewport.map(f64::from);
        let inside = left + radius <= middle.x
            && middle.x <= left + width - radius
            && top + radius <= middle.y
            && middle.y <= top + height - radius;
        if inside {
            let rectangle = [middle.x - radius, middle.y - radius, 2.0 * radius, 2.0 * radius].map(narrow);
            marks.push(Mark { rectangle, colour, second, shape });
        }
    }

    fn pixel(&self, point: DVec3) -> Option<DVec2> {
        self.lens.project(point).map(|(pixel, _)| DVec2::from(pixel))
    }
}

/// Whether a polygon winds around a point.
fn is_inside(polygon: &[DVec2], point: DVec2) -> bool {
    let sides = polygon.iter().zip(polygon.iter().cycle().skip(1));
    let crossed = sides.filter(|(a, b)| {
        (a.y > point.y) != (b.y > point.y) && point.x < a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y)
    });
    crossed.count() % 2 == 1
}

/// The point among a few inside a polygon that is farthest from all its sides, and how far it is.
fn roomiest(corners: &[DVec2]) -> (DVec2, f64) {
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
