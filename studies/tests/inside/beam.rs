//! Beams of few cells, with numbers of an independent implementation, of closed forms and of the page in the documentation.

use super::*;
use crate::reading::{documented, markdown_rows};

const PAGE: &str = include_str!("../../../docs/material/beam.md");

/// The rows of a model in a page.
fn rows(page: &str, name: &str, elements: &str) -> impl Iterator<Item = Vec<String>> {
    markdown_rows(page).into_iter().filter(move |row| row[0] == name && row[1] == elements)
}

#[test]
fn bars_bend_as_was_computed_independently_and_as_the_page_says() {
    let study = Beam { across: vec![1, 2], along: 32, bent: &MODELS[2..3] };
    let results = measure(&study, &|_| true).expect("nobody stops it");
    assert_eq!(study.work(), (results.tips.len() + results.bent.len()) as u64 + 1);
    let shape = [0.3367, 0.6676, 0.8185, 0.8890, 0.9474];
    let finite_elements = [0.6656, 0.8875, 0.9466, 0.9692, 0.9861];
    let expected =
        [("`shape-based`", shape), ("`shape-based, bending 1/2`", finite_elements), ("`linear`", finite_elements)];
    let text = results.text();
    for (name, expected) in expected {
        let shown = rows(PAGE, name, "hexahedra").next().expect("its row");
        for (cells, expected) in [1, 2, 3, 4, 6].into_iter().zip(expected) {
            let found: f64 = shown[1 + cells].parse().expect("a number");
            assert!((found - expected).abs() < 1.5e-4, "{name}, {cells} cells: {found} instead of {expected}");
        }
    }
    for model in &MODELS {
        let (name, elements) = (format!("`{}`", model.name), model.elements.name(false));
        // Small deflections come first, with each Poisson's ratio that the model takes.
        let tables = Beam::kinds().filter(|kind| kind.0 == model).count();
        let [found, shown] = [&text, PAGE].map(|page| rows(page, &name, elements).take(tables).collect::<Vec<_>>());
        assert_eq!(found.len(), tables);
        for (found, shown) in found.iter().zip(&shown) {
            assert_eq!(found[2..], shown[2..4], "{name} of {elements}");
        }
    }
    let end = results.bent[0].ends.iter().zip(MATTIASSON);
    for (end, (load, printed)) in end {
        let (end, exact) = (end.expect("a balance"), elastica(load));
        for axis in [0, 1] {
            let is_near = printed.is_none_or(|printed| (exact[axis] - printed[axis]).abs() < 0.6e-5);
            assert!(is_near, "{load}: {} instead of {printed:?}", exact[axis]);
            assert!((end[axis] / exact[axis] - 1.0).abs() < 0.01, "{load}: {} instead of {}", end[axis], exact[axis]);
        }
    }
    for wave in &results.waves {
        assert!(wave.error < 1e-9, "{wave:?}");
    }
    assert_eq!(results.table().heads, documented("beam.csv"));
    assert_eq!(results.elastica_table().heads, documented("beam-elastica.csv"));
    assert_eq!(results.waves_table().heads, documented("beam-waves.csv"));
}

#[test]
fn it_stops_when_it_is_told() {
    let study = Beam { across: vec![1], along: 2, bent: &[] };
    assert_eq!(measure(&study, &|_| false), None);
}
