//! The copies of cells, and the nodes that copies of neighbours share.

use super::super::clip::Piece;
use super::super::facet::Facet;
use super::super::lattice::{CORNERS, Cell, Full, corner};
use super::{Local, Parted, Parts, Scene};
use crate::edges::Sets;

impl Scene<'_> {
    /// The cells with one copy for each separate part of the inside, and the corners that copies share.
    pub(in crate::fill) fn parts(&self, cells: &[Parted]) -> Parts {
        // The pieces of each cell.
        let mut starts = Vec::with_capacity(cells.len() + 1);
        let mut next = 0;
        for Parted { full, .. } in cells {
            next += self.pieces[next..].partition_point(|piece| piece.cell < full.cell);
            starts.push(next);
        }
        starts.push(self.pieces.len());
        let of = |at: usize| {
            let own = &self.pieces[starts[at]..starts[at + 1]];
            &own[..own.partition_point(|piece| piece.cell <= cells[at].full.cell)]
        };
        let mut copies = Vec::with_capacity(cells.len());
        let mut first = Vec::with_capacity(cells.len());
        let mut copy_of = vec![0; self.pieces.len()];
        for (at, Parted { full, local }) in cells.iter().enumerate() {
            first.push(copies.len() as u32);
            let Some(local) = local else {
                copies.push(*full);
                continue;
            };
            for (place, part) in local.part_of.iter().enumerate() {
                copy_of[starts[at] + place] = copies.len() as u32 + part;
            }
            copies.extend(local.volumes.iter().map(|&filled| Full { filled, ..*full }));
        }
        let mut corners = Sets::new(8 * copies.len());
        for (at, Parted { full, .. }) in cells.iter().enumerate() {
            let cell = self.lattice.cell(full.cell);
            for axis in 0..3 {
                let mut beyond = cell;
                beyond[axis] += 1;
                if beyond[axis] as usize >= self.lattice.counts[axis] {
                    continue;
                }
                let key = self.lattice.key(beyond);
                let Ok(other) =
                    cells[at..].binary_search_by_key(&key, |parted| parted.full.cell).map(|place| at + place)
                else {
                    continue;
                };
                let pair = [at, other];
                let links = self.links(pair.map(of), pair.map(|at| cells[at].local.as_ref()), beyond, axis);
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
    fn links(&self, pieces: [&[Piece]; 2], locals: [Option<&Local>; 2], above: Cell, axis: usize) -> Vec<[u32; 2]> {
        let mut links = Vec::new();
        let low = corner(above);
        if let [Some(here), Some(there)] = locals {
            // Triangles that pass the face.
            let mut rest = 0;
            for (at, piece) in pieces[0].iter().enumerate() {
                rest += pieces[1][rest..].partition_point(|other| other.triangle < piece.triangle);
                if pieces[1].get(rest).is_some_and(|other| other.triangle == piece.triangle) {
                    links.push([here.part_of[at], there.part_of[rest]]);
                }
            }
            // Triangles that meet at an edge in the face.
            let mut high = low + 1.0;
            high[axis] = low[axis];
            let in_face = |piece: &Piece| self.corners(piece).iter().filter(|at| at[axis] == low[axis]).count() >= 2;
            let edges = |pieces: &[Piece]| {
                let numbered = (0usize..).zip(pieces).filter(|(_, piece)| in_face(piece));
                let mut found: Vec<_> = numbered
                    .flat_map(|(at, piece)| self.edges_in(piece, low, high).map(move |edge| (edge, at)))
                    .collect();
                found.sort_unstable();
                found
            };
            let (one_side, other_side) = (edges(pieces[0]), edges(pieces[1]));
            for &(edge, at) in &one_side {
                let start = other_side.partition_point(|&(other, _)| other < edge);
                let same = other_side[start..].iter().take_while(|&&(other, _)| other == edge);
                links.extend(same.map(|&(_, place)| [here.part_of[at], there.part_of[place]]));
            }
        }
        // What is at the middle of the face. A cell without surface is full, and so is its face.
        let is_full = || match locals {
            [Some(here), Some(there)] if here.volumes.len() == 1 && there.volumes.len() == 1 => {
                let mut middle = low + 0.5;
                middle[axis] = low[axis];
                here.open || there.open || self.inside.contains(middle)
            }
            _ => true,
        };
        if links.is_empty() && !self.is_walled(pieces, above, axis) && is_full() {
            let face = |which: usize| locals[which].map_or(Some(0), |local| local.faces[2 * axis + 1 - which]);
            links.extend(face(0).zip(face(1)).map(|(one, other)| [one, other]));
        }
        links.sort_unstable();
        links.dedup();
        links
    }

    /// Whether a triangle that bounds the inside lies in the face between two cells.
    fn is_walled(&self, pieces: [&[Piece]; 2], above: Cell, axis: usize) -> bool {
        let plane = f64::from(above[axis]);
        let is_wall = |piece: &Piece| {
            let corners = self.corners(piece);
            let facet = || Facet::new(corners, corner(self.lattice.cell(piece.cell)));
            corners.iter().all(|corner| corner[axis] == plane) && facet().bounds(self.inside)
        };
        pieces.iter().any(|pieces| pieces.iter().any(is_wall))
    }
}
