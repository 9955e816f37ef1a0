//! The patch test, passed and failed.

use super::*;
use crate::reading::documented;

#[test]
fn regular_blocks_and_finite_elements_pass_and_irregular_shapes_fail() {
    let study = Patch { cells: 3, blocks: 1 };
    let results = measure(&study, &|_| true).expect("nobody stops it");
    assert_eq!(study.work(), results.missed.len() as u64);
    for one in &results.missed {
        let miss = one.miss.expect("a balance");
        let is_uniform = one.irregular == 0.0 || matches!(one.model.kind, "linear" | "corotational" | "neo-hookean");
        assert_eq!(miss < ROUND_OFF, is_uniform, "{one:?}");
        if one.model.kind == "metric" {
            assert!(miss < 0.1 * one.irregular + ROUND_OFF, "{one:?}");
        }
        if one.model.name == "shape-based" && one.poisson == 0.0 {
            assert!(miss < 0.7 * one.irregular + ROUND_OFF, "{one:?}");
        }
        // Of the tetrahedra of a regular lattice only one in five is regular.
        let is_shape = one.model.kind == "shape-based" && one.model.elements == super::super::Elements::Simplices;
        if is_uniform && !one.model.is_springs() && !is_shape {
            let energy = one.energy.expect("an energy");
            // Neo-Hookean materials are linear only in small strains.
            assert!(energy.abs() < 2e-3, "{one:?}");
        }
    }
    assert_eq!(results.table().heads, documented("patch.csv"));
    assert!(results.text().contains("*0*"));
}
