//! Obstacles in the plane: discs, rods with round ends and rectangles, flat and behind the body. Plates are drawn as
//! floors are.

use super::camera::Lens;
use super::narrow::narrow_point;
use super::obstacle::{HalfSpace, Staged, clipped_polygon, going};
use super::palette::{Colour, Palette};
use super::pointer::Pointers;
use super::{Mark, Mesh, Obstacles, Solid, Vertex};
use crate::sim::contact::{Motion, Obstacle, Shape};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A round outline is nowhere farther from its polygon than this (px).
const FLATNESS: f64 = 0.1;
/// Into how many segments something round is cut, at least and at most.
const SEGMENTS: [f64; 2] = [24.0, 360.0];
/// Thickness of outlines (px in the reference picture).
const RIM: f64 = 2.0;

/// What is needed to draw the obstacles of one panel in the plane.
pub(super) struct Flat<'a> {
    pub(super) obstacles: &'a [Obstacle],
    /// The time of the panel's state (s).
    pub(super) time: f64,
    /// The time between two frames (s).
    pub(super) frame: f64,
    pub(super) lens: &'a Lens,
    /// The panel's origin (m).
    pub(super) origin: DVec3,
    /// The panel's unit of length (m).
    pub(super) side: f64,
    /// The size of the body (m).
    pub(super) extent: f64,
    /// Thickness of lines, in parts of that in the reference picture.
    pub(super) line_scale: f64,
    pub(super) palette: &'a Palette,
}

/// The half-space that a floor or a plate fills at a time (s).
pub(super) fn half_space(obstacle: &Obstacle, time: f64) -> Option<HalfSpace> {
    let Shape::Plate { point, normal } = obstacle.shape else { return obstacle.floor(time) };
    let pose = obstacle.pose(time);
    let normal = pose.turn * normal;
    Some((normal, normal.dot(pose.apply(point, point))))
}

impl Flat<'_> {
    /// The arrows of plates that move, on the side that is solid.
    pub(super) fn arrows(&self, pointers: &Pointers<'_>, marks: &mut Vec<Mark>) {
        for obstacle in self.obstacles {
            let Shape::Plate { point, .. } = obstacle.shape else { continue };
            let Some((normal, _)) = half_space(obstacle, self.time).filter(|_| obstacle.motion != Motion::Still) else {
                continue;
            };
            let point = obstacle.pose(self.time).apply(point, point);
            let going = going(obstacle, point, self.time, self.frame, self.extent);
            pointers.draw(point, going, going.velocity.dot(normal) > 0.0, 5.0, marks);
        }
    }

    /// All obstacles but half-spaces, and points around them (m).
    pub(super) fn draw(&self) -> (Obstacles, Staged) {
        let solid = self.obstacles.iter().filter_map(|obstacle| half_space(obstacle, self.time));
        let solid: Vec<_> = solid.collect();
        let (mut solids, mut outermost) = (Vec::new(), Vec::new());
        let rim = RIM * self.line_scale / self.lens.focal;
        for obstacle in self.obstacles {
            let Some(outline) = self.outline(obstacle, 0.0) else { continue };
            let [fill, line] = self.palette.obstacle_flat;
            // Where both are the first one stays: depth is everywhere the same.
            let inside = self.outline(obstacle, rim).unwrap_or_default();
            for (polygon, colour) in [(&inside, fill), (&outline, line)] {
                solids.extend(self.filled(&clipped_polygon(polygon, &solid), colour));
            }
            outermost.extend(outline);
        }
        (Obstacles { solids, slabs: Vec::new() }, Staged { outermost, ..Staged::default() })
    }

    /// The outline of an obstacle, counter-clockwise, moved inwards by a length (m); `None` for half-spaces and where
    /// nothing is left.
    fn outline(&self, obstacle: &Obstacle, inwards: f64) -> Option<Vec<DVec3>> {
        let (pose, pivot) = (obstacle.pose(self.time), obstacle.shape.pivot());
        let place = |point: DVec3| pose.apply(pivot, point);
        match obstacle.shape {
            Shape::Floor { .. } | Shape::Plate { .. } => None,
            Shape::Sphere { centre, radius } => {
                let radius = radius - inwards;
                (radius > 0.0).then(|| self.round([place(centre); 2], radius))
            }
            Shape::Capsule { from, to, radius } => {
                let radius = radius - inwards;
                (radius > 0.0).then(|| self.round([place(from), place(to)], radius))
            }
            Shape::Box { centre, half, turn } => {
                let half = half - inwards;
                let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
                let corner = |[x, y]: [f64; 2]| place(centre + turn * DVec3::new(x * half.x, y * half.y, 0.0));
                (half.x > 0.0 && half.y > 0.0).then(|| corners.map(corner).to_vec())
            }
        }
    }

    /// The outline of all points near a line.
    fn round(&self, [from, to]: [DVec3; 2], radius: f64) -> Vec<DVec3> {
        let needed = PI / (2.0 * FLATNESS / (radius * self.lens.focal).max(1e-3)).sqrt();
        let segments = (needed.clamp(SEGMENTS[0], SEGMENTS[1]) as usize).next_multiple_of(2);
        let along = (to - from).try_normalize().unwrap_or(DVec3::X);
        let across = DVec3::new(-along.y, along.x, 0.0);
        let half = segments / 2;
        let around = |middle: DVec3, begin: usize| {
            (begin..=begin + half).map(move |at| {
                let (sine, cosine) = libm::sincos(TAU * at as f64 / segments as f64);
                middle + radius * (sine * along - cosine * across)
            })
        };
        around(to, 0).chain(around(from, half)).collect()
    }

    fn filled(&self, polygon: &[DVec3], colour: Colour) -> Option<Solid> {
        let vertex = |&at: &DVec3| Vertex {
            position: narrow_point((at - self.origin) / self.side).to_array(),
            normal: [0.0, 0.0, 1.0],
            hatch: 0.0,
        };
        let triangles = (2..polygon.len() as u32).map(|at| [0, at - 1, at]);
        let mesh =
            Mesh { vertices: polygon.iter().map(vertex).collect(), triangles: triangles.collect(), shades: Vec::new() };
        (polygon.len() > 2).then_some(Solid { mesh, colour })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    #[test]
    fn a_plate_is_where_its_path_has_brought_it() {
        use crate::sim::motion::Place;
        let place = Place { shift: DVec3::new(0.0, -0.5, 0.0), turn: DVec3::new(0.0, 0.0, PI / 2.0) };
        let plate = Obstacle {
            shape: Shape::Plate { point: DVec3::Y, normal: -DVec3::Y },
            motion: Motion::at(place),
            restitution: 0.0,
            friction: 0.0,
        };
        let (normal, height) = half_space(&plate, 0.0).unwrap();
        assert!(normal.distance(DVec3::X) < 1e-12 && height.abs() < 1e-12, "{normal} {height}");
    }
}
