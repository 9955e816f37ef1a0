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
mod pass;

use super::memory::Aligned;
use super::stepper::{Pass, Passes, Stepper};
use super::{Around, Conditions, Lost};
use crate::body::Body;
use crate::crew::Crew;
use crate::gather::Group;
use crate::hull::bounds;
use crate::lanes::{Lanes, MOST, Set, Work, each};
use crate::law::{Law, RECORD, Reader};
use crate::lists::IndexLists;
use crate::tally::Tally;
use glam::DVec3;
use pass::{OnePart, SharedNodes};
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

/// The last numbers of the record of a node, a cache line: 1/m, and the sum of the relative stiffnesses of its elements: their number,
/// if all are 1.
const INVERSE_MASS: usize = 6;
const VALENCE: usize = 7;
/// Doubles in the sum of a node: the force in x, y, z, and padding.
const SUM: usize = 4;

/// The elements of a body, in parts.
#[derive(Clone)]
pub(crate) struct General<W> {
    set: Set,
    law: W,
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
        let elements = own.as_ref().unwrap_or(&body.elements);
        let Body { rest, mass, .. } = body;
        let parts = cut(elements, along_curve(elements, rest));
        // The first part of each node, and whether it has several.
        let (mut first, mut is_shared) = (vec![NONE; rest.len()], vec![false; rest.len()]);
        let mut valence = vec![0.0; rest.len()];
        for (part, own) in (0..).zip(&parts) {
            for &element in own {
                let filled = fill.as_ref().map_or(1.0, |fill| fill[element as usize]);
                for &node in &elements[element as usize] {
                    let node = node as usize;
                    is_shared[node] |= first[node] != NONE && first[node] != part;
                    first[node] = first[node].min(part);
                    valence[node] += filled;
                }
            }
        }
        let mut places = vec![RecordAddress { part: 0, record: 0 }; rest.len()];
        let mut shared_places: Vec<(u32, RecordAddress)> = Vec::new();
        let mut made = Vec::with_capacity(parts.len());
        let mut record = vec![NONE; rest.len()];
        for (part, own) in (0u32..).zip(&parts) {
            // Nodes in the order in which the elements use them.
            let (mut index, mut of_others) = (Vec::new(), Vec::new());
            for &node in own.iter().flat_map(|&element| &elements[element as usize]) {
                let seen = &mut record[node as usize];
                if *seen == NONE {
                    *seen = 0;
                    if is_shared[node as usize] { &mut of_others } else { &mut index }.push(node);
                }
            }
            if part == 0 {
                index.extend((0..rest.len() as u32).filter(|&node| first[node as usize] == NONE));
            }
            let alone = index.len();
            index.resize(alone.next_multiple_of(MOST), 0);
            let whole = index.len();
            for (at, &node) in (0..).zip(&index[..alone]) {
                places[node as usize] = RecordAddress { part, record: at };
                record[node as usize] = at;
            }
            for (at, &node) in (whole as u32..).zip(&of_others) {
                record[node as usize] = at;
                shared_places.push((node, RecordAddress { part, record: at }));
                if first[node as usize] == part {
                    places[node as usize] = RecordAddress { part, record: at };
                }
            }
            index.extend(&of_others);
            let mut records = Aligned::zeros((index.len() + 1) * RECORD);
            let is_node = |at: usize| at < alone || at >= whole;
            for (at, &node) in index.iter().enumerate().filter(|(at, _)| is_node(*at)) {
                let record = &mut records.as_mut_slice()[at * RECORD..][..RECORD];
                record[INVERSE_MASS] = 1.0 / mass[node as usize];
                record[VALENCE] = valence[node as usize];
            }
            // Lanes without an element use this record.
            let nothing = index.len() as u32;
            let mut counts: Vec<usize> = own.iter().map(|&element| elements[element as usize].len()).collect();
            counts.sort_unstable();
            counts.dedup();
            let class = |corners: usize| {
                let of_class: Vec<u32> =
                    own.iter().copied().filter(|&element| elements[element as usize].len() == corners).collect();
                let prepare = Prepare { law: &law, body, lists: elements, fill: fill.as_deref(), elements: &of_class };
                let constants = conditions.set.run(prepare);
                Class::new::<W>(elements, of_class, constants, &record, nothing)
            };
            made.push(Part {
                own: whole / MOST,
                records,
                sums: Aligned::zeros(of_others.len() * SUM),
                accelerations: Aligned::zeros(whole * 3),
                kept: Aligned::zeros((index.len() + 1) * RECORD),
                classes: counts.into_iter().map(class).collect(),
                index,
            });
            for &node in own.iter().flat_map(|&element| &elements[element as usize]) {
                record[node as usize] = NONE;
            }
        }
        // In the order of the first part, so that nodes moved one after the other are neighbours in memory.
        shared_places.sort_by_key(|&(node, place)| {
            let RecordAddress { part, record } = places[node as usize];
            (part, record, place.part)
        });
        let mut shared =
            Shared { index: Vec::new(), starts: Vec::new(), places: Vec::new(), accelerations: Aligned::zeros(0) };
        for of_node in shared_places.chunk_by(|a, b| a.0 == b.0) {
            let node = of_node[0].0;
            places[node as usize] = RecordAddress { part: NONE, record: shared.index.len() as u32 };
            shared.index.push(node);
            shared.starts.push(shared.places.len() as u32);
            shared.places.extend(of_node.iter().map(|(_, place)| place));
        }
        let whole = shared.index.len().next_multiple_of(MOST);
        shared.index.resize(whole, 0);
        shared.starts.resize(whole + 1, shared.places.len() as u32);
        shared.accelerations = Aligned::zeros(whole * 3);
        let (elements, tally) = (elements.len(), Tally::default());
        let &Conditions { step, set, .. } = conditions;
        Self { set, law, step, parts: made, shared, sums: Vec::new(), places, elements, tally }
    }
}

impl Shared {
    /// All places of the node with this number.
    fn of(&self, number: usize) -> &[RecordAddress] {
        &self.places[self.starts[number] as usize..self.starts[number + 1] as usize]
    }
}

/// The elements in the order of their centres at rest on the Morton curve.
fn along_curve(elements: &IndexLists, rest: &[DVec3]) -> Vec<u32> {
    let (low, high) = bounds(rest);
    let cells = f64::from(1u32 << 20) / (high - low).max_element().max(f64::MIN_POSITIVE);
    let spread = |value: f64| (0..21).fold(0u64, |all, bit| all | (value as u64 >> bit & 1) << (3 * bit));
    let key = |nodes: &[u32]| {
        let middle = nodes.iter().map(|&node| rest[node as usize] - low).sum::<DVec3>() / nodes.len() as f64;
        let [x, y, z] = (middle * cells).to_array().map(spread);
        x | y << 1 | z << 2
    };
    let mut keyed: Vec<(u64, u32)> = elements.iter().map(key).zip(0..).collect();
    keyed.sort_unstable();
    keyed.into_iter().map(|(_, element)| element).collect()
}

/// The number of parts of elements.
pub(super) fn parts(elements: &IndexLists) -> usize {
    /// Corners in a part: the data of their nodes stay in the second-level cache.
    const CORNERS: usize = 32768;
    elements.indices().len().div_ceil(CORNERS).max(1)
}

/// A body of more parts exceeds the share of the last cache that it can count on: prefetching what is read in no order is then
/// worth its instructions. So many parts have 11 MB if elements have eight corners.
pub(super) const SMALL: usize = 8;

/// Divides elements into parts of about equal work.
fn cut(elements: &IndexLists, order: Vec<u32>) -> Vec<Vec<u32>> {
    let (all, parts) = (elements.indices().len(), parts(elements));
    let mut cut = vec![Vec::new(); parts];
    let mut before = 0;
    for element in order {
        cut[before * parts / all].push(element);
        before += elements[element as usize].len();
    }
    cut
}

impl Class {
    /// Elements of lists, with the same number of corners. Lanes without an element use the record `nothing`.
    fn new<W: Law>(lists: &IndexLists, elements: Vec<u32>, constants: Aligned, record: &[u32], nothing: u32) -> Self {
        let corners = lists[elements[0] as usize].len();
        let blocks = elements.len().div_ceil(MOST);
        let mut nodes = vec![nothing * RECORD as u32; blocks * corners * MOST];
        for (at, &element) in elements.iter().enumerate() {
            for (corner, &node) in lists[element as usize].iter().enumerate() {
                nodes[(at / MOST * corners + corner) * MOST + at % MOST] = record[node as usize] * RECORD as u32;
            }
        }
        let [memory, kept] = [0; 2].map(|_| Aligned::zeros(blocks * W::MEMORY * MOST));
        Self { corners, elements, nodes, constants, memory, kept }
    }
}

/// Computes the constants of elements with the same number of corners.
struct Prepare<'a, W> {
    law: &'a W,
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
        let Self { law, body, lists, fill, elements } = self;
        let mut reader = Reader::<L>::new();
        let mut all = Aligned::zeros(0);
        for first in (0..elements.len().next_multiple_of(MOST)).step_by(L::WIDTH) {
            // The last element fills the lanes that are left.
            let element = |lane: usize| elements[(first + lane).min(elements.len() - 1)] as usize;
            let group = Group::of(|lane| &lists[element(lane)]);
            let parts = each!(8, lane => fill.map_or(1.0, |fill| fill[element(lane)]));
            reader.read(&group, body, &body.rest, None, &parts);
            let constants = reader.prepare(law);
            if first == 0 {
                all = Aligned::zeros(elements.len().div_ceil(MOST) * constants.len());
            }
            let block = &mut all.as_mut_slice()[first / MOST * constants.len()..][..constants.len()];
            for (row, constants) in block.chunks_exact_mut(MOST).zip(constants.chunks_exact(MOST)) {
                row[first % MOST..][..L::WIDTH].copy_from_slice(&constants[..L::WIDTH]);
            }
        }
        all
    }
}

impl<W: Law> General<W> {
    /// Whether it has more parts than are [`SMALL`].
    fn is_large(&self) -> bool {
        self.parts.len() > SMALL
    }

    /// Calls `each` with each number that elements remember, and its place in the memory of the model.
    fn each_number(&mut self, mut each: impl FnMut(&mut f64, usize)) {
        let width = W::MEMORY;
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

    /// Evaluates the forces once, unless they are known, and moves all nodes. Returns the first node that becomes too
    /// fast.
    fn pass(&self, pass: Pass, around: Around<'_>, crew: &Crew) -> Option<Lost> {
        let (body, step, of_node) = (self, self.step, self.law.of_node());
        let lost = first_lost(crew, self.parts.len(), |me, parts| {
            let one = |part| self.set.run(OnePart { body, part, sums: &body.sums[me], pass, around });
            parts.map(one).fold(NONE, u32::min)
        });
        let of_shared = first_lost(crew, self.shared.index.len() / MOST, |_, blocks| {
            let (shared, parts, is_large) = (&body.shared, &body.parts[..], body.is_large());
            self.set.run(SharedNodes { shared, parts, is_large, blocks, pass, around, of_node, step })
        });
        let lost = lost.min(of_shared);
        (lost != NONE).then_some(Lost { step: pass.number, node: lost as usize })
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
        self.each_number(|number, at| *number = memory[at]);
        self.tally.load(memory.get(self.elements * W::MEMORY));
    }

    fn store(&mut self, position: &mut [DVec3], velocity: &mut [DVec3], memory: &mut [f64]) {
        self.read(position, velocity);
        self.each_number(|number, at| memory[at] = *number);
        self.tally.store(memory.get_mut(self.elements * W::MEMORY));
    }

    #[inline]
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

    #[inline]
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

    fn is_damped(&self) -> bool {
        self.law.is_damped()
    }

    fn copy(&self) -> Box<dyn Stepper> {
        Box::new(self.clone())
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

    fn run(&mut self, passes: Passes, some: Range<u64>, around: &Around<'_>, crew: &Crew) -> Option<Lost> {
        if self.sums.len() < crew.threads() {
            let most = self.parts.iter().map(|part| part.index.len() + 1).max().unwrap_or(0);
            self.sums.resize_with(crew.threads(), || Aligned::zeros(most * SUM));
        }
        some.into_iter().find_map(|pass| self.pass(passes.get(pass), *around, crew))
    }
}
