//! The stress suite in its fast form: the promises of every trial.

use super::{Outcome, Tried, compared, measure};
use crate::reading::documented;

/// All trials with every model, with 20 000 steps instead of a million for bodies that rest or spin.
#[test]
fn the_shape_model_keeps_what_it_promises_and_no_model_gives_nan() {
    let results = measure(20_000, &compared(&[]), &|_| true).expect("it is never stopped");
    let broken: Vec<_> = results.rows.iter().filter(|row| !row.broken().is_empty()).collect();
    let broken: Vec<_> = broken
        .iter()
        .map(|row| format!("{}, {}: {}", row.trial.group, row.trial.name, row.broken().join("; ")))
        .collect();
    assert!(broken.is_empty(), "{broken:#?}\n{}", results.text());
    // The paper's point: from a mirror image, springs do not recover.
    let mirrored = results.rows.iter().find(|row| row.trial.name == "a mirror image").expect("it is a trial");
    let is_mirrored =
        |springs: &Option<Outcome>| springs.is_some_and(|springs| springs.turned_over == mirrored.trial.elements());
    assert!(mirrored.outcomes[2..].iter().all(is_mirrored), "{mirrored:?}");
    let table = results.table();
    assert_eq!(table.rows.len(), results.rows.iter().flat_map(|row| row.outcomes.iter().flatten()).count());
    assert_eq!(table.heads, documented("stress.csv"));
}

/// Every model by its name: finite numbers, or a body that it does not take.
#[test]
fn every_model_is_tried_by_its_name() {
    let kinds = crate::models::kinds();
    assert!(kinds.len() > 5 && kinds.contains(&"corotational".to_owned()), "{kinds:?}");
    let results = measure(2000, &compared(&kinds), &|_| true).expect("it is never stopped");
    let broken =
        |row: &Tried| row.broken().into_iter().filter(|words| words.contains("not finite")).collect::<Vec<_>>();
    assert!(results.rows.iter().all(|row| broken(row).is_empty()), "{}", results.text());
    let on_cubes = results.rows.iter().find(|row| row.trial.name == "a mirror image").expect("it is a trial");
    assert!(on_cubes.outcomes.iter().all(Option::is_some), "all models take cubes: {on_cubes:?}");
}
