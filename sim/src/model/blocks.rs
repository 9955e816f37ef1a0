//! Sharing the work of a model among threads, with results that do not depend on the number of threads.
//!
//! Each element or spring is evaluated by one thread, which stores its forces. Then each node adds up its own forces in
//! a fixed order. So the result has the same bits for 1, 2 or 8 threads.

use crate::crew::Crew;
use crate::lists::IndexLists;
use glam::DVec3;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Elements in the share of a thread, at least. An element takes about 150 ns and waking a thread some microseconds, so smaller shares
/// would cost more than they save.
const LEAST: usize = 512;

/// Calls `work(element, memory of the element, corners of the element)` for every element. The memory has `width` numbers
/// for each element.
pub(super) fn for_each<T: Send>(
    crew: &Crew,
    elements: &IndexLists,
    width: usize,
    memory: &mut [f64],
    corners: &mut [T],
    work: &(impl Fn(usize, &mut [f64], &mut [T]) + Sync),
) {
    for_each_block(crew, elements, width, memory, corners, &|range, memory, mut corners| {
        for (element, memory) in range.zip(memory.chunks_exact_mut(width)) {
            let (own, others) = corners.split_at_mut(elements.range(element).len());
            work(element, memory, own);
            corners = others;
        }
    });
}

/// Calls `work(elements, memory of the elements, corners of the elements)` for the share of each thread.
pub(crate) fn for_each_block<T: Send>(
    crew: &Crew,
    elements: &IndexLists,
    width: usize,
    mut memory: &mut [f64],
    mut corners: &mut [T],
    work: &(impl Fn(Range<usize>, &mut [f64], &mut [T]) + Sync),
) {
    let first_corner = |element: usize| if element == 0 { 0 } else { elements.range(element - 1).end };
    let shares = shares(crew, elements.len()).map(|range| {
        let (own, others) = std::mem::take(&mut memory).split_at_mut(range.len() * width);
        memory = others;
        let (places, others) =
            std::mem::take(&mut corners).split_at_mut(first_corner(range.end) - first_corner(range.start));
        corners = others;
        (range, own, places)
    });
    run(crew, shares, |(range, memory, corners)| work(range, memory, corners));
}

/// Calls `work(index, value)` for every value.
pub(super) fn for_each_one<T: Send>(crew: &Crew, mut values: &mut [T], work: &(impl Fn(usize, &mut T) + Sync)) {
    let shares = shares(crew, values.len()).map(|range| {
        let (own, others) = std::mem::take(&mut values).split_at_mut(range.len());
        values = others;
        (range.start, own)
    });
    run(crew, shares, |(start, own)| own.iter_mut().enumerate().for_each(|(at, value)| work(start + at, value)));
}

/// The share of each thread in a number of elements.
fn shares(crew: &Crew, count: usize) -> impl Iterator<Item = Range<usize>> {
    let threads = crew.threads().min(count / LEAST).max(1);
    (0..threads).map(move |at| at * count / threads..(at + 1) * count / threads)
}

/// Calls `work` with each share, each on a thread of its own.
fn run<S: Send>(crew: &Crew, shares: impl Iterator<Item = S>, work: impl Fn(S) + Sync) {
    let shares: Vec<_> = shares.map(|share| Mutex::new(Some(share))).collect();
    if let [only] = &shares[..] {
        return only.lock().unwrap_or_else(PoisonError::into_inner).take().into_iter().for_each(work);
    }
    crew.run(&|me| {
        let own = shares.get(me).and_then(|own| own.lock().unwrap_or_else(PoisonError::into_inner).take());
        own.into_iter().for_each(&work);
    });
}

/// The entries of all nodes, such as forces that act on them, sorted by node, and rising for each node.
pub(crate) struct EntriesOfNode {
    /// Where the entries of each node begin; the last number is where all end.
    starts: Vec<usize>,
    entries: Vec<usize>,
}

impl EntriesOfNode {
    /// Sorts entries, given in rising order, by their nodes. Node numbers are below `nodes`.
    pub(crate) fn new(nodes: usize, entries: impl Iterator<Item = (usize, u32)> + Clone) -> Self {
        let mut starts = vec![0; nodes + 1];
        for (_, node) in entries.clone() {
            starts[node as usize + 1] += 1;
        }
        for node in 0..nodes {
            starts[node + 1] += starts[node];
        }
        let mut next = starts.clone();
        let mut sorted = vec![0; starts[nodes]];
        for (entry, node) in entries {
            sorted[next[node as usize]] = entry;
            next[node as usize] += 1;
        }
        Self { starts, entries: sorted }
    }

    /// Adds those of some forces that act on each node to its own, in rising order.
    pub(crate) fn add(&self, crew: &Crew, entries: &[DVec3], forces: &mut [DVec3]) {
        for_each_one(crew, forces, &|node, force| {
            for &entry in self.of(node) {
                *force += entries[entry];
            }
        });
    }

    /// The entries of a node.
    pub(crate) fn of(&self, node: usize) -> &[usize] {
        &self.entries[self.starts[node]..self.starts[node + 1]]
    }
}
