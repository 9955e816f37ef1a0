//! Eq. (4) in lanes, for any elements in space and in the plane, and Eq. (1) for springs that form no families.
//!
//! Lanes are elements with the same number of corners, in blocks of eight for every vector width. With `w = k P + D V`
//! the force of an element on a corner is `−w + w̄ + k M R0`. Elements add up the last two terms; the first one is
//! computed once for each node, times the number of its elements. As `Σ R0 = 0` the moments need no centroid.
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
use super::tally::Tally;
use super::{Around, Lost, Rotation};
use crate::body::Body;
use crate::crew::Crew;
use crate::element::Dimension;
use crate::hull::bounds;
use crate::lanes::{MOST, Set};
use crate::lists::IndexLists;
use glam::DVec3;
use pass::{OnePart, SharedNodes};
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

/// Doubles in the record of a node, a cache line: px, py, vx, vy, pz, vz, 1/m, and the number of its elements. What the
/// plane needs comes first.
const RECORD: usize = 8;
const INVERSE_MASS: usize = 6;
const VALENCE: usize = 7;
/// Doubles in the sum of a node: the force in x, y, z, and padding.
const SUM: usize = 4;

/// What the elements compute.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Law {
    /// Eq. (4) in the plane, with the rotation of Eq. (9).
    Plane,
    /// Eq. (4) in space.
    Space(Rotation),
    /// Eq. (1): the elements are pairs of nodes.
    Spring,
}

/// The constants of Eq. (4) or Eq. (1).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Constants {
    /// `k` (N/m).
    pub(crate) stiffness: f64,
    /// `D` (N s/m), on the motion relative to the mean of an element.
    pub(crate) damping: f64,
    /// Acceleration of gravity (m/s²).
    pub(crate) gravity: DVec3,
    /// ΔT (s).
    pub(crate) step: f64,
}

/// The elements or springs of a body, in parts.
pub(crate) struct General {
    set: Set,
    law: Law,
    constants: Constants,
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
struct Class {
    corners: usize,
    /// The index in the body of each.
    elements: Vec<u32>,
    /// Where the records of their corners begin: block by block, corner by corner.
    nodes: Vec<u32>,
    /// `R0` (m): block by block, corner by corner, coordinate by coordinate; or `k L` (N) of springs.
    rest: Aligned,
    /// `1 / Σ |R0|²` of each (1/m²).
    scale: Aligned,
    /// Rotations: block by block, a quaternion or (cos, sin).
    turns: Aligned,
    kept: Aligned,
}

/// The nodes that belong to several parts.
struct Shared {
    /// The index in the body of each, in whole blocks; 0 for padding.
    index: Vec<u32>,
    /// The start of the places of each node.
    starts: Vec<u32>,
    places: Vec<RecordAddress>,
    accelerations: Aligned,
}

impl General {
    /// The elements of a body, with Eq. (4). In the plane `rotation` is not used.
    pub(crate) fn new(body: &Body, rotation: Rotation, constants: Constants, set: Set) -> Self {
        let law = match body.dimension {
            Dimension::Plane => Law::Plane,
            Dimension::Space => Law::Space(rotation),
        };
        Self::with(&body.elements, &body.rest, &body.mass, law, constants, set)
    }

    /// Springs, with Eq. (1).
    pub(crate) fn springs(body: &Body, springs: &[[u32; 2]], constants: Constants, set: Set) -> Self {
        let pairs: IndexLists = springs.iter().map(|ends| &ends[..]).collect();
        Self::with(&pairs, &body.rest, &body.mass, Law::Spring, constants, set)
    }

    fn with(elements: &IndexLists, rest: &[DVec3], mass: &[f64], law: Law, constants: Constants, set: Set) -> Self {
        let parts = cut(elements, along_curve(elements, rest));
        // The first part of each node, and whether it has several.
        let (mut first, mut is_shared) = (vec![NONE; rest.len()], vec![false; rest.len()]);
        let mut valence = vec![0u32; rest.len()];
        for (part, own) in (0..).zip(&parts) {
            for &node in own.iter().flat_map(|&element| &elements[element as usize]) {
                let node = node as usize;
                is_shared[node] |= first[node] != NONE && first[node] != part;
                first[node] = first[node].min(part);
                valence[node] += u32::from(law != Law::Spring);
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
                record[VALENCE] = f64::from(valence[node as usize]);
            }
            // Lanes without an element use this record.
            let nothing = index.len() as u32;
            let mut counts: Vec<usize> = own.iter().map(|&element| elements[element as usize].len()).collect();
            counts.sort_unstable();
            counts.dedup();
            let class = |corners: usize| {
                let of_class: Vec<u32> =
                    own.iter().copied().filter(|&element| elements[element as usize].len() == corners).collect();
                Class::new(corners, of_class, elements, &record, nothing, rest, law, constants)
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
        Self { set, law, constants, parts: made, shared, sums: Vec::new(), places, elements, tally }
    }
}

impl Law {
    /// Doubles in the memory of each element.
    fn memory(self) -> usize {
        match self {
            Self::Plane => 2,
            Self::Space(_) => 4,
            Self::Spring => 0,
        }
    }

    /// Coordinates of each corner at rest.
    fn axes(self) -> usize {
        match self {
            Self::Plane => 2,
            Self::Space(_) => 3,
            Self::Spring => 0,
        }
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

/// Divides elements into parts of about equal work.
fn cut(elements: &IndexLists, order: Vec<u32>) -> Vec<Vec<u32>> {
    /// Corners in a part: the data of their nodes stay in the second-level cache.
    const CORNERS: usize = 32768;
    let all = elements.indices().len();
    let parts = all.div_ceil(CORNERS).max(1);
    let mut cut = vec![Vec::new(); parts];
    let mut before = 0;
    for element in order {
        cut[before * parts / all].push(element);
        before += elements[element as usize].len();
    }
    cut
}

impl Class {
    #[expect(clippy::too_many_arguments, reason = "called once")]
    fn new(
        corners: usize,
        elements: Vec<u32>,
        lists: &IndexLists,
        record: &[u32],
        nothing: u32,
        rest: &[DVec3],
        law: Law,
        constants: Constants,
    ) -> Self {
        let blocks = elements.len().div_ceil(MOST);
        let (axes, memory) = (law.axes(), law.memory());
        let mut nodes = vec![nothing * RECORD as u32; blocks * corners * MOST];
        let per_block = if law == Law::Spring { 1 } else { corners * axes };
        let mut shapes = Aligned::zeros(blocks * per_block * MOST);
        let mut scale = Aligned::zeros(blocks * MOST);
        let mut turns = Aligned::zeros(blocks * memory * MOST);
        for (at, &element) in elements.iter().enumerate() {
            let (block, lane) = (at / MOST, at % MOST);
            let own = &lists[element as usize];
            let at_rest = |node: u32| rest[node as usize];
            let middle = own.iter().map(|&node| at_rest(node)).sum::<DVec3>() / corners as f64;
            for (corner, &node) in own.iter().enumerate() {
                nodes[(block * corners + corner) * MOST + lane] = record[node as usize] * RECORD as u32;
                for axis in 0..axes {
                    shapes.as_mut_slice()[((block * corners + corner) * axes + axis) * MOST + lane] =
                        (at_rest(node) - middle)[axis];
                }
            }
            if law == Law::Spring {
                shapes.as_mut_slice()[at] = constants.stiffness * (at_rest(own[0]) - at_rest(own[1])).length();
            }
            let squares: f64 = own.iter().map(|&node| (at_rest(node) - middle).length_squared()).sum();
            scale.as_mut_slice()[at] = if squares > 0.0 { 1.0 / squares } else { 1.0 };
        }
        for lane in 0..blocks * MOST {
            // The identity: the real part of a quaternion is last, the cosine first.
            let entry = if memory == 4 { 3 } else { 0 };
            if memory > 0 {
                turns.as_mut_slice()[(lane / MOST * memory + entry) * MOST + lane % MOST] = 1.0;
            }
        }
        let kept = Aligned::zeros(blocks * memory * MOST);
        Self { corners, elements, nodes, rest: shapes, scale, turns, kept }
    }
}

impl General {
    /// Whether the body exceeds the share of the last cache that it can count on: prefetching what is read in no
    /// order is then worth its instructions. So many parts have 11 MB if elements have eight corners.
    pub(super) fn is_large(&self) -> bool {
        self.parts.len() > 8
    }

    /// Evaluates the forces once, unless they are known, and moves all nodes. Returns the first node that becomes too
    /// fast.
    fn pass(&self, pass: Pass, around: Around<'_>, crew: &mut Crew) -> Option<Lost> {
        let (body, threads, lost) = (self, crew.threads(), AtomicU32::new(NONE));
        let share = |count: usize, me: usize| me * count / threads..(me + 1) * count / threads;
        crew.run(&|me| {
            for part in share(self.parts.len(), me) {
                lost.fetch_min(
                    self.set.run(OnePart { body, part, sums: &body.sums[me], pass, around }),
                    Ordering::Relaxed,
                );
            }
        });
        let shared = self.shared.index.len() / MOST;
        if shared > 0 {
            crew.run(&|me| {
                let blocks = share(shared, me);
                lost.fetch_min(self.set.run(SharedNodes { body, blocks, pass, around }), Ordering::Relaxed);
            });
        }
        let lost = lost.into_inner();
        (lost != NONE).then_some(Lost { step: pass.number, node: lost as usize })
    }
}

/// No node.
pub(super) const NONE: u32 = u32::MAX;

/// The lower of two nodes: `one`, and the first of the lanes whose bits are set.
#[inline(always)]
pub(super) fn first_of(one: u32, lanes: u32, index: impl Fn(usize) -> u32) -> u32 {
    if lanes == 0 { one } else { (0..MOST).filter(|lane| lanes >> lane & 1 == 1).map(index).fold(one, u32::min) }
}

impl Stepper for General {
    fn load(&mut self, position: &[DVec3], velocity: &[DVec3], memory: &[f64]) {
        for node in 0..self.places.len() {
            self.set_node(node, position[node], velocity[node]);
        }
        let width = self.law.memory();
        for class in self.parts.iter_mut().flat_map(|part| &mut part.classes) {
            let turns = class.turns.as_mut_slice();
            for (at, &element) in class.elements.iter().enumerate() {
                for entry in 0..width {
                    turns[(at / MOST * width + entry) * MOST + at % MOST] = memory[element as usize * width + entry];
                }
            }
        }
        self.tally.load(memory.get(self.elements * width));
    }

    fn store(&mut self, position: &mut [DVec3], velocity: &mut [DVec3], memory: &mut [f64]) {
        for node in 0..self.places.len() {
            (position[node], velocity[node]) = self.node(node);
        }
        let width = self.law.memory();
        for class in self.parts.iter_mut().flat_map(|part| &mut part.classes) {
            let turns = class.turns.as_mut_slice();
            for (at, &element) in class.elements.iter().enumerate() {
                for entry in 0..width {
                    memory[element as usize * width + entry] = turns[(at / MOST * width + entry) * MOST + at % MOST];
                }
            }
        }
        self.tally.store(memory.get_mut(self.elements * width));
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

    fn is_damped(&self) -> bool {
        self.constants.damping > 0.0
    }

    fn keep(&mut self) {
        for part in &mut self.parts {
            part.kept.copy_from(&mut part.records);
            part.classes.iter_mut().for_each(|class| class.kept.copy_from(&mut class.turns));
        }
        self.tally.keep();
    }

    fn restore(&mut self) {
        for part in &mut self.parts {
            part.records.copy_from(&mut part.kept);
            part.classes.iter_mut().for_each(|class| class.turns.copy_from(&mut class.kept));
        }
        self.tally.restore();
    }

    fn run(&mut self, passes: Passes, some: Range<u64>, around: &Around<'_>, crew: &mut Crew) -> Option<Lost> {
        if self.sums.len() < crew.threads() {
            let most = self.parts.iter().map(|part| part.index.len() + 1).max().unwrap_or(0);
            self.sums.resize_with(crew.threads(), || Aligned::zeros(most * SUM));
        }
        some.into_iter().find_map(|pass| self.pass(passes.get(pass), *around, crew))
    }
}
