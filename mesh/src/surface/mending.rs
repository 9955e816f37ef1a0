//! Surfaces mended, as far as that is safe.

use super::{Flaws, Surface};
use crate::edges::EdgeUse;
use crate::read::Used;
use crate::weld::joined;
use glam::DVec3;
use localshape_sim::geometry::bounds;

impl Surface {
    /// The surface without its flaws, as far as that is safe, and what they were.
    ///
    /// Points with the same coordinates to 10⁻¹² of the extent become one. Triangles without area and doubled ones are left out; of two with
    /// opposite sides both stay, a wall between two pieces, unless most of the surface is of that kind. Each piece is
    /// turned so that neighbours agree, which the fewest triangles determine, and that its volume is positive. A piece
    /// inside another is turned with that one: if it looked the other way in the file, it is a cavity.
    pub fn mended(&self) -> (Self, Flaws) {
        let mut flaws = Flaws::default();
        let mut surface = self.welded(&mut flaws);
        surface.drop_doubled(&mut flaws);
        surface.drop_flat(&mut flaws);
        surface.orient(&mut flaws);
        // Points of triangles that were left out belong to none.
        (surface.compact(), flaws)
    }

    /// The surface with its points welded, without triangles of fewer than three points.
    fn welded(&self, flaws: &mut Flaws) -> Self {
        /// Programs write zeros as sines of half turns, parts of the extent as small as this.
        const ROUND_OFF: f64 = 1e-12;
        let is_place = |&point: &u32| self.points.get(point as usize).is_some_and(|point| point.is_finite());
        let mut used: Vec<u32> = self.triangles.as_flattened().iter().copied().filter(is_place).collect();
        used.sort_unstable();
        used.dedup();
        let (low, high) = bounds(&used.iter().map(|&point| self.points[point as usize]).collect::<Vec<_>>());
        let first = joined(&self.points, used.clone(), ROUND_OFF * (high - low).max_element());
        for &point in used.iter().filter(|&&point| first[point as usize] != point) {
            flaws.welded += 1;
            flaws.near += usize::from(self.points[first[point as usize] as usize] != self.points[point as usize]);
        }
        let mut triangles = Vec::with_capacity(self.triangles.len());
        for triangle in &self.triangles {
            if triangle.iter().all(is_place) {
                let [a, b, c] = triangle.map(|point| first[point as usize]);
                if a != b && b != c && c != a {
                    triangles.push([a, b, c]);
                }
            }
        }
        flaws.degenerate = self.triangles.len() - triangles.len();
        let groups = self.groups.iter().map(|group| group.renamed(&first)).collect();
        Self { points: self.points.clone(), triangles, groups, notes: self.notes.clone() }.compact()
    }

    /// The surface with those points only that belong to a triangle, in the same order.
    pub(crate) fn compact(mut self) -> Self {
        let used = Used::new(self.points.len(), self.triangles.as_flattened());
        self.triangles.as_flattened_mut().iter_mut().for_each(|corner| *corner = used.new[*corner as usize]);
        Self { points: used.of(&self.points), groups: used.groups(&self.groups), ..self }
    }

    fn drop_doubled(&mut self, flaws: &mut Flaws) {
        // The points in rising order, and whether that is the triangle's direction.
        let key = |triangle: usize| {
            let of = self.triangles[triangle];
            let lowest = (0..3).min_by_key(|&at| of[at]).unwrap_or(0);
            let [a, b, c] = [0, 1, 2].map(|at| of[(lowest + at) % 3]);
            ([a, b.min(c), b.max(c)], b < c)
        };
        let mut order: Vec<usize> = (0..self.triangles.len()).collect();
        order.sort_by_cached_key(|&triangle| (key(triangle), triangle));
        let same = |&a: &usize, &b: &usize| key(a).0 == key(b).0;
        let two_sided = order.chunk_by(same).filter(|same| key(same[0]).1 != key(same[same.len() - 1]).1).count();
        let all = order.chunk_by(same).count();
        let mut keep = vec![false; self.triangles.len()];
        for same in order.chunk_by(same) {
            if 2 * two_sided > all {
                keep[same.iter().copied().min().unwrap_or(0)] = true;
            } else {
                same.chunk_by(|&a, &b| key(a) == key(b)).for_each(|one_sided| keep[one_sided[0]] = true);
            }
        }
        flaws.doubled = self.keep(&keep);
    }

    /// Drops triangles whose corners are on a line and that have an edge of their own: they close nothing.
    fn drop_flat(&mut self, flaws: &mut Flaws) {
        let mut keep = vec![true; self.triangles.len()];
        let is_flat = |triangle: u32| {
            let [a, b, c] = self.corners(self.triangles[triangle as usize]);
            (b - a).cross(c - a) == DVec3::ZERO
        };
        for edge in EdgeUse::all(&self.triangles).chunk_by(EdgeUse::same) {
            if edge.len() == 1 && is_flat(edge[0].triangle) {
                keep[edge[0].triangle as usize] = false;
            }
        }
        flaws.degenerate += self.keep(&keep);
    }

    /// Keeps some triangles, and returns the number of others.
    fn keep(&mut self, keep: &[bool]) -> usize {
        let before = self.triangles.len();
        let mut keep = keep.iter();
        self.triangles.retain(|_| keep.next().is_some_and(|keep| *keep));
        before - self.triangles.len()
    }
}
