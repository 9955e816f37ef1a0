//! Damping in proportion to masses.

use super::INTEGRATORS;
use super::support::{lattice, mass_spring};
use glam::DVec3;
use localshape_sim::model::ElasticModel;
use localshape_sim::model::shape_based::ShapeBased;
use localshape_sim::stability::{Restraint, Stability};
use localshape_sim::{Body, Integrator, Kernel, Springs, State, Status, Stepping, Surroundings, World};
use std::sync::Arc;

const RATE: f64 = 4.0;
const SPEED: DVec3 = DVec3::new(1.0, -2.0, 0.5);

fn around() -> Surroundings {
    Surroundings { mass_damping: RATE, ..Surroundings::default() }
}

/// A world of a body that moves as a whole.
fn thrown(body: &Arc<Body>, model: &dyn ElasticModel, integrator: Integrator, kernel: Kernel, step: f64) -> World {
    let start = State { velocity: vec![SPEED; body.len()], ..State::at_rest(body.rest().to_vec()) };
    World::new(body, start, model, around(), Stepping { kernel, ..Stepping::new(integrator, step) })
}

/// The methods that take damping.
fn methods() -> impl Iterator<Item = Integrator> {
    INTEGRATORS.into_iter().filter(|&one| one != Integrator::Pefrl)
}

/// A body that flies slows down as `exp(−αt)`, to the order of each method, and fast code does what the reference does.
#[test]
fn a_flying_body_slows_down() {
    const TIME: f64 = 0.25;
    let body = lattice(2, 0.1);
    let models: [Arc<dyn ElasticModel>; 2] =
        [Arc::new(ShapeBased::new(1e3)), Arc::new(mass_spring(&body, 1e3, 0.1, Springs::All))];
    for (model, integrator) in models.iter().flat_map(|model| methods().map(move |one| (model, one))) {
        let speed = |kernel, step: f64| {
            let mut world = thrown(&body, &**model, integrator, kernel, step);
            world.advance((TIME / step).round() as u64);
            assert_eq!(world.status(), Status::Ok);
            world.state().velocity.clone()
        };
        let [coarse, fine] = [1.0 / 512.0, 1.0 / 1024.0].map(|step| speed(Kernel::Fast, step));
        let reference = speed(Kernel::Reference, 1.0 / 512.0);
        let apart = coarse.iter().zip(&reference).map(|(one, other)| one.distance(*other)).fold(0.0, f64::max);
        assert!(apart < 1e-12, "{integrator:?}: {apart}");
        let error = |of: &[DVec3]| of[3].distance(SPEED * (-RATE * TIME).exp());
        let (order, least) = match integrator {
            Integrator::VelocityVerlet => (2.0, 0.0),
            Integrator::RungeKutta | Integrator::DormandPrince => (4.0, 1e-6),
            _ => (1.0, 0.0),
        };
        let found = (error(&coarse) / error(&fine)).log2();
        assert!(error(&fine) < least || (found - order).abs() < 0.05, "{integrator:?}: order {found}");
        assert!(error(&coarse) < 0.01, "{integrator:?}: {}", error(&coarse));
    }
}

/// Of one step of Eqs. (2) and (3) the result is known.
#[test]
fn a_step_takes_away_its_share() {
    let body = lattice(2, 0.1);
    let mut world = thrown(&body, &ShapeBased::new(1e3), Integrator::SemiImplicitEuler, Kernel::Fast, 0.01);
    world.advance(3);
    let expected = SPEED * (1.0 - RATE * 0.01_f64).powi(3);
    assert!(world.state().velocity.iter().all(|speed| speed.distance(expected) < 1e-13));
}

/// The amplitude of an oscillation falls as `exp(−ζωt)` with `ζ = α / 2ω`, also where no model is damped.
#[test]
fn oscillations_have_the_ratio() {
    const STEP: f64 = 1e-4;
    let body = lattice(1, 0.1);
    let model = ShapeBased::new(1e3);
    let start = |share: f64| State::at_rest(body.rest().iter().map(|at| *at * (1.0 + share)).collect());
    let energy = |damping: f64, steps: u64| {
        let around = Surroundings { mass_damping: damping, ..Surroundings::default() };
        let stepping = Stepping::new(Integrator::VelocityVerlet, STEP);
        let mut world = World::new(&body, start(0.01), &model, around, stepping);
        world.advance(steps);
        let state = world.state();
        let motion = state.velocity.iter().zip(body.mass()).map(|(speed, mass)| 0.5 * mass * speed.length_squared());
        motion.sum::<f64>() + world.report(0).energy.expect("an energy")
    };
    // Over many periods the energy falls as its square.
    let (first, last) = (energy(RATE, 0), energy(RATE, 5000));
    assert!((last / first / (-RATE * 0.5_f64).exp() - 1.0).abs() < 0.02, "{}", last / first);
    assert!((energy(0.0, 5000) / first - 1.0).abs() < 1e-3);
}

/// The largest stable step knows it, and so does the bound.
#[test]
fn predictions_of_steps_know_it() {
    let body = lattice(2, 0.1);
    for model in [ShapeBased::new(20.0), ShapeBased { damping: 0.3, ..ShapeBased::new(20.0) }] {
        let rate = 60.0;
        let restraint = Restraint { mass_damping: rate, ..Restraint::default() };
        for integrator in [Integrator::SemiImplicitEuler, Integrator::VelocityVerlet, Integrator::RungeKutta] {
            let limit = Stability::of(&body, &model, integrator, restraint).largest;
            let free = Stability::of(&body, &model, integrator, Restraint::default()).largest;
            let certain = Stability::certain(&body, &model, integrator, rate).expect("a bound");
            assert!(certain <= limit * 1.0001 && limit < 0.97 * free, "{integrator:?}: {certain} {limit} {free}");
            let grows = |share: f64| {
                let stretched = body.rest().iter().enumerate().map(|(node, at)| {
                    *at + DVec3::new((node as f64).sin(), (2.0 * node as f64).cos(), (3.0 * node as f64).sin()) * 1e-7
                });
                let start = State::at_rest(stretched.collect());
                let around = Surroundings { mass_damping: rate, ..Surroundings::default() };
                let mut world = World::new(&body, start, &model, around, Stepping::new(integrator, share * limit));
                world.advance(3000);
                world.state().velocity.iter().any(|speed| speed.length() > 1e-2 || speed.is_nan())
            };
            assert_eq!([grows(0.98), grows(1.02)], [false, true], "{integrator:?}");
        }
    }
}

/// Substeps backwards in time would feed energy in.
#[test]
fn compositions_refuse_it() {
    let (body, model) = (lattice(1, 0.1), ShapeBased::new(1e3));
    assert!(Integrator::Pefrl.refusal(&model, &body, 0.0).is_none());
    assert!(Integrator::Pefrl.refusal(&model, &body, 1.0).is_some_and(|why| why.contains("damping")));
}

/// It changes at run time, and a value that is none is told.
#[test]
fn it_is_set_between_steps() {
    let (body, model) = (lattice(1, 0.1), ShapeBased::new(1e3));
    let mut world = thrown(&body, &model, Integrator::VelocityVerlet, Kernel::Fast, 1e-3);
    world.set_mass_damping(0.0).expect("a value");
    world.advance(10);
    assert!(world.state().velocity.iter().all(|speed| speed.distance(SPEED) < 1e-13));
    for wrong in [-1.0, f64::NAN, f64::INFINITY] {
        let error = world.set_mass_damping(wrong).expect_err("no value");
        assert_eq!(
            (error.of, error.to_string().contains("expected a finite number, 0 or more")),
            ("mass_damping", true)
        );
    }
}
