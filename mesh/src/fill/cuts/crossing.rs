//! The cuts of edges, and the crossings of triangles with edges from which they follow.

use super::{AXES, CLOSE, EDGES, Lattice, WIDE};
use glam::{DVec2, DVec3, IVec3};
use rayon::prelude::*;

impl Lattice {
    /// The cuts of all edges with one end inside, where the surface crosses them first seen from that end. An edge across a hole of
    /// the surface, which crosses no triangle, is cut in its middle. Edges with an end inside that is wide are cut at
    /// [`WIDE`]. Without middles, edges with both ends outside are cut where the surface crosses them first and last.
    pub(in crate::fill) fn cuts(&self, is_inside: &[bool], is_wide: impl Fn(usize) -> bool) -> Cuts {
        let edges = self.edges();
        let mut cuts = Cuts { edges, ..Cuts::default() };
        let mut found = self.crossings.iter().copied().peekable();
        for index in 0..self.len() {
            let from = self.point(index);
            if !self.holds(from) {
                continue;
            }
            let mut ends = [None; AXES];
            for edge in 0..edges {
                let to = from + EDGES[edge];
                let own = slot(index, edge);
                while found.next_if(|next| next.0 < own).is_some() {}
                let mut range = None;
                while let Some((_, next)) = found.next_if(|next| next.0 == own) {
                    range = Some([range.map_or(next, |[first, _]: [f64; 2]| first), next]);
                }
                if !self.holds(to) {
                    continue;
                }
                let mut part = match (range, [index, self.index(to)].map(|end| is_inside[end])) {
                    (Some([first, last]), [false, false]) if !self.has_middles => {
                        ends[edge] = Some(last);
                        first
                    }
                    (_, [one, other]) if one == other => continue,
                    (range, [is_first, _]) => range.map_or(0.5, |range| range[usize::from(!is_first)]),
                };
                let part_wide = WIDE[usize::from(edge >= AXES)];
                if is_inside[index] && is_wide(index) {
                    part = part_wide;
                } else if !is_inside[index] && is_wide(self.index(to)) {
                    part = 1.0 - part_wide;
                }
                cuts.slots.push(own);
                cuts.parts.push(part);
            }
            for (edge, last) in ends.into_iter().enumerate().filter_map(|(edge, last)| Some((edge, last?))) {
                cuts.slots.push(slot(index, edges + edge));
                cuts.parts.push(last);
            }
            let point = slot(index, EDGES.len());
            while found.next_if(|next| next.0 < point).is_some() {}
            if found.next_if(|next| next.0 == point).is_some() {
                cuts.on.push(index);
            }
        }
        cuts
    }

    /// Where edges, and points, cross triangles, in the order of their numbers: the part of the way to the crossing.
    pub(super) fn all_crossings(&self) -> Vec<(u64, f64)> {
        let of_triangle = |triangle: &[u32; 3]| {
            let corners = self.surface.corners(*triangle);
            let mut found = Vec::new();
            (0..self.edges()).for_each(|edge| self.crossings_along(corners, edge, &mut found));
            found
        };
        let mut found: Vec<(u64, f64)> = self.surface.triangles.par_iter().flat_map_iter(of_triangle).collect();
        found.par_sort_unstable_by(|one, other| one.0.cmp(&other.0).then(one.1.total_cmp(&other.1)));
        found
    }

    /// Appends the edges of one direction that cross a triangle. Corners are in halves of the side from the origin.
    fn crossings_along(&self, corners: [DVec3; 3], edge: usize, found: &mut Vec<(u64, f64)>) {
        // Seen along the edges of this direction, lines are points of a plane with whole coordinates, and `depth` is along them.
        let direction = EDGES[edge];
        let (is_axis, slope) = (edge < AXES, direction.as_dvec3());
        let seen = |at: DVec3| match edge {
            0 => (at.x, DVec2::new(at.y, at.z)),
            1 => (at.y, DVec2::new(at.z, at.x)),
            2 => (at.z, DVec2::new(at.x, at.y)),
            _ => (at.x, DVec2::new(at.y - slope.y * at.x, at.z - slope.z * at.x)),
        };
        let [(depth_a, a), (depth_b, b), (depth_c, c)] = corners.map(seen);
        let area = (b - a).perp_dot(c - a);
        if area == 0.0 {
            return;
        }
        let low = (a.min(b).min(c) - CLOSE).ceil().as_ivec2();
        let high = (a.max(b).max(c) + CLOSE).floor().as_ivec2();
        let [near, far] = [depth_a.min(depth_b).min(depth_c), depth_a.max(depth_b).max(depth_c)];
        let step = if is_axis { 2 } else { 1 };
        for u in low.x..=high.x {
            // Middles are on lines along the axes with odd coordinates, and all other lines have even ones.
            let is_odd = u % 2 != 0;
            if is_odd && !(is_axis && self.has_middles) {
                continue;
            }
            let first = low.y + i32::from((low.y % 2 != 0) != is_odd);
            for v in (first..=high.y).step_by(2) {
                let line = DVec2::new(f64::from(u), f64::from(v));
                let across = |from: DVec2, to: DVec2| {
                    let twice = (to - from).perp_dot(line - from) * area.signum();
                    (twice >= -CLOSE * (to - from).length()).then_some(twice / area.abs())
                };
                let (Some(of_a), Some(of_b), Some(of_c)) = (across(b, c), across(c, a), across(a, b)) else { continue };
                let depth = (of_a * depth_a + of_b * depth_b + of_c * depth_c).clamp(near, far);
                // The first point of the lattice on the line has the depth 0 or 1.
                let start = if is_axis { i32::from(is_odd) } else { 0 };
                let steps = (depth - f64::from(start)) / f64::from(step);
                let [lowest, highest] = [steps - CLOSE, steps + CLOSE].map(|steps| steps.floor() as i32);
                for at in lowest..=highest {
                    let depth = start + step * at;
                    let from = match edge {
                        0 => IVec3::new(depth, u, v),
                        1 => IVec3::new(v, depth, u),
                        2 => IVec3::new(u, v, depth),
                        _ => IVec3::new(depth, u + direction.y * depth, v + direction.z * depth),
                    };
                    if !(self.holds(from) && self.holds(from + direction)) {
                        continue;
                    }
                    let index = self.index(from);
                    if lowest < highest && at == highest {
                        found.push((slot(index, EDGES.len()), 0.0));
                    }
                    found.push((slot(index, edge), (steps - f64::from(at)).clamp(0.0, 1.0)));
                }
            }
        }
    }
}

/// The numbers of the edges that start at each point of the lattice, and one for the point itself.
const SLOTS: usize = EDGES.len() + 1;

/// The number of an edge that starts at a point of the lattice, or, with the number of edges, of the point.
fn slot(index: usize, edge: usize) -> u64 {
    (index * SLOTS + edge) as u64
}

/// Cuts of edges by a surface, in the order of the points of the lattice at which the edges start, then of [`EDGES`].
#[derive(Clone, Debug, Default)]
pub(in crate::fill) struct Cuts {
    slots: Vec<u64>,
    /// The number of edges from each point of the lattice.
    edges: usize,
    /// The part of the way along the edge, from 0 to 1.
    pub(in crate::fill) parts: Vec<f64>,
    /// The points of the lattice that are on the surface to round-off, in rising order.
    pub(in crate::fill) on: Vec<usize>,
}

impl Cuts {
    /// The cut of an edge, by its start; the first one of an edge with both ends outside.
    pub(in crate::fill) fn find(&self, index: usize, edge: usize) -> Option<usize> {
        self.slots.binary_search(&slot(index, edge)).ok()
    }

    /// The last cut of an edge with both ends outside.
    pub(in crate::fill) fn last(&self, index: usize, edge: usize) -> Option<usize> {
        self.find(index, self.edges + edge)
    }

    /// The start of the edge of a cut, by its place in lists, and the direction of the edge.
    pub(in crate::fill) fn edge(&self, cut: usize) -> (usize, usize) {
        let slot = self.slots[cut] as usize;
        (slot / SLOTS, slot % SLOTS % self.edges)
    }
}
