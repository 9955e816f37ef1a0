//! Where a surface cuts the edges of a lattice.

mod crossing;

use super::allowed::{Allowed, check};
use super::parts::{Parted, Scene};
use super::{Fill, FillError, Thin, clip, cubes, lattice};
use crate::inside::{Grid, Inside};
use crate::{Flaws, Surface};
pub(super) use crossing::Cuts;
use glam::{DVec3, IVec3};
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

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
    /// Whether places (m) are inside, by the bits of their coordinates: elements that are made again ask for most of them again.
    known: Mutex<HashMap<[u64; 3], bool>>,
    /// Where edges cross the surface.
    crossings: Vec<(u64, f64)>,
}

/// What of the cubes of a lattice is inside.
pub(super) struct Within {
    /// The part of each, with x fastest, then y, then z.
    pub(super) cubes: Vec<f64>,
    /// The volume that lies in several shells (m³).
    pub(super) overlap: f64,
    pub(super) thin: Thin,
}

impl Lattice {
    /// The lattice around a surface, whose points nearly on planes of the lattice are moved to them.
    ///
    /// # Errors
    /// If its triangles lie over each other by thousands, or far more elements than allowed would be needed.
    pub(super) fn around(
        surface: &mut Surface,
        side: f64,
        has_middles: bool,
        allowed: &Allowed,
    ) -> Result<Self, FillError> {
        let fill = if has_middles { Fill::Tetrahedra { side } } else { Fill::Polyhedra { side } };
        check(&surface.measures(), fill, allowed)?;
        let (lattice, mut scaled) = lattice::Lattice::about(surface, side, None, allowed.most)?;
        let counts = DVec3::from_array(lattice.counts.map(|count| count as f64)) + 2.0;
        scaled.points.iter_mut().for_each(|point| *point = 2.0 * (*point + 1.0));
        let inside = Inside::new(&scaled);
        let (origin, cubes) = (lattice.origin - side, counts.as_ivec3());
        let (known, crossings) = Default::default();
        let mut lattice = Self { origin, side, cubes, has_middles, surface: scaled, inside, known, crossings };
        lattice.crossings = lattice.all_crossings();
        Ok(lattice)
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
        let key = at.to_array().map(f64::to_bits);
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let found = known().get(&key).copied();
        found.unwrap_or_else(|| {
            let is_inside = self.inside.contains(self.halves(at));
            known().insert(key, is_inside);
            is_inside
        })
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

    /// What is inside.
    ///
    /// # Errors
    /// If nothing is.
    pub(super) fn filled(&self, flaws: &Flaws) -> Result<Within, FillError> {
        let (lattice, scaled) = self.in_cubes();
        let (inside, pieces) = (Inside::new(&scaled), clip::pieces(&scaled, &lattice));
        let scene = Scene::new(&scaled, &lattice, &inside, &pieces);
        let cells = cubes::cells(&scene, flaws)?;
        let mut filled = vec![0.0; self.cubes.as_usizevec3().element_product()];
        for Parted { full, .. } in &cells {
            let cube = IVec3::from_array(lattice.cell(full.cell).map(|at| at as i32 + 1));
            filled[self.cube(cube)] = full.filled;
        }
        let overlap = cubes::overlap(&scene, &cells) * self.side * self.side * self.side;
        Ok(Within { cubes: filled, overlap, thin: scene.parts(&cells).thin() })
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
}
