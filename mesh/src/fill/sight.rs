//! What sees what in a cell: which patches of the surface bound the same part of the inside.

use super::facet::Facet;
use super::union::Tangle;
use crate::edges::Sets;
use glam::DVec3;

/// What sees what in a cell.
pub(super) struct Sight<'f> {
    facets: &'f [Facet],
    patch_of: &'f [u32],
    low: DVec3,
    /// The shells that cross or lie in each other.
    tangle: Option<&'f Tangle>,
    /// Whether each facet bounds the inside, at least in part; and the facets that do.
    is_seen: Vec<bool>,
    seen: Vec<usize>,
}

/// The parts of the inside that patches bound.
pub(super) struct Seen {
    /// The part of each facet.
    pub(super) part_of: Vec<u32>,
    pub(super) count: usize,
    /// The part at the middle of each face, if one is there: low and high along x, y and z.
    pub(super) faces: [Option<u32>; 6],
}

/// Hits nearer than this are where a line begins, in sides of the cell.
const NEAR: f64 = 1e-9;
/// Places of points along each side of a cell that look for patches. Those beside faces stand for them. The second one is not in the
/// middle, where points of symmetric surfaces are: round-off lets a line through a point pass between its triangles.
const LOOKOUTS: [f64; 3] = [1e-3, 0.4871, 1.0 - 1e-3];
/// Those beside the middles of faces: low and high along x, y and z.
const FACES: [usize; 6] = [12, 14, 10, 16, 4, 22];
/// From so many pieces of a patch it is looked inwards.
const LOOKS: usize = 8;

impl<'f> Sight<'f> {
    pub(super) fn new(facets: &'f [Facet], patch_of: &'f [u32], low: DVec3, tangle: Option<&'f Tangle>) -> Self {
        let mut is_seen = vec![tangle.is_none(); facets.len()];
        for fragment in tangle.iter().flat_map(|tangle| &tangle.fragments) {
            is_seen[fragment.facet] |= fragment.bounding != 0.0;
        }
        let seen = (0..facets.len()).filter(|&at| is_seen[at]).collect();
        Self { facets, patch_of, low, tangle, is_seen, seen }
    }

    /// About how often a line is tried with a facet to find the parts that so many patches bound.
    pub(super) fn effort(facets: usize, patches: usize) -> f64 {
        let (facets, patches) = (facets as f64, patches as f64);
        facets * (LOOKS as f64 * patches + 27.0 * patches + 0.5 * patches * patches)
    }

    /// The nearest facet along a line, up to its end, apart from one.
    fn first(&self, from: DVec3, along: DVec3, apart: usize) -> Option<usize> {
        let near = NEAR / along.length();
        let hits = self.seen.iter().copied().filter(|&at| at != apart);
        let hits = hits.filter_map(|at| self.facets[at].hit(from, along).map(|hit| (hit, at)));
        let hits = hits.filter(|&(hit, _)| hit > near && hit < 1.0 + near);
        hits.reduce(|best, other| if other.0 < best.0 { other } else { best }).map(|(_, at)| at)
    }

    /// The end of a line from a point of the cell to where it leaves the cell.
    fn to_side(&self, from: DVec3, along: DVec3) -> DVec3 {
        let mut reach = f64::INFINITY;
        for axis in 0..3 {
            let ahead = if along[axis] > 0.0 { self.low[axis] + 1.0 - from[axis] } else { self.low[axis] - from[axis] };
            if along[axis] != 0.0 {
                reach = reach.min(ahead / along[axis]);
            }
        }
        along * reach.max(0.0)
    }

    /// The parts that so many patches bound.
    pub(super) fn parts(&self, patches: usize) -> Seen {
        let is_seen = |&at: &usize| self.is_seen[at];
        // The largest piece of each patch, or of those that are seen.
        let mut largest = vec![None::<usize>; patches];
        let mut sizes = vec![0usize; patches];
        for (at, (facet, &patch)) in self.facets.iter().zip(self.patch_of).enumerate() {
            sizes[patch as usize] += 1;
            let best = &mut largest[patch as usize];
            if best.is_none_or(|best| (is_seen(&at), facet.area) > (is_seen(&best), self.facets[best].area)) {
                *best = Some(at);
            }
        }
        let (targets, hidden): (Vec<usize>, Vec<usize>) = largest.iter().flatten().copied().partition(is_seen);
        // Lookouts, at last those on patches that are not seen, which are inside.
        let places = (0..27).map(|at| self.low + DVec3::new(LOOKOUTS[at % 3], LOOKOUTS[at / 3 % 3], LOOKOUTS[at / 9]));
        let lookouts: Vec<DVec3> = places.chain(hidden.iter().map(|&at| self.facets[at].middle)).collect();
        // Patches, then lookouts.
        let mut sets = Sets::new(patches + lookouts.len());
        for &[one, other] in self.tangle.iter().flat_map(|tangle| &tangle.joined) {
            sets.join(self.patch_of[one], self.patch_of[other]);
        }
        for (&at, place) in hidden.iter().zip(patches as u32 + 27..) {
            sets.join(self.patch_of[at], place);
        }
        let mut seen = vec![0usize; patches];
        for (at, (facet, &patch)) in self.facets.iter().zip(self.patch_of).enumerate() {
            let number = &mut seen[patch as usize];
            let stride = sizes[patch as usize].div_ceil(LOOKS);
            *number += 1;
            if !is_seen(&at) || (!(*number - 1).is_multiple_of(stride) && largest[patch as usize] != Some(at)) {
                continue;
            }
            let along = self.to_side(facet.middle, -facet.normal);
            if along.length_squared() > 0.0
                && let Some(hit) = self.first(facet.middle, along, at)
            {
                sets.join(patch, self.patch_of[hit]);
            }
        }
        let mut is_inside = vec![false; lookouts.len()];
        let mut start = 0;
        // Patches that are not seen, and see others, are looked from only where there may be several parts.
        for end in [27, lookouts.len()] {
            for (place, &from) in lookouts.iter().enumerate().take(end).skip(start) {
                let sights: Vec<usize> = targets
                    .iter()
                    .filter_map(|&target| self.first(from, self.facets[target].middle - from, usize::MAX))
                    .collect();
                // A facet seen from behind is seen through the inside.
                is_inside[place] = place >= 27
                    || sights.iter().any(|&hit| self.facets[hit].normal.dot(self.facets[hit].corners[0] - from) > 0.0);
                if is_inside[place] {
                    sights.iter().for_each(|&hit| sets.join((patches + place) as u32, self.patch_of[hit]));
                }
            }
            for one in start..end {
                for other in 0..one {
                    let both = is_inside[one] && is_inside[other];
                    let [a, b] = [one, other].map(|place| (patches + place) as u32);
                    if both && sets.of(a) != sets.of(b) {
                        let along = lookouts[other] - lookouts[one];
                        if self.first(lookouts[one], along, usize::MAX).is_none() {
                            sets.join(a, b);
                        }
                    }
                }
            }
            let mut parts = targets.iter().map(|&target| sets.of(self.patch_of[target]));
            let first = parts.next();
            if parts.all(|part| Some(part) == first) {
                return Seen { part_of: vec![0; self.facets.len()], count: 1, faces: [Some(0); 6] };
            }
            start = end;
        }
        // A patch from which nothing is seen is in the midst of a part.
        for &at in &hidden {
            let own = sets.of(self.patch_of[at]);
            if !targets.iter().any(|&target| sets.of(self.patch_of[target]) == own) {
                sets.join(own, self.patch_of[*targets.first().unwrap_or(&hidden[0])]);
            }
        }
        let (part_of, _) = sets.numbered();
        // Each part has a patch, whose number is lower than that of a lookout: parts are counted by patches.
        let count = part_of[..patches].iter().max().map_or(1, |most| *most as usize + 1);
        let faces = FACES.map(|place| is_inside[place].then(|| part_of[patches + place]));
        Seen { part_of: self.patch_of.iter().map(|&patch| part_of[patch as usize]).collect(), count, faces }
    }
}
