//! Extended position-based dynamics: what it is the same as, what it tends to, and that it takes what surrounds a body.

use super::conformance::bodies;
use super::shape_matching::goals;
use super::support::{Noise, bricks, floor, free, lattice, shape_based, stepped, world};
use glam::DVec3;
use localshape_sim::model::ElasticModel;
use localshape_sim::model::shape_based::{RotationReading, ShapeBased};
use localshape_sim::model::xpbd::Xpbd;
use localshape_sim::stability::{Restraint, Stability};
use localshape_sim::{
    Body, Crew, Dimension, Grip, Integrator, Kernel, Material, Motion, State, Stepping, Surroundings, World,
};
use std::sync::Arc;

const GRAVITY: DVec3 = DVec3::new(0.0, -9.8, 0.0);

fn xpbd(stiffness: f64) -> Xpbd {
    Xpbd::new(ShapeBased::new(stiffness))
}

/// A cube of a material with `ν = 0.3`, and its shape model.
fn of_material(body: &Body) -> ShapeBased {
    let material = Material { young: 2e4, poisson: 0.3 };
    let stiffness = material.stiffness(body)[0];
    ShapeBased { material: Some(material), ..ShapeBased::new(stiffness) }
}

fn shaken(body: &Body, amount: f64) -> State {
    let mut noise = Noise(7);
    State::at_rest(body.rest().iter().map(|&rest| rest + noise.vector() * amount).collect())
}

/// Shape matching of the positions to which nodes would go freely.
#[test]
fn one_element_of_equal_masses_is_shape_matching_of_free_positions() {
    let (body, start) = (lattice(1, 0.1), shaken(&lattice(1, 0.1), 0.02));
    let (stiffness, step) = (3e3, 1e-2);
    let alpha = stiffness * step * step / (1.0 + stiffness * step * step);
    let mut world = free(&body, start.clone(), &xpbd(stiffness), step);
    let (mut position, mut velocity) = (start.position, start.velocity);
    for _ in 0..50 {
        let free: Vec<_> = position.iter().zip(&velocity).map(|(&from, &speed)| from + speed * step).collect();
        for (node, goal) in goals(body.rest(), &free).into_iter().enumerate() {
            let to = free[node] + (goal - free[node]) * alpha;
            (velocity[node], position[node]) = ((to - position[node]) / step, to);
        }
        world.advance(1);
        let far = position.iter().zip(&world.state().position).fold(0.0, |far: f64, (a, b)| far.max(a.distance(*b)));
        assert!(far < 1e-13, "{far:e}");
    }
}

/// With smaller steps motion tends to that of the shape model, in proportion to the step: no stiffness depends on their number.
#[test]
fn small_steps_tend_to_the_shape_model() {
    let body = lattice(2, 0.1);
    let start = shaken(&body, 0.004);
    let time = 0.02;
    for shape in [ShapeBased::new(1e3), ShapeBased { bending: 1.0 / 3.0, ..of_material(&body) }] {
        let mut exact = stepped(&body, start.clone(), &shape, Integrator::RungeKutta, time / 200.0);
        exact.advance(200);
        let errors = [100_u32, 200, 400].map(|steps| {
            let mut world = free(&body, start.clone(), &Xpbd::new(shape.clone()), time / f64::from(steps));
            world.advance(u64::from(steps));
            let pairs = world.state().position.iter().zip(&exact.state().position);
            pairs.fold(0.0, |far: f64, (a, b)| far.max(a.distance(*b)))
        });
        assert!(errors[2] < 2e-4, "{errors:?}");
        for pair in errors.windows(2) {
            assert!((1.7..2.3).contains(&(pair[0] / pair[1])), "{errors:?}");
        }
    }
}

/// The sag of a body that hangs does not depend on the number of steps either.
#[test]
fn a_body_hangs_as_low_as_the_shape_model() {
    let body = lattice(2, 0.1);
    let nodes = (0..27).filter(|&node| body.rest()[node as usize].y > 0.19).collect();
    let grip = Grip { nodes, from: 0.0, until: f64::INFINITY, motion: Motion::Still };
    let around = Surroundings { gravity: GRAVITY, grips: vec![grip.clone()], ..Surroundings::default() };
    let shape = shape_based(1e4, 40.0);
    let mut exact = world(&body, State::at_rest(body.rest().to_vec()), &shape, 1e-3, around.clone());
    exact.advance(5000);
    let errors = [1e-2, 5e-3, 2.5e-3].map(|step| {
        let mut world = world(&body, State::at_rest(body.rest().to_vec()), &xpbd(1e4), step, around.clone());
        world.advance((20.0 / step) as u64);
        for &node in &grip.nodes {
            assert_eq!(world.state().position[node as usize], body.rest()[node as usize]);
        }
        assert!(world.state().velocity.iter().all(|v| v.length() < 1e-6));
        world.state().position[0].y - exact.state().position[0].y
    });
    let sag = body.rest()[0].y - exact.state().position[0].y;
    assert!(errors[2].abs() < 0.03 * sag, "{errors:?} of {sag}");
    assert!(errors[1].abs() < 0.4 * errors[0].abs() && errors[2].abs() < 0.4 * errors[1].abs(), "{errors:?}");
}

/// A bar that hangs, of ten cubes: its end is `ρgL²/2E` = 0.049 m lower, and with long steps by the predicted factor more.
#[test]
fn long_steps_give_way_as_predicted() {
    let cubes = bricks([1, 10, 1], DVec3::splat(0.1));
    let mut mass = vec![0.0; cubes.len()];
    cubes.elements().iter().flatten().for_each(|&node| mass[node as usize] += 0.125);
    let body = Arc::new(Body::clone(&cubes).with_masses(mass).expect("masses"));
    let nodes = (0..body.len() as u32).filter(|&node| body.rest()[node as usize].y > 0.99).collect();
    let grips = vec![Grip { nodes, from: 0.0, until: f64::INFINITY, motion: Motion::Still }];
    let around = Surroundings { gravity: GRAVITY, grips, ..Surroundings::default() };
    let model = Xpbd::new(ShapeBased::new(5e3));
    for step in [1.0 / 60.0, 1.0 / 120.0, 1.0 / 300.0] {
        let mut world = world(&body, State::at_rest(body.rest().to_vec()), &model, step, around.clone());
        world.advance((60.0 / step) as u64);
        let excess = -world.state().position[0].y / 0.049 - 1.0;
        let predicted = model.projection(&body).expect("constraints").softening(step) - 1.0;
        assert!((excess / predicted - 1.0).abs() < 0.15, "{step}: {excess} {predicted}");
    }
    assert!(ShapeBased::new(5e3).projection(&body).is_none());
}

#[test]
fn a_body_at_rest_falls_undeformed() {
    let body = lattice(2, 0.1);
    let around = Surroundings { gravity: GRAVITY, ..Surroundings::default() };
    let mut world = world(&body, State::at_rest(body.rest().to_vec()), &xpbd(1e8), 1e-3, around);
    world.advance(1000);
    // As semi-implicit Euler: Σ g ΔT² over the steps.
    let fallen = GRAVITY * (0.5 * 1000.0 * 1001.0 * 1e-6);
    for (now, rest) in world.state().position.iter().zip(body.rest()) {
        assert!((*now - *rest - fallen).length() < 1e-10, "{now}");
    }
    assert!(world.state().velocity.iter().all(|v| (*v - GRAVITY).length() < 1e-8));
}

#[test]
fn a_body_rebounds_on_a_floor_and_comes_to_rest_on_it() {
    let body = lattice(2, 0.1);
    let start = State::at_rest(body.rest().iter().map(|&rest| rest + DVec3::Y * 0.5).collect());
    let fall = |restitution| {
        let around =
            Surroundings { gravity: GRAVITY, obstacles: vec![floor(restitution, 0.3)], ..Surroundings::default() };
        world(&body, start.clone(), &xpbd(1e5), 1e-3, around)
    };
    let mut bouncing = fall(0.8);
    let energy = bouncing.diagnostics().energy;
    let (mut has_touched, mut highest) = (false, 0.0);
    for _ in 0..800 {
        bouncing.advance(1);
        let lowest = bouncing.state().position.iter().fold(f64::INFINITY, |low, at| low.min(at.y));
        assert!(lowest > -1e-12, "{lowest:e}");
        has_touched |= lowest < 1e-3;
        if has_touched {
            highest = f64::max(highest, lowest);
        }
        assert!(bouncing.diagnostics().energy < energy * 1.02);
    }
    assert!((0.02..0.5).contains(&highest), "{highest}");
    let mut resting = fall(0.0);
    resting.advance(4000);
    assert!(resting.state().velocity.iter().all(|v| v.length() < 0.02), "{:?}", resting.state().velocity);
}

/// Momentum with steps of any length; angular momentum, as of backward Euler, in proportion to the step.
#[test]
fn momentum_is_kept_and_angular_momentum_with_small_steps() {
    let equal = lattice(2, 0.1);
    let mass: Vec<_> = (0..27).map(|node| 0.3 + f64::from(node % 5)).collect();
    let body = Arc::new(Body::clone(&equal).with_masses(mass.clone()).expect("masses"));
    let mut start = shaken(&body, 0.01);
    let mut noise = Noise(5);
    start.velocity = body.rest().iter().map(|_| noise.vector()).collect();
    let momenta = |state: &State| {
        let each = || mass.iter().zip(state.position.iter().zip(&state.velocity));
        let momentum: DVec3 = each().map(|(&mass, (_, &v))| v * mass).sum();
        let angular: DVec3 = each().map(|(&mass, (p, &v))| p.cross(v) * mass).sum();
        (momentum, angular)
    };
    let before = momenta(&start);
    let shape = ShapeBased { bending: 0.5, ..of_material(&body) };
    let change = |step, steps| {
        let mut world = free(&body, start.clone(), &Xpbd::new(shape.clone()), step);
        world.advance(steps);
        let after = momenta(world.state());
        ((after.0 - before.0).length(), (after.1 - before.1).length())
    };
    assert!(change(0.1, 100).0 < 1e-9, "{:?}", change(0.1, 100));
    let errors = [40_u32, 80, 160].map(|steps| change(0.02 / f64::from(steps), steps.into()));
    assert!(errors.iter().all(|error| error.0 < 1e-10), "{errors:?}");
    for pair in errors.windows(2) {
        assert!((1.8..2.2).contains(&(pair[0].1 / pair[1].1)), "{errors:?}");
    }
}

/// A body with the angular velocity `ω` loses the part `ω² ΔT` of its angular momentum each second.
#[test]
fn a_body_that_turns_is_braked_in_proportion_to_the_step() {
    let body = lattice(2, 0.1);
    let (spin, time) = (3.0, 1.0);
    let middle = DVec3::splat(0.1);
    let angular = |state: &State| -> f64 {
        state.position.iter().zip(&state.velocity).map(|(p, &v)| (*p - middle).cross(v).z).sum()
    };
    for steps in [500_u32, 2000] {
        let mut start = State::at_rest(body.rest().to_vec());
        start.velocity = body.rest().iter().map(|&rest| (DVec3::Z * spin).cross(rest - middle)).collect();
        let (before, step) = (angular(&start), time / f64::from(steps));
        let mut world = free(&body, start, &xpbd(1e6), step);
        world.advance(steps.into());
        let lost = 1.0 - angular(world.state()) / before;
        let expected = spin * spin * step * time;
        assert!((lost / expected - 1.0).abs() < 0.05, "{lost} {expected}");
    }
}

/// From small steps to steps of a thousand periods.
#[test]
fn energy_does_not_grow_with_any_step() {
    let body = lattice(3, 0.1);
    for poisson in [0.0, 0.3] {
        let material = Material { young: 2e4, poisson };
        let shape = ShapeBased { material: Some(material), ..ShapeBased::new(material.stiffness(&body)[0]) };
        let model = Xpbd::new(shape.clone());
        assert_eq!(Stability::of(&body, &model, Integrator::default(), Restraint::default()).largest, f64::INFINITY);
        for periods in [0.01, 0.1, 1.0, 10.0, 1000.0] {
            let step = periods * std::f64::consts::TAU / shape.stiffness.sqrt();
            let mut start = shaken(&body, 0.01);
            let mut noise = Noise(5);
            start.velocity = body.rest().iter().map(|_| noise.vector() * (0.01 / step)).collect();
            let mut world = free(&body, start, &model, step);
            let first = world.diagnostics().energy;
            let mut most = 0.0_f64;
            for _ in 0..400 {
                world.advance(1);
                most = most.max(world.diagnostics().energy);
            }
            assert!(most <= first * (1.0 + 1e-9), "{poisson} {periods}: {most} of {first}");
            assert!(world.diagnostics().energy < first, "{poisson} {periods}");
        }
    }
}

/// Bodies of every kind of element, and elements that are crushed to a point or turned over at the start.
#[test]
fn states_stay_finite() {
    for body in bodies() {
        let flat = |v: DVec3| if body.dimension() == Dimension::Plane { v.with_z(0.0) } else { v };
        let mut noise = Noise(3);
        let starts = [
            body.rest().iter().map(|&rest| rest + flat(noise.vector()) * 0.3 * body.extent()).collect::<Vec<_>>(),
            vec![DVec3::ZERO; body.len()],
            body.rest().iter().map(|&rest| rest * DVec3::new(-1.0, 1.0, 1.0)).collect(),
        ];
        for start in starts {
            let mut world = free(&body, State::at_rest(start), &xpbd(1e4), 1e-2);
            world.advance(50);
            assert!(world.state().position.iter().all(|at| at.is_finite()), "{:?}", body.kinds());
            assert_eq!(world.status(), localshape_sim::Status::Ok, "{:?}", body.kinds());
        }
    }
}

#[test]
fn states_have_the_same_bits_for_any_number_of_threads_and_when_continued() {
    let body = lattice(6, 0.1);
    let around = Surroundings { gravity: GRAVITY, obstacles: vec![floor(0.5, 0.3)], ..Surroundings::default() };
    let shape = ShapeBased { rotation: RotationReading::Robust, ..of_material(&body) };
    let new = || world(&body, shaken(&body, 0.01), &Xpbd::new(shape.clone()), 1e-3, around.clone());
    let mut first = new();
    first.advance(60);
    for threads in [2, 8] {
        let mut other = new();
        other.set_crew(Crew::new(threads));
        other.advance(25);
        let written = State::from_bytes(&other.state().to_bytes()).expect("a state");
        let mut continued = new();
        continued.set_state(written);
        continued.advance(35);
        assert_eq!(continued.state(), first.state());
    }
}

/// Whatever integrator and kernel are asked for, the model steps itself.
#[test]
fn the_model_owns_its_step() {
    let body = lattice(2, 0.1);
    let run = |integrator, kernel| {
        let stepping = Stepping { kernel, ..Stepping::new(integrator, 1e-2) };
        let mut world = World::new(&body, shaken(&body, 0.01), &xpbd(1e6), Surroundings::default(), stepping);
        world.advance(20);
        world.state().position.clone()
    };
    let own = run(Integrator::SemiImplicitEuler, Kernel::Reference);
    assert_eq!(run(Integrator::VelocityVerlet, Kernel::Fast), own);
    assert_eq!(run(Integrator::ExplicitEuler, Kernel::Reference), own);
}

/// A shape model whose elements break has the constraints of one whose elements do not.
#[test]
fn its_elements_do_not_break() {
    let body = lattice(2, 0.1);
    let run = |breaks_at| {
        let model = Xpbd::new(ShapeBased { breaks_at, ..ShapeBased::new(1e3) });
        let mut world = free(&body, shaken(&body, 0.04), &model, 1e-2);
        world.advance(20);
        world.state().clone()
    };
    assert_eq!(run(Some(1e-3)), run(None));
}
