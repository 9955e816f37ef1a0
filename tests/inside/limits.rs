//! Tests of `src/scene/limits.rs`.

use super::*;
use std::slice;

fn models<const N: usize>(models: [&str; N]) -> [ModelFile; N] {
    let model = |kind: &str| toml::from_str::<toml::Table>(&format!("model = {{ kind = {kind}, stiffness = 1e4 }}"));
    models.map(|kind| model(kind).unwrap()["model"].clone().try_into().unwrap())
}

fn block(side: u128) -> BodySize {
    BodySize::new((side + 1).pow(3), [(8, side.pow(3))])
}

/// The excess of a body with a run for each model.
fn beyond(size: &BodySize, models: &[ModelFile], limits: &Limits) -> Option<Excess> {
    let runs: Vec<_> = models.iter().map(|model| vec![(0, Some(model))]).collect();
    excess(slice::from_ref(size), &runs, limits, |_| "use fewer cells")
}

#[test]
fn the_default_allows_a_block_of_two_hundred_cells_a_side_and_not_of_a_thousand() {
    let limits = Limits::default();
    assert_eq!(beyond(&block(200), &models(["'shape-based'", "'mass-spring'"]), &limits), None);
    let Excess { message, help, of } = beyond(&block(1000), &models(["'shape-based'"]), &limits).unwrap();
    assert!(message.starts_with("this makes 1 003 003 001 nodes and 1 000 000 000 elements"), "{message}");
    assert!(help.contains("fewer cells") && of == Largest::Body(0), "{help}");
    let many = models(["'shape-based'"; 4]);
    assert!(beyond(&block(200), &many, &limits).unwrap().message.contains("of all runs"));
}

#[test]
fn springs_are_counted_by_the_topology_asked_for() {
    let polygon = BodySize::new(60_000, [(60_000, 1)]);
    let found = |model| beyond(&polygon, &models(["'shape-based'", model]), &Limits::default());
    let Excess { message, help, of } = found("'mass-spring', springs = 'all'").unwrap();
    assert!(message.contains("up to 1 799 970 000 springs"), "{message}");
    assert!(help.contains("springs = \"edges\"") && of == Largest::Model(1, 0), "{help}");
    // The default topology has the diagonals of the polygon, which is its own face.
    assert!(found("'mass-spring'").is_some());
    assert_eq!(found("'mass-spring', springs = 'edges'"), None);
    assert_eq!(found("'shape-based'"), None);
}

#[test]
fn all_bodies_of_all_runs_count() {
    let [model] = models(["'mass-spring', springs = 'edges'"]);
    let sizes = [block(1), block(3), block(2)];
    let found = |runs: &[&[usize]], limits| {
        let run = |of: &&[usize]| of.iter().map(|&body| (body, Some(&model))).collect();
        excess(&sizes, &runs.iter().map(run).collect::<Vec<_>>(), &limits, |_| "use fewer cells")
    };
    let limits = Limits { nodes: 8 + 64 + 27, corners: 8 + 216 + 64 + 8, ..Limits::NONE };
    let springs = 24 * (1 + 27 + 8 + 1);
    let [all, again]: [&[usize]; 2] = [&[0, 1, 2], &[0]];
    assert_eq!(found(&[all, again], Limits { springs, ..limits }), None);
    assert!(
        found(&[all, again], Limits { springs: springs - 1, ..limits })
            .is_some_and(|one| one.of == Largest::Model(0, 1))
    );
    let Excess { message, of, .. } = found(&[all, again, again], limits).unwrap();
    assert!(message.contains("the elements of all runs have 304 nodes"), "{message}");
    assert_eq!(of, Largest::Body(1));
    let message = found(&[all], Limits { nodes: limits.nodes - 1, ..limits }).unwrap().message;
    assert!(message.starts_with("all bodies together make 99 nodes, 36 elements"), "{message}");
}

#[test]
fn nodes_and_elements_must_be_counted_by_32_bits() {
    let models = models(["'shape-based'"]);
    let message = |count| beyond(&BodySize::new(2, [(2, count)]), &models, &Limits::NONE).map(|one| one.message);
    assert!(!message((1 << 32) - 1).is_some_and(|message| message.contains("32-bit")));
    assert!(message(1 << 32).unwrap().contains("32-bit"));
}

#[test]
fn what_no_machine_gives_is_said_beforehand() {
    let enormous = BodySize::new(8, [(usize::MAX, 1)]);
    let message = beyond(&enormous, &models(["'shape-based'"]), &Limits::NONE).unwrap().message;
    assert!(message.contains("more than this machine has"), "{message}");
    assert_eq!(beyond(&block(1), &models(["'shape-based'"]), &Limits::NONE), None);
}

#[test]
fn no_size_overflows() {
    let all = models(["'shape-based'", "'mass-spring', springs = 'all'"]);
    let enormous = BodySize::new(u128::MAX, [(usize::MAX, u128::MAX), (3, u128::MAX)]);
    assert!(beyond(&enormous, &all, &Limits::NONE).is_some());
}
