//! Which elements and nodes each part has, and where their numbers are.

use super::{Class, INVERSE_MASS, NONE, Part, RecordAddress, SUM, Shared, VALENCE};
use crate::body::Body;
use crate::hull::bounds;
use crate::kernel::memory::Aligned;
use crate::lanes::MOST;
use crate::law::RECORD;
use crate::lists::IndexLists;
use glam::DVec3;

/// Divides elements of a body, with the relative stiffness of each, into parts; with them come the nodes of several parts, and where the
/// record of each node is. Elements remember `memory` numbers. `constants` computes those of elements with the same number of corners.
pub(super) fn divide(
    lists: &IndexLists,
    fill: Option<&[f64]>,
    body: &Body,
    memory: usize,
    constants: &dyn Fn(&[u32]) -> Aligned,
) -> (Vec<Part>, Shared, Vec<RecordAddress>) {
    let parts = cut(lists, along_curve(lists, &body.rest));
    let uses = Uses::new(lists, fill, body.rest.len(), &parts);
    let places = vec![RecordAddress { part: 0, record: 0 }; body.rest.len()];
    let record = vec![NONE; body.rest.len()];
    let mut making = Making { lists, mass: &body.mass, memory, constants, uses, record, places, shared: Vec::new() };
    let parts = (0..).zip(&parts).map(|(number, own)| making.part(number, own)).collect();
    let shared = Shared::new(making.shared, &mut making.places);
    (parts, shared, making.places)
}

/// How elements use the nodes.
struct Uses {
    /// The first part of each node; [`NONE`] without an element.
    first: Vec<u32>,
    /// Whether it has several.
    is_shared: Vec<bool>,
    /// The sum of the relative stiffnesses of its elements.
    valence: Vec<f64>,
}

impl Uses {
    /// By the elements of each part, for so many nodes.
    fn new(lists: &IndexLists, fill: Option<&[f64]>, nodes: usize, parts: &[Vec<u32>]) -> Self {
        let (mut first, mut is_shared, mut valence) = (vec![NONE; nodes], vec![false; nodes], vec![0.0; nodes]);
        for (part, own) in (0..).zip(parts) {
            for &element in own {
                let filled = fill.map_or(1.0, |fill| fill[element as usize]);
                for &node in &lists[element as usize] {
                    let node = node as usize;
                    is_shared[node] |= first[node] != NONE && first[node] != part;
                    first[node] = first[node].min(part);
                    valence[node] += filled;
                }
            }
        }
        Self { first, is_shared, valence }
    }
}

/// What parts are made of.
struct Making<'a> {
    lists: &'a IndexLists,
    /// The mass of each node (kg).
    mass: &'a [f64],
    /// How many numbers an element remembers.
    memory: usize,
    /// The constants of elements with the same number of corners.
    constants: &'a dyn Fn(&[u32]) -> Aligned,
    uses: Uses,
    /// The record of each node in the part that is made; [`NONE`] for those that it has not.
    record: Vec<u32>,
    /// The record of each node in its first part.
    places: Vec<RecordAddress>,
    /// All records of the nodes of several parts.
    shared: Vec<(u32, RecordAddress)>,
}

impl Making<'_> {
    /// The part with a number, of some elements.
    fn part(&mut self, part: u32, own: &[u32]) -> Part {
        let [mut index, of_others] = self.nodes(part, own);
        let alone = index.len();
        index.resize(alone.next_multiple_of(MOST), 0);
        let whole = index.len();
        for (record, &node) in (0..).zip(&index[..alone]) {
            self.places[node as usize] = RecordAddress { part, record };
            self.record[node as usize] = record;
        }
        for (record, &node) in (whole as u32..).zip(&of_others) {
            self.record[node as usize] = record;
            self.shared.push((node, RecordAddress { part, record }));
            if self.uses.first[node as usize] == part {
                self.places[node as usize] = RecordAddress { part, record };
            }
        }
        index.extend(&of_others);
        let mut records = Aligned::zeros((index.len() + 1) * RECORD);
        let is_node = |at: usize| at < alone || at >= whole;
        for (at, &node) in index.iter().enumerate().filter(|(at, _)| is_node(*at)) {
            let record = &mut records.as_mut_slice()[at * RECORD..][..RECORD];
            record[INVERSE_MASS] = 1.0 / self.mass[node as usize];
            record[VALENCE] = self.uses.valence[node as usize];
        }
        let corners = |element: u32| self.lists[element as usize].len();
        let mut counts: Vec<usize> = own.iter().map(|&element| corners(element)).collect();
        counts.sort_unstable();
        counts.dedup();
        let of_class = |count: usize| own.iter().copied().filter(|&element| corners(element) == count).collect();
        // The record after the last node is for lanes without an element.
        let nothing = index.len() as u32;
        let classes = counts.into_iter().map(|count| self.class(of_class(count), nothing)).collect();
        for &node in own.iter().flat_map(|&element| &self.lists[element as usize]) {
            self.record[node as usize] = NONE;
        }
        Part {
            own: whole / MOST,
            records,
            sums: Aligned::zeros(of_others.len() * SUM),
            accelerations: Aligned::zeros(whole * 3),
            kept: Aligned::zeros((index.len() + 1) * RECORD),
            classes,
            index,
        }
    }

    /// Elements with the same number of corners. Lanes without an element use the record `nothing`.
    fn class(&self, elements: Vec<u32>, nothing: u32) -> Class {
        let corners = self.lists[elements[0] as usize].len();
        let blocks = elements.len().div_ceil(MOST);
        let mut nodes = vec![nothing * RECORD as u32; blocks * corners * MOST];
        for (at, &element) in elements.iter().enumerate() {
            for (corner, &node) in self.lists[element as usize].iter().enumerate() {
                nodes[(at / MOST * corners + corner) * MOST + at % MOST] = self.record[node as usize] * RECORD as u32;
            }
        }
        let [memory, kept] = [0; 2].map(|_| Aligned::zeros(blocks * self.memory * MOST));
        let constants = (self.constants)(&elements);
        Class { corners, elements, nodes, constants, memory, kept }
    }

    /// The nodes of this part only, and those that it shares, in the order in which the elements use them. The first part also has the nodes
    /// without an element.
    fn nodes(&mut self, part: u32, own: &[u32]) -> [Vec<u32>; 2] {
        let [mut alone, mut shared] = [Vec::new(), Vec::new()];
        for &node in own.iter().flat_map(|&element| &self.lists[element as usize]) {
            let seen = &mut self.record[node as usize];
            if *seen == NONE {
                *seen = 0;
                if self.uses.is_shared[node as usize] { &mut shared } else { &mut alone }.push(node);
            }
        }
        if part == 0 {
            alone.extend((0..self.uses.first.len() as u32).filter(|&node| self.uses.first[node as usize] == NONE));
        }
        [alone, shared]
    }
}

impl Shared {
    /// Nodes by all their records. Their places become their numbers here.
    fn new(mut records: Vec<(u32, RecordAddress)>, places: &mut [RecordAddress]) -> Self {
        // In the order of the first part, so that nodes moved one after the other are neighbours in memory.
        records.sort_by_key(|&(node, place)| {
            let RecordAddress { part, record } = places[node as usize];
            (part, record, place.part)
        });
        let (mut index, mut starts, mut all) = (Vec::new(), Vec::new(), Vec::new());
        for of_node in records.chunk_by(|a, b| a.0 == b.0) {
            let node = of_node[0].0;
            places[node as usize] = RecordAddress { part: NONE, record: index.len() as u32 };
            index.push(node);
            starts.push(all.len() as u32);
            all.extend(of_node.iter().map(|(_, place)| place));
        }
        let whole = index.len().next_multiple_of(MOST);
        index.resize(whole, 0);
        starts.resize(whole + 1, all.len() as u32);
        Self { index, starts, places: all, accelerations: Aligned::zeros(whole * 3) }
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
pub(in crate::kernel) fn parts(elements: &IndexLists) -> usize {
    /// Corners in a part: the data of their nodes stay in the second-level cache.
    const CORNERS: usize = 32768;
    elements.indices().len().div_ceil(CORNERS).max(1)
}

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
