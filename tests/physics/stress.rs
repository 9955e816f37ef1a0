//! The stress suite in its fast form: what must hold of every trial.

use localshape::study::stress::{MODELS, Protocol, measure};

/// All trials with every model, with 20 000 steps instead of a million for bodies that rest or spin.
#[test]
fn the_shape_model_keeps_what_it_promises_and_no_model_gives_nan() {
    let results = measure(Protocol { steps: 20_000 }, &|_| true).expect("it is never stopped");
    let broken: Vec<_> = results.rows.iter().filter(|row| !row.broken().is_empty()).collect();
    let broken: Vec<_> =
        broken.iter().map(|row| format!("{}, {}: {}", row.group, row.name, row.broken().join("; "))).collect();
    assert!(broken.is_empty(), "{broken:#?}\n{}", results.markdown("mark"));
    // The point of the paper: from a mirror image springs do not come back.
    let mirrored = results.rows.iter().find(|row| row.name == "a mirror image").expect("it is a trial");
    assert!(mirrored.outcomes[2..].iter().all(|springs| springs.turned_over == mirrored.elements), "{mirrored:?}");
    let csv = results.csv();
    assert_eq!(csv.lines().count(), 1 + results.rows.len() * MODELS.len());
    let page = include_str!("../../docs/files.md");
    let section = page.split("\n## ").find(|section| section.starts_with("`stress.csv`")).expect("its section");
    let cells = section.lines().filter_map(|line| line.strip_prefix("| `")?.split(" | ").next());
    let documented: Vec<_> = cells.flat_map(|cell| cell.split(", ")).map(|name| name.trim_matches('`')).collect();
    assert_eq!(csv.lines().next().expect("heads").split(',').collect::<Vec<_>>(), documented);
}
