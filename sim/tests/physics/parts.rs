//! Several bodies in one world.

use super::support::{Noise, floor, lattice, mass_spring, shape_based};
use glam::DVec3;
use localshape_sim::model::ElasticModel;
use localshape_sim::model::mass_spring::MassSpring;
use localshape_sim::model::shape_based::{RotationReading, ShapeBased};
use localshape_sim::{
    Assembly, Body, Crew, Divergence, Grip, Integrator, Kernel, Motion, Obstacle, Offset, Shape, Solids, Springs,
    State, Status, Stepping, Surroundings, World,
};
use std::sync::Arc;

const STIFFNESS: f64 = 1e4;

/// A body with its model, its start, and grips that number its own nodes.
struct Thing {
    body: Arc<Body>,
    model: Box<dyn ElasticModel>,
    start: State,
    grips: Vec<Grip>,
}

impl Thing {
    fn new(body: &Arc<Body>, model: impl ElasticModel + 'static, seed: u64) -> Self {
        let mut noise = Noise(seed);
        let shift = DVec3::new(0.3 * seed as f64, 0.02, 0.0);
        let position = body.rest().iter().map(|&at| at + shift + noise.vector() * 0.003).collect();
        let velocity = body.rest().iter().map(|_| DVec3::new(0.1, -2.0, 0.0) + noise.vector() * 0.1).collect();
        Self { body: Arc::clone(body), model: Box::new(model), start: State::new(position, velocity), grips: vec![] }
    }

    fn held(mut self, nodes: &[u32], from: f64, until: f64, motion: &Motion) -> Self {
        self.grips.push(Grip { nodes: nodes.to_vec(), from, until, motion: motion.clone() });
        self
    }
}

/// One world of things, in this order.
fn world(things: &[&Thing], obstacles: &[Obstacle], stepping: Stepping) -> World {
    let (mut start, mut grips) = (State::default(), Vec::new());
    for thing in things {
        let first = start.position.len() as u32;
        grips.extend(thing.grips.iter().map(|grip| {
            let nodes = grip.nodes.iter().map(|node| first + node).collect();
            Grip { nodes, ..grip.clone() }
        }));
        start.position.extend(&thing.start.position);
        start.velocity.extend(&thing.start.velocity);
    }
    let around =
        Surroundings { gravity: DVec3::Y * -9.8, obstacles: obstacles.to_vec(), grips, ..Surroundings::default() };
    let bodies: Vec<_> = things.iter().map(|thing| (Arc::clone(&thing.body), &*thing.model)).collect();
    World::of_parts(&bodies, start, around, stepping)
}

/// The states of worlds with one body each, as one state. The memory of the integrator is left out.
fn joined(worlds: &[World]) -> State {
    let mut all = State { steps: worlds[0].steps(), ..State::default() };
    for world in worlds {
        let State { position, velocity, memory, .. } = world.state();
        all.position.extend(position);
        all.velocity.extend(velocity);
        all.memory.model.extend(&memory.model);
        all.memory.constraints.extend(&memory.constraints);
    }
    all
}

fn without_integrator(world: &World) -> State {
    let mut state = world.state().clone();
    state.memory.integrator.clear();
    state
}

/// Cubes of which the first lacks a corner, which are no lattice.
fn notched(cells: u32) -> Arc<Body> {
    let whole = lattice(cells, 0.1);
    let elements = whole.elements().iter().enumerate().map(|(at, nodes)| &nodes[usize::from(at == 0)..]).collect();
    let mass = (0..whole.len()).map(|node| 0.7 + (node % 4) as f64 * 0.2).collect();
    Arc::new(
        Body::builder(whole.rest().to_vec())
            .elements(elements)
            .solids(Solids::Convex)
            .masses(mass)
            .build()
            .expect("a body"),
    )
}

/// Shape-based models on a lattice and on other elements, damped and not, and springs in families and others.
fn things(damping: f64) -> [Thing; 4] {
    let swing = Motion::Swing {
        period: 0.1,
        phase: 0.0,
        amplitude: Offset { shift: DVec3::new(0.02, 0.01, 0.0), rotation: DVec3::Z * 0.2 },
    };
    let (large, small, other) = (lattice(3, 0.1), lattice(2, 0.1), notched(2));
    let robust = ShapeBased { rotation: RotationReading::Robust, ..shape_based(STIFFNESS, damping) };
    let mut noise = Noise(3);
    let mut end = |first: f64| (first + 6.0 * noise.next().abs()) as u32;
    let listed: Vec<[u32; 2]> = (0..40).map(|_| [end(0.0), end(20.0)]).collect();
    let listed = MassSpring { stiffness: STIFFNESS, damping: 0.0, springs: listed.into(), breaks_at: None };
    [
        Thing::new(&large, robust, 1),
        Thing::new(&other, shape_based(STIFFNESS, 0.0), 2).held(&[3, 5], 0.0, 0.03, &swing),
        Thing::new(&small, mass_spring(&small, STIFFNESS, damping, Springs::EdgesFaceDiagonals), 3),
        Thing::new(&small, listed, 4).held(&[26, 0], 0.01, 0.02, &swing).held(&[7], 0.0251, f64::INFINITY, &swing),
    ]
}

/// A floor that stands still, alone and with one ball that moves and one that does not.
fn surroundings() -> [Vec<Obstacle>; 2] {
    let ball = |motion: Motion, x: f64| Obstacle {
        shape: Shape::Sphere { centre: DVec3::new(x, 0.1, 0.1), radius: 0.1 },
        motion,
        pivot: DVec3::new(x, 0.5, 0.0),
        ..floor(0.3, 0.4)
    };
    let amplitude = Offset { shift: DVec3::new(0.2, 0.0, 0.0), rotation: DVec3::Z * 0.3 };
    let swing = Motion::Swing { period: 0.2, phase: 0.25, amplitude };
    [vec![floor(0.5, 0.3)], vec![floor(0.5, 0.3), ball(swing, 0.7), ball(Motion::Still, 0.25)]]
}

/// Ways to step: the integrators with steps of their own find them for all bodies together.
const WAYS: [(Integrator, Kernel); 9] = [
    (Integrator::SemiImplicitEuler, Kernel::Fast),
    (Integrator::ExplicitEuler, Kernel::Fast),
    (Integrator::VelocityVerlet, Kernel::Fast),
    (Integrator::Pefrl, Kernel::Fast),
    (Integrator::SemiImplicitEuler, Kernel::Reference),
    (Integrator::ExplicitEuler, Kernel::Reference),
    (Integrator::VelocityVerlet, Kernel::Reference),
    (Integrator::Pefrl, Kernel::Reference),
    (Integrator::RungeKutta, Kernel::Reference),
];

fn stepping((integrator, kernel): (Integrator, Kernel)) -> Stepping {
    Stepping { kernel, ..Stepping::new(integrator, 1e-3) }
}

/// States, energies and what else is measured have the same bits, whatever other bodies there are.
#[test]
fn bodies_in_one_world_move_and_are_measured_like_each_alone() {
    for way in WAYS {
        for (damping, obstacles) in [0.0, 15.0].into_iter().flat_map(|damping| surroundings().map(|all| (damping, all)))
        {
            let (things, stepping) = (things(damping), stepping(way));
            let mut alone = things.each_ref().map(|thing| world(&[thing], &obstacles, stepping));
            let mut together = world(&things.each_ref(), &obstacles, stepping);
            let assembly = Assembly::new(things.iter().map(|thing| Arc::clone(&thing.body)).collect());
            for steps in [0, 5, 20, 75] {
                alone.iter_mut().for_each(|world| world.advance(steps));
                together.advance(steps);
                assert!(without_integrator(&together) == joined(&alone), "{way:?} {damping} {}", together.steps());
                let all = together.snapshot();
                for (part, alone) in alone.iter().enumerate() {
                    let (one, elements) = (alone.snapshot(), assembly.elements(part));
                    assert_eq!(one.placements, all.placements[part..=part]);
                    assert_eq!(one.turned_over, all.turned_over[elements.clone()]);
                    assert_eq!(one.flat, all.flat[elements]);
                    assert_eq!(format!("{:?}", one.diagnostics), format!("{:?}", all.of_bodies[part]), "{way:?}");
                    assert_eq!(alone.report(0), together.report(part), "{way:?}");
                }
            }
            assert_eq!(together.status(), Status::Ok, "{way:?}");
        }
    }
}

#[test]
fn the_order_of_bodies_changes_nothing_but_the_order() {
    for way in WAYS {
        let (things, [_, obstacles]) = (things(15.0), surroundings());
        let run = |order: [usize; 4]| {
            let mut world = world(&order.map(|at| &things[at]), &obstacles, stepping(way));
            world.advance(60);
            let state = world.state();
            let mut rest = (&state.position[..], &state.velocity[..]);
            let mut parts = order.map(|at| {
                let count = things[at].body.len();
                let (position, velocity) = (rest.0.split_at(count), rest.1.split_at(count));
                rest = (position.1, velocity.1);
                (at, position.0.to_vec(), velocity.0.to_vec())
            });
            parts.sort_by_key(|part| part.0);
            parts
        };
        let first = run([0, 1, 2, 3]);
        assert!(first == run([3, 1, 2, 0]) && first == run([2, 3, 0, 1]), "{way:?}");
    }
}

#[test]
fn several_bodies_go_on_from_what_was_written_with_the_same_bits() {
    for way in WAYS {
        let (things, [_, obstacles]) = (things(15.0), surroundings());
        let begin = || world(&things.each_ref(), &obstacles, stepping(way));
        let (mut whole, mut cut) = (begin(), begin());
        whole.advance(50);
        for steps in [1, 9, 1, 14, 25] {
            cut.advance(steps);
            let state = State::from_bytes(&cut.state().to_bytes()).expect("what was written");
            cut = begin();
            assert!(cut.takes(&state));
            cut.set_state(state);
        }
        assert!(cut.state().to_bytes() == whole.state().to_bytes(), "{way:?}");
    }
}

/// Bodies that are too small to be divided, so that threads share them, beside one that is divided.
#[test]
fn threads_change_no_bit_of_several_bodies() {
    let mut large = things(15.0).map(|thing| thing.body).to_vec();
    large.extend([lattice(13, 0.1), notched(5), lattice(6, 0.1)]);
    let model = |body: &Arc<Body>, at: usize| -> Box<dyn ElasticModel> {
        match at % 2 {
            0 => Box::new(ShapeBased { rotation: RotationReading::Robust, ..shape_based(STIFFNESS, 5.0) }),
            _ => Box::new(mass_spring(body, STIFFNESS, 5.0, Springs::EdgesOneDiagonal)),
        }
    };
    let things: Vec<Thing> = large
        .iter()
        .enumerate()
        .map(|(at, body)| Thing { model: model(body, at), ..Thing::new(body, shape_based(1.0, 0.0), at as u64) })
        .collect();
    let things: Vec<&Thing> = things.iter().collect();
    let [_, obstacles] = surroundings();
    for &way in &WAYS[..4] {
        let run = |threads: usize| {
            let mut world = world(&things, &obstacles, stepping(way));
            world.set_crew(Crew::new(threads));
            world.advance(40);
            world.state().clone()
        };
        let one = run(1);
        assert!(one == run(2) && one == run(3) && one == run(8), "{way:?}");
    }
}

/// The step in which a node of any body becomes too fast is taken by none of them.
#[test]
fn a_body_that_diverges_stops_all_at_the_step_before() {
    let body = lattice(2, 0.1);
    // At this step the first hardly moves, the second diverges in some steps, and the third at once.
    let calm = || Thing::new(&body, shape_based(0.01, 0.0), 1);
    let slow = || Thing::new(&body, shape_based(4e3, 0.0), 2);
    let quick = || Thing::new(&notched(2), shape_based(1e6, 0.0), 3);
    for (integrator, kernel) in WAYS {
        for (culprit, things) in [
            (1, vec![calm(), slow()]),
            (0, vec![slow(), calm(), calm()]),
            (2, vec![slow(), calm(), quick()]),
            (0, vec![quick(), calm(), slow()]),
            // Both in the same step.
            (1, vec![calm(), slow(), slow()]),
        ] {
            let stepping = Stepping { kernel, ..Stepping::new(integrator, 0.025) };
            let things: Vec<&Thing> = things.iter().collect();
            let mut together = world(&things, &[floor(0.5, 0.3)], stepping);
            together.advance(4000);
            let Status::Diverged(Divergence { step, part, time, .. }) = together.status() else {
                panic!("{integrator:?} {kernel:?} is stable")
            };
            assert_eq!((part, together.steps()), (culprit, 4000), "{integrator:?} {kernel:?}");
            assert_eq!(time, step as f64 * 0.025);
            let (node, limit) = together.runaway().expect("a divergence");
            let assembly = Assembly::new(things.iter().map(|thing| Arc::clone(&thing.body)).collect());
            assert!(assembly.nodes(part).contains(&node) && limit > 0.0);
            let mut alone: Vec<World> =
                things.iter().map(|thing| world(&[thing], &[floor(0.5, 0.3)], stepping)).collect();
            alone.iter_mut().for_each(|world| world.advance(step - 1));
            let before = joined(&alone);
            assert_eq!(together.state().position, before.position, "{integrator:?} {kernel:?}");
            assert_eq!(together.state().velocity, before.velocity, "{integrator:?} {kernel:?}");
            assert_eq!(together.state().memory.model, before.memory.model, "{integrator:?} {kernel:?}");
            // However the steps are divided.
            let mut one_by_one = world(&things, &[floor(0.5, 0.3)], stepping);
            (0..step + 3).for_each(|_| one_by_one.advance(1));
            assert_eq!(one_by_one.status(), together.status());
            assert_eq!(one_by_one.state().position, together.state().position);
        }
    }
}

/// With one model that has no vectorised steps, all bodies take those of the reference code.
#[test]
fn one_body_without_a_kernel_leaves_all_to_the_reference() {
    let body = lattice(2, 0.1);
    let shape = shape_based(STIFFNESS, 10.0);
    let plain = ShapeBased { rotation: RotationReading::VectorLength, ..shape.clone() };
    let things = [Thing::new(&body, shape, 1), Thing::new(&body, plain, 2)];
    let [fast, reference] = [Kernel::Fast, Kernel::Reference].map(|kernel| {
        let mut world = world(&things.each_ref(), &[], stepping((Integrator::VelocityVerlet, kernel)));
        world.advance(50);
        world.state().clone()
    });
    assert_eq!(fast, reference);
}
