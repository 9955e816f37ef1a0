//! Motions whose result is known in closed form.

use super::support::{Noise, Remembering, floor, free, lattice, mass_spring, shape_based, world};
use glam::DVec3;
use localshape_sim::{Body, FrictionOf, IndexLists, Obstacle, Springs, State, Surroundings};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A free element scaled by `1 + a` oscillates at exactly `ω = √(k/m)`, in steps as `x_n = a cos((n + ½) θ) / cos(θ/2)`
/// with `cos θ = 1 − ω² ΔT²/2`.
#[test]
fn a_free_element_breathes_at_exactly_its_frequency() {
    let (body, amplitude, stiffness) = (lattice(1, 0.1), 0.2, 1e4);
    let step = TAU / f64::sqrt(stiffness) / 50.0;
    let centre = DVec3::splat(0.05);
    let scaled = body.rest().iter().map(|&rest| centre + (rest - centre) * (1.0 + amplitude)).collect();
    let mut world = free(&body, State::at_rest(scaled), &shape_based(stiffness, 0.0), step);
    let theta = (1.0 - stiffness * step * step / 2.0).acos();
    for n in 1..=500 {
        world.advance(1);
        let expected = amplitude * ((f64::from(n) + 0.5) * theta).cos() / (theta / 2.0).cos();
        for (&now, &rest) in world.state().position.iter().zip(body.rest()) {
            let error = (now - centre) - (rest - centre) * (1.0 + expected);
            assert!(error.length() < 2e-15 * f64::from(n), "step {n}: {error}");
        }
    }
}

/// `y_n = y_0 − g ΔT² n (n + 1) / 2`.
#[test]
fn a_body_falls_as_the_sum_of_its_steps() {
    let (body, step, g) = (lattice(2, 0.1), 1e-3, 9.8);
    let around = Surroundings { gravity: DVec3::new(0.0, -g, 0.0), ..Surroundings::default() };
    for model in [
        &shape_based(1e4, 20.0) as &dyn localshape_sim::model::ElasticModel,
        &mass_spring(&body, 1e4, 20.0, Springs::All),
    ] {
        let mut world = world(&body, State::at_rest(body.rest().to_vec()), model, step, around.clone());
        world.advance(1000);
        let fall = g * step * step * 1000.0 * 1001.0 / 2.0;
        for (now, rest) in world.state().position.iter().zip(body.rest()) {
            assert!((rest.y - now.y - fall).abs() < 1e-12, "{} {}", rest.y - now.y, fall);
        }
    }
}

/// Two nodes with a very soft spring: the rebound height is `e² h` up to O(ΔT).
#[test]
fn rebounds_reach_the_restitution_squared_of_the_height() {
    let mut elements = IndexLists::default();
    elements.push(&[0, 1]);
    let rest = vec![DVec3::ZERO, DVec3::X];
    let body = Arc::new(Body::builder(rest).elements(elements).build().expect("a body"));
    let around = Surroundings {
        gravity: DVec3::new(0.0, -9.8, 0.0),
        obstacles: vec![floor(0.5, 0.0)],
        ..Surroundings::default()
    };
    let start = State::at_rest(vec![DVec3::Y, DVec3::new(1.0, 1.0, 0.0)]);
    let mut world = world(&body, start, &shape_based(1.0, 0.0), 1e-4, around);
    let mut peaks = Vec::new();
    let (mut before, mut rising) = (1.0, false);
    while peaks.len() < 2 {
        world.advance(1);
        let height = world.state().position[0].y;
        if rising && height < before {
            peaks.push(before);
        }
        rising = height >= before;
        before = height;
    }
    assert!((peaks[0] - 0.25).abs() < 5e-3 && (peaks[1] - 0.0625).abs() < 2e-3, "{peaks:?}");
}

#[test]
fn friction_brakes_by_the_impulse_of_the_rebound_and_never_reverses() {
    for (friction, kept) in [(0.0, 3.0), (0.2, 3.0 - 0.2 * 1.5 * 2.0), (10.0, 0.0)] {
        let (mut position, mut velocity) = (DVec3::new(0.0, -0.01, 0.0), DVec3::new(0.0, -2.0, 3.0));
        let paper = Obstacle { friction_of: FrictionOf::Velocity, ..floor(0.5, friction) };
        paper.at(0.0, 1.0).rebound(&mut position, &mut velocity, DVec3::ZERO);
        assert!((position - DVec3::new(0.0, 0.005, 0.0)).length() < 1e-16);
        assert!((velocity - DVec3::new(0.0, 1.0, kept)).length() < 1e-14, "{friction}: {velocity}");
    }
    // A node that is moving outward already is moved out and keeps its velocity.
    let (mut position, mut velocity) = (DVec3::new(0.0, -0.01, 0.0), DVec3::new(1.0, 2.0, 3.0));
    floor(0.5, 0.3).at(0.0, 1.0).rebound(&mut position, &mut velocity, DVec3::ZERO);
    assert!((position.y - 0.005).abs() < 1e-17);
    assert_eq!(velocity, DVec3::new(1.0, 2.0, 3.0));
}

#[test]
fn momentum_and_angular_momentum_stay_to_round_off() {
    let body = lattice(3, 0.1);
    let mut noise = Noise(7);
    let position: Vec<_> = body.rest().iter().map(|&rest| rest + noise.vector() * 0.02).collect();
    let velocity = body.rest().iter().map(|_| noise.vector()).collect();
    let start = State::new(position, velocity);
    let step = TAU / 100.0 / 50.0;
    let spring = mass_spring(&body, 1e4, 0.0, Springs::EdgesOneDiagonal);
    // After the paper's two passes a small torque remains; angular momentum is conserved only with exact rotations.
    let shape = localshape_sim::model::shape_based::ShapeBased { passes: 6, ..shape_based(1e4, 0.0) };
    for model in [&shape as &dyn localshape_sim::model::ElasticModel, &spring] {
        let mut world = free(&body, start.clone(), model, step);
        let before = world.snapshot().diagnostics;
        world.advance(1000);
        let after = world.snapshot().diagnostics;
        // Internal impulses in that time sum to about 4e4 kg m²/s; 1e-10 is ten times their round-off.
        let drift = (after.momentum - before.momentum).length();
        assert!(drift < 1e-10, "{model:?}: {drift:e}");
        let drift = (after.angular_momentum - before.angular_momentum).length();
        assert!(drift < 1e-10, "{model:?}: {drift:e}");
    }
}

/// The free 3×3×3 lattice's highest frequency, by power iteration on the force: 2.7585 ω for the shape model,
/// 3.099, 3.087 and 1.848 ω for springs.
#[test]
fn the_highest_frequencies_are_those_of_an_independent_implementation() {
    let body = lattice(3, 0.1);
    let k = 1e4;
    let spring = |named| Box::new(mass_spring(&body, k, 0.0, named)) as Box<dyn localshape_sim::model::ElasticModel>;
    let cases = [
        (Box::new(localshape_sim::model::shape_based::ShapeBased { passes: 4, ..shape_based(k, 0.0) }) as _, 2.7585),
        (spring(Springs::EdgesFaceDiagonals), 3.099),
        (spring(Springs::EdgesOneDiagonal), 3.087),
        (spring(Springs::EdgesBodyDiagonals), 2.686),
        (spring(Springs::Edges), 1.848),
        (spring(Springs::All), 3.6795),
    ];
    for (model, expected) in cases {
        let mut noise = Noise(3);
        let mut mode: Vec<_> = body.rest().iter().map(|_| noise.vector()).collect();
        let mut worker = Remembering::new(&body, model.as_ref(), &State::at_rest(body.rest().to_vec()));
        let mut squared = 0.0;
        for _ in 0..1500 {
            let h = 1e-7;
            let state = State::at_rest(body.rest().iter().zip(&mode).map(|(&rest, &mode)| rest + mode * h).collect());
            let forces = worker.follow(&state);
            let length = forces.iter().map(|f| f.length_squared()).sum::<f64>().sqrt();
            squared = length / h;
            mode = forces.iter().map(|f| -*f / length).collect();
        }
        let ratio = f64::sqrt(squared / k);
        assert!((ratio - expected).abs() < 1e-3, "{ratio} instead of {expected}");
    }
}

/// Halving the step halves the error: semi-implicit Euler is of order 1.
#[test]
fn the_error_of_semi_implicit_euler_falls_with_the_step() {
    let body = lattice(2, 0.1);
    let twisted = body.rest().iter().map(|&rest| {
        let angle = 3.0 * rest.z;
        let (x, y) = (rest.x - 0.1, rest.y - 0.1);
        DVec3::new(x * angle.cos() - y * angle.sin(), x * angle.sin() + y * angle.cos(), rest.z * 1.2)
    });
    let start = State::at_rest(twisted.collect());
    // Enough passes for exact rotations, so that the step is the only error.
    let model = localshape_sim::model::shape_based::ShapeBased { passes: 6, ..shape_based(1e4, 0.0) };
    let end = |steps: u32| {
        let mut world = free(&body, start.clone(), &model, 0.2 / f64::from(steps));
        world.advance(steps.into());
        world.state().position.clone()
    };
    let exact = end(64_000);
    let error = |steps| {
        let distance = |(a, b): (&DVec3, &DVec3)| a.distance(*b);
        end(steps).iter().zip(&exact).map(distance).fold(0.0, f64::max)
    };
    let order = f64::log2(error(500) / error(1000));
    assert!((order - 1.0).abs() < 0.1, "{order}");
}

/// Undamped, semi-implicit Euler is stable as long as `ω_max ΔT < 2`: 2.7585 ω for the free 3×3×3 lattice.
#[test]
fn a_step_is_stable_up_to_two_over_the_highest_frequency() {
    let body = lattice(3, 0.1);
    let stiffness = 1e4;
    let model = localshape_sim::model::shape_based::ShapeBased { passes: 4, ..shape_based(stiffness, 0.0) };
    let growth = |part_of_limit: f64| {
        let step = part_of_limit * 2.0 / (2.7585 * f64::sqrt(stiffness));
        let mut noise = Noise(4);
        let position = body.rest().iter().map(|&rest| rest + noise.vector() * 1e-7).collect();
        let mut world = free(&body, State::at_rest(position), &model, step);
        let before = world.snapshot().diagnostics.shape_error;
        world.advance(300);
        world.snapshot().diagnostics.shape_error / before
    };
    assert!(growth(0.98) < 10.0, "{}", growth(0.98));
    assert!(growth(1.02) > 1e3, "{}", growth(1.02));
}
