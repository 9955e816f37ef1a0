//! The forces of elements in lanes, by any law.
//!
//! Lanes are elements with the same number of corners, in blocks of eight for every vector width. What the law says
//! of each node is computed once for it, times the number of its elements.
//!
//! Elements are sorted along a space-filling curve and divided into parts, which depend on the body only. A part has
//! its own records and sums of all its nodes. Nodes of one part are moved as soon as its elements are done; nodes
//! shared by several parts are moved after all parts, by the sums of all, in the order of the parts. Sums run block by
//! block, corner by corner, lane by lane, so their bits do not depend on the width or the number of threads.

#![expect(unsafe_code, reason = "lanes without tests of bounds; threads share the arrays by parts")]

mod elements;
pub(super) mod layout;
mod pass;

use super::memory::Aligned;
use super::stepper::{Pass, Passes, Stepper};
use super::{Around, Conditions, Lost};
use crate::body::Body;
use crate::crew::Crew;
use crate::gather::Group;
use crate::lanes::{Lanes, MOST, Set, Work, each};
use crate::law::{Law, RECORD, Reader};
use crate::lists::IndexLists;
use crate::tally::Tally;
use glam::DVec3;
use pass::{Moved, OwnNodes, PartForces, SharedNodes};
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

/// The last numbers of the record of a node, a cache line: 1/m, and the sum of the relative stiffnesses of its elements: their number,
/// if all are 1.
const INVERSE_MASS: usize = 6;
const VALENCE: usize = 7;
/// Doubles in the sum of a node: the force in x, y, z, and padding.
const SUM: usize = 4;

/// The elements of a body and the law of their forces.
#[derive(Clone)]
pub(crate) struct General<W> {
    law: W,
    arrays: Arrays,
}

/// The numbers of elements and nodes, in parts. What is done with them here is compiled once, and not for each law.
#[derive(Clone)]
struct Arrays {
    set: Set,
    /// ΔT (s).
    step: f64,
    parts: Vec<Part>,
    shared: Shared,
    /// For each thread the sums of its present part, which stay in the caches; zeros between parts.
    sums: Vec<Aligned>,
    /// The record of each node. If several parts share it, the part is [`NONE`], and the record its number in `shared`.
    places: Vec<RecordAddress>,
    /// Number of elements.
    elements: usize,
    /// How many numbers each element remembers.
    memory: usize,
    tally: Tally,
}

/// Where a record is: its part, and its number there.
#[derive(Clone, Copy)]
struct RecordAddress {
    part: u32,
    record: u32,
}

/// The elements of one task.
#[derive(Clone)]
struct Part {
    /// Number of nodes of this part only, in whole blocks.
    own: usize,
    /// The index in the body of each record; 0 for padding.
    index: Vec<u32>,
    records: Aligned,
    /// Of the nodes shared with other parts.
    sums: Aligned,
    /// Of the nodes of this part only, block by block, coordinate by coordinate.
    accelerations: Aligned,
    /// A copy of the records. Accelerations need none: the first pass of a run computes them.
    kept: Aligned,
    classes: Vec<Class>,
}

/// Elements with the same number of corners.
#[derive(Clone)]
struct Class {
    corners: usize,
    /// The index in the body of each.
    elements: Vec<u32>,
    /// Where the records of their corners begin: block by block, corner by corner.
    nodes: Vec<u32>,
    /// Block by block: of the corners, then of the elements.
    constants: Aligned,
    /// Block by block.
    memory: Aligned,
    kept: Aligned,
}

/// The nodes that belong to several parts.
#[derive(Clone)]
struct Shared {
    /// The index in the body of each, in whole blocks; 0 for padding.
    index: Vec<u32>,
    /// The start of the places of each node.
    starts: Vec<u32>,
    places: Vec<RecordAddress>,
    accelerations: Aligned,
}

impl<W: Law> General<W> {
    /// The elements of a body on which a law acts. If their relative stiffness is not 1, the law is [`Filled`](crate::law::Filled).
    pub(crate) fn new(law: W, body: &Body, conditions: &Conditions) -> Self {
        let (own, fill) = (law.elements(body), law.relative_stiffness(body));
        let (lists, fill) = (own.as_ref().unwrap_or(&body.elements), fill.as_deref());
        let constants = |elements: &[u32]| {
            let alike = Alike { body, lists, fill, elements };
            conditions.set.run(Prepare { law: &law, alike })
        };
        let (parts, shared, places) = layout::divide(lists, fill, body, W::MEMORY, &constants);
        let &Conditions { step, set, .. } = conditions;
        let (sums, elements, memory, tally) = (Vec::new(), lists.len(), W::MEMORY, Tally::default());
        let arrays = Arrays { set, step, parts, shared, sums, places, elements, memory, tally };
        Self { law, arrays }
    }
}

impl Shared {
    /// All places of the node with this number.
    fn of(&self, number: usize) -> &[RecordAddress] {
        &self.places[self.starts[number] as usize..self.starts[number + 1] as usize]
    }
}

/// A body of more parts exceeds the share of the last cache that it can count on: prefetching what is read in no order is then
/// worth its instructions. So many parts have 11 MB if elements have eight corners.
pub(super) const SMALL: usize = 8;

/// Computes the constants of elements with the same number of corners.
struct Prepare<'a, W> {
    law: &'a W,
    alike: Alike<'a>,
}

/// Elements with the same number of corners.
struct Alike<'a> {
    body: &'a Body,
    lists: &'a IndexLists,
    /// The relative stiffness of each of the lists; `None` if all are 1.
    fill: Option<&'a [f64]>,
    elements: &'a [u32],
}

impl<W: Law> Work for Prepare<'_, W> {
    type Output = Aligned;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Aligned {
        let Self { law, alike } = self;
        let count = alike.elements.len();
        let mut reader = Reader::<L>::new();
        let mut all = Aligned::zeros(0);
        for first in (0..count.next_multiple_of(MOST)).step_by(L::WIDTH) {
            alike.read(first, &mut reader);
            put(&mut all, reader.prepare(law), first..first + L::WIDTH, count);
        }
        all
    }
}

impl Alike<'_> {
    /// Reads those from one on into lanes, at rest.
    fn read<L: Lanes>(&self, first: usize, reader: &mut Reader<L>) {
        let Self { body, lists, fill, elements, .. } = *self;
        // The last element fills the lanes that are left.
        let element = |lane: usize| elements[(first + lane).min(elements.len() - 1)] as usize;
        let group = Group::of(|lane| &lists[element(lane)]);
        let parts = each!(8, lane => fill.map_or(1.0, |fill| fill[element(lane)]));
        reader.read(&group, body, &body.rest, None, &parts);
    }
}

/// Adds the constants of some of so many elements, which are rows of [`MOST`] numbers, to those before.
fn put(all: &mut Aligned, constants: &[f64], lanes: Range<usize>, elements: usize) {
    if lanes.start == 0 {
        *all = Aligned::zeros(elements.div_ceil(MOST) * constants.len());
    }
    let block = &mut all.as_mut_slice()[lanes.start / MOST * constants.len()..][..constants.len()];
    for (row, constants) in block.chunks_exact_mut(MOST).zip(constants.chunks_exact(MOST)) {
        row[lanes.start % MOST..][..lanes.len()].copy_from_slice(&constants[..lanes.len()]);
    }
}

impl<W: Law> General<W> {
    /// Evaluates the forces once, unless they are known, and moves all nodes. Returns the first node that becomes too
    /// fast.
    fn pass(&self, pass: Pass, around: &Around<'_>, crew: &Crew) -> Option<Lost> {
        let Self { law, arrays } = self;
        let moved = &Moved { arrays, pass, around, of_node: law.of_node() };
        let lost = first_lost(crew, arrays.parts.len(), |me, parts| {
            let sums = &arrays.sums[me];
            let one = |part| {
                if pass.stage.has_forces() {
                    arrays.set.run(PartForces { law, arrays, part, sums, commit: pass.commit });
                }
                arrays.set.run(OwnNodes { part, sums, moved })
            };
            parts.map(one).fold(NONE, u32::min)
        });
        let of_shared = first_lost(crew, arrays.shared.index.len() / MOST, |_, blocks| {
            arrays.set.run(SharedNodes { blocks, moved })
        });
        let lost = lost.min(of_shared);
        (lost != NONE).then_some(Lost { step: pass.number, node: lost as usize })
    }
}

impl Arrays {
    /// Whether it has more parts than are [`SMALL`].
    fn is_large(&self) -> bool {
        self.parts.len() > SMALL
    }

    /// Calls `each` with each number that elements remember, and its place in the memory of the model.
    fn each_number(&mut self, mut each: impl FnMut(&mut f64, usize)) {
        let width = self.memory;
        for class in self.parts.iter_mut().flat_map(|part| &mut part.classes) {
            let numbers = class.memory.as_mut_slice();
            for (at, &element) in class.elements.iter().enumerate() {
                for entry in 0..width {
                    let number = &mut numbers[(at / MOST * width + entry) * MOST + at % MOST];
                    each(number, element as usize * width + entry);
                }
            }
        }
    }

    /// Takes what elements remember.
    fn load(&mut self, memory: &[f64]) {
        self.each_number(|number, at| *number = memory[at]);
        self.tally.load(memory.get(self.elements * self.memory));
    }

    /// Writes what elements remember.
    fn store(&mut self, memory: &mut [f64]) {
        self.each_number(|number, at| memory[at] = *number);
        self.tally.store(memory.get_mut(self.elements * self.memory));
    }

    fn node(&mut self, node: usize) -> (DVec3, DVec3) {
        let RecordAddress { part, record } = match self.places[node] {
            RecordAddress { part: NONE, record } => self.shared.of(record as usize)[0],
            place => place,
        };
        let records = self.parts[part as usize].records.as_mut_slice();
        let (records, _) = records.as_chunks::<RECORD>();
        let [px, py, vx, vy, pz, vz, ..] = records[record as usize];
        (DVec3::new(px, py, pz), DVec3::new(vx, vy, vz))
    }

    fn set_node(&mut self, node: usize, position: DVec3, velocity: DVec3) {
        let values = [position.x, position.y, velocity.x, velocity.y, position.z, velocity.z];
        let Self { parts, shared, places, .. } = self;
        let mut put = |place: RecordAddress| {
            let record = &mut parts[place.part as usize].records.as_mut_slice()[place.record as usize * RECORD..];
            record[..values.len()].copy_from_slice(&values);
        };
        match places[node] {
            RecordAddress { part: NONE, record } => shared.of(record as usize).iter().for_each(|&place| put(place)),
            place => put(place),
        }
    }

    fn keep(&mut self) {
        for part in &mut self.parts {
            part.kept.copy_from(&mut part.records);
            part.classes.iter_mut().for_each(|class| class.kept.copy_from(&mut class.memory));
        }
        self.tally.keep();
    }

    fn restore(&mut self) {
        for part in &mut self.parts {
            part.records.copy_from(&mut part.kept);
            part.classes.iter_mut().for_each(|class| class.memory.copy_from(&mut class.kept));
        }
        self.tally.restore();
    }

    /// Sees to it that there are sums for so many threads.
    fn prepare_sums(&mut self, threads: usize) {
        if self.sums.len() < threads {
            let most = self.parts.iter().map(|part| part.index.len() + 1).max().unwrap_or(0);
            self.sums.resize_with(threads, || Aligned::zeros(most * SUM));
        }
    }
}

/// No node.
pub(super) const NONE: u32 = u32::MAX;

/// The first node that becomes too fast in `work`, which takes the number of each thread and its share of so many parts; [`NONE`] if none
/// does.
pub(super) fn first_lost(crew: &Crew, count: usize, work: impl Fn(usize, Range<usize>) -> u32 + Sync) -> u32 {
    let (threads, lost) = (crew.threads(), AtomicU32::new(NONE));
    if count > 0 {
        crew.run(&|me| {
            lost.fetch_min(work(me, me * count / threads..(me + 1) * count / threads), Ordering::Relaxed);
        });
    }
    lost.into_inner()
}

/// The lower of two nodes: `one`, and the first of the lanes whose bits are set and that is not held.
#[inline(always)]
pub(super) fn first_of(one: u32, lanes: u32, held: &[bool], index: impl Fn(usize) -> u32) -> u32 {
    if lanes == 0 {
        return one;
    }
    let free = |&node: &u32| held.get(node as usize) != Some(&true);
    (0..MOST).filter(|lane| lanes >> lane & 1 == 1).map(index).filter(free).fold(one, u32::min)
}

impl<W: Law> Stepper for General<W> {
    fn load(&mut self, position: &[DVec3], velocity: &[DVec3], memory: &[f64]) {
        self.place(position, velocity);
        self.arrays.load(memory);
    }

    fn store(&mut self, position: &mut [DVec3], velocity: &mut [DVec3], memory: &mut [f64]) {
        self.read(position, velocity);
        self.arrays.store(memory);
    }

    fn node(&mut self, node: usize) -> (DVec3, DVec3) {
        self.arrays.node(node)
    }

    fn set_node(&mut self, node: usize, position: DVec3, velocity: DVec3) {
        self.arrays.set_node(node, position, velocity);
    }

    fn is_damped(&self) -> bool {
        self.law.is_damped()
    }

    fn copy(&self) -> Box<dyn Stepper> {
        Box::new(self.clone())
    }

    fn keep(&mut self) {
        self.arrays.keep();
    }

    fn restore(&mut self) {
        self.arrays.restore();
    }

    fn run(&mut self, passes: Passes, some: Range<u64>, around: &Around<'_>, crew: &Crew) -> Option<Lost> {
        self.arrays.prepare_sums(crew.threads());
        some.into_iter().find_map(|pass| self.pass(passes.get(pass), around, crew))
    }
}
