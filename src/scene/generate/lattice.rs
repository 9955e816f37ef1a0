//! Lattices of cells, whole or cut into triangles, tetrahedra or mixed elements.

use super::block::Block;
use super::{Made, irregular, mixed};
use crate::scene::file::{Cells, Lattice};
use crate::scene::limits::BodySize;
use crate::sim::IndexLists;

/// The largest size of a block. A block of mixed elements may be smaller, with middle nodes in fewer cells.
pub(super) fn size(typed: &Lattice) -> BodySize {
    let product = |extra: u128| typed.cells.iter().fold(1, |all: u128, &n| all.saturating_mul(u128::from(n) + extra));
    let (cells, is_flat) = (product(0), typed.cells.len() == 2);
    let (corners, pieces) = match typed.elements {
        Cells::Cells if is_flat => (4, 1),
        Cells::Cells => (8, 1),
        Cells::Triangles => (3, 2),
        Cells::Tetrahedra => (4, 5),
        Cells::Mixed if is_flat => (4, 2),
        // Twelve tetrahedra around the middle of each cube.
        Cells::Mixed => (4, 12),
    };
    let middles = if typed.elements == Cells::Mixed && !is_flat { cells } else { 0 };
    let size = BodySize::new(product(1).saturating_add(middles), [(corners, cells.saturating_mul(pieces))]);
    BodySize { is_bound: typed.elements == Cells::Mixed, ..size }
}

/// A lattice. In the plane its cells are squares or triangles, in space cubes or tetrahedra.
pub(super) fn make(typed: &Lattice) -> Made {
    let block = Block::new(typed);
    let mut elements = IndexLists::default();
    // The corners of cells with a node in their middle. These nodes follow the nodes at corners.
    let mut middles = Vec::new();
    match typed.elements {
        Cells::Cells if block.is_flat() => block.each_cell().for_each(|cell| elements.push(&block.square(cell))),
        Cells::Cells => block.each_cell().for_each(|cell| elements.push(&block.corners(cell))),
        Cells::Triangles => block.each_cell().for_each(|cell| triangles(&block, cell, &mut elements)),
        Cells::Tetrahedra => block.each_cell().for_each(|cell| tetrahedra(&block, cell, &mut elements)),
        Cells::Mixed if block.is_flat() => mixed::cut_squares(&block, typed.seed, &mut elements),
        Cells::Mixed => middles = mixed::cut_cubes(&block, typed.seed, &mut elements),
    }
    let mut nodes = block.nodes();
    for cell in &middles {
        nodes.push(irregular::middle(&nodes, cell));
    }
    if typed.irregular > 0.0 {
        irregular::disturb(typed, &mut nodes, &elements, &middles);
    }
    Made { nodes, elements }
}

/// Cuts a square in two. The diagonals of neighbours meet, so that no direction is preferred.
fn triangles(block: &Block, cell: [u32; 3], elements: &mut IndexLists) {
    let halves = mixed::halves(block.square(cell), (cell[0] + cell[1]).is_multiple_of(2));
    halves.iter().for_each(|half| elements.push(half));
}

/// Cuts a cube in five: one tetrahedron on four corners that are no neighbours, and one on each other corner.
/// Neighbouring cubes take the other four corners, so that their faces have the same diagonals.
fn tetrahedra(block: &Block, cell: [u32; 3], elements: &mut IndexLists) {
    const EVEN: [[usize; 4]; 5] = [[0, 3, 6, 5], [1, 3, 0, 5], [2, 0, 3, 6], [4, 5, 0, 6], [7, 3, 5, 6]];
    const ODD: [[usize; 4]; 5] = [[1, 2, 4, 7], [0, 1, 2, 4], [3, 2, 1, 7], [5, 1, 4, 7], [6, 4, 2, 7]];
    let corners = block.corners(cell);
    let parts = if cell.iter().sum::<u32>().is_multiple_of(2) { EVEN } else { ODD };
    parts.iter().for_each(|part| elements.push(&part.map(|at| corners[at])));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::file::{Positive, SideFile};
    use crate::sim::geometry::{bounds, kind, volume_by_faces};
    use crate::sim::{Body, Dimension, ElementKind, Solids};
    use glam::DVec3;
    use std::collections::BTreeMap;

    fn typed(cells: &[u32], elements: Cells, irregular: f64, seed: u32) -> Lattice {
        Lattice { cells: cells.to_vec(), side: SideFile::Equal(0.5), elements, irregular, seed }
    }

    fn plain(cells: &[u32]) -> Made {
        make(&typed(cells, Cells::Cells, 0.0, 1))
    }

    #[test]
    fn a_block_is_numbered_x_fastest_and_stands_on_the_ground() {
        let Made { nodes, elements } = plain(&[2, 1, 1]);
        assert_eq!(nodes.len(), 12);
        assert_eq!(nodes[0], DVec3::new(-0.5, 0.0, -0.25));
        assert_eq!(nodes[1], DVec3::new(0.0, 0.0, -0.25));
        assert_eq!(nodes[3], DVec3::new(-0.5, 0.5, -0.25));
        assert_eq!(nodes[11], DVec3::new(0.5, 0.5, 0.25));
        assert_eq!(&elements[1], [1, 2, 4, 5, 7, 8, 10, 11]);
    }

    /// Blocks of all kinds of pieces, even and uneven.
    fn blocks() -> Vec<Lattice> {
        let mut blocks = Vec::new();
        for irregular in [0.0, 0.1, 0.4] {
            for seed in [1, 2, 77] {
                for cells in [&[1, 1][..], &[2, 1], &[7, 4], &[1, 9]] {
                    for elements in [Cells::Cells, Cells::Triangles, Cells::Mixed] {
                        blocks.push(typed(cells, elements, irregular, seed));
                    }
                }
                for cells in [&[1, 1, 1][..], &[2, 1, 1], &[5, 4, 3], &[8, 8, 8]] {
                    for elements in [Cells::Cells, Cells::Tetrahedra, Cells::Mixed] {
                        blocks.push(typed(cells, elements, irregular, seed));
                    }
                }
            }
        }
        let thin = SideFile::PerAxis([1.0, 0.01, 0.1].map(Positive).to_vec());
        blocks.push(Lattice { side: thin, ..typed(&[6, 6, 6], Cells::Mixed, 0.4, 5) });
        blocks
    }

    #[test]
    fn the_pieces_fill_the_block_once_and_none_is_inside_out() {
        for typed in blocks() {
            let Made { nodes, elements } = make(&typed);
            let dimension = if typed.cells.len() == 2 { Dimension::Plane } else { Dimension::Space };
            let size =
                |element: &[u32]| volume_by_faces(kind(dimension, Solids::Ordered, element.len()), element, &nodes);
            let sizes: Vec<f64> = elements.iter().map(size).collect();
            let sides = Block::new(&typed).sides;
            let cell = sides.x * sides.y * if dimension == Dimension::Space { sides.z } else { 1.0 };
            let whole = cell * typed.cells.iter().map(|&cells| f64::from(cells)).product::<f64>();
            assert!((sizes.iter().sum::<f64>() / whole - 1.0).abs() < 1e-12, "{typed:?}");
            let least = sizes.iter().copied().fold(f64::INFINITY, f64::min) / cell;
            assert!(least > 1e-3, "{typed:?}: {least}");
            assert!(
                elements.iter().all(|nodes| kind(dimension, Solids::Ordered, nodes.len()) != ElementKind::Other),
                "{typed:?}"
            );
        }
    }

    #[test]
    fn the_pieces_fit_together_and_their_outside_is_that_of_the_block() {
        for typed in blocks() {
            let Made { nodes, elements } = make(&typed);
            let mut used = vec![false; nodes.len()];
            elements.indices().iter().for_each(|&node| used[node as usize] = true);
            assert!(used.iter().all(|&used| used), "{typed:?}");
            let (low, high) = bounds(&plain(&typed.cells).nodes);
            let scale = Block::new(&typed).sides / 0.5;
            let (low, high) = (low * scale, high * scale);
            if typed.cells.len() == 2 {
                // Every side of a single element lies on the outline.
                let mut sides: Vec<[u32; 2]> = elements.iter().flat_map(crate::sim::geometry::around).collect();
                sides.sort_unstable();
                assert!(sides.windows(2).all(|two| two[0] != two[1]), "{typed:?}");
                for &[a, b] in sides.iter().filter(|&&[a, b]| sides.binary_search(&[b, a]).is_err()) {
                    assert!(
                        on_the_outside([a, b].map(|node| nodes[node as usize]).as_slice(), low, high, 2),
                        "{typed:?}"
                    );
                }
            } else {
                let body = Body::builder(nodes).elements(elements).build().expect("a body");
                for (face, outer) in body.faces().nodes.iter().zip(&body.faces().outer) {
                    let corners: Vec<_> = face.iter().map(|&node| body.rest()[node as usize]).collect();
                    assert_eq!(on_the_outside(&corners, low, high, 3), outer.is_none(), "{typed:?}: {corners:?}");
                }
            }
        }
    }

    /// Whether points lie on one side of a box.
    fn on_the_outside(points: &[DVec3], low: DVec3, high: DVec3, axes: usize) -> bool {
        let on = |axis: usize, at: f64| points.iter().all(|point| (point[axis] - at).abs() < 1e-12);
        (0..axes).any(|axis| on(axis, low[axis]) || on(axis, high[axis]))
    }

    fn count_by_nodes(elements: &IndexLists) -> BTreeMap<usize, u128> {
        let mut counted = BTreeMap::new();
        elements.iter().for_each(|nodes| *counted.entry(nodes.len()).or_default() += 1);
        counted
    }

    #[test]
    fn a_block_is_no_larger_than_was_said_before() {
        for typed in blocks() {
            let Made { nodes, elements } = make(&typed);
            let (said, made) = (size(&typed), BodySize::new(nodes.len() as u128, count_by_nodes(&elements)));
            if typed.elements == Cells::Mixed {
                assert!(made.nodes <= said.nodes && made.count() <= said.count(), "{typed:?}");
                assert!(made.corners() <= said.corners(), "{typed:?}");
            } else {
                assert_eq!(said, made, "{typed:?}");
            }
        }
    }

    #[test]
    fn mixed_blocks_have_elements_of_every_kind() {
        let kinds = |cells: &[u32]| count_by_nodes(&make(&typed(cells, Cells::Mixed, 0.0, 1)).elements);
        let plane = kinds(&[12, 12]);
        assert!((3..=6).all(|corners| plane[&corners] >= 8), "{plane:?}");
        let space = kinds(&[6, 6, 6]);
        assert!([4, 5, 6, 8].iter().all(|corners| space[corners] >= 30), "{space:?}");
    }

    #[test]
    fn irregular_nodes_move_as_far_as_was_asked_for_and_no_farther() {
        for cells in [&[9, 9][..], &[9, 9, 9]] {
            let flat = plain(cells).nodes;
            let distances = |seed| -> Vec<f64> {
                let moved = make(&typed(cells, Cells::Cells, 0.2, seed)).nodes;
                moved.iter().zip(&flat).map(|(a, b)| a.distance(*b) / 0.5).collect()
            };
            let one = distances(1);
            let farthest = one.iter().copied().fold(0.0, f64::max);
            assert!(farthest <= 0.2 && farthest > 0.15, "{farthest}");
            assert_ne!(one, distances(2));
            // Corners stay, and others along edges and sides do not.
            assert_eq!((one[0], one[9], one[one.len() - 1]), (0.0, 0.0, 0.0));
            assert!(one[1] > 0.0 && one[20] > 0.0);
        }
    }
}
