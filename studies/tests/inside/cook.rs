//! Cook's membrane with few cells.

use super::*;
use crate::reading::{documented, markdown_rows};

#[test]
fn the_page_has_these_deflections_and_finite_elements_converge_to_the_literature() {
    let study = Cook { cells: vec![2, 4] };
    let results = measure(&study, &|_| true).expect("nobody stops it");
    assert_eq!(study.work(), results.deflections.len() as u64);
    let row = |page: &str, model: &Model| {
        let name = format!("`{}`", model.name);
        let rows = markdown_rows(page);
        rows.into_iter().find(|row| row[0] == name && row[1] == model.elements.name(true)).expect("its row")
    };
    let (page, text) = (include_str!("../../../docs/material/cook.md"), results.text());
    for model in Cook::models() {
        let documented = row(page, model);
        assert_eq!(row(&text, model)[2..4], documented[2..4], "{model:?}");
        if !model.name.starts_with("shape-based") {
            let limit: f64 = documented.last().expect("a limit").parse().expect("a number");
            assert!((limit / PRINTED - 1.0).abs() < 0.01, "{model:?}: {limit}");
        }
    }
    assert_eq!(results.table().heads, documented("cook.csv"));
}
