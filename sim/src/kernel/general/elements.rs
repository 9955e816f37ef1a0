//! The laws of elements and springs in lanes: their contributions to the sums of their nodes.

use super::{Class, Constants, Part, RECORD, SUM};
use crate::kernel::memory::Aligned;
use crate::kernel::rotation::{self, Moments, Solver};
use crate::kernel::tally::Tally;
use crate::lanes::{Lanes, MOST, each};

/// The elements of one class of a part.
pub(super) struct Elements<'a> {
    pub(super) part: &'a Part,
    /// Of the nodes of the part.
    pub(super) sums: &'a Aligned,
    pub(super) class: &'a Class,
    pub(super) constants: &'a Constants,
    pub(super) commit: bool,
    pub(super) tally: &'a Tally,
    /// [`General::is_large`](super::General::is_large).
    pub(super) is_large: bool,
}

/// Blocks in a batch, for which first all moments are computed, then all rotations, then all forces. A rotation is a
/// long chain of dependent operations; the processor overlaps those of several blocks.
const BATCH: usize = 4;

/// The sum of a node, from the start of its record. Sums are half as long as records, and an `f32` is half as long as a
/// double, so the offset of the record can be used directly. That saves a shift for each corner.
///
/// # Safety
/// The record has such a sum.
#[inline(always)]
unsafe fn sum_of(sums: *mut f64, record: u32) -> *mut f64 {
    const { assert!(2 * SUM == RECORD) };
    // SAFETY: the caller's.
    unsafe { sums.cast::<f32>().add(record as usize).cast() }
}

/// The contributions of a block's elements to all their corners, lane by lane: in space `w̄` and `k M`, and behind them the
/// rotations between two passes.
#[repr(C, align(64))]
struct Block<const ROWS: usize>([[f64; MOST]; ROWS]);

/// Where these rotations are.
const TURN: usize = 12;

impl Elements<'_> {
    /// Eq. (4) in space.
    #[inline(always)]
    pub(super) fn space<L: Lanes, const DAMPED: bool>(&self, solver: impl Solver) {
        let &Self { part, sums, class, constants, commit, tally, is_large } = self;
        let tally = commit.then_some(tally);
        let corners = class.corners;
        let (records, sums) = (part.records.pointer(), sums.pointer());
        let k = L::splat(constants.stiffness);
        let k_mean = L::splat(constants.stiffness / corners as f64);
        let d_mean = L::splat(constants.damping / corners as f64);
        let zero = L::splat(0.0);
        let blocks = class.elements.len().div_ceil(MOST);
        let ahead = if is_large { 2 * BATCH } else { BATCH };
        let mut batch = [const { Block([[0.0; MOST]; TURN + 4]) }; BATCH];
        for begin in (0..blocks).step_by(BATCH) {
            let batch = &mut batch[..BATCH.min(blocks - begin)];
            // SAFETY: the arrays have an entry for each block, corner, coordinate and lane; the records named are the
            // part's, which is this thread's.
            unsafe {
                for (block, sums) in (begin..).zip(&mut *batch) {
                    let nodes = class.nodes.as_ptr().add(block * corners * MOST);
                    let rest = class.rest.pointer().add(block * corners * 3 * MOST);
                    for lanes in (0..MOST).step_by(L::WIDTH) {
                        let (mut position, mut velocity, mut a) = ([zero; 3], [zero; 3], [[zero; 3]; 3]);
                        let mut first = [zero; 3];
                        for corner in 0..corners {
                            let node = nodes.add(corner * MOST + lanes);
                            let [px, py, vx, vy, pz, vz, ..] =
                                L::columns(|lane| records.add(*node.add(lane) as usize).cast_const());
                            let v = [vx, vy, vz];
                            if corner == 0 {
                                first = [px, py, pz];
                            }
                            // Relative to the first corner, so that an element with all corners at one point gives
                            // exactly zero.
                            let p = [px - first[0], py - first[1], pz - first[2]];
                            for axis in 0..3 {
                                position[axis] = position[axis] + p[axis];
                                if DAMPED {
                                    velocity[axis] = velocity[axis] + v[axis];
                                }
                                let rest = L::load(rest.add((corner * 3 + axis) * MOST + lanes));
                                a[axis] = each!(3, row => p[row].mul_add(rest, a[axis][row]));
                            }
                        }
                        for axis in 0..3 {
                            let mut mean = position[axis].mul_add(k_mean, first[axis] * k);
                            if DAMPED {
                                mean = velocity[axis].mul_add(d_mean, mean);
                            }
                            mean.store(sums.0[axis].as_mut_ptr().add(lanes));
                            each!(3, row => a[axis][row].store(sums.0[3 + 3 * axis + row].as_mut_ptr().add(lanes)));
                        }
                    }
                }
                let passes = solver.passes();
                let mut open = [[0; MOST]; BATCH];
                for pass in 1..=passes {
                    for (block, (out, open)) in (begin..).zip(batch.iter_mut().zip(&mut open)) {
                        for lanes in (0..MOST).step_by(L::WIDTH) {
                            let out = out.0.as_mut_ptr().cast::<f64>().add(lanes);
                            let turns = class.turns.pointer().add(block * 4 * MOST + lanes);
                            let a = each!(3, axis => each!(3, row => L::load(out.add((3 + 3 * axis + row) * MOST))));
                            let scale = L::load(class.scale.pointer().add(block * MOST + lanes));
                            let last = if pass == 1 {
                                let left = class.elements.len().saturating_sub(block * MOST + lanes);
                                open[lanes] = (1 << left.min(L::WIDTH)) - 1;
                                each!(4, entry => L::load(turns.add(entry * MOST)))
                            } else {
                                each!(4, entry => L::load(out.add((TURN + entry) * MOST)))
                            };
                            let of = Moments { a: &a, scale, tally };
                            let (turn, next) = solver.step(of, last, open[lanes], pass == passes);
                            if pass < passes {
                                open[lanes] = next;
                                each!(4, entry => turn[entry].store(out.add((TURN + entry) * MOST)));
                                continue;
                            }
                            if commit {
                                each!(4, entry => turn[entry].store(turns.add(entry * MOST)));
                            }
                            let matrix = rotation::matrix(turn, k);
                            each!(3, axis => each!(3, row =>
                                matrix[axis][row].store(out.add((3 + 3 * axis + row) * MOST))));
                        }
                    }
                }
                for (block, out) in (begin..).zip(&*batch) {
                    let nodes = class.nodes.as_ptr().add(block * corners * MOST);
                    let rest = class.rest.pointer().add(block * corners * 3 * MOST);
                    // Prefetches the data of the next batch, which are not in the second-level cache. Those of a large
                    // body take longer to arrive: here of the batch after it, and the records of the next one.
                    let turns = class.turns.pointer().wrapping_add((block + ahead) * 4 * MOST);
                    each!(4, entry => L::expect(turns.wrapping_add(entry * MOST)));
                    if is_large && block + BATCH < blocks {
                        let nodes = nodes.add(BATCH * corners * MOST);
                        for corner in 0..corners * MOST {
                            L::expect(records.add(*nodes.add(corner) as usize));
                        }
                    }
                    let expect_corner = |corner: usize| {
                        let corner = ahead * corners + corner;
                        each!(3, axis => L::expect(rest.wrapping_add((corner * 3 + axis) * MOST)));
                        L::expect(nodes.wrapping_add(corner * MOST).cast());
                    };
                    if L::WIDTH == MOST {
                        let out = out.0.as_ptr().cast::<f64>();
                        let w = each!(3, axis => L::load(out.add(axis * MOST)));
                        let m = each!(3, axis => each!(3, row => L::load(out.add((3 + 3 * axis + row) * MOST))));
                        for corner in 0..corners {
                            let node = nodes.add(corner * MOST);
                            expect_corner(corner);
                            let [x, y, z] = each!(3, axis => L::load(rest.add((corner * 3 + axis) * MOST)));
                            let [fx, fy, fz] = each!(3, axis =>
                                z.mul_add(m[2][axis], y.mul_add(m[1][axis], x.mul_add(m[0][axis], w[axis]))));
                            L::add_rows([fx, fy, fz, zero], |lane| sum_of(sums, *node.add(lane)));
                        }
                        continue;
                    }
                    for corner in 0..corners {
                        expect_corner(corner);
                        for lanes in (0..MOST).step_by(L::WIDTH) {
                            let node = nodes.add(corner * MOST + lanes);
                            let out = out.0.as_ptr().cast::<f64>().add(lanes);
                            let [x, y, z] = each!(3, axis => L::load(rest.add((corner * 3 + axis) * MOST + lanes)));
                            let [fx, fy, fz] = each!(3, axis => {
                                let [mx, my, mz] = each!(3, column => L::load(out.add((3 + 3 * column + axis) * MOST)));
                                let w = L::load(out.add(axis * MOST));
                                z.mul_add(mz, y.mul_add(my, x.mul_add(mx, w)))
                            });
                            L::add_rows([fx, fy, fz, zero], |lane| sum_of(sums, *node.add(lane)));
                        }
                    }
                }
            }
        }
    }

    /// Eq. (4) in the plane, with the rotation of Eq. (9).
    #[inline(always)]
    pub(super) fn plane<L: Lanes, const DAMPED: bool>(&self) {
        let &Self { part, sums, class, constants, commit, .. } = self;
        let corners = class.corners;
        let (records, sums) = (part.records.pointer(), sums.pointer());
        let k = L::splat(constants.stiffness);
        let k_mean = L::splat(constants.stiffness / corners as f64);
        let d_mean = L::splat(constants.damping / corners as f64);
        let zero = L::splat(0.0);
        for block in 0..class.elements.len().div_ceil(MOST) {
            let mut out = Block([[0.0; MOST]; 4]);
            // SAFETY: as in space.
            unsafe {
                let nodes = class.nodes.as_ptr().add(block * corners * MOST);
                let rest = class.rest.pointer().add(block * corners * 2 * MOST);
                let turns = class.turns.pointer().add(block * 2 * MOST);
                for lanes in (0..MOST).step_by(L::WIDTH) {
                    let (mut position, mut velocity, mut turn) = ([zero; 2], [zero; 2], [zero; 2]);
                    let mut first = [zero; 2];
                    for corner in 0..corners {
                        let node = nodes.add(corner * MOST + lanes);
                        let [px, py, vx, vy] = L::columns_4(|lane| records.add(*node.add(lane) as usize).cast_const());
                        let [x, y] = each!(2, axis => L::load(rest.add((corner * 2 + axis) * MOST + lanes)));
                        if corner == 0 {
                            first = [px, py];
                        }
                        let (px, py) = (px - first[0], py - first[1]);
                        position = [position[0] + px, position[1] + py];
                        if DAMPED {
                            velocity = [velocity[0] + vx, velocity[1] + vy];
                        }
                        turn[0] = y.mul_add(py, x.mul_add(px, turn[0]));
                        turn[1] = y.neg_mul_add(px, x.mul_add(py, turn[1]));
                    }
                    let last = each!(2, entry => L::load(turns.add(entry * MOST + lanes)));
                    let turn = rotation::in_plane(turn, last);
                    if commit {
                        each!(2, entry => turn[entry].store(turns.add(entry * MOST + lanes)));
                    }
                    for axis in 0..2 {
                        let mut mean = position[axis].mul_add(k_mean, first[axis] * k);
                        if DAMPED {
                            mean = velocity[axis].mul_add(d_mean, mean);
                        }
                        mean.store(out.0[axis].as_mut_ptr().add(lanes));
                        (turn[axis] * k).store(out.0[2 + axis].as_mut_ptr().add(lanes));
                    }
                }
                for corner in 0..corners {
                    for lanes in (0..MOST).step_by(L::WIDTH) {
                        let node = nodes.add(corner * MOST + lanes);
                        let out = out.0.as_ptr().cast::<f64>().add(lanes);
                        let [x, y] = each!(2, axis => L::load(rest.add((corner * 2 + axis) * MOST + lanes)));
                        let [wx, wy, cosine, sine] = each!(4, entry => L::load(out.add(entry * MOST)));
                        let fx = y.neg_mul_add(sine, x.mul_add(cosine, wx));
                        let fy = y.mul_add(cosine, x.mul_add(sine, wy));
                        L::add_rows([fx, fy, zero, zero], |lane| sum_of(sums, *node.add(lane)));
                    }
                }
            }
        }
    }

    /// Eq. (1).
    #[inline(always)]
    pub(super) fn springs<L: Lanes, const DAMPED: bool>(&self) {
        let &Self { part, sums, class, constants, .. } = self;
        let (records, sums) = (part.records.pointer(), sums.pointer());
        let (k, d) = (L::splat(constants.stiffness), L::splat(constants.damping));
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        for block in 0..class.elements.len().div_ceil(MOST) {
            let mut out = Block([[0.0; MOST]; 3]);
            // SAFETY: as in space.
            unsafe {
                let nodes = class.nodes.as_ptr().add(block * 2 * MOST);
                let tension = class.rest.pointer().add(block * MOST);
                for lanes in (0..MOST).step_by(L::WIDTH) {
                    let [near, far] = each!(2, corner => {
                        let node = nodes.add(corner * MOST + lanes);
                        L::columns(|lane| records.add(*node.add(lane) as usize).cast_const())
                    });
                    let [px, py, vx, vy, pz, vz, ..] = each!(8, entry => far[entry] - near[entry]);
                    let squared = pz.mul_add(pz, py.mul_add(py, px * px));
                    let inverse = one.div(squared.sqrt());
                    let tension = L::load(tension.add(lanes));
                    let along = if DAMPED {
                        (vz.mul_add(pz, vy.mul_add(py, vx * px)) * d).mul_sub(inverse, tension)
                    } else {
                        -tension
                    };
                    // A spring between coincident nodes has no direction.
                    let pull = along.mul_add(inverse, k).select(zero.lt(squared), zero);
                    let p = [px, py, pz];
                    each!(3, axis => (pull * p[axis]).store(out.0[axis].as_mut_ptr().add(lanes)));
                }
                for corner in 0..2 {
                    for lanes in (0..MOST).step_by(L::WIDTH) {
                        let node = nodes.add(corner * MOST + lanes);
                        let [x, y, z] = each!(3, axis => {
                            let force = L::load(out.0[axis].as_ptr().add(lanes));
                            if corner == 0 { force } else { -force }
                        });
                        L::add_rows([x, y, z, zero], |lane| sum_of(sums, *node.add(lane)));
                    }
                }
            }
        }
    }
}
