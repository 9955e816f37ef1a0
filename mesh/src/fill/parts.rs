//! Cells with separate parts of a body: one copy of the cell for each, so that legs side by side do not grow together
//! (M. Nesme et al., “Preserving topology and elasticity for embedded deformable models”, 2009).
//!
//! The surface in a cell falls into patches, which shared edges hold together. Two patches bound the same part of the inside if
//! one sees the other through the inside, directly or by way of points that see each other. Copies of neighbouring cells share
//! nodes where the same part passes their common face.

mod joining;

use super::Thin;
use super::clip::{self, Piece};
use super::facet::Facet;
use super::lattice::{Full, Lattice, corner};
use super::sight::{Local, Sight};
use super::union::Tangle;
use crate::Surface;
use crate::edges::{EdgeUse, Sets, net};
use crate::inside::Inside;
use glam::DVec3;

/// An element is filled at least by this part, lest its numbers come near to the smallest.
pub(super) const LEAST: f64 = 1e-9;

/// Volumes below this are round-off, in cells.
const CLOSE: f64 = 1e-9;

/// Cells and their copies.
pub(super) struct Parts {
    /// The cell of each copy and the part of it that is inside, by cell.
    pub(super) copies: Vec<Full>,
    /// For each corner of each copy, the set of corners that are one node.
    pub(super) corners: Vec<u32>,
    /// The copy of each piece of the surface.
    pub(super) copy_of: Vec<u32>,
}

impl Parts {
    /// The copies filled in part that share no corner with a full one, for any kind of elements: those filled in part by others, such as cut
    /// ones, may be none.
    pub(super) fn thin(&self) -> Thin {
        let of = || self.copies.iter().zip(self.corners.as_chunks::<8>().0);
        let mut is_firm = vec![false; self.corners.len()];
        of().filter(|(copy, _)| copy.filled == 1.0)
            .for_each(|(_, own)| own.iter().for_each(|&corner| is_firm[corner as usize] = true));
        let thin = of().filter(|(_, own)| !own.iter().any(|&corner| is_firm[corner as usize]));
        let filled = thin.map(|(copy, _)| copy.filled);
        Thin { cubes: filled.clone().count(), of: self.copies.len(), filled: filled.sum() }
    }
}

/// A surface in a lattice.
pub(super) struct Scene<'s> {
    pub(super) scaled: &'s Surface,
    pub(super) lattice: &'s Lattice,
    pub(super) inside: &'s Inside,
    pub(super) pieces: &'s [Piece],
    edges: Edges,
}

/// A cell with a part of the inside.
#[derive(Clone, Debug)]
pub(super) struct Parted {
    pub(super) full: Full,
    /// Its parts, if there is a surface in it.
    local: Option<Local>,
}

impl Parted {
    /// A cell without a surface.
    pub(super) fn whole(cell: u64) -> Self {
        Self { full: Full { cell, filled: 1.0 }, local: None }
    }
}

/// The pieces of a surface in a cell, and what of them shared edges hold together.
pub(super) struct Patches<'s> {
    pieces: &'s [Piece],
    /// The patch of each piece.
    of: Vec<u32>,
    pub(super) count: usize,
    /// Whether more than two pieces meet in an edge.
    folded: bool,
    /// Whether the volume of the inside is known, and not only tried at points.
    certain: bool,
}

impl Patches<'_> {
    /// About how often it is asked whether a line meets a triangle to tell what the patches bound.
    pub(super) fn effort(&self, inside: &Inside) -> f64 {
        Tangle::effort(self.pieces.len(), inside) + Sight::effort(self.pieces.len(), self.count)
    }
}

/// A part of a cell or an element: all, if it differs from that by round-off, and at least [`LEAST`].
pub(super) fn bounded(part: f64) -> f64 {
    if part > 1.0 - 1e-12 { 1.0 } else { part.max(LEAST) }
}

impl<'s> Scene<'s> {
    pub(super) fn new(scaled: &'s Surface, lattice: &'s Lattice, inside: &'s Inside, pieces: &'s [Piece]) -> Self {
        Self { scaled, lattice, inside, pieces, edges: Edges::new(scaled) }
    }

    fn corners(&self, piece: &Piece) -> [DVec3; 3] {
        self.scaled.corners(self.scaled.triangles[piece.triangle as usize])
    }

    /// The numbers of the edges of a piece's triangle that pass a box.
    fn edges_in(&self, piece: &Piece, low: DVec3, high: DVec3) -> impl Iterator<Item = u32> {
        let corners = self.corners(piece);
        let numbers = self.edges.of[piece.triangle as usize].into_iter().enumerate();
        numbers.filter(move |&(at, _)| passes(corners[at], corners[(at + 1) % 3], low, high)).map(|(_, number)| number)
    }

    /// A cell with a surface in it as if it had one part, and its patches if they may bound several, or if shells may cross in it. The
    /// volume of its inside, in cells, is that of all parts, unless shells cross or lie in each other. `certain` says whether it is
    /// known, and not only tried at points.
    pub(super) fn begun(&self, pieces: &'s [Piece], volume: f64, certain: bool) -> (Parted, Option<Patches<'s>>) {
        let (cell, count) = (pieces[0].cell, pieces.len());
        let low = corner(self.lattice.cell(cell));
        let mut shared: Vec<(u32, u32)> = Vec::with_capacity(3 * count);
        for (at, piece) in (0..).zip(pieces) {
            shared.extend(self.edges_in(piece, low, low + 1.0).map(|edge| (edge, at)));
        }
        let open = shared.iter().any(|&(edge, _)| self.edges.open[edge as usize]);
        let whole = Parted { full: Full { cell, filled: volume }, local: Some(Local::whole(count, volume, open)) };
        if open {
            return (whole, None);
        }
        shared.sort_unstable();
        let mut patches = Sets::new(count);
        shared.windows(2).filter(|pair| pair[0].0 == pair[1].0).for_each(|pair| patches.join(pair[0].1, pair[1].1));
        let folded = shared.windows(3).any(|uses| uses[0].0 == uses[2].0);
        let (of, count) = patches.numbered();
        (whole, (count > 1 || folded).then_some(Patches { pieces, of, count, folded, certain }))
    }

    /// The parts of a cell that its patches bound.
    pub(super) fn parted(&self, whole: Parted, patches: &Patches) -> Parted {
        let Full { cell, filled: volume } = whole.full;
        let &Patches { pieces, of: ref patch_of, count, folded, certain } = patches;
        let low = corner(self.lattice.cell(cell));
        let facets: Vec<_> = pieces.iter().map(|piece| Facet::new(self.corners(piece), low)).collect();
        let tangle = if certain { Tangle::new(self.inside, &facets, patch_of, folded) } else { None };
        let mut local = Sight::new(&facets, (patch_of, count), low, tangle.as_ref()).parts();
        if local.volumes.len() == 1 && tangle.is_none() {
            return whole;
        }
        match &tangle {
            Some(tangle) => tangle.fragments.iter().for_each(|fragment| {
                local.volumes[local.part_of[fragment.facet] as usize] +=
                    fragment.bounding * clip::volume(&fragment.corners, low);
            }),
            None => facets.iter().zip(&local.part_of).for_each(|(facet, &part)| {
                local.volumes[part as usize] += clip::volume(facet.piece.corners(), low);
            }),
        }
        self.give_corner(&mut local.volumes, low + 1.0);
        local.volumes.iter_mut().for_each(|volume| *volume = bounded(*volume));
        let sum: f64 = local.volumes.iter().sum();
        if tangle.is_none() && (sum - volume).abs() > 1e-6 * volume {
            if certain && (sum - volume).abs() > CLOSE {
                // A part was not seen as one. Together they have the volume that is known.
                return whole;
            }
            // The surface is open nearby.
            local.volumes.iter_mut().for_each(|own| *own *= volume / sum);
        }
        Parted { full: Full { cell, filled: local.volumes.iter().sum() }, local: Some(local) }
    }

    /// Adds a whole cell to the part that contains the highest corner of the cell, if one does. Its volume is known but for this one.
    fn give_corner(&self, volumes: &mut [f64], corner: DVec3) {
        // A little inside of the cell, and in no plane that a user would choose.
        let beside = corner - 1e-7 * DVec3::new(1.0, 2.3, 3.7);
        let Some(least) = volumes.iter_mut().min_by(|one, other| one.total_cmp(other)) else { return };
        if *least < -CLOSE || (*least < CLOSE && self.inside.around(beside) > 0) {
            *least += 1.0;
        }
    }
}

/// The edges of a surface.
struct Edges {
    /// The number of the edge from each corner of a triangle to the next.
    of: Vec<[u32; 3]>,
    /// Whether the surface is not closed at an edge.
    open: Vec<bool>,
}

impl Edges {
    fn new(surface: &Surface) -> Self {
        let mut of = vec![[0; 3]; surface.triangles.len()];
        let mut open = Vec::new();
        for edge in EdgeUse::all(&surface.triangles).chunk_by(EdgeUse::same) {
            for one in edge {
                let corners = surface.triangles[one.triangle as usize];
                let from = if one.forward { one.low } else { one.high };
                let place = corners.iter().position(|&corner| corner == from).unwrap_or(0);
                of[one.triangle as usize][place] = open.len() as u32;
            }
            open.push(net(edge) != 0);
        }
        Self { of, open }
    }
}

/// Whether more than a point of a line is in a box.
fn passes(from: DVec3, to: DVec3, low: DVec3, high: DVec3) -> bool {
    let (mut start, mut end) = (0.0f64, 1.0f64);
    for axis in 0..3 {
        let (at, along) = (from[axis], to[axis] - from[axis]);
        if along == 0.0 {
            if at < low[axis] || at > high[axis] {
                return false;
            }
        } else {
            let [one, other] = [low[axis], high[axis]].map(|plane| (plane - at) / along);
            start = start.max(one.min(other));
            end = end.min(one.max(other));
        }
    }
    start < end
}
