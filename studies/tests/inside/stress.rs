//! The stress suite in its fast form: the promises of every trial.

use super::{MODELS, measure};
use crate::reading::documented;

/// All trials with every model, with 20 000 steps instead of a million for bodies that rest or spin.
#[test]
fn the_shape_model_keeps_what_it_promises_and_no_model_gives_nan() {
    let results = measure(20_000, &|_| true).expect("it is never stopped");
    let broken: Vec<_> = results.rows.iter().filter(|row| !row.broken().is_empty()).collect();
    let broken: Vec<_> =
        broken.iter().map(|row| format!("{}, {}: {}", row.group, row.name, row.broken().join("; "))).collect();
    assert!(broken.is_empty(), "{broken:#?}\n{}", results.text());
    // The paper's point: from a mirror image, springs do not recover.
    let mirrored = results.rows.iter().find(|row| row.name == "a mirror image").expect("it is a trial");
    assert!(mirrored.outcomes[2..].iter().all(|springs| springs.turned_over == mirrored.elements), "{mirrored:?}");
    let table = results.table();
    assert_eq!(table.rows.len(), results.rows.len() * MODELS.len());
    assert_eq!(table.heads, documented("stress.csv"));
}
