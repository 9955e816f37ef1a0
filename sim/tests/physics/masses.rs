//! Bodies whose nodes have different masses.

use super::support::{Noise, lattice, shape_based};
use glam::{DQuat, DVec3};
use localshape_sim::model::shape_based::ShapeBased;
use localshape_sim::rotation::{linearised, moment, torque};
use localshape_sim::{Body, Ease, Grip, Integrator, Key, Motion, Offset, State, Stepping, Surroundings, World};
use std::sync::Arc;

/// A cube with its nodes moved a little and masses from 1 to 8 kg.
fn uneven() -> Arc<Body> {
    let cube = lattice(1, 0.1);
    let mut noise = Noise(5);
    let rest = cube.rest().iter().map(|&rest| rest + noise.vector() * 0.01).collect();
    let mass = (1..=8).map(f64::from).collect();
    Arc::new(Body::builder(rest).elements(cube.elements().clone()).masses(mass).build().expect("a body"))
}

#[test]
fn momenta_and_energy_weigh_each_node_with_its_mass() {
    let body = uneven();
    let mut noise = Noise(6);
    let state = State::new(body.rest().to_vec(), body.rest().iter().map(|_| noise.vector()).collect());
    let gravity = DVec3::new(1.0, -9.8, 2.0);
    let around = Surroundings { gravity, ..Surroundings::default() };
    let stepping = Stepping::new(Integrator::default(), 1e-3);
    let found = World::new(&body, state.clone(), &shape_based(1e4, 0.0), around, stepping).diagnostics();
    let nodes = || body.mass().iter().zip(&state.position).zip(&state.velocity).map(|((&m, &p), &v)| (m, p, v));
    let momentum: DVec3 = nodes().map(|(m, _, v)| v * m).sum();
    let angular_momentum: DVec3 = nodes().map(|(m, p, v)| p.cross(v * m)).sum();
    let kinetic: f64 = nodes().map(|(m, _, v)| 0.5 * m * v.dot(v)).sum();
    let gravitational: f64 = nodes().map(|(m, p, _)| -m * gravity.dot(p)).sum();
    assert!((found.momentum - momentum).length() < 1e-13 * momentum.length());
    assert!((found.angular_momentum - angular_momentum).length() < 1e-13 * angular_momentum.length());
    assert!((found.kinetic - kinetic).abs() < 1e-13 * kinetic);
    assert!((found.gravitational - gravitational).abs() < 1e-13 * gravitational.abs());
}

/// Eqs. (17) and (18): `α = k |Σ r × R| / Σ m |R0|²`, here with every node rotated by a grip in one step.
#[test]
fn the_residual_is_the_torque_over_the_moment_of_inertia() {
    let (body, stiffness, step) = (uneven(), 1e4, 0.01);
    let axis = DVec3::new(3.0, 10.0, -4.0);
    let keys = vec![
        Key { time: 0.0, offset: Offset::default() },
        Key { time: 1.0, offset: Offset { shift: DVec3::ZERO, rotation: axis } },
    ];
    let motion = Motion::Keys { keys, ease: Ease::Linear, repeat: false };
    let grip = Grip { nodes: (0..8).collect(), from: 0.0, until: 1.0, motion };
    let around = Surroundings { grips: vec![grip], ..Surroundings::default() };
    let model = ShapeBased { passes: 1, ..shape_based(stiffness, 0.0) };
    let stepping = Stepping::new(Integrator::default(), step);
    let start = State::at_rest(body.rest().iter().map(|&rest| rest * DVec3::new(1.2, 0.9, 1.0)).collect());
    let mut world = World::new(&body, start, &model, around, stepping);
    let centred = |points: &[DVec3]| -> Vec<DVec3> {
        let centre = points.iter().sum::<DVec3>() / points.len() as f64;
        points.iter().map(|&point| point - centre).collect()
    };
    let rest = centred(body.rest());
    // The rotation of the forces in the first step, which starts from the exact one.
    let solve = |a| linearised::rotation_by_arctangent(linearised::solve(a));
    let at_rest = |world: &World| moment(&rest, centred(&world.state().position));
    let exact = localshape_sim::rotation::davenport1968::optimum(at_rest(&world), DQuat::IDENTITY);
    let first = linearised::iterate(at_rest(&world), exact, 1, solve).rotation;
    world.advance(1);
    let second = linearised::iterate(at_rest(&world), first, 1, solve).rotation;
    let inertia: f64 = body.mass().iter().zip(&rest).map(|(m, r)| m * r.dot(*r)).sum();
    let expected = stiffness * torque(glam::DMat3::from_quat(second) * at_rest(&world)).length() / inertia;
    let found = world.report(0).residual.expect("the shape model has one");
    assert!(expected > 1e-3 && (found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
}

/// `ζ = D / 2√(km)` with the mass of the lightest node, as in the cycle of which a step is a fraction.
#[cfg(feature = "scene")]
#[test]
fn a_damping_ratio_is_about_the_lightest_node() {
    let body = Body::clone(&uneven()).with_masses(vec![4.0, 2.0, 9.0, 4.0, 4.0, 4.0, 4.0, 4.0]).expect("masses");
    let damping = 2.0 * 0.3 * (50.0f64 * 2.0).sqrt();
    let json = |kind: &str| serde_json::json!({ "kind": kind, "stiffness": 50.0, "damping_ratio": 0.3 });
    for kind in ["shape-based", "mass-spring"] {
        let parameters: localshape_sim::model::ModelParameters = serde_json::from_value(json(kind)).expect("a model");
        let model = parameters.resolve(&body, None).expect("it fits");
        let text = format!("{model:?}");
        assert!(text.contains(&format!("damping: {damping:?}")), "{text}");
    }
}
