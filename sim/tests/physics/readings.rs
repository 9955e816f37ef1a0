//! The effect of each reading of the paper.

use super::support::{free, lattice, shape_based};
use glam::DVec3;
use localshape_sim::model::shape_based::{DampingReading, RotationReading, ShapeBased};
use localshape_sim::{Body, State};

fn spinning(body: &Body, spin: DVec3) -> State {
    let centre = body.rest().iter().sum::<DVec3>() / body.len() as f64;
    let velocity = body.rest().iter().map(|&rest| spin.cross(rest - centre)).collect();
    State::new(body.rest().to_vec(), velocity)
}

/// One free element. As printed, its rotation decays as `exp(−D t/m)`; with damping of deformation it persists.
#[test]
fn damping_as_printed_brakes_a_rigid_spin_and_damping_of_deformation_does_not() {
    let body = lattice(1, 0.1);
    let (damping, step, spin) = (2.0, 1e-4, DVec3::new(0.0, 3.0, 0.0));
    let momentum = |reading| {
        let model = ShapeBased { damping_of: reading, passes: 4, ..shape_based(1e4, damping) };
        let mut world = free(&body, spinning(&body, spin), &model, step);
        let before = world.snapshot().diagnostics.angular_momentum;
        world.advance(5000);
        world.snapshot().diagnostics.angular_momentum.y / before.y
    };
    let printed = momentum(DampingReading::RelativeMotion);
    assert!((printed - (-damping * 0.5_f64).exp()).abs() < 1e-3, "{printed}");
    let deformation = momentum(DampingReading::Deformation);
    assert!((deformation - 1.0).abs() < 1e-11, "{deformation}");
}

#[test]
fn damping_of_deformation_still_brings_deformation_to_rest() {
    let body = lattice(2, 0.1);
    let mut start = spinning(&body, DVec3::new(0.0, 3.0, 0.0));
    start.position.iter_mut().for_each(|p| *p *= DVec3::new(1.1, 0.9, 1.0));
    let model = ShapeBased { damping_of: DampingReading::Deformation, passes: 4, ..shape_based(1e4, 40.0) };
    let mut world = free(&body, start, &model, 1e-4);
    let before = world.snapshot().diagnostics;
    world.advance(20_000);
    let after = world.snapshot().diagnostics;
    // The remaining error is the extension by the centrifugal force: m ω² r / k.
    assert!(after.elastic < 1e-3 * before.elastic, "{} {}", after.elastic, before.elastic);
    assert!((after.angular_momentum - before.angular_momentum).length() < 1e-10);
}

/// With the angle read as `|w|`, one pass for a fast rotation overshoots every time, which adds energy.
#[test]
fn the_length_as_angle_leaves_more_error_than_the_arctangent() {
    let body = lattice(1, 0.1);
    let residual = |rotation| {
        let model = ShapeBased { rotation, passes: 1, ..shape_based(1e4, 0.0) };
        let mut world = free(&body, spinning(&body, DVec3::new(0.0, 30.0, 5.0)), &model, 2e-3);
        (0..200).fold(0.0, |most: f64, _| {
            world.advance(1);
            most.max(world.snapshot().diagnostics.residual)
        })
    };
    let [arctangent, length] = [RotationReading::Arctangent, RotationReading::VectorLength].map(residual);
    assert!(length > 10.0 * arctangent, "{arctangent:e} {length:e}");
}
