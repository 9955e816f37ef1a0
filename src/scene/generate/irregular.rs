//! Lattices with randomly displaced nodes, without inverted elements.

use super::block::Block;
use super::random;
use crate::scene::file::Lattice;
use crate::sim::IndexLists;
use glam::DVec3;

/// An element counts as flat if one of its corners has less than this part of its regular volume (area).
const LEAST: f64 = 0.1;

/// The centre of a cell with nodes at its corners (m).
pub(super) fn middle(nodes: &[DVec3], cell: &[u32; 8]) -> DVec3 {
    cell.iter().map(|&node| nodes[node as usize]).sum::<DVec3>() / 8.0
}

/// Moves the nodes of a lattice at random, each by up to a part of a cell's shortest side. Nodes on the surface move only
/// along it, and the centres of cells stay in place.
///
/// Displacements of an element that becomes flat or inverted are halved until no such element is left. The regular
/// lattice has none, so this ends.
pub(super) fn disturb(typed: &Lattice, nodes: &mut [DVec3], elements: &IndexLists, middles: &[[u32; 8]]) {
    let block = Block::new(typed);
    let regular = nodes.to_vec();
    let corners = regular.len() - middles.len();
    let mut shifts = shifts(&block, typed.irregular, typed.seed);
    loop {
        for (node, shift) in shifts.iter().enumerate() {
            nodes[node] = regular[node] + *shift;
        }
        for (at, cell) in middles.iter().enumerate() {
            nodes[corners + at] = middle(nodes, cell);
        }
        let mut is_bad = vec![false; corners];
        for element in elements.iter().filter(|element| is_spoilt(element, &regular, nodes, block.is_flat())) {
            for &node in element {
                match (node as usize).checked_sub(corners) {
                    None => is_bad[node as usize] = true,
                    Some(at) => middles[at].iter().for_each(|&corner| is_bad[corner as usize] = true),
                }
            }
        }
        let bad = || is_bad.iter().enumerate().filter(|&(_, &bad)| bad).map(|(node, _)| node);
        // Without displacements the lattice is regular; only coordinates beyond double precision can still fail the test.
        if bad().all(|node| shifts[node] == DVec3::ZERO) {
            return;
        }
        bad().for_each(|node| shifts[node] *= 0.5);
    }
}

/// The displacement of each node at a corner (m).
fn shifts(block: &Block, part: f64, seed: u32) -> Vec<DVec3> {
    let axes = if block.is_flat() { 2 } else { 3 };
    let shortest = block.sides.to_array()[..axes].iter().copied().fold(f64::INFINITY, f64::min);
    // The diagonal of the box in which a node moves has the length of the requested displacement.
    let farthest = part * shortest / (axes as f64).sqrt();
    let [nx, ny, nz] = block.cells;
    let mut shifts = Vec::with_capacity(block.len() as usize);
    for (z, y, x) in (0..=nz).flat_map(|z| (0..=ny).flat_map(move |y| (0..=nx).map(move |x| (z, y, x)))) {
        let index = shifts.len() as u64;
        let along = |axis: usize, at: u32| match at {
            0 => 0.0,
            at if at == block.cells[axis] => 0.0,
            _ => farthest * (2.0 * random::unit(seed, index, axis as u64) - 1.0),
        };
        shifts.push(DVec3::new(along(0, x), along(1, y), along(2, z)));
    }
    shifts
}

/// Whether a corner of an element has lost most of its regular volume (area).
fn is_spoilt(element: &[u32], regular: &[DVec3], now: &[DVec3], is_flat: bool) -> bool {
    let is_lost = |corner: [usize; 4]| {
        let spanned = |nodes: &[DVec3]| {
            let [o, a, b, c] = corner.map(|at| nodes[element[at] as usize]);
            let area = (a - o).cross(b - o);
            if is_flat { area.z } else { area.dot(c - o) }
        };
        spanned(now) / spanned(regular) < LEAST
    };
    // The neighbours of a corner may have any order: only ratios matter.
    match (is_flat, element.len()) {
        (true, 3) => is_lost([0, 1, 2, 0]),
        (true, 4) => (0..4).any(|at| is_lost([at, (at + 1) % 4, (at + 3) % 4, at])),
        // Larger polygons begin at a node that sees all their sides.
        (true, count) => (2..count).any(|at| is_lost([0, at - 1, at, 0])),
        (false, 4) => is_lost([0, 1, 2, 3]),
        (false, 5) => (0..4).any(|at| is_lost([at, (at + 1) % 4, (at + 3) % 4, 4])),
        (false, 6) => (0..6).any(|at| {
            let first = at / 3 * 3;
            is_lost([at, first + (at + 1) % 3, first + (at + 2) % 3, (at + 3) % 6])
        }),
        (false, _) => (0..8).any(|at| is_lost([at, at ^ 1, at ^ 2, at ^ 4])),
    }
}
