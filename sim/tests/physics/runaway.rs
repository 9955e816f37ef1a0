//! High speed with an external cause is not a divergence: a small, soft body falls for long, is hit by a fast plate,
//! and is dragged by a fast grip. By itself it would never move faster than some metres per second.

use super::support::{lattice, shape_based};
use glam::DVec3;
use localshape_sim::{
    Ease, Grip, Integrator, Key, Motion, Obstacle, Offset, Shape, State, Status, Stepping, Surroundings, World,
};

/// The fastest node (m/s) of a cube of 1 cm with a cycle of 2 s, after some seconds.
fn fastest(around: Surroundings, seconds: f64) -> f64 {
    let body = lattice(1, 0.01);
    let step = 0.001;
    let stepping = Stepping::new(Integrator::default(), step);
    let start = State::at_rest(body.rest().to_vec());
    let mut world = World::new(&body, start, &shape_based(10.0, 0.0), around, stepping);
    world.advance((seconds / step).round() as u64);
    assert_eq!(world.status(), Status::Ok);
    world.state().velocity.iter().map(|v| v.length()).fold(0.0, f64::max)
}

/// A short path in one step: 200 m/s.
fn path() -> Motion {
    let keys = vec![
        Key { time: 0.1, offset: Offset::default() },
        Key { time: 0.11, offset: Offset { shift: DVec3::X * 2.0, rotation: DVec3::ZERO } },
    ];
    Motion::Keys { keys, ease: Ease::Linear, repeat: false }
}

#[test]
fn a_body_may_fall_for_long() {
    let around = Surroundings { gravity: DVec3::new(0.0, -9.8, 0.0), ..Surroundings::default() };
    assert!((fastest(around, 20.0) - 196.0).abs() < 1e-6);
}

#[test]
fn a_body_may_be_hit_by_a_fast_plate() {
    let shape = Shape::Plate { point: DVec3::X * -0.5, normal: DVec3::X };
    let plate = Obstacle {
        shape,
        motion: path(),
        pivot: DVec3::ZERO,
        restitution: 0.5,
        friction: 0.0,
        friction_of: Default::default(),
    };
    assert!(fastest(Surroundings { obstacles: vec![plate], ..Surroundings::default() }, 0.108) > 250.0);
}

#[test]
fn a_body_may_be_dragged_by_a_fast_hand() {
    let grip = Grip { nodes: (0..8).collect(), from: 0.0, until: 0.5, motion: path() };
    assert!(fastest(Surroundings { grips: vec![grip], ..Surroundings::default() }, 0.108) > 199.0);
}
