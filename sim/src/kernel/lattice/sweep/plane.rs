//! One plane of boxes and the nodes below it: gather, moments, rotations, forces and update in lanes.

use super::Sweep;
use crate::kernel::damped::{DEFORMING, NONE, RELATIVE};
use crate::kernel::general::{NONE as NOBODY, first_of};
use crate::kernel::lattice::{ACCELERATION, CHUNK, INVERSE_MASS, MEAN, TURN, VELOCITY, slot};
use crate::kernel::rotation::{Moments, Solver, choose, cross, matrix, turn, turned_back};
use crate::kernel::update::{NodeUpdate, NodeVector};
use crate::lanes::{Lanes, MOST, each};
use crate::law::Turning;

/// The numbers of a square of four nodes along x and z: their sum, their differences along x and z, the sum of their velocities, and the
/// sums of their [`Turning`]. Only the first [`parts`] are there.
const SUM: usize = 0;
const ALONG_X: usize = 3;
const ALONG_Z: usize = 6;
const SPEED: usize = 9;
const TURNING: usize = 12;

/// Count of numbers for each square.
const fn parts(damping: u8) -> usize {
    match damping {
        NONE => 9,
        RELATIVE => 12,
        _ => 21,
    }
}

/// The squares at both ends of boxes along y.
struct Ends<L: Lanes> {
    near: *const f64,
    far: *const f64,
    /// The distance between parts.
    part: usize,
    distance: L::Distance,
    line: usize,
}

impl<L: Lanes> Ends<L> {
    /// One number of the squares at the lower and at the upper ends.
    #[inline(always)]
    unsafe fn get(&self, number: usize) -> [L; 2] {
        // SAFETY: the ring buffer has these parts in whole vectors, and a vector more.
        unsafe {
            let beyond = L::load_beyond(self.far.add(number * self.part), self.distance, self.line);
            [L::load(self.near.add(number * self.part)), beyond]
        }
    }

    /// The sum of both.
    #[inline(always)]
    unsafe fn sum(&self, number: usize) -> L {
        // SAFETY: the caller's.
        let [near, far] = unsafe { self.get(number) };
        near + far
    }
}

impl Sweep<'_> {
    /// Evaluates the boxes above a plane of nodes, and steps its nodes. Their forces on the next plane are written to
    /// `above`. If the plane `is_shared`, its nodes are not stepped yet.
    #[inline(always)]
    pub(super) unsafe fn plane<L: Lanes, S: Solver, const DAMPING: u8>(
        &self,
        plane: usize,
        update: &NodeUpdate<'_, L>,
        solver: S,
        commit: bool,
        above: *mut f64,
        is_shared: bool,
    ) -> Option<usize> {
        let zero = L::splat(0.0);
        let layer = self.grid.layer();
        let (mut pull_before, mut rise_before, mut spin_before) = ([zero; 3], [zero; 3], [zero; 3]);
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
                self.put_row::<L, DAMPING>(at, &[[zero; 3]; 4]);
            }
            for chunk in (0..layer).step_by(CHUNK) {
                let boxes = self.box_stride.min(chunk + CHUNK);
                let end = layer.min(chunk + CHUNK);
                filled = self.boxes::<L, S, DAMPING>(plane, [chunk, boxes], own, filled, solver, commit);
                for at in (chunk..end).step_by(L::WIDTH) {
                    let (pull, rise, spin) = self.along_y::<L, DAMPING>(at, own, at < boxes);
                    own = self.next(own, L::WIDTH);
                    let work = self.work.add(at % CHUNK);
                    let first = slot(at, 3);
                    // Along x, and then along z.
                    let [mut to_low, mut to_high] = each!(2, _side => [zero; 3]);
                    each!(3, axis => {
                        let (high, low) = pull[axis];
                        let here = high.shift_in(pull_before[axis]) + low;
                        let up = rise[axis].shift_in(rise_before[axis]) + rise[axis];
                        (pull_before[axis], rise_before[axis]) = (high, rise[axis]);
                        (to_low[axis], to_high[axis]) = (here - up, here + up);
                    });
                    if DAMPING == DEFORMING {
                        let all = each!(3, axis => spin[axis].shift_in(spin_before[axis]) + spin[axis]);
                        spin_before = spin;
                        to_low = self.turned(plane, at, &all, to_low);
                        to_high = self.turned(plane + 1, at, &all, to_high);
                    }
                    each!(3, axis => {
                        let force = if is_shared {
                            to_low[axis].store(lowest.add(first + axis * MOST));
                            zero
                        } else {
                            L::load(below.add(first + axis * MOST)) + to_low[axis]
                        };
                        force.store(work.add(axis * CHUNK));
                        to_high[axis].store(above.add(first + axis * MOST));
                    });
                }
                if !is_shared {
                    let force = |at: usize| each!(3, axis => L::load(self.work.add(axis * CHUNK + at % CHUNK)));
                    if let Some(node) = self.update::<L, DAMPING>(plane, [chunk, end], update, force) {
                        return Some(node);
                    }
                }
            }
        }
        None
    }

    /// Forces on nodes (N) with those of boxes of which the sum of `D ω` is `spin` (N/m).
    #[inline(always)]
    unsafe fn turned<L: Lanes>(&self, plane: usize, at: usize, spin: &[L; 3], force: [L; 3]) -> [L; 3] {
        // SAFETY: the caller passes an existing plane and less than a stride.
        let position = unsafe {
            let from = self.nodes(plane, at);
            each!(3, axis => L::load(from.add(axis * MOST)))
        };
        let turning = cross(spin, &position);
        each!(3, axis => force[axis] + turning[axis])
    }

    /// Steps the nodes of a plane between boxes on both sides, whose forces (N) are known.
    #[inline(always)]
    pub(super) unsafe fn nodes_between<L: Lanes, const DAMPING: u8>(
        &self,
        plane: usize,
        update: &NodeUpdate<'_, L>,
        pulls: impl Fn(usize) -> (L, L),
    ) -> Option<usize> {
        let force = |at: usize| {
            each!(3, axis => {
                let (below, above) = pulls(slot(at, 3) + axis * MOST);
                below + above
            })
        };
        // SAFETY: these are the nodes of a plane.
        unsafe { self.update::<L, DAMPING>(plane, [0, self.grid.layer()], update, force) }
    }

    /// The place in a ring buffer `steps` after another.
    #[inline(always)]
    fn next(&self, place: usize, steps: usize) -> usize {
        let next = place + steps;
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
                each!(3, axis => values[group][axis].store(to.add((3 * group + axis) * part)));
            }
            if place < MOST {
                let (first, _) = self.ring_place::<L>(place + self.ring, 3 * PARTS);
                let to = ring.add(first);
                for group in 0..PARTS {
                    each!(3, axis => values[group][axis].store(to.add((3 * group + axis) * part)));
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
    unsafe fn boxes<L: Lanes, S: Solver, const DAMPING: u8>(
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
                place = self.squares::<L, DAMPING>(plane, filled, needed, place);
                filled = needed;
            }
            for pass in 0..passes {
                let is_last = pass + 1 == passes;
                let mut here = own;
                for at in (first..end).step_by(L::WIDTH) {
                    let work = self.work.add(at % CHUNK);
                    let ends = self.ends::<L, DAMPING>(here);
                    let (edges, sum) = self.edges(&ends);
                    if pass == 0 {
                        let live = L::load(self.live.add(at));
                        lanes[at % CHUNK][0] = L::bits(L::splat(0.0).lt(live)) as u8;
                        let mean = self.mean::<L, DAMPING>(&ends, &sum, live);
                        each!(3, axis => mean[axis].store(work.add((MEAN + axis) * CHUNK)));
                    }
                    here = self.next(here, L::WIDTH);
                    let last = self.turns::<L>(plane, at, pass == 0);
                    let b = turned_back(&self.along_sides(edges), &matrix(last, scale));
                    each!(3, row => each!(3, column => b[row][column].store(work.add((3 * row + column) * CHUNK))));
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
                        let (edges, _) = self.edges(&self.ends::<L, DAMPING>(here));
                        let of = Moments { a: &self.along_sides(edges), scale, tally: commit.then_some(self.tally) };
                        q = solver.go_on(of, q, late, failed);
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

    /// The rotations of boxes, of the last step or of the previous pass.
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

    /// Writes the numbers of squares of four nodes along x and z, in a range of nodes; see [`SUM`]. Returns the place in the ring
    /// buffer after them.
    #[inline(always)]
    unsafe fn squares<L: Lanes, const DAMPING: u8>(
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
                        let (v, w) = if DAMPING != NONE {
                            (L::load(low.add(VELOCITY * MOST)), L::load(high.add(VELOCITY * MOST)))
                        } else {
                            (L::splat(0.0), L::splat(0.0))
                        };
                        (a + b, b - a, v + w, w - v)
                    })
                }};
            }
            let mut left = upright!(from);
            for at in (from..to).step_by(L::WIDTH) {
                let next = upright!(at + L::WIDTH);
                let right = each!(3, axis => left[axis].0.shift_out(next[axis].0));
                let sum = each!(3, axis => left[axis].0 + right[axis]);
                let x = each!(3, axis => right[axis] - left[axis].0);
                let beside = each!(3, axis => left[axis].1.shift_out(next[axis].1));
                let z = each!(3, axis => left[axis].1 + beside[axis]);
                let v = each!(3, axis => left[axis].2.shift_out(next[axis].2));
                let speed = each!(3, axis => left[axis].2 + v[axis]);
                let ring = self.slabs.add(self.slab.squares);
                match DAMPING {
                    NONE => self.put(ring, place, &[sum, x, z]),
                    RELATIVE => self.put(ring, place, &[sum, x, z, speed]),
                    _ => {
                        let w = each!(3, axis => left[axis].3.shift_out(next[axis].3));
                        let both = each!(3, axis => beside[axis] - left[axis].1);
                        let mut turning = Turning::new();
                        turning.add(x, x, each!(3, axis => v[axis] - left[axis].2));
                        turning.add(z, z, each!(3, axis => left[axis].3 + w[axis]));
                        turning.add(both, both, each!(3, axis => w[axis] - left[axis].3));
                        let [xx, yy, zz, xy, xz, yz] = turning.squares;
                        self.put(ring, place, &[sum, x, z, speed, [xx, yy, zz], [xy, xz, yz], turning.momentum]);
                    }
                }
                place = self.next(place, L::WIDTH);
                left = next;
            }
        }
        place
    }

    /// The squares of boxes; `own` is the place of those at the lower ends along y.
    #[inline(always)]
    unsafe fn ends<L: Lanes, const DAMPING: u8>(&self, own: usize) -> Ends<L> {
        let beyond = self.next(own, self.grid.row());
        let (near, part) = self.ring_place::<L>(own, parts(DAMPING));
        let (far, _) = self.ring_place::<L>(beyond / MOST * MOST, parts(DAMPING));
        // SAFETY: both places are in the ring buffer.
        let [near, far] = unsafe { [near, far].map(|place| self.slabs.add(self.slab.squares + place).cast_const()) };
        Ends { near, far, part, distance: L::distance(beyond % MOST), line: MOST * parts(DAMPING) }
    }

    /// The sums of the edges of boxes along each axis, and the sum of their corners.
    #[inline(always)]
    unsafe fn edges<L: Lanes>(&self, ends: &Ends<L>) -> ([[L; 3]; 3], [L; 3]) {
        let mut edges = [[L::splat(0.0); 3]; 3];
        let mut sum = [L::splat(0.0); 3];
        // SAFETY: all squares have these numbers.
        each!(3, axis => unsafe {
            let [near, far] = ends.get(SUM + axis);
            edges[0][axis] = ends.sum(ALONG_X + axis);
            edges[1][axis] = far - near;
            edges[2][axis] = ends.sum(ALONG_Z + axis);
            sum[axis] = near + far;
        });
        (edges, sum)
    }

    /// Columns times the sides of boxes, divided by the mean side: from sums of edges the columns of `A` except for a factor.
    #[inline(always)]
    fn along_sides<L: Lanes>(&self, columns: [[L; 3]; 3]) -> [[L; 3]; 3] {
        if self.is_cube {
            return columns;
        }
        each!(3, column => each!(3, axis => columns[column][axis] * L::splat(self.ratio[column])))
    }

    /// `w̄` of boxes, from the sum of their corners.
    #[inline(always)]
    unsafe fn mean<L: Lanes, const DAMPING: u8>(&self, ends: &Ends<L>, sum: &[L; 3], live: L) -> [L; 3] {
        let (of_p, of_v) = (L::splat(0.125 * self.stiffness) * live, L::splat(0.125 * self.damping) * live);
        each!(3, axis => {
            let mean = of_p * sum[axis];
            // SAFETY: with damping, squares have the sums of velocities.
            if DAMPING == NONE { mean } else { of_v.mul_add(unsafe { ends.sum(SPEED + axis) }, mean) }
        })
    }

    /// `D ω` of boxes (N/m), and the force on a corner that does not depend on the corner (N).
    #[inline(always)]
    unsafe fn spin<L: Lanes>(&self, ends: &Ends<L>, live: L) -> [[L; 3]; 2] {
        // SAFETY: with this damping, squares have these numbers.
        unsafe {
            let mut turning = Turning {
                squares: each!([0, 1, 2, 3, 4, 5], entry => ends.sum(TURNING + entry)),
                momentum: each!(3, axis => ends.sum(TURNING + 6 + axis)),
            };
            let positions = each!(3, axis => ends.get(SUM + axis));
            let y = each!(3, axis => positions[axis][1] - positions[axis][0]);
            let v = each!(3, axis => {
                let [near, far] = ends.get(SPEED + axis);
                far - near
            });
            turning.add(each!(3, axis => L::splat(0.5) * y[axis]), y, v);
            let (spin, d) = (turning.spin(), L::splat(self.damping) * live);
            let spin = each!(3, axis => spin[axis] * d);
            let middle = each!(3, axis => L::splat(-0.125) * (positions[axis][0] + positions[axis][1]));
            [spin, cross(&spin, &middle)]
        }
    }

    /// `u`, `v` and `t` of boxes.
    #[inline(always)]
    unsafe fn shape<L: Lanes>(&self, at: usize, ends: &Ends<L>, live: L) -> [[L; 3]; 3] {
        // SAFETY: a chunk of `work` has boxes in whole vectors.
        unsafe {
            let work = self.work.add(at % CHUNK);
            let q = each!(4, part => L::load(work.add((TURN + part) * CHUNK)));
            let mut shape = self.along_sides(matrix(q, L::splat(self.half) * live));
            if self.maps.are_used {
                let (edges, _) = self.edges(ends);
                let [x, y, z] = &edges;
                let cofactors = [cross(y, z), cross(z, x), cross(x, y)];
                let product = each!(3, axis => x[axis] * cofactors[0][axis]);
                let volume = (product[0] + product[1]) + product[2];
                let excess = volume.mul_sub(L::splat(self.maps.per_volume), L::splat(1.0));
                let (pressure, affine) =
                    (L::splat(self.maps.pressure) * live * excess, L::splat(self.maps.affine) * live);
                shape = each!(3, column => each!(3, axis => {
                    let rest = affine.neg_mul_add(edges[column][axis], shape[column][axis]);
                    pressure.neg_mul_add(cofactors[column][axis], rest)
                }));
            }
            shape
        }
    }

    /// Writes `w̄ + v`, `u`, `t` and, where it is needed, `D ω` of boxes.
    #[inline(always)]
    unsafe fn put_row<L: Lanes, const DAMPING: u8>(&self, own: usize, [sum, u, t, spin]: &[[L; 3]; 4]) {
        // SAFETY: see `put`.
        unsafe {
            let rows = self.slabs.add(self.slab.rows);
            if DAMPING == DEFORMING {
                self.put(rows, own, &[*sum, *u, *t, *spin]);
            } else {
                self.put(rows, own, &[*sum, *u, *t]);
            }
        }
    }

    /// Adds up the forces of the boxes of two rows on the nodes between: for each axis the sums for the next node along
    /// x and for the node itself, and the part whose sign changes along z; and their `D ω`.
    #[inline(always)]
    unsafe fn along_y<L: Lanes, const DAMPING: u8>(
        &self,
        at: usize,
        own: usize,
        is_box: bool,
    ) -> ([(L, L); 3], [L; 3], [L; 3]) {
        // SAFETY: `live` has all boxes of a plane in whole vectors, and a chunk of `work` those of a chunk; see `put`. The ring
        // buffers can be read from any place.
        unsafe {
            let work = self.work.add(at % CHUNK);
            let zero = [L::splat(0.0); 3];
            let ([mut u, mut v, mut t], mut mean, mut spin) = ([zero; 3], zero, zero);
            if is_box {
                let (ends, live) = (self.ends::<L, DAMPING>(own), L::load(self.live.add(at)));
                [u, v, t] = self.shape(at, &ends, live);
                mean = each!(3, axis => L::load(work.add((MEAN + axis) * CHUNK)));
                if DAMPING == DEFORMING {
                    let [turning, still] = self.spin(&ends, live);
                    (spin, mean) = (turning, each!(3, axis => mean[axis] + still[axis]));
                }
            }
            self.put_row::<L, DAMPING>(own, &[each!(3, axis => mean[axis] + v[axis]), u, t, spin]);
            // From the previous row. Its first lanes may just have been written.
            let parts = if DAMPING == DEFORMING { 12 } else { 9 };
            let before = self.next(own, self.ring - self.grid.row());
            let (from, part) = self.ring_place::<L>(before / MOST * MOST, parts);
            let from = self.slabs.add(self.slab.rows + from);
            let (distance, line) = (L::distance(before % MOST), MOST * parts);
            let mut pull = [(mean[0], mean[0]); 3];
            let mut rise = t;
            each!(3, axis => {
                let sum = L::load_beyond(from.add(axis * part), distance, line) + (mean[axis] - v[axis]);
                let along = L::load_beyond(from.add((3 + axis) * part), distance, line) + u[axis];
                pull[axis] = (sum + along, sum - along);
                rise[axis] = L::load_beyond(from.add((6 + axis) * part), distance, line) + t[axis];
                if DAMPING == DEFORMING {
                    spin[axis] = L::load_beyond(from.add((9 + axis) * part), distance, line) + spin[axis];
                }
            });
            (pull, rise, spin)
        }
    }

    /// Eqs. (2) and (3) and contact for a range of nodes of a plane, on which elements act with a force (N) in addition
    /// to `−w`. Returns the first node that becomes too fast, if any.
    #[inline(always)]
    unsafe fn update<L: Lanes, const DAMPING: u8>(
        &self,
        plane: usize,
        [first, end]: [usize; 2],
        update: &NodeUpdate<'_, L>,
        force: impl Fn(usize) -> [L; 3],
    ) -> Option<usize> {
        let planes = if plane == 0 || plane == self.grid.cells[2] { 1.0 } else { 2.0 };
        let (stiffness, damping) = (L::splat(planes * self.stiffness), L::splat(planes * self.damping));
        let stage = update.stage();
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
                let acceleration = if stage.loads_acceleration() { load(to, ACCELERATION) } else { [zero; 3] };
                let mut nodes = NodeVector { position: load(to, 0), velocity: load(to, VELOCITY), acceleration };
                let mut total = force(at);
                each!(3, axis => {
                    total[axis] = nodes.position[axis].neg_mul_add(stiffness, total[axis]);
                    if DAMPING != NONE {
                        total[axis] = nodes.velocity[axis].neg_mul_add(damping, total[axis]);
                    }
                });
                let total = update.pushed(total, |lane| plane * self.grid.layer() + at + lane);
                let lost = update.go(&mut nodes, total, inverse_mass(to));
                if lost != 0
                    && let Some(first) = self.first_lost(plane * self.grid.layer() + at, lost)
                {
                    return Some(first);
                }
                near |= update.near(&nodes);
                each!(3, axis => {
                    nodes.position[axis].store(to.add(axis * MOST));
                    nodes.velocity[axis].store(to.add((VELOCITY + axis) * MOST));
                });
                if stage.stores_acceleration() {
                    each!(3, axis => nodes.acceleration[axis].store(to.add((ACCELERATION + axis) * MOST)));
                }
            }
            if near == 0 {
                return None;
            }
            for at in (first..end).step_by(L::WIDTH) {
                let to = self.nodes(plane, at);
                let acceleration = if stage.keeps_acceleration() { load(to, ACCELERATION) } else { [zero; 3] };
                let mut nodes = NodeVector { position: load(to, 0), velocity: load(to, VELOCITY), acceleration };
                update.meet(&mut nodes, inverse_mass(to), |lane| plane * self.grid.layer() + at + lane);
                each!(3, axis => {
                    nodes.position[axis].store(to.add(axis * MOST));
                    nodes.velocity[axis].store(to.add((VELOCITY + axis) * MOST));
                });
            }
        }
        None
    }

    /// The first of the nodes from `from` on that is too fast, by the bits of `lanes`, and that no grip holds. It is apart from the
    /// loop over nodes, which would be a sixth longer with it.
    #[cold]
    #[inline(never)]
    fn first_lost(&self, from: usize, lanes: u32) -> Option<usize> {
        let first = first_of(NOBODY, lanes, self.around.held, |lane| (from + lane) as u32);
        (first != NOBODY).then_some(first as usize)
    }
}
