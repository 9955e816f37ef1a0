//! Cells with separate parts of a body: one copy of the cell for each, so that legs side by side do not grow together
//! (M. Nesme et al., “Preserving topology and elasticity for embedded deformable models”, 2009).
//!
//! The surface in a cell falls into patches, which shared edges hold together. Two patches bound the same part of the inside if
//! one sees the other through the inside, directly or by way of points that see each other. Copies of neighbouring cells share
//! nodes where the same part passes their common face.

use super::clip::{Piece, Polygon};
use super::lattice::{CORNERS, Cell, Full, Lattice, corner};
use crate::Surface;
use crate::edges::{EdgeUse, Sets, net};
use crate::inside::Inside;
use glam::DVec3;
use rayon::prelude::*;

/// Cells and their copies.
pub(super) struct Parts {
    /// The cell of each copy and the part of it that is inside, by cell.
    pub(super) copies: Vec<Full>,
    /// For each corner of each copy, the set of corners that are one node.
    pub(super) corners: Vec<u32>,
    /// The copy of each piece of the surface.
    pub(super) copy_of: Vec<u32>,
}

/// A surface in a lattice.
pub(super) struct Scene<'s> {
    pub(super) scaled: &'s Surface,
    pub(super) lattice: &'s Lattice,
    pub(super) inside: &'s Inside,
    pub(super) pieces: &'s [Piece],
}

/// The parts of the inside in one cell.
#[derive(Clone, Debug)]
struct Local {
    /// The part that each piece of the surface bounds.
    part_of: Vec<u32>,
    /// How much of the cell's inside each part has.
    shares: Vec<f64>,
    /// The part at the middle of each face, if one is there: low and high along x, y and z. Known for several parts only.
    faces: [Option<u32>; 6],
    /// Whether the surface is open in the cell, so that it has one part.
    open: bool,
}

impl Local {
    fn whole(pieces: usize, open: bool) -> Self {
        Self { part_of: vec![0; pieces], shares: vec![1.0], faces: [None; 6], open }
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

impl Scene<'_> {
    fn corners(&self, piece: &Piece) -> [DVec3; 3] {
        self.scaled.corners(self.scaled.triangles[piece.triangle as usize])
    }

    /// The numbers of the edges of a piece's triangle that pass a box.
    fn edges_in<'e>(
        &'e self,
        edges: &'e Edges,
        piece: &'e Piece,
        low: DVec3,
        high: DVec3,
    ) -> impl Iterator<Item = u32> + 'e {
        let corners = self.corners(piece);
        let numbers = edges.of[piece.triangle as usize].into_iter().enumerate();
        numbers.filter(move |&(at, _)| passes(corners[at], corners[(at + 1) % 3], low, high)).map(|(_, number)| number)
    }

    /// The parts in one cell, with the pieces of the surface in it.
    fn local(&self, edges: &Edges, pieces: &[Piece]) -> Local {
        let count = pieces.len();
        let low = corner(self.lattice.cell(pieces[0].cell));
        let mut shared: Vec<(u32, u32)> = Vec::with_capacity(3 * count);
        for (at, piece) in (0..).zip(pieces) {
            shared.extend(self.edges_in(edges, piece, low, low + 1.0).map(|edge| (edge, at)));
        }
        if shared.iter().any(|&(edge, _)| edges.open[edge as usize]) {
            return Local::whole(count, true);
        }
        shared.sort_unstable();
        let mut patches = Sets::new(count);
        shared.windows(2).filter(|pair| pair[0].0 == pair[1].0).for_each(|pair| patches.join(pair[0].1, pair[1].1));
        let (patch_of, number) = patches.numbered();
        if number == 1 {
            return Local::whole(count, false);
        }
        let facets = pieces.iter().map(|piece| Facet::new(self.corners(piece), low)).collect();
        Sight { facets, patch_of, low }.parts(number)
    }

    /// The cells with one copy for each separate part of the inside, and the corners that copies share.
    pub(super) fn parts(&self, cells: &[Full]) -> Parts {
        let edges = Edges::new(self.scaled);
        // The pieces of each cell, and the parts of those with pieces.
        let mut starts = Vec::with_capacity(cells.len() + 1);
        let mut next = 0;
        for full in cells {
            next += self.pieces[next..].partition_point(|piece| piece.cell < full.cell);
            starts.push(next);
        }
        starts.push(self.pieces.len());
        let of = |at: usize| {
            let own = &self.pieces[starts[at]..starts[at + 1]];
            &own[..own.partition_point(|piece| piece.cell <= cells[at].cell)]
        };
        let locals: Vec<Option<Local>> = (0..cells.len())
            .into_par_iter()
            .map(|at| Some(of(at)).filter(|pieces| !pieces.is_empty()).map(|pieces| self.local(&edges, pieces)))
            .collect();
        let mut copies = Vec::with_capacity(cells.len());
        let mut first = Vec::with_capacity(cells.len());
        let mut copy_of = vec![0; self.pieces.len()];
        for (at, (full, local)) in cells.iter().zip(&locals).enumerate() {
            first.push(copies.len() as u32);
            let Some(local) = local else {
                copies.push(*full);
                continue;
            };
            for (place, part) in local.part_of.iter().enumerate() {
                copy_of[starts[at] + place] = copies.len() as u32 + part;
            }
            copies.extend(local.shares.iter().map(|share| Full { filled: full.filled * share, ..*full }));
        }
        let mut corners = Sets::new(8 * copies.len());
        for (at, full) in cells.iter().enumerate() {
            let cell = self.lattice.cell(full.cell);
            for axis in 0..3 {
                let mut beyond = cell;
                beyond[axis] += 1;
                if beyond[axis] as usize >= self.lattice.counts[axis] {
                    continue;
                }
                let key = self.lattice.key(beyond);
                let Ok(other) = cells[at..].binary_search_by_key(&key, |full| full.cell).map(|place| at + place) else {
                    continue;
                };
                let pair = [at, other];
                let links = self.links(&edges, pair.map(of), pair.map(|at| locals[at].as_ref()), beyond, axis);
                for [here, there] in links {
                    let [here, there] = [first[at] + here, first[other] + there];
                    for (near, far) in (0u32..).zip(&CORNERS).filter(|(_, corner)| corner[axis] == 0) {
                        debug_assert_eq!(far[axis], 0);
                        corners.join(8 * here + near + (1 << axis), 8 * there + near);
                    }
                }
            }
        }
        let corners = (0..8 * copies.len() as u32).map(|corner| corners.of(corner)).collect();
        Parts { copies, corners, copy_of }
    }

    /// The parts of two neighbours that are one beyond their common face: the lower face of the cell `above` across an
    /// axis.
    fn links(
        &self,
        edges: &Edges,
        pieces: [&[Piece]; 2],
        locals: [Option<&Local>; 2],
        above: Cell,
        axis: usize,
    ) -> Vec<[u32; 2]> {
        let [Some(here), Some(there)] = locals else {
            // A cell without surface is full, and so is the face.
            let face = |local: Option<&Local>, face: usize| match local {
                Some(local) if local.shares.len() > 1 => local.faces[face],
                _ => Some(0),
            };
            let parts = [face(locals[0], 2 * axis + 1), face(locals[1], 2 * axis)];
            return match parts {
                [Some(here), Some(there)] if !self.is_walled(pieces, above, axis) => vec![[here, there]],
                _ => Vec::new(),
            };
        };
        // Triangles that pass the face.
        let mut links = Vec::new();
        let mut rest = 0;
        for (at, piece) in pieces[0].iter().enumerate() {
            rest += pieces[1][rest..].partition_point(|other| other.triangle < piece.triangle);
            if pieces[1].get(rest).is_some_and(|other| other.triangle == piece.triangle) {
                links.push([here.part_of[at], there.part_of[rest]]);
            }
        }
        // Triangles that meet at an edge in the face.
        let low = corner(above);
        let mut high = low + 1.0;
        high[axis] = low[axis];
        let in_face = |which: usize| {
            let numbered = (0usize..).zip(pieces[which]);
            let mut found: Vec<_> = numbered
                .filter(|(_, piece)| {
                    let corners = self.corners(piece);
                    corners.iter().filter(|corner| corner[axis] == low[axis]).count() >= 2
                })
                .flat_map(|(at, piece)| self.edges_in(edges, piece, low, high).map(move |edge| (edge, at)))
                .collect();
            found.sort_unstable();
            found
        };
        let (one_side, other_side) = (in_face(0), in_face(1));
        for &(edge, at) in &one_side {
            let start = other_side.partition_point(|&(other, _)| other < edge);
            let same = other_side[start..].iter().take_while(|&&(other, _)| other == edge);
            links.extend(same.map(|&(_, place)| [here.part_of[at], there.part_of[place]]));
        }
        if links.is_empty() && !self.is_walled(pieces, above, axis) {
            let mut middle = low + 0.5;
            middle[axis] = low[axis];
            let is_single = |local: &Local| local.shares.len() == 1;
            let is_full = if is_single(here) && is_single(there) {
                here.open || there.open || self.inside.contains(middle)
            } else {
                true
            };
            let face = |local: &Local, face: usize| if is_single(local) { Some(0) } else { local.faces[face] };
            if let (true, Some(one), Some(other)) = (is_full, face(here, 2 * axis + 1), face(there, 2 * axis)) {
                links.push([one, other]);
            }
        }
        links.sort_unstable();
        links.dedup();
        links
    }

    /// Whether a triangle lies in the face between two cells.
    fn is_walled(&self, pieces: [&[Piece]; 2], above: Cell, axis: usize) -> bool {
        let plane = f64::from(above[axis]);
        pieces
            .iter()
            .any(|pieces| pieces.iter().any(|piece| self.corners(piece).iter().all(|corner| corner[axis] == plane)))
    }
}

/// A piece of the surface in a cell.
struct Facet {
    corners: [DVec3; 3],
    /// The normal of its triangle, with any length.
    normal: DVec3,
    /// A point in the middle of the piece, and the piece's area.
    middle: DVec3,
    area: f64,
}

impl Facet {
    fn new(corners: [DVec3; 3], low: DVec3) -> Self {
        let piece = Polygon::new(corners).within(low);
        let all = piece.corners();
        let middle = match all.len() {
            0 => corners[0].clamp(low, low + 1.0),
            count => all.iter().sum::<DVec3>() / count as f64,
        };
        let area = if all.len() < 3 { 0.0 } else { piece.area().length() };
        Self { corners, normal: (corners[1] - corners[0]).cross(corners[2] - corners[0]), middle, area }
    }

    /// How far along a line the triangle is hit, in lengths of `along`.
    fn hit(&self, from: DVec3, along: DVec3) -> Option<f64> {
        // T. Möller and B. Trumbore, 1997.
        let across = self.normal.dot(along);
        let [a, b, c] = self.corners.map(|corner| corner - from);
        let [u, v, w] = [along.dot(b.cross(c)), along.dot(c.cross(a)), along.dot(a.cross(b))];
        let is_in = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
        (is_in && across != 0.0).then(|| self.normal.dot(a) / across)
    }
}

/// What sees what in a cell.
struct Sight {
    facets: Vec<Facet>,
    patch_of: Vec<u32>,
    low: DVec3,
}

/// Hits nearer than this are where a line begins, in sides of the cell.
const NEAR: f64 = 1e-9;
/// Places of points along each side of a cell that look for patches. Those beside faces stand for them.
const LOOKOUTS: [f64; 3] = [1e-3, 0.5, 1.0 - 1e-3];
/// From so many pieces of a patch it is looked inwards.
const LOOKS: usize = 8;

impl Sight {
    /// The nearest facet along a line, up to its end, apart from one.
    fn first(&self, from: DVec3, along: DVec3, apart: usize) -> Option<usize> {
        let near = NEAR / along.length();
        let hits = self.facets.iter().enumerate().filter(|&(at, _)| at != apart);
        let hits = hits.filter_map(|(at, facet)| facet.hit(from, along).map(|hit| (hit, at)));
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

    fn parts(&self, patches: usize) -> Local {
        // The largest piece of each patch.
        let mut largest = vec![None::<usize>; patches];
        let mut sizes = vec![0usize; patches];
        for (at, (facet, &patch)) in self.facets.iter().zip(&self.patch_of).enumerate() {
            sizes[patch as usize] += 1;
            let best = &mut largest[patch as usize];
            if best.is_none_or(|best| facet.area > self.facets[best].area) {
                *best = Some(at);
            }
        }
        // Patches, then lookouts.
        let mut sets = Sets::new(patches + 27);
        let mut seen = vec![0usize; patches];
        for (at, (facet, &patch)) in self.facets.iter().zip(&self.patch_of).enumerate() {
            let number = &mut seen[patch as usize];
            let stride = sizes[patch as usize].div_ceil(LOOKS);
            *number += 1;
            if !(*number - 1).is_multiple_of(stride) && largest[patch as usize] != Some(at) {
                continue;
            }
            let along = self.to_side(facet.middle, -facet.normal);
            if along.length_squared() > 0.0
                && let Some(hit) = self.first(facet.middle, along, at)
            {
                sets.join(patch, self.patch_of[hit]);
            }
        }
        let lookouts: Vec<DVec3> =
            (0..27).map(|at| self.low + DVec3::new(LOOKOUTS[at % 3], LOOKOUTS[at / 3 % 3], LOOKOUTS[at / 9])).collect();
        let mut is_inside = [false; 27];
        for (place, &from) in lookouts.iter().enumerate() {
            let sights: Vec<usize> = largest
                .iter()
                .flatten()
                .filter_map(|&target| self.first(from, self.facets[target].middle - from, usize::MAX))
                .collect();
            // A facet seen from behind is seen through the inside.
            is_inside[place] =
                sights.iter().any(|&hit| self.facets[hit].normal.dot(self.facets[hit].corners[0] - from) > 0.0);
            if is_inside[place] {
                sights.iter().for_each(|&hit| sets.join((patches + place) as u32, self.patch_of[hit]));
            }
        }
        for one in 0..27 {
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
        let (part_of, _) = sets.numbered();
        // Each part has a patch, whose number is lower than that of a lookout: parts are counted by patches.
        let count = part_of[..patches].iter().max().map_or(1, |most| *most as usize + 1);
        let faces = [12, 14, 10, 16, 4, 22].map(|place| is_inside[place].then(|| part_of[patches + place]));
        let shares = if count > 1 { self.shares(&part_of, count) } else { vec![1.0] };
        Local {
            part_of: self.patch_of.iter().map(|&patch| part_of[patch as usize]).collect(),
            shares,
            faces,
            open: false,
        }
    }

    /// How much of the inside each part has: by points, each of which looks along the axes for a facet.
    fn shares(&self, part_of: &[u32], count: usize) -> Vec<f64> {
        const ALONG: usize = 5;
        // No part is empty.
        let mut numbers = vec![0.1; count];
        for at in 0..ALONG * ALONG * ALONG {
            let place = [at % ALONG, at / ALONG % ALONG, at / ALONG / ALONG].map(|at| (at as f64 + 0.5) / ALONG as f64);
            let from = self.low + DVec3::from_array(place);
            let sides = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
            let hit = sides.filter_map(|side| self.first(from, self.to_side(from, side), usize::MAX)).next();
            if let Some(hit) = hit
                && self.facets[hit].normal.dot(self.facets[hit].corners[0] - from) > 0.0
            {
                numbers[part_of[self.patch_of[hit] as usize] as usize] += 1.0;
            }
        }
        let all: f64 = numbers.iter().sum();
        numbers.into_iter().map(|number| number / all).collect()
    }
}
