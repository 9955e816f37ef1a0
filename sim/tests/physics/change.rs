//! Worlds whose surroundings and nodes change between steps, by the code of every kernel.

use super::INTEGRATORS;
use super::support::{floor, lattice, mass_spring, shape_based};
use glam::DVec3;
use localshape_sim::model::ElasticModel;
use localshape_sim::model::xpbd::Xpbd;
use localshape_sim::{
    Body, Course, Crew, Grip, Kernel, Load, Loading, Motion, Pose, Springs, State, Status, Stepping, Surroundings,
    World,
};
use std::sync::Arc;

const STEP: f64 = 1e-4;

/// A lattice and the same with its elements backwards, which has another kernel.
fn bodies() -> [Arc<Body>; 2] {
    let body = lattice(3, 0.1);
    let backwards = body.elements().iter().collect::<Vec<_>>().into_iter().rev().collect();
    let other = Body::builder(body.rest().to_vec()).elements(backwards).masses(body.mass().to_vec());
    [body, Arc::new(other.build().expect("a body"))]
}

fn models(body: &Body) -> [Arc<dyn ElasticModel>; 3] {
    let springs = mass_spring(body, 1e3, 0.0, Springs::All);
    [Arc::new(shape_based(1e3, 0.0)), Arc::new(springs), Arc::new(Xpbd::new(shape_based(1e3, 0.0)))]
}

/// Worlds of every model, integrator and kernel, at rest and free.
fn worlds() -> Vec<(String, World)> {
    let mut all = Vec::new();
    for body in bodies() {
        for model in models(&body) {
            for integrator in INTEGRATORS.into_iter().filter(|one| one.refusal(&*model, &body, 0.0).is_none()) {
                for kernel in [Kernel::Fast, Kernel::Reference] {
                    let stepping = Stepping { kernel, ..Stepping::new(integrator, STEP) };
                    let start = State::at_rest(body.rest().to_vec());
                    let world = World::new(&body, start, &*model, Surroundings::default(), stepping);
                    all.push((format!("{integrator:?} {kernel:?} {model:?}"), world));
                }
            }
        }
    }
    all
}

/// The same force (N) on some nodes, for ever.
fn push(nodes: &[u32], force: DVec3) -> Vec<Arc<dyn Load>> {
    vec![Arc::new(Loading::dead(nodes.to_vec(), vec![force; nodes.len()], Course::ALWAYS))]
}

fn middle(of: &[DVec3]) -> DVec3 {
    of.iter().sum::<DVec3>() / of.len() as f64
}

/// The same force on each node, however it is given, moves a body as gravity does.
#[test]
fn forces_move_a_body_as_gravity_does() {
    let pull = DVec3::new(2.0, -1.0, 0.5);
    for (text, mut falling) in worlds() {
        let count = falling.state().position.len();
        let of_load = move |_: f64, _: &[DVec3], forces: &mut [DVec3]| forces.iter_mut().for_each(|sum| *sum += pull);
        let [mut pushed, mut loaded] = [(); 2].map(|()| falling.clone());
        falling.set_gravity(pull).expect("gravity");
        pushed.set_loads(push(&(0..count as u32).collect::<Vec<_>>(), pull)).expect("a load");
        loaded.set_loads(vec![Arc::new(of_load)]).expect("a load");
        for world in [&mut falling, &mut pushed, &mut loaded] {
            world.set_crew(Crew::new(2));
            world.advance(30);
            world.advance(20);
        }
        for world in [&pushed, &loaded] {
            for (one, other) in world.state().position.iter().zip(&falling.state().position) {
                assert!(one.distance(*other) < 1e-11, "{text}: {one} {other}");
            }
        }
        assert!(falling.state().velocity[0].distance(pull * (50.0 * STEP)) < 1e-9, "{text}");
    }
}

/// Of a force that grows with time the momentum is the integral, and a spring to a point outside pulls the body there.
#[test]
fn loads_follow_time_and_positions() {
    for (text, mut world) in worlds() {
        let (count, duration) = (world.state().position.len() as f64, 50.0 * STEP);
        let growing = |time: f64, _: &[DVec3], forces: &mut [DVec3]| forces[0] += DVec3::X * (1e3 * time);
        let mut held = world.clone();
        world.set_loads(vec![Arc::new(growing)]).expect("a load");
        world.advance(50);
        let momentum = world.diagnostics().momentum.x;
        let expected = 0.5e3 * duration * duration;
        // Methods of first order are off by half a step.
        assert!((momentum / expected - 1.0).abs() < 0.03, "{text}: {momentum} {expected}");
        let spring = |_: f64, position: &[DVec3], forces: &mut [DVec3]| {
            position.iter().zip(forces).for_each(|(at, sum)| *sum -= *at * 1e3);
        };
        let before = middle(held.state().position.as_slice());
        held.set_loads(vec![Arc::new(spring)]).expect("a load");
        held.advance(50);
        let moved = middle(&held.state().position) - before;
        let expected = before * ((1e3_f64.sqrt() * duration).cos() - 1.0);
        assert!(moved.distance(expected) < 0.03 * expected.length(), "{text}: {moved} {expected} {count}");
    }
}

#[test]
fn copies_go_on_with_the_same_bits() {
    for (text, mut world) in worlds() {
        world.set_loads(push(&[0, 5], DVec3::new(1.0, 2.0, -1.0))).expect("nodes");
        world.advance(7);
        let mut copy = world.clone();
        copy.advance(9);
        world.advance(4);
        world.advance(5);
        assert_eq!(copy.state(), world.state(), "{text}");
        copy.set_loads(Vec::new()).expect("no loads");
        copy.advance(3);
        world.advance(3);
        assert_ne!(copy.state().velocity, world.state().velocity, "{text}");
    }
}

#[test]
fn obstacles_grips_and_nodes_change_between_steps() {
    for (text, mut world) in worlds() {
        let rest = world.state().position.clone();
        world.set_gravity(DVec3::Y * -9.8).expect("gravity");
        world.advance(100);
        let grip = Grip { nodes: vec![0, 1], from: 0.0, until: f64::INFINITY, motion: Motion::Still };
        let number = world.add_grip(grip.clone()).expect("nodes of the body");
        let held = world.state().position[0];
        world.advance(100);
        assert!(world.state().position[0].distance(held) < 1e-15, "{text}");
        assert_eq!(world.remove_grip(number).map(|grip| grip.nodes), Some(grip.nodes));
        assert!(world.remove_grip(number).is_none());
        world.advance(100);
        assert!(world.state().position[0].y < held.y, "{text}");
        // Back to the start, on a floor that rises by a path of the caller.
        world.set_nodes(rest.clone(), vec![DVec3::ZERO; rest.len()]).expect("places");
        let start = world.state().steps as f64 * STEP;
        let rise = move |time: f64| Pose { shift: DVec3::Y * (0.2 * (time - start)), ..Pose::NONE };
        let mut ground = floor(0.0, 0.5);
        ground.motion = Motion::Along(Arc::new(rise));
        world.set_obstacles(vec![ground]).expect("a floor");
        world.advance(100);
        let lowest = world.state().position.iter().fold(f64::INFINITY, |low, at| low.min(at.y));
        assert!(lowest > 0.2 * 100.0 * STEP - 1e-4, "{text}: {lowest}");
        assert_eq!(world.status(), Status::Ok, "{text}");
    }
}

#[test]
fn wrong_surroundings_are_told_and_change_nothing() {
    let (_, mut world) = worlds().swap_remove(0);
    let count = world.state().position.len();
    let told = |found: Result<(), localshape_sim::WrongSurroundings>| found.unwrap_err().to_string();
    assert_eq!(told(world.set_gravity(DVec3::NAN)), "gravity is [NaN, NaN, NaN]; expected finite numbers (m/s²)");
    let missing = told(world.set_loads(push(&[0, 99], DVec3::X)));
    assert_eq!(missing, format!("load 0 names node 99; the last one is {}", count - 1));
    let infinite = told(world.set_loads(push(&[2], DVec3::X * f64::INFINITY)));
    assert_eq!(infinite, "the force of node 2 is [inf, NaN, NaN]; expected finite numbers");
    let wrong = world.set_nodes(vec![DVec3::ZERO; count], vec![DVec3::ZERO; 2]);
    assert_eq!(told(wrong), format!("there are 2 velocities for {count} nodes; give one for each"));
    let grip = Grip { nodes: vec![0, 70], from: 0.0, until: 1.0, motion: Motion::Still };
    let told_of_grip = world.add_grip(grip).unwrap_err().to_string();
    assert_eq!(told_of_grip, format!("grip 0 names node 70; the last one is {}", count - 1));
    let mut bouncing = floor(0.0, 0.5);
    bouncing.restitution = 1.5;
    let found = told(world.set_obstacles(vec![floor(0.0, 0.5), bouncing]));
    assert_eq!(found, "the restitution of obstacle 1 is 1.5; expected a number from 0 to 1");
    let around = world.surroundings();
    assert!(around.loads.is_empty() && around.grips.is_empty() && around.obstacles.is_empty());
}
