//! Fig. 4(b): 3×3×3 cubes hit the floor with the speed of a fall of 5 m.

use crate::support::{floor, lattice, mass_spring, shape_based, world};
use glam::{DQuat, DVec3};
use localshape::sim::body::State;
use localshape::sim::model::ElasticModel;
use localshape::sim::topology::Springs;
use localshape::sim::world::Surroundings;
use std::f64::consts::TAU;

fn fall(model: &dyn ElasticModel, step: f64, seconds: f64) -> localshape::sim::Snapshot {
    let body = lattice(3, 0.1);
    let tilt = DQuat::from_axis_angle(DVec3::new(1.0, 0.0, 1.0).normalize(), 0.028_284);
    let mut position: Vec<_> = body.rest.iter().map(|&rest| tilt * (rest - DVec3::splat(0.15))).collect();
    let lowest = position.iter().fold(f64::INFINITY, |lowest, p| lowest.min(p.y));
    position.iter_mut().for_each(|p| p.y -= lowest);
    let velocity = vec![DVec3::new(0.0, -9.899_495, 0.0); body.len()];
    let around = Surroundings { gravity: DVec3::new(0.0, -9.8, 0.0), obstacles: vec![floor(0.5, 0.3)] };
    let mut world = world(&body, State { position, velocity }, model, step, around);
    world.advance((seconds / step).round() as u64);
    world.snapshot()
}

#[test]
fn springs_turn_over_exactly_the_lowest_nine_cubes_and_the_shape_model_none() {
    let body = lattice(3, 0.1);
    let (k, damping) = (1e4, 2.0 * 0.1 * f64::sqrt(1e4));
    let step = TAU / f64::sqrt(k) / 50.0;
    let shape = fall(&shape_based(k, damping), step, 3.0);
    assert_eq!(shape.diagnostics.turned_over, 0);
    assert!((shape.diagnostics.volume_ratio - 0.98).abs() < 0.005, "{}", shape.diagnostics.volume_ratio);
    // Rung out, it sags under its own weight: volume 0.9826, RMS error 0.022 sides.
    let sagging = fall(&shape_based(k, damping), step, 6.0).diagnostics;
    assert!((sagging.volume_ratio - 0.9826).abs() < 2e-4, "{}", sagging.volume_ratio);
    assert!((sagging.shape_error - 0.0022).abs() < 5e-5, "{}", sagging.shape_error);
    let spring = fall(&mass_spring(&body, k, damping, Springs::EdgesOneDiagonal), step, 3.0);
    let lowest: Vec<_> = (0..27).filter(|cube| spring.turned_over[*cube]).collect();
    assert_eq!(lowest, (0..27).filter(|cube| cube / 3 % 3 == 0).collect::<Vec<_>>());
    // An independent implementation found 0.338. How the folded layer settles depends on the direction of the tilt:
    // ours gives 0.3415 for a tilt about (1, 0, 1) and 0.3310 about (1, 0, −1).
    assert!((spring.diagnostics.volume_ratio - 0.338).abs() < 0.005, "{}", spring.diagnostics.volume_ratio);
}

#[test]
fn at_ten_times_the_stiffness_nothing_turns_over() {
    let body = lattice(3, 0.1);
    let (k, damping) = (1e5, 2.0 * 0.1 * f64::sqrt(1e5));
    let step = TAU / f64::sqrt(k) / 50.0;
    assert_eq!(fall(&shape_based(k, damping), step, 1.0).diagnostics.turned_over, 0);
    assert_eq!(fall(&mass_spring(&body, k, damping, Springs::EdgesOneDiagonal), step, 1.0).diagnostics.turned_over, 0);
}

#[test]
fn a_step_beyond_the_limit_of_stability_is_a_result_with_a_time() {
    let body = lattice(3, 0.1);
    let spring = mass_spring(&body, 1e4, 20.0, Springs::EdgesOneDiagonal);
    let end = fall(&spring, 0.02, 3.0);
    let localshape::sim::snapshot::Status::Diverged(at) = end.status else { panic!("it must diverge") };
    assert!(at.step > 1 && (at.time - at.step as f64 * 0.02).abs() < 1e-12 && at.element.is_some(), "{at:?}");
    assert!(end.position.iter().chain(&end.velocity).all(|v| v.is_finite()));
    // What is left can be drawn: it lies within some hundred sides.
    assert!(end.position.iter().all(|p| p.length() < 100.0));
}
