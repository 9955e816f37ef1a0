//! One fused step of the shape model on a lattice of equal boxes.
//!
//! Gather, moments, rotations, forces, motion and contact are one pass over the planes of nodes, in place. What makes it
//! fast, with `R0` the corners of a box at rest, `Σ R0 = 0`:
//!
//! - `A = Σ r R0ᵀ` needs no centre: its columns are the sums of the four edges along each axis, times half the side.
//! - With `w = k P + D V` and `w̄` its mean over a box, Eq. (4) is `−w + w̄ + k M R0`. The sum of `−w` over the boxes of a
//!   node is a product; `w̄ + k M R0` is `w̄ ± u ± v ± t` with one vector for each axis.
//! - Both are sums over two nodes or boxes along z, then along x, then along y, and the same backwards.
//!
//! Nodes of a plane are numbered x fastest, and lanes are nodes of successive numbers. So are boxes, by their lowest node;
//! the last node of a row counts as a box of no stiffness. Rows then need no padding.
//!
//! Each node sums its boxes as `(those below) + (those above)` along z, so planes may be dealt to threads: where two meet,
//! each writes its own term.

#![expect(unsafe_code, reason = "the innermost loops read and write lanes without bounds checks")]

use super::array::Array;
use super::lanes::{Lanes, MOST, Set, Work, each, thrice};
use super::rotation::{Arctangent, Optimum, Solver, matrix};
use super::{Around, Bound, Resolve, Rotation, Runaway};
use crate::sim::body::{Body, Dimension};
use glam::DVec3;

/// What a step computes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::sim) struct Parameters {
    /// Elastic constant `k_e` of each element (N/m).
    pub(in crate::sim) stiffness: f64,
    /// Damping constant `D_e` of each element (N s/m), of the motion relative to the element's mean.
    pub(in crate::sim) damping: f64,
    /// How rotations are found.
    pub(in crate::sim) rotation: Rotation,
    /// Acceleration of gravity (m/s²).
    pub(in crate::sim) gravity: DVec3,
    /// ΔT (s).
    pub(in crate::sim) step: f64,
}

/// Which body a lattice of equal boxes is.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Grid {
    /// Boxes along x, y and z.
    cells: [usize; 3],
    /// The sides of a box (m).
    sides: DVec3,
}

impl Grid {
    /// `None` where the body is something else.
    fn of(body: &Body) -> Option<Self> {
        /// Of the sides.
        const EQUAL: f64 = 1e-12;
        let first = body.elements.iter().next().filter(|nodes| nodes.len() == 8)?;
        let (row, layer) = (first[2] as usize, first[4] as usize);
        if body.dimension != Dimension::Space
            || row < 2
            || layer < 2 * row
            || layer % row != 0
            || body.len() % layer != 0
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

    /// Where an element is.
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

    /// Boxes in a plane, with the ends of rows but the last.
    fn boxes(&self) -> usize {
        self.row() * self.cells[1] - 1
    }

    /// Numbers between one plane of nodes, or one of their coordinates, and the next: whole vectors, so many that what is
    /// read for the last box, a row and two vectors ahead of it, is there.
    fn stride(&self) -> usize {
        let stride = (self.box_stride() + self.row() + 2 * MOST).next_multiple_of(MOST);
        // Coordinates that lie a multiple of a page apart would compete for the same places of the cache.
        if stride % 512 == 0 { stride + MOST } else { stride }
    }

    /// How many successive numbers a [`Ring`] holds.
    fn ring(&self) -> usize {
        CHUNK + (self.row() + 2 * MOST).next_multiple_of(MOST)
    }

    /// Numbers between one plane of boxes and the next.
    fn box_stride(&self) -> usize {
        self.boxes().next_multiple_of(MOST)
    }
}

/// For each node in a plane of them: position, velocity, `ΔT/m`.
const NODE: usize = 7;
const VELOCITY: usize = 3;
const PUSH: usize = 6;

/// Boxes that are gathered, then rotated, then stepped: so many that a processor finds independent work in each of these
/// loops, so few that what they hand over stays in its nearest cache. A multiple of [`MOST`].
const CHUNK: usize = 64;

/// A lattice of equal boxes at work.
pub(in crate::sim) struct Lattice {
    set: Set,
    grid: Grid,
    parameters: Parameters,
    /// Plane after plane: each of the [`NODE`] numbers of all its nodes.
    nodes: Array,
    /// Plane after plane: x, y, z and w of the rotations of all its boxes.
    turns: Array,
    /// `nodes` and `turns` as they were before the steps of a call.
    before: (Array, Array),
    pattern: Pattern,
    slab: Slab,
}

/// What all planes have in common.
struct Pattern {
    /// 1 for a box, 0 for the end of a row.
    live: Array,
    /// The number of boxes of a plane that a node belongs to.
    valence: Array,
}

/// The memory of one thread that steps successive planes.
struct Slab {
    /// A ring of nodes: for each axis sums over the two planes and two successive nodes along x, of positions, of their
    /// differences along x and along z, and of velocities.
    pairs: Array,
    /// A ring of boxes: `w̄ + v`, `u` and `t`.
    rows: Array,
    /// What the boxes below pull at the nodes of a plane (N).
    below: Array,
    /// Of a chunk of boxes the sums of edges, then `u`, `v` and `t` in their place; and `w̄`.
    work: Array,
}

impl Lattice {
    /// `None` if the body is no full lattice of equal boxes, numbered x fastest.
    pub(in crate::sim) fn new(body: &Body, parameters: Parameters, set: Set) -> Option<Self> {
        let grid = Grid::of(body)?;
        let (stride, row) = (grid.stride(), grid.row());
        let [_, rows, planes] = grid.cells;
        let mut nodes = Array::zeros((planes + 1) * NODE * stride);
        for (node, &mass) in body.mass.iter().enumerate() {
            let (plane, at) = (node / grid.layer(), node % grid.layer());
            nodes[(plane * NODE + PUSH) * stride + at] = parameters.step / mass;
        }
        let turns = Array::zeros(planes * 4 * grid.box_stride());
        let mut pattern = Pattern { live: Array::zeros(grid.box_stride()), valence: Array::zeros(stride) };
        for at in (0..grid.boxes()).filter(|at| at % row != row - 1) {
            pattern.live[at] = 1.0;
        }
        for at in 0..grid.layer() {
            let edge = |at: usize, cells: usize| if at == 0 || at == cells { 1.0 } else { 2.0 };
            pattern.valence[at] = edge(at % row, row - 1) * edge(at / row, rows);
        }
        let ring = grid.ring() + MOST;
        let slab = Slab {
            pairs: Array::zeros(12 * ring),
            rows: Array::zeros(9 * ring),
            below: Array::zeros(3 * stride),
            work: Array::zeros(12 * CHUNK),
        };
        let before = (nodes.clone(), turns.clone());
        Some(Self { set, grid, parameters, nodes, turns, before, pattern, slab })
    }

    /// Where the numbers of a node stand in `nodes`: the first of them; the others follow a stride apart.
    fn index(&self, node: usize) -> usize {
        node / self.grid.layer() * NODE * self.grid.stride() + node % self.grid.layer()
    }

    /// Takes over a state: positions (m), velocities (m/s), and the rotation of each element as (x, y, z, w).
    pub(in crate::sim) fn load(&mut self, position: &[DVec3], velocity: &[DVec3], memory: &[f64]) {
        for (node, (&position, &velocity)) in position.iter().zip(velocity).enumerate() {
            self.set_node(node, position, velocity);
        }
        let stride = self.grid.box_stride();
        // The ends of rows have a rotation, too, of which nothing comes.
        for (at, turn) in self.turns.iter_mut().enumerate() {
            *turn = if at / stride % 4 == 3 { 1.0 } else { 0.0 };
        }
        for (element, turn) in memory.chunks_exact(4).enumerate() {
            let at = self.turn_index(element);
            (0..4).for_each(|part| self.turns[at + part * stride] = turn[part]);
        }
    }

    /// Hands the state out.
    pub(in crate::sim) fn store(&self, position: &mut [DVec3], velocity: &mut [DVec3], memory: &mut [f64]) {
        for (node, (position, velocity)) in position.iter_mut().zip(velocity).enumerate() {
            (*position, *velocity) = self.node(node);
        }
        let stride = self.grid.box_stride();
        for (element, turn) in memory.chunks_exact_mut(4).enumerate() {
            let at = self.turn_index(element);
            (0..4).for_each(|part| turn[part] = self.turns[at + part * stride]);
        }
    }

    fn turn_index(&self, element: usize) -> usize {
        let [x, y, z] = self.grid.place(element);
        z * 4 * self.grid.box_stride() + x + y * self.grid.row()
    }

    /// The position (m) and velocity (m/s) of a node.
    pub(in crate::sim) fn node(&self, node: usize) -> (DVec3, DVec3) {
        let (at, stride) = (self.index(node), self.grid.stride());
        let vector = |first: usize| DVec3::from_array([0, 1, 2].map(|axis| self.nodes[at + (first + axis) * stride]));
        (vector(0), vector(VELOCITY))
    }

    /// Puts a node somewhere else.
    pub(in crate::sim) fn set_node(&mut self, node: usize, position: DVec3, velocity: DVec3) {
        let (at, stride) = (self.index(node), self.grid.stride());
        for axis in 0..3 {
            self.nodes[at + axis * stride] = position[axis];
            self.nodes[at + (VELOCITY + axis) * stride] = velocity[axis];
        }
    }

    /// Takes steps of semi-implicit Euler.
    ///
    /// # Errors
    /// When a node would become faster than the limit. The state is then that before the step.
    pub(in crate::sim) fn step(&mut self, steps: u64, around: &Around<'_>) -> Result<(), Runaway> {
        self.before.0.copy_from_slice(&self.nodes);
        self.before.1.copy_from_slice(&self.turns);
        for step in 0..steps {
            if let Some(node) = self.sweep((around.speed_limit)(step), around) {
                self.nodes.copy_from_slice(&self.before.0);
                self.turns.copy_from_slice(&self.before.1);
                for again in 0..step {
                    self.sweep((around.speed_limit)(again), around);
                }
                return Err(Runaway { taken: step, node });
            }
        }
        Ok(())
    }

    /// One step; the first node that becomes too fast, if there is one, and then the step is not finished.
    fn sweep(&mut self, speed_limit: f64, around: &Around<'_>) -> Option<usize> {
        let Self { set, grid, parameters, nodes, turns, pattern, slab, .. } = self;
        let Parameters { stiffness, damping, rotation, gravity, step } = *parameters;
        let side = grid.sides.element_sum() / 3.0;
        let ratio = (grid.sides / side).to_array();
        let sweep = Sweep {
            nodes: nodes.as_mut_ptr(),
            turns: turns.as_mut_ptr(),
            live: pattern.live.as_ptr(),
            valence: pattern.valence.as_ptr(),
            pairs: slab.pairs.as_mut_ptr(),
            rows: slab.rows.as_mut_ptr(),
            below: slab.below.as_mut_ptr(),
            work: slab.work.as_mut_ptr(),
            grid: *grid,
            stride: grid.stride(),
            box_stride: grid.box_stride(),
            ring: grid.ring(),
            stiffness,
            damping,
            ratio,
            is_cube: ratio == [1.0; 3],
            // The columns of A at rest are 2 side², and half a side is left out of them.
            scale: 1.0 / (4.0 * side),
            half: 0.5 * side * stiffness,
            gain: (gravity * step).to_array(),
            step,
            limit: speed_limit * speed_limit,
            around,
        };
        let mut bad = None;
        macro_rules! run {
            ($damped:literal) => {
                match rotation {
                    Rotation::Optimum => set.run(Solved::<_, $damped>(&sweep, Optimum, &mut bad)),
                    Rotation::Arctangent { passes } => {
                        set.run(Solved::<_, $damped>(&sweep, Arctangent { passes }, &mut bad));
                    }
                }
            };
        }
        if damping == 0.0 {
            run!(false)
        } else {
            run!(true)
        }
        bad
    }
}

/// Everything a sweep reads and writes. See the fields of the same name.
///
/// A sweep works on a copy of its own, whose address nobody knows: else every store might change it.
#[derive(Clone, Copy)]
struct Sweep<'a> {
    nodes: *mut f64,
    turns: *mut f64,
    live: *const f64,
    valence: *const f64,
    pairs: *mut f64,
    rows: *mut f64,
    below: *mut f64,
    work: *mut f64,
    grid: Grid,
    stride: usize,
    box_stride: usize,
    ring: usize,
    stiffness: f64,
    damping: f64,
    /// The sides over their mean.
    ratio: [f64; 3],
    is_cube: bool,
    /// What makes sums of edges about 1.
    scale: f64,
    /// Half the mean side, times the stiffness (N).
    half: f64,
    /// What gravity adds to the velocity (m/s).
    gain: [f64; 3],
    step: f64,
    /// The square of the speed limit.
    limit: f64,
    around: &'a Around<'a>,
}

/// A sweep with a solver, damped or not.
struct Solved<'a, 'b, S, const DAMPED: bool>(&'a Sweep<'b>, S, &'a mut Option<usize>);

impl<S: Solver, const DAMPED: bool> Work for Solved<'_, '_, S, DAMPED> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self(&sweep, solver, bad) = self;
        let planes = sweep.grid.cells[2];
        // SAFETY: the arrays are those of a lattice, all of this grid, and borrowed by nobody else.
        unsafe {
            sweep.clear::<L>();
            let mut last_row = 0;
            for plane in 0..planes {
                if let Some(node) = sweep.plane::<L, S, DAMPED>(plane, solver, &mut last_row) {
                    *bad = Some(node);
                    return;
                }
            }
            *bad = sweep.top::<L, DAMPED>(planes);
        }
    }
}

impl Sweep<'_> {
    /// Makes the boxes below the first plane, and before its first row, pull at nothing.
    #[inline(always)]
    unsafe fn clear<L: Lanes>(&self) {
        // SAFETY: `below` has three strides, which are whole vectors; the rings are longer than a row in whole vectors.
        unsafe {
            for at in (0..3 * self.stride).step_by(L::WIDTH) {
                L::splat(0.0).store(self.below.add(at));
            }
            let row = self.grid.row().next_multiple_of(MOST);
            for part in 0..9 {
                for at in (self.ring - row..self.ring).step_by(L::WIDTH) {
                    L::splat(0.0).store(self.rows.add(part * (self.ring + MOST) + at));
                }
            }
        }
    }

    /// Steps the nodes of a plane, with the boxes between it and the next one. `own` is the place in the ring of rows, before
    /// which a row of zeros lies: the last nodes of a plane have no boxes.
    #[inline(always)]
    unsafe fn plane<L: Lanes, S: Solver, const DAMPED: bool>(
        &self,
        plane: usize,
        solver: S,
        own: &mut usize,
    ) -> Option<usize> {
        let zero = L::splat(0.0);
        let (row, layer) = (self.grid.row(), self.grid.layer());
        let (mut pull_before, mut rise_before) = ([zero; 3], [zero; 3]);
        let heights = if plane == 0 { 1.0 } else { 2.0 };
        // The nodes up to which pairs are known; places in the ring of pairs; the sums over two planes of the next nodes.
        let (mut known, mut end, mut here, mut next_row) = (0, 0, 0, row);
        // SAFETY: a plane has nodes, in whole vectors.
        let mut sums = unsafe { self.sums::<L, DAMPED>(plane, 0) };
        for chunk in (0..layer).step_by(CHUNK) {
            let boxes = self.box_stride.min(chunk + CHUNK);
            // SAFETY: `at` is a multiple of a width, below `layer`, and below the stride of boxes where they are asked for. A
            // chunk of `work` holds what is written to it. The ring holds the pairs of a chunk, a row and a vector more.
            unsafe {
                while known < boxes + row {
                    sums = self.pair::<L, DAMPED>(plane, known, end, sums);
                    known += L::WIDTH;
                    end = self.next(end, L::WIDTH);
                }
                let mut at = chunk;
                while at < boxes {
                    self.gather::<L, DAMPED>(at, here, next_row);
                    at += L::WIDTH;
                    here = self.next(here, L::WIDTH);
                    next_row = self.next(next_row, L::WIDTH);
                }
                let mut at = chunk;
                while at < boxes {
                    self.rotate::<L, S>(plane, at, solver);
                    at += L::WIDTH;
                }
                let mut at = chunk;
                while at < layer.min(chunk + CHUNK) {
                    let (pull, rise) = self.along_y::<L>(at, *own, at < boxes);
                    *own = self.next(*own, L::WIDTH);
                    // Along x, and then along z.
                    let mut force = [zero; 3];
                    thrice!(axis => {
                        let (high, low) = pull[axis];
                        let here = high.shift_in(pull_before[axis]) + low;
                        let up = rise[axis].shift_in(rise_before[axis]) + rise[axis];
                        (pull_before[axis], rise_before[axis]) = (high, rise[axis]);
                        let below = self.below.add(axis * self.stride + at);
                        force[axis] = L::load(below) + (here - up);
                        (here + up).store(below);
                    });
                    if let Some(node) = self.update::<L, DAMPED>(plane, at, heights, force) {
                        return Some(node);
                    }
                    at += L::WIDTH;
                }
            }
        }
        None
    }

    /// The place in a ring that lies so far behind another.
    #[inline(always)]
    fn next(&self, place: usize, way: usize) -> usize {
        let next = place + way;
        if next >= self.ring { next - self.ring } else { next }
    }

    /// Writes a number of each part to a ring; what lies across its end is there twice.
    #[inline(always)]
    unsafe fn put<L: Lanes, const PARTS: usize>(&self, ring: *mut f64, place: usize, values: &[[L; 3]; PARTS]) {
        let part = self.ring + MOST;
        // SAFETY: a ring has a vector more for each part, and places are multiples of a width.
        unsafe {
            let to = ring.add(place);
            for group in 0..PARTS {
                thrice!(axis => values[group][axis].store(to.add((3 * group + axis) * part)));
            }
            if place < MOST {
                let to = to.add(self.ring);
                for group in 0..PARTS {
                    thrice!(axis => values[group][axis].store(to.add((3 * group + axis) * part)));
                }
            }
        }
    }

    /// Of nodes the sums over this plane and the next of positions, of velocities, and the differences of positions.
    #[inline(always)]
    unsafe fn sums<L: Lanes, const DAMPED: bool>(&self, plane: usize, at: usize) -> [[L; 3]; 3] {
        let mut sums = [[L::splat(0.0); 3]; 3];
        // SAFETY: a stride holds whole vectors as far as boxes are gathered.
        unsafe {
            let low = self.nodes.add(plane * NODE * self.stride + at);
            let high = low.add(NODE * self.stride);
            thrice!(axis => {
                let (a, b) = (L::load(low.add(axis * self.stride)), L::load(high.add(axis * self.stride)));
                sums[axis][0] = a + b;
                sums[axis][1] = b - a;
                if DAMPED {
                    let place = (VELOCITY + axis) * self.stride;
                    sums[axis][2] = L::load(low.add(place)) + L::load(high.add(place));
                }
            });
        }
        sums
    }

    /// Writes the pairs of nodes, of which `sums` are known, and returns the sums of the next.
    #[inline(always)]
    unsafe fn pair<L: Lanes, const DAMPED: bool>(
        &self,
        plane: usize,
        at: usize,
        place: usize,
        sums: [[L; 3]; 3],
    ) -> [[L; 3]; 3] {
        // SAFETY: see `sums` and `put`.
        unsafe {
            let next = self.sums::<L, DAMPED>(plane, at + L::WIDTH);
            let right = each!(3, axis => sums[axis][0].shift_out(next[axis][0]));
            let pairs = [
                each!(3, axis => sums[axis][0] + right[axis]),
                each!(3, axis => right[axis] - sums[axis][0]),
                each!(3, axis => sums[axis][1] + sums[axis][1].shift_out(next[axis][1])),
            ];
            if DAMPED {
                let speeds = each!(3, axis => sums[axis][2] + sums[axis][2].shift_out(next[axis][2]));
                self.put(self.pairs, place, &[pairs[0], pairs[1], pairs[2], speeds]);
            } else {
                self.put(self.pairs, place, &pairs);
            }
            next
        }
    }

    /// Steps the nodes of the last plane, which has no boxes above.
    #[inline(always)]
    unsafe fn top<L: Lanes, const DAMPED: bool>(&self, plane: usize) -> Option<usize> {
        let mut at = 0;
        while at < self.grid.layer() {
            // SAFETY: `at` is a multiple of a width below `layer`.
            unsafe {
                let force = each!(3, axis => L::load(self.below.add(axis * self.stride + at)));
                if let Some(node) = self.update::<L, DAMPED>(plane, at, 1.0, force) {
                    return Some(node);
                }
            }
            at += L::WIDTH;
        }
        None
    }

    /// `w̄` of boxes, and the sums of their edges along each axis: the columns of `A` but for a factor. `here` and `next_row`
    /// are places in the ring of pairs.
    #[inline(always)]
    unsafe fn gather<L: Lanes, const DAMPED: bool>(&self, at: usize, here: usize, next_row: usize) {
        // SAFETY: `live` holds all boxes in whole vectors, a chunk of `work` what is written to it, and the ring whole
        // vectors from any place.
        unsafe {
            let work = self.work.add(at % CHUNK);
            let live = L::load(self.live.add(at));
            let (mean_of_p, mean_of_v) =
                (L::splat(0.125 * self.stiffness) * live, L::splat(0.125 * self.damping) * live);
            let both = |part: usize| {
                let from = self.pairs.add(part * (self.ring + MOST));
                (L::load(from.add(here)), L::load(from.add(next_row)))
            };
            thrice!(axis => {
                let ((sum0, sum1), (x0, x1), (z0, z1)) = (both(axis), both(3 + axis), both(6 + axis));
                let mut mean = mean_of_p * (sum0 + sum1);
                if DAMPED {
                    let (a, b) = both(9 + axis);
                    mean = mean_of_v.mul_add(a + b, mean);
                }
                let columns = [x0 + x1, sum1 - sum0, z0 + z1];
                thrice!(column => {
                    let mut edge = columns[column];
                    if !self.is_cube {
                        edge = edge * L::splat(self.ratio[column]);
                    }
                    edge.store(work.add((3 * column + axis) * CHUNK));
                });
                mean.store(work.add((9 + axis) * CHUNK));
            });
        }
    }

    /// The rotations of boxes, and with them `u`, `v` and `t`: the forces on the corners are `w̄ ± u ± v ± t`, without `−w`
    /// of the nodes.
    #[inline(always)]
    unsafe fn rotate<L: Lanes, S: Solver>(&self, plane: usize, at: usize, solver: S) {
        // SAFETY: `live` and the turns hold all boxes of a plane in whole vectors.
        unsafe {
            let work = self.work.add(at % CHUNK);
            let edges = each!(3, column => each!(3, axis => L::load(work.add((3 * column + axis) * CHUNK))));
            let live = L::load(self.live.add(at));
            let turns = self.turns.add(plane * 4 * self.box_stride + at);
            let last = each!(4, part => L::load(turns.add(part * self.box_stride)));
            let q = solver.follow(&edges, L::splat(self.scale), last, L::splat(0.0).lt(live));
            for part in 0..4 {
                q[part].store(turns.add(part * self.box_stride));
            }
            let shape = matrix(q, L::splat(self.half) * live);
            thrice!(column => {
                thrice!(axis => {
                    let mut part = shape[column][axis];
                    if !self.is_cube {
                        part = part * L::splat(self.ratio[column]);
                    }
                    part.store(work.add((3 * column + axis) * CHUNK));
                });
            });
        }
    }

    /// Adds what the boxes of two rows do to the nodes between: for each axis the sum for the next node along x and for the
    /// own, and the part that changes its sign along z.
    #[inline(always)]
    unsafe fn along_y<L: Lanes>(&self, at: usize, own: usize, is_box: bool) -> ([(L, L); 3], [L; 3]) {
        // SAFETY: a chunk of `work` holds boxes in whole vectors; see `put`, and the ring holds whole vectors from any place.
        unsafe {
            let work = self.work.add(at % CHUNK);
            let parts = each!(4, part => each!(3, axis => {
                if is_box { L::load(work.add((3 * part + axis) * CHUNK)) } else { L::splat(0.0) }
            }));
            let [u, v, t, mean] = parts;
            self.put(self.rows, own, &[each!(3, axis => mean[axis] + v[axis]), u, t]);
            // Of the row before, of which the first lanes may just have been written.
            let before = self.next(own, self.ring - self.grid.row());
            let get = |part: usize| L::load(self.rows.add(part * (self.ring + MOST) + before));
            let mut pull = [(mean[0], mean[0]); 3];
            let mut rise = t;
            thrice!(axis => {
                let sum = get(axis) + (mean[axis] - v[axis]);
                let along = get(3 + axis) + u[axis];
                pull[axis] = (sum + along, sum - along);
                rise[axis] = get(6 + axis) + t[axis];
            });
            (pull, rise)
        }
    }

    /// Eqs. (2) and (3) for nodes on which elements act with a force (N) besides `−w`, and what they meet. The first that
    /// becomes too fast, if there is one.
    #[inline(always)]
    unsafe fn update<L: Lanes, const DAMPED: bool>(
        &self,
        plane: usize,
        at: usize,
        heights: f64,
        force: [L; 3],
    ) -> Option<usize> {
        let layer = self.grid.layer();
        // SAFETY: a stride holds all nodes of a plane in whole vectors.
        unsafe {
            let node = self.nodes.add(plane * NODE * self.stride + at);
            let place = |of: usize| node.add(of * self.stride);
            let valence = L::load(self.valence.add(at)) * L::splat(heights);
            let push = L::load(place(PUSH));
            let (stiffness, damping) = (L::splat(self.stiffness) * valence, L::splat(self.damping) * valence);
            let mut gain = each!(3, axis => L::splat(self.gain[axis]));
            if at + L::WIDTH > layer {
                // What fills the last vector stays where it is.
                let nodes = L::mask((1 << (layer - at)) - 1);
                gain = each!(3, axis => gain[axis].select(nodes, L::splat(0.0)));
            }
            let (mut p, mut v) = ([push; 3], [push; 3]);
            thrice!(axis => {
                (p[axis], v[axis]) = (L::load(place(axis)), L::load(place(VELOCITY + axis)));
                let mut force = p[axis].neg_mul_add(stiffness, force[axis]);
                if DAMPED {
                    force = v[axis].neg_mul_add(damping, force);
                }
                v[axis] = force.mul_add(push, v[axis] + gain[axis]);
                p[axis] = v[axis].mul_add(L::splat(self.step), p[axis]);
            });
            let square = v[2].mul_add(v[2], v[1].mul_add(v[1], v[0] * v[0]));
            let kept = L::bits(square.le(L::splat(self.limit)));
            if kept != L::ALL {
                let node = plane * layer + at + (!kept).trailing_zeros() as usize;
                return Some(node);
            }
            let mut near = 0;
            for bound in self.around.bounds {
                near |= L::bits(within(bound, &p));
            }
            if near != 0 {
                let left = layer - at;
                (p, v) = meet(self.around.resolve, plane * layer + at, near & ((1 << left.min(MOST)) - 1), p, v);
            }
            thrice!(axis => {
                p[axis].store(place(axis));
                v[axis].store(place(VELOCITY + axis));
            });
        }
        None
    }
}

/// Lets those nodes whose bits are set meet what is around.
#[inline(always)]
fn meet<L: Lanes>(resolve: &Resolve<'_>, first: usize, near: u32, p: [L; 3], v: [L; 3]) -> ([L; 3], [L; 3]) {
    let (mut p, mut v) = (each!(3, axis => p[axis].to_array()), each!(3, axis => v[axis].to_array()));
    meet_one_by_one(resolve, first, near, &mut p, &mut v);
    (each!(3, axis => L::from_array(p[axis])), each!(3, axis => L::from_array(v[axis])))
}

#[inline(never)]
fn meet_one_by_one(resolve: &Resolve<'_>, first: usize, near: u32, p: &mut [[f64; MOST]; 3], v: &mut [[f64; MOST]; 3]) {
    for lane in (0..MOST).filter(|lane| near >> lane & 1 == 1) {
        let vector = |of: &[[f64; MOST]; 3]| DVec3::from_array([0, 1, 2].map(|axis| of[axis][lane]));
        let (mut position, mut velocity) = (vector(p), vector(v));
        resolve(first + lane, &mut position, &mut velocity, DVec3::ZERO);
        for axis in 0..3 {
            (p[axis][lane], v[axis][lane]) = (position[axis], velocity[axis]);
        }
    }
}

/// Which points lie within a bound.
#[inline(always)]
fn within<L: Lanes>(bound: &Bound, p: &[L; 3]) -> L::Mask {
    match *bound {
        Bound::HalfSpace { normal, height } => {
            let along = p[2].mul_add(L::splat(normal.z), p[1].mul_add(L::splat(normal.y), p[0] * L::splat(normal.x)));
            along.lt(L::splat(height))
        }
        Bound::Box { low, high } => {
            let between = |axis: usize| L::both(L::splat(low[axis]).lt(p[axis]), p[axis].lt(L::splat(high[axis])));
            L::both(between(0), L::both(between(1), between(2)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::body::{IndexLists, Solids, State};
    use crate::sim::contact::{Motion, Obstacle, Shape};
    use crate::sim::integrate::Integrator;
    use crate::sim::model::shape_based::{DampingReading, RotationReading, ShapeBased};
    use crate::sim::rotation::{davenport1968, moment};
    use crate::sim::world::{Stepping, Surroundings, World};
    use glam::DQuat;
    use std::sync::Arc;

    const STEP: f64 = 1e-3;
    const GRAVITY: DVec3 = DVec3::new(0.3, -9.8, 0.1);

    /// Numbers from −1 to 1 that look random.
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

    /// Turned, stretched, shaken and in flight, close above the floor.
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
        State { position, velocity }
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
        Obstacle { shape, motion: Motion::Still, pivot: DVec3::ZERO, restitution: 0.5, friction: 0.3 }
    }

    fn bound(floor: &Obstacle) -> Bound {
        let Shape::Floor { normal, height } = floor.shape else { unreachable!() };
        Bound::HalfSpace { normal, height: height + 1e-9 }
    }

    fn run(body: &Body, state: &State, parameters: Parameters, set: Set, calls: u64, steps: u64) -> (State, Vec<f64>) {
        let mut lattice = Lattice::new(body, parameters, set).expect("a lattice");
        let mut memory = turns(body, state);
        lattice.load(&state.position, &state.velocity, &memory);
        let floor = floor();
        let resolve = |_: usize, p: &mut DVec3, v: &mut DVec3, a: DVec3| floor.at(0.0, STEP).rebound(p, v, a);
        let around = Around { bounds: &[bound(&floor)], resolve: &resolve, speed_limit: &|_| 1e6 };
        for _ in 0..calls {
            lattice.step(steps, &around).expect("no runaway");
        }
        let mut state = state.clone();
        lattice.store(&mut state.position, &mut state.velocity, &mut memory);
        (state, memory)
    }

    fn reference(body: &Arc<Body>, state: &State, parameters: Parameters, steps: u64) -> State {
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
        let stepping = Stepping { integrator: Integrator::SemiImplicitEuler, step: STEP };
        let mut world = World::new(body, state.clone(), &model, surroundings, stepping);
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
                    let (found, _) = run(&body, &state, parameters, Set::best(), 10, 100);
                    let distance = distance(&reference(&body, &state, parameters, 1000), &found);
                    assert!(distance < 1e-12, "{cells:?} {sides} {parameters:?}: {distance}");
                }
            }
        }
    }

    #[test]
    fn every_set_has_the_same_bits() {
        for cells in EXTENTS {
            let body = lattice(cells, DVec3::new(0.5, 0.3, 0.8));
            // Shaken so much that some elements turn over.
            let state = start(&body, 0.6);
            for rotation in [Rotation::Optimum, Rotation::Arctangent { passes: 2 }] {
                let all = Set::all().map(|set| run(&body, &state, parameters(0.3, rotation), set, 1, 300));
                let all: Vec<_> = all.collect();
                assert!(all.windows(2).all(|two| two[0] == two[1]), "{cells:?} {rotation:?}");
            }
        }
    }
}
