//! Forces and reports by a law.

use super::{Law, Reader, alike};
use crate::body::Body;
use crate::crew::Crew;
use crate::lanes::{Lanes, MOST, Set, Work, each};
use crate::lists::IndexLists;
use crate::model::blocks::{self, EntriesOfNode};
use crate::model::{ForceModel, Report, Scratch, Share};
use crate::state::Nodes;
use glam::DVec3;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// The elastic energy of a body.
pub(crate) trait Energy: Send + Sync {
    /// Energy and residuals with the nodes at `position` (m) and this memory of the model. Calls `share`, if given, for
    /// each element, in order.
    fn report(&self, position: &[DVec3], memory: &[f64], share: Option<&mut Share<'_>>, crew: &Crew) -> Report;
}

/// The forces and the energy of a body by the [`Law`] of its elements.
///
/// Lanes are consecutive elements with the same number of corners. Nothing is kept from one evaluation to the next. Sums of energies run
/// within chunks and then over chunks, those of forces node by node, in order, so that their bits do not depend on the width or on the
/// number of threads.
pub struct ByLaw<W> {
    set: Set,
    law: W,
    body: Arc<Body>,
    /// Those of the law, if they are not the body's.
    elements: Option<IndexLists>,
    /// The relative stiffness of each element; `None` if all are 1.
    fill: Option<Vec<f64>>,
    gather: OnceLock<EntriesOfNode>,
}

impl<W: Law> ByLaw<W> {
    /// The law on a body.
    pub fn new(law: W, body: &Arc<Body>) -> Self {
        Self::with(Set::best(), law, body)
    }

    pub(crate) fn with(set: Set, law: W, body: &Arc<Body>) -> Self {
        let (elements, fill) = (law.elements(body), law.relative_stiffness(body));
        Self { set, law, body: Arc::clone(body), elements, fill, gather: OnceLock::new() }
    }

    #[inline(always)]
    fn elements(&self) -> &IndexLists {
        self.elements.as_ref().unwrap_or(&self.body.elements)
    }

    /// The relative stiffness of `count` elements from one on; `None` if all are 1.
    #[inline(always)]
    fn parts<L: Lanes>(&self, first: usize, count: usize) -> Option<L> {
        let of_lane = |fill: &[f64], lane: usize| fill[first + lane.min(count - 1)];
        self.fill.as_deref().map(|fill| L::from_array(each!(8, lane => of_lane(fill, lane))))
    }
}

impl<W: Law> Energy for ByLaw<W> {
    fn report(&self, position: &[DVec3], memory: &[f64], share: Option<&mut Share<'_>>, crew: &Crew) -> Report {
        let with_shares = share.is_some();
        let measure = |range| self.set.run(Energies { by: self, position, memory, range, with_shares });
        let found: Vec<Found> = crew.map_chunks(self.elements().len(), measure);
        let (energy, residual) = total(&found, self.elements(), share);
        Report { energy: Some(energy), residual: W::HAS_RESIDUAL.then_some(residual) }
    }
}

/// The energy (J) and the largest residual of all chunks. Calls `share`, if given, for each element.
fn total(chunks: &[Found], elements: &IndexLists, share: Option<&mut Share<'_>>) -> (f64, f64) {
    if let Some(share) = share {
        let shares: Vec<f64> = chunks.iter().flat_map(|chunk| &chunk.shares).copied().collect();
        (0..elements.len()).for_each(|at| share(at, &elements[at], &shares[elements.range(at)]));
    }
    let energy = chunks.iter().map(|chunk| chunk.energy).sum();
    (energy, chunks.iter().fold(0.0, |most: f64, chunk| most.max(chunk.residual)))
}

/// Computes the energies of consecutive elements.
struct Energies<'a, W> {
    by: &'a ByLaw<W>,
    position: &'a [DVec3],
    memory: &'a [f64],
    range: Range<usize>,
    with_shares: bool,
}

/// The results of a chunk.
#[derive(Default)]
struct Found {
    /// (J)
    energy: f64,
    /// The largest residual.
    residual: f64,
    /// The energy of each corner (J), if requested.
    shares: Vec<f64>,
}

impl<W: Law> Work for Energies<'_, W> {
    type Output = Found;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Found {
        let Self { by, position, memory, range, with_shares } = self;
        let (mut reader, mut shares, mut found) = (Reader::<L>::new(), Vec::new(), Found::default());
        let mut at = range.start;
        while at < range.end {
            let (group, count) = alike::<L>(by.elements(), at..range.end);
            reader.read(&group, &by.body, position, None, &[1.0; MOST]);
            reader.prepare(&by.law);
            reader.recall(memory, at, count, W::MEMORY);
            let (element, rest) = reader.elements::<W>(count);
            shares.clear();
            shares.resize(element.corners(), L::splat(0.0));
            let mut residual = by.law.energy(&element, &rest, &mut shares);
            if let Some(parts) = by.parts::<L>(at, count) {
                residual = residual * parts;
                shares.iter_mut().for_each(|share| *share = *share * parts);
            }
            let residual = residual.to_array();
            let mut energy = L::splat(0.0);
            for &share in &shares {
                energy = energy + share;
            }
            let energy = energy.to_array();
            for lane in 0..count {
                found.energy += energy[lane];
                found.residual = found.residual.max(residual[lane]);
            }
            if with_shares {
                let first = found.shares.len();
                found.shares.resize(first + count * shares.len(), 0.0);
                for (corner, share) in shares.iter().enumerate() {
                    let share = share.to_array();
                    (0..count).for_each(|lane| found.shares[first + lane * shares.len() + corner] = share[lane]);
                }
            }
            at += count;
        }
        found
    }
}

impl<W: Law> ForceModel for ByLaw<W> {
    fn add_forces(&self, at: Nodes<'_>, memory: &[f64], next: &mut [f64], scratch: &mut Scratch, forces: &mut [DVec3]) {
        let elements = self.elements();
        let (crew, corners) = scratch.parts(elements.indices().len());
        blocks::for_each_block(crew, elements, W::MEMORY, next, corners, &|range, next, corners| {
            self.set.run(Forces { by: self, at, memory, range, next, corners });
        });
        let gather = || EntriesOfNode::new(self.body.len(), (0..).zip(elements.indices().iter().copied()));
        self.gather.get_or_init(gather).add(crew, corners, forces);
    }

    fn is_damped(&self) -> bool {
        self.law.is_damped()
    }

    fn report(&self, at: Nodes<'_>, memory: &[f64], share: &mut Share<'_>) -> Report {
        Energy::report(self, at.position, memory, Some(share), &Crew::new(1))
    }
}

/// Computes the forces on the corners of consecutive elements (N).
struct Forces<'a, W> {
    by: &'a ByLaw<W>,
    at: Nodes<'a>,
    memory: &'a [f64],
    range: Range<usize>,
    /// The memory of these elements.
    next: &'a mut [f64],
    /// Their corners.
    corners: &'a mut [DVec3],
}

impl<W: Law> Work for Forces<'_, W> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { by: ByLaw { law, body, .. }, at: nodes, memory, range, next, corners } = self;
        let [k, d] = law.of_node().map(L::splat);
        let (mut reader, mut first) = (Reader::<L>::new(), 0);
        let mut at = range.start;
        while at < range.end {
            let (group, count) = alike::<L>(self.by.elements(), at..range.end);
            reader.read(&group, body, nodes.position, Some(nodes.velocity), &[1.0; MOST]);
            let parts = self.by.parts::<L>(at, count);
            reader.prepare(law);
            reader.recall(memory, at, count, W::MEMORY);
            let (element, _) = reader.elements::<W>(count);
            let mut whole = law.whole(&element);
            for pass in 0..law.passes() {
                law.refine(pass, &element, &mut whole);
            }
            for corner in 0..element.corners() {
                let force = law.force(&element, corner, &whole);
                let (p, v) = element.corner(corner);
                let mut force = each!(3, axis => d.neg_mul_add(v[axis], k.neg_mul_add(p[axis], force[axis])));
                if let Some(parts) = parts {
                    force = each!(3, axis => force[axis] * parts);
                }
                let force = each!(3, axis => force[axis].to_array());
                for lane in 0..count {
                    corners[first + lane * element.corners() + corner] =
                        DVec3::new(force[0][lane], force[1][lane], force[2][lane]);
                }
            }
            first += count * element.corners();
            for (entry, row) in reader.memory.iter().enumerate() {
                (0..count).for_each(|lane| next[(at - range.start + lane) * W::MEMORY + entry] = row[lane]);
            }
            at += count;
        }
    }
}
