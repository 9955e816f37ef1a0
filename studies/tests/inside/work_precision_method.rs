//! Runs with evaluations counted.

use super::*;
use localshape::{Limits, Scene};

/// A body that rests on a floor: nodes rebound again and again, and an adaptive method takes ever shorter substeps.
#[test]
fn a_run_that_takes_far_too_many_evaluations_is_given_up() {
    let rests = "
        gravity = [0, -9.8, 0]
        time.duration = 0.5
        body = { lattice = { cells = [1, 1, 1], side = 0.1 }, lowest = 0 }
        obstacle = [{ kind = 'floor', restitution = 0.5 }]
        run = [{ name = 'cube', model = { kind = 'shape-based', stiffness = 1e4, damping_ratio = 0.1 } }]
    ";
    let scene = Scene::parse(rests, "one.toml", &Limits::default()).unwrap();
    let subject = Subject { name: "one".to_owned(), scene, run: 0 };
    let model = Method::DORMAND_PRINCE.model(&subject).expect("its own");
    let attempt = Attempt::new(Method::DORMAND_PRINCE, 1e3, 1e-9);
    let (end, evaluations) = attempt.run(&subject, &model, 1e3, |_, _| ());
    assert!(end == End::GivenUp && (16_000..17_000).contains(&evaluations), "{evaluations}");
}

#[test]
fn all_runs_have_their_states_at_the_same_moments() {
    let numbers = |steps: u64| {
        let attempt = Attempt { steps, ..Attempt::new(Method::DEFAULT, 1.0, 1.0) };
        let mut numbers = Vec::new();
        let subject = &super::super::usual(&[])[1];
        attempt.run(subject, &Method::DEFAULT.model(subject).expect("its own"), f64::INFINITY, |number, _| {
            numbers.push(number)
        });
        numbers
    };
    assert_eq!(numbers(4096), (0..MOMENTS).collect::<Vec<_>>());
    assert_eq!(numbers(Attempt::new(Method::DEFAULT, 4096.0, 1.0).finer().steps), (0..MOMENTS).collect::<Vec<_>>());
    assert_eq!(numbers(64), (0..MOMENTS).skip(1).step_by(2).collect::<Vec<_>>());
}
