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

    /// Lists the points that may touch the plane in a step, in order.
    fn list(&self, near: &mut Near, surface: &Surface, [start, end]: [&[DVec3]; 2], plane: Plane) {
        /// A share of the thickness, and of the way of a step.
        const SKIN: [f64; 2] = [20.0, 16.0];
        let (Self { law, obstacle, .. }, Near { points, heights, skin, .. }) = (self, near);
        let height = |position: &[DVec3], node: u32| plane.above(position[node as usize]);
        let nodes = &surface.nodes;
        let far = |way: f64, now: f64, other: f64| way.max((now - other).abs());
        let ahead = nodes.iter().fold(0.0, |way, &node| far(way, height(start, node), height(end, node)));
        let since = nodes.iter().zip(&*heights).fold(0.0, |way, (&node, &then)| far(way, height(start, node), then));
        if obstacle.is_still() && !heights.is_empty() && surface.lever * (since + ahead) <= *skin {
            return;
        }
        *skin = (SKIN[0] * surface.thickness).max(SKIN[1] * surface.lever * ahead);
        let reach = if obstacle.is_still() { law.gap + *skin } else { f64::INFINITY };
        let is_near = |&point: &u32| plane.above(surface.points.place(point as usize, start)) <= reach;
        points.clear();
        points.extend((0..surface.points.len() as u32).filter(is_near));
        heights.clear();
        heights.extend(nodes.iter().map(|&node| height(start, node)));
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
        let plane = self.plane(interval.begin);
        let [from, to] = [interval.begin, interval.end].map(|time| self.obstacle.pose(time));
        self.list(near, surface, [start, end], plane);
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
