//! What sees what in a cell: which patches of the surface bound the same part of the inside.

use super::facet::Facet;
use super::union::Tangle;
use crate::edges::Sets;
use glam::DVec3;
use std::ops::Range;

/// The parts of the inside in one cell.
#[derive(Clone, Debug)]
pub(super) struct Local {
    /// The part that each piece of the surface bounds.
    pub(super) part_of: Vec<u32>,
    /// The volume of each part, in cells.
    pub(super) volumes: Vec<f64>,
    /// The part at the middle of each face, if one is there: low and high along x, y and z. Of a single part it is not tried.
    pub(super) faces: [Option<u32>; 6],
    /// Whether the surface is open in the cell, so that it has one part.
    pub(super) open: bool,
}

impl Local {
    pub(super) fn whole(pieces: usize, volume: f64, open: bool) -> Self {
        Self { part_of: vec![0; pieces], volumes: vec![volume], faces: [Some(0); 6], open }
    }
}

/// What sees what in a cell, and what is known so far of the parts that patches bound.
pub(super) struct Sight<'f> {
    facets: &'f [Facet],
    /// The patch of each facet, and how many patches there are.
    patch_of: &'f [u32],
    patches: usize,
    low: DVec3,
    /// Whether each facet bounds the inside, at least in part.
    is_seen: Vec<bool>,
    /// The largest piece of each patch, or of its pieces that are seen: of patches that are seen, and of others.
    targets: Vec<usize>,
    hidden: Vec<usize>,
    /// Lookouts, at last those on patches that are not seen, which are inside.
    lookouts: Vec<DVec3>,
    is_inside: Vec<bool>,
    /// What bounds or sees one part: patches, then lookouts.
    sets: Sets,
}

/// Hits nearer than this are where a line begins, in sides of the cell.
const NEAR: f64 = 1e-9;
/// Places of points along each side of a cell that look for patches. Those beside faces stand for them. The second one is not in the
/// middle, where points of symmetric surfaces are: round-off lets a line through a point pass between its triangles.
const LOOKOUTS: [f64; 3] = [1e-3, 0.4871, 1.0 - 1e-3];
const PLACES: usize = LOOKOUTS.len().pow(3);
/// Those beside the middles of faces: low and high along x, y and z.
const FACES: [usize; 6] = [12, 14, 10, 16, 4, 22];
/// From so many pieces of a patch it is looked inwards.
const LOOKS: usize = 8;

impl<'f> Sight<'f> {
    /// The facets of so many patches in the cell with this lowest corner, and those of them that cross or lie in each other.
    pub(super) fn new(
        facets: &'f [Facet],
        (patch_of, patches): (&'f [u32], usize),
        low: DVec3,
        tangle: Option<&Tangle>,
    ) -> Self {
        let mut is_seen = vec![tangle.is_none(); facets.len()];
        for fragment in tangle.iter().flat_map(|tangle| &tangle.fragments) {
            is_seen[fragment.facet] |= fragment.bounding != 0.0;
        }
        let mut largest = vec![None::<usize>; patches];
        let rank = |at: usize| (is_seen[at], facets[at].area);
        for (at, &patch) in patch_of.iter().enumerate() {
            let best = &mut largest[patch as usize];
            if best.is_none_or(|best| rank(at) > rank(best)) {
                *best = Some(at);
            }
        }
        let (targets, hidden): (Vec<_>, Vec<_>) = largest.into_iter().flatten().partition(|&at| is_seen[at]);
        let places = (0..PLACES).map(|at| DVec3::new(LOOKOUTS[at % 3], LOOKOUTS[at / 3 % 3], LOOKOUTS[at / 9]));
        let places = places.map(|place| low + place);
        let lookouts: Vec<DVec3> = places.chain(hidden.iter().map(|&at| facets[at].middle)).collect();
        let mut sets = Sets::new(patches + lookouts.len());
        for &[one, other] in tangle.iter().flat_map(|tangle| &tangle.joined) {
            sets.join(patch_of[one], patch_of[other]);
        }
        for (&at, place) in hidden.iter().zip((patches + PLACES) as u32..) {
            sets.join(patch_of[at], place);
        }
        let is_inside = vec![false; lookouts.len()];
        Self { facets, patch_of, patches, low, is_seen, targets, hidden, lookouts, is_inside, sets }
    }

    /// About how often a line is tried with a facet to find the parts that so many patches bound.
    pub(super) fn effort(facets: usize, patches: usize) -> f64 {
        let (facets, patches) = (facets as f64, patches as f64);
        facets * (LOOKS as f64 * patches + PLACES as f64 * patches + 0.5 * patches * patches)
    }

    /// The nearest facet along a line, up to its end, apart from one.
    fn first(&self, from: DVec3, along: DVec3, apart: usize) -> Option<usize> {
        let near = NEAR / along.length();
        let hits = (0..self.facets.len()).filter(|&at| self.is_seen[at] && at != apart);
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

    /// The parts that the patches bound, without their volumes.
    pub(super) fn parts(mut self) -> Local {
        self.look_inwards();
        // Patches that are not seen, and see others, are looked from only where there may be several parts.
        for places in [0..PLACES, PLACES..self.lookouts.len()] {
            self.look_around(places.clone());
            self.join_lookouts(places);
            if self.is_one() {
                return Local::whole(self.facets.len(), 0.0, false);
            }
        }
        self.join_hidden();
        self.seen()
    }

    /// Joins patches with those that some of their pieces see inwards.
    fn look_inwards(&mut self) {
        let (facets, patch_of) = (self.facets, self.patch_of);
        let mut sizes = vec![0usize; self.patches];
        patch_of.iter().for_each(|&patch| sizes[patch as usize] += 1);
        let mut numbers = vec![0usize; self.patches];
        for (at, (facet, &patch)) in facets.iter().zip(patch_of).enumerate() {
            let number = numbers[patch as usize];
            numbers[patch as usize] += 1;
            let is_chosen =
                || number.is_multiple_of(sizes[patch as usize].div_ceil(LOOKS)) || self.targets.contains(&at);
            if !self.is_seen[at] || !is_chosen() {
                continue;
            }
            let along = self.to_side(facet.middle, -facet.normal);
            if along.length_squared() > 0.0
                && let Some(hit) = self.first(facet.middle, along, at)
            {
                self.sets.join(patch, patch_of[hit]);
            }
        }
    }

    /// Tells which of some lookouts are inside, and joins these with the patches that they see.
    fn look_around(&mut self, places: Range<usize>) {
        let (facets, patch_of) = (self.facets, self.patch_of);
        for place in places {
            let from = self.lookouts[place];
            let towards = |&target: &usize| self.first(from, facets[target].middle - from, usize::MAX);
            let sights: Vec<usize> = self.targets.iter().filter_map(towards).collect();
            // A facet seen from behind is seen through the inside.
            let is_behind = |&hit: &usize| facets[hit].normal.dot(facets[hit].corners[0] - from) > 0.0;
            self.is_inside[place] = place >= PLACES || sights.iter().any(is_behind);
            if self.is_inside[place] {
                sights.iter().for_each(|&hit| self.sets.join((self.patches + place) as u32, patch_of[hit]));
            }
        }
    }

    /// Joins some lookouts with those before them that they see, if both are inside.
    fn join_lookouts(&mut self, places: Range<usize>) {
        for one in places {
            for other in (0..one).filter(|&other| self.is_inside[one] && self.is_inside[other]) {
                let [a, b] = [one, other].map(|place| (self.patches + place) as u32);
                if self.sets.of(a) != self.sets.of(b) {
                    let (from, to) = (self.lookouts[one], self.lookouts[other]);
                    if self.first(from, to - from, usize::MAX).is_none() {
                        self.sets.join(a, b);
                    }
                }
            }
        }
    }

    /// Whether all patches that are seen bound one part.
    fn is_one(&mut self) -> bool {
        let mut parts = self.targets.iter().map(|&target| self.sets.of(self.patch_of[target]));
        let first = parts.next();
        parts.all(|part| Some(part) == first)
    }

    /// Joins patches from which nothing is seen, which are in the midst of a part, with the first part.
    fn join_hidden(&mut self) {
        let patch_of = self.patch_of;
        for &at in &self.hidden {
            let own = self.sets.of(patch_of[at]);
            if !self.targets.iter().any(|&target| self.sets.of(patch_of[target]) == own) {
                self.sets.join(own, patch_of[*self.targets.first().unwrap_or(&self.hidden[0])]);
            }
        }
    }

    fn seen(self) -> Local {
        let (part_of, _) = self.sets.numbered();
        // Each part has a patch, whose number is lower than that of a lookout: parts are counted by patches.
        let count = part_of[..self.patches].iter().max().map_or(1, |most| *most as usize + 1);
        let faces = FACES.map(|place| self.is_inside[place].then(|| part_of[self.patches + place]));
        let part_of = self.patch_of.iter().map(|&patch| part_of[patch as usize]).collect();
        Local { part_of, volumes: vec![0.0; count], faces, open: false }
    }
}
