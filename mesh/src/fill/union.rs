//! What of the surface in a cell bounds the inside, where shells cross or lie in each other.
//!
//! Inside, the winding number is above 0. A shell in another one has it on both of its sides and bounds nothing. Where shells cross,
//! their triangles are divided, so that each fragment has one winding number on either side.

use super::facet::{Facet, overlap};
use crate::inside::Inside;
use glam::DVec3;
use localshape_sim::geometry::bounds;

/// A facet is divided into no more fragments by further facets: hundreds that cross in one cell are no shells.
const MOST: usize = 256;

/// A part of a facet that no other facet passes.
pub(super) struct Fragment {
    pub(super) facet: usize,
    pub(super) corners: Vec<DVec3>,
    /// How much of it bounds the inside: 0 or 1, or an equal share of one among facets at the same place.
    pub(super) bounding: f64,
}

/// The facets of shells that cross or lie in each other.
pub(super) struct Tangle {
    pub(super) fragments: Vec<Fragment>,
    /// Pairs of facets that cross, or are at the same place.
    pub(super) joined: Vec<[usize; 2]>,
}

impl Tangle {
    /// About how often facets are compared with each other, and with a line.
    pub(super) fn effort(facets: usize, inside: &Inside) -> f64 {
        let fragments = facets * facets.min(MOST);
        (facets * facets) as f64 + 2.0 * fragments as f64 * inside.columns.crowd()
    }

    /// The tangle of facets, or `None` if all of them bound the inside. Facets of one patch are compared only if `folded` says that more
    /// than two may meet in an edge.
    pub(super) fn new(inside: &Inside, facets: &[Facet], patch_of: &[u32], folded: bool) -> Option<Self> {
        let boxes: Vec<_> = facets.iter().map(|facet| bounds(facet.piece.corners())).collect();
        let near = near(facets, &boxes, patch_of, folded);
        // Patches away from others are on one side of them all, as their largest facets are.
        let mut largest = vec![None::<usize>; patch_of.len()];
        for (at, &patch) in patch_of.iter().enumerate() {
            let best = &mut largest[patch as usize];
            *best = best.filter(|&best| facets[best].area >= facets[at].area).or(Some(at));
        }
        let mut known: Vec<Option<f64>> =
            largest.iter().map(|at| at.map(|at| facets[at].bounding(inside, facets[at].middle))).collect();
        for (_, &patch) in near.iter().zip(patch_of).filter(|(near, _)| folded || !near.is_empty()) {
            known[patch as usize] = None;
        }
        let mut tangle = Self { fragments: Vec::new(), joined: Vec::new() };
        for (at, facet) in facets.iter().enumerate() {
            let mut parts = vec![facet.piece.corners().to_vec()];
            for &other in &near[at] {
                if parts.len() < MOST {
                    parts = parts.into_iter().flat_map(|part| facets[other].divide(part, boxes[other])).collect();
                }
            }
            let first = tangle.fragments.len();
            tangle.fragments.extend(parts.into_iter().filter(|corners| corners.len() > 2).map(|corners| {
                let middle = || corners.iter().sum::<DVec3>() / corners.len() as f64;
                let bounding = known[patch_of[at] as usize].unwrap_or_else(|| facet.bounding(inside, middle()));
                Fragment { facet: at, corners, bounding }
            }));
            let is_shared = tangle.fragments[first..].iter().any(|fragment| fragment.bounding.fract() != 0.0);
            let joined = near[at].iter().filter(|&&other| is_shared || facet.crosses(&facets[other]));
            tangle.joined.extend(joined.map(|&other| [at, other]));
        }
        tangle.fragments.iter().any(|fragment| fragment.bounding != 1.0).then_some(tangle)
    }
}

/// For each facet, those of other patches that it may meet; of its own, too, if surfaces are folded.
fn near(facets: &[Facet], boxes: &[(DVec3, DVec3)], patch_of: &[u32], folded: bool) -> Vec<Vec<usize>> {
    let mut of_patches = vec![(DVec3::INFINITY, DVec3::NEG_INFINITY); facets.len()];
    for (&patch, own) in patch_of.iter().zip(boxes) {
        let all = &mut of_patches[patch as usize];
        *all = (all.0.min(own.0), all.1.max(own.1));
    }
    let near = |at: usize| {
        let is_other = |patch: u32| folded || patch != patch_of[at];
        let is_alone = !(0..).zip(&of_patches).any(|(patch, of)| is_other(patch) && overlap(boxes[at], *of));
        if is_alone || facets[at].area == 0.0 {
            return Vec::new();
        }
        let meets = |&other: &usize| {
            let is_met = other != at && is_other(patch_of[other]) && facets[other].area > 0.0;
            is_met && overlap(boxes[at], boxes[other]) && facets[at].meets(&facets[other])
        };
        (0..facets.len()).filter(meets).collect()
    };
    (0..facets.len()).map(near).collect()
}
