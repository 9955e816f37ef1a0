//! Each integrator compared with closed forms.

use super::conformance::{bodies, cases};
use super::support::{Noise, body, floor, free, lattice, mass_spring, shape_based, stepped};
use glam::DVec3;
use localshape_sim::model::ElasticModel;
use localshape_sim::model::mass_spring::MassSpring;
use localshape_sim::model::shape_based::{RotationReading, ShapeBased};
use localshape_sim::{
    Body, Dimension, Ease, Grip, Integrator, Kernel, Key, Motion, Offset, Springs, State, Stepping, Surroundings, World,
};
use std::f64::consts::TAU;
use std::sync::Arc;

const STIFFNESS: f64 = 1e4;
const ALL: [Integrator; 3] = [Integrator::SemiImplicitEuler, Integrator::ExplicitEuler, Integrator::VelocityVerlet];
/// The methods of higher order.
const HIGH: [Integrator; 2] = [Integrator::Pefrl, Integrator::RungeKutta];

/// The scale of an oscillating cube that starts scaled by `1 + a`, after each of some steps.
fn breathing(integrator: Integrator, step: f64, steps: usize, a: f64) -> Vec<f64> {
    let body = lattice(1, 0.1);
    let centre = DVec3::splat(0.05);
    let scaled = body.rest().iter().map(|&rest| centre + (rest - centre) * (1.0 + a)).collect();
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
    let twisted = body.rest().iter().map(|&rest| {
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

/// 27 cubes, twisted and stretched.
fn twisted(body: &Body) -> State {
    let twisted = body.rest().iter().map(|&rest| {
        let (x, y, angle) = (rest.x - 0.15, rest.y - 0.15, 2.0 * rest.z);
        DVec3::new(x * angle.cos() - y * angle.sin(), x * angle.sin() + y * angle.cos(), rest.z * 1.2)
    });
    State::at_rest(twisted.collect())
}

/// A free lattice of 27 cubes, k/m = 1e4, twisted and stretched, for 0.2 s. Both are of order 4, and Runge–Kutta with
/// damping, too. The references have small steps.
#[test]
fn methods_of_high_order_have_their_orders() {
    let body = lattice(3, 0.1);
    let start = twisted(&body);
    let end = |integrator, damping, steps: u32| {
        let model = ShapeBased { rotation: RotationReading::Robust, ..shape_based(STIFFNESS, damping) };
        let mut world = stepped(&body, start.clone(), &model, integrator, 0.2 / f64::from(steps));
        world.advance(steps.into());
        world.state().position.clone()
    };
    let distance =
        |ones: &[DVec3], others: &[DVec3]| ones.iter().zip(others).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    let exact = [end(Integrator::Pefrl, 0.0, 2400), end(Integrator::RungeKutta, 20.0, 6000)];
    let cases = [
        (Integrator::Pefrl, 0.0, 60, 4.0, 0.1),
        (Integrator::RungeKutta, 0.0, 300, 4.0, 0.1),
        (Integrator::RungeKutta, 20.0, 300, 4.0, 0.1),
    ];
    for (integrator, damping, steps, order, margin) in cases {
        let error = |steps| distance(&end(integrator, damping, steps), &exact[usize::from(damping > 0.0)]);
        let measured = f64::log2(error(steps) / error(2 * steps));
        assert!((measured - order).abs() < margin, "{integrator:?}, damping {damping}: {measured}");
    }
}

/// A hundred steps, and back with reversed velocities.
#[test]
fn symmetric_methods_are_reversible() {
    let body = lattice(2, 0.1);
    let mut noise = Noise(21);
    let model = ShapeBased { rotation: RotationReading::Robust, ..shape_based(STIFFNESS, 0.0) };
    let start = State::new(
        body.rest().iter().map(|&rest| rest + noise.vector() * 0.01).collect(),
        body.rest().iter().map(|_| noise.vector()).collect(),
    );
    for integrator in [Integrator::VelocityVerlet, Integrator::Pefrl] {
        let advanced = |state: State| {
            let mut world = stepped(&body, state, &model, integrator, 1e-3);
            world.advance(100);
            let State { position, velocity, .. } = world.state();
            State::new(position.clone(), velocity.iter().map(|&v| -v).collect())
        };
        let back = advanced(advanced(start.clone()));
        let off = back.position.iter().zip(&start.position).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(off < 1e-12, "{integrator:?}: {off:e}");
    }
}

/// For a million steps, or 20 000 of the reference code: the mean energy of the second half is that of the first, and
/// angular momentum is conserved.
#[test]
fn symplectic_methods_keep_energy_and_angular_momentum_without_a_trend() {
    let body = lattice(2, 0.1);
    let mut noise = Noise(17);
    let start = State::new(
        body.rest().iter().map(|&rest| rest + noise.vector() * 0.005).collect(),
        body.rest().iter().map(|&rest| DVec3::new(3.0, 10.0, -5.0).cross(rest - 0.1)).collect(),
    );
    let model = ShapeBased { rotation: RotationReading::Robust, ..shape_based(STIFFNESS, 0.0) };
    let step = TAU / STIFFNESS.sqrt() / 50.0;
    for (integrator, kernel, steps, bound) in [
        (Integrator::SemiImplicitEuler, Kernel::Fast, 1_000_000, 0.2),
        (Integrator::VelocityVerlet, Kernel::Fast, 1_000_000, 0.01),
        (Integrator::Pefrl, Kernel::Fast, 1_000_000, 1e-5),
        (Integrator::SemiImplicitEuler, Kernel::Reference, 20_000, 0.2),
        (Integrator::VelocityVerlet, Kernel::Reference, 20_000, 0.01),
    ] {
        let stepping = Stepping { kernel, ..Stepping::new(integrator, step) };
        let mut world = World::new(&body, start.clone(), &model, Surroundings::default(), stepping);
        let first = world.diagnostics();
        let mut halves = [0.0; 2];
        for at in 0..400 {
            world.advance(steps / 400);
            let now = world.diagnostics();
            let energy = (now.kinetic + now.elastic) / (first.kinetic + first.elastic) - 1.0;
            assert!(energy.abs() < bound, "{integrator:?}: {energy:e}");
            halves[at / 200] += energy / 200.0;
            let turned = (now.angular_momentum - first.angular_momentum).length() / first.angular_momentum.length();
            assert!(turned < 1e-11, "{integrator:?} {at}: {turned:e}");
        }
        let trend = (halves[1] - halves[0]).abs();
        assert!(trend < 0.02 * bound, "{integrator:?}: {halves:?}");
    }
}

/// The error of the adaptive method falls with its tolerance, from which it follows, also with damping and with rebounds,
/// and its steps end where they should.
#[test]
fn the_adaptive_method_keeps_its_tolerance() {
    let body = lattice(2, 0.1);
    for (damping, height) in [(0.0, None), (20.0, None), (20.0, Some(0.02))] {
        let model = ShapeBased { rotation: RotationReading::Robust, ..shape_based(STIFFNESS, damping) };
        let mut start = twisted(&body);
        let mut around = Surroundings::default();
        if let Some(height) = height {
            let turned = |at: &mut DVec3| *at = DVec3::new(at.x + 0.3 * at.y, at.y - 0.3 * at.x, at.z);
            start = State::new(body.rest().to_vec(), vec![DVec3::Y * -1.0; body.len()]);
            start.position.iter_mut().for_each(turned);
            let lowest = start.position.iter().map(|at| at.y).fold(f64::INFINITY, f64::min);
            start.position.iter_mut().for_each(|at| at.y += height - lowest);
            around = Surroundings { gravity: DVec3::Y * -9.8, obstacles: vec![floor(0.5, 0.0)], ..around };
        }
        let end = |tolerance| {
            let stepping = Stepping { tolerance, ..Stepping::new(Integrator::DormandPrince, 0.03) };
            let mut world = World::new(&body, start.clone(), &model, around.clone(), stepping);
            world.advance(1);
            world.state().position.clone()
        };
        let exact = end(1e-11);
        // The errors of some hundred substeps add up at most.
        for tolerance in [1e-5, 1e-7, 1e-9] {
            let bound = 100.0 * tolerance;
            let far = end(tolerance).iter().zip(&exact).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
            let off = far / body.extent();
            assert!(off < bound, "damping {damping}, {height:?}, tolerance {tolerance:e}: {off:e}");
        }
    }
}

/// Two nodes that a spring joins, whose stiffness (N/m) and damping (N s/m) are given; 1 kg each unless `heavy`, with which the second
/// one hardly moves.
fn pair(rest: [DVec3; 2], heavy: bool, stiffness: f64, damping: f64) -> (Arc<Body>, MassSpring) {
    let elements = [&[0, 1][..]].into_iter().collect();
    let mass = vec![1.0, if heavy { 1e12 } else { 1.0 }];
    let body = Arc::new(Body::builder(rest.to_vec()).elements(elements).masses(mass).build().expect("a body"));
    (body, MassSpring { stiffness, damping, springs: [[0, 1]].into(), breaks_at: None })
}

/// Nodes that bounce without loss keep their energy with a coarse tolerance, too: the acceleration of a rebound is that of its substep.
#[test]
fn rebounds_of_the_adaptive_method_keep_the_energy() {
    let (body, model) = pair([DVec3::ZERO, DVec3::X], false, 1e-9, 0.0);
    let start = State::at_rest(body.rest().iter().map(|&at| at + DVec3::Y * 0.01).collect());
    let around = Surroundings { gravity: DVec3::Y * -9.8, obstacles: vec![floor(1.0, 0.0)], ..Surroundings::default() };
    let stepping = Stepping { tolerance: 1e-3, ..Stepping::new(Integrator::DormandPrince, 0.2) };
    let mut world = World::new(&body, start, &model, around, stepping);
    for _ in 0..10 {
        world.advance(1);
        let State { position, velocity, .. } = world.state();
        let energy = 0.5 * velocity[0].length_squared() + 9.8 * position[0].y;
        assert!((energy / 0.098 - 1.0).abs() < 1e-9, "{energy}");
    }
}

/// A damped oscillation that is interrupted by rebounds, against its closed form between them.
#[test]
fn rebounds_of_the_adaptive_method_have_its_tolerance() {
    let (rate, decay, restitution, middle) = (20.0_f64, 3.0_f64, 0.8, 0.05);
    let (body, model) = pair([DVec3::Y * middle, DVec3::Y], true, rate * rate, 2.0 * decay);
    let start = State::new(body.rest().to_vec(), vec![DVec3::Y * -4.0, DVec3::ZERO]);
    let around = Surroundings { obstacles: vec![floor(restitution, 0.0)], ..Surroundings::default() };
    let stepping = Stepping { tolerance: 1e-9, ..Stepping::new(Integrator::DormandPrince, 0.01) };
    let mut world = World::new(&body, start, &model, around, stepping);
    // Height above the middle and speed after a time.
    let slow = (rate * rate - decay * decay).sqrt();
    let free = |[at, speed]: [f64; 2], time: f64| {
        let (sine, cosine) = (slow * time).sin_cos();
        let other = (speed + decay * at) / slow;
        let [out, turned] = [at * cosine + other * sine, other * cosine - at * sine];
        [out, slow * turned - decay * out].map(|one| one * (-decay * time).exp())
    };
    let (mut from, mut now, mut bounces) = (0.0, [0.0, -4.0], 0);
    for step in 1..=40 {
        let end = 0.01 * f64::from(step);
        while free(now, end - from)[0] < -middle {
            let (mut above, mut below) = (0.0, end - from);
            for _ in 0..60 {
                let time = 0.5 * (above + below);
                if free(now, time)[0] < -middle { below = time } else { above = time }
            }
            from += above;
            now = [-middle, -restitution * free(now, above)[1]];
            bounces += 1;
        }
        world.advance(1);
        let [out, speed] = free(now, end - from);
        let state = world.state();
        let off = (state.position[0].y - middle - out).abs().max((state.velocity[0].y - speed).abs() / rate);
        assert!(off < 5.0 * 1e-9, "step {step}: {off:e} after {bounces} rebounds");
    }
    assert!(bounces >= 2, "{bounces}");
}

/// Backward Euler is of first order, and stable for any step: where a deformed body is free with steps of many
/// cycles, its energy does not grow.
#[test]
fn the_implicit_method_is_stable_for_any_step() {
    let body = lattice(2, 0.1);
    let cycle = TAU / STIFFNESS.sqrt();
    for damping in [0.0, 20.0] {
        let model = ShapeBased { rotation: RotationReading::Robust, ..shape_based(STIFFNESS, damping) };
        let end = |integrator, steps: u32| {
            let mut world = stepped(&body, twisted(&body), &model, integrator, 0.02 / f64::from(steps));
            world.advance(steps.into());
            world.state().position.clone()
        };
        let exact = end(Integrator::RungeKutta, 400);
        let error = |steps| {
            let ends = end(Integrator::BackwardEuler, steps);
            ends.iter().zip(&exact).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
        };
        let order = f64::log2(error(3200) / error(6400));
        assert!((order - 1.0).abs() < 0.1, "damping {damping}: {order}");
        for cycles in [0.5, 3.0, 30.0] {
            let mut noise = Noise(7);
            let start = State::new(
                body.rest().iter().map(|&rest| rest + noise.vector() * 0.02).collect(),
                body.rest().iter().map(|_| noise.vector()).collect(),
            );
            let mut world = stepped(&body, start, &model, Integrator::BackwardEuler, cycles * cycle);
            let energy = |world: &World| {
                let now = world.diagnostics();
                now.kinetic + now.elastic
            };
            let first = energy(&world);
            let mut before = first;
            for step in 0..50 {
                world.advance(1);
                let now = energy(&world);
                assert!(
                    now <= before + 1e-6 * first,
                    "damping {damping}, {cycles} cycles, step {step}: {before} {now}"
                );
                before = now;
            }
        }
    }
}

#[test]
fn momentum_changes_by_gravity_alone() {
    let gravity = DVec3::new(1.0, -9.8, 0.5);
    for body in bodies() {
        let in_plane = body.dimension() == Dimension::Plane;
        let flat = |v: DVec3| if in_plane { v.with_z(0.0) } else { v };
        let gravity = flat(gravity);
        let mass: f64 = body.mass().iter().sum();
        for (model, integrator) in cases(&body, 3.0)
            .into_iter()
            .flat_map(|case| ALL.into_iter().chain(HIGH).map(move |integrator| (case.model.clone(), integrator)))
        {
            let mut noise = Noise(9);
            let scale = 0.02 * body.extent();
            let start = State::new(
                body.rest().iter().map(|&rest| rest + flat(noise.vector()) * scale).collect(),
                body.rest().iter().map(|_| flat(noise.vector())).collect(),
            );
            let around = Surroundings { gravity, ..Surroundings::default() };
            let mut world = World::new(&body, start, model.as_ref(), around, Stepping::new(integrator, 1e-4));
            let before = world.snapshot().diagnostics.momentum;
            world.advance(200);
            let drift = world.snapshot().diagnostics.momentum - before - gravity * mass * 0.02;
            assert!(drift.length() < 1e-10 * mass, "{integrator:?} {model:?}: {drift}");
        }
    }
}

/// A floor without friction exerts only vertical forces: the other momenta are conserved to round-off while the body
/// bounces.
#[test]
fn contact_changes_momentum_along_its_normal_alone() {
    let body = lattice(2, 0.1);
    let shape = ShapeBased { passes: 6, ..shape_based(STIFFNESS, 0.0) };
    let spring = mass_spring(&body, STIFFNESS, 20.0, Springs::EdgesOneDiagonal);
    for model in [&shape as &dyn ElasticModel, &spring] {
        for integrator in [Integrator::SemiImplicitEuler, Integrator::VelocityVerlet] {
            let mut noise = Noise(6);
            let start = State::new(
                body.rest().iter().map(|&rest| rest + noise.vector() * 0.004 + DVec3::Y * 0.01).collect(),
                body.rest().iter().map(|_| noise.vector() * 0.1 + DVec3::new(0.5, -2.0, 0.2)).collect(),
            );
            let around = Surroundings {
                gravity: DVec3::new(0.0, -9.8, 0.0),
                obstacles: vec![floor(0.5, 0.0)],
                ..Surroundings::default()
            };
            let mut world = World::new(&body, start, model, around, Stepping::new(integrator, 2e-4));
            let before = world.snapshot().diagnostics;
            world.advance(3000);
            let after = world.snapshot().diagnostics;
            let drift = after.momentum - before.momentum;
            assert!(drift.x.abs() + drift.z.abs() < 1e-10, "{integrator:?} {model:?}: {drift}");
            assert!(after.momentum.y > before.momentum.y + 10.0, "it has bounced: {drift}");
        }
    }
}

/// The force that velocity Verlet stores is that at the positions after contact, so each step is equal to the first
/// step of a world that starts from the same state, bit for bit.
#[test]
fn velocity_verlet_goes_on_as_if_it_began() {
    let body = lattice(2, 0.1);
    let around = Surroundings {
        gravity: DVec3::new(0.0, -9.8, 0.0),
        obstacles: vec![floor(0.5, 0.3)],
        ..Surroundings::default()
    };
    let mut noise = Noise(8);
    let start = State::new(
        body.rest().iter().map(|&rest| rest + noise.vector() * 0.005 + DVec3::Y * 0.006).collect(),
        vec![DVec3::new(0.2, -2.0, 0.1); body.len()],
    );
    let stepping = Stepping::new(Integrator::VelocityVerlet, 1e-3);
    for damping in [0.0, 20.0] {
        let model = mass_spring(&body, STIFFNESS, damping, Springs::EdgesOneDiagonal);
        let begin = |state: State| World::new(&body, state, &model, around.clone(), stepping);
        let mut world = begin(start.clone());
        let mut rebounds = 0;
        for step in 1..=100 {
            let before = world.state().clone();
            let mut other = begin(before.clone());
            world.advance(1);
            other.advance(1);
            let [world, other] = [&world, &other].map(World::state);
            let nodes = |state: &State| (state.position.clone(), state.velocity.clone());
            assert!(nodes(world) == nodes(other), "damping {damping}, step {step}");
            let turned = |(old, new): (&DVec3, &DVec3)| old.y < -0.5 && new.y > 0.0;
            rebounds += usize::from(before.velocity.iter().zip(&world.velocity).any(turned));
        }
        assert!(rebounds > 3, "{rebounds}");
    }
}

/// With `e = 1` the energy of a bouncing node is conserved to round-off for 100 000 rebounds.
#[test]
fn velocity_verlet_keeps_the_energy_of_a_bouncing_node() {
    let nodes = body(Dimension::Space, &[[0.0, 0.0, 0.0], [0.1, 0.0, 0.0]], &[&[0, 1]]);
    let (height, g) = (0.05, 9.8);
    let around =
        Surroundings { gravity: DVec3::new(0.0, -g, 0.0), obstacles: vec![floor(1.0, 0.0)], ..Surroundings::default() };
    let start = State::at_rest(nodes.rest().iter().map(|&rest| rest + DVec3::Y * height).collect());
    let stepping = Stepping::new(Integrator::VelocityVerlet, 0.01);
    let mut world = World::new(&nodes, start, &shape_based(1.0, 0.0), around, stepping);
    let (mut rebounds, mut last) = (0, 0.0);
    while rebounds < 100_000 {
        world.advance(1);
        let State { position, velocity, .. } = world.state();
        let energy = 0.5 * velocity[0].y * velocity[0].y + g * position[0].y;
        assert!((energy / (g * height) - 1.0).abs() < 1e-9, "after {rebounds} rebounds: {energy}");
        rebounds += usize::from(last < 0.0 && velocity[0].y > 0.0);
        last = velocity[0].y;
    }
}

/// A damped body on a floor comes to rest with every restitution; with velocity Verlet completely.
#[test]
fn a_damped_body_on_a_floor_comes_to_rest() {
    let body = lattice(2, 0.1);
    for restitution in [0.0, 0.5, 1.0] {
        let around = Surroundings {
            gravity: DVec3::new(0.0, -9.8, 0.0),
            obstacles: vec![floor(restitution, 0.3)],
            ..Surroundings::default()
        };
        let model = shape_based(STIFFNESS, 20.0);
        let start = State::at_rest(body.rest().to_vec());
        let stepping = Stepping::new(Integrator::VelocityVerlet, 1e-3);
        let mut world = World::new(&body, start, &model, around, stepping);
        let energy = |world: &World| {
            let now = world.diagnostics();
            now.kinetic + now.elastic + now.gravitational
        };
        let mut before = energy(&world);
        for _ in 0..20 {
            world.advance(1000);
            let now = energy(&world);
            assert!(now < before + 1e-9 * before.abs(), "restitution {restitution}: {before} {now}");
            before = now;
        }
        let fastest = world.state().velocity.iter().map(|v| v.length()).fold(0.0, f64::max);
        assert!(fastest < 1e-12, "restitution {restitution}: {fastest:e}");
    }
}

/// `dV/dt = −c V` only: stable up to `c ΔT = 2`, for velocity Verlet and both Euler methods.
#[test]
fn the_damping_limit_is_the_same_for_every_method() {
    let pair = body(Dimension::Space, &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], &[&[0, 1]]);
    let start = State::new(pair.rest().to_vec(), vec![DVec3::Y * 1e-3, DVec3::Y * -1e-3]);
    let damping = 5.0;
    for integrator in ALL {
        let is_stable = |step: f64| {
            // Soft enough that elasticity has no influence.
            let mut world = stepped(&pair, start.clone(), &shape_based(1e-9, damping), integrator, step);
            world.advance(2000);
            world.state().velocity[0].length() < 2e-3
        };
        let (mut stable, mut unstable) = (0.01, 1.0);
        while unstable - stable > 1e-4 {
            let middle = 0.5 * (stable + unstable);
            *if is_stable(middle) { &mut stable } else { &mut unstable } = middle;
        }
        assert!((stable * damping / 2.0 - 1.0).abs() < 0.01, "{integrator:?}: {}", stable * damping);
    }
}

/// Eq. (18) is about the rotations of the forces at a state, so for equal states it does not depend on the integrator.
/// Here every node of a cube is rotated by a grip, in each step further than one pass can follow exactly.
#[test]
fn the_residual_means_the_same_for_every_method() {
    let body = lattice(1, 0.1);
    let keys = vec![
        Key { time: 0.0, offset: Offset::default() },
        Key { time: 1.0, offset: Offset { shift: DVec3::ZERO, rotation: DVec3::new(3.0, 10.0, -4.0) } },
    ];
    let motion = Motion::Keys { keys, ease: Ease::Linear, repeat: false };
    let grip = Grip { nodes: (0..8).collect(), from: 0.0, until: 1.0, motion };
    let mut noise = Noise(11);
    let start = State::at_rest(body.rest().iter().map(|&rest| rest + noise.vector() * 0.02).collect());
    for damping in [0.0, 20.0] {
        let model = ShapeBased { passes: 1, ..shape_based(STIFFNESS, damping) };
        let residuals = ALL.map(|integrator| {
            let around = Surroundings { grips: vec![grip.clone()], ..Surroundings::default() };
            let stepping = Stepping { kernel: Kernel::Reference, ..Stepping::new(integrator, 0.01) };
            let mut world = World::new(&body, start.clone(), &model, around, stepping);
            let mut residuals = vec![];
            for _ in 0..50 {
                world.advance(1);
                residuals.push(world.report(0).residual.expect("the shape model has one"));
            }
            residuals
        });
        assert!(residuals[0].iter().all(|&residual| residual > 1e-3), "{:?}", residuals[0]);
        assert_eq!(residuals[0], residuals[1]);
        assert_eq!(residuals[0], residuals[2]);
    }
}

/// A gripped node has the velocity of the grip at the end of a step, whatever forces act on it.
#[test]
fn held_nodes_have_the_velocity_of_the_hand() {
    let body = lattice(2, 0.1);
    let keys = vec![
        Key { time: 0.0, offset: Offset::default() },
        Key { time: 1.0, offset: Offset { shift: DVec3::new(0.3, 0.1, 0.0), rotation: DVec3::ZERO } },
    ];
    let motion = Motion::Keys { keys, ease: Ease::Linear, repeat: false };
    let grip = Grip { nodes: vec![0, 5, 9], from: 0.0, until: 1.0, motion };
    for integrator in ALL.into_iter().chain(HIGH) {
        let around =
            Surroundings { gravity: DVec3::new(0.0, -9.8, 0.0), grips: vec![grip.clone()], ..Surroundings::default() };
        let start = State::at_rest(body.rest().to_vec());
        let mut world = World::new(&body, start, &shape_based(STIFFNESS, 5.0), around, Stepping::new(integrator, 1e-3));
        for _ in 0..100 {
            world.advance(1);
            for node in [0, 5, 9] {
                let off = world.state().velocity[node] - DVec3::new(0.3, 0.1, 0.0);
                assert!(off.length() < 1e-11, "{integrator:?}: {off}");
            }
        }
    }
}

/// At rest a node continues to bounce with semi-implicit Euler. It returns faster by at most `A ΔT` than it left, with
/// `A` the acceleration by which its load presses it down: so it leaves with at most `e/(1 − e) A ΔT`. `A` is at most
/// `g` times the mass of the body divided by that of the node. With velocity Verlet it comes to rest.
#[test]
fn the_jitter_at_rest_has_the_bound_of_the_load() {
    let (g, step) = (9.8, 1e-3);
    let cases = (1..4).flat_map(|seed| [0.0, 0.3, 0.5, 0.7, 0.9].map(|restitution| (seed, restitution)));
    for (seed, restitution) in cases {
        let cells = lattice(2, 0.1);
        let mut noise = Noise(seed);
        let turn = noise.rotation();
        let rest: Vec<_> = cells.rest().iter().map(|&rest| turn * (rest + noise.vector() * 0.02)).collect();
        let lowest = rest.iter().map(|rest| rest.y).fold(f64::INFINITY, f64::min);
        let rest: Vec<_> = rest.into_iter().map(|rest| rest - DVec3::Y * lowest).collect();
        let mass: Vec<_> = rest.iter().map(|_| 1.0 + 0.5 * noise.next()).collect();
        let irregular = Arc::new(
            Body::builder(rest.clone()).elements(cells.elements().clone()).masses(mass).build().expect("a body"),
        );
        let whole: f64 = irregular.mass().iter().sum();
        let around = Surroundings {
            gravity: DVec3::new(0.0, -g, 0.0),
            obstacles: vec![floor(restitution, 0.5)],
            ..Surroundings::default()
        };
        for integrator in [Integrator::SemiImplicitEuler, Integrator::VelocityVerlet] {
            let model = shape_based(STIFFNESS, 20.0);
            let start = State::at_rest(rest.clone());
            let mut world = World::new(&irregular, start, &model, around.clone(), Stepping::new(integrator, step));
            world.advance(30_000);
            for _ in 0..100 {
                world.advance(1);
                for (velocity, mass) in world.state().velocity.iter().zip(irregular.mass()) {
                    let bound = match integrator {
                        Integrator::VelocityVerlet => 0.0,
                        _ => restitution / (1.0 - restitution) * g * whole / mass * step,
                    };
                    let speed = velocity.length();
                    assert!(speed < bound + 1e-8, "{integrator:?}, e = {restitution}: {speed:e} of {bound:e} m/s");
                }
            }
        }
    }
}

/// After an obstacle has moved nodes, the stored forces of velocity Verlet are invalid: the body must bounce as with
/// the others.
#[test]
fn rebounds_are_alike_with_every_stable_method() {
    let body = lattice(1, 0.1);
    let height = |integrator| {
        let around = Surroundings {
            gravity: DVec3::new(0.0, -9.8, 0.0),
            obstacles: vec![floor(0.5, 0.0)],
            ..Surroundings::default()
        };
        let start = State::at_rest(body.rest().iter().map(|&rest| rest + DVec3::Y).collect());
        let stepping = Stepping::new(integrator, 2e-5);
        let mut world = World::new(&body, start, &shape_based(1e5, 0.0), around, stepping);
        world.advance(35_000);
        world.state().position.iter().map(|p| p.y).sum::<f64>() / 8.0
    };
    let euler = height(Integrator::SemiImplicitEuler);
    for integrator in [Integrator::VelocityVerlet].into_iter().chain(HIGH) {
        let other = height(integrator);
        assert!((euler - other).abs() < 5e-3, "{integrator:?}: {euler} {other}");
    }
}

/// The energy of an undamped motion oscillates, and with the symplectic methods it does not drift.
#[test]
fn energy_drifts_with_explicit_euler_alone() {
    let body = lattice(2, 0.1);
    let mut noise = Noise(3);
    let start = State::at_rest(body.rest().iter().map(|&rest| rest + noise.vector() * 0.01).collect());
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
