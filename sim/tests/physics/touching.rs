//! Single touches beside their right values: distances that are kept, nodes that are held, friction that holds, and what is known of a step.

use super::surfaces::{Noise, Placed, SIDE, block, by, moments, still, with_contacts};
use glam::{DQuat, DVec3};
use localshape_sim::{
    Body, BodyContact, Contacts, Dimension, Ease, FrictionOf, Grip, Integrator, Kernel, Key, Moment, Motion, Obstacle,
    Offset, Reaction, Shape, Source, State, Surroundings, World,
};
use std::f64::consts::TAU;
use std::sync::Arc;

const STIFFNESS: f64 = 1e4;
/// ΔT (s).
const STEP: f64 = 0.02 * TAU / 100.0;

pub(super) fn world(bodies: &[(Arc<Body>, Placed)], around: Surroundings) -> World {
    by(Integrator::SemiImplicitEuler, Kernel::Fast, bodies, STIFFNESS, 0.02, around)
}

pub(super) fn flying(at: DVec3, speed: DVec3) -> Placed {
    Placed { speed, ..still(at) }
}

pub(super) fn obstacle(shape: Shape, motion: Motion, friction: f64) -> Obstacle {
    let friction_of = FrictionOf::default();
    Obstacle { pivot: shape.middle(), shape, motion, restitution: 0.0, friction, friction_of }
}

pub(super) fn slab(half: [f64; 3], at: DVec3) -> Shape {
    Shape::Box { centre: at, half: half.into(), rotation: DQuat::IDENTITY }
}

/// Constant speed (m/s) and angular velocity (rad/s).
pub(super) fn steady(speed: DVec3, spin: DVec3) -> Motion {
    let key = |time: f64| Key { time, offset: Offset { shift: speed * time, rotation: spin * time } };
    Motion::Keys { keys: vec![key(0.0), key(10.0)], ease: Ease::Linear, repeat: false }
}

pub(super) fn steps(time: f64) -> u64 {
    (time / STEP).round() as u64
}

pub(super) fn mean(of: &[DVec3]) -> DVec3 {
    of.iter().sum::<DVec3>() / of.len() as f64
}

/// A corner above a face, nearer than the distance that is kept: one step moves both apart to this distance, and gives them no speed.
#[test]
fn what_starts_too_near_is_moved_apart() {
    const GAP: f64 = 2e-3;
    let cube = block([1; 3]);
    let down = DQuat::from_rotation_arc(DVec3::ONE.normalize(), DVec3::NEG_Y);
    let height = SIDE * (0.5 + 0.75f64.sqrt()) + 0.5 * GAP;
    let bodies = [still(DVec3::ZERO), Placed { turned: down, ..still(DVec3::new(0.02, height, 0.01)) }];
    let mut around = with_contacts(0.5, 0.5);
    let thin = BodyContact { thickness: Some(0.5 * GAP), itself: false };
    around.contacts.as_mut().expect("contacts").bodies = vec![thin; 2];
    let mut world = world(&bodies.map(|placed| (Arc::clone(&cube), placed)), around.clone());
    // In the triangle of two corners and the middle of the face.
    let apart = |world: &World| {
        let at = &world.state().position;
        let middle = mean(&[at[2], at[3], at[6], at[7]]);
        (at[8 + 7] - (middle * 0.6 + at[3] * 0.1 + at[7] * 0.3)).length()
    };
    assert!((apart(&world) - 0.5 * GAP).abs() < 1e-12);
    world.advance(1);
    assert!((apart(&world) - GAP).abs() < 1e-12, "{}", apart(&world));
    assert!(world.state().velocity.iter().all(|speed| speed.length() < 1e-10));
    // Where they move, too, their momenta stay.
    for friction in [0.0, 0.5] {
        around.contacts.as_mut().expect("contacts").friction = friction;
        let moving = [bodies[0], Placed { speed: DVec3::new(0.4, -0.1, 0.2), ..bodies[1] }];
        let mut world = self::world(&moving.map(|placed| (Arc::clone(&cube), placed)), around.clone());
        let mass = [cube.mass(), cube.mass()].concat();
        let before = moments(&world, &mass);
        world.advance(2);
        let after = moments(&world, &mass);
        assert!(
            (after.0 - before.0).length() < 1e-14 && (after.1 - before.1).length() < 1e-15,
            "{friction}: {after:?}"
        );
    }
}

/// A body that is held stays to the last bit where it is held, throws back what hits it, and feels the opposite of what that feels.
#[test]
fn what_is_held_stays_and_feels_the_impact() {
    let body = block([2; 3]);
    let bodies = [still(DVec3::ZERO), flying(DVec3::new(0.013, 0.23, 0.021), DVec3::new(0.3, -1.0, 0.1))];
    let nodes = (0..body.len() as u32).collect();
    let grip = Grip { nodes, from: 0.0, until: f64::INFINITY, motion: Motion::at(Offset::default()) };
    let around = Surroundings { grips: vec![grip], ..with_contacts(0.5, 0.4) };
    let mut world = world(&bodies.map(|placed| (Arc::clone(&body), placed)), around);
    world.keep_reactions(Moment::at(200.0 * STEP));
    let held = world.state().position[..body.len()].to_vec();
    let momentum = |world: &World| {
        let nodes = world.state().velocity[body.len()..].iter().zip(body.mass());
        nodes.map(|(&speed, &mass)| speed * mass).sum::<DVec3>()
    };
    let before = momentum(&world);
    for _ in 0..200 {
        world.advance(1);
        assert_eq!(world.state().position[..body.len()], held, "step {}", world.steps());
        assert!(world.state().velocity[..body.len()].iter().all(|&speed| speed == DVec3::ZERO));
    }
    let gained = momentum(&world) - before;
    assert!(gained.y > 8.0, "it is thrown back: {gained}");
    let forces = world.reactions().expect("an interval has ended");
    let of = |from: Source, body: usize| {
        let Reaction { force, torque, .. } =
            forces.iter().find(|one| (one.from, one.on) == (from, body)).expect("a pair");
        [*force, *torque].map(|one| one * (200.0 * STEP))
    };
    let ([on_held, turning], [on_other, back]) = (of(Source::Body(1), 0), of(Source::Body(0), 1));
    let holding = of(Source::Grip(0), 0)[0];
    assert!((holding + on_held).length() < 1e-11, "what holds it is pushed: {holding}");
    assert!((on_other - gained).length() < 1e-11 && (on_held + gained).length() < 1e-11, "{on_held} {gained}");
    assert!((turning + back).length() < 0.02 * back.length(), "{turning} {back}");
}

/// A block on a slope within its friction stays where it is: friction holds its path, and not more than its speed.
#[test]
fn friction_holds_a_block_on_a_slope() {
    let body = block([2, 1, 2]);
    let gravity = DVec3::new(0.4, -1.0, 0.0).normalize() * 10.0;
    let surface = slab([3.0, 0.1, 1.0], DVec3::Y * -0.153);
    let around =
        Surroundings { gravity, obstacles: vec![obstacle(surface, Motion::Still, 0.5)], ..with_contacts(0.0, 0.0) };
    let mut world = world(&[(Arc::clone(&body), still(DVec3::ZERO))], around);
    world.advance(steps(0.5));
    let before = mean(&world.state().position);
    world.advance(steps(0.5));
    let way = mean(&world.state().position).x - before.x;
    // Without friction of the path it creeps by 2.3 mm.
    assert!(way.abs() < 1e-4, "{way}");
}

/// In the plane, too, a square slows down on a box with the friction of both.
#[test]
fn a_square_slows_down_in_the_plane() {
    let place = |at: u32| DVec3::new(f64::from(at % 3), f64::from(at / 3), 0.0) * SIDE;
    let cells = [[0u32, 1, 4, 3], [1, 2, 5, 4]];
    let elements = cells.iter().map(|cell| &cell[..]).collect();
    let body = Body::builder((0..6).map(place).collect()).dimension(Dimension::Plane).elements(elements);
    let body = Arc::new(body.build().expect("two squares"));
    let surface = slab([3.0, 0.1, f64::INFINITY], DVec3::Y * -0.103);
    let obstacles = vec![obstacle(surface, Motion::Still, 0.3)];
    let around = Surroundings { gravity: DVec3::Y * -10.0, obstacles, ..with_contacts(0.0, 0.0) };
    let mut world = world(&[(body, flying(DVec3::ZERO, DVec3::X * 2.0))], around);
    world.advance(steps(0.4));
    let speed = mean(&world.state().velocity).x;
    assert!((speed - (2.0 - 0.3 * 10.0 * 0.4)).abs() < 0.05, "{speed}");
}

/// Soft blocks that spin and fall among obstacles that move. A world that forgets what it knows before each step has the same bits.
#[test]
fn what_is_known_of_a_step_changes_no_bit() {
    for round in 1..3 {
        let mut noise = Noise(round);
        let bodies: Vec<_> = (0..4u32)
            .map(|at| {
                let place = DVec3::new(0.36 * f64::from(at % 2), 0.3 + 0.38 * f64::from(at / 2), 0.1 * noise.number());
                (block([2, 1 + at % 2, 3]), Placed { at: place, turned: noise.turn(), speed: DVec3::Y * -3.0 })
            })
            .collect();
        let spin = DVec3::new(noise.number(), noise.number(), noise.number()) * 20.0;
        let obstacles = vec![
            obstacle(slab([1.0, 0.1, 1.0], DVec3::Y * -0.2), steady(DVec3::Y * 0.5, DVec3::Z * 0.3), 0.4),
            obstacle(Shape::Sphere { centre: DVec3::ZERO, radius: 0.05 }, steady(DVec3::X * 0.5, DVec3::Y * 3.0), 0.4),
        ];
        let contacts = Contacts { restitution: 0.3, friction: 0.4, ..Contacts::default() };
        let contacts = if round == 2 {
            let itself = BodyContact { itself: true, thickness: None };
            Contacts { bodies: vec![itself; 4], ..contacts }
        } else {
            contacts
        };
        let around =
            Surroundings { gravity: DVec3::Y * -9.8, obstacles, contacts: Some(contacts), ..Surroundings::default() };
        let begin = || {
            let mut world = by(Integrator::SemiImplicitEuler, Kernel::Fast, &bodies, 1e3, 0.02, around.clone());
            let mut state = world.state().clone();
            let mut first = 0;
            for (body, placed) in &bodies {
                for node in first..first + body.len() {
                    state.velocity[node] += spin.cross(state.position[node] - placed.at);
                }
                first += body.len();
            }
            world.set_state(state);
            world
        };
        let (mut whole, mut forgetful) = (begin(), begin());
        for _ in 0..20 {
            whole.advance(8);
            forgetful = forgetful.clone();
            forgetful.advance(8);
            let State { position, velocity, .. } = whole.state();
            let same = (position, velocity) == (&forgetful.state().position, &forgetful.state().velocity);
            assert!(same, "round {round}, step {}", whole.steps());
        }
    }
}
