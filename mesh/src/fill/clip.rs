//! Triangles cut at the planes of a lattice, in units of the lattice.

use super::lattice::{Cell, Lattice};
use super::range;
use crate::Surface;
use glam::DVec3;
use rayon::prelude::*;

/// A convex polygon: a triangle cut by at most six planes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polygon {
    corners: [DVec3; 9],
    count: usize,
}

impl Polygon {
    pub(super) fn new(corners: [DVec3; 3]) -> Self {
        let mut all = [DVec3::ZERO; 9];
        all[..3].copy_from_slice(&corners);
        Self { corners: all, count: 3 }
    }

    pub(super) fn corners(&self) -> &[DVec3] {
        &self.corners[..self.count]
    }

    /// The part on one side of a plane: where `sign · coordinate ≥ sign · at`.
    fn cut(&self, axis: usize, at: f64, sign: f64) -> Self {
        let mut cut = Self { corners: [DVec3::ZERO; 9], count: 0 };
        let mut push = |corner: DVec3| {
            if cut.count < 9 {
                cut.corners[cut.count] = corner;
                cut.count += 1;
            }
        };
        for (place, &from) in self.corners().iter().enumerate() {
            let to = self.corners[(place + 1) % self.count];
            let [below, above] = [from, to].map(|corner| sign * (corner[axis] - at));
            if below >= 0.0 {
                push(from);
            }
            if below * above < 0.0 {
                // Cut from the lower end, so that both neighbours of an edge get the same point.
                let (low, high) = if from[axis] < to[axis] { (from, to) } else { (to, from) };
                let mut corner = low + (high - low) * ((at - low[axis]) / (high[axis] - low[axis]));
                corner[axis] = at;
                push(corner);
            }
        }
        cut
    }

    /// The part in a cell with this lowest corner.
    pub(super) fn within(&self, low: DVec3) -> Self {
        (0..3).fold(*self, |part, axis| part.cut(axis, low[axis], 1.0).cut(axis, low[axis] + 1.0, -1.0))
    }

    /// The normal with twice the polygon's area as its length.
    pub(super) fn area(&self) -> DVec3 {
        let origin = self.corners[0];
        fan(self.corners()).map(|[b, c]| (b - origin).cross(c - origin)).sum()
    }

    /// The parts between neighbouring planes across an axis, with the numbers of the cells between them. What lies in a
    /// plane belongs to the cell behind it.
    fn slabs(&self, axis: usize, normal: DVec3, lattice: &Lattice, mut visit: impl FnMut(u32, Self)) {
        if self.count < 3 {
            return;
        }
        let (low, high) = range(self.corners().iter().map(|corner| corner[axis]));
        if low == high && low.fract() == 0.0 {
            let cell = if normal[axis] > 0.0 { low - 1.0 } else { low };
            return visit(cell.clamp(0.0, lattice.counts[axis] as f64 - 1.0) as u32, *self);
        }
        let (first, last) = (low.floor() as u32, (high.ceil() as u32).max(1) - 1);
        let mut rest = *self;
        for cell in first..last {
            let plane = f64::from(cell) + 1.0;
            visit(cell, rest.cut(axis, plane, -1.0));
            rest = rest.cut(axis, plane, 1.0);
        }
        visit(last, rest);
    }
}

/// The corners of a polygon after the first one, in pairs that make triangles with it.
fn fan(corners: &[DVec3]) -> impl Iterator<Item = [DVec3; 2]> + '_ {
    corners.windows(2).skip(1).map(|pair| [pair[0], pair[1]])
}

/// The volume between a polygon and a plane across x, positive where the inside is there, and its area seen along x with the same
/// sign.
fn under(corners: &[DVec3], plane: f64) -> [f64; 2] {
    let base = DVec3::new(plane, 0.0, 0.0);
    let origin = corners[0] - base;
    let (mut volume, mut shadow) = (0.0, 0.0);
    for [b, c] in fan(corners) {
        let [b, c] = [b - base, c - base];
        let area = 0.5 * (b - origin).cross(c - origin).x;
        shadow += area;
        volume += area * (origin.x + b.x + c.x) / 3.0;
    }
    [volume, shadow]
}

/// The volume inside a cell with this lowest corner that a polygon adds as one of those that bound it, but for whole cells: only the
/// part that contains the highest corner of the cell has one more.
///
/// By the divergence theorem for the field x, that is the volume under the polygon and the inside of the upper face across x. The area
/// of the latter follows from its outline in the same way: from the sides of polygons in that face, and from where they end at its
/// upper edge along z.
pub(super) fn volume(corners: &[DVec3], low: DVec3) -> f64 {
    if corners.is_empty() {
        return 0.0;
    }
    let [mut volume, _] = under(corners, low.x);
    let high = low + 1.0;
    for (at, from) in corners.iter().enumerate() {
        let to = corners[(at + 1) % corners.len()];
        let is_at_edge = [from.y == high.y, to.y == high.y];
        if from.x == high.x && to.x == high.x && is_at_edge != [true, true] {
            volume -= (0.5 * (from.y + to.y) - low.y) * (to.z - from.z);
            volume += if is_at_edge[1] { to.z - low.z } else { 0.0 };
            volume -= if is_at_edge[0] { from.z - low.z } else { 0.0 };
        }
    }
    volume
}

/// The part of a triangle in a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) cell: u64,
    pub(super) triangle: u32,
    /// The volume between the piece and the lower face of the cell across x, positive where the inside is there.
    pub(super) volume: f64,
    /// The area of the piece seen along x, with the same sign.
    pub(super) shadow: f64,
}

/// Calls `visit` with each cell that a triangle reaches into and the part of the triangle in it, if it has an area.
pub(super) fn cut(corners: [DVec3; 3], lattice: &Lattice, mut visit: impl FnMut(Cell, &Polygon)) {
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    Polygon::new(corners).slabs(2, normal, lattice, |z, slab| {
        slab.slabs(1, normal, lattice, |y, row| {
            row.slabs(0, normal, lattice, |x, piece| {
                if piece.count > 2 && piece.area() != DVec3::ZERO {
                    visit([x, y, z], &piece);
                }
            });
        });
    });
}

fn pieces_of(triangle: u32, corners: [DVec3; 3], lattice: &Lattice) -> Vec<Piece> {
    let mut pieces = Vec::new();
    cut(corners, lattice, |cell, polygon| {
        let [volume, shadow] = under(polygon.corners(), f64::from(cell[0]));
        pieces.push(Piece { cell: lattice.key(cell), triangle, volume, shadow });
    });
    pieces
}

/// The parts of all triangles, by cell and then by triangle.
pub(super) fn pieces(surface: &Surface, lattice: &Lattice) -> Vec<Piece> {
    let mut pieces: Vec<_> = surface
        .triangles
        .par_chunks(1024)
        .enumerate()
        .flat_map_iter(|(chunk, triangles)| {
            let numbered = (1024 * chunk as u32..).zip(triangles);
            numbered.flat_map(|(triangle, &of)| pieces_of(triangle, surface.corners(of), lattice))
        })
        .collect();
    pieces.par_sort_unstable_by_key(|piece| (piece.cell, piece.triangle));
    pieces
}
