//! Rebound and friction against closed forms, at obstacles of every shape, still and moving.

use super::support::{Noise, lattice, shape_based};
use glam::{DQuat, DVec3};
use localshape_sim::{
    Ease, Integrator, Kernel, Key, Motion, Obstacle, Offset, Shape, State, Stepping, Surroundings, World,
};

const STEP: f64 = 1e-3;

fn obstacle(shape: Shape, restitution: f64, friction: f64, motion: Motion) -> Obstacle {
    let pivot = shape.middle();
    Obstacle { shape, motion, pivot, restitution, friction, friction_of: Default::default() }
}

fn floor() -> Shape {
    Shape::Floor { normal: DVec3::Y, height: 0.0 }
}

/// Constant speed (m/s) and angular velocity (rad/s) from the start on.
fn steady(speed: DVec3, spin: DVec3) -> Motion {
    let keys = vec![
        Key { time: 0.0, offset: Offset::default() },
        Key { time: 100.0, offset: Offset { shift: speed * 100.0, rotation: spin * 100.0 } },
    ];
    Motion::Keys { keys, ease: Ease::Linear, repeat: false }
}

#[test]
fn a_moving_wall_gives_a_node_its_own_speed_and_the_rebound() {
    for (restitution, speed, before) in [(0.0, 2.0, 0.0), (0.5, 2.0, -1.0), (1.0, 3.0, 0.0)] {
        let rising = obstacle(floor(), restitution, 0.0, steady(DVec3::Y * speed, DVec3::ZERO));
        let height = 0.4 * speed;
        let (mut position, mut velocity) = (DVec3::new(0.3, height - 0.01, 0.0), DVec3::Y * before);
        rising.at(0.4, STEP).rebound(&mut position, &mut velocity, DVec3::ZERO);
        // Relative to the wall: −e (v − u), and reflected to e times the depth.
        let expected = speed - restitution * (before - speed);
        assert!((velocity - DVec3::Y * expected).length() < 1e-11, "{velocity} {expected}");
        assert!((position.y - (height + restitution * 0.01)).abs() < 1e-13, "{position}");
    }
}

#[test]
fn a_node_that_flees_faster_than_the_wall_keeps_its_speed() {
    let rising = obstacle(floor(), 0.5, 0.5, steady(DVec3::Y, DVec3::ZERO));
    let (mut position, mut velocity) = (DVec3::new(0.0, 0.09, 0.0), DVec3::new(0.5, 1.5, 0.0));
    rising.at(0.1, STEP).rebound(&mut position, &mut velocity, DVec3::ZERO);
    assert_eq!(velocity, DVec3::new(0.5, 1.5, 0.0));
}

#[test]
fn a_conveyor_takes_a_node_along_by_friction_and_no_faster_than_itself() {
    let belt = |friction| obstacle(floor(), 0.0, friction, steady(DVec3::X * 3.0, DVec3::ZERO));
    for (friction, along) in [(0.0, 0.0), (0.2, 0.4), (1.0, 2.0), (5.0, 3.0)] {
        let (mut position, mut velocity) = (DVec3::new(0.0, -0.001, 0.0), DVec3::new(0.0, -2.0, 0.0));
        belt(friction).at(0.5, STEP).rebound(&mut position, &mut velocity, DVec3::ZERO);
        assert!((velocity - DVec3::X * along).length() < 1e-10, "{friction}: {velocity}");
    }
}

#[test]
fn a_turning_table_carries_a_node_at_the_speed_of_the_place_where_it_stands() {
    let table = obstacle(floor(), 0.0, 1e3, steady(DVec3::ZERO, DVec3::Y * 4.0));
    let (mut position, mut velocity) = (DVec3::new(0.5, -0.001, 0.2), DVec3::new(0.0, -1.0, 0.0));
    table.at(0.7, STEP).rebound(&mut position, &mut velocity, DVec3::ZERO);
    // The chord of the last step instead of the tangent: rotated by half a step.
    let chord = DQuat::from_rotation_y(-4.0 * STEP / 2.0) * DVec3::new(4.0 * 0.2, 0.0, -4.0 * 0.5);
    assert!((velocity - chord).length() < 1e-5, "{velocity} {chord}");
}

/// A floor that has turned has turned its normal, for nodes, for pictures and for kernels.
#[test]
fn a_turning_floor_turns_its_normal() {
    let tilt = 0.4;
    let tilting = Obstacle { pivot: DVec3::X, ..obstacle(floor(), 0.0, 0.0, steady(DVec3::ZERO, DVec3::Z * tilt)) };
    let normal = DVec3::new(-tilt.sin(), tilt.cos(), 0.0);
    let (found, height) = tilting.floor(1.0).expect("a floor");
    assert!((found - normal).length() < 1e-14 && (height - normal.x).abs() < 1e-14, "{found} {height}");
    // It is pushed out, and keeps its speed along the surface.
    let inside = DVec3::X + DVec3::new(tilt.cos(), tilt.sin(), 0.0) - normal * 0.01;
    let (mut position, mut velocity) = (inside, DVec3::Z - normal);
    tilting.at(1.0, 1e-9).rebound(&mut position, &mut velocity, DVec3::ZERO);
    assert!((position - inside - normal * 0.01).length() < 1e-12, "{position}");
    assert!((velocity - DVec3::Z - normal * tilt).length() < 1e-6, "{velocity}");
    let body = lattice(2, 0.1);
    let start = State::at_rest(body.rest().iter().map(|&at| at + DVec3::new(1.2, 0.01, 0.0)).collect());
    let ends = [Kernel::Fast, Kernel::Reference].map(|kernel| {
        let gravity = DVec3::Y * -9.8;
        let around = Surroundings { gravity, obstacles: vec![tilting.clone()], ..Surroundings::default() };
        let stepping = Stepping { kernel, ..Stepping::new(Integrator::SemiImplicitEuler, STEP) };
        let mut world = World::new(&body, start.clone(), &shape_based(1e4, 20.0), around, stepping);
        world.advance(300);
        let state = world.state().position.clone();
        let (normal, height) = tilting.floor(0.3).expect("a floor");
        assert!(state.iter().all(|at| at.dot(normal) > height - 1e-3), "{kernel:?}: a node has sunk in");
        state
    });
    assert!(ends[0].iter().zip(&ends[1]).all(|(fast, plain)| fast.distance(*plain) < 1e-9));
}

#[test]
fn every_shape_mirrors_the_depth_and_the_speed_along_its_normal() {
    let slant = DVec3::new(0.6, 0.8, 0.0);
    let shapes = [
        (floor(), DVec3::new(0.2, -0.01, 0.1), DVec3::Y),
        (Shape::Plate { point: DVec3::Y, normal: slant }, DVec3::Y - slant * 0.01, slant),
        (Shape::Sphere { centre: DVec3::X, radius: 0.5 }, DVec3::X + slant * 0.49, slant),
        (Shape::Capsule { from: -DVec3::Z, to: DVec3::Z, radius: 0.3 }, slant * 0.29 + DVec3::Z * 0.4, slant),
        (Shape::Capsule { from: -DVec3::Z, to: DVec3::Z, radius: 0.3 }, DVec3::Z * 1.29, DVec3::Z),
        (
            Shape::Box { centre: DVec3::ONE, half: DVec3::new(0.5, 0.2, 0.3), rotation: DQuat::IDENTITY },
            DVec3::ONE + DVec3::new(0.1, 0.19, 0.1),
            DVec3::Y,
        ),
    ];
    for (shape, inside, normal) in shapes {
        for restitution in [0.0, 0.5, 1.0] {
            let (mut position, mut velocity) = (inside, DVec3::new(0.3, -0.4, 0.2) - normal * 3.0);
            let before = velocity;
            obstacle(shape.clone(), restitution, 0.0, Motion::Still).at(1.0, STEP).rebound(
                &mut position,
                &mut velocity,
                DVec3::ZERO,
            );
            let depth = 0.01;
            assert!((position - (inside + normal * depth * (1.0 + restitution))).length() < 1e-14, "{shape:?}");
            let expected = before - normal * (1.0 + restitution) * before.dot(normal);
            assert!((velocity - expected).length() < 1e-13, "{shape:?}: {velocity} {expected}");
            let outside = obstacle(shape.clone(), 1.0, 1.0, Motion::Still);
            let (mut away, mut speed) = (inside + normal * 0.02, -normal);
            outside.at(1.0, STEP).rebound(&mut away, &mut speed, DVec3::ZERO);
            assert_eq!((away, speed), (inside + normal * 0.02, -normal), "{shape:?}");
        }
    }
}

/// A moving obstacle acts like a still one in a moving frame: to round-off for uniform motion.
#[test]
fn a_steadily_moving_obstacle_is_a_still_one_in_a_moving_frame() {
    let mut noise = Noise(4);
    let shapes = [
        floor(),
        Shape::Sphere { centre: DVec3::new(0.1, 0.0, 0.0), radius: 0.9 },
        Shape::Capsule { from: -DVec3::X, to: DVec3::X * 0.5, radius: 0.8 },
        Shape::Box { centre: DVec3::ZERO, half: DVec3::ONE, rotation: DQuat::from_rotation_y(0.4) },
    ];
    for shape in shapes {
        let mut met = 0;
        for _ in 0..200 {
            let drift = noise.vector();
            let still = obstacle(shape.clone(), 0.6, 0.3, Motion::Still);
            let moving = obstacle(shape.clone(), 0.6, 0.3, steady(drift, DVec3::ZERO));
            let (mut position, mut velocity) = (noise.vector(), noise.vector() * 2.0);
            let (mut other, mut other_velocity) = (position + drift * 0.25, velocity + drift);
            met += usize::from(still.at(0.25, STEP).contact(position).is_some());
            still.at(0.25, STEP).rebound(&mut position, &mut velocity, DVec3::ZERO);
            moving.at(0.25, STEP).rebound(&mut other, &mut other_velocity, DVec3::ZERO);
            assert!((other - position - drift * 0.25).length() < 1e-12);
            assert!((other_velocity - velocity - drift).length() < 1e-11, "{shape:?}");
        }
        assert!(met > 30, "{shape:?}: {met}");
    }
}

#[test]
fn obstacles_act_in_the_order_of_the_scene() {
    // Between two walls that overlap, the last one decides.
    let left = obstacle(Shape::Plate { point: DVec3::ZERO, normal: DVec3::X }, 0.0, 0.0, Motion::Still);
    let right = obstacle(Shape::Plate { point: DVec3::X * -0.1, normal: -DVec3::X }, 0.0, 0.0, Motion::Still);
    for (order, end) in [([&left, &right], -0.1), ([&right, &left], 0.0)] {
        let (mut position, mut velocity) = (DVec3::X * -0.05, DVec3::ZERO);
        for one in order {
            one.at(1.0, STEP).rebound(&mut position, &mut velocity, DVec3::ZERO);
        }
        assert_eq!(position.x, end);
    }
}

/// A uniform translation of a rotated obstacle, `far` metres from its position in the scene.
fn turned_and_shifting(far: f64) -> Motion {
    let shift = DVec3::new(0.2, -0.1, 0.3);
    let at = |time: f64| Key { time, offset: Offset { shift: shift * (time + far), rotation: DVec3::Y } };
    Motion::Keys { keys: vec![at(0.0), at(1.0)], ease: Ease::Linear, repeat: false }
}

/// About the position to which it has moved what was near the origin.
fn wall_place(far: Option<f64>) -> DVec3 {
    far.map_or(DVec3::ZERO, |far| DVec3::new(0.2, -0.1, 0.3) * far)
}

/// Where a rebound with `e = 0` places a node, round-off decides on which side of the surface it is. The result must
/// not depend on that: an approaching node rebounds, any other one is unchanged.
#[test]
fn a_node_on_the_surface_rebounds_if_it_approaches() {
    let mut noise = Noise(12);
    let slant = DVec3::new(0.3, 0.9, -0.2).normalize();
    let rotation = DQuat::from_xyzw(0.1, 0.3, -0.2, 0.9).normalize();
    let shapes = [
        Shape::Floor { normal: slant, height: 0.7 },
        Shape::Plate { point: DVec3::new(0.1, 0.2, 0.3), normal: slant },
        Shape::Sphere { centre: DVec3::splat(0.2), radius: 2.0 },
        Shape::Capsule { from: DVec3::X, to: DVec3::new(-0.4, 0.3, 0.0), radius: 2.0 },
        Shape::Box { centre: DVec3::new(0.1, 0.0, 0.0), half: DVec3::splat(2.0), rotation },
    ];
    for (shape, far) in shapes.iter().flat_map(|shape| [None, Some(0.0), Some(1e4)].map(|far| (shape, far))) {
        let motion = far.map_or(Motion::Still, turned_and_shifting);
        let wall = obstacle(shape.clone(), 0.0, 0.0, motion);
        let wall = wall.at(0.3, STEP);
        let mut outside = 0;
        for _ in 0..300 {
            let place = wall_place(far) + noise.vector();
            let (mut position, mut velocity) = (place, DVec3::ZERO);
            let Some((contact, own)) = wall.contact(position) else { continue };
            // On the surface.
            wall.rebound(&mut position, &mut velocity, DVec3::ZERO);
            outside += usize::from(wall.contact(position).is_none());
            for (towards, after) in [(-1.0, 0.0), (1.0, 1.0)] {
                let mut velocity = own + contact.normal * towards;
                let mut there = position;
                wall.rebound(&mut there, &mut velocity, DVec3::ZERO);
                let left = (velocity - own).dot(contact.normal);
                assert!((left - after).abs() < 1e-8, "{shape:?} {position}: {towards} {left}");
                assert!(there.distance(position) < 1e-14 * (1.0 + position.length()), "{shape:?}");
            }
        }
        assert!(outside > 0, "{shape:?}: round-off puts some outside");
    }
}

/// A node that has fallen into a floor within a step, and the same fall with the impact computed inside the step: with
/// any restitution both reach the same height.
#[test]
fn a_rebound_of_a_node_that_accelerates_has_the_energy_of_the_impact() {
    let g = 9.8;
    for restitution in [0.0_f64, 0.3, 0.8, 1.0] {
        for share in [0.05_f64, 0.5, 0.95] {
            // Above the surface by what the node falls in a fraction of the step, then the rest of the step into the
            // floor.
            let (start, step) = (-1.3, 0.01);
            let height = -start * share * step + 0.5 * g * (share * step).powi(2);
            let impact = start - g * share * step;
            let (mut position, mut velocity) =
                (DVec3::Y * (height + start * step - 0.5 * g * step * step), DVec3::Y * (start - g * step));
            obstacle(floor(), restitution, 0.0, Motion::Still).at(1.0, STEP).rebound(
                &mut position,
                &mut velocity,
                DVec3::Y * -g,
            );
            let energy = 0.5 * velocity.y * velocity.y + g * position.y;
            let expected = 0.5 * (restitution * impact).powi(2);
            assert!((energy - expected).abs() < 1e-14, "{restitution} {share}: {energy} {expected}");
        }
    }
}
