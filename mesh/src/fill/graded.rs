//! The cubes of cells, which may be coarser away from the surface.
//!
//! Where they may, eight cells without surface are joined to one cube. It lists the nodes of smaller neighbours that hang in the middles of its
//! faces and edges: to the shape model they are nodes like others. The surface is in the smaller cubes alone, where its weights are
//! those of plain cubes.
//!
//! Cubes are not joined again: their mass is in their corners, so that the moment of inertia would be too large by a part that does not
//! fall with the size of cells. Hanging nodes carry what they would carry among cells, so that the centre of mass stays.

use super::draft::Nodes;
use super::lattice::{CORNERS, Cell, Lattice, corner};
use super::parts::{Parts, Scene};
use glam::DVec3;
use localshape_sim::IndexLists;
use std::collections::HashMap;

/// A cube of one cell, or of several that are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Cube {
    /// The lowest cell, and the number of cells along a side.
    low: Cell,
    side: u32,
    /// The copy of the lowest cell.
    copy: u32,
}

impl Cube {
    /// A place (m) in halves of the side from the lowest corner.
    fn place(&self, lattice: &Lattice, at: Cell) -> DVec3 {
        lattice.place(corner([0, 1, 2].map(|axis| self.low[axis] + at[axis] * self.side / 2)))
    }
}

/// Elements made of copies, the part of each that is inside, and the element of each copy that touches the surface.
#[derive(Default)]
pub(super) struct Graded {
    pub(super) elements: IndexLists,
    pub(super) filled: Vec<f64>,
    pub(super) element_of: Vec<u32>,
    /// The volume inside that each node carries, in cells, if they are graded.
    pub(super) volumes: Option<Vec<f64>>,
}

/// Makes a cube of each copy, with some joined if they are graded.
pub(super) fn joined(scene: &Scene, parts: &Parts, is_graded: bool, nodes: &mut Nodes) -> Graded {
    let lattice = scene.lattice;
    let cubes = leaves(scene, parts, is_graded);
    // All corners of cubes are nodes.
    let mut is_node = vec![false; parts.corners.len()];
    let set = |cube: &Cube, at: Cell| set(lattice, parts, cube, at);
    for cube in &cubes {
        for corner in CORNERS {
            is_node[set(cube, corner.map(|end| 2 * end)) as usize] = true;
        }
    }
    let mut graded = Graded { element_of: vec![0; parts.copies.len()], ..Graded::default() };
    for cube in &cubes {
        let mut own = Vec::with_capacity(8);
        let mut push = |at: Cell| {
            let set = set(cube, at);
            if is_node[set as usize] {
                own.push(nodes.of(set as usize, || cube.place(lattice, at)));
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
    graded.volumes = is_graded.then(|| volumes(lattice, parts, &cubes, &is_node, nodes));
    graded
}

/// The volume inside that each node carries, in cells.
fn volumes(lattice: &Lattice, parts: &Parts, cubes: &[Cube], is_node: &[bool], nodes: &mut Nodes) -> Vec<f64> {
    let mut volumes = vec![0.0; nodes.places.len()];
    let set = |cube: &Cube, at: Cell| set(lattice, parts, cube, at);
    for cube in cubes {
        let mut add = |at: Cell, volume: f64| {
            volumes[nodes.of(set(cube, at) as usize, || cube.place(lattice, at)) as usize] += volume;
        };
        if cube.side == 1 {
            let own = parts.copies[cube.copy as usize].filled / 8.0;
            CORNERS.iter().for_each(|corner| add(corner.map(|end| 2 * end), own));
            continue;
        }
        // Each cell has its volume in its corners. What is no node has it in the corners of the cube around it.
        for at in (0..27).map(|at| [at % 3, at / 3 % 3, at / 9]) {
            let own: f64 = at.iter().map(|&at| if at == 1 { 1.0 } else { 0.5 }).product();
            let is_around = |end: &Cell| (0..3).all(|axis| at[axis] == 1 || 2 * end[axis] == at[axis]);
            let ends: Vec<Cell> =
                CORNERS.iter().filter(|end| is_around(end)).map(|end| end.map(|end| 2 * end)).collect();
            match is_node[set(cube, at) as usize] {
                true => add(at, own),
                false => ends.iter().for_each(|&end| add(end, own / ends.len() as f64)),
            }
        }
    }
    volumes
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
fn leaves(scene: &Scene, parts: &Parts, is_graded: bool) -> Vec<Cube> {
    let lattice = scene.lattice;
    let block = |cell: Cell| lattice.key(cell.map(|at| at / 2));
    let mut touched = scene.pieces.iter().map(|piece| piece.cell).peekable();
    let mut free: HashMap<u64, u32> = HashMap::new();
    for full in parts.copies.iter().filter(|_| is_graded) {
        while touched.next_if(|&cell| cell < full.cell).is_some() {}
        if touched.peek() != Some(&full.cell) {
            *free.entry(block(lattice.cell(full.cell))).or_default() += 1;
        }
    }
    let cubes = parts.copies.iter().zip(0..).filter_map(|(full, copy)| {
        let low = lattice.cell(full.cell);
        if free.get(&block(low)) != Some(&8) {
            return Some(Cube { low, side: 1, copy });
        }
        low.iter().all(|at| at % 2 == 0).then_some(Cube { low, side: 2, copy })
    });
    cubes.collect()
}
