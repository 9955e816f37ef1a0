//! Passes over a lattice, by one thread or several, each with its own planes of boxes.

mod plane;

use super::{Chunk, Grid, LatticeStepper, Parameters, Signal, Slab, slot};
use crate::crew::{Crew, wait_until};
use crate::kernel::damped::{DEFORMING, NONE, RELATIVE};
use crate::kernel::memory::Aligned;
use crate::kernel::rotation::{Arctangent, Optimum, Solver};
use crate::kernel::stepper::{Pass, Passes, Scheme};
use crate::kernel::update::NodeUpdate;
use crate::kernel::{Around, Lost, Rotation};
use crate::lanes::{Lanes, MOST, Set, Work};
use crate::tally::Tally;
use std::mem::MaybeUninit;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// Executes some of the passes; see [`Stepper::run`](super::Stepper::run). Uses at most as many threads of the crew as
/// there are planes of boxes along z.
pub(super) fn run(
    lattice: &mut LatticeStepper,
    passes: Passes,
    some: Range<u64>,
    around: &Around<'_>,
    crew: &Crew,
) -> Option<Lost> {
    if some.is_empty() {
        return None;
    }
    let members = crew.threads().min(lattice.grid.cells[2]);
    if lattice.signals.len() < members {
        lattice.slabs = Aligned::zeros(members * Slab::new(&lattice.grid).end);
        lattice.signals = (0..members).map(|_| Signal::default()).collect();
    }
    for signal in &mut lattice.signals {
        *signal = Signal::default();
    }
    let stop = AtomicBool::new(false);
    let sweep = Sweep::new(lattice, passes, [some.start, some.end], around, members, &stop);
    let lost = Mutex::new(None);
    let work = |member: usize| {
        if member >= members {
            return;
        }
        // Other threads wait for this one; the guard ends their wait if it panics.
        let _guard = StopOnPanic(&stop);
        // SAFETY: each thread has its own buffers.
        let slabs = unsafe { sweep.slabs().add(member * sweep.slab.end) };
        let sweep = Sweep { member, slabs, ..sweep };
        if let Some(found) = sweep.solve(lattice.set, &lattice.parameters) {
            *lost.lock().unwrap_or_else(PoisonError::into_inner) = Some(found);
        }
    };
    if members == 1 {
        work(0)
    } else {
        crew.run(&work)
    }
    lost.into_inner().unwrap_or_else(PoisonError::into_inner)
}

/// The constants of the linear maps of boxes. The columns of a map are the sums of four edges over four sides.
#[derive(Clone, Copy)]
struct Maps {
    /// Whether forces depend on them.
    are_used: bool,
    /// The force on a corner for the sum of the edges along an axis (N/m).
    affine: f64,
    /// The relative volume for the product of the three sums (1/m³).
    per_volume: f64,
    /// The force on a corner for the product of two of the sums, times the relative excess of the volume (N/m²).
    pressure: f64,
}

struct StopOnPanic<'a>(&'a AtomicBool);

impl Drop for StopOnPanic<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.store(true, Ordering::Relaxed);
        }
    }
}

/// Everything that a sweep reads and writes. See the fields of the same name.
///
/// A sweep works on its own copy, whose address does not escape: otherwise the compiler would have to assume that every
/// store can change it.
#[derive(Clone, Copy)]
struct Sweep<'a> {
    nodes: *mut f64,
    turns: *mut f64,
    live: *const f64,
    valence: *const f64,
    /// The buffers of this thread.
    slabs: *mut f64,
    slab: Slab,
    /// A [`Chunk`].
    work: *mut f64,
    grid: Grid,
    stride: usize,
    box_stride: usize,
    ring: usize,
    /// `k` in `w` (N/m).
    stiffness: f64,
    damping: f64,
    maps: Maps,
    /// The sides divided by their mean.
    ratio: [f64; 3],
    is_cube: bool,
    /// Scales sums of edges to about 1.
    scale: f64,
    /// Half the mean side, times the stiffness (N).
    half: f64,
    step: f64,
    parts: usize,
    around: &'a Around<'a>,
    passes: Passes,
    /// The passes to be executed: from the first number up to, not including, the second.
    some: [u64; 2],
    /// The number of this thread.
    member: usize,
    members: usize,
    signals: &'a [Signal],
    tally: &'a Tally,
    /// Set when a thread has panicked or found a node that is too fast.
    stop: &'a AtomicBool,
}

// SAFETY: threads write to their own planes, and read those of others only when `Signal` allows it.
unsafe impl Sync for Sweep<'_> {}

impl<'a> Sweep<'a> {
    /// The first of so many threads, without buffers of its own.
    fn new(
        lattice: &'a LatticeStepper,
        passes: Passes,
        some: [u64; 2],
        around: &'a Around<'a>,
        members: usize,
        stop: &'a AtomicBool,
    ) -> Self {
        let LatticeStepper { grid, parameters, parts, nodes, turns, pattern, slabs, signals, tally, .. } = lattice;
        let &Parameters { stiffness, bending, volume, damping, step, .. } = parameters;
        let side = grid.sides.element_sum() / 3.0;
        let ratio = (grid.sides / side).to_array();
        Self {
            nodes: nodes.pointer(),
            turns: turns.pointer(),
            live: pattern.live.pointer(),
            valence: pattern.valence.pointer(),
            slabs: slabs.pointer(),
            slab: Slab::new(grid),
            work: std::ptr::null_mut(),
            grid: *grid,
            stride: grid.stride(),
            box_stride: grid.box_stride(),
            ring: grid.ring(),
            stiffness: bending * stiffness,
            damping,
            maps: Maps {
                are_used: bending != 1.0 || volume != 0.0,
                affine: 0.125 * (1.0 - bending) * stiffness,
                per_volume: 1.0 / (64.0 * grid.sides.element_product()),
                pressure: volume * stiffness * grid.sides.length_squared() / (192.0 * grid.sides.element_product()),
            },
            ratio,
            is_cube: ratio == [1.0; 3],
            // The columns of `A` at rest have length 2 side²; the factor side / 2 is left out.
            scale: 1.0 / (4.0 * side),
            half: 0.5 * side * stiffness,
            step,
            parts: *parts,
            around,
            passes,
            some,
            member: 0,
            members,
            signals,
            tally,
            stop,
        }
    }

    /// Executes the passes of this thread by the rotation and the damping of the parameters.
    fn solve(&self, set: Set, parameters: &Parameters) -> Option<Lost> {
        let mut found = None;
        macro_rules! run {
            ($damped:ident) => {
                match parameters.rotation {
                    Rotation::Optimum => set.run(Solved::<_, $damped>(self, Optimum, &mut found)),
                    Rotation::Arctangent { passes } => {
                        set.run(Solved::<_, $damped>(self, Arctangent { passes }, &mut found));
                    }
                }
            };
        }
        match parameters.damped {
            NONE => run!(NONE),
            RELATIVE => run!(RELATIVE),
            _ => run!(DEFORMING),
        }
        found
    }
}

/// A sweep with a solver, and the velocity that is damped.
struct Solved<'a, 'b, S, const DAMPING: u8>(&'a Sweep<'b>, S, &'a mut Option<Lost>);

impl<S: Solver, const DAMPING: u8> Work for Solved<'_, '_, S, DAMPING> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self(&sweep, solver, found) = self;
        let mut chunk = MaybeUninit::<Chunk>::uninit();
        let sweep = Sweep { work: chunk.as_mut_ptr().cast(), ..sweep };
        if sweep.passes.scheme == Scheme::SemiImplicitEuler {
            // Compiled separately with a constant scheme.
            let passes = Passes { scheme: Scheme::SemiImplicitEuler, ..sweep.passes };
            Sweep { passes, ..sweep }.passes::<L, S, DAMPING>(solver, found);
        } else {
            sweep.passes::<L, S, DAMPING>(solver, found);
        }
    }
}

impl Sweep<'_> {
    /// Executes all passes of `some`.
    #[inline(always)]
    fn passes<L: Lanes, S: Solver, const DAMPING: u8>(&self, solver: S, found: &mut Option<Lost>) {
        let [first, end] = self.some;
        for pass in 0..end - first {
            let Pass { stage, number, commit, .. } = self.passes.get(first + pass);
            let update = NodeUpdate::<L>::new(stage, self.step, number, *self.around);
            // SAFETY: the arrays belong to a lattice, all to this grid, and are accessed by no one but the other
            // threads.
            let bad = unsafe {
                if stage.has_forces() {
                    self.pass::<L, S, DAMPING>(pass, &update, solver, commit)
                } else {
                    self.coast::<L>(pass, &update)
                }
            };
            if let Some(node) = bad {
                *found = Some(Lost { step: number, node });
                self.stop.store(true, Ordering::Relaxed);
            }
            if self.stop.load(Ordering::Relaxed) {
                return;
            }
        }
    }

    #[inline(always)]
    fn slabs(&self) -> *mut f64 {
        self.slabs
    }

    /// A pointer to the first number of a vector of nodes; the others follow at distances of [`MOST`].
    #[inline(always)]
    unsafe fn nodes(&self, plane: usize, at: usize) -> *mut f64 {
        // SAFETY: the caller passes an existing plane and less than a stride.
        unsafe { self.nodes.add(slot(plane * self.stride + at, self.parts)) }
    }

    /// The index of a place in a ring buffer with so many parts, and the distance between parts. Where a vector is a
    /// cache line, all parts of a vector are together, at fixed distances; with narrower vectors each part has an array
    /// of its own, so that consecutive lanes are adjacent.
    #[inline(always)]
    fn ring_place<L: Lanes>(&self, place: usize, parts: usize) -> (usize, usize) {
        if L::WIDTH == MOST { (place * parts, MOST) } else { (place, self.ring + MOST) }
    }

    /// Moves the nodes of this thread without evaluating forces, in a pass of this number.
    #[inline(always)]
    unsafe fn coast<L: Lanes>(&self, pass: u64, update: &NodeUpdate<'_, L>) -> Option<usize> {
        let planes = self.grid.cells[2];
        let first = planes * self.member / self.members;
        let end = planes * (self.member + 1) / self.members + usize::from(self.member + 1 == self.members);
        for plane in first..end {
            // SAFETY: planes from `first` on belong to this thread and are moved before the others may read them.
            let bad = unsafe { self.nodes_between::<L, NONE>(plane, update, |_| (L::splat(0.0), L::splat(0.0))) };
            if bad.is_some() {
                return bad;
            }
        }
        self.signals[self.member].pulled.store(pass + 1, Ordering::Release);
        self.signals[self.member].shared.store(pass + 1, Ordering::Release);
        None
    }

    /// Evaluates the forces on the planes of this thread and moves their nodes, in a pass of this number.
    #[inline(always)]
    unsafe fn pass<L: Lanes, S: Solver, const DAMPING: u8>(
        &self,
        pass: u64,
        update: &NodeUpdate<'_, L>,
        solver: S,
        commit: bool,
    ) -> Option<usize> {
        let planes = self.grid.cells[2];
        let first = planes * self.member / self.members;
        let end = planes * (self.member + 1) / self.members;
        let is_last = self.member + 1 == self.members;
        // SAFETY: planes from `first` on belong to this thread. The one at `end`, if it belongs to another, is read
        // after the other has moved it and moved by the other after it was read. The same holds for the forces of both
        // there.
        unsafe {
            let memory = |part: usize| self.slabs.add(part);
            if self.member == 0 {
                self.clear::<L>(memory(self.slab.below));
            }
            for plane in first..end {
                let is_end = plane + 1 == end && !is_last;
                if is_end && !self.wait(|| self.signals[self.member + 1].shared.load(Ordering::Acquire) >= pass) {
                    return None;
                }
                let above = memory(if is_end { self.slab.highest } else { self.slab.below });
                let is_shared = plane == first && self.member > 0;
                if let Some(node) = self.plane::<L, S, DAMPING>(plane, update, solver, commit, above, is_shared) {
                    return Some(node);
                }
            }
            self.signals[self.member].pulled.store(pass + 1, Ordering::Release);
            if is_last {
                let below = memory(self.slab.below);
                let bad =
                    self.nodes_between::<L, DAMPING>(planes, update, |at| (L::load(below.add(at)), L::splat(0.0)));
                if bad.is_some() {
                    return bad;
                }
            }
            if self.member > 0 {
                let before = self.member - 1;
                if !self.wait(|| self.signals[before].pulled.load(Ordering::Acquire) > pass) {
                    return None;
                }
                let below = memory(self.slab.highest).sub(self.slab.end);
                let lowest = memory(self.slab.lowest);
                let bad = self
                    .nodes_between::<L, DAMPING>(first, update, |at| (L::load(below.add(at)), L::load(lowest.add(at))));
                if bad.is_some() {
                    return bad;
                }
                self.signals[self.member].shared.store(pass + 1, Ordering::Release);
            }
        }
        None
    }

    /// Waits for another thread; false if the sweep is to stop.
    #[inline(never)]
    fn wait(&self, is_so: impl Fn() -> bool) -> bool {
        wait_until(|| is_so() || self.stop.load(Ordering::Relaxed));
        is_so()
    }

    /// Sets the forces of the boxes below the first plane to zero.
    #[inline(always)]
    unsafe fn clear<L: Lanes>(&self, below: *mut f64) {
        for at in (0..3 * self.stride).step_by(L::WIDTH) {
            // SAFETY: it has three strides, which are whole vectors.
            unsafe { L::splat(0.0).store(below.add(at)) };
        }
    }
}
