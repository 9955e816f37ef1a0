//! Obstacles in the plane: discs, capsules and rectangles behind the body. Plates are drawn like floors.

use super::Staged;
use super::half_space::{clipped_polygon, half_space};
use super::space::Staging;
use crate::picture::layout::steps::STRONG;
use crate::picture::{Mesh, Obstacles, Solid, Vertex};
use crate::sim::{Obstacle, Shape};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The largest distance of a round outline from its polygon (px).
const FLATNESS: f64 = 0.1;
/// The least and the largest number of segments of a round outline.
const SEGMENTS: [f64; 2] = [24.0, 360.0];

impl Staging<'_> {
    /// All obstacles but half-spaces, in front of half-spaces. Each is one polygon in the colour of its rim and another inside.
    pub(super) fn flat(&self) -> (Obstacles, Staged) {
        let half_spaces = self.draft.scene.obstacles.iter().filter_map(|obstacle| half_space(obstacle, self.time()));
        let half_spaces: Vec<_> = half_spaces.collect();
        let [colour, rim_colour] = self.palette().obstacle_flat;
        let (mut obstacles, mut staged) = (Obstacles::default(), Staged::default());
        let rim = STRONG * self.draft.scale.line() / self.draft.lens.focal;
        // The first obstacle lies in front.
        for obstacle in self.draft.scene.obstacles.iter().rev() {
            for (inwards, colour) in [(0.0, rim_colour), (rim, colour)] {
                let corners = self.around(obstacle, inwards).unwrap_or_default();
                let corners = clipped_polygon(&corners, &half_spaces);
                let vertex = |&at: &DVec3| Vertex { position: self.draft.relative(at), ..Vertex::default() };
                let mesh = Mesh { vertices: corners.iter().map(vertex).collect(), ..Mesh::default() };
                obstacles.solids.extend((!corners.is_empty()).then_some(Solid { mesh, colour }));
                staged.outermost.extend(corners);
            }
        }
        (obstacles, staged)
    }

    /// The outline of an obstacle, counter-clockwise, moved inwards by a length (m); `None` for half-spaces and if
    /// nothing is left.
    fn around(&self, obstacle: &Obstacle, inwards: f64) -> Option<Vec<DVec3>> {
        let (pose, pivot) = (obstacle.pose(self.time()), obstacle.pivot);
        let place = |point: DVec3| pose.apply(pivot, point);
        let (ends, radius) = match obstacle.shape {
            Shape::Floor { .. } | Shape::Plate { .. } => return None,
            Shape::Sphere { centre, radius } => ([centre; 2], radius),
            Shape::Capsule { from, to, radius } => ([from, to], radius),
            Shape::Box { centre, half, rotation } => {
                let half = half - inwards;
                let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
                let corner = |[x, y]: [f64; 2]| place(centre + rotation * DVec3::new(x * half.x, y * half.y, 0.0));
                return (half.x > 0.0 && half.y > 0.0).then(|| corners.map(corner).to_vec());
            }
        };
        (radius > inwards).then(|| self.stadium(ends.map(place), radius, inwards))
    }

    /// The outline of all points near a line, moved inwards by a length (m).
    fn stadium(&self, [from, to]: [DVec3; 2], radius: f64, inwards: f64) -> Vec<DVec3> {
        let needed = PI / (2.0 * FLATNESS / (radius * self.draft.lens.focal).max(1e-3)).sqrt();
        let segments = (needed.clamp(SEGMENTS[0], SEGMENTS[1]) as usize).next_multiple_of(2);
        let along = (to - from).try_normalize().unwrap_or(DVec3::X);
        let across = DVec3::new(-along.y, along.x, 0.0);
        let half = segments / 2;
        let around = |middle: DVec3, begin: usize| {
            (begin..=begin + half).map(move |at| {
                let (sine, cosine) = libm::sincos(TAU * at as f64 / segments as f64);
                middle + (radius - inwards) * (sine * along - cosine * across)
            })
        };
        around(to, 0).chain(around(from, half)).collect()
    }
}
