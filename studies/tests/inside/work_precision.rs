//! The promises of a comparison of integrators.

use super::*;
use localshape::Limits;
use localshape::sim::model::shape_based::RotationReading;

const QUICK: Effort = Effort { evaluations: 4096, seconds: 10.0, rounds: 1 };

fn subjects(text: &str) -> Vec<Subject> {
    let scene = Scene::parse(text, "one.toml", &Limits::default()).unwrap();
    vec![Subject { name: "one".to_owned(), scene, run: 0 }]
}

const FREE: &str = "
    time.duration = 0.2
    body = { lattice = { cells = [1, 1, 1], side = 0.1 }, spin = { axis = [1, 2, 3], rate = 20 } }
    [[run]]
    name = 'cube'
    model = { kind = 'shape-based', stiffness = 1e4 }
";

/// A triangle that swings, with damping that has used up most of the motion at the end.
const DAMPED: &str = "
    time.duration = 1
    body.nodes = [[0, 0], [1, 0], [0.5, 0.866]]
    body.elements = [[0, 1, 2]]
    body.positions = [[0, 0], [1.3, 0.1], [0.4, 0.7]]
    [[run]]
    name = 'triangle'
    model = { kind = 'shape-based', stiffness = 1e4, damping_ratio = 0.1 }
";

/// A body that meets a floor.
const DROP: &str = "
    gravity = [0, -9.8, 0]
    time.duration = 0.06
    body = { lattice = { cells = [1, 1, 1], side = 0.1 }, velocity = [0, -1, 0], lowest = 0.03 }
    obstacle = [{ kind = 'floor', restitution = 0.5 }]
    run = [{ name = 'cube', model = { kind = 'mass-spring', stiffness = 1e4 } }]
";

#[test]
fn errors_fall_with_evaluations_and_the_reference_knows_its_own() {
    let watched = std::sync::atomic::AtomicU64::new(0);
    let watch = |more| watched.fetch_add(more, std::sync::atomic::Ordering::Relaxed) < u64::MAX;
    let results = measure(QUICK, &subjects(FREE), &watch).expect("it is never stopped");
    assert!(watched.into_inner() <= work(QUICK, &subjects(FREE)[0]));
    let found = &results.comparisons[0];
    assert!(found.reference.as_ref().is_ok_and(|reference| reference.error < 1e-9), "{:?}", found.reference);
    assert!(found.refused.is_empty());
    assert_eq!(found.methods().count(), Method::ALL.len());
    let cost = |method| found.cost(method, 1e-5).expect("it is reached").evaluations;
    let [euler, pefrl] = [Method::DEFAULT, Method::PEFRL].map(cost);
    assert!(euler > 5.0 * pefrl, "{euler} {pefrl}");
    let orders = [(Method::VERLET, 2.0), (Method::PEFRL, 4.0), (Method::FOREST_RUTH, 4.0)];
    for (method, order) in orders {
        let own = found.order(method).expect("it has one");
        assert!((own - order).abs() < 0.3, "{method:?}: {own}");
    }
    let least = |method| found.of(method).filter_map(|one| one.error).fold(f64::INFINITY, f64::min);
    let readings =
        [RotationReading::Arctangent, RotationReading::LinearUpdate].map(|one| least(Method::of_reading(one)));
    let (exact, [printed, linear]) = (least(Method::VERLET), readings);
    assert!(printed < 2.0 * exact && linear > 100.0 * exact, "{exact:e} {printed:e} {linear:e}");
    assert_eq!(results.table().rows.len(), found.measured.len());
    assert_eq!(results.table().heads, crate::reading::documented("work-precision.csv"));
    assert!(measure(QUICK, &subjects(FREE), &|_| false).is_none());
}

/// At the end of a damped motion the error is small. The error over the whole time counts.
#[test]
fn an_error_is_the_largest_over_the_whole_time() {
    let subject = &subjects(DAMPED)[0];
    let (methods, model) = (subject.methods(), Method::VERLET.model(subject).expect("its own"));
    let (exact, _) = reference(subject, &methods, 65_536.0).expect("there is one");
    let attempt = Attempt::new(Method::VERLET, 512.0, 1.0);
    let (mut last, mut largest, size) = (0.0, 0.0, subject.scene.bodies[0].body.extent());
    attempt.run(subject, &model, 1e6, |moment, positions| {
        last = farthest(positions, &exact[moment]) / size;
        largest = larger(largest, last);
    });
    assert!(largest > 10.0 * last, "{largest:e} {last:e}");
    let results = measure(QUICK, &subjects(DAMPED), &|_| true).expect("it is never stopped");
    let same =
        results.comparisons[0].of(Method::VERLET).find(|one| one.attempt.steps == attempt.steps).expect("it is tried");
    let error = same.error.expect("it does not diverge");
    assert!((error / largest - 1.0).abs() < 0.01, "{error:e} {largest:e}");
}

/// Two methods of low order may be far from each other, and a third one near one of them.
#[test]
fn no_error_is_below_that_of_the_reference() {
    let results = measure(QUICK, &subjects(DROP), &|_| true).expect("it is never stopped");
    let found = &results.comparisons[0];
    let own = found.reference.as_ref().expect("there is one").error;
    assert!(found.measured.iter().all(|one| one.error.is_none_or(|error| error >= own)), "{found:#?}");
    let tried = |method| found.of(method).count();
    assert!(Method::ALL.into_iter().any(|one| tried(one) > 0 && tried(one) < STEPS), "one is cut short");
}

/// A comparison with one method and these errors, with steps that are halved.
fn with_errors(method: Method, errors: &[f64]) -> Comparison {
    let measured = errors.iter().enumerate().map(|(at, &error)| Measured {
        attempt: Attempt::new(method, 1.0, 1.0),
        step: 0.5f64.powi(at as i32),
        evaluations: 1 << at,
        error: Some(error),
        end: End::Reached,
        time: Spread::of([1.0]),
        is_fast: false,
    });
    Comparison {
        name: "one".to_owned(),
        words: String::new(),
        duration: 1.0,
        cycle: 1.0,
        reference: Ok(Reference { methods: [method; 2], error: 1e-9 }),
        measured: measured.collect(),
        refused: Vec::new(),
    }
}

#[test]
fn orders_are_told_only_where_errors_show_one() {
    let order = |method, errors: &[f64]| with_errors(method, errors).order(method);
    assert_eq!(order(Method::VERLET, &[0.5, 8e-3, 2e-3, 5e-4]), Some(2.0));
    assert_eq!(order(Method::VERLET, &[0.5, 8e-3, 2e-3]), None, "two of them in the range");
    assert_eq!(order(Method::VERLET, &[0.5, 0.1, 8e-3, 2e-3, 1e-8]), None, "the last is round-off");
    assert_eq!(order(Method::VERLET, &[8e-3, 2e-3, 1.9e-3]), None, "without a common order");
    assert_eq!(order(Method::DORMAND_PRINCE, &[8e-3, 1e-3, 1e-4, 1e-5]), None, "steps are its own");
}

/// A larger error with smaller steps counts, too.
#[test]
fn a_cost_is_that_from_which_on_errors_are_small() {
    let found = with_errors(Method::VERLET, &[1e-1, 1e-4, 1e-2, 1e-5]);
    let cost = |error| found.cost(Method::VERLET, error).map(|cost| cost.step);
    assert_eq!(cost(1e-5), Some(0.125));
    assert!((0.125..0.25).contains(&cost(1e-3).expect("it is reached")));
    assert_eq!((cost(0.5), cost(1e-6)), (Some(1.0), None));
}

#[test]
fn the_scenes_that_are_measured_by_default_have_no_mistakes() {
    let has_readings = |subject: &Subject| subject.methods().iter().any(|(one, _)| one.reading.is_some());
    assert_eq!(
        usual(&[]).iter().map(has_readings).collect::<Vec<_>>(),
        [true, true, false],
        "the last one is in the plane"
    );
}

#[test]
fn methods_that_cannot_advance_a_run_are_named_with_the_reason() {
    let results = measure(QUICK, &subjects(&FREE.replace("1e4 }", "1e4, damping = 1 }")), &|_| true);
    let results = results.expect("it is never stopped");
    let refused: Vec<_> = results.comparisons[0].refused.iter().map(|(one, _)| one.name()).collect();
    assert_eq!(refused, ["forest-ruth", "pefrl", "blanes-moan", "kahan-li"]);
    assert!(results.text().contains("pefrl has substeps backwards in time"));
}

#[test]
fn a_scene_that_methods_do_not_agree_on_has_no_reference() {
    let results = measure(QUICK, &subjects(&FREE.replace("1e4", "1e12")), &|_| true).expect("it is never stopped");
    let found = &results.comparisons[0];
    let why = "no finite reference";
    assert!(found.reference.as_ref().is_err_and(|told| told.contains(why)), "{:?}", found.reference);
    assert!(found.measured.is_empty());
    assert!(results.text().contains(why));
}
