//! States of rest: forces that balance, with every model; contact, loads that follow, and what has no rest.

use super::conformance::of_stiffness;
use super::support::{bricks, floor, lattice, shape_based, world};
use glam::DVec3;
use localshape_sim::model::{ElasticModel, linear, neo_hookean};
use localshape_sim::{
    Body, Contacts, Course, Crew, Equilibrium, Grip, Load, Loading, Material, Motion, NoEquilibrium, State,
    Surroundings, equilibrium,
};
use std::sync::Arc;

const GRAVITY: DVec3 = DVec3::new(0.0, -9.8, 0.0);

fn nodes(body: &Body, is_one: impl Fn(DVec3) -> bool) -> Vec<u32> {
    (0..body.len() as u32).filter(|&node| is_one(body.rest()[node as usize])).collect()
}

/// Nodes that do not move from a time (s) on.
fn held(nodes: Vec<u32>, from: f64) -> Grip {
    Grip { nodes, from, until: f64::INFINITY, motion: Motion::Still }
}

fn rest(
    body: &Arc<Body>,
    model: &dyn ElasticModel,
    around: &Surroundings,
    threads: usize,
) -> Result<Equilibrium, NoEquilibrium> {
    let start = State::at_rest(body.rest().to_vec());
    equilibrium(&[(Arc::clone(body), model)], &start, around, 1e-4, Crew::new(threads))
}

/// Every model hangs at rest: a world that starts there stays there. A model whose forces depend on its history is told.
#[test]
fn every_model_hangs_at_rest() {
    let body = bricks([2, 3, 2], DVec3::splat(0.1));
    let top = nodes(&body, |at| at.y > 0.29);
    let around = Surroundings { gravity: GRAVITY, grips: vec![held(top, 0.0)], ..Surroundings::default() };
    for (at, case) in of_stiffness(1e4, &body, 0.0).into_iter().enumerate() {
        let found = rest(&body, &*case.model, &around, 1);
        if !case.has_potential {
            // Its rotations depend on the way there.
            assert!(matches!(found, Err(NoEquilibrium::Unbalanced { .. })), "model {at}: {found:?}");
            continue;
        }
        let found = found.unwrap_or_else(|error| panic!("model {at}: {error}"));
        assert!(found.residual < 1e-8, "model {at}: {found:?}");
        let sunk = |position: &[DVec3]| body.rest().iter().zip(position).map(|(rest, now)| rest.y - now.y).sum::<f64>();
        assert!(sunk(&found.position) > 0.01, "model {at} hangs down");
        let start = State::at_rest(found.position.clone());
        let mut world = world(&body, start, &*case.model, 1e-4, around.clone());
        world.advance(200);
        let moved = world.state().position.iter().zip(&found.position).map(|(now, then)| now.distance(*then));
        // The body would have fallen by 2 mm.
        let most = moved.fold(0.0, f64::max);
        assert!(most < 1e-9, "model {at} moves by {most} m");
    }
}

/// A slender cantilever comes to rest about as soon as a compact one, though it bends by half its length.
#[test]
fn slender_bodies_bend_at_once() {
    for cells in [[64, 2, 2], [8, 6, 5]] {
        let body = bricks(cells, DVec3::splat(0.1));
        let model = neo_hookean::model(&body, Material { young: 4e5, poisson: 0.3 }, 0.0).expect("bricks");
        let around = Surroundings {
            gravity: GRAVITY * 0.02,
            grips: vec![held(nodes(&body, |at| at.x < 0.01), 0.0)],
            ..Surroundings::default()
        };
        let found = rest(&body, &*model, &around, 1).expect("a state of rest");
        assert!(found.residual < 1e-9, "{cells:?}: {}", found.residual);
        assert!(found.evaluations < 1500, "{cells:?}: {} evaluations", found.evaluations);
        if cells[0] == 64 {
            let sunk = found.position.iter().map(|at| -at.y).fold(0.0, f64::max);
            assert!((2.0..6.0).contains(&sunk), "the end sinks by {sunk} m of 6.4 m");
        }
    }
}

/// A bar that is pulled by `ω² m x` from its held end on is pulled apart at the latest where `ω > π/2 √(E/ρ)/L`: its balance is not stable, and
/// no state of rest.
#[test]
fn an_unstable_balance_is_no_rest() {
    let (side, young) = (0.1, 1e4);
    let body = bricks([8, 2, 2], DVec3::splat(side));
    let mut mass = vec![0.0; body.len()];
    body.elements().iter().flatten().for_each(|&node| mass[node as usize] += 0.125);
    let body = Body::builder(body.rest().to_vec()).elements(body.elements().clone()).masses(mass.clone());
    let body = Arc::new(body.build().expect("a bar"));
    let model = linear::model(&body, Material { young, poisson: 0.0 }, 0.0).expect("bricks");
    let largest = std::f64::consts::FRAC_PI_2 * (young * side.powi(3)).sqrt() / 0.8;
    for share in [0.8, 1.1] {
        let (mass, square) = (mass.clone(), (share * largest).powi(2));
        let pull = move |_: f64, position: &[DVec3], forces: &mut [DVec3]| {
            let pulls = position.iter().zip(&mass).map(|(at, mass)| DVec3::X * (mass * square * at.x));
            forces.iter_mut().zip(pulls).for_each(|(force, pull)| *force += pull);
        };
        let (grips, loads) = (vec![held(nodes(&body, |at| at.x < 0.01), 0.0)], vec![Arc::new(pull) as Arc<dyn Load>]);
        let around = Surroundings { grips, loads, ..Surroundings::default() };
        let found = rest(&body, &*model, &around, 1);
        if share < 1.0 {
            // `L tan(φ)/φ`, with `φ` the share of a quarter of a turn.
            let angle = share * std::f64::consts::FRAC_PI_2;
            let end = found.expect("a state of rest").position[8].x;
            assert!((end / (0.8 * angle.tan() / angle) - 1.0).abs() < 0.01, "{end} m");
        } else {
            assert!(matches!(found, Err(NoEquilibrium::Unbalanced { .. })), "{found:?}");
        }
    }
}

/// A bar under its own weight sinks by `ρ g L²/2E`; nodes of linear elements without contraction have the exact places.
#[test]
fn a_bar_hangs_by_the_closed_form() {
    const YOUNG: f64 = 1e6;
    let body = bricks([2, 8, 2], DVec3::new(0.1, 0.25, 0.1));
    // The mass of a cell goes to its corners in equal parts.
    let mut mass = vec![0.0; body.len()];
    body.elements().iter().flatten().for_each(|&node| mass[node as usize] += 0.25);
    let body =
        Body::builder(body.rest().to_vec()).elements(body.elements().clone()).masses(mass).build().expect("a bar");
    let body = Arc::new(body);
    let model = linear::model(&body, Material { young: YOUNG, poisson: 0.0 }, 0.0).expect("bricks");
    let top = nodes(&body, |at| at.y > 1.99);
    let around = Surroundings { gravity: GRAVITY, grips: vec![held(top, 0.0)], ..Surroundings::default() };
    let found = rest(&body, &*model, &around, 1).expect("a state of rest");
    let weight = 9.8 * 2.0 * 4.0 * 8.0;
    let expected = weight * 2.0 / (2.0 * YOUNG * 0.04);
    let sunk = -found.position[0].y;
    assert!((sunk / expected - 1.0).abs() < 1e-7, "{sunk} m in place of {expected} m");
}

/// Bodies that meet nothing come to rest as each does alone, however many they are.
#[test]
fn many_bodies_rest_as_each_does_alone() {
    const BODIES: u32 = 30;
    let body = bricks([9, 1, 1], DVec3::splat(0.1));
    let model = linear::model(&body, Material { young: 1e6, poisson: 0.3 }, 0.0).expect("bricks");
    let end = nodes(&body, |at| at.x < 0.01);
    let around = |bodies: u32| {
        let count = body.len() as u32;
        let held_nodes = (0..bodies).flat_map(|at| end.iter().map(move |node| at * count + node)).collect();
        Surroundings { gravity: GRAVITY, grips: vec![held(held_nodes, 0.0)], ..Surroundings::default() }
    };
    let alone = rest(&body, &*model, &around(1), 1).expect("a state of rest");
    let all: Vec<(_, &dyn ElasticModel)> = (0..BODIES).map(|_| (Arc::clone(&body), &*model)).collect();
    let start = State::at_rest(body.rest().repeat(BODIES as usize));
    let found = equilibrium(&all, &start, &around(BODIES), 1e-4, Crew::new(1)).expect("a state of rest");
    let apart = found.position.iter().zip(alone.position.iter().cycle()).map(|(one, other)| one.distance(*other));
    let most = apart.fold(0.0, f64::max);
    assert!(most < 1e-9, "{most} m");
}

/// Bits do not depend on the number of threads.
#[test]
fn rest_has_the_same_bits_on_any_number_of_threads() {
    let body = lattice(17, 0.05);
    let around = Surroundings {
        gravity: GRAVITY,
        grips: vec![held(nodes(&body, |at| at.x < 0.01), 0.0)],
        ..Surroundings::default()
    };
    let [one, two] = [1, 2].map(|threads| rest(&body, &shape_based(1e6, 0.0), &around, threads));
    assert_eq!(one.expect("a state of rest"), two.expect("a state of rest"));
}

/// Only what acts at the start counts: loads of later times, and grips that hold then, do not.
#[test]
fn only_what_acts_at_the_start_counts() {
    let body = bricks([1, 1, 4], DVec3::splat(0.1));
    let (end, start) = (nodes(&body, |at| at.z > 0.39), nodes(&body, |at| at.z < 0.01));
    let load = |force: f64, during| -> Arc<dyn Load> {
        let course = Course { during, ..Course::ALWAYS };
        Arc::new(Loading::dead(end.clone(), vec![DVec3::X * force; end.len()], course))
    };
    let plain = Surroundings {
        loads: vec![load(1.0, 0.0..1.0)],
        grips: vec![held(start.clone(), 0.0)],
        ..Surroundings::default()
    };
    let later = Surroundings {
        loads: vec![load(1.0, 0.0..1.0), load(50.0, 0.5..1.0)],
        grips: vec![held(start, 0.0), held(end.clone(), 0.1)],
        ..Surroundings::default()
    };
    let model = shape_based(1e4, 0.0);
    let [plain, later] = [plain, later].map(|around| rest(&body, &model, &around, 1).expect("a state of rest"));
    assert_eq!(plain.position, later.position);
    let moved = end.iter().map(|&node| plain.position[node as usize].x - body.rest()[node as usize].x);
    assert!(moved.fold(f64::INFINITY, f64::min) > 1e-3);
}

/// A pressure that follows the surface inflates a free body, which nothing has to hold.
#[test]
fn a_pressure_inflates_a_free_body() {
    let body = lattice(3, 0.1);
    let faces = body.faces();
    let outside = (0..faces.nodes.len()).filter(|&face| faces.outer[face].is_none());
    let outside: Vec<_> = outside.map(|face| faces.nodes[face].to_vec()).collect();
    let load: Arc<dyn Load> = Arc::new(Loading::pressure(outside, -1e3, Course::ALWAYS));
    let model = linear::model(&body, Material { young: 1e5, poisson: 0.3 }, 0.0).expect("bricks");
    let around = Surroundings { loads: vec![load], ..Surroundings::default() };
    let found = rest(&body, &*model, &around, 1).expect("a state of rest");
    // ε = p (1 − 2ν)/E, but for the growth of the faces.
    let [low, high] = [0, body.len() - 1].map(|node| found.position[node]);
    let strain = (high - low) / (body.rest()[body.len() - 1] - body.rest()[0]) - 1.0;
    assert!(strain.min_element() > 0.004 && strain.max_element() < 0.0041, "{strain}");
}

/// A stack lies on the ground: each body bears those above it, by nodes and by surfaces, and stays where it is.
#[test]
fn a_stack_lies_on_the_ground() {
    let body = lattice(2, 0.1);
    let model = shape_based(2e4, 0.0);
    let gap = 0.008;
    for contacts in [None, Some(Contacts { friction: 0.3, ..Contacts::default() })] {
        let count = if contacts.is_some() { 2 } else { 1 };
        let place = |at: usize| body.rest().iter().map(move |&rest| rest + DVec3::Y * (gap + at as f64 * (0.2 + gap)));
        let start = State::at_rest((0..count).flat_map(place).collect());
        let around =
            Surroundings { gravity: GRAVITY, obstacles: vec![floor(0.5, 0.3)], contacts, ..Surroundings::default() };
        let parts = vec![(Arc::clone(&body), &model as &dyn ElasticModel); count];
        let found = equilibrium(&parts, &start, &around, 1e-4, Crew::default()).expect("a state of rest");
        let bottom = |at: usize| {
            found.position[at * body.len()..(at + 1) * body.len()].iter().map(|at| at.y).fold(f64::INFINITY, f64::min)
        };
        assert!(bottom(0).abs() < 1e-3, "the lowest nodes are on the ground: {}", bottom(0));
        if count == 2 {
            assert!((0.15..0.2).contains(&bottom(1)), "the upper one is on the lower one: {}", bottom(1));
        }
        let enough = if count == 2 { 1e-2 } else { 1e-8 };
        assert!(found.residual < enough, "{found:?}");
    }
}

/// What has no state of rest is told, with the force that nothing holds; a body without loads is at rest.
#[test]
fn a_free_body_under_gravity_has_no_rest() {
    let body = lattice(2, 0.1);
    let model = shape_based(1e4, 0.0);
    let around = Surroundings { gravity: GRAVITY, ..Surroundings::default() };
    let weight = GRAVITY * body.len() as f64;
    match rest(&body, &model, &around, 1) {
        Err(NoEquilibrium::Unheld { body: 0, force }) => assert!(force.distance(weight) < 1e-9, "{force}"),
        other => panic!("{other:?}"),
    }
    let found = rest(&body, &model, &Surroundings::default(), 1).expect("at rest");
    assert_eq!(found.position.as_slice(), body.rest());
    // A torque that nothing holds turns it for ever.
    let all: Vec<u32> = (0..body.len() as u32).collect();
    let weights = vec![1.0 / body.len() as f64; body.len()];
    let load: Arc<dyn Load> = Arc::new(Loading::torque(all, weights, DVec3::Z, Course::ALWAYS));
    let turned = rest(&body, &model, &Surroundings { loads: vec![load], ..Surroundings::default() }, 1);
    assert!(matches!(turned, Err(NoEquilibrium::Unbalanced { .. })), "{turned:?}");
}
