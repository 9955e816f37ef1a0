//! Obstacles in the plane: discs, capsules and rectangles, flat and behind the body. Plates are drawn like floors.

use super::Site;
use super::half_space::{clipped_polygon, half_space};
use crate::picture::Item;
use crate::picture::layout::steps::{CLOSE, STRONG};
use crate::picture::page::{Path, point};
use crate::picture::pointer::Pointers;
use crate::sim::{Motion, Obstacle, Shape};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The largest distance of a round outline from its polygon (px).
const FLATNESS: f64 = 0.1;
/// The least and the largest number of segments of a round outline.
const SEGMENTS: [f64; 2] = [24.0, 360.0];

/// The data for the obstacles of one panel in the plane.
pub(in crate::picture) struct PlaneObstacles<'a> {
    pub(in crate::picture) site: Site<'a>,
    /// Thickness of lines, relative to the reference picture.
    pub(in crate::picture) line_scale: f64,
}

impl PlaneObstacles<'_> {
    /// The arrows of moving plates, on the solid side.
    pub(in crate::picture) fn arrows(&self, pointers: &Pointers<'_>, marks: &mut Vec<Item>) {
        for obstacle in self.site.obstacles {
            let Shape::Plate { point, .. } = obstacle.shape else { continue };
            let Some((normal, _)) = half_space(obstacle, self.site.time).filter(|_| obstacle.motion != Motion::Still)
            else {
                continue;
            };
            let point = obstacle.pose(self.site.time).apply(point, point);
            let going = self.site.going(obstacle, point, self.site.extent);
            pointers.draw(point, going, going.velocity.dot(normal) > 0.0, CLOSE, marks);
        }
    }

    /// All obstacles but half-spaces, in front of half-spaces, each with a rim; and outlines a pixel around them (m).
    pub(in crate::picture) fn draw(&self) -> (Vec<Item>, Vec<Vec<DVec3>>) {
        let half_spaces = self.site.obstacles.iter().filter_map(|obstacle| half_space(obstacle, self.site.time));
        let half_spaces: Vec<_> = half_spaces.collect();
        let rim = STRONG * self.line_scale / self.site.lens.focal;
        let [colour, rim_colour] = self.site.palette.obstacle_flat;
        let (mut items, mut outlines) = (Vec::new(), Vec::new());
        // The first obstacle lies in front.
        for obstacle in self.site.obstacles.iter().rev() {
            let fill = |outline: &[DVec3], colour| {
                let pixels =
                    clipped_polygon(outline, &half_spaces).into_iter().filter_map(|at| self.site.lens.project(at));
                let path = Path::polygon(&pixels.map(|(pixel, _)| point(pixel.into())).collect::<Vec<_>>());
                (!path.is_empty()).then(|| Item::fill(path, colour))
            };
            let Some(outline) = self.outline(obstacle, 0.0) else { continue };
            let inside = self.outline(obstacle, rim).unwrap_or_default();
            let fills: Vec<_> = [fill(&outline, rim_colour), fill(&inside, colour)].into_iter().flatten().collect();
            items.extend((!fills.is_empty()).then(|| Item::part("obstacle", fills)));
            let around = self.outline(obstacle, -self.site.lens.focal.recip()).unwrap_or_default();
            outlines.push(clipped_polygon(&around, &half_spaces));
        }
        (items, outlines)
    }

    /// The outline of an obstacle, counter-clockwise, moved inwards by a length (m); `None` for half-spaces and if
    /// nothing is left. The number of corners does not depend on the length.
    fn outline(&self, obstacle: &Obstacle, inwards: f64) -> Option<Vec<DVec3>> {
        let (pose, pivot) = (obstacle.pose(self.site.time), obstacle.pivot);
        let place = |point: DVec3| pose.apply(pivot, point);
        match obstacle.shape {
            Shape::Floor { .. } | Shape::Plate { .. } => None,
            Shape::Sphere { centre, radius } => {
                (radius > inwards).then(|| self.round([place(centre); 2], radius, inwards))
            }
            Shape::Capsule { from, to, radius } => {
                (radius > inwards).then(|| self.round([place(from), place(to)], radius, inwards))
            }
            Shape::Box { centre, half, rotation } => {
                let half = half - inwards;
                let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
                let corner = |[x, y]: [f64; 2]| place(centre + rotation * DVec3::new(x * half.x, y * half.y, 0.0));
                (half.x > 0.0 && half.y > 0.0).then(|| corners.map(corner).to_vec())
            }
        }
    }

    /// The outline of all points near a line, moved inwards by a length (m).
    fn round(&self, [from, to]: [DVec3; 2], radius: f64, inwards: f64) -> Vec<DVec3> {
        let needed = PI / (2.0 * FLATNESS / (radius * self.site.lens.focal).max(1e-3)).sqrt();
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
