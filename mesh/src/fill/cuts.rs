//! Where a surface cuts the edges of a lattice.

use super::parts::{Parted, Scene};
use super::{FillError, clip, cubes, lattice};
use crate::inside::{Grid, Inside};
use crate::{Flaws, Surface};
use glam::{DVec2, DVec3, IVec3};
use rayon::prelude::*;

/// A point outside of all elements follows the nearest one if it is at most so many sides away: beyond, it would only show how
/// that element turns.
pub(super) const FAR: f64 = 0.75;

/// The edges of a body-centred lattice: three along the axes between neighbours of one kind, four between a corner and a middle.
/// Each is counted from the end with the lower x, or the lower coordinate along its axis; in halves of the side.
pub(super) const EDGES: [IVec3; 7] = [
    IVec3::new(2, 0, 0),
    IVec3::new(0, 2, 0),
    IVec3::new(0, 0, 2),
    IVec3::new(1, -1, -1),
    IVec3::new(1, -1, 1),
    IVec3::new(1, 1, -1),
    IVec3::new(1, 1, 1),
];

/// The number of edges along the axes, which come first.
pub(super) const AXES: usize = 3;

/// Distances below this, in halves of the side, are round-off: a crossing so near to the end of an edge counts for both edges that
/// end there, and a line so near to the side of a triangle meets it.
const CLOSE: f64 = 1e-9;

/// A place so near to the border of a cube, in halves of the side, belongs to the cube beyond it, too.
const SLACK: f64 = 1e-6;

/// Where edges are cut, as a part of the way from an end that counts as inside because the body is thin there: for edges along the axes
/// and for others. Just so far that the end is not moved to the cut.
pub(super) const WIDE: [f64; 2] = [0.29, 0.40];

/// A lattice of cubes around a surface. Points are counted in halves of the side: corners of cubes have even coordinates, their
/// middles odd ones.
pub(super) struct Lattice {
    origin: DVec3,
    /// The side of the cubes (m).
    pub(super) side: f64,
    /// The number of cubes along each axis. The outermost are outside of the surface.
    pub(super) cubes: IVec3,
    /// Whether there are middles.
    has_middles: bool,
    /// The surface in halves of the side, from the origin.
    surface: Surface,
    inside: Inside,
}

impl Lattice {
    /// The lattice around a surface, whose points nearly on planes of the lattice are moved to them.
    ///
    /// # Errors
    /// If its triangles lie over each other by thousands.
    pub(super) fn around(surface: &mut Surface, side: f64, has_middles: bool, most: usize) -> Result<Self, FillError> {
        let (lattice, mut scaled) = lattice::Lattice::about(surface, side, most)?;
        let counts = DVec3::from_array(lattice.counts.map(|count| count as f64)) + 2.0;
        scaled.points.iter_mut().for_each(|point| *point = 2.0 * (*point + 1.0));
        let inside = Inside::new(&scaled);
        Ok(Self { origin: lattice.origin - side, side, cubes: counts.as_ivec3(), has_middles, surface: scaled, inside })
    }

    /// The ends of the edge of a cut.
    pub(super) fn ends(&self, cuts: &Cuts, cut: usize) -> [usize; 2] {
        let (from, edge) = cuts.edge(cut);
        [from, self.index(self.point(from) + EDGES[edge])]
    }

    /// The place of a cut at a part of the way along its edge, in halves of the side from the origin.
    pub(super) fn along(&self, cuts: &Cuts, cut: usize, part: f64) -> DVec3 {
        let (from, edge) = cuts.edge(cut);
        self.point(from).as_dvec3() + part * EDGES[edge].as_dvec3()
    }

    /// The position (m) of a place in halves of the side from the origin.
    pub(super) fn place(&self, at: DVec3) -> DVec3 {
        self.origin + 0.5 * self.side * at
    }

    /// A place (m) in halves of the side from the origin.
    fn halves(&self, at: DVec3) -> DVec3 {
        (at - self.origin) / (0.5 * self.side)
    }

    /// Whether there is such a point; its coordinates are all odd or all even.
    pub(super) fn holds(&self, point: IVec3) -> bool {
        point.cmpge(IVec3::ZERO).all() && point.cmple(2 * self.cubes).all()
    }

    /// The number of points, with some that are not used.
    pub(super) fn len(&self) -> usize {
        let kinds = if self.has_middles { 2 } else { 1 };
        kinds * self.corners()
    }

    /// The number of edges from each point.
    fn edges(&self) -> usize {
        if self.has_middles { EDGES.len() } else { AXES }
    }

    /// Points of the surface farther than this from all elements, in sides, ask at first for more: cubes have nodes for them.
    pub(super) fn far(&self) -> f64 {
        if self.has_middles { FAR } else { 0.3 }
    }

    /// How often places can be marked to some effect by [`Self::touch`].
    pub(super) fn marks(&self) -> u8 {
        if self.has_middles { 1 } else { 2 }
    }

    fn corners(&self) -> usize {
        let along = (self.cubes + 1).as_usizevec3();
        along.x * along.y * along.z
    }

    /// The place of a point in lists.
    pub(super) fn index(&self, point: IVec3) -> usize {
        let (along, half) = ((self.cubes + 1).as_usizevec3(), (point / 2).as_usizevec3());
        let is_middle = point.x % 2 != 0;
        usize::from(is_middle) * self.corners() + (half.z * along.y + half.y) * along.x + half.x
    }

    /// The point at a place in lists.
    pub(super) fn point(&self, index: usize) -> IVec3 {
        let along = (self.cubes + 1).as_usizevec3();
        let (kind, at) = (index / self.corners(), index % self.corners());
        let half = [at % along.x, at / along.x % along.y, at / along.x / along.y];
        2 * IVec3::from_array(half.map(|half| half as i32)) + kind as i32
    }

    /// Whether a place (m) is inside.
    pub(super) fn contains(&self, at: DVec3) -> bool {
        self.inside.contains(self.halves(at))
    }

    pub(super) fn inside(&self) -> Vec<bool> {
        let counts = (self.cubes + 1).as_usizevec3().to_array();
        let mut inside = self.inside.grid(&Grid { first: DVec3::ZERO, side: 2.0, counts });
        if self.has_middles {
            // With some outside at the high ends, lest middles have indices of their own.
            inside.extend(self.inside.grid(&Grid { first: DVec3::ONE, side: 2.0, counts }));
        }
        inside
    }

    /// The lattice without the cubes outside, and the surface in units of it.
    pub(super) fn in_cubes(&self) -> (lattice::Lattice, Surface) {
        let counts = (self.cubes - 2).as_usizevec3().to_array();
        let lattice = lattice::Lattice { origin: self.origin + self.side, side: self.side, counts };
        let most = (self.cubes - 2).as_dvec3();
        let points = self.surface.points.iter().map(|&point| (0.5 * point - 1.0).clamp(DVec3::ZERO, most)).collect();
        (lattice, Surface { points, triangles: self.surface.triangles.clone(), ..Surface::default() })
    }

    /// The part of each cube that is inside, with x fastest, then y, then z, and the volume that lies in several shells (m³).
    ///
    /// # Errors
    /// If nothing is inside.
    pub(super) fn filled(&self, flaws: &Flaws) -> Result<(Vec<f64>, f64), FillError> {
        let (lattice, scaled) = self.in_cubes();
        let (inside, pieces) = (Inside::new(&scaled), clip::pieces(&scaled, &lattice));
        let scene = Scene::new(&scaled, &lattice, &inside, &pieces);
        let cells = cubes::cells(&scene, flaws)?;
        let mut filled = vec![0.0; self.cubes.as_usizevec3().element_product()];
        for Parted { full, .. } in &cells {
            let cube = IVec3::from_array(lattice.cell(full.cell).map(|at| at as i32 + 1));
            filled[self.cube(cube)] = full.filled;
        }
        Ok((filled, cubes::overlap(&scene, &cells) * self.side * self.side * self.side))
    }

    pub(super) fn is_closed(&self) -> bool {
        self.inside.caps().is_empty()
    }

    /// The place of a cube in lists.
    fn cube(&self, cube: IVec3) -> usize {
        ((cube.z * self.cubes.y + cube.y) * self.cubes.x + cube.x) as usize
    }

    /// The lowest corner of a cube.
    pub(super) fn lowest(&self, cube: i32) -> IVec3 {
        2 * IVec3::new(cube % self.cubes.x, cube / self.cubes.x % self.cubes.y, cube / self.cubes.x / self.cubes.y)
    }

    /// The place in lists of the cube that contains a place (m), or of the nearest.
    pub(super) fn cube_at(&self, at: DVec3) -> usize {
        self.cube((0.5 * self.halves(at)).floor().as_ivec3().clamp(IVec3::ZERO, self.cubes - 1))
    }

    /// The cuts of all edges with one end inside, where the surface crosses them first seen from that end. An edge across a hole of
    /// the surface, which crosses no triangle, is cut in its middle. Edges with an end inside that is wide are cut at
    /// [`WIDE`]. Without middles, edges with both ends outside are cut where the surface crosses them first and last.
    pub(super) fn cuts(&self, is_inside: &[bool], is_wide: impl Fn(usize) -> bool) -> Cuts {
        let edges = self.edges();
        let crossings = |triangle: &[u32; 3]| {
            let corners = self.surface.corners(*triangle);
            let mut found = Vec::new();
            for edge in 0..edges {
                self.crossings(corners, edge, is_inside, &mut found);
            }
            found
        };
        let mut found: Vec<(u64, f64)> = self.surface.triangles.par_iter().flat_map_iter(crossings).collect();
        found.par_sort_unstable_by(|one, other| one.0.cmp(&other.0).then(one.1.total_cmp(&other.1)));
        let mut cuts = Cuts { edges, ..Cuts::default() };
        let mut found = found.into_iter().peekable();
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
                    (Some([first, last]), [false, false]) => {
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

    /// Places (m) all over a triangle of the surface, so close that they miss only the tips of cells.
    pub(super) fn samples(&self, triangle: [u32; 3]) -> impl Iterator<Item = DVec3> {
        let [a, b, c] = self.surface.corners(triangle);
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let steps = (2.0 * longest).ceil().max(1.0) as i32;
        let part = move |at: i32| f64::from(at) / f64::from(steps);
        let all =
            (0..=steps).flat_map(move |i| (0..=steps - i).map(move |j| a + (b - a) * part(i) + (c - a) * part(j)));
        let (origin, half) = (self.origin, 0.5 * self.side);
        all.map(move |at| origin + half * at)
    }

    /// Calls `mark` with the corners of the tetrahedron of the lattice that holds a place (m); without middles, with the lowest corner
    /// of the cube, or of each that has the place on its border.
    pub(super) fn touch(&self, at: DVec3, mut mark: impl FnMut(usize)) {
        let at = self.halves(at);
        if !self.has_middles {
            let [low, high] = [-SLACK, SLACK].map(|slack| (0.5 * (at + slack)).floor().as_ivec3());
            let (low, high) = (low.max(IVec3::ONE), high.min(self.cubes - 2));
            for z in low.z..=high.z {
                for y in low.y..=high.y {
                    (low.x..=high.x).for_each(|x| mark(self.index(2 * IVec3::new(x, y, z))));
                }
            }
            return;
        }
        let low = 2 * (0.5 * at).floor().as_ivec3();
        let mut mark = |corner: IVec3| {
            if self.holds(corner) {
                mark(self.index(corner));
            }
        };
        // The tetrahedron is about the edge to the next middle along the farthest axis, at the side of the second one.
        let middle = low + 1;
        let from = at - middle.as_dvec3();
        let mut axes = [0, 1, 2];
        axes.sort_by(|&one, &other| from[other].abs().total_cmp(&from[one].abs()));
        let [far, second, third] = axes.map(|axis| if from[axis] < 0.0 { -EDGES[axis] } else { EDGES[axis] });
        mark(middle);
        mark(middle + far);
        mark(middle + (far + second + third) / 2);
        mark(middle + (far + second - third) / 2);
    }

    /// What [`Self::touch`] marks for places all over the surface; without middles, all cubes with a part `inside`.
    pub(super) fn touched(&self, surface: &Surface, inside: &[f64]) -> Vec<bool> {
        let mut touched = vec![false; self.len()];
        if self.has_middles {
            let all = surface.triangles.iter().flat_map(|&of| self.samples(of));
            all.for_each(|at| self.touch(at, |point| touched[point] = true));
        } else {
            let numbered = (0..).zip(inside).filter(|(_, inside)| **inside > 0.0);
            numbered.for_each(|(cube, _)| touched[self.index(self.lowest(cube))] = true);
        }
        touched
    }

    /// The neighbours of a point along edges.
    pub(super) fn neighbours(&self, index: usize) -> impl Iterator<Item = usize> + '_ {
        let point = self.point(index);
        let around = EDGES[..self.edges()].iter().flat_map(move |&edge| [point - edge, point + edge]);
        around.filter(|&other| self.holds(other)).map(|other| self.index(other))
    }

    /// Appends the edges of one direction with one end inside that cross a triangle, with the part of the way to the crossing.
    /// Corners are in halves of the side from the origin.
    fn crossings(&self, corners: [DVec3; 3], edge: usize, is_inside: &[bool], found: &mut Vec<(u64, f64)>) {
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
                    let ends = [index, self.index(from + direction)].map(|end| is_inside[end]);
                    if ends[0] != ends[1] || !(ends[0] || self.has_middles) {
                        found.push((slot(index, edge), (steps - f64::from(at)).clamp(0.0, 1.0)));
                    }
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
pub(super) struct Cuts {
    slots: Vec<u64>,
    /// The number of edges from each point of the lattice.
    edges: usize,
    /// The part of the way along the edge, from 0 to 1.
    pub(super) parts: Vec<f64>,
    /// The points of the lattice that are on the surface to round-off, in rising order.
    pub(super) on: Vec<usize>,
}

impl Cuts {
    /// The cut of an edge, by its start; the first one of an edge with both ends outside.
    pub(super) fn find(&self, index: usize, edge: usize) -> Option<usize> {
        self.slots.binary_search(&slot(index, edge)).ok()
    }

    /// The last cut of an edge with both ends outside.
    pub(super) fn last(&self, index: usize, edge: usize) -> Option<usize> {
        self.find(index, self.edges + edge)
    }

    /// The start of the edge of a cut, by its place in lists, and the direction of the edge.
    pub(super) fn edge(&self, cut: usize) -> (usize, usize) {
        let slot = self.slots[cut] as usize;
        (slot / SLOTS, slot % SLOTS % self.edges)
    }
}
