//! Blocks of elements of many kinds that fit together: the cells of a lattice cut or joined at random.

use super::block::Block;
use super::random;
use crate::sim::IndexLists;

/// Uses of random numbers; 0 to 2 are the axes along which nodes move.
const WISH: u64 = 3;
const TURN: u64 = 4;

/// Two neighbouring squares in the plane stay two, become a hexagon, or a pentagon and a triangle. A square that stays
/// may be cut in two triangles. Pairs are staggered from row to row like bricks.
pub(super) fn cut_squares(block: &Block, seed: u32, elements: &mut IndexLists) {
    let [nx, ny, _] = block.cells;
    for y in 0..ny {
        let mut x = 0;
        while x < nx {
            let cell = [x, y, 0];
            let is_first = x % 2 == y % 2 && x + 1 < nx;
            let wish = random::unit(seed, block.node(cell).into(), WISH);
            if is_first && wish < 0.5 {
                join(block, seed, cell, wish < 0.2, elements);
                x += 2;
            } else {
                let square = block.square(cell);
                match random::hash(seed, block.node(cell).into(), TURN) % 4 {
                    turn @ (0 | 1) => halves(square, turn == 0).iter().for_each(|half| elements.push(half)),
                    _ => elements.push(&square),
                }
                x += 1;
            }
        }
    }
}

/// Joins two squares side by side: `whole` as a hexagon, else as a pentagon and a triangle, cut off at one of the four
/// outer corners. Both begin at a node that sees all their sides, the middle one of the lower or upper row.
fn join(block: &Block, seed: u32, [x, y, z]: [u32; 3], whole: bool, elements: &mut IndexLists) {
    let [a, b, e, f] = block.square([x, y, z]);
    let [_, c, d, _] = block.square([x + 1, y, z]);
    // Around: a b c below from left to right, d e f above from right to left.
    match random::hash(seed, block.node([x, y, z]).into(), TURN) % 4 {
        _ if whole => elements.push(&[b, c, d, e, f, a]),
        0 => [&[b, c, d, e, f][..], &[a, b, f]].iter().for_each(|part| elements.push(part)),
        1 => [&[b, d, e, f, a][..], &[b, c, d]].iter().for_each(|part| elements.push(part)),
        2 => [&[e, f, a, b, c][..], &[c, d, e]].iter().for_each(|part| elements.push(part)),
        _ => [&[e, a, b, c, d][..], &[e, f, a]].iter().for_each(|part| elements.push(part)),
    }
}

/// The element that a cube becomes, if its neighbours allow it.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Wish {
    /// A hexahedron.
    Whole,
    /// Two wedges along an axis, and the diagonal that separates them.
    Wedges(usize, bool),
    /// Pyramids and tetrahedra about the middle of the cube.
    Middle,
}

fn wish(block: &Block, seed: u32, cell: [u32; 3]) -> Wish {
    let index = block.node(cell).into();
    let turn = random::hash(seed, index, TURN);
    match random::unit(seed, index, WISH) {
        whole if whole < 0.6 => Wish::Whole,
        wedges if wedges < 0.9 => Wish::Wedges((turn >> 8) as usize % 3, turn.is_multiple_of(2)),
        _ => Wish::Middle,
    }
}

/// The diagonal of the face at the low end of a cell along an axis, if one of its two cells is to become wedges along
/// that axis. The lower cell takes precedence.
fn diagonal(block: &Block, seed: u32, axis: usize, cell: [u32; 3]) -> Option<bool> {
    let mut below = cell;
    below[axis] = below[axis].wrapping_sub(1);
    let sides = [(cell[axis] > 0).then_some(below), (cell[axis] < block.cells[axis]).then_some(cell)];
    sides.into_iter().flatten().find_map(|cell| match wish(block, seed, cell) {
        Wish::Wedges(along, diagonal) if along == axis => Some(diagonal),
        _ => None,
    })
}

/// The faces of a cube as indices of corners, counter-clockwise from outside: low and high along each axis. The
/// diagonal `true` joins the first and the third corner.
const FACES: [[[usize; 4]; 2]; 3] =
    [[[0, 4, 6, 2], [1, 3, 7, 5]], [[0, 1, 5, 4], [2, 6, 7, 3]], [[0, 2, 3, 1], [4, 5, 7, 6]]];

/// Cuts a cube in space into two wedges, or into pyramids and tetrahedra about a node in its middle, or leaves it
/// whole. Returns the corners of each cube with such a node. These nodes follow the nodes of the block in this order.
pub(super) fn cut_cubes(block: &Block, seed: u32, elements: &mut IndexLists) -> Vec<[u32; 8]> {
    let mut middles = Vec::new();
    for cell in block.each_cell() {
        cut_cube(block, seed, cell, &mut middles, elements);
    }
    middles
}

fn cut_cube(block: &Block, seed: u32, cell: [u32; 3], middles: &mut Vec<[u32; 8]>, elements: &mut IndexLists) {
    let corners = block.corners(cell);
    let diagonals: [[Option<bool>; 2]; 3] = std::array::from_fn(|axis| {
        let mut above = cell;
        above[axis] += 1;
        [cell, above].map(|cell| diagonal(block, seed, axis, cell))
    });
    let is_square = |axis: usize| diagonals[axis] == [None, None];
    if (0..3).all(is_square) && wish(block, seed, cell) != Wish::Middle {
        return elements.push(&corners);
    }
    for axis in 0..3 {
        if let [Some(low), Some(high)] = diagonals[axis]
            && low == high
            && (0..3).all(|other| other == axis || is_square(other))
        {
            for triangle in halves(FACES[axis][0], low) {
                // The order seen from inside, as on the other side of the cube.
                let [a, b, c] = [triangle[0], triangle[2], triangle[1]];
                elements.push(&[a, b, c, a | 1 << axis, b | 1 << axis, c | 1 << axis].map(|at| corners[at]));
            }
            return;
        }
    }
    let middle = block.len() as u32 + middles.len() as u32;
    middles.push(corners);
    for (faces, diagonals) in FACES.iter().zip(diagonals) {
        for (&face, diagonal) in faces.iter().zip(diagonals) {
            match diagonal {
                None => {
                    let [a, b, c, d] = face.map(|at| corners[at]);
                    elements.push(&[a, d, c, b, middle]);
                }
                Some(diagonal) => {
                    for triangle in halves(face, diagonal) {
                        let [a, b, c] = triangle.map(|at| corners[at]);
                        elements.push(&[a, c, b, middle]);
                    }
                }
            }
        }
    }
}

/// A square cut along one of its diagonals: `true` from its first corner.
pub(super) fn halves<T: Copy>([a, b, c, d]: [T; 4], diagonal: bool) -> [[T; 3]; 2] {
    if diagonal { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
}
