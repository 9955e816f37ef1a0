//! The law of an element: its forces, its memory and its energy, written once for vectors of elements.
//!
//! From a [`Law`] follow a [`ForceModel`](super::model::ForceModel) and reports ([`ByLaw`]), and vectorised steps. All have the same bits
//! for every vector set.

#![expect(unsafe_code, reason = "the corners of elements are read without tests of bounds")]

mod breaking;
mod by_law;
mod filled;
mod reader;
mod rigid;

pub(crate) use breaking::{Breaking, Strained};
pub use by_law::ByLaw;
pub(crate) use by_law::Energy;
pub(crate) use filled::Filled;
pub(crate) use reader::{Reader, alike};
pub(crate) use rigid::{Rigid, Turning, off};

use super::body::Body;
use super::fill;
use super::lanes::{Lanes, MOST};
use super::lists::IndexLists;
use super::tally::Tally;
use std::marker::PhantomData;

/// The law of an element of an elastic model, for as many elements with the same number of corners as there are lanes.
///
/// The forces on the corners are computed in up to three parts: what an element knows from all its corners
/// ([`whole`](Self::whole)), iterations on that ([`refine`](Self::refine)), and the force on each corner
/// ([`force`](Self::force)). Between the parts come other elements, whose operations the processor overlaps.
///
/// Functions are `#[inline(always)]`, and call no other functions and no closures with lanes that are not: only so are they
/// compiled for each vector set. A model that is a law returns itself from
/// [`ElasticModel::vectorised`](super::model::ElasticModel::vectorised), and [`ByLaw`] from
/// [`ElasticModel::prepare`](super::model::ElasticModel::prepare).
///
/// A law is about full elements of one stiffness. Where elements are [filled in part](super::body::Body::fill) or
/// [differ in stiffness](super::body::Body::stiffness), forces, energies and the residual are multiplied outside of it by the relative
/// stiffness, the product of the two, unless the law has [its own](Self::relative_stiffness). Elements of its own, such as springs, have
/// the mean relative stiffness of the body's elements that hold all their nodes.
///
/// # Example
/// A complete model: a rod with the energy `k/(8 L²) (|p|² − L²)²` between any two nodes of an element.
/// ```
#[doc = include_str!("../../tests/physics/example_model.rs")]
/// use glam::DVec3;
/// use localshape_sim::{Dimension, Integrator, Solids, State, Stepping, Surroundings, World};
///
/// let rest = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let elements: IndexLists = [&[0, 1, 2, 3][..]].into_iter().collect();
/// let start = State::at_rest(rest.iter().map(|&node| node * 1.1).collect());
/// let body = Arc::new(Body::builder(rest).elements(elements).build().expect("a body"));
/// let stepping = Stepping::new(Integrator::SemiImplicitEuler, 1e-3);
/// let mut world = World::new(&body, start, &Rods { stiffness: 100.0 }, Surroundings::default(), stepping);
/// let energy = world.diagnostics().elastic;
/// world.advance(1000);
/// assert!(world.diagnostics().energy < energy * 1.01);
/// ```
pub trait Law: Clone + Send + Sync + 'static {
    /// How many constants each element has.
    const OF_ELEMENT: usize = 0;
    /// How many constants each corner of an element has.
    const OF_CORNER: usize = 0;
    /// How many numbers each element remembers from one evaluation to the next. They are the memory of the model, element by
    /// element.
    const MEMORY: usize = 0;
    /// Whether elements have the residual whose greatest value is [reported](super::model::Report::residual).
    const HAS_RESIDUAL: bool = false;

    /// What the forces on the corners of an element have in common.
    type Whole<L: Lanes>: Copy;

    /// The nodes of each element, if it acts on others than the elements of the body.
    fn elements(&self, body: &Body) -> Option<IndexLists> {
        let _ = body;
        None
    }

    /// The relative stiffness of each element on which the law acts, as far as it is filled; `None` if all are 1.
    fn relative_stiffness(&self, body: &Body) -> Option<Vec<f64>> {
        match self.elements(body) {
            Some(own) => fill::parts(body, own.iter()),
            None => fill::of_elements(body),
        }
    }

    /// Whether forces depend on velocities.
    fn is_damped(&self) -> bool {
        false
    }

    /// Computes the constants from the corners at rest. Those of a corner follow on those of the corner before.
    #[inline(always)]
    fn prepare<L: Lanes>(&self, rest: &Corners<'_, L>, of_element: &mut [L], of_corner: &mut [L]) {
        let _ = (rest, of_element, of_corner);
    }

    /// `k` (N/m) and `D` (N s/m) of a force `−(k P + D V)` on each corner with position `P` and velocity `V`, which
    /// [`force`](Self::force) then leaves out: a node computes it once for all its elements.
    fn of_node(&self) -> [f64; 2] {
        [0.0; 2]
    }

    /// What follows from all corners.
    fn whole<L: Lanes>(&self, element: &Element<'_, L>) -> Self::Whole<L>;

    /// How often [`refine`](Self::refine) is called.
    fn passes(&self) -> u32 {
        0
    }

    /// One pass of an iteration, counted from 0.
    #[inline(always)]
    fn refine<L: Lanes>(&self, pass: u32, element: &Element<'_, L>, whole: &mut Self::Whole<L>) {
        let _ = (pass, element, whole);
    }

    /// The force on a corner (N).
    fn force<L: Lanes>(&self, element: &Element<'_, L>, corner: usize, whole: &Self::Whole<L>) -> [L; 3];

    /// Writes the share of each corner in the elastic energy (J), and returns the residual, zero without one.
    fn energy<L: Lanes>(&self, element: &Element<'_, L>, rest: &Corners<'_, L>, shares: &mut [L]) -> L;
}

/// Doubles in the record of a node: px, py, vx, vy, pz, vz, and two more. What the plane needs comes first.
pub(crate) const RECORD: usize = 8;

/// The corners of elements with the same number of corners, one element in each lane.
#[derive(Clone, Copy)]
pub struct Corners<'a, L> {
    records: *const f64,
    offsets: *const u32,
    count: usize,
    of: PhantomData<(&'a f64, L)>,
}

impl<L: Lanes> Corners<'_, L> {
    /// # Safety
    /// While this lives, there are records at the offsets of `count` corners, corner by corner, with [`MOST`] offsets from one to the
    /// next.
    #[inline(always)]
    pub(crate) unsafe fn new(records: *const f64, offsets: *const u32, count: usize) -> Self {
        Self { records, offsets, count, of: PhantomData }
    }

    #[inline(always)]
    fn record(&self, corner: usize, lane: usize) -> *const f64 {
        // SAFETY: the condition of `new`, and the test of its callers.
        unsafe { self.records.add(*self.offsets.add(corner * MOST + lane) as usize) }
    }

    #[inline(always)]
    fn columns(&self, corner: usize) -> [L; RECORD] {
        assert!(corner < self.count, "a corner");
        // SAFETY: the condition of `new`.
        unsafe { L::columns(|lane| self.record(corner, lane)) }
    }

    /// The number of corners of each element.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count
    }

    /// The position of a corner (m).
    #[inline(always)]
    pub fn position(&self, corner: usize) -> [L; 3] {
        let [x, y, _, _, z, ..] = self.columns(corner);
        [x, y, z]
    }

    /// The mass of the node at a corner of elements at rest (kg).
    #[inline(always)]
    pub(crate) fn mass(&self, corner: usize) -> L {
        self.columns(corner)[RECORD - 1]
    }

    /// The relative stiffness of elements at rest.
    #[inline(always)]
    pub(crate) fn part(&self) -> L {
        self.columns(0)[RECORD - 2]
    }
}

/// Elements that are evaluated, one in each lane.
#[derive(Clone, Copy)]
pub struct Element<'a, L> {
    pub(crate) corners: Corners<'a, L>,
    /// Of the corners, then of the element.
    constants: *const f64,
    memory: *mut f64,
    /// Constants of the element and of each corner, and remembered numbers.
    numbers: [usize; 3],
    /// Whether the memory is written.
    commit: bool,
    /// One bit for each lane with an element.
    live: u32,
    tally: Option<&'a Tally>,
}

/// The number of constants of an element with so many corners.
#[inline(always)]
pub(crate) fn constants<W: Law>(corners: usize) -> usize {
    corners * W::OF_CORNER + W::OF_ELEMENT
}

impl<'a, L: Lanes> Element<'a, L> {
    /// # Safety
    /// While this lives, there are the constants and remembered numbers of a law for [`MOST`] elements each, from these addresses on,
    /// and no other thread accesses the latter.
    #[inline(always)]
    pub(crate) unsafe fn new<W: Law>(
        corners: Corners<'a, L>,
        constants: *const f64,
        memory: *mut f64,
        commit: bool,
        live: u32,
        tally: Option<&'a Tally>,
    ) -> Self {
        let numbers = [W::OF_ELEMENT, W::OF_CORNER, W::MEMORY];
        Self { corners, constants, memory, numbers, commit, live, tally }
    }

    /// The number of corners of each element.
    #[inline(always)]
    pub fn corners(&self) -> usize {
        self.corners.count
    }

    /// The position (m) and the velocity (m/s) of a corner. In the plane the last coordinates are zero.
    #[inline(always)]
    pub fn corner(&self, corner: usize) -> ([L; 3], [L; 3]) {
        let [px, py, vx, vy, pz, vz, ..] = self.corners.columns(corner);
        ([px, py, pz], [vx, vy, vz])
    }

    /// The position and the velocity of a corner in the plane.
    #[inline(always)]
    pub(crate) fn corner_in_plane(&self, corner: usize) -> ([L; 2], [L; 2]) {
        assert!(corner < self.corners.count, "a corner");
        // SAFETY: the condition of `Corners::new`.
        let [px, py, vx, vy] = unsafe { L::columns_4(|lane| self.corners.record(corner, lane)) };
        ([px, py], [vx, vy])
    }

    /// A constant of the element.
    #[inline(always)]
    pub fn of_element(&self, at: usize) -> L {
        assert!(at < self.numbers[0], "a constant of an element");
        // SAFETY: the condition of `new`.
        unsafe { L::load(self.constants.add((self.corners.count * self.numbers[1] + at) * MOST)) }
    }

    /// A constant of a corner.
    #[inline(always)]
    pub fn of_corner(&self, corner: usize, at: usize) -> L {
        assert!(corner < self.corners.count && at < self.numbers[1], "a constant of a corner");
        // SAFETY: the condition of `new`.
        unsafe { L::load(self.constants.add((corner * self.numbers[1] + at) * MOST)) }
    }

    /// The numbers that the element remembers, from the first on.
    #[inline(always)]
    pub fn memory<const COUNT: usize>(&self) -> [L; COUNT] {
        self.memory_from(0)
    }

    /// Some of the numbers that the element remembers, from one on.
    #[inline(always)]
    pub(crate) fn memory_from<const COUNT: usize>(&self, first: usize) -> [L; COUNT] {
        assert!(first + COUNT <= self.numbers[2], "numbers that an element remembers");
        let mut numbers = [L::splat(0.0); COUNT];
        for (at, number) in numbers.iter_mut().enumerate() {
            // SAFETY: the condition of `new`.
            *number = unsafe { L::load(self.memory.add((first + at) * MOST)) };
        }
        numbers
    }

    /// Remembers numbers, from the first on, unless the evaluation is a trial.
    #[inline(always)]
    pub fn remember<const COUNT: usize>(&self, numbers: [L; COUNT]) {
        self.remember_from(0, numbers);
    }

    /// Remembers some of the numbers, from one on, unless the evaluation is a trial.
    #[inline(always)]
    pub(crate) fn remember_from<const COUNT: usize>(&self, first: usize, numbers: [L; COUNT]) {
        assert!(first + COUNT <= self.numbers[2], "numbers that an element remembers");
        if self.commit {
            for (at, number) in numbers.into_iter().enumerate() {
                // SAFETY: the condition of `new`.
                unsafe { number.store(self.memory.add((first + at) * MOST)) };
            }
        }
    }

    /// One bit for each lane with an element of its own, the lowest for the first.
    #[inline(always)]
    pub fn live(&self) -> u32 {
        self.live
    }

    /// Counts the rotations that need the global solver, if they are remembered.
    #[inline(always)]
    pub(crate) fn tally(&self) -> Option<&'a Tally> {
        if self.commit { self.tally } else { None }
    }
}
