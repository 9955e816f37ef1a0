//! The forces of elements in lanes, by a law: their contributions to the sums of their nodes.

use super::{Class, Part, SUM};
use crate::kernel::memory::Aligned;
use crate::lanes::{Lanes, MOST};
use crate::law::{self, Corners, Element, Law, RECORD};
use crate::tally::Tally;
use std::mem::MaybeUninit;

/// The elements of one class of a part.
pub(super) struct Elements<'a, W> {
    pub(super) part: &'a Part,
    /// Of the nodes of the part.
    pub(super) sums: &'a Aligned,
    pub(super) class: &'a Class,
    pub(super) law: &'a W,
    pub(super) commit: bool,
    pub(super) tally: &'a Tally,
    /// [`Arrays::is_large`](super::Arrays::is_large).
    pub(super) is_large: bool,
}

/// Blocks in a batch, for which each part of the law is computed before the next. A rotation is a long chain of dependent
/// operations; the processor overlaps those of several blocks.
const BATCH: usize = 4;

/// What the elements of a batch know, vector by vector: on the stack, and aligned to cache lines.
#[repr(C, align(64))]
struct Batch<T>([MaybeUninit<T>; BATCH * MOST]);

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

/// The addresses of the elements of a class. As values they stay in registers: what is behind references is read again after each
/// store.
#[derive(Clone, Copy)]
struct Addresses<'a> {
    records: *const f64,
    sums: *mut f64,
    nodes: *const u32,
    constants: *const f64,
    memory: *mut f64,
    corners: usize,
    elements: usize,
    commit: bool,
    tally: &'a Tally,
}

impl<'a> Addresses<'a> {
    /// The elements of a vector of a block.
    ///
    /// # Safety
    /// There is such a block, and a law has as many numbers.
    #[inline(always)]
    unsafe fn element<L: Lanes, W: Law>(self, block: usize, vector: usize) -> Element<'a, L> {
        let Self { records, nodes, constants: numbers, memory, corners, elements, commit, tally, .. } = self;
        let lanes = vector * L::WIDTH;
        let left = elements.saturating_sub(block * MOST + lanes);
        // SAFETY: the arrays have an entry for each block, corner, number and lane; the records named are the part's, which is this
        // thread's.
        unsafe {
            Element::new::<W>(
                Corners::new(records, nodes.add(block * corners * MOST + lanes), corners),
                numbers.add(block * law::constants::<W>(corners) * MOST + lanes),
                memory.add(block * W::MEMORY * MOST + lanes),
                commit,
                (1 << left.min(L::WIDTH)) - 1,
                Some(tally),
            )
        }
    }

    /// Adds the forces on a corner.
    ///
    /// # Safety
    /// As for [`Self::element`].
    #[inline(always)]
    unsafe fn add<L: Lanes, W: Law>(self, law: &W, block: usize, vector: usize, corner: usize, whole: &W::Whole<L>) {
        // SAFETY: the caller's.
        unsafe {
            let [x, y, z] = law.force(&self.element::<L, W>(block, vector), corner, whole);
            let node = self.nodes.add((block * self.corners + corner) * MOST + vector * L::WIDTH);
            L::add_rows([x, y, z, L::splat(0.0)], |lane| sum_of(self.sums, *node.add(lane)));
        }
    }
}

impl<W: Law> Elements<'_, W> {
    /// Adds the forces of all elements.
    #[inline(always)]
    pub(super) fn add<L: Lanes>(&self) {
        let &Self { part, sums, class, commit, tally, is_large, .. } = self;
        // A copy, whose numbers stay in registers.
        let law = self.law.clone();
        let (corners, elements, vectors) = (class.corners, class.elements.len(), MOST / L::WIDTH);
        let (records, nodes, constants) = (part.records.pointer(), class.nodes.as_ptr(), class.constants.pointer());
        let (sums, memory) = (sums.pointer(), class.memory.pointer());
        let all = Addresses { records, sums, nodes, constants, memory, corners, elements, commit, tally };
        let blocks = elements.div_ceil(MOST);
        let ahead = if is_large { 2 * BATCH } else { BATCH };
        let width = law::constants::<W>(corners);
        let mut batch = Batch([const { MaybeUninit::<W::Whole<L>>::uninit() }; BATCH * MOST]);
        for begin in (0..blocks).step_by(BATCH) {
            let count = BATCH.min(blocks - begin);
            // SAFETY: blocks are below their number, and each vector is written before it is read.
            unsafe {
                for block in 0..count {
                    for vector in 0..vectors {
                        let element = all.element::<L, W>(begin + block, vector);
                        batch.0[block * vectors + vector].write(law.whole(&element));
                    }
                }
                for pass in 0..law.passes() {
                    for block in 0..count {
                        for vector in 0..vectors {
                            let element = all.element::<L, W>(begin + block, vector);
                            law.refine(pass, &element, batch.0[block * vectors + vector].assume_init_mut());
                        }
                    }
                }
                for block in 0..count {
                    let at = begin + block;
                    let nodes = nodes.add(at * corners * MOST);
                    let constants = constants.add(at * width * MOST);
                    if W::MEMORY > 0 {
                        // Prefetches the data of the next batch, which are not in the second-level cache. Those of a large
                        // body take longer to arrive: here of the batch after it, and the records of the next one.
                        let memory = memory.wrapping_add((at + ahead) * W::MEMORY * MOST);
                        (0..W::MEMORY).for_each(|entry| L::expect(memory.wrapping_add(entry * MOST)));
                        let of_element = constants.wrapping_add((ahead * width + corners * W::OF_CORNER) * MOST);
                        (0..W::OF_ELEMENT).for_each(|entry| L::expect(of_element.wrapping_add(entry * MOST)));
                    }
                    if is_large && at + BATCH < blocks {
                        let nodes = nodes.add(BATCH * corners * MOST);
                        for corner in 0..corners * MOST {
                            L::expect(records.add(*nodes.add(corner) as usize));
                        }
                    }
                    let expect_corner = |corner: usize| {
                        if W::MEMORY > 0 {
                            let constants = constants.wrapping_add((ahead * width + corner * W::OF_CORNER) * MOST);
                            (0..W::OF_CORNER).for_each(|entry| L::expect(constants.wrapping_add(entry * MOST)));
                            L::expect(nodes.wrapping_add((ahead * corners + corner) * MOST).cast());
                        }
                    };
                    if vectors == 1 {
                        let whole = batch.0[block].assume_init();
                        for corner in 0..corners {
                            expect_corner(corner);
                            all.add::<L, W>(&law, at, 0, corner, &whole);
                        }
                        continue;
                    }
                    for corner in 0..corners {
                        expect_corner(corner);
                        for vector in 0..vectors {
                            let whole = batch.0[block * vectors + vector].assume_init_ref();
                            all.add::<L, W>(&law, at, vector, corner, whole);
                        }
                    }
                }
            }
        }
    }
}
