//! Bodies that carry a surface meet half-spaces with it, and not with the nodes of their cages.

use super::surfaces::{Placed, SIDE, block, by};
use super::touching::steady;
use glam::{DQuat, DVec3};
use localshape_sim::{
    Body, Carried, Contacts, Crew, Ease, FrictionOf, Integrator, Kernel, Key, Motion, Obstacle, Offset, Shape, State,
    Surroundings, Weights, World,
};
use std::sync::Arc;

/// Half of the side of the cube that is carried (m), and the distance that it keeps: the fortieth part of its mean edge.
const HALF: f64 = 0.06;
const THICKNESS: f64 = 0.025 * 2.0 * HALF * (12.0 + 6.0 * std::f64::consts::SQRT_2) / 18.0;

/// A block of eight cells that carries a cube inside it.
fn carrying() -> Arc<Body> {
    let cage = block([2; 3]);
    let sign = |corner: u32, axis: usize| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
    let rest: Vec<_> =
        (0..8).map(|corner| HALF * DVec3::from_array([0, 1, 2].map(|axis| sign(corner, axis)))).collect();
    let mut weights = Weights::default();
    for corner in 0..8 {
        let (mut nodes, mut shares) = (Vec::new(), Vec::new());
        for (node, &at) in (0u32..).zip(cage.rest()) {
            let share = |axis: usize| match (at[axis] / SIDE).round() * sign(corner, axis) {
                0.0 => 1.0 - HALF / SIDE,
                1.0 => HALF / SIDE,
                _ => 0.0,
            };
            let share = share(0) * share(1) * share(2);
            if share > 0.0 {
                nodes.push(node);
                shares.push(share);
            }
        }
        weights.push(&nodes, &shares);
    }
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Arc::new(Body::clone(&cage).with_carried(Arc::new(Carried { rest, triangles, weights })).expect("a body"))
}

fn half_space(normal: DVec3, friction: f64, motion: Motion) -> Obstacle {
    let shape = Shape::Plate { point: DVec3::ZERO, normal };
    Obstacle { shape, motion, pivot: DVec3::ZERO, restitution: 0.0, friction, friction_of: FrictionOf::Path }
}

/// A world of one such body at a place, and a half-space through the origin.
fn world(at: DVec3, gravity: DVec3, plate: Obstacle, contacts: Option<Contacts>, kernel: Kernel) -> World {
    let around = Surroundings { gravity, obstacles: vec![plate], contacts, ..Surroundings::default() };
    let placed = Placed { at, turned: DQuat::IDENTITY, speed: DVec3::ZERO };
    by(Integrator::SemiImplicitEuler, kernel, &[(carrying(), placed)], 2e4, 0.02, around)
}

/// The least height (m) of points of the carried surface, and of nodes.
fn lowest(world: &World, normal: DVec3) -> [f64; 2] {
    let State { position, .. } = world.state();
    let fine = carrying().carried().expect("a surface").positions(position);
    let least = |points: &[DVec3]| points.iter().fold(f64::INFINITY, |least, at| least.min(normal.dot(*at)));
    [least(&fine), least(position)]
}

#[test]
fn the_surface_comes_to_rest_on_the_floor() {
    let run = |contacts: Option<Contacts>, kernel: Kernel| {
        let plate = half_space(DVec3::Y, 0.0, Motion::Still);
        let mut world = world(DVec3::Y * 0.2, DVec3::Y * -10.0, plate, contacts, kernel);
        world.advance(20_000);
        world
    };
    for kernel in [Kernel::Fast, Kernel::Reference] {
        let [fine, cage] = lowest(&run(Some(Contacts::default()), kernel), DVec3::Y);
        assert!((fine - THICKNESS).abs() < 0.05 * THICKNESS, "{kernel:?}: {fine} {THICKNESS}");
        assert!(cage < -0.03, "{kernel:?}: {cage}");
        let [fine, cage] = lowest(&run(None, kernel), DVec3::Y);
        assert!(cage > -1e-9 && fine > 0.03, "{kernel:?}: {fine} {cage}");
    }
}

/// Copies, states that are read back, and threads: nothing of what is known of a step changes a bit, beside a plate at rest, one that
/// moves, and one that turns.
#[test]
fn nothing_changes_a_bit() {
    for motion in [Motion::Still, steady(DVec3::Y * 0.3, DVec3::ZERO), steady(DVec3::Y * 0.1, DVec3::X * 0.5)] {
        let begin = || {
            let plate = half_space(DVec3::new(0.1, 1.0, 0.2).normalize(), 0.3, motion.clone());
            world(DVec3::Y * 0.15, DVec3::Y * -10.0, plate, Some(Contacts::default()), Kernel::Fast)
        };
        let mut whole = begin();
        whole.advance(600);
        let mut parts = begin();
        parts.set_crew(Crew::new(2));
        parts.advance(251);
        let mut copy = parts.clone();
        let mut read = begin();
        read.set_state(parts.state().clone());
        for world in [&mut parts, &mut copy, &mut read] {
            (0..349).for_each(|_| world.advance(1));
            let State { position, velocity, .. } = whole.state();
            assert!(world.state().position == *position && world.state().velocity == *velocity, "{motion:?}");
        }
    }
}

#[test]
fn a_plate_lifts_the_surface_and_friction_holds_it() {
    let key = |time: f64, y: f64| Key { time, offset: Offset { shift: DVec3::Y * y, rotation: DVec3::ZERO } };
    let motion = Motion::Keys { keys: vec![key(0.0, 0.0), key(5.0, 1.0)], ease: Ease::Linear, repeat: false };
    let above = DVec3::Y * (HALF + 0.01);
    let plate = half_space(DVec3::Y, 0.0, motion);
    let mut lifted = world(above, DVec3::Y * -10.0, plate, Some(Contacts::default()), Kernel::Fast);
    let step = 0.02 * std::f64::consts::TAU / 2e4_f64.sqrt();
    let steps = (4.0 / step) as u64;
    lifted.advance(steps);
    let [fine, _] = lowest(&lifted, DVec3::Y);
    assert!((fine - 0.2 * steps as f64 * step - THICKNESS).abs() < 0.1 * THICKNESS, "{fine}");
    // On a slope of 20°, whose tangent is .364.
    let (sine, cosine) = (20.0_f64.to_radians().sin(), 20.0_f64.to_radians().cos());
    let gravity = DVec3::new(sine, -cosine, 0.0) * 10.0;
    let middle = |world: &World| world.state().position.iter().sum::<DVec3>() / 27.0;
    let slides = |friction: f64| {
        let plate = half_space(DVec3::Y, friction, Motion::Still);
        let at = DVec3::Y * (HALF + THICKNESS);
        let mut world = world(at, gravity, plate, Some(Contacts::default()), Kernel::Fast);
        world.advance(steps / 4);
        middle(&world).x
    };
    let (free, held) = (slides(0.0), slides(0.5));
    let expected = 5.0 * sine * ((steps / 4) as f64 * step).powi(2);
    assert!((free - expected).abs() < 0.02 * expected, "{free} {expected}");
    // Elastic vibrations lift it now and then.
    assert!(held.abs() < 0.01 * expected, "{held}");
}

/// Wherever it starts, its surface stops at the distance that it keeps: no point comes nearer, also in the step after which its list of points is
/// made anew. A plate that comes to a body at rest is met as one at rest by a body that moves.
#[test]
fn the_surface_stops_wherever_it_starts() {
    for (start, rises) in (0..40).flat_map(|start| [0.0, 1.5, 4.0].map(|rises| (start, rises))) {
        let height = HALF + THICKNESS + 0.06 + 5e-4 * f64::from(start);
        let motion = if rises == 0.0 { Motion::Still } else { steady(DVec3::Y * rises, DVec3::ZERO) };
        let plate = half_space(DVec3::Y, 0.0, motion);
        let step = 0.02 * std::f64::consts::TAU / 2e4_f64.sqrt();
        // This code asks for points from the first step on.
        let mut world = world(DVec3::Y * height, DVec3::ZERO, plate, Some(Contacts::default()), Kernel::Reference);
        let speed = vec![DVec3::Y * (rises - 4.0); 27];
        world.set_nodes(world.state().position.clone(), speed).expect("speeds");
        let mut least = f64::INFINITY;
        for _ in 0..28 {
            world.advance(1);
            least = least.min(lowest(&world, DVec3::Y)[0] - rises * world.steps() as f64 * step);
        }
        // In a step it goes once more as far.
        assert!((0.9 * THICKNESS..2.4 * THICKNESS).contains(&least), "{height} {rises}: {least} {THICKNESS}");
    }
}

#[test]
fn a_plate_that_moves_aside_takes_the_surface_along() {
    let key = |time: f64| Key { time, offset: Offset { shift: DVec3::X * (0.5 * time), rotation: DVec3::ZERO } };
    let motion = Motion::Keys { keys: vec![key(0.0), key(10.0)], ease: Ease::Linear, repeat: false };
    let plate = half_space(DVec3::Y, 0.5, motion);
    let at = DVec3::Y * (HALF + THICKNESS);
    let mut carried = world(at, DVec3::Y * -10.0, plate, Some(Contacts::default()), Kernel::Fast);
    carried.advance((0.5 / (0.02 * std::f64::consts::TAU / 2e4_f64.sqrt())) as u64);
    let speed = carried.state().velocity.iter().map(|speed| speed.x).sum::<f64>() / 27.0;
    assert!((speed - 0.5).abs() < 0.05, "{speed}");
}

/// A cell that carries a cube of one and a half times its size.
fn protruding() -> Arc<Body> {
    const TIMES: f64 = 1.5;
    let cage = block([1; 3]);
    let signs = |corner: u32| DVec3::from_array([0, 1, 2].map(|axis| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 }));
    let rest = (0..8).map(|corner| 0.5 * TIMES * SIDE * signs(corner)).collect();
    let mut weights = Weights::default();
    for corner in 0..8 {
        let share = |node: u32| (0.5 * (1.0 + TIMES * signs(corner) * signs(node))).to_array().iter().product();
        weights.push(&[0, 1, 2, 3, 4, 5, 6, 7], &[0, 1, 2, 3, 4, 5, 6, 7].map(share));
    }
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Arc::new(Body::clone(&cage).with_carried(Arc::new(Carried { rest, triangles, weights })).expect("a body"))
}

/// Fillings that cut cells stand inside of their surface in places. Boxes around their nodes would let bodies run alone into each other.
#[test]
fn surfaces_that_stand_out_of_their_cages_meet_in_time() {
    for kernel in [Kernel::Fast, Kernel::Reference] {
        let bodies = [-1.0, 1.0].map(|sign| {
            let at = 0.9 * SIDE * sign * DVec3::X;
            (protruding(), Placed { at, turned: DQuat::IDENTITY, speed: -0.05 * sign * DVec3::X })
        });
        let around = Surroundings { contacts: Some(Contacts::default()), ..Surroundings::default() };
        let mut world = by(Integrator::SemiImplicitEuler, kernel, &bodies, 2e4, 0.02, around);
        for _ in 0..100 {
            world.advance(10);
            assert_eq!(world.crossings(), Some(Vec::new()), "{kernel:?}");
        }
        let [left, right] = [0..8, 8..16].map(|nodes| {
            let State { position, velocity, .. } = world.state();
            (position[nodes.clone()].iter().sum::<DVec3>() / 8.0, velocity[nodes].iter().sum::<DVec3>() / 8.0)
        });
        assert!(right.0.x - left.0.x > 1.45 * SIDE, "{kernel:?}: {} {}", left.0, right.0);
        assert!(left.1.x < 1e-3 && right.1.x > -1e-3, "{kernel:?}: {} {}", left.1, right.1);
    }
}
