//! One fused step of the shape model on a lattice of equal boxes.
//!
//! Gather, moments, rotations, forces, motion and contact are one pass over the planes of nodes, in place. It is fast
//! for these reasons, with `R0` the corners of a box at rest, `Σ R0 = 0`:
//!
//! - `A = Σ r R0ᵀ` needs no centre: its columns are the sums of the four edges along each axis, times half the side.
//! - With `w = k P + D V` and `w̄` its mean over a box, Eq. (4) is `−w + w̄ + k M R0`. The sum of `−w` over the boxes of a
//!   node is a product; `w̄ + k M R0` is `w̄ ± u ± v ± t` with one vector for each axis.
//! - Both are separable: sums over two nodes or boxes along z, then along x, then along y; for forces in reverse order.
//!
//! Nodes of a plane are numbered x fastest, and lanes are consecutive nodes. Boxes have the number of their lowest
//! node; the last node of a row counts as a box without stiffness, so rows need no padding.
//!
//! Each node adds up its boxes as `(those below) + (those above)` along z, so threads can share the planes: where the
//! planes of two threads meet, each computes its own term.

#![expect(unsafe_code, reason = "the innermost loops read and write lanes without bounds checks")]

use super::memory::Aligned;
use super::motion::{Motion, Nodes, Stage};
use super::rotation::{Arctangent, Optimum, Solver, choose, matrix, turn, turned_back};
use super::stepper::{Pass, Passes, Scheme, Stepper};
use super::{Around, Lost, Rotation};
use crate::sim::body::{Body, Dimension};
use crate::sim::crew::{Crew, wait_until};
use crate::sim::lanes::{Lanes, MOST, Set, Work, each, thrice};
use glam::DVec3;
use std::mem::MaybeUninit;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// The constants of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::sim) struct Parameters {
    /// Elastic constant `k_e` of each element (N/m).
    pub(in crate::sim) stiffness: f64,
    /// Damping constant `D_e` of each element (N s/m), for the velocity relative to the element's mean.
    pub(in crate::sim) damping: f64,
    /// How rotations are computed.
    pub(in crate::sim) rotation: Rotation,
    /// Acceleration of gravity (m/s²).
    pub(in crate::sim) gravity: DVec3,
    /// ΔT (s).
    pub(in crate::sim) step: f64,
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
    /// `None` for any other body.
    fn of(body: &Body) -> Option<Self> {
        /// Relative to the sides.
        const EQUAL: f64 = 1e-12;
        let first = body.elements.iter().next().filter(|nodes| nodes.len() == 8)?;
        let (row, layer) = (first[2] as usize, first[4] as usize);
        if body.dimension != Dimension::Space
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

/// The numbers of each node: position, velocity, `1/m`, and with velocity Verlet the acceleration.
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
pub(in crate::sim) struct Lattice {
    set: Set,
    grid: Grid,
    parameters: Parameters,
    /// Count of numbers for each node.
    parts: usize,
    /// The numbers of the nodes, plane after plane; see [`slot`].
    nodes: Aligned,
    /// The rotations of the boxes (x, y, z, w), plane after plane; see [`slot`].
    turns: Aligned,
    /// Copies of `nodes` and `turns`.
    kept: [Aligned; 2],
    pattern: Pattern,
    /// The buffers of all threads; see [`Slab`].
    slabs: Aligned,
    /// The progress of each thread.
    signals: Box<[Signal]>,
}

/// Data that are the same for all planes.
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
    /// A ring buffer of boxes: `w̄ + v`, `u` and `t`.
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
        let squares = 9 * (grid.ring() + MOST);
        let below = squares + 12 * (grid.ring() + MOST);
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

impl Lattice {
    /// `None` if the body is not a full lattice of equal boxes, numbered x fastest.
    pub(in crate::sim) fn new(body: &Body, parameters: Parameters, scheme: Scheme, set: Set) -> Option<Self> {
        let grid = Grid::of(body)?;
        let (stride, row) = (grid.stride(), grid.row());
        let [_, rows, planes] = grid.cells;
        let parts = if scheme == Scheme::VelocityVerlet { 10 } else { 7 };
        let [nodes, turns] = [(planes + 1) * parts * stride, planes * 4 * grid.box_stride()];
        let kept = [nodes, turns].map(Aligned::zeros);
        let [mut nodes, turns] = [nodes, turns].map(Aligned::zeros);
        for (node, &mass) in body.mass.iter().enumerate() {
            let (plane, at) = (node / grid.layer(), node % grid.layer());
            nodes.as_mut_slice()[slot(plane * stride + at, parts) + INVERSE_MASS * MOST] = mass.recip();
        }
        let mut pattern = Pattern { live: Aligned::zeros(grid.box_stride()), valence: Aligned::zeros(stride) };
        let live = pattern.live.as_mut_slice();
        (0..grid.boxes()).filter(|at| at % row != row - 1).for_each(|at| live[at] = 1.0);
        for (at, valence) in pattern.valence.as_mut_slice()[..grid.layer()].iter_mut().enumerate() {
            let edge = |at: usize, cells: usize| if at == 0 || at == cells { 1.0 } else { 2.0 };
            *valence = edge(at % row, row - 1) * edge(at / row, rows);
        }
        let (slabs, signals) = (Aligned::zeros(0), Box::default());
        Some(Self { set, grid, parameters, parts, nodes, turns, kept, pattern, slabs, signals })
    }

    /// The index in `nodes` of the first number of a node.
    fn index(&self, node: usize) -> usize {
        slot(node / self.grid.layer() * self.grid.stride() + node % self.grid.layer(), self.parts)
    }

    fn turn_index(&self, element: usize) -> usize {
        let [x, y, z] = self.grid.place(element);
        slot(z * self.grid.box_stride() + x + y * self.grid.row(), 4)
    }
}

impl Stepper for Lattice {
    fn load(&mut self, position: &[DVec3], velocity: &[DVec3], memory: &[f64]) {
        for (node, (&position, &velocity)) in position.iter().zip(velocity).enumerate() {
            self.set_node(node, position, velocity);
        }
        // The ends of rows have a rotation, too, which has no effect.
        for (at, turn) in self.turns.as_mut_slice().iter_mut().enumerate() {
            *turn = if at / MOST % 4 == 3 { 1.0 } else { 0.0 };
        }
        for (element, turn) in memory.chunks_exact(4).enumerate() {
            let at = self.turn_index(element);
            let turns = self.turns.as_mut_slice();
            (0..4).for_each(|part| turns[at + part * MOST] = turn[part]);
        }
    }

    fn store(&mut self, position: &mut [DVec3], velocity: &mut [DVec3], memory: &mut [f64]) {
        for (node, (position, velocity)) in position.iter_mut().zip(velocity).enumerate() {
            (*position, *velocity) = self.node(node);
        }
        for (element, turn) in memory.chunks_exact_mut(4).enumerate() {
            let at = self.turn_index(element);
            let turns = self.turns.as_mut_slice();
            (0..4).for_each(|part| turn[part] = turns[at + part * MOST]);
        }
    }

    fn node(&mut self, node: usize) -> (DVec3, DVec3) {
        let at = self.index(node);
        let nodes = self.nodes.as_mut_slice();
        let vector = |first: usize| DVec3::from_array([0, 1, 2].map(|axis| nodes[at + (first + axis) * MOST]));
        (vector(0), vector(VELOCITY))
    }

    fn set_node(&mut self, node: usize, position: DVec3, velocity: DVec3) {
        let at = self.index(node);
        let nodes = self.nodes.as_mut_slice();
        for axis in 0..3 {
            nodes[at + axis * MOST] = position[axis];
            nodes[at + (VELOCITY + axis) * MOST] = velocity[axis];
        }
    }

    fn is_damped(&self) -> bool {
        self.parameters.damping > 0.0
    }

    fn keep(&mut self) {
        let [nodes, turns] = &mut self.kept;
        nodes.copy_from(&mut self.nodes);
        turns.copy_from(&mut self.turns);
    }

    fn restore(&mut self) {
        let [nodes, turns] = &mut self.kept;
        self.nodes.copy_from(nodes);
        self.turns.copy_from(turns);
    }

    /// Uses at most as many threads of the crew as there are planes of boxes along z.
    fn run(&mut self, passes: Passes, some: Range<u64>, around: &Around<'_>, crew: &mut Crew) -> Option<Lost> {
        let Self { set, grid, parameters, parts, nodes, turns, pattern, slabs, signals, kept: _ } = self;
        if some.is_empty() {
            return None;
        }
        let Parameters { stiffness, damping, rotation, gravity, step } = *parameters;
        let side = grid.sides.element_sum() / 3.0;
        let ratio = (grid.sides / side).to_array();
        let members = crew.threads().min(grid.cells[2]);
        if signals.len() < members {
            *slabs = Aligned::zeros(members * Slab::new(grid).end);
            *signals = (0..members).map(|_| Signal::default()).collect();
        }
        for signal in &mut **signals {
            *signal = Signal::default();
        }
        let stop = AtomicBool::new(false);
        let sweep = Sweep {
            nodes: nodes.pointer(),
            turns: turns.pointer(),
            live: pattern.live.pointer(),
            valence: pattern.valence.pointer(),
            slabs: slabs.pointer(),
            slab: Slab::new(grid),
            work: std::ptr::null_mut(),
            grid: *grid,
            stride: grid.stride(),
            box_stride: grid.box_stride(),
            ring: grid.ring(),
            stiffness,
            damping,
            ratio,
            is_cube: ratio == [1.0; 3],
            // The columns of `A` at rest have length 2 side²; the factor side / 2 is left out.
            scale: 1.0 / (4.0 * side),
            half: 0.5 * side * stiffness,
            gravity,
            step,
            parts: *parts,
            around,
            passes,
            some: [some.start, some.end],
            member: 0,
            members,
            signals,
            stop: &stop,
        };
        let lost = Mutex::new(None);
        let work = |member: usize| {
            if member >= members {
                return;
            }
            // Other threads wait for this one; the guard ends their wait if it panics.
            let _guard = StopOnPanic(&stop);
            let mut found = None;
            // SAFETY: each thread has its own buffers.
            let slabs = unsafe { sweep.slabs().add(member * sweep.slab.end) };
            let sweep = Sweep { member, slabs, ..sweep };
            macro_rules! run {
                ($damped:literal) => {
                    match rotation {
                        Rotation::Optimum => set.run(Solved::<_, $damped>(&sweep, Optimum, &mut found)),
                        Rotation::Arctangent { passes } => {
                            set.run(Solved::<_, $damped>(&sweep, Arctangent { passes }, &mut found));
                        }
                    }
                };
            }
            if damping > 0.0 {
                run!(true)
            } else {
                run!(false)
            }
            if let Some(found) = found {
                *lost.lock().unwrap_or_else(PoisonError::into_inner) = Some(found);
            }
        };
        if members == 1 {
            work(0)
        } else {
            crew.run(&work)
        }
        lost.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

struct StopOnPanic<'a>(&'a AtomicBool);

impl Drop for StopOnPanic<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.store(true, Ordering::Relaxed);
        }
    }
}

/// Everything that a sweep reads and writes. See the fields of the same name.
///
/// A sweep works on its own copy, whose address does not escape: otherwise the compiler would have to assume that every
/// store can change it.
#[derive(Clone, Copy)]
struct Sweep<'a> {
    nodes: *mut f64,
    turns: *mut f64,
    live: *const f64,
    valence: *const f64,
    /// The buffers of this thread.
    slabs: *mut f64,
    slab: Slab,
    /// A [`Chunk`].
    work: *mut f64,
    grid: Grid,
    stride: usize,
    box_stride: usize,
    ring: usize,
    stiffness: f64,
    damping: f64,
    /// The sides divided by their mean.
    ratio: [f64; 3],
    is_cube: bool,
    /// Scales sums of edges to about 1.
    scale: f64,
    /// Half the mean side, times the stiffness (N).
    half: f64,
    gravity: DVec3,
    step: f64,
    parts: usize,
    around: &'a Around<'a>,
    passes: Passes,
    /// The passes to be executed: from the first number up to, not including, the second.
    some: [u64; 2],
    /// The number of this thread.
    member: usize,
    members: usize,
    signals: &'a [Signal],
    /// Set when a thread has panicked or found a node that is too fast.
    stop: &'a AtomicBool,
}

// SAFETY: threads write to their own planes, and read those of others only when `Signal` allows it.
unsafe impl Sync for Sweep<'_> {}

/// A sweep with a solver, with or without damping.
struct Solved<'a, 'b, S, const DAMPED: bool>(&'a Sweep<'b>, S, &'a mut Option<Lost>);

impl<S: Solver, const DAMPED: bool> Work for Solved<'_, '_, S, DAMPED> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self(&sweep, solver, found) = self;
        let mut chunk = MaybeUninit::<Chunk>::uninit();
        let sweep = Sweep { work: chunk.as_mut_ptr().cast(), ..sweep };
        if sweep.passes.scheme == Scheme::SemiImplicitEuler {
            // Compiled separately with a constant scheme.
            let passes = Passes { scheme: Scheme::SemiImplicitEuler, ..sweep.passes };
            Sweep { passes, ..sweep }.passes::<L, S, DAMPED>(solver, found);
        } else {
            sweep.passes::<L, S, DAMPED>(solver, found);
        }
    }
}

impl Sweep<'_> {
    /// Executes all passes of `some`.
    #[inline(always)]
    fn passes<L: Lanes, S: Solver, const DAMPED: bool>(&self, solver: S, found: &mut Option<Lost>) {
        let [first, end] = self.some;
        for pass in 0..end - first {
            let Pass { stage, number, commit } = self.passes.get(first + pass);
            let motion = Motion::<L>::new(stage, self.step, self.gravity, number, *self.around);
            // SAFETY: the arrays belong to a lattice, all to this grid, and are accessed by no one but the other
            // threads.
            let bad = unsafe {
                if stage == Stage::Coast {
                    self.coast::<L>(pass, &motion)
                } else {
                    self.pass::<L, S, DAMPED>(pass, &motion, solver, commit)
                }
            };
            if let Some(node) = bad {
                *found = Some(Lost { step: number, node });
                self.stop.store(true, Ordering::Relaxed);
            }
            if self.stop.load(Ordering::Relaxed) {
                return;
            }
        }
    }

    #[inline(always)]
    fn slabs(&self) -> *mut f64 {
        self.slabs
    }

    /// A pointer to the first number of a vector of nodes; the others follow at distances of [`MOST`].
    #[inline(always)]
    unsafe fn nodes(&self, plane: usize, at: usize) -> *mut f64 {
        // SAFETY: the caller passes an existing plane and less than a stride.
        unsafe { self.nodes.add(slot(plane * self.stride + at, self.parts)) }
    }

    /// The index of a place in a ring buffer with so many parts, and the distance between parts. Where a vector is a
    /// cache line, all parts of a vector are together, at fixed distances; with narrower vectors each part has an array
    /// of its own, so that consecutive lanes are adjacent.
    #[inline(always)]
    fn ring_place<L: Lanes>(&self, place: usize, parts: usize) -> (usize, usize) {
        if L::WIDTH == MOST { (place * parts, MOST) } else { (place, self.ring + MOST) }
    }

    /// Moves the nodes of this thread without evaluating forces, in a pass of this number.
    #[inline(always)]
    unsafe fn coast<L: Lanes>(&self, pass: u64, motion: &Motion<'_, L>) -> Option<usize> {
        let planes = self.grid.cells[2];
        let first = planes * self.member / self.members;
        let end = planes * (self.member + 1) / self.members + usize::from(self.member + 1 == self.members);
        for plane in first..end {
            // SAFETY: planes from `first` on belong to this thread and are moved before the others may read them.
            let bad = unsafe { self.nodes_between::<L, false>(plane, motion, |_| (L::splat(0.0), L::splat(0.0))) };
            if bad.is_some() {
                return bad;
            }
        }
        self.signals[self.member].pulled.store(pass + 1, Ordering::Release);
        self.signals[self.member].shared.store(pass + 1, Ordering::Release);
        None
    }

    /// Evaluates the forces on the planes of this thread and moves their nodes, in a pass of this number.
    #[inline(always)]
    unsafe fn pass<L: Lanes, S: Solver, const DAMPED: bool>(
        &self,
        pass: u64,
        motion: &Motion<'_, L>,
        solver: S,
        commit: bool,
    ) -> Option<usize> {
        let planes = self.grid.cells[2];
        let first = planes * self.member / self.members;
        let end = planes * (self.member + 1) / self.members;
        let is_last = self.member + 1 == self.members;
        // SAFETY: planes from `first` on belong to this thread. The one at `end`, if it belongs to another, is read
        // after the other has moved it and moved by the other after it was read. The same holds for the forces of both
        // there.
        unsafe {
            let memory = |part: usize| self.slabs.add(part);
            if self.member == 0 {
                self.clear::<L>(memory(self.slab.below));
            }
            for plane in first..end {
                let is_end = plane + 1 == end && !is_last;
                if is_end && !self.wait(|| self.signals[self.member + 1].shared.load(Ordering::Acquire) >= pass) {
                    return None;
                }
                let above = memory(if is_end { self.slab.highest } else { self.slab.below });
                let is_shared = plane == first && self.member > 0;
                if let Some(node) = self.plane::<L, S, DAMPED>(plane, motion, solver, commit, above, is_shared) {
                    return Some(node);
                }
            }
            self.signals[self.member].pulled.store(pass + 1, Ordering::Release);
            if is_last {
                let below = memory(self.slab.below);
                let bad = self.nodes_between::<L, DAMPED>(planes, motion, |at| (L::load(below.add(at)), L::splat(0.0)));
                if bad.is_some() {
                    return bad;
                }
            }
            if self.member > 0 {
                let before = self.member - 1;
                if !self.wait(|| self.signals[before].pulled.load(Ordering::Acquire) > pass) {
                    return None;
                }
                let below = memory(self.slab.highest).sub(self.slab.end);
                let lowest = memory(self.slab.lowest);
                let bad = self
                    .nodes_between::<L, DAMPED>(first, motion, |at| (L::load(below.add(at)), L::load(lowest.add(at))));
                if bad.is_some() {
                    return bad;
                }
                self.signals[self.member].shared.store(pass + 1, Ordering::Release);
            }
        }
        None
    }

    /// Waits for another thread; false if the sweep is to stop.
    #[inline(never)]
    fn wait(&self, is_so: impl Fn() -> bool) -> bool {
        wait_until(|| is_so() || self.stop.load(Ordering::Relaxed));
        is_so()
    }

    /// Sets the forces of the boxes below the first plane to zero.
    #[inline(always)]
    unsafe fn clear<L: Lanes>(&self, below: *mut f64) {
        for at in (0..3 * self.stride).step_by(L::WIDTH) {
            // SAFETY: it has three strides, which are whole vectors.
            unsafe { L::splat(0.0).store(below.add(at)) };
        }
    }

    /// Evaluates the boxes above a plane of nodes, and steps its nodes. Their forces on the next plane are written to
    /// `above`. If the plane `is_shared`, its nodes are not stepped yet.
    #[inline(always)]
    unsafe fn plane<L: Lanes, S: Solver, const DAMPED: bool>(
        &self,
        plane: usize,
        motion: &Motion<'_, L>,
        solver: S,
        commit: bool,
        above: *mut f64,
        is_shared: bool,
    ) -> Option<usize> {
        let zero = L::splat(0.0);
        let layer = self.grid.layer();
        let (mut pull_before, mut rise_before) = ([zero; 3], [zero; 3]);
        // The place in the ring buffer of rows, and how far the ring buffer of squares is filled.
        let mut own = 0;
        let mut filled = (0, 0);
        // SAFETY: `at` is a multiple of a width, below `layer`, and below the stride of boxes where boxes are read. A
        // chunk of `work` has room for what is written. The ring buffer has more than a row in whole vectors; the row
        // before the first is zero.
        unsafe {
            let (below, lowest) = (self.slabs.add(self.slab.below), self.slabs.add(self.slab.lowest));
            let row = self.grid.row().next_multiple_of(MOST);
            for at in (self.ring - row..self.ring).step_by(L::WIDTH) {
                self.put::<L, 3>(self.slabs.add(self.slab.rows), at, &[[zero; 3]; 3]);
            }
            for chunk in (0..layer).step_by(CHUNK) {
                let boxes = self.box_stride.min(chunk + CHUNK);
                let end = layer.min(chunk + CHUNK);
                filled = self.boxes::<L, S, DAMPED>(plane, [chunk, boxes], own, filled, solver, commit);
                for at in (chunk..end).step_by(L::WIDTH) {
                    let (pull, rise) = self.along_y::<L>(at, own, at < boxes);
                    own = self.next(own, L::WIDTH);
                    let work = self.work.add(at % CHUNK);
                    let first = slot(at, 3);
                    // Along x, and then along z.
                    thrice!(axis => {
                        let (high, low) = pull[axis];
                        let here = high.shift_in(pull_before[axis]) + low;
                        let up = rise[axis].shift_in(rise_before[axis]) + rise[axis];
                        (pull_before[axis], rise_before[axis]) = (high, rise[axis]);
                        let force = if is_shared {
                            (here - up).store(lowest.add(first + axis * MOST));
                            zero
                        } else {
                            L::load(below.add(first + axis * MOST)) + (here - up)
                        };
                        force.store(work.add(axis * CHUNK));
                        (here + up).store(above.add(first + axis * MOST));
                    });
                }
                if !is_shared {
                    let force = |at: usize| each!(3, axis => L::load(self.work.add(axis * CHUNK + at % CHUNK)));
                    if let Some(node) = self.update::<L, DAMPED>(plane, [chunk, end], motion, force) {
                        return Some(node);
                    }
                }
            }
        }
        None
    }

    /// Steps the nodes of a plane between boxes on both sides, whose forces (N) are known.
    #[inline(always)]
    unsafe fn nodes_between<L: Lanes, const DAMPED: bool>(
        &self,
        plane: usize,
        motion: &Motion<'_, L>,
        pulls: impl Fn(usize) -> (L, L),
    ) -> Option<usize> {
        let force = |at: usize| {
            each!(3, axis => {
                let (below, above) = pulls(slot(at, 3) + axis * MOST);
                below + above
            })
        };
        // SAFETY: these are the nodes of a plane.
        unsafe { self.update::<L, DAMPED>(plane, [0, self.grid.layer()], motion, force) }
    }

    /// The place in a ring buffer that is `way` after another.
    #[inline(always)]
    fn next(&self, place: usize, way: usize) -> usize {
        let next = place + way;
        if next >= self.ring { next - self.ring } else { next }
    }

    /// Writes one number of each part to a ring buffer; what is within a vector of its start is repeated after its end.
    #[inline(always)]
    unsafe fn put<L: Lanes, const PARTS: usize>(&self, ring: *mut f64, place: usize, values: &[[L; 3]; PARTS]) {
        let (first, part) = self.ring_place::<L>(place, 3 * PARTS);
        // SAFETY: a ring buffer has an additional vector for each part, and places are multiples of a width.
        unsafe {
            let to = ring.add(first);
            for group in 0..PARTS {
                thrice!(axis => values[group][axis].store(to.add((3 * group + axis) * part)));
            }
            if place < MOST {
                let (first, _) = self.ring_place::<L>(place + self.ring, 3 * PARTS);
                let to = ring.add(first);
                for group in 0..PARTS {
                    thrice!(axis => values[group][axis].store(to.add((3 * group + axis) * part)));
                }
            }
        }
    }

    /// Computes the rotations of a chunk of boxes, and their `w̄`. `own` is the place of the first box in the ring
    /// buffers. The squares have been written up to box `filled`; the next ones go to `place`. Both are returned for
    /// the next chunk.
    ///
    /// In several short loops: a rotation is a long chain of dependent operations, and a processor overlaps several of
    /// them in a short loop.
    #[inline(always)]
    unsafe fn boxes<L: Lanes, S: Solver, const DAMPED: bool>(
        &self,
        plane: usize,
        [first, end]: [usize; 2],
        own: usize,
        (mut filled, mut place): (usize, usize),
        solver: S,
        commit: bool,
    ) -> (usize, usize) {
        let passes = solver.passes();
        let scale = L::splat(self.scale);
        // For each vector the lanes that are not finished, those where the pass was valid, and those where it was the
        // last.
        let mut lanes = [[0u8; 3]; CHUNK];
        // SAFETY: `live` and the rotations have all boxes of a plane in whole vectors, and `work` those of a chunk.
        unsafe {
            if first < end {
                let needed = (end - L::WIDTH + self.grid.row()) / MOST * MOST + 2 * MOST;
                place = self.squares::<L, DAMPED>(plane, filled, needed, place);
                filled = needed;
            }
            for pass in 0..passes {
                let is_last = pass + 1 == passes;
                let mut here = own;
                for at in (first..end).step_by(L::WIDTH) {
                    let live = L::load(self.live.add(at));
                    if pass == 0 {
                        lanes[at % CHUNK][0] = L::bits(L::splat(0.0).lt(live)) as u8;
                    }
                    let edges = self.edges::<L, DAMPED>(at, here, live);
                    here = self.next(here, L::WIDTH);
                    let b = turned_back(&edges, &matrix(self.turns::<L>(plane, at, pass == 0), scale));
                    let work = self.work.add(at % CHUNK);
                    thrice!(row => thrice!(column => b[row][column].store(work.add((3 * row + column) * CHUNK))));
                }
                for at in (first..end).step_by(L::WIDTH) {
                    let work = self.work.add(at % CHUNK);
                    let b = each!(3, row => each!(3, column => L::load(work.add((3 * row + column) * CHUNK))));
                    let (turn, sound, last) = solver.pass(&b);
                    self.expect::<L>(plane, at + CHUNK);
                    let _ = each!(4, part => turn[part].store(work.add(part * CHUNK)));
                    lanes[at % CHUNK][1] = L::bits(sound) as u8;
                    lanes[at % CHUNK][2] = L::bits(last) as u8;
                }
                let mut here = own;
                for at in (first..end).step_by(L::WIDTH) {
                    let work = self.work.add(at % CHUNK);
                    let [x, y, z, s] = each!(4, part => L::load(work.add(part * CHUNK)));
                    let before = self.turns::<L>(plane, at, pass == 0);
                    let (next, in_range) = turn(before, [x, y, z], s);
                    let [open, sound, last] = lanes[at % CHUNK];
                    let sound = u32::from(open & sound) & L::bits(in_range);
                    let mut q = choose(L::mask(sound), next, before);
                    lanes[at % CHUNK][0] = sound as u8;
                    let failed = u32::from(open) & !sound;
                    let late = if is_last { sound & !u32::from(last) } else { 0 };
                    if failed | late != 0 {
                        let edges = self.edges::<L, DAMPED>(at, here, L::load(self.live.add(at)));
                        q = solver.go_on(&edges, scale, q, late, failed);
                    }
                    here = self.next(here, L::WIDTH);
                    let _ = each!(4, part => q[part].store(work.add((TURN + part) * CHUNK)));
                    if commit && is_last {
                        let turns = self.turns.add(slot(plane * self.box_stride + at, 4));
                        let _ = each!(4, part => q[part].store(turns.add(part * MOST)));
                    }
                }
            }
        }
        (filled, place)
    }

    /// Prefetches the rotations of boxes, and the nodes of their squares. They are in a higher-level cache, and in
    /// short loops the hardware does not prefetch them in time.
    #[inline(always)]
    fn expect<L: Lanes>(&self, plane: usize, at: usize) {
        // Narrower vectors share a cache line.
        if !at.is_multiple_of(MOST) {
            return;
        }
        let turns = self.turns.wrapping_add(slot(plane * self.box_stride + at, 4));
        let _ = each!(4, part => L::expect(turns.wrapping_add(part * MOST)));
        let ahead = plane * self.stride + at + self.grid.row() + 2 * MOST;
        let low = self.nodes.wrapping_add(slot(ahead, self.parts));
        let high = self.nodes.wrapping_add(slot(ahead + self.stride, self.parts));
        let _ = each!(8, part => if part <= INVERSE_MASS { L::expect(low.wrapping_add(part * MOST)) });
        let _ = each!(8, part => if part < INVERSE_MASS { L::expect(high.wrapping_add(part * MOST)) });
    }

    /// The rotations of boxes: those of the last step, or those of the previous pass.
    #[inline(always)]
    unsafe fn turns<L: Lanes>(&self, plane: usize, at: usize, is_first: bool) -> [L; 4] {
        // SAFETY: the rotations have all boxes of a plane in whole vectors, and `work` those of a chunk.
        unsafe {
            let (from, stride) = if is_first {
                (self.turns.add(slot(plane * self.box_stride + at, 4)), MOST)
            } else {
                (self.work.add(TURN * CHUNK + at % CHUNK), CHUNK)
            };
            each!(4, part => L::load(from.add(part * stride)))
        }
    }

    /// Writes, for squares of four nodes along x and z, their sum, their differences along x and along z, and the sum
    /// of their velocities, in a range of nodes. Returns the place in the ring buffer after them.
    #[inline(always)]
    unsafe fn squares<L: Lanes, const DAMPED: bool>(
        &self,
        plane: usize,
        from: usize,
        to: usize,
        mut place: usize,
    ) -> usize {
        // SAFETY: a stride has all boxes in whole vectors, and a row and two vectors more; for the ring buffer see
        // `put`.
        unsafe {
            macro_rules! upright {
                ($at:expr) => {{
                    let (low, high) = (self.nodes(plane, $at), self.nodes(plane + 1, $at));
                    each!(3, axis => {
                        let (low, high) = (low.add(axis * MOST), high.add(axis * MOST));
                        let (a, b) = (L::load(low), L::load(high));
                        let speed = if DAMPED {
                            L::load(low.add(VELOCITY * MOST)) + L::load(high.add(VELOCITY * MOST))
                        } else {
                            L::splat(0.0)
                        };
                        (a + b, b - a, speed)
                    })
                }};
            }
            let mut left = upright!(from);
            for at in (from..to).step_by(L::WIDTH) {
                let next = upright!(at + L::WIDTH);
                let right = each!(3, axis => left[axis].0.shift_out(next[axis].0));
                let sum = each!(3, axis => left[axis].0 + right[axis]);
                let x = each!(3, axis => right[axis] - left[axis].0);
                let z = each!(3, axis => left[axis].1 + left[axis].1.shift_out(next[axis].1));
                let ring = self.slabs.add(self.slab.squares);
                if DAMPED {
                    let speed = each!(3, axis => left[axis].2 + left[axis].2.shift_out(next[axis].2));
                    self.put(ring, place, &[sum, x, z, speed]);
                } else {
                    self.put(ring, place, &[sum, x, z]);
                }
                place = self.next(place, L::WIDTH);
                left = next;
            }
        }
        place
    }

    /// The sums of the edges of boxes along each axis: the columns of `A` except for a factor. Writes `w̄`. `own` is
    /// the place of the squares at the lower ends along y.
    #[inline(always)]
    unsafe fn edges<L: Lanes, const DAMPED: bool>(&self, at: usize, own: usize, live: L) -> [[L; 3]; 3] {
        // SAFETY: the ring buffer has the squares in whole vectors, and a vector more.
        unsafe {
            let row = self.grid.row();
            let parts = if DAMPED { 12 } else { 9 };
            let squares = self.slabs.add(self.slab.squares);
            let (near, part) = self.ring_place::<L>(own, parts);
            let beyond = self.next(own, row);
            let (far, _) = self.ring_place::<L>(beyond / MOST * MOST, parts);
            let (near, far) = (squares.add(near), squares.add(far));
            let (distance, line) = (L::distance(beyond % MOST), MOST * parts);
            let work = self.work.add(at % CHUNK);
            let mut edges = [[L::splat(0.0); 3]; 3];
            let (of_p, of_v) = (L::splat(0.125 * self.stiffness) * live, L::splat(0.125 * self.damping) * live);
            thrice!(axis => {
                let (sum0, sum1) = (L::load(near.add(axis * part)), L::load_beyond(far.add(axis * part), distance, line));
                let x = (3 + axis) * part;
                edges[0][axis] = L::load(near.add(x)) + L::load_beyond(far.add(x), distance, line);
                edges[1][axis] = sum1 - sum0;
                let z = (6 + axis) * part;
                edges[2][axis] = L::load(near.add(z)) + L::load_beyond(far.add(z), distance, line);
                let mut mean = of_p * (sum0 + sum1);
                if DAMPED {
                    let v = (9 + axis) * part;
                    let sum = L::load(near.add(v)) + L::load_beyond(far.add(v), distance, line);
                    mean = of_v.mul_add(sum, mean);
                }
                mean.store(work.add((MEAN + axis) * CHUNK));
            });
            if !self.is_cube {
                edges = each!(3, column => each!(3, axis => edges[column][axis] * L::splat(self.ratio[column])));
            }
            edges
        }
    }

    /// `u`, `v` and `t` of boxes.
    #[inline(always)]
    unsafe fn shape<L: Lanes>(&self, at: usize) -> [[L; 3]; 3] {
        // SAFETY: `live` has all boxes of a plane in whole vectors, and `work` those of a chunk.
        unsafe {
            let work = self.work.add(at % CHUNK);
            let q = each!(4, part => L::load(work.add((TURN + part) * CHUNK)));
            let mut shape = matrix(q, L::splat(self.half) * L::load(self.live.add(at)));
            if !self.is_cube {
                shape = each!(3, column => each!(3, axis => shape[column][axis] * L::splat(self.ratio[column])));
            }
            shape
        }
    }

    /// Adds up the forces of the boxes of two rows on the nodes between: for each axis the sums for the next node along
    /// x and for the node itself, and the part whose sign changes along z.
    #[inline(always)]
    unsafe fn along_y<L: Lanes>(&self, at: usize, own: usize, is_box: bool) -> ([(L, L); 3], [L; 3]) {
        // SAFETY: a chunk of `work` has boxes in whole vectors; see `put`. The ring buffer can be read from any place.
        unsafe {
            let work = self.work.add(at % CHUNK);
            let zero = [L::splat(0.0); 3];
            let ([u, v, t], mean) = if is_box {
                (self.shape::<L>(at), each!(3, axis => L::load(work.add((MEAN + axis) * CHUNK))))
            } else {
                ([zero; 3], zero)
            };
            self.put(self.slabs.add(self.slab.rows), own, &[each!(3, axis => mean[axis] + v[axis]), u, t]);
            // From the previous row, of which the first lanes may just have been written.
            let before = self.next(own, self.ring - self.grid.row());
            let (from, part) = self.ring_place::<L>(before / MOST * MOST, 9);
            let from = self.slabs.add(self.slab.rows + from);
            let (distance, line) = (L::distance(before % MOST), MOST * 9);
            let mut pull = [(mean[0], mean[0]); 3];
            let mut rise = t;
            thrice!(axis => {
                let sum = L::load_beyond(from.add(axis * part), distance, line) + (mean[axis] - v[axis]);
                let along = L::load_beyond(from.add((3 + axis) * part), distance, line) + u[axis];
                pull[axis] = (sum + along, sum - along);
                rise[axis] = L::load_beyond(from.add((6 + axis) * part), distance, line) + t[axis];
            });
            (pull, rise)
        }
    }

    /// Eqs. (2) and (3) and contact for a range of nodes of a plane, on which elements act with a force (N) in addition
    /// to `−w`. Returns the first node that becomes too fast, if any.
    #[inline(always)]
    unsafe fn update<L: Lanes, const DAMPED: bool>(
        &self,
        plane: usize,
        [first, end]: [usize; 2],
        motion: &Motion<'_, L>,
        force: impl Fn(usize) -> [L; 3],
    ) -> Option<usize> {
        let planes = if plane == 0 || plane == self.grid.cells[2] { 1.0 } else { 2.0 };
        let (stiffness, damping) = (L::splat(planes * self.stiffness), L::splat(planes * self.damping));
        let is_verlet = motion.stage().is_verlet();
        let zero = L::splat(0.0);
        let mut near = 0;
        // SAFETY: a stride has all nodes of a plane in whole vectors.
        unsafe {
            let load = |from: *const f64, part: usize| each!(3, axis => L::load(from.add((part + axis) * MOST)));
            let inverse_mass = |from: *const f64| L::load(from.add(INVERSE_MASS * MOST));
            for at in (first..end).step_by(L::WIDTH) {
                let to = self.nodes(plane, at);
                let valence = L::load(self.valence.add(at));
                let (stiffness, damping) = (stiffness * valence, damping * valence);
                let acceleration = if is_verlet { load(to, ACCELERATION) } else { [zero; 3] };
                let mut nodes = Nodes { position: load(to, 0), velocity: load(to, VELOCITY), acceleration };
                let mut total = force(at);
                thrice!(axis => {
                    total[axis] = nodes.position[axis].neg_mul_add(stiffness, total[axis]);
                    if DAMPED {
                        total[axis] = nodes.velocity[axis].neg_mul_add(damping, total[axis]);
                    }
                });
                let lost = motion.go(&mut nodes, total, inverse_mass(to));
                if lost != 0 {
                    return Some(plane * self.grid.layer() + at + lost.trailing_zeros() as usize);
                }
                near |= motion.near(&nodes);
                thrice!(axis => {
                    nodes.position[axis].store(to.add(axis * MOST));
                    nodes.velocity[axis].store(to.add((VELOCITY + axis) * MOST));
                });
                if is_verlet {
                    thrice!(axis => nodes.acceleration[axis].store(to.add((ACCELERATION + axis) * MOST)));
                }
            }
            if near == 0 {
                return None;
            }
            for at in (first..end).step_by(L::WIDTH) {
                let to = self.nodes(plane, at);
                let acceleration = if is_verlet { load(to, ACCELERATION) } else { [zero; 3] };
                let mut nodes = Nodes { position: load(to, 0), velocity: load(to, VELOCITY), acceleration };
                motion.meet(&mut nodes, inverse_mass(to));
                thrice!(axis => {
                    nodes.position[axis].store(to.add(axis * MOST));
                    nodes.velocity[axis].store(to.add((VELOCITY + axis) * MOST));
                });
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::body::{IndexLists, Solids};
    use crate::sim::contact::{self, Bound, Obstacle, Shape};
    use crate::sim::dynamics::Runaway;
    use crate::sim::integrate::Integrator;
    use crate::sim::kernel::stepper::Way;
    use crate::sim::model::shape_based::{DampingReading, RotationReading, ShapeBased};
    use crate::sim::rotation::{davenport1968, moment};
    use crate::sim::state::State;
    use crate::sim::world::{Kernel, Stepping, Surroundings, World};
    use glam::DQuat;
    use std::sync::Arc;

    const STEP: f64 = 1e-3;
    const GRAVITY: DVec3 = DVec3::new(0.3, -9.8, 0.1);

    /// Pseudo-random numbers from −1 to 1.
    fn random(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    fn vector(random: &mut impl FnMut() -> f64) -> DVec3 {
        DVec3::new(random(), random(), random())
    }

    fn lattice(cells: [usize; 3], sides: DVec3) -> Arc<Body> {
        let grid = Grid { cells, sides };
        let layer = grid.layer();
        let place = |node: usize| [node % grid.row(), node % layer / grid.row(), node / layer];
        let rest: Vec<_> = (0..layer * (cells[2] + 1))
            .map(|node| sides * DVec3::from_array(place(node).map(|at| at as f64)))
            .collect();
        let mass = (0..rest.len()).map(|node| 0.5 + 0.01 * (node % 7) as f64).collect();
        let mut elements = IndexLists::default();
        for element in 0..cells.iter().product() {
            let [x, y, z] = grid.place(element);
            let low = x + grid.row() * y + layer * z;
            let corner = |bits: usize| low + (bits & 1) + grid.row() * (bits >> 1 & 1) + layer * (bits >> 2);
            elements.push(&[0, 1, 2, 3, 4, 5, 6, 7].map(|bits| corner(bits) as u32));
        }
        Arc::new(Body::new(Dimension::Space, rest, mass, elements, Solids::Ordered, None))
    }

    /// Rotated, stretched, randomly displaced and moving, close above the floor.
    fn start(body: &Body, shake: f64) -> State {
        let mut random = random(7);
        let turn = DQuat::from_xyzw(0.3, -0.2, 0.4, 0.8).normalize();
        let spin = DVec3::new(0.5, 2.0, -1.0);
        let side = (body.rest[1] - body.rest[0]).length();
        let position: Vec<_> = body
            .rest
            .iter()
            .map(|&rest| turn * (rest * DVec3::new(1.05, 0.97, 1.0)) + vector(&mut random) * (shake * side) + DVec3::Y)
            .collect();
        let velocity = position.iter().map(|&at| spin.cross(at) + vector(&mut random) * 0.1 - DVec3::Y).collect();
        State::new(position, velocity)
    }

    fn turns(body: &Body, state: &State) -> Vec<f64> {
        let turn = |nodes: &[u32]| {
            let relative = |of: &[DVec3]| -> Vec<DVec3> {
                let mean = nodes.iter().map(|&node| of[node as usize]).sum::<DVec3>() / 8.0;
                nodes.iter().map(|&node| of[node as usize] - mean).collect()
            };
            davenport1968::optimum(moment(&relative(&body.rest), relative(&state.position)), DQuat::IDENTITY).to_array()
        };
        body.elements.iter().flat_map(turn).collect()
    }

    fn parameters(damping: f64, rotation: Rotation) -> Parameters {
        Parameters { stiffness: 900.0, damping, rotation, gravity: GRAVITY, step: STEP }
    }

    fn floor() -> Obstacle {
        let normal = DVec3::new(0.1, 1.0, 0.0).normalize();
        let shape = Shape::Floor { normal, height: 0.02 };
        Obstacle { shape, motion: contact::Motion::Still, pivot: DVec3::ZERO, restitution: 0.5, friction: 0.3 }
    }

    fn bound(floor: &Obstacle) -> Bound {
        let Shape::Floor { normal, height } = floor.shape else { unreachable!() };
        Bound::HalfSpace { normal, height: height + 1e-9 }
    }

    fn run(body: &Body, state: &State, parameters: Parameters, set: Set, calls: u64, steps: u64) -> (State, Vec<f64>) {
        run_by(1, Scheme::SemiImplicitEuler, body, state, parameters, set, [calls, steps])
    }

    fn run_by(
        threads: usize,
        scheme: Scheme,
        body: &Body,
        state: &State,
        parameters: Parameters,
        set: Set,
        [calls, steps]: [u64; 2],
    ) -> (State, Vec<f64>) {
        let (mut way, mut memory) = (way(body, parameters, scheme, set), turns(body, state));
        way.load(0, &state.position, &state.velocity, &memory);
        let floor = floor();
        let resolve = |_: u64, p: &mut DVec3, v: &mut DVec3, a: DVec3| floor.at(0.0, STEP).rebound(p, v, a);
        let around = Around { bounds: &[bound(&floor)], row: &|_| 0..1, resolve: &resolve, ..FREE };
        for call in 1..=calls {
            way.advance(call * steps, &around, &mut Crew::new(threads)).expect("no runaway");
        }
        let mut state = state.clone();
        way.stepper.store(&mut state.position, &mut state.velocity, &mut memory);
        (state, memory)
    }

    /// No obstacle.
    const FREE: Around<'_> = Around {
        bounds: &[],
        row: &|_| 0..0,
        resolve: &|_, _, _, _| {},
        floor: None,
        grips: None,
        speed_limit: &|_| 1e6,
    };

    fn way(body: &Body, parameters: Parameters, scheme: Scheme, set: Set) -> Way {
        Way::new(Box::new(Lattice::new(body, parameters, scheme, set).expect("a lattice")), scheme)
    }

    fn reference(scheme: Scheme, body: &Arc<Body>, state: &State, parameters: Parameters, steps: u64) -> State {
        let (passes, rotation) = match parameters.rotation {
            Rotation::Arctangent { passes } => (passes, RotationReading::Arctangent),
            Rotation::Optimum => (1, RotationReading::Exact),
        };
        let model = ShapeBased {
            stiffness: parameters.stiffness,
            damping: parameters.damping,
            passes,
            rotation,
            damping_of: DampingReading::RelativeMotion,
        };
        let surroundings = Surroundings { gravity: GRAVITY, obstacles: vec![floor()], grips: vec![] };
        let integrator = match scheme {
            Scheme::SemiImplicitEuler => Integrator::SemiImplicitEuler,
            Scheme::ExplicitEuler => Integrator::ExplicitEuler,
            Scheme::VelocityVerlet => Integrator::VelocityVerlet,
        };
        let plain = Stepping { integrator, step: STEP, kernel: Kernel::Reference };
        let mut world = World::new(body, state.clone(), &model, surroundings, plain);
        world.advance(steps);
        assert_eq!(world.steps(), steps);
        world.state().clone()
    }

    fn distance(a: &State, b: &State) -> f64 {
        let of = |a: &[DVec3], b: &[DVec3]| {
            let scale = a.iter().fold(1.0, |scale: f64, a| scale.max(a.length()));
            a.iter().zip(b).fold(0.0, |most: f64, (a, b)| most.max((*a - *b).length() / scale))
        };
        of(&a.position, &b.position).max(of(&a.velocity, &b.velocity))
    }

    const SCHEMES: [Scheme; 3] = [Scheme::SemiImplicitEuler, Scheme::ExplicitEuler, Scheme::VelocityVerlet];

    const EXTENTS: [[usize; 3]; 9] =
        [[1, 1, 1], [1, 1, 5], [1, 4, 1], [7, 1, 3], [3, 3, 3], [9, 2, 2], [8, 3, 2], [17, 2, 1], [2, 13, 3]];

    #[test]
    fn steps_are_those_of_the_reference() {
        for cells in EXTENTS {
            for sides in [DVec3::splat(0.5), DVec3::new(0.5, 0.3, 0.8)] {
                let body = lattice(cells, sides);
                let state = start(&body, 0.05);
                for (damping, rotation) in
                    [(0.0, Rotation::Optimum), (0.7, Rotation::Optimum), (0.7, Rotation::Arctangent { passes: 2 })]
                {
                    let parameters = parameters(damping, rotation);
                    for scheme in SCHEMES {
                        // A rebound in velocity Verlet takes the square root of a difference, which loses half of the
                        // digits.
                        let mut state = state.clone();
                        if scheme == Scheme::VelocityVerlet {
                            state.velocity.iter_mut().for_each(|velocity| velocity.y += 9.0);
                        }
                        let (found, _) = run_by(1, scheme, &body, &state, parameters, Set::best(), [10, 100]);
                        let distance = distance(&reference(scheme, &body, &state, parameters, 1000), &found);
                        assert!(distance < 1e-12, "{cells:?} {sides} {scheme:?} {parameters:?}: {distance}");
                    }
                }
            }
        }
    }

    #[test]
    fn rebounds_in_velocity_verlet_are_those_of_the_reference() {
        let body = lattice([3, 2, 4], DVec3::splat(0.5));
        let state = start(&body, 0.05);
        for damping in [0.0, 0.7] {
            let parameters = parameters(damping, Rotation::Optimum);
            let (found, _) = run_by(1, Scheme::VelocityVerlet, &body, &state, parameters, Set::best(), [8, 50]);
            let reference = reference(Scheme::VelocityVerlet, &body, &state, parameters, 400);
            assert!(reference.velocity.iter().any(|velocity| velocity.y > 1.0), "some have rebounded");
            assert!(distance(&reference, &found) < 1e-11, "{}", distance(&reference, &found));
        }
    }

    #[test]
    fn every_set_has_the_same_bits() {
        for cells in EXTENTS {
            let body = lattice(cells, DVec3::new(0.5, 0.3, 0.8));
            // Displaced so much that some elements turn over.
            let state = start(&body, 0.6);
            for rotation in [Rotation::Optimum, Rotation::Arctangent { passes: 2 }] {
                let all = Set::all().map(|set| run(&body, &state, parameters(0.3, rotation), set, 1, 300));
                let all: Vec<_> = all.collect();
                assert!(all.windows(2).all(|two| two[0] == two[1]), "{cells:?} {rotation:?}");
            }
        }
    }

    #[test]
    fn every_number_of_threads_has_the_same_bits() {
        for cells in [[3, 3, 3], [2, 3, 7], [17, 2, 4], [1, 1, 5], [4, 4, 1]] {
            let body = lattice(cells, DVec3::splat(0.5));
            let state = start(&body, 0.3);
            let parameters = parameters(0.3, Rotation::Optimum);
            for (scheme, threads) in SCHEMES.into_iter().flat_map(|scheme| [2, 3, 7].map(|threads| (scheme, threads))) {
                let one = run_by(1, scheme, &body, &state, parameters, Set::best(), [2, 40]);
                assert_eq!(
                    run_by(threads, scheme, &body, &state, parameters, Set::best(), [2, 40]),
                    one,
                    "{cells:?} {threads}"
                );
            }
        }
    }

    #[test]
    fn before_a_runaway_the_state_is_that_of_the_step_before() {
        let body = lattice([5, 3, 6], DVec3::splat(0.5));
        let state = start(&body, 0.05);
        // Far beyond the limit of stability.
        let parameters = Parameters { step: 0.3, ..parameters(0.0, Rotation::Optimum) };
        let around = Around { speed_limit: &|step| 1e6 + step as f64, ..FREE };
        let memory = turns(&body, &state);
        for scheme in SCHEMES {
            let make = || {
                let mut way = way(&body, parameters, scheme, Set::best());
                way.load(0, &state.position, &state.velocity, &memory);
                way
            };
            let read = |way: &mut Way| {
                let (mut state, mut memory) = (state.clone(), memory.clone());
                way.stepper.store(&mut state.position, &mut state.velocity, &mut memory);
                (way.steps(), state, memory)
            };
            let mut one = make();
            let runaway = one.advance(1000, &around, &mut Crew::new(1)).expect_err("unstable");
            let taken = one.steps();
            assert!((1..1000).contains(&taken), "{taken}");
            let mut up_to_there = make();
            assert_eq!(up_to_there.advance(taken, &around, &mut Crew::new(1)), Ok(()));
            assert!(read(&mut one) == read(&mut up_to_there), "{scheme:?}");
            assert_eq!(up_to_there.advance(taken + 1, &around, &mut Crew::new(1)), Err(runaway));
            assert!(read(&mut one) == read(&mut up_to_there), "{scheme:?}");
            // In calls of one step, and with several threads.
            for (threads, steps) in [(1, 1), (2, 1000), (3, 1000), (3, 7)] {
                let (mut other, mut crew) = (make(), Crew::new(threads));
                let lost = (1..).find_map(|call| other.advance(call * steps, &around, &mut crew).err());
                assert_eq!(lost, Some(runaway));
                assert!(read(&mut other) == read(&mut one), "{scheme:?} {threads} {steps}");
            }
        }
    }

    #[test]
    fn what_is_no_number_is_lost_at_once() {
        let body = lattice([3, 2, 2], DVec3::splat(0.5));
        let state = start(&body, 0.0);
        let parameters = parameters(0.1, Rotation::Optimum);
        let mut way = way(&body, parameters, Scheme::SemiImplicitEuler, Set::best());
        way.load(0, &state.position, &state.velocity, &turns(&body, &state));
        way.stepper.set_node(17, DVec3::new(0.0, f64::NAN, 0.0), DVec3::ZERO);
        assert!(matches!(way.advance(3, &FREE, &mut Crew::new(1)), Err(Runaway { .. })) && way.steps() == 0);
        assert!(way.stepper.node(17).0.y.is_nan() && way.stepper.node(0) == (state.position[0], state.velocity[0]));
    }

    #[test]
    fn only_lattices_of_equal_boxes_are_recognised() {
        let body = lattice([3, 2, 4], DVec3::new(0.5, 0.3, 0.8));
        let grid = Grid::of(&body).expect("a lattice");
        assert_eq!(grid.cells, [3, 2, 4]);
        assert!((grid.sides - DVec3::new(0.5, 0.3, 0.8)).length() < 1e-14);
        let with = |change: &dyn Fn(&mut Body)| {
            let mut body = Body::clone(&body);
            change(&mut body);
            Grid::of(&body)
        };
        assert_eq!(with(&|body| body.rest[30].x += 1e-9), None);
        assert_eq!(with(&|body| body.rest.iter_mut().for_each(|node| node.x *= -1.0)), None);
        assert_eq!(with(&|body| body.dimension = Dimension::Plane), None);
        let without_first = |body: &mut Body| body.elements = body.elements.iter().skip(1).collect();
        assert_eq!(with(&without_first), None);
        let backwards = |body: &mut Body| {
            body.elements = (0..body.elements.len()).rev().map(|at| &body.elements[at]).collect();
        };
        assert_eq!(with(&backwards), None);
        assert_eq!(with(&|body| body.elements = IndexLists::default()), None);
    }
}
