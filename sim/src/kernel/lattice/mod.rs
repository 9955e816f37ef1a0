//! One fused step of the shape model on a lattice of equal boxes.
//!
//! Gather, moments, rotations, forces, motion and contact are one pass over the planes of nodes, in place. It is fast
//! for these reasons, with `R0` the corners of a box at rest, `Σ R0 = 0`:
//!
//! - `A = Σ r R0ᵀ` needs no centre: its columns are the sums of the four edges along each axis, times half the side.
//! - With `w = k P + D V` and `w̄` its mean over a box, Eq. (4) is `−w + w̄ + k M R0`. The sum of `−w` over the boxes of a
//!   node is a product; `w̄ + k M R0` is `w̄ ± u ± v ± t` with one vector for each axis.
//! - Both are separable: sums over two nodes or boxes along z, then along x, then along y; for forces in reverse order.
//! - The linear map that fits a box best is `F = A M⁻¹`, and `M` is diagonal: its columns are sums of edges, too. So bending `β` and an
//!   energy of the volume change `u`, `v` and `t` only, with `w = β k P + D V`.
//! - Damping that leaves rotation `ω` alone has the force `D ω × (p − p̄)` in addition: one part of it is in `w̄`, and the other is
//!   `(Σ D ω) × p`, with a sum over the boxes of a node. The sums over corners that `ω` follows from are those over the differences of
//!   nodes along z, then of sums and differences along x, then of sums along y: without centre, and without cancellation.
//!
//! Nodes of a plane are numbered x fastest, and lanes are consecutive nodes. Boxes have the number of their lowest
//! node; the last node of a row counts as a box without stiffness, so rows need no padding.
//!
//! Each node adds up its boxes as `(those below) + (those above)` along z, so threads can share the planes: where the
//! planes of two threads meet, each computes its own term.

#![expect(unsafe_code, reason = "the innermost loops read and write lanes without bounds checks")]

mod sweep;
#[cfg(test)]
mod tests;

use super::memory::Aligned;
use super::stepper::{Passes, Scheme, Stepper};
use super::{Around, Lost, Rotation, damped};
use crate::body::Body;
use crate::crew::Crew;
use crate::element::Dimension;
use crate::lanes::{MOST, Set};
use crate::tally::Tally;
use glam::DVec3;
use std::ops::Range;
use std::sync::atomic::AtomicU64;

/// The constants of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parameters {
    /// Elastic constant `k_e` of each element (N/m).
    pub(crate) stiffness: f64,
    /// The factor `β` of the part of displacements that is not affine.
    pub(crate) bending: f64,
    /// `λ/μ` of the energy of the volume.
    pub(crate) volume: f64,
    /// Damping constant `D_e` of each element (N s/m).
    pub(crate) damping: f64,
    /// The velocity that is [damped].
    pub(crate) damped: u8,
    /// How rotations are computed.
    pub(crate) rotation: Rotation,
    /// ΔT (s).
    pub(crate) step: f64,
}

/// The dimensions of a lattice of equal boxes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Grid {
    /// Boxes along x, y and z.
    cells: [usize; 3],
    /// The sides of a box (m).
    sides: DVec3,
}

impl Grid {
    /// `None` for any other body, and for one whose elements are filled in part or differ in stiffness.
    fn of(body: &Body) -> Option<Self> {
        /// Relative to the sides.
        const EQUAL: f64 = 1e-12;
        let first = body.elements.iter().next().filter(|nodes| nodes.len() == 8)?;
        let (row, layer) = (first[2] as usize, first[4] as usize);
        if body.dimension != Dimension::Space
            || body.fill.is_some()
            || body.stiffness.is_some()
            || row < 2
            || layer < 2 * row
            || !layer.is_multiple_of(row)
            || !body.len().is_multiple_of(layer)
        {
            return None;
        }
        let cells = [row - 1, layer / row - 1, body.len() / layer - 1];
        let count = cells.iter().product::<usize>();
        if count != body.elements.len() || count == 0 {
            return None;
        }
        let extent = body.rest[body.len() - 1] - body.rest[0];
        let sides = extent / DVec3::from_array(cells.map(|cells| cells as f64));
        let grid = Self { cells, sides };
        let farthest = body.rest.iter().fold(0.0, |farthest: f64, node| farthest.max(node.abs().max_element()));
        let tolerance = EQUAL * sides.max_element() + 4.0 * f64::EPSILON * farthest;
        let corner = |bits: usize| sides * DVec3::from_array([0, 1, 2].map(|axis| (bits >> axis & 1) as f64));
        let is_equal = |(element, nodes): (usize, &[u32])| {
            let [x, y, z] = grid.place(element);
            let low = x + row * y + layer * z;
            nodes.len() == 8
                && nodes.iter().enumerate().all(|(bits, &node)| {
                    let node = node as usize;
                    node == low + (bits & 1) + row * (bits >> 1 & 1) + layer * (bits >> 2)
                        && (body.rest[node] - body.rest[low] - corner(bits)).abs().max_element() <= tolerance
                })
        };
        (sides.min_element() > 0.0 && body.elements.iter().enumerate().all(is_equal)).then_some(grid)
    }

    /// The position of an element in the lattice.
    fn place(&self, element: usize) -> [usize; 3] {
        let [x, y, _] = self.cells;
        [element % x, element / x % y, element / (x * y)]
    }

    /// Nodes in a row.
    fn row(&self) -> usize {
        self.cells[0] + 1
    }

    /// Nodes in a plane.
    fn layer(&self) -> usize {
        self.row() * (self.cells[1] + 1)
    }

    /// Boxes in a plane, including the ends of all rows but the last.
    fn boxes(&self) -> usize {
        self.row() * self.cells[1] - 1
    }

    /// Nodes from one plane to the next: whole vectors, and enough padding for reads of the last box, which reach one
    /// row and two vectors ahead.
    fn stride(&self) -> usize {
        (self.box_stride() + self.row() + 2 * MOST).next_multiple_of(MOST)
    }

    /// Number of boxes in the ring buffer of rows: a chunk, and more than a row.
    fn ring(&self) -> usize {
        CHUNK + (self.row() + 2 * MOST).next_multiple_of(MOST)
    }

    /// Boxes from one plane to the next.
    fn box_stride(&self) -> usize {
        self.boxes().next_multiple_of(MOST)
    }
}

/// The numbers of each node: position, velocity, `1/m`, and with velocity Verlet the acceleration, with compositions the velocity at the
/// start of the step.
const VELOCITY: usize = 3;
const INVERSE_MASS: usize = 6;
const ACCELERATION: usize = 7;

/// Boxes in a chunk, which are gathered, then rotated, then used for forces: enough for independent work in each of
/// these loops, and few enough that the data between them stay in the first-level cache. A multiple of [`MOST`].
const CHUNK: usize = 64;

/// The index of the first number of a node or box that has `parts` numbers. A number is stored for [`MOST`] neighbours,
/// then the next number for them. So the numbers of a vector have fixed distances, which suits prefetching.
#[inline(always)]
fn slot(at: usize, parts: usize) -> usize {
    at / MOST * MOST * parts + at % MOST
}

/// The positions of `w̄` and of the rotation in a [`Chunk`].
const MEAN: usize = 9;
const TURN: usize = 12;

/// The steps of a lattice of equal boxes.
#[derive(Clone)]
pub(crate) struct LatticeStepper {
    set: Set,
    grid: Grid,
    parameters: Parameters,
    /// Count of numbers for each node.
    parts: usize,
    /// The numbers of the nodes, plane after plane; see [`slot`].
    nodes: Aligned,
    /// Where the first number of each node is.
    places: Box<[u32]>,
    /// The rotations of the boxes (x, y, z, w), plane after plane; see [`slot`].
    turns: Aligned,
    /// Copies of `nodes` and `turns`.
    kept: [Aligned; 2],
    tally: Tally,
    pattern: Pattern,
    /// The buffers of all threads; see [`Slab`].
    slabs: Aligned,
    /// The progress of each thread.
    signals: Box<[Signal]>,
}

/// Data that all planes share.
#[derive(Clone)]
struct Pattern {
    /// 1 for a box, 0 for the end of a row.
    live: Aligned,
    /// The number of boxes of a plane that a node belongs to.
    valence: Aligned,
}

/// Offsets in the buffers of a thread, which steps consecutive planes of boxes and the nodes below them.
///
/// The plane of nodes between the boxes of two threads belongs to the upper thread. Each thread writes the forces of
/// its boxes there; when both have, the upper thread steps these nodes.
#[derive(Clone, Copy)]
struct Slab {
    /// A ring buffer of boxes: `w̄ + v`, `u`, `t` and `D ω`.
    rows: usize,
    /// A ring buffer of squares of nodes along x and z; see [`Sweep::squares`].
    squares: usize,
    /// The forces of the boxes below a plane on its nodes (N).
    below: usize,
    /// The forces of the lowest boxes on the nodes below them (N).
    lowest: usize,
    /// The forces of the highest boxes on the nodes above them (N).
    highest: usize,
    /// The start of the buffers of the next thread.
    end: usize,
}

impl Slab {
    fn new(grid: &Grid) -> Self {
        let plane = 3 * grid.stride();
        let squares = 12 * (grid.ring() + MOST);
        let below = squares + 21 * (grid.ring() + MOST);
        let (lowest, highest) = (below + plane, below + 2 * plane);
        // Threads share no cache line, and no pair of lines that a processor fetches together.
        Self { rows: 0, squares, below, lowest, highest, end: highest + plane + 2 * MOST }
    }
}

/// The data of a chunk of boxes between loops: nine numbers of intermediate results, `w̄`, and the new rotation.
/// Aligned to cache lines.
///
/// It is on the stack because a function with such an aligned variable also aligns the vectors that it spills to the
/// stack. Otherwise each of them would cross two lines.
#[repr(C, align(64))]
struct Chunk([f64; 16 * CHUNK]);

/// The progress of a thread, in its own cache line.
#[derive(Default)]
#[repr(align(128))]
struct Signal {
    /// Passes in which its boxes have been read and their forces written.
    pulled: AtomicU64,
    /// Passes in which the nodes that it shares with the thread below have been moved.
    shared: AtomicU64,
}

/// Between runs there is no progress.
impl Clone for Signal {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl LatticeStepper {
    /// `None` if the body is not a full lattice of equal boxes, numbered x fastest.
    pub(crate) fn new(body: &Body, parameters: Parameters, scheme: Scheme, set: Set) -> Option<Self> {
        let grid = Grid::of(body)?;
        let (stride, row) = (grid.stride(), grid.row());
        let [_, rows, planes] = grid.cells;
        let parts = if scheme.keeps_acceleration() { 10 } else { 7 };
        let [nodes, turns] = [(planes + 1) * parts * stride, planes * 4 * grid.box_stride()];
        let kept = [nodes, turns].map(Aligned::zeros);
        let [mut nodes, turns] = [nodes, turns].map(Aligned::zeros);
        let place = |node: usize| slot(node / grid.layer() * stride + node % grid.layer(), parts) as u32;
        let places: Box<[u32]> = (0..body.len()).map(place).collect();
        for (&place, &mass) in places.iter().zip(&body.mass) {
            nodes.as_mut_slice()[place as usize + INVERSE_MASS * MOST] = mass.recip();
        }
        let mut pattern = Pattern { live: Aligned::zeros(grid.box_stride()), valence: Aligned::zeros(stride) };
        let live = pattern.live.as_mut_slice();
        (0..grid.boxes()).filter(|at| at % row != row - 1).for_each(|at| live[at] = 1.0);
        for (at, valence) in pattern.valence.as_mut_slice()[..grid.layer()].iter_mut().enumerate() {
            let edge = |at: usize, cells: usize| if at == 0 || at == cells { 1.0 } else { 2.0 };
            *valence = edge(at % row, row - 1) * edge(at / row, rows);
        }
        let (slabs, signals, tally) = (Aligned::zeros(0), Box::default(), Tally::default());
        Some(Self { set, grid, parameters, parts, nodes, places, turns, kept, tally, pattern, slabs, signals })
    }

    /// The index in `nodes` of the first number of a node.
    fn index(&self, node: usize) -> usize {
        self.places[node] as usize
    }

    fn turn_index(&self, element: usize) -> usize {
        let [x, y, z] = self.grid.place(element);
        slot(z * self.grid.box_stride() + x + y * self.grid.row(), 4)
    }
}

impl Stepper for LatticeStepper {
    fn load(&mut self, position: &[DVec3], velocity: &[DVec3], memory: &[f64]) {
        self.place(position, velocity);
        // The ends of rows have a rotation, too, which has no effect.
        for (at, turn) in self.turns.as_mut_slice().iter_mut().enumerate() {
            *turn = if at / MOST % 4 == 3 { 1.0 } else { 0.0 };
        }
        for (element, turn) in memory.chunks_exact(4).enumerate() {
            let at = self.turn_index(element);
            let turns = self.turns.as_mut_slice();
            (0..4).for_each(|part| turns[at + part * MOST] = turn[part]);
        }
        self.tally.load(memory.chunks_exact(4).remainder().first());
    }

    fn store(&mut self, position: &mut [DVec3], velocity: &mut [DVec3], memory: &mut [f64]) {
        self.read(position, velocity);
        for (element, turn) in memory.chunks_exact_mut(4).enumerate() {
            let at = self.turn_index(element);
            let turns = self.turns.as_mut_slice();
            (0..4).for_each(|part| turn[part] = turns[at + part * MOST]);
        }
        self.tally.store(memory.chunks_exact_mut(4).into_remainder().first_mut());
    }

    #[inline]
    fn node(&mut self, node: usize) -> (DVec3, DVec3) {
        let at = self.index(node);
        let nodes = self.nodes.as_mut_slice();
        let vector = |first: usize| DVec3::from_array([0, 1, 2].map(|axis| nodes[at + (first + axis) * MOST]));
        (vector(0), vector(VELOCITY))
    }

    #[inline]
    fn set_node(&mut self, node: usize, position: DVec3, velocity: DVec3) {
        let at = self.index(node);
        let nodes = self.nodes.as_mut_slice();
        for axis in 0..3 {
            nodes[at + axis * MOST] = position[axis];
            nodes[at + (VELOCITY + axis) * MOST] = velocity[axis];
        }
    }

    fn is_damped(&self) -> bool {
        self.parameters.damped != damped::NONE
    }

    fn copy(&self) -> Box<dyn Stepper> {
        Box::new(self.clone())
    }

    fn keep(&mut self) {
        let [nodes, turns] = &mut self.kept;
        nodes.copy_from(&mut self.nodes);
        turns.copy_from(&mut self.turns);
        self.tally.keep();
    }

    fn restore(&mut self) {
        let [nodes, turns] = &mut self.kept;
        self.nodes.copy_from(nodes);
        self.turns.copy_from(turns);
        self.tally.restore();
    }

    fn run(&mut self, passes: Passes, some: Range<u64>, around: &Around<'_>, crew: &Crew) -> Option<Lost> {
        sweep::run(self, passes, some, around, crew)
    }
}
