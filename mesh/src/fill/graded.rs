//! Cubes that are coarser away from the surface.
//!
//! Cells whose neighbourhood is full are joined, eight to one, again and again. Cubes that share a face or an edge differ by
//! a factor of two at most. A cube lists the nodes of smaller neighbours that hang in the middles of its faces and edges: to
//! the shape model they are nodes like others. The surface is in the smallest cubes alone, where its weights are those of
//! plain cubes.

use super::lattice::{CORNERS, Cell, Lattice, Nodes};
use super::parts::{Parts, Scene};
use localshape_sim::IndexLists;
use std::collections::HashSet;

/// A cube of several cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Cube {
    /// The lowest cell, and the number of cells along a side.
    low: Cell,
    side: u32,
    /// The copy of the lowest cell.
    copy: u32,
}

/// Elements made of copies, the part of each that is inside, and the element of each copy that touches the surface.
pub(super) struct Graded {
    pub(super) elements: IndexLists,
    pub(super) filled: Vec<f64>,
    pub(super) element_of: Vec<u32>,
}

/// Joins cells.
pub(super) fn joined(scene: &Scene, parts: &Parts, nodes: &mut Nodes) -> Graded {
    let lattice = scene.lattice;
    let cubes = leaves(scene, parts);
    // All corners of cubes are nodes.
    let mut is_node = vec![false; parts.corners.len()];
    let set = |cube: &Cube, at: Cell| set(lattice, parts, cube, at);
    for cube in &cubes {
        for corner in CORNERS {
            is_node[set(cube, corner.map(|end| 2 * end)) as usize] = true;
        }
    }
    let mut graded =
        Graded { elements: IndexLists::default(), filled: vec![], element_of: vec![0; parts.copies.len()] };
    for cube in &cubes {
        let mut own = Vec::with_capacity(8);
        let mut push = |at: Cell| {
            let set = set(cube, at);
            if is_node[set as usize] {
                own.push(nodes.of(set, [0, 1, 2].map(|axis| cube.low[axis] + at[axis] * cube.side / 2)));
            }
        };
        for corner in CORNERS {
            push(corner.map(|end| 2 * end));
        }
        if cube.side > 1 {
            // The middles of edges and faces, but not of the cube.
            let middles = (0..27).map(|at| [at % 3, at / 3 % 3, at / 9]);
            middles.filter(|at| (1..3).contains(&at.iter().filter(|&&at| at == 1).count())).for_each(&mut push);
        }
        graded.element_of[cube.copy as usize] = graded.elements.len() as u32;
        graded.elements.push(&own);
        graded.filled.push(if cube.side > 1 { 1.0 } else { parts.copies[cube.copy as usize].filled });
    }
    graded
}

/// The set of corners at a corner of a cube or in a middle, whose place is in halves of its side.
fn set(lattice: &Lattice, parts: &Parts, cube: &Cube, at: Cell) -> u32 {
    // A cell of the cube that has the place as a corner.
    let place = at.map(|at| at * cube.side / 2);
    let inner = place.map(|place| place.min(cube.side - 1));
    let cell = [0, 1, 2].map(|axis| cube.low[axis] + inner[axis]);
    let corner = (0..3).map(|axis| (place[axis] - inner[axis]) << axis).sum::<u32>();
    let copy = if cube.side == 1 {
        cube.copy
    } else {
        let key = lattice.key(cell);
        parts.copies.binary_search_by_key(&key, |full| full.cell).map_or(cube.copy, |copy| copy as u32)
    };
    parts.corners[(8 * copy + corner) as usize]
}

/// The cubes, by their lowest cell.
fn leaves(scene: &Scene, parts: &Parts) -> Vec<Cube> {
    let lattice = scene.lattice;
    let single = |copy: usize| Cube { low: lattice.cell(parts.copies[copy].cell), side: 1, copy: copy as u32 };
    let mut cubes: Vec<Cube> = (0..parts.copies.len()).map(single).collect();
    let mut leaves: Vec<Cube> = Vec::new();
    // All places with a part of the inside, in units of the present side, and those of whole cubes of this side.
    let mut taken: HashSet<Cell> = cubes.iter().map(|cube| cube.low).collect();
    let mut full: HashSet<Cell> = taken.clone();
    let mut free: HashSet<Cell> = {
        let mut touched = scene.pieces.iter().map(|piece| piece.cell).peekable();
        let mut is_touched = |key: u64| {
            while touched.next_if(|&cell| cell < key).is_some() {}
            touched.peek() == Some(&key)
        };
        cubes.iter().filter(|cube| !is_touched(lattice.key(cube.low))).map(|cube| cube.low).collect()
    };
    let mut side = 1;
    loop {
        // Blocks of eight free cubes, around which no place is divided further.
        let is_whole = |block: &Cell| {
            (0..64).all(|at| {
                let [x, y, z] = [at % 4, at / 4 % 4, at / 16];
                let outside = [x, y, z].iter().filter(|&&at| at == 0 || at == 3).count();
                // Cubes that meet at a corner only may differ by more.
                let place = [0, 1, 2].map(|axis| (2 * block[axis] + [x, y, z][axis]).checked_sub(1));
                let [Some(x), Some(y), Some(z)] = place else { return outside > 0 };
                match outside {
                    0 => free.contains(&[x, y, z]),
                    3 => true,
                    _ => full.contains(&[x, y, z]) || !taken.contains(&[x, y, z]),
                }
            })
        };
        let corners = cubes.iter().filter(|cube| cube.low.iter().all(|at| at / side % 2 == 0));
        let whole: Vec<Cube> = corners
            .filter(|cube| free.contains(&cube.low.map(|at| at / side)) && is_whole(&cube.low.map(|at| at / side / 2)))
            .map(|cube| Cube { side: 2 * side, ..*cube })
            .collect();
        let joined: HashSet<Cell> = whole.iter().map(|cube| cube.low.map(|at| at / side / 2)).collect();
        leaves.extend(cubes.iter().filter(|cube| !joined.contains(&cube.low.map(|at| at / side / 2))));
        if whole.is_empty() {
            break;
        }
        taken = taken.iter().map(|place| place.map(|at| at / 2)).collect();
        full.clone_from(&joined);
        free = joined;
        cubes = whole;
        side *= 2;
    }
    leaves.sort_unstable_by_key(|cube| (lattice.key(cube.low), cube.copy));
    leaves
}
