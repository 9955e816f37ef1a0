//! Bodies that carry a surface meet half-spaces with its points, by the rule of surfaces.
//!
//! A half-space is a facet without sides. The foot of a point on its plane is a point that is held.

use super::Obstacle;
use super::end::Motion;
use super::rule::{Law, Term, Touch};
use super::surface::Surface;
use super::touches::Touches;
use crate::body::Body;
use crate::motion::Interval;
use glam::DVec3;
use std::sync::Arc;

/// A body and a half-space.
#[derive(Clone, Debug)]
pub(super) struct Ground {
    /// The number of the body.
    pub(super) body: usize,
    /// The number of the obstacle.
    pub(super) number: usize,
    obstacle: Obstacle,
    pub(super) law: Law,
}

/// Points that were near a plane, with the heights of all nodes of the surface then (m); without heights nothing
/// is known. It only saves work.
#[derive(Clone, Debug, Default)]
pub(super) struct Near {
    points: Vec<u32>,
    heights: Vec<f64>,
    /// How far points may move towards the plane (m) until others may touch it.
    skin: f64,
    /// What touches in this step.
    pub(super) touches: Touches,
}

/// A plane: all points with `normal · x = height`.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    normal: DVec3,
    height: f64,
}

impl Plane {
    pub(super) fn above(self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.height
    }
}

impl Ground {
    /// The half-spaces that bodies with a carried surface meet.
    pub(super) fn all(bodies: &[Arc<Body>], surfaces: &[Surface], obstacles: &[Obstacle]) -> Vec<Self> {
        let carried = bodies.iter().zip(surfaces).enumerate().filter(|(_, (body, _))| body.meets_by_surface());
        let all = carried.flat_map(|(body, (_, surface))| {
            obstacles.iter().enumerate().filter_map(move |(number, obstacle)| {
                obstacle.half_space(0.0)?;
                let &Obstacle { restitution, friction, .. } = obstacle;
                let law = Law { gap: surface.thickness, restitution, friction };
                Some(Self { body, number, obstacle: obstacle.clone(), law })
            })
        });
        all.collect()
    }

    pub(super) fn plane(&self, time: f64) -> Plane {
        let (normal, height) = self.obstacle.half_space(time).unwrap_or((DVec3::Y, f64::NEG_INFINITY));
        Plane { normal, height }
    }

    /// The way (m) for which the body surely touches nothing; `None` if that is not known, as beside planes that move.
    pub(super) fn clear(&self, surfaces: &[Surface], position: &[DVec3]) -> Option<f64> {
        let surface = &surfaces[self.body];
        if !self.obstacle.is_still() || surface.lever > 1.0 {
            return None;
        }
        let plane = self.plane(0.0);
        let heights = surface.nodes.iter().map(|&node| plane.above(position[node as usize]));
        Some(heights.fold(f64::INFINITY, f64::min) - self.law.gap)
    }

    /// Lists the points that may touch the plane in a step, in order: a plane at its start, and at its end.
    ///
    /// The height of a point is a mean of those of its nodes, above a plane that moves, too. So no point moves farther, by itself or towards
    /// the plane, than the `lever` times the farthest node. A plane that turns in the step may touch all points.
    fn list(&self, near: &mut Near, surface: &Surface, [start, end]: [&[DVec3]; 2], planes: [Plane; 2]) {
        /// A share of the thickness, and of the ways of a step.
        const SKIN: [f64; 2] = [20.0, 8.0];
        let Near { points, heights, skin, .. } = near;
        let [plane, later] = planes;
        let turns = plane.normal != later.normal;
        let ways = surface.nodes.iter().map(|&node| {
            let (here, there) = (start[node as usize], end[node as usize]);
            (plane.above(here) - later.above(there)).abs() + plane.normal.dot(there - here).abs()
        });
        let ahead = ways.fold(0.0, f64::max);
        let height = |&node: &u32| plane.above(start[node as usize]);
        let since = surface.nodes.iter().map(height).zip(&*heights).map(|(now, then)| (now - then).abs());
        let since = since.fold(0.0, f64::max);
        if !turns && !heights.is_empty() && surface.lever * (since + ahead) <= *skin {
            return;
        }
        *skin = (SKIN[0] * surface.thickness).max(SKIN[1] * surface.lever * ahead);
        let reach = if turns { f64::INFINITY } else { self.law.gap + *skin };
        let is_near = |&point: &u32| plane.above(surface.points.place(point as usize, start)) <= reach;
        points.clear();
        points.extend((0..surface.points.len() as u32).filter(is_near));
        heights.clear();
        if !turns {
            heights.extend(surface.nodes.iter().map(height));
        }
    }

    /// Finds the points that come nearer to the plane than the distance that is kept. Their feet are added to `feet`, with their motions.
    pub(super) fn look(
        &self,
        near: &mut Near,
        surface: &Surface,
        [start, end]: [&[DVec3]; 2],
        interval: Interval,
        feet: &mut Vec<(DVec3, Motion)>,
    ) {
        let planes @ [plane, _] = [interval.begin, interval.end].map(|time| self.plane(time));
        let [from, to] = [interval.begin, interval.end].map(|time| self.obstacle.pose(time));
        self.list(near, surface, [start, end], planes);
        near.touches.clear();
        let Touches { all, terms } = &mut near.touches;
        for &point in &near.points {
            let (nodes, weights) = surface.points.of(point as usize);
            let here = surface.points.place(point as usize, start);
            let distance = plane.above(here);
            let foot = here - plane.normal * distance;
            let moved = to.apply(self.obstacle.pivot, from.undo(self.obstacle.pivot, foot));
            let there = surface.points.place(point as usize, end);
            // Impulses at other points may press it down.
            let reserve = plane.normal.dot(there - here).abs();
            if plane.normal.dot(there - moved) >= self.law.gap + reserve {
                continue;
            }
            let first = terms.len() as u32;
            let own = nodes.iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
            terms.extend(own.map(|(&node, &weight)| Term { node, weight }));
            terms.push(Term { node: (end.len() + feet.len()) as u32, weight: -1.0 });
            feet.push((moved, Motion::held((moved - foot) / interval.step)));
            let terms = [first, terms.len() as u32];
            all.push(Touch { at: here, normal: plane.normal, distance, keeps_law: true, drag: DVec3::ZERO, terms });
        }
    }
}
