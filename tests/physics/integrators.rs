//! What each integrator does, against closed forms.

use crate::conformance::{bodies, cases};
use crate::support::{Noise, floor, free, lattice, mass_spring, shape_based, stepped};
use glam::DVec3;
use localshape::sim::body::{Dimension, State};
use localshape::sim::integrate::Integrator;
use localshape::sim::model::ElasticModel;
use localshape::sim::model::shape_based::ShapeBased;
use localshape::sim::topology::Springs;
use localshape::sim::world::{Stepping, Surroundings, World};
use std::f64::consts::TAU;

const STIFFNESS: f64 = 1e4;
const ALL: [Integrator; 3] = [Integrator::SemiImplicitEuler, Integrator::ExplicitEuler, Integrator::VelocityVerlet];

/// The scale of a breathing cube that starts scaled by `1 + a`, after each of some steps.
fn breathing(integrator: Integrator, step: f64, steps: usize, a: f64) -> Vec<f64> {
    let body = lattice(1, 0.1);
    let centre = DVec3::splat(0.05);
    let scaled = body.rest.iter().map(|&rest| centre + (rest - centre) * (1.0 + a)).collect();
    let mut world = stepped(&body, State::at_rest(scaled), &shape_based(STIFFNESS, 0.0), integrator, step);
    let scale = |world: &World| (world.state().position[7] - centre).x / 0.05 - 1.0;
    (0..steps)
        .map(|_| {
            world.advance(1);
            scale(&world)
        })
        .collect()
}

/// `x_n = a Re (1 − iωΔT)^n`: at ΔT = T/10 the amplitude grows by 1.18 a step.
#[test]
fn explicit_euler_grows_as_printed() {
    let step = TAU / STIFFNESS.sqrt() / 10.0;
    let (growth, angle) = ((1.0 + (TAU / 10.0).powi(2)).sqrt(), (TAU / 10.0).atan());
    assert!((growth - 1.18).abs() < 5e-3);
    for (n, scale) in (1..).zip(breathing(Integrator::ExplicitEuler, step, 30, 1e-4)) {
        let expected = 1e-4 * growth.powi(n) * (f64::from(n) * angle).cos();
        assert!((scale - expected).abs() < 1e-12 * growth.powi(n), "step {n}: {scale} {expected}");
    }
}

/// `x_n = a cos nθ` with `cos θ = 1 − ω²ΔT²/2`.
#[test]
fn velocity_verlet_keeps_the_amplitude_exactly() {
    let step = TAU / STIFFNESS.sqrt() / 20.0;
    let theta = (1.0 - (TAU / 20.0).powi(2) / 2.0).acos();
    for (n, scale) in (1..).zip(breathing(Integrator::VelocityVerlet, step, 1000, 0.1)) {
        let expected = 0.1 * (f64::from(n) * theta).cos();
        assert!((scale - expected).abs() < 1e-14 * f64::from(n), "step {n}: {scale} {expected}");
    }
}

/// Orders of the errors: explicit and semi-implicit Euler 1, velocity Verlet 2, also with damping.
#[test]
fn errors_fall_with_the_order_of_the_method() {
    let body = lattice(2, 0.1);
    let twisted = body.rest.iter().map(|&rest| {
        let (x, y, angle) = (rest.x - 0.1, rest.y - 0.1, 3.0 * rest.z);
        DVec3::new(x * angle.cos() - y * angle.sin(), x * angle.sin() + y * angle.cos(), rest.z * 1.2)
    });
    let start = State::at_rest(twisted.collect());
    for damping in [0.0, 20.0] {
        // Enough passes for exact rotations, so that the step is the only error.
        let model = ShapeBased { passes: 6, ..shape_based(STIFFNESS, damping) };
        let end = |integrator, steps: u32| {
            let mut world = stepped(&body, start.clone(), &model, integrator, 0.1 / f64::from(steps));
            world.advance(steps.into());
            world.state().position.clone()
        };
        let exact = end(Integrator::VelocityVerlet, 32_000);
        for (integrator, order) in ALL.into_iter().zip([1.0, 1.0, 2.0]) {
            let error = |steps| {
                let distance = |(a, b): (&DVec3, &DVec3)| a.distance(*b);
                end(integrator, steps).iter().zip(&exact).map(distance).fold(0.0, f64::max)
            };
            let measured = f64::log2(error(1000) / error(2000));
            assert!((measured - order).abs() < 0.1, "{integrator:?}, damping {damping}: {measured}");
        }
    }
}

#[test]
fn momentum_changes_by_gravity_alone() {
    let gravity = DVec3::new(1.0, -9.8, 0.5);
    for body in bodies() {
        let in_plane = body.dimension == Dimension::Plane;
        let flat = |v: DVec3| if in_plane { v.with_z(0.0) } else { v };
        let gravity = flat(gravity);
        let mass: f64 = body.mass.iter().sum();
        for (model, integrator) in cases(&body, 3.0).into_iter().flat_map(|case| {
            let model: std::rc::Rc<dyn ElasticModel> = case.model.into();
            ALL.map(|integrator| (model.clone(), integrator))
        }) {
            let mut noise = Noise(9);
            let scale = 0.02 * body.extent();
            let start = State {
                position: body.rest.iter().map(|&rest| rest + flat(noise.vector()) * scale).collect(),
                velocity: body.rest.iter().map(|_| flat(noise.vector())).collect(),
            };
            let around = Surroundings { gravity, ..Surroundings::default() };
            let mut world = World::new(&body, start, model.as_ref(), around, Stepping { integrator, step: 1e-4 });
            let before = world.snapshot().diagnostics.momentum;
            world.advance(200);
            let drift = world.snapshot().diagnostics.momentum - before - gravity * mass * 0.02;
            assert!(drift.length() < 1e-10 * mass, "{integrator:?} {model:?}: {drift}");
        }
    }
}

/// A floor without friction pushes upwards alone: the other momenta stay to round-off while the body bounces on it.
#[test]
fn contact_changes_momentum_along_its_normal_alone() {
    let body = lattice(2, 0.1);
    let shape = ShapeBased { passes: 6, ..shape_based(STIFFNESS, 0.0) };
    let spring = mass_spring(&body, STIFFNESS, 20.0, Springs::EdgesOneDiagonal);
    for model in [&shape as &dyn ElasticModel, &spring] {
        for integrator in [Integrator::SemiImplicitEuler, Integrator::VelocityVerlet] {
            let mut noise = Noise(6);
            let start = State {
                position: body.rest.iter().map(|&rest| rest + noise.vector() * 0.004 + DVec3::Y * 0.01).collect(),
                velocity: body.rest.iter().map(|_| noise.vector() * 0.1 + DVec3::new(0.5, -2.0, 0.2)).collect(),
            };
            let around = Surroundings {
                gravity: DVec3::new(0.0, -9.8, 0.0),
                obstacles: vec![floor(0.5, 0.0)],
                ..Surroundings::default()
            };
            let mut world = World::new(&body, start, model, around, Stepping { integrator, step: 2e-4 });
            let before = world.snapshot().diagnostics;
            world.advance(3000);
            let after = world.snapshot().diagnostics;
            let drift = after.momentum - before.momentum;
            assert!(drift.x.abs() + drift.z.abs() < 1e-10, "{integrator:?} {model:?}: {drift}");
            assert!(after.momentum.y > before.momentum.y + 10.0, "it has bounced: {drift}");
        }
    }
}

/// Nodes moved by an obstacle make what velocity Verlet remembers worthless: the body must bounce like the others.
#[test]
fn rebounds_are_alike_with_every_stable_method() {
    let body = lattice(1, 0.1);
    let height = |integrator| {
        let around = Surroundings {
            gravity: DVec3::new(0.0, -9.8, 0.0),
            obstacles: vec![floor(0.5, 0.0)],
            ..Surroundings::default()
        };
        let start = State::at_rest(body.rest.iter().map(|&rest| rest + DVec3::Y).collect());
        let stepping = Stepping { integrator, step: 2e-5 };
        let mut world = World::new(&body, start, &shape_based(1e5, 0.0), around, stepping);
        world.advance(35_000);
        world.state().position.iter().map(|p| p.y).sum::<f64>() / 8.0
    };
    let [one, other] = [Integrator::SemiImplicitEuler, Integrator::VelocityVerlet].map(height);
    assert!((one - other).abs() < 5e-3, "{one} {other}");
}

/// The energy of an undamped motion swings with the step and does not drift with the symplectic methods.
#[test]
fn energy_drifts_with_explicit_euler_alone() {
    let body = lattice(2, 0.1);
    let mut noise = Noise(3);
    let start = State::at_rest(body.rest.iter().map(|&rest| rest + noise.vector() * 0.01).collect());
    let model = ShapeBased { passes: 4, ..shape_based(STIFFNESS, 0.0) };
    let step = TAU / STIFFNESS.sqrt() / 100.0;
    let energy = |world: &World| {
        let d = world.snapshot().diagnostics;
        d.kinetic + d.elastic
    };
    let before = energy(&free(&body, start.clone(), &model, step));
    for (integrator, [least, most]) in ALL.into_iter().zip([[0.9, 1.1], [50.0, f64::INFINITY], [0.98, 1.02]]) {
        let mut world = stepped(&body, start.clone(), &model, integrator, step);
        world.advance(2000);
        let ratio = energy(&world) / before;
        assert!((least..=most).contains(&ratio), "{integrator:?}: {ratio}");
    }
}
