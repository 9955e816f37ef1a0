//! Large triangles divided.

use super::Surface;
use crate::edges::EdgeUse;

impl Surface {
    /// Divides triangles until no edge is longer, unless there would be many times more than `most`.
    pub(crate) fn refine(&mut self, longest: f64, most: usize) {
        let parts = |&of: &[u32; 3]| {
            let [a, b, c] = self.corners(of);
            let area = (b - a).cross(c - a).length();
            1.0 + (4.0 * area / longest + a.distance(b) + b.distance(c) + c.distance(a)) / longest
        };
        let needed: f64 = self.triangles.iter().map(parts).sum();
        // Not true for a length of zero or one that is no number, either.
        let fits = needed <= 16.0 * most as f64 + 8.0 * self.triangles.len() as f64;
        while fits && self.halve(longest) {}
    }

    /// Divides longer edges in halves, and returns whether there were some.
    fn halve(&mut self, longest: f64) -> bool {
        let is_long = |&at: &usize| {
            let [a, b, c] = self.corners(self.triangles[at]);
            [a.distance(b), b.distance(c), c.distance(a)].into_iter().any(|length| length > longest)
        };
        // Triangles that share a longer edge all have one, and mostly few are left after the first times.
        let long: Vec<usize> = (0..self.triangles.len()).filter(is_long).collect();
        let of_long: Vec<[u32; 3]> = long.iter().map(|&at| self.triangles[at]).collect();
        if long.is_empty() {
            return false;
        }
        let mut middles = vec![[None; 3]; self.triangles.len()];
        // The groups of each point, to which the middle between two of their points belongs, too.
        let mut groups_of = vec![Vec::new(); self.points.len()];
        for (group, at) in self.groups.iter().zip(0u32..) {
            group.points.iter().for_each(|&point| groups_of[point as usize].push(at));
        }
        for edge in EdgeUse::all(&of_long).chunk_by(EdgeUse::same) {
            let [low, high] = [edge[0].low, edge[0].high].map(|point| self.points[point as usize]);
            let middle = low.midpoint(high);
            // An edge as short as round-off has no middle.
            if low.distance(high) > longest && middle != low && middle != high {
                for one in edge {
                    let from = if one.forward { one.low } else { one.high };
                    let place = of_long[one.triangle as usize].iter().position(|&corner| corner == from);
                    middles[long[one.triangle as usize]][place.unwrap_or(0)] = Some(self.points.len() as u32);
                }
                // Of two rising lists, the shorter one is gone through: a point in the middle of a fan may have very many groups.
                let [mut fewer, mut more] = [edge[0].low, edge[0].high].map(|point| &groups_of[point as usize]);
                if fewer.len() > more.len() {
                    std::mem::swap(&mut fewer, &mut more);
                }
                for &group in fewer.iter().filter(|group| more.binary_search(group).is_ok()) {
                    self.groups[group as usize].points.push(self.points.len() as u32);
                }
                self.points.push(middle);
            }
        }
        let mut triangles = Vec::with_capacity(2 * self.triangles.len());
        for (&[a, b, c], middles) in self.triangles.iter().zip(&middles) {
            match *middles {
                [None, None, None] => triangles.push([a, b, c]),
                [Some(ab), Some(bc), Some(ca)] => {
                    triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
                }
                [Some(ab), None, None] => triangles.extend([[a, ab, c], [ab, b, c]]),
                [None, Some(bc), None] => triangles.extend([[b, bc, a], [bc, c, a]]),
                [None, None, Some(ca)] => triangles.extend([[c, ca, b], [ca, a, b]]),
                [Some(ab), Some(bc), None] => self.cut_off([a, b, c], [ab, bc], &mut triangles),
                [None, Some(bc), Some(ca)] => self.cut_off([b, c, a], [bc, ca], &mut triangles),
                [Some(ab), None, Some(ca)] => self.cut_off([c, a, b], [ca, ab], &mut triangles),
            }
        }
        let divided = triangles.len() > self.triangles.len();
        self.triangles = triangles;
        divided
    }

    /// The parts of a triangle whose first two edges have middles. The rest beyond them is divided by its shorter diagonal.
    fn cut_off(&self, [a, b, c]: [u32; 3], [ab, bc]: [u32; 2], parts: &mut Vec<[u32; 3]>) {
        let length = |from: u32, to: u32| self.points[from as usize].distance_squared(self.points[to as usize]);
        parts.push([ab, b, bc]);
        if length(a, bc) <= length(ab, c) {
            parts.extend([[a, ab, bc], [a, bc, c]]);
        } else {
            parts.extend([[a, ab, c], [ab, bc, c]]);
        }
    }
}
