//! One pass: the forces of the elements of a part and the update of its nodes, then the update of the nodes of several parts.

use super::elements::Elements;
use super::{Arrays, NONE, RecordAddress, SUM, first_of};
use crate::kernel::Around;
use crate::kernel::memory::Aligned;
use crate::kernel::stepper::Pass;
use crate::kernel::update::{NodeUpdate, NodeVector};
use crate::lanes::{Lanes, MOST, Work, each};
use crate::law::{Law, RECORD};
use std::ops::Range;

/// The forces of the elements of a part.
pub(super) struct PartForces<'a, W> {
    pub(super) law: &'a W,
    pub(super) arrays: &'a Arrays,
    pub(super) part: usize,
    /// Zeros, at least one row more than the part has records.
    pub(super) sums: &'a Aligned,
    /// [`Pass::commit`].
    pub(super) commit: bool,
}

impl<W: Law> Work for PartForces<'_, W> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { law, arrays, part, sums, commit } = self;
        let (part, tally, is_large) = (&arrays.parts[part], &arrays.tally, arrays.is_large());
        for class in &part.classes {
            Elements { part, sums, class, law, commit, tally, is_large }.add::<L>();
        }
    }
}

/// How nodes are moved in a pass.
pub(super) struct Moved<'a> {
    pub(super) arrays: &'a Arrays,
    pub(super) pass: Pass,
    pub(super) around: &'a Around<'a>,
    /// [`Law::of_node`].
    pub(super) of_node: [f64; 2],
}

impl<'a> Moved<'a> {
    #[inline(always)]
    fn update<L: Lanes>(&self) -> Own<'a, L> {
        let update = NodeUpdate::<L>::new(self.pass.stage, self.arrays.step, self.pass.number, *self.around);
        Own { update, of_node: self.of_node }
    }
}

/// The update of the nodes of one part only, by the sums of its forces.
pub(super) struct OwnNodes<'a> {
    pub(super) part: usize,
    pub(super) sums: &'a Aligned,
    pub(super) moved: &'a Moved<'a>,
}

impl Work for OwnNodes<'_> {
    type Output = u32;

    #[inline(always)]
    fn run<L: Lanes>(self) -> u32 {
        let part = &self.moved.arrays.parts[self.part];
        let own = self.moved.update::<L>();
        let (records, sums) = (part.records.pointer(), self.sums.pointer());
        let mut lost = NONE;
        for first in (0..part.own * MOST).step_by(L::WIDTH) {
            // SAFETY: these are records of the part, which is this thread's.
            unsafe {
                let accelerations = part.accelerations.pointer().add(first / MOST * 3 * MOST + first % MOST);
                let [x, y, z, _] = sums_of::<L>(|lane| sums.add((first + lane) * SUM));
                let sum = own.update.pushed([x, y, z], |lane| part.index[first + lane] as usize);
                let node = |lane: usize| part.index[first + lane] as usize;
                let lanes = own.advance(|lane| records.add((first + lane) * RECORD), sum, accelerations, node);
                lost = first_of(lost, lanes, self.moved.around.held, |lane| part.index[first + lane]);
            }
        }
        // Zeros for the next part, and sums for `SharedNodes`. The last row belongs to lanes without an element.
        // SAFETY: both sums are this thread's.
        unsafe {
            let own = part.own * MOST;
            let (of_shared, count) = (sums.add(own * SUM), (part.index.len() - own) * SUM);
            part.sums.pointer().copy_from_nonoverlapping(of_shared, count);
            of_shared.write_bytes(0, count + SUM);
        }
        lost
    }
}

/// The columns of sums, which are then set to zero.
///
/// # Safety
/// The rows belong to this thread alone.
#[inline(always)]
unsafe fn sums_of<L: Lanes>(row: impl Fn(usize) -> *mut f64) -> [L; 4] {
    // SAFETY: the caller's.
    unsafe {
        let sums = L::columns_4(|lane| row(lane).cast_const());
        for lane in 0..L::WIDTH {
            *row(lane).cast::<[f64; SUM]>() = [0.0; SUM];
        }
        sums
    }
}

/// The update of nodes by their records.
struct Own<'a, L> {
    update: NodeUpdate<'a, L>,
    /// [`Law::of_node`].
    of_node: [f64; 2],
}

impl<L: Lanes> Own<'_, L> {
    /// Moves a vector of nodes by the forces of their elements, to which [`Law::of_node`] is added.
    ///
    /// # Safety
    /// Records and accelerations belong to this thread alone.
    #[inline(always)]
    unsafe fn advance(
        &self,
        record: impl Fn(usize) -> *mut f64,
        sum: [L; 3],
        accelerations: *mut f64,
        node: impl Fn(usize) -> usize,
    ) -> u32 {
        // SAFETY: the caller's.
        unsafe {
            let [px, py, vx, vy, pz, vz, inverse_mass, valence] = L::columns(|lane| record(lane).cast_const());
            let [k, d] = each!(2, at => L::splat(self.of_node[at]));
            let (k, d) = (k * valence, d * valence);
            let (position, velocity) = ([px, py, pz], [vx, vy, vz]);
            let force: [L; 3] =
                each!(3, axis => d.neg_mul_add(velocity[axis], k.neg_mul_add(position[axis], sum[axis])));
            let mut acceleration = [L::splat(0.0); 3];
            let stage = self.update.stage();
            if stage.loads_acceleration() {
                acceleration = each!(3, axis => L::load(accelerations.add(axis * MOST)));
            }
            let mut nodes = NodeVector { position, velocity, acceleration };
            let lost = self.update.advance(&mut nodes, force, inverse_mass, node);
            if stage.stores_acceleration() {
                each!(3, axis => nodes.acceleration[axis].store(accelerations.add(axis * MOST)));
            }
            let ([px, py, pz], [vx, vy, vz]) = (nodes.position, nodes.velocity);
            L::put_rows([px, py, vx, vy, pz, vz, inverse_mass, valence], record);
            lost
        }
    }
}

/// The update of the nodes that belong to several parts.
pub(super) struct SharedNodes<'a> {
    pub(super) blocks: Range<usize>,
    pub(super) moved: &'a Moved<'a>,
}

impl Work for SharedNodes<'_> {
    type Output = u32;

    #[inline(always)]
    fn run<L: Lanes>(self) -> u32 {
        let Self { blocks, moved } = self;
        let Arrays { shared, parts, .. } = moved.arrays;
        let own = moved.update::<L>();
        let record = |place: &RecordAddress| {
            parts[place.part as usize].records.pointer().wrapping_add(place.record as usize * RECORD)
        };
        let sum = |place: &RecordAddress| {
            let part = &parts[place.part as usize];
            part.sums.pointer().wrapping_add((place.record as usize - part.own * MOST) * SUM)
        };
        let mut lost = NONE;
        for first in (blocks.start * MOST..blocks.end * MOST).step_by(L::WIDTH) {
            let places = |lane: usize| shared.of(first + lane);
            if moved.arrays.is_large() {
                let start = |lane: usize| shared.starts[shared.index.len().min(first + lane)] as usize;
                for place in &shared.places[start(2 * L::WIDTH)..start(3 * L::WIDTH)] {
                    L::expect(record(place));
                    L::expect(sum(place));
                }
            }
            let (mut padding, mut rows) = ([[0.0; RECORD]; MOST], [std::ptr::null_mut(); MOST]);
            let mut sums = [[0.0; SUM]; MOST];
            // SAFETY: all parts are done, and these nodes belong to this thread, wherever their records are. Lanes
            // without a node have rows of their own.
            unsafe {
                for lane in 0..L::WIDTH {
                    let places = places(lane);
                    rows[lane] = places.first().map_or(padding[lane].as_mut_ptr(), record);
                    for place in places {
                        let row = &*sum(place).cast::<[f64; SUM]>();
                        sums[lane].iter_mut().zip(row).for_each(|(sum, value)| *sum += value);
                    }
                }
                let [x, y, z, _] = L::columns_4(|lane| sums[lane].as_ptr());
                let accelerations = shared.accelerations.pointer().add(first / MOST * 3 * MOST + first % MOST);
                let sum = own.update.pushed([x, y, z], |lane| shared.index[first + lane] as usize);
                let node = |lane: usize| shared.index[first + lane] as usize;
                let lanes = own.advance(|lane| rows[lane], sum, accelerations, node);
                lost = first_of(lost, lanes, moved.around.held, |lane| shared.index[first + lane]);
                for (lane, row) in rows.iter().enumerate().take(L::WIDTH) {
                    for place in places(lane).iter().skip(1) {
                        record(place).copy_from_nonoverlapping(*row, RECORD);
                    }
                }
            }
        }
        lost
    }
}
