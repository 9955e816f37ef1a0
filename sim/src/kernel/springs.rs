//! Eq. (1) in lanes, for springs in families. A family is all pairs of nodes with one difference of indices,
//! as on every lattice.
//!
//! Lanes are consecutive nodes. A spring adds its force to the lane of its lower node and, at the offset of the family,
//! to the lane of its upper node. As the other ends of a node's springs are either earlier or later nodes, all forces of a
//! node are known when the pass reaches it: one pass evaluates the springs and moves the nodes in place.
//!
//! The sum of a node is: the forces from earlier nodes, the farthest first, plus those from later nodes, the farthest
//! first. So its bits do not depend on the width.
//!
//! A large body is divided into slabs, which depend on the body only. The previous slab still
//! reads the first nodes of a slab and adds forces to them. So they are moved after all others, and their sum has one more term.

#![expect(unsafe_code, reason = "lanes without tests of bounds; threads share the arrays by slabs")]

use super::general::{NONE, first_lost, first_of};
use super::memory::Aligned;
use super::stepper::{Pass, Passes, Stepper};
use super::update::{NodeUpdate, NodeVector, Stage};
use super::{Around, Conditions, Lost};
use crate::body::Body;
use crate::crew::Crew;
use crate::lanes::{Lanes, Set, Work, each};
use glam::DVec3;
use std::ops::Range;

/// Nodes for which one family is evaluated before the next, so that their data stay in the first-level cache. The size
/// does not change any bit.
const CHUNK: usize = 128;
/// Nodes that share a byte of presence.
const BLOCK: usize = 8;
/// Natural lengths that differ by no more than this fraction count as equal. Covers round-off of coordinates up to a
/// thousand lengths from the origin.
const ALIKE: f64 = 1e-13;

/// Springs of one family.
#[derive(Clone)]
struct Family {
    /// The difference of the indices of the two nodes.
    offset: usize,
    /// `k L` (N) if all are equal.
    tension: f64,
    /// Otherwise the start of the family's `k L`, by first node, in the list of all.
    tensions: Option<usize>,
}

/// The springs of a body, in families.
#[derive(Clone)]
pub(crate) struct Stencil {
    set: Set,
    nodes: usize,
    /// `k` (N/m).
    stiffness: f64,
    /// `D` (N s/m).
    damping: f64,
    /// ΔT (s).
    step: f64,
    /// Sorted by offset, the largest first.
    families: Vec<Family>,
    /// One bit for each spring: chunk by chunk, family by family, block by block.
    presence: Vec<[u8; CHUNK / BLOCK]>,
    tensions: Aligned,
    /// Positions, velocities, inverse masses and accelerations, with a separate array for each coordinate.
    state: Aligned,
    stride: usize,
    kept: Aligned,
    slabs: Vec<Slab>,
    /// Chunks at the beginning of every slab but the first that are moved after all others.
    deferred: usize,
}

/// A part of the body that one thread works on.
#[derive(Clone)]
struct Slab {
    /// Its chunks.
    first: usize,
    last: usize,
    /// The forces of springs from earlier nodes on its nodes and on those after it (N), with a separate array for each
    /// coordinate.
    pulls: Aligned,
    stride: usize,
}

/// The start of each array, in strides.
const VELOCITY: usize = 3;
const INVERSE_MASS: usize = 6;
const ACCELERATION: usize = 7;
const ARRAYS: usize = 10;

/// The springs between pairs of nodes, by the difference of their numbers and the lower one: those of the same difference together. Two springs
/// between the same nodes are in two families.
fn families(springs: &[[u32; 2]]) -> Vec<Vec<(usize, usize, usize)>> {
    let mut sorted: Vec<(usize, usize, usize)> = Vec::with_capacity(springs.len());
    for ends in springs {
        let [low, high] = [ends[0].min(ends[1]), ends[0].max(ends[1])].map(|end| end as usize);
        sorted.push((high - low, low, high));
    }
    sorted.sort_unstable_by_key(|&(offset, low, _)| (std::cmp::Reverse(offset), low));
    let mut families: Vec<Vec<_>> = Vec::new();
    for family in sorted.chunk_by(|a, b| a.0 == b.0) {
        let mut doubles = 0;
        let begin = families.len();
        for (at, &spring) in family.iter().enumerate() {
            doubles = if at > 0 && family[at - 1].1 == spring.1 { doubles + 1 } else { 0 };
            if begin + doubles == families.len() {
                families.push(Vec::new());
            }
            families[begin + doubles].push(spring);
        }
    }
    families
}

/// So many chunks in slabs, which are long compared with the deferred chunks. Their number is a power of two.
fn slabs(chunks: usize, deferred: usize) -> Vec<Slab> {
    let count = 1 << (chunks / (4 * deferred)).clamp(1, 16).ilog2();
    let slab = |at: usize| {
        let [first, last] = [at, at + 1].map(|at| at * chunks / count);
        let stride = staggered((last - first + deferred) * CHUNK);
        Slab { first, last, pulls: Aligned::zeros(3 * stride), stride }
    };
    (0..count).map(slab).collect()
}

impl Stencil {
    /// The springs of a body with a stiffness (N/m) and a damping (N s/m), or `None` if they form no families, so that most
    /// lanes would be empty, or if elements are filled in part or differ in stiffness.
    pub(crate) fn new(
        springs: &[[u32; 2]],
        [stiffness, damping]: [f64; 2],
        body: &Body,
        conditions: &Conditions,
    ) -> Option<Self> {
        /// Lanes for each spring, at most: if less than half of them are used, the gathering kernel is faster.
        const SPARSE: usize = 2;
        let &Conditions { step, set, .. } = conditions;
        let Body { rest, mass, fill: None, stiffness: None, .. } = body else { return None };
        let nodes = rest.len();
        let chunks = nodes.div_ceil(CHUNK).max(1);
        let families = families(springs);
        let blocks: usize =
            families.iter().map(|family| family.chunk_by(|a, b| a.1 / BLOCK == b.1 / BLOCK).count()).sum();
        if blocks * BLOCK > SPARSE * springs.len() + BLOCK * families.len() {
            return None;
        }
        let reach = families.first().map_or(0, |family| family[0].0);
        let padded = chunks * CHUNK;
        let mut presence = vec![[0; CHUNK / BLOCK]; chunks * families.len()];
        let mut listed = Vec::new();
        let mut made = Vec::with_capacity(families.len());
        for (at, family) in families.iter().enumerate() {
            let tension = |&(_, low, high): &(usize, usize, usize)| stiffness * (rest[low] - rest[high]).length();
            for &(_, low, _) in family {
                presence[low / CHUNK * families.len() + at][low % CHUNK / BLOCK] |= 1 << (low % BLOCK);
            }
            // On a lattice lengths differ only by the rounding of coordinates.
            let common = tension(&family[0]);
            let differs = |spring| (tension(spring) - common).abs() > ALIKE * common;
            let tensions = family.iter().any(differs).then(|| {
                let begin = listed.len();
                listed.resize(begin + padded, 0.0);
                family.iter().for_each(|spring| listed[begin + spring.1] = tension(spring));
                begin
            });
            made.push(Family { offset: family[0].0, tension: common, tensions });
        }
        let mut tensions = Aligned::zeros(listed.len());
        tensions.as_mut_slice()[..listed.len()].copy_from_slice(&listed);
        let behind = reach + BLOCK;
        let deferred = behind.div_ceil(CHUNK);
        let slabs = slabs(chunks, deferred);
        let stride = staggered(padded + behind);
        let mut state = Aligned::zeros(ARRAYS * stride);
        for (inverse, &mass) in state.as_mut_slice()[INVERSE_MASS * stride..].iter_mut().zip(mass) {
            *inverse = 1.0 / mass;
        }
        Some(Self {
            set,
            nodes,
            stiffness,
            damping,
            step,
            families: made,
            presence,
            tensions,
            kept: Aligned::zeros(ARRAYS * stride),
            state,
            stride,
            slabs,
            deferred,
        })
    }

    fn arrays(&self) -> Arrays {
        Arrays { state: self.state.pointer(), stride: self.stride }
    }

    /// Evaluates the forces once, unless they are known, and moves all nodes. Returns the first node that becomes too
    /// fast.
    fn pass(&self, pass: Pass, around: Around<'_>, crew: &Crew) -> Option<Lost> {
        let (springs, slabs) = (self, self.slabs.len());
        let lost = first_lost(crew, slabs, |_, own| {
            own.map(|slab| self.set.run(OneSlab { springs, slab, pass, around })).fold(NONE, u32::min)
        });
        let of_deferred = first_lost(crew, slabs.saturating_sub(1), |_, own| {
            own.map(|slab| self.set.run(Deferred { springs, slab: slab + 1, pass, around })).fold(NONE, u32::min)
        });
        let lost = lost.min(of_deferred);
        (lost != NONE).then_some(Lost { step: pass.number, node: lost as usize })
    }
}

impl Stepper for Stencil {
    fn load(&mut self, position: &[DVec3], velocity: &[DVec3], _: &[f64]) {
        self.place(position, velocity);
    }

    fn store(&mut self, position: &mut [DVec3], velocity: &mut [DVec3], _: &mut [f64]) {
        self.read(position, velocity);
    }

    fn node(&mut self, node: usize) -> (DVec3, DVec3) {
        let (all, stride) = (self.state.as_mut_slice(), self.stride);
        let at = |first: usize| DVec3::from_array([0, 1, 2].map(|axis| all[(first + axis) * stride + node]));
        (at(0), at(VELOCITY))
    }

    fn set_node(&mut self, node: usize, position: DVec3, velocity: DVec3) {
        let (all, stride) = (self.state.as_mut_slice(), self.stride);
        for axis in 0..3 {
            all[axis * stride + node] = position[axis];
            all[(VELOCITY + axis) * stride + node] = velocity[axis];
        }
    }

    fn is_damped(&self) -> bool {
        self.damping > 0.0
    }

    fn copy(&self) -> Box<dyn Stepper> {
        Box::new(self.clone())
    }

    fn keep(&mut self) {
        self.kept.copy_from(&mut self.state);
    }

    fn restore(&mut self) {
        self.state.copy_from(&mut self.kept);
    }

    fn run(&mut self, passes: Passes, some: Range<u64>, around: &Around<'_>, crew: &Crew) -> Option<Lost> {
        some.into_iter().find_map(|pass| self.pass(passes.get(pass), *around, crew))
    }
}

/// An array length for arrays that are used together, so that their cache lines are not in the same sets of the cache.
fn staggered(count: usize) -> usize {
    let lines = count.div_ceil(Aligned::LINE);
    (lines + (5 + 64 - lines % 64) % 64) * Aligned::LINE
}

/// The state's arrays.
#[derive(Clone, Copy)]
struct Arrays {
    state: *mut f64,
    stride: usize,
}

impl Arrays {
    /// Three coordinates of nodes from `at` on.
    #[inline(always)]
    unsafe fn load<L: Lanes>(&self, array: usize, at: usize) -> [L; 3] {
        // SAFETY: the caller's; nodes and the padding after them are within a stride.
        each!(3, axis => unsafe { L::load(self.state.add((array + axis) * self.stride + at)) })
    }

    #[inline(always)]
    unsafe fn store<L: Lanes>(&self, array: usize, at: usize, values: [L; 3]) {
        // SAFETY: as above.
        each!(3, axis => unsafe { values[axis].store(self.state.add((array + axis) * self.stride + at)) });
    }

    /// Moves the nodes from `at` on.
    #[inline(always)]
    unsafe fn advance<L: Lanes>(&self, update: &NodeUpdate<'_, L>, stage: Stage, at: usize, force: [L; 3]) -> u32 {
        // SAFETY: the caller's.
        unsafe {
            let zero = [L::splat(0.0); 3];
            let mut nodes = NodeVector {
                position: self.load(0, at),
                velocity: self.load(VELOCITY, at),
                acceleration: if stage.loads_acceleration() { self.load(ACCELERATION, at) } else { zero },
            };
            let inverse_mass = L::load(self.state.add(INVERSE_MASS * self.stride + at));
            let force = update.pushed(force, |lane| at + lane);
            let lost = update.advance(&mut nodes, force, inverse_mass, |lane| at + lane);
            self.store(0, at, nodes.position);
            self.store(VELOCITY, at, nodes.velocity);
            if stage.stores_acceleration() {
                self.store(ACCELERATION, at, nodes.acceleration);
            }
            lost
        }
    }
}

/// The springs that begin in a slab, and the update of its nodes.
struct OneSlab<'a> {
    springs: &'a Stencil,
    slab: usize,
    pass: Pass,
    around: Around<'a>,
}

#[repr(C, align(64))]
struct Own([[f64; CHUNK]; 3]);

impl Work for OneSlab<'_> {
    type Output = u32;

    #[inline(always)]
    fn run<L: Lanes>(self) -> u32 {
        if self.springs.damping > 0.0 { self.evaluate::<L, true>() } else { self.evaluate::<L, false>() }
    }
}

impl OneSlab<'_> {
    #[inline(always)]
    fn evaluate<L: Lanes, const DAMPED: bool>(self) -> u32 {
        let Self { springs, slab: at, pass: Pass { stage, number, .. }, around } = self;
        let slab = &springs.slabs[at];
        let (arrays, pulls, width, start) = (springs.arrays(), slab.pulls.pointer(), slab.stride, slab.first * CHUNK);
        let update = NodeUpdate::<L>::new(stage, springs.step, number, around);
        let (k, d, one, zero) = (L::splat(springs.stiffness), L::splat(springs.damping), L::splat(1.0), L::splat(0.0));
        let all_tensions = springs.tensions.pointer().cast_const();
        let mut own = Own([[0.0; CHUNK]; 3]);
        let mut lost = NONE;
        for chunk in slab.first..slab.last {
            let base = chunk * CHUNK;
            let count = (springs.nodes.next_multiple_of(BLOCK) - base).min(CHUNK);
            own.0 = [[0.0; CHUNK]; 3];
            let families = if stage.has_forces() { &springs.families } else { &[][..] };
            for (row, family) in families.iter().enumerate() {
                let &Family { offset, tension, tensions } = family;
                let listed = tensions.map(|begin| all_tensions.wrapping_add(begin));
                let tension = L::splat(tension);
                let present = &springs.presence[chunk * springs.families.len() + row];
                for (block, &present) in present.iter().enumerate() {
                    if present == 0 {
                        continue;
                    }
                    for part in (0..BLOCK).step_by(L::WIDTH) {
                        let i = base + block * BLOCK + part;
                        let j = i + offset;
                        // SAFETY: i is a node of this slab or up to seven places behind the last, j at most `reach`
                        // farther; all arrays are that long. No other thread writes to the nodes i, nor to the nodes j,
                        // which are of this slab or deferred, nor to this slab's pulls.
                        unsafe {
                            let [near, far] = [arrays.load::<L>(0, i), arrays.load::<L>(0, j)];
                            let p = each!(3, axis => far[axis] - near[axis]);
                            let squared = p[2].mul_add(p[2], p[1].mul_add(p[1], p[0] * p[0]));
                            let inverse = one.div(squared.sqrt());
                            let tension = listed.map_or(tension, |listed| L::load(listed.add(i)));
                            let along = if DAMPED {
                                let [near, far] = [arrays.load::<L>(VELOCITY, i), arrays.load::<L>(VELOCITY, j)];
                                let v = each!(3, axis => far[axis] - near[axis]);
                                let product = v[2].mul_add(p[2], v[1].mul_add(p[1], v[0] * p[0]));
                                (product * d).mul_sub(inverse, tension)
                            } else {
                                -tension
                            };
                            let is_spring = L::both(L::mask(u32::from(present) >> part), zero.lt(squared));
                            let pull = along.mul_add(inverse, k).select(is_spring, zero);
                            for axis in 0..3 {
                                let near = own.0[axis].as_mut_ptr().add(i - base);
                                pull.mul_add(p[axis], L::load(near)).store(near);
                                let far = pulls.add(axis * width + j - start);
                                pull.neg_mul_add(p[axis], L::load(far)).store(far);
                            }
                        }
                    }
                }
            }
            let is_deferred = at > 0 && chunk - slab.first < springs.deferred;
            for i in (base..base + count).step_by(L::WIDTH) {
                // SAFETY: as above.
                unsafe {
                    let place = |axis: usize| pulls.add(axis * width + i - start);
                    let force: [L; 3] =
                        std::array::from_fn(|axis| L::load(place(axis)) + L::load(own.0[axis].as_ptr().add(i - base)));
                    if is_deferred {
                        each!(3, axis => force[axis].store(place(axis)));
                    } else {
                        each!(3, axis => zero.store(place(axis)));
                        let lanes = arrays.advance(&update, stage, i, force);
                        lost = first_of(lost, lanes, around.held, |lane| (i + lane) as u32);
                    }
                }
            }
        }
        lost
    }
}

/// The update of the first nodes of a slab.
struct Deferred<'a> {
    springs: &'a Stencil,
    slab: usize,
    pass: Pass,
    around: Around<'a>,
}

impl Work for Deferred<'_> {
    type Output = u32;

    #[inline(always)]
    fn run<L: Lanes>(self) -> u32 {
        let Self { springs, slab: at, pass: Pass { stage, number, .. }, around } = self;
        let (before, slab) = (&springs.slabs[at - 1], &springs.slabs[at]);
        let update = NodeUpdate::<L>::new(stage, springs.step, number, around);
        let (arrays, zero) = (springs.arrays(), L::splat(0.0));
        let mut lost = NONE;
        let start = slab.first * CHUNK;
        for i in (start..start + springs.deferred * CHUNK).step_by(L::WIDTH) {
            // SAFETY: slabs are longer than what is deferred. All slabs are done, and each thread has its own deferred
            // nodes.
            unsafe {
                let halo = |axis: usize| before.pulls.pointer().add(axis * before.stride + i - before.first * CHUNK);
                let place = |axis: usize| slab.pulls.pointer().add(axis * slab.stride + i - start);
                let force = each!(3, axis => L::load(halo(axis)) + L::load(place(axis)));
                for axis in 0..3 {
                    zero.store(halo(axis));
                    zero.store(place(axis));
                }
                let lanes = arrays.advance(&update, stage, i, force);
                lost = first_of(lost, lanes, around.held, |lane| (i + lane) as u32);
            }
        }
        lost
    }
}
