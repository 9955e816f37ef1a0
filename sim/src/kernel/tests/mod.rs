//! Kernels for any elements and springs, compared with the reference and with each other.

mod elements;
mod energies;
mod parts;
mod springs;
mod surroundings;

use super::springs::Stencil;
use super::stepper::{PartStepper, Rollback, Scheme, Stepper};
use super::{Around, Conditions, Rotation};
use crate::body::Body;
use crate::contact::{Bound, Obstacle, Shape};
use crate::crew::Crew;
use crate::element::{Dimension, Solids};
use crate::grip::Grip;
use crate::integrate::{Integrator, composition};
use crate::lanes::Set;
use crate::lists::IndexLists;
use crate::model::ElasticModel;
use crate::model::mass_spring::MassSpring;
use crate::model::shape_based::{RotationReading, ShapeBased};
use crate::motion::{Ease, Key, Motion, Offset};
use crate::noise::Noise;
use crate::rotation::{best, davenport1968, moment, planar};
use crate::state::Runaway;
use crate::state::State;
use crate::surroundings::Surroundings;
use crate::topology::Springs;
use crate::world::{Kernel, Stepping, World};
use glam::{DMat3, DQuat, DVec2, DVec3};
use std::sync::Arc;

const STIFFNESS: f64 = 1e4;
const STEP: f64 = 2e-4;
const GRAVITY: DVec3 = DVec3::new(0.3, -9.8, 0.0);
/// Steps in which a run differs from the reference by round-off only.
const STEPS: u64 = 1000;

/// A vector with coordinates from −1 to 1, in the plane or in space.
fn vector(random: &mut Noise, dimension: Dimension) -> DVec3 {
    let vector = random.vector();
    if dimension == Dimension::Plane { vector.with_z(0.0) } else { vector }
}

/// The nodes of a block of cells with a side of 0.1 m, each moved by up to a fraction of that, and the corners of each
/// cell: x fastest, or in the plane counter-clockwise.
fn block(cells: [u32; 3], irregular: f64, random: &mut Noise) -> (Dimension, Vec<DVec3>, Vec<Vec<u32>>) {
    let [nx, ny, nz] = cells;
    let dimension = if nz == 0 { Dimension::Plane } else { Dimension::Space };
    let at = |x: u32, y: u32, z: u32| x + (nx + 1) * (y + (ny + 1) * z);
    let places = (0..=nz).flat_map(|z| (0..=ny).flat_map(move |y| (0..=nx).map(move |x| [x, y, z])));
    let rest = places
        .map(|place| (DVec3::from_array(place.map(f64::from)) + vector(random, dimension) * irregular) * 0.1)
        .collect();
    let places = (0..nz.max(1)).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
    let corners = places.map(|[x, y, z]| match dimension {
        Dimension::Plane => vec![at(x, y, 0), at(x + 1, y, 0), at(x + 1, y + 1, 0), at(x, y + 1, 0)],
        Dimension::Space => (0..8).map(|bits| at(x + (bits & 1), y + (bits >> 1 & 1), z + (bits >> 2))).collect(),
    });
    (dimension, rest, corners.collect())
}

/// A body with unequal masses.
fn body(dimension: Dimension, rest: Vec<DVec3>, elements: IndexLists, random: &mut Noise) -> Arc<Body> {
    let mass = rest.iter().map(|_| 1.0 + 0.5 * random.next()).collect();
    Arc::new(
        Body::builder(rest)
            .dimension(dimension)
            .elements(elements)
            .solids(Solids::Convex)
            .masses(mass)
            .build()
            .expect("a body"),
    )
}

/// A block of whole cells.
pub(super) fn whole(cells: [u32; 3], irregular: f64, seed: u64) -> Arc<Body> {
    let random = &mut Noise(seed);
    let (dimension, rest, corners) = block(cells, irregular, random);
    body(dimension, rest, corners.iter().map(|corners| &corners[..]).collect(), random)
}

/// As many elements as a block has cells, each with some of the corners of a cell; some nodes may belong to no element.
pub(super) fn pieces(cells: [u32; 3], counts: &[usize], seed: u64) -> Arc<Body> {
    let random = &mut Noise(seed);
    let (dimension, rest, corners) = block(cells, 0.2, random);
    let mut elements = IndexLists::default();
    for mut corners in corners {
        let count = counts[random.below(counts.len())];
        while corners.len() > count {
            corners.remove(random.below(corners.len()));
        }
        elements.push(&corners);
    }
    body(dimension, rest, elements, random)
}

/// The body with elements that are filled in part.
pub(super) fn filled(body: Arc<Body>) -> Arc<Body> {
    let random = &mut Noise(41);
    let fill = body.elements.iter().map(|_| [1.0, 0.9, 0.37, 0.2][random.below(4)]).collect();
    Arc::new(Body { fill: Some(fill), ..Body::clone(&body) })
}

/// The body with elements that differ in stiffness.
pub(super) fn stiffened(body: Arc<Body>) -> Arc<Body> {
    let random = &mut Noise(42);
    let stiffness = body.elements.iter().map(|_| [1.0, 1.7, 0.6, 0.3][random.below(4)]).collect();
    Arc::new(Body { stiffness: Some(stiffness), ..Body::clone(&body) })
}

/// Rotated, stretched and moving.
pub(super) fn start(body: &Body, seed: u64) -> State {
    let random = &mut Noise(seed);
    let turn = match body.dimension {
        Dimension::Plane => DMat3::from_cols_array(&[0.8, 0.6, 0.0, -0.6, 0.8, 0.0, 0.0, 0.0, 1.0]),
        Dimension::Space => DMat3::from_quat(DQuat::from_xyzw(0.1, -0.3, 0.2, 0.9).normalize()),
    };
    let position = body.rest.iter().map(|&rest| {
        turn * (rest * DVec3::new(1.1, 0.95, 1.05)) + vector(random, body.dimension) * 0.005 + DVec3::new(0.1, 0.5, 0.0)
    });
    let position = position.collect();
    let velocity = body.rest.iter().map(|_| vector(random, body.dimension) * 0.1).collect();
    State::new(position, velocity)
}

/// The places of the nodes of an element, relative to their mean.
fn centred(nodes: &[u32], places: &[DVec3]) -> Vec<DVec3> {
    let corners = nodes.iter().map(|&node| places[node as usize]);
    let mean = corners.clone().sum::<DVec3>() / nodes.len() as f64;
    corners.map(|corner| corner - mean).collect()
}

/// The rotations of the elements at a state, and in space the number of those that took the global solver: the memory with which the
/// reference starts as well.
fn rotations(body: &Body, state: &State) -> Vec<f64> {
    let mut memory = Vec::new();
    for nodes in body.elements.iter() {
        let a = moment(&centred(nodes, &body.rest), centred(nodes, &state.position));
        match body.dimension {
            Dimension::Plane => memory.extend(planar::solve(a, DVec2::X).to_array()),
            Dimension::Space => memory.extend(davenport1968::optimum(a, DQuat::IDENTITY).to_array()),
        }
    }
    memory.extend((body.dimension == Dimension::Space).then_some(0.0));
    memory
}

/// Gravity alone, and no speed limit.
pub(super) const FREE: Around<'_> = Around {
    mass_damping: 0.0,
    gravity: GRAVITY,
    forces: [&[]; 3],
    push: None,
    bounds: &[],
    row: &|_| 0..0,
    resolve: &|_, _, _, _, _| {},
    impulses: None,
    work: None,
    floor: None,
    apart: &[],
    grips: None,
    held: &[],
    meeting: None,
    speed_limit: &|_| f64::MAX,
};

fn conditions(scheme: Scheme, set: Set) -> Conditions {
    Conditions { scheme, step: STEP, set }
}

/// What a computation finds, with the same bits for the lanes of every one of some sets and for each number of threads.
pub(super) fn same<T: PartialEq>(
    sets: impl Iterator<Item = Set>,
    threads: &[usize],
    find: impl Fn(Set, usize) -> T,
) -> T {
    let mut found = None;
    for (set, &threads) in sets.flat_map(|set| threads.iter().map(move |threads| (set, threads))) {
        let here = find(set, threads);
        assert!(found.as_ref().is_none_or(|found| *found == here), "{set:?} on {threads} threads has other bits");
        found = Some(here);
    }
    found.expect("some set")
}

/// A state with the rotations.
pub(super) type Whole = (State, Vec<f64>);

/// A state with its rotations.
pub(super) fn with_rotations(body: &Body, state: State) -> Whole {
    let memory = rotations(body, &state);
    (state, memory)
}

/// A kernel advancing from a state, with its threads.
pub(super) struct Moving(pub(super) Rollback, Crew);

impl Moving {
    pub(super) fn new(stepper: Box<dyn Stepper>, start: &Whole, scheme: Scheme, threads: usize) -> Self {
        let (nodes, memory) = (0..start.0.position.len(), 0..start.1.len());
        let mut rollback = Rollback::new(vec![PartStepper { stepper, nodes, memory }], scheme);
        rollback.load(0, &start.0.position, &start.0.velocity, &start.1);
        Self(rollback, Crew::new(threads))
    }

    pub(super) fn advance(&mut self, steps: u64, around: Around<'_>) -> Result<(), Runaway> {
        self.0.advance(self.0.steps() + steps, &around, &self.1)
    }

    pub(super) fn stored(&mut self, like: &Whole) -> Whole {
        let (mut state, mut memory) = like.clone();
        self.0.store(&mut state.position, &mut state.velocity, &mut memory);
        (state, memory)
    }
}

/// A start from which the reference steps a body.
struct Case<'a> {
    body: &'a Arc<Body>,
    start: &'a Whole,
    model: &'a dyn ElasticModel,
    scheme: Scheme,
    steps: u64,
}

impl Case<'_> {
    /// Steps it by a kernel with the lanes of some sets on each number of threads, which must agree bit for bit, and with the reference.
    fn compare(
        &self,
        name: &str,
        sets: impl Iterator<Item = Set>,
        threads: &[usize],
        kernel: impl Fn(&Conditions) -> Box<dyn Stepper>,
    ) {
        let &Self { body, start, model, scheme, steps } = self;
        let (found, _) = same(sets, threads, |set, threads| {
            let mut kernel = Moving::new(kernel(&conditions(scheme, set)), start, scheme, threads);
            // The result does not depend on how steps are divided into calls.
            for steps in [1, steps / 9, steps / 3, steps - 1 - steps / 9 - steps / 3] {
                assert_eq!(kernel.advance(steps, FREE), Ok(()), "{name}");
            }
            kernel.stored(start)
        });
        let mut world = reference(body, &start.0, model, scheme, Vec::new());
        world.advance(steps);
        let far = distance(&found, world.state());
        assert!(far <= 1e-12, "{name}, {model:?}, {scheme:?}: {far:e}");
    }
}

fn general(body: &Arc<Body>, start: &Whole, rotation: Rotation, damping: f64, scheme: Scheme, set: Set) -> Moving {
    let compiled = shape_based(rotation, damping).by_law(body, &conditions(scheme, set), None);
    Moving::new(compiled.stepper, start, scheme, 1)
}

pub(super) fn shape_based(rotation: Rotation, damping: f64) -> ShapeBased {
    let (rotation, passes) = match rotation {
        Rotation::Arctangent { passes } => (RotationReading::Arctangent, passes),
        // In scalar code, which `rotation` tests against Davenport's method.
        Rotation::Optimum => (RotationReading::Robust, 1),
    };
    ShapeBased { damping, passes, rotation, ..ShapeBased::new(STIFFNESS) }
}

/// Springs that do not break.
fn mass_spring(springs: &[[u32; 2]], damping: f64) -> MassSpring {
    MassSpring { stiffness: STIFFNESS, damping, springs: springs.into(), breaks_at: None }
}

/// A simulation by the reference code.
pub(super) fn stepped_by_reference(
    body: &Arc<Body>,
    start: &State,
    model: &dyn ElasticModel,
    scheme: Scheme,
    around: Surroundings,
    step: f64,
) -> World {
    let integrator = match scheme {
        Scheme::SemiImplicitEuler => Integrator::SemiImplicitEuler,
        Scheme::ExplicitEuler => Integrator::ExplicitEuler,
        Scheme::VelocityVerlet => Integrator::VelocityVerlet,
        Scheme::Composition(_) => Integrator::Pefrl,
    };
    World::new(
        body,
        start.clone(),
        model,
        around,
        Stepping { kernel: Kernel::Reference, ..Stepping::new(integrator, step) },
    )
}

fn reference(
    body: &Arc<Body>,
    start: &State,
    model: &dyn ElasticModel,
    scheme: Scheme,
    obstacles: Vec<Obstacle>,
) -> World {
    let around = Surroundings { gravity: GRAVITY, obstacles, ..Surroundings::default() };
    stepped_by_reference(body, start, model, scheme, around, STEP)
}

/// An obstacle that stands still.
pub(super) fn obstacle(shape: Shape, restitution: f64, friction: f64) -> Obstacle {
    let (motion, pivot, friction_of) = (Motion::Still, DVec3::ZERO, Default::default());
    Obstacle { shape, motion, pivot, restitution, friction, friction_of }
}

/// The largest distance between two states, relative to their extent and to the speed of an oscillation over that
/// extent.
fn distance(a: &State, b: &State) -> f64 {
    let extent = b.position.iter().fold(0.0, |far: f64, p| far.max(p.length()));
    let frequency = STIFFNESS.sqrt();
    let largest = |a: &[DVec3], b: &[DVec3]| {
        a.iter().zip(b).fold(0.0, |far: f64, (a, b)| if a == b { far } else { far.max(a.distance(*b)) })
    };
    let distance = largest(&a.position, &b.position).max(largest(&a.velocity, &b.velocity) / frequency);
    assert!(distance.is_finite());
    distance / extent
}

pub(super) const TWICE: Rotation = Rotation::Arctangent { passes: 2 };
const SEMI: Scheme = Scheme::SemiImplicitEuler;
/// All schemes of kernels.
pub(super) const SCHEMES: [Scheme; 4] = [SEMI, Scheme::ExplicitEuler, Scheme::VelocityVerlet, PEFRL];
pub(super) const PEFRL: Scheme = Scheme::Composition(composition::PEFRL);
