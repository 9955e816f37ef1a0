//! Kernels for any elements and springs, compared with the reference and with each other.

use super::general::{Constants, General};
use super::springs::Stencil;
use super::stepper::{Scheme, Stepper, Way};
use super::{Around, Rotation};
use crate::sim::body::{Body, Dimension, IndexLists, Solids};
use crate::sim::contact::{Bound, Obstacle, Shape};
use crate::sim::crew::Crew;
use crate::sim::dynamics::Runaway;
use crate::sim::grip::Grip;
use crate::sim::integrate::Integrator;
use crate::sim::lanes::Set;
use crate::sim::model::ElasticModel;
use crate::sim::model::mass_spring::MassSpring;
use crate::sim::model::shape_based::{DampingReading, RotationReading, ShapeBased};
use crate::sim::motion::{Ease, Key, Motion, Offset};
use crate::sim::rotation::{best, davenport1968, moment, planar};
use crate::sim::state::State;
use crate::sim::topology::Springs;
use crate::sim::world::{Kernel, Stepping, Surroundings, World};
use glam::{DMat3, DQuat, DVec2, DVec3};
use std::sync::Arc;

const STIFFNESS: f64 = 1e4;
const STEP: f64 = 2e-4;
const GRAVITY: DVec3 = DVec3::new(0.3, -9.8, 0.0);
/// Steps in which a run differs from the reference by round-off only.
const STEPS: u64 = 1000;

/// Pseudo-random numbers from −1 to 1.
pub(super) struct Random(pub(super) u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn below(&mut self, count: usize) -> usize {
        ((0.5 * self.next() + 0.5) * count as f64) as usize
    }

    pub(super) fn vector(&mut self, dimension: Dimension) -> DVec3 {
        let [x, y, z] = [self.next(), self.next(), self.next()];
        DVec3::new(x, y, if dimension == Dimension::Plane { 0.0 } else { z })
    }
}

/// The nodes of a block of cells with a side of 0.1 m, each moved by up to a fraction of that, and the corners of each
/// cell: x fastest, or in the plane counter-clockwise.
fn block(cells: [u32; 3], irregular: f64, random: &mut Random) -> (Dimension, Vec<DVec3>, Vec<Vec<u32>>) {
    let [nx, ny, nz] = cells;
    let dimension = if nz == 0 { Dimension::Plane } else { Dimension::Space };
    let at = |x: u32, y: u32, z: u32| x + (nx + 1) * (y + (ny + 1) * z);
    let places = (0..=nz).flat_map(|z| (0..=ny).flat_map(move |y| (0..=nx).map(move |x| [x, y, z])));
    let rest = places
        .map(|place| (DVec3::from_array(place.map(f64::from)) + random.vector(dimension) * irregular) * 0.1)
        .collect();
    let places = (0..nz.max(1)).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
    let corners = places.map(|[x, y, z]| match dimension {
        Dimension::Plane => vec![at(x, y, 0), at(x + 1, y, 0), at(x + 1, y + 1, 0), at(x, y + 1, 0)],
        Dimension::Space => (0..8).map(|bits| at(x + (bits & 1), y + (bits >> 1 & 1), z + (bits >> 2))).collect(),
    });
    (dimension, rest, corners.collect())
}

/// A body with unequal masses.
fn body(dimension: Dimension, rest: Vec<DVec3>, elements: IndexLists, random: &mut Random) -> Arc<Body> {
    let mass = rest.iter().map(|_| 1.0 + 0.5 * random.next()).collect();
    Arc::new(Body::new(dimension, rest, mass, elements, Solids::Convex, None))
}

/// A block of whole cells.
pub(super) fn whole(cells: [u32; 3], irregular: f64, seed: u64) -> Arc<Body> {
    let random = &mut Random(seed);
    let (dimension, rest, corners) = block(cells, irregular, random);
    body(dimension, rest, corners.iter().map(|corners| &corners[..]).collect(), random)
}

/// As many elements as a block has cells, each with some of the corners of a cell; some nodes may belong to no element.
pub(super) fn pieces(cells: [u32; 3], counts: &[usize], seed: u64) -> Arc<Body> {
    let random = &mut Random(seed);
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

/// Rotated, stretched and moving.
pub(super) fn start(body: &Body, seed: u64) -> State {
    let random = &mut Random(seed);
    let turn = match body.dimension {
        Dimension::Plane => DMat3::from_cols_array(&[0.8, 0.6, 0.0, -0.6, 0.8, 0.0, 0.0, 0.0, 1.0]),
        Dimension::Space => DMat3::from_quat(DQuat::from_xyzw(0.1, -0.3, 0.2, 0.9).normalize()),
    };
    let position = body.rest.iter().map(|&rest| {
        turn * (rest * DVec3::new(1.1, 0.95, 1.05)) + random.vector(body.dimension) * 0.005 + DVec3::new(0.1, 0.5, 0.0)
    });
    let position = position.collect();
    let velocity = body.rest.iter().map(|_| random.vector(body.dimension) * 0.1).collect();
    State::new(position, velocity)
}

/// The rotations of the elements at a state, with which the reference starts as well.
pub(super) fn rotations(body: &Body, state: &State) -> Vec<f64> {
    let mut memory = Vec::new();
    for nodes in body.elements.iter() {
        let relative = |places: &[DVec3]| -> Vec<DVec3> {
            let mean = nodes.iter().map(|&node| places[node as usize]).sum::<DVec3>() / nodes.len() as f64;
            nodes.iter().map(|&node| places[node as usize] - mean).collect()
        };
        let a = moment(&relative(&body.rest), relative(&state.position));
        match body.dimension {
            Dimension::Plane => memory.extend(planar::solve(a, DVec2::X).to_array()),
            Dimension::Space => memory.extend(davenport1968::optimum(a, DQuat::IDENTITY).to_array()),
        }
    }
    memory
}

/// No obstacles and no speed limit.
const FREE: Around<'_> = Around {
    bounds: &[],
    row: &|_| 0..0,
    resolve: &|_, _, _, _| {},
    floor: None,
    grips: None,
    speed_limit: &|_| f64::MAX,
};

fn constants(damping: f64) -> Constants {
    Constants { stiffness: STIFFNESS, damping, gravity: GRAVITY, step: STEP }
}

/// A state with the rotations.
type Whole = (State, Vec<f64>);

/// A kernel advancing from a state, with its threads.
struct Moving(Way, Crew);

impl Moving {
    fn new(kernel: impl Stepper + 'static, start: &Whole, scheme: Scheme, threads: usize) -> Self {
        let mut way = Way::new(Box::new(kernel), scheme);
        way.load(0, &start.0.position, &start.0.velocity, &start.1);
        Self(way, Crew::new(threads))
    }

    fn advance(&mut self, steps: u64, around: Around<'_>) -> Result<(), Runaway> {
        self.0.advance(self.0.steps() + steps, &around, &mut self.1)
    }

    fn stored(&mut self, like: &Whole) -> Whole {
        let (mut state, mut memory) = like.clone();
        self.0.stepper.store(&mut state.position, &mut state.velocity, &mut memory);
        (state, memory)
    }
}

fn general(body: &Body, start: &Whole, rotation: Rotation, damping: f64, scheme: Scheme, set: Set) -> Moving {
    Moving::new(General::new(body, rotation, constants(damping), set), start, scheme, 1)
}

pub(super) fn shape_based(rotation: Rotation, damping: f64) -> ShapeBased {
    let (rotation, passes) = match rotation {
        Rotation::Arctangent { passes } => (RotationReading::Arctangent, passes),
        Rotation::Optimum => (RotationReading::Exact, 1),
    };
    ShapeBased { stiffness: STIFFNESS, damping, passes, rotation, damping_of: DampingReading::RelativeMotion }
}

fn reference(
    body: &Arc<Body>,
    start: &State,
    model: &dyn ElasticModel,
    scheme: Scheme,
    obstacles: Vec<Obstacle>,
) -> World {
    let integrator = match scheme {
        Scheme::SemiImplicitEuler => Integrator::SemiImplicitEuler,
        Scheme::ExplicitEuler => Integrator::ExplicitEuler,
        Scheme::VelocityVerlet => Integrator::VelocityVerlet,
    };
    let surroundings = Surroundings { gravity: GRAVITY, obstacles, grips: Vec::new() };
    World::new(body, start.clone(), model, surroundings, Stepping { integrator, step: STEP, kernel: Kernel::Reference })
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

/// Steps a body with the lanes of every set, which must agree bit for bit, and with the reference.
fn compare(name: &str, body: &Arc<Body>, start: State, rotation: Rotation, damping: f64, scheme: Scheme) {
    let memory = rotations(body, &start);
    let start = (start, memory);
    let mut found: Option<Whole> = None;
    for set in Set::all() {
        let mut kernel = general(body, &start, rotation, damping, scheme, set);
        // The result does not depend on how steps are divided into calls.
        for steps in [1, 7, 100, STEPS - 108] {
            assert_eq!(kernel.advance(steps, FREE), Ok(()), "{name}");
        }
        let here = kernel.stored(&start);
        assert!(found.as_ref().is_none_or(|found| *found == here), "{name}: {set:?} has other bits");
        found = Some(here);
    }
    let model = shape_based(rotation, damping);
    let mut world = reference(body, &start.0, &model, scheme, Vec::new());
    world.advance(STEPS);
    let far = distance(&found.expect("some set").0, world.state());
    assert!(far <= 1e-12, "{name}, {rotation:?}, D = {damping}, {scheme:?}: {far:e}");
}

pub(super) const TWICE: Rotation = Rotation::Arctangent { passes: 2 };
const SEMI: Scheme = Scheme::SemiImplicitEuler;

#[test]
fn any_elements_step_like_the_reference() {
    for (name, body) in [
        ("one hexahedron", whole([1, 1, 1], 0.2, 1)),
        ("a bar", whole([9, 1, 1], 0.2, 2)),
        ("a block", whole([3, 4, 2], 0.2, 3)),
        ("tetrahedra", pieces([3, 3, 3], &[4], 4)),
        ("one tetrahedron", pieces([1, 1, 1], &[4], 5)),
        ("anything", pieces([4, 3, 5], &[4, 5, 6, 7, 8], 6)),
        ("anything flat", pieces([4, 5, 0], &[3, 4], 7)),
        ("one triangle", pieces([1, 1, 0], &[3], 8)),
        ("squares", whole([9, 1, 0], 0.1, 9)),
    ] {
        for rotation in [TWICE, Rotation::Optimum] {
            for damping in [0.0, 10.0] {
                compare(name, &body, start(&body, 1), rotation, damping, Scheme::SemiImplicitEuler);
            }
        }
    }
}

#[test]
fn any_scheme_steps_like_the_reference() {
    for (name, body) in [("anything", pieces([3, 2, 3], &[4, 5, 6, 8], 6)), ("flat", pieces([4, 3, 0], &[3, 4], 7))] {
        for scheme in [Scheme::ExplicitEuler, Scheme::VelocityVerlet] {
            for damping in [0.0, 10.0] {
                compare(name, &body, start(&body, 2), TWICE, damping, scheme);
            }
        }
    }
}

/// Several parts that share nodes, and blocks that are not full.
#[test]
fn a_body_of_several_parts_steps_like_the_reference() {
    let body = pieces([23, 17, 19], &[4, 6, 8], 11);
    let start = start(&body, 3);
    let start = (start.clone(), rotations(&body, &start));
    let mut world = reference(&body, &start.0, &shape_based(TWICE, 10.0), Scheme::SemiImplicitEuler, Vec::new());
    world.advance(50);
    let mut found: Option<Whole> = None;
    for (set, threads) in Set::all().skip(1).flat_map(|set| [1, 2, 3].map(|threads| (set, threads))) {
        let mut kernel = general(&body, &start, TWICE, 10.0, SEMI, set);
        kernel.1 = Crew::new(threads);
        assert_eq!(kernel.advance(50, FREE), Ok(()));
        let here = kernel.stored(&start);
        assert!(found.as_ref().is_none_or(|found| *found == here), "{set:?} on {threads} threads has other bits");
        found = Some(here);
    }
    let far = distance(&found.expect("some set").0, world.state());
    assert!(far <= 1e-12, "{far:e}");
}

/// Elements turned inside out, flattened or collapsed to a point, in single lanes among others.
#[test]
fn elements_without_a_guide_step_like_the_reference() {
    let body = whole([3, 2, 2], 0.1, 12);
    for (name, element, crush) in [
        ("inside out", 5, DVec3::new(1.0, 1.0, -1.0)),
        ("flat", 7, DVec3::new(1.0, 1.0, 0.0)),
        ("a line", 2, DVec3::new(0.0, 1.0, 0.0)),
        ("a point", 11, DVec3::ZERO),
    ] {
        let mut start = State::at_rest(body.rest.clone());
        let middle = body.elements[element].iter().map(|&node| body.rest[node as usize]).sum::<DVec3>() / 8.0;
        for &node in &body.elements[element] {
            let place = &mut start.position[node as usize];
            *place = middle + (*place - middle) * crush;
        }
        let memory = rotations(&body, &start);
        let start = (start, memory);
        let model = shape_based(Rotation::Optimum, 10.0);
        let mut world = reference(&body, &start.0, &model, Scheme::SemiImplicitEuler, Vec::new());
        world.advance(20);
        for set in Set::all() {
            let mut kernel = general(&body, &start, Rotation::Optimum, 10.0, SEMI, set);
            assert_eq!(kernel.advance(20, FREE), Ok(()), "{name}");
            let far = distance(&kernel.stored(&start).0, world.state());
            assert!(far <= 1e-12, "{name}: {far:e}");
        }
    }
    // In the plane all angles are equally good for a triangle at a point: the last one is kept.
    let body = pieces([1, 1, 0], &[3], 13);
    let start = (State::at_rest(vec![DVec3::ZERO; body.len()]), vec![0.6, 0.8]);
    for set in Set::all() {
        let mut kernel = general(&body, &start, TWICE, 0.0, SEMI, set);
        assert_eq!(kernel.advance(1, FREE), Ok(()));
        assert_eq!(kernel.stored(&start).1, [0.6, 0.8]);
    }
    assert_eq!(best(Dimension::Plane, DMat3::ZERO), DMat3::IDENTITY);
}

#[test]
fn nodes_rebound_as_in_the_reference() {
    let body = pieces([4, 3, 4], &[4, 8], 14);
    let mut start = start(&body, 4);
    start.velocity.iter_mut().for_each(|velocity| velocity.y -= 3.0);
    let start = (start.clone(), rotations(&body, &start));
    let floor = Obstacle {
        shape: Shape::Floor { normal: DVec3::Y, height: 0.45 },
        motion: Motion::Still,
        pivot: DVec3::ZERO,
        restitution: 0.5,
        friction: 0.3,
    };
    for scheme in [Scheme::SemiImplicitEuler, Scheme::VelocityVerlet] {
        let model = shape_based(TWICE, 10.0);
        let mut world = reference(&body, &start.0, &model, scheme, vec![floor.clone()]);
        world.advance(300);
        let resolve = |_: u64, position: &mut DVec3, velocity: &mut DVec3, acceleration: DVec3| {
            floor.at(STEP, STEP).rebound(position, velocity, acceleration);
        };
        for bound in [
            Bound::HalfSpace { normal: DVec3::Y, height: 0.46 },
            Bound::Box { low: DVec3::splat(-9.0), high: DVec3::new(9.0, 0.47, 9.0) },
        ] {
            for set in Set::all() {
                let mut kernel = general(&body, &start, TWICE, 10.0, scheme, set);
                let around = Around { bounds: &[bound], row: &|_| 0..1, resolve: &resolve, ..FREE };
                assert_eq!(kernel.advance(300, around), Ok(()));
                let far = distance(&kernel.stored(&start).0, world.state());
                assert!(far <= 1e-12, "{scheme:?}: {far:e}");
            }
        }
    }
}

/// The step in which a node becomes too fast is rejected and those before are kept, for any division into calls.
#[test]
fn a_runaway_leaves_the_state_before_its_step() {
    let body = pieces([4, 3, 4], &[4, 8], 15);
    let start = start(&body, 5);
    let start = (start.clone(), rotations(&body, &start));
    for scheme in [Scheme::SemiImplicitEuler, Scheme::VelocityVerlet] {
        for damping in [0.0, 10.0] {
            let make = || general(&body, &start, TWICE, damping, scheme, Set::best());
            let mut one_by_one = make();
            // It falls, and becomes too fast at some time.
            let limit = 8.0;
            let around = Around { speed_limit: &|_| limit, ..FREE };
            let taken = (0..10_000).take_while(|_| one_by_one.advance(1, around).is_ok()).count() as u64;
            assert!(taken > 40 && taken < 9_999, "{taken}");
            let mut at_once = make();
            let runaway = at_once.advance(10_000, around).expect_err("it falls");
            assert_eq!(at_once.0.steps(), taken);
            assert_eq!(at_once.stored(&start), one_by_one.stored(&start));
            // Without a limit the same node is the first to exceed it.
            let mut free = make();
            assert_eq!(free.advance(taken + 1, FREE), Ok(()));
            let speeds = free.stored(&start).0.velocity;
            assert_eq!(
                speeds.iter().position(|speed| speed.length() > limit),
                Some(runaway.node),
                "{scheme:?} {damping}"
            );
        }
    }
    let mut kernel = general(&body, &start, TWICE, 0.0, SEMI, Set::best());
    kernel.0.stepper.set_node(7, DVec3::NAN, DVec3::ZERO);
    assert!(kernel.advance(5, FREE).is_err() && kernel.0.steps() == 0);
}

/// The kernel for families of springs, if there are families, and the general one.
fn assert_springs_step_like_the_reference(body: &Arc<Body>, springs: &[[u32; 2]], damping: f64, families: bool) {
    let start = start(body, 6);
    let model = MassSpring { stiffness: STIFFNESS, damping, springs: springs.into() };
    for scheme in [Scheme::SemiImplicitEuler, Scheme::ExplicitEuler, Scheme::VelocityVerlet] {
        let mut world = reference(body, &start, &model, scheme, Vec::new());
        world.advance(STEPS);
        let (mut by_families, mut gathered): (Option<State>, Option<State>) = (None, None);
        for set in Set::all() {
            let same = |found: &mut Option<State>, here: State| {
                assert!(found.as_ref().is_none_or(|found| *found == here), "{set:?} has other bits");
                let far = distance(&here, world.state());
                assert!(far <= 1e-12, "{} springs, {scheme:?}, {set:?}: {far:e}", springs.len());
                *found = Some(here);
            };
            let stencil = Stencil::new(springs, &body.rest, &body.mass, constants(damping), set);
            assert_eq!(stencil.is_some(), families, "{} springs", springs.len());
            let whole = (start.clone(), Vec::new());
            let run = |kernel: Moving| {
                let mut kernel = kernel;
                assert_eq!(kernel.advance(STEPS, FREE), Ok(()));
                kernel.stored(&whole).0
            };
            if let Some(stencil) = stencil {
                same(&mut by_families, run(Moving::new(stencil, &whole, scheme, 1)));
            }
            let kernel = General::springs(body, springs, constants(damping), set);
            same(&mut gathered, run(Moving::new(kernel, &whole, scheme, 1)));
        }
    }
}

#[test]
fn springs_step_like_the_reference() {
    for damping in [0.0, 10.0] {
        for cells in [[3, 4, 2], [1, 1, 1], [7, 1, 3], [9, 5, 0]] {
            let body = whole(cells, 0.1, 16);
            for named in [Springs::Edges, Springs::EdgesOneDiagonal, Springs::All] {
                assert_springs_step_like_the_reference(&body, &body.topology().springs(named), damping, true);
            }
        }
        // All lengths equal; and one spring twice.
        let body = whole([4, 4, 4], 0.0, 17);
        let mut springs = body.topology().springs(Springs::EdgesFaceDiagonals);
        springs.push([springs[0][1], springs[0][0]]);
        assert_springs_step_like_the_reference(&body, &springs, damping, true);
        assert_springs_step_like_the_reference(&body, &[[9, 4]], damping, true);
        let random = &mut Random(18);
        let springs: Vec<[u32; 2]> = (0..90).map(|_| [random.below(62) as u32, 62 + random.below(62) as u32]).collect();
        assert_springs_step_like_the_reference(&body, &springs, damping, false);
    }
}

#[test]
fn a_spring_between_coincident_nodes_does_nothing() {
    let body = whole([4, 1, 1], 0.0, 19);
    let springs = body.topology().springs(Springs::Edges);
    let start = State::at_rest(vec![DVec3::ONE; body.len()]);
    for set in Set::all() {
        let free = Constants { gravity: DVec3::ZERO, ..constants(10.0) };
        let start = (start.clone(), Vec::new());
        let stencil = Stencil::new(&springs, &body.rest, &body.mass, free, set).expect("a lattice");
        let kernel = General::springs(&body, &springs, free, set);
        for mut kernel in [Moving::new(stencil, &start, SEMI, 1), Moving::new(kernel, &start, SEMI, 1)] {
            assert_eq!(kernel.advance(9, FREE), Ok(()));
            assert_eq!(kernel.stored(&start), start);
        }
    }
}

/// Slabs, each with nodes that are moved after all others.
#[test]
fn springs_in_several_slabs_step_like_the_reference() {
    let body = whole([19, 19, 23], 0.1, 20);
    let springs = body.topology().springs(Springs::EdgesOneDiagonal);
    let start = start(&body, 7);
    let model = MassSpring { stiffness: STIFFNESS, damping: 10.0, springs: springs[..].into() };
    let mut world = reference(&body, &start, &model, Scheme::SemiImplicitEuler, Vec::new());
    world.advance(50);
    let mut found: Option<State> = None;
    for (set, threads) in Set::all().skip(1).flat_map(|set| [1, 2, 3].map(|threads| (set, threads))) {
        let stencil = Stencil::new(&springs, &body.rest, &body.mass, constants(10.0), set).expect("a lattice");
        let whole = (start.clone(), Vec::new());
        let mut kernel = Moving::new(stencil, &whole, SEMI, threads);
        assert_eq!(kernel.advance(50, FREE), Ok(()));
        let end = kernel.stored(&whole).0;
        assert!(found.as_ref().is_none_or(|found| *found == end), "{set:?} on {threads} threads has other bits");
        found = Some(end);
    }
    let far = distance(&found.expect("some set"), world.state());
    assert!(far <= 1e-12, "{far:e}");
}

/// Grips that become active and inactive, and moving obstacles, with every scheme and kernel: a lattice, any elements,
/// springs in families and others.
#[test]
fn what_holds_and_moves_is_that_of_the_reference() {
    let offset = |x: f64, turn: f64| Offset { shift: DVec3::new(x, 0.02, 0.0), rotation: DVec3::Z * turn };
    let keys = [(0.0, 0.0, 0.0), (0.1, 0.03, 0.2), (0.15, 0.01, 0.1)];
    let keys = keys.map(|(time, x, turn)| Key { time, offset: offset(x, turn) }).to_vec();
    let dragging = Motion::Keys { keys, ease: Ease::Smooth, repeat: false };
    let grip = |nodes: &[u32], from: f64, until: f64, motion: &Motion| Grip {
        nodes: nodes.to_vec(),
        from,
        until,
        motion: motion.clone(),
    };
    let still = Motion::Still;
    let grips = vec![
        grip(&[0, 3], 0.0, f64::INFINITY, &dragging),
        grip(&[17], 0.0101, 0.05, &still),
        grip(&[17, 11], 0.11, 0.12, &dragging),
    ];
    let some_time = vec![grip(&[5, 12], 0.02, 0.03, &dragging)];
    // It moves with the nodes and pushes: nothing rebounds, which would lose digits.
    let swing = Motion::Swing { period: 0.5, phase: 0.0, amplitude: offset(0.3, 0.4) };
    let paddle = Obstacle {
        shape: Shape::Sphere { centre: DVec3::new(-0.25, 0.7, 0.1), radius: 0.25 },
        motion: swing,
        pivot: DVec3::ZERO,
        restitution: 0.0,
        friction: 0.0,
    };
    let random = &mut Random(21);
    let (lattice, any) = (whole([4, 2, 3], 0.0, 22), pieces([3, 2, 2], &[4, 6, 8], 23));
    let listed: Vec<[u32; 2]> = (0..60).map(|_| [random.below(30) as u32, 30 + random.below(30) as u32]).collect();
    let named = lattice.topology().springs(Springs::EdgesFaceDiagonals);
    for damping in [0.0, 10.0] {
        let spring = |springs: &[[u32; 2]]| MassSpring { stiffness: STIFFNESS, damping, springs: springs.into() };
        let models: [(&Arc<Body>, Box<dyn ElasticModel>); 4] = [
            (&lattice, Box::new(shape_based(TWICE, damping))),
            (&any, Box::new(shape_based(Rotation::Optimum, damping))),
            (&lattice, Box::new(spring(&named))),
            (&lattice, Box::new(spring(&listed))),
        ];
        for (body, model) in models {
            for integrator in [Integrator::SemiImplicitEuler, Integrator::ExplicitEuler, Integrator::VelocityVerlet] {
                // Without damping its energy grows without bound.
                if integrator == Integrator::ExplicitEuler && damping == 0.0 {
                    continue;
                }
                for (grips, obstacles) in [(&grips, vec![]), (&some_time, vec![paddle.clone()])] {
                    let world = |kernel, obstacles: &[Obstacle]| {
                        let (obstacles, grips) = (obstacles.to_vec(), grips.clone());
                        let around = Surroundings { gravity: GRAVITY, obstacles, grips };
                        let stepping = Stepping { integrator, step: STEP, kernel };
                        World::new(body, start(body, 8), model.as_ref(), around, stepping)
                    };
                    let [mut fast, mut plain] =
                        [Kernel::Fast, Kernel::Reference].map(|kernel| world(kernel, &obstacles));
                    fast.advance(STEPS);
                    plain.advance(STEPS);
                    let far = distance(fast.state(), plain.state());
                    let name = format!("{integrator:?} {damping} {} {model:?}", obstacles.len());
                    // A rebound in velocity Verlet takes the square root of a difference.
                    assert!(far <= if obstacles.is_empty() { 1e-12 } else { 1e-11 }, "{far:e} {name}");
                    assert!(fast.state().memory.constraints.iter().any(|&gripped| gripped != 0.0));
                    let mut cut = world(Kernel::Fast, &obstacles);
                    for steps in [1, 49, 1, 33, 466, 1, STEPS - 551] {
                        cut.advance(steps);
                    }
                    assert!(cut.state() == fast.state(), "cut: {name}");
                    if !obstacles.is_empty() {
                        let mut free = world(Kernel::Fast, &[]);
                        free.advance(STEPS);
                        assert!(distance(fast.state(), free.state()) > 1e-3, "touched: {name}");
                    }
                }
            }
        }
    }
}
