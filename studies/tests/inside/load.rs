//! Bodies at rest under loads, with few cells.

use super::*;
use crate::material::{Elements, Rod};
use crate::reading::{documented, markdown_rows};
use localshape::sim::Material;

const PAGE: &str = include_str!("../../../docs/loads/load.md");

/// The error of finite elements that turn, hexahedra, with the fewest cells and with half of their size, and the least order between.
const NEAR: [(&Case, [f64; 2], f64); 5] = [
    (&twist::CASE, [0.19, 0.053], 1.7),
    (&follower::CASE, [0.4, 0.1], 1.9),
    (&bend::CASE, [0.19, 0.05], 1.8),
    (&column::CASE, [0.51, 0.13], 1.9),
    (&ring::CASE, [0.03, 0.01], 1.9),
];

#[test]
fn the_page_has_these_numbers() {
    let study = Loads { most: 1 };
    let results = measure(study, &|_| true).expect("nobody stops it");
    assert_eq!(study.work(), results.len() as u64);
    let [found, mut shown] = [&text(study, &results), PAGE].map(markdown_rows);
    // A row of dashes is left out.
    shown.retain(|row| row[2] != "–");
    assert_eq!(found.len(), shown.len());
    for (found, shown) in found.iter().zip(&shown) {
        assert_eq!(found[..3], shown[..3]);
    }
    assert_eq!(table(&results).heads, documented("load.csv"));
    for Measured { case, model, ratio, .. } in results {
        // Cubes of the shape model are a material; its tetrahedra are none.
        let is_material = model.kind != "shape-based" || model.elements == Elements::Cells;
        let within = match case {
            _ if case == pull::STRETCHED.name || case == pull::PRESSED.name => is_material.then_some(1e-8),
            _ if case == weight::SCALE.name => Some(1e-9),
            _ if case == weight::STACK.name => Some(1e-4),
            _ => None,
        };
        let error = ratio.map(|ratio| (ratio - 1.0).abs());
        assert!(within.is_none_or(|within| error.is_some_and(|error| error < within)), "{case}: {model:?}: {error:?}");
    }
}

#[test]
fn finer_cells_come_nearer_with_their_order() {
    let turns =
        |model: &&Model| model.elements == Elements::Cells && ["corotational", "neo-hookean"].contains(&model.kind);
    for (case, within, least) in NEAR {
        for model in case.models().filter(turns) {
            let ratios = [0, 1].map(|refined| (case.measure)(model, refined));
            let errors = ratios.map(|ratio| ratio.map_or(f64::INFINITY, |ratio| (ratio - 1.0).abs()));
            assert!(errors[0] < within[0] && errors[1] < within[1], "{}: {}: {errors:?}", case.name, model.name);
            assert!(
                order(&ratios).is_some_and(|order| order > least && order < 2.2),
                "{}: {}: {errors:?}",
                case.name,
                model.name
            );
        }
    }
}

/// A rod in its plane is the elastica of Mattiasson 1981, and out of its plane near to beams of the literature.
#[test]
fn rods_are_near_the_literature() {
    for printed in [DVec3::new(15.9, 47.2, 53.4), DVec3::new(15.79, 47.23, 53.37)] {
        assert!(bend::end().distance(printed) < 0.01 * printed.length(), "{}", bend::end());
    }
    let material = Material { young: 12.0, poisson: 0.0 };
    let rod = Rod::square(1000.0, DVec3::ZERO, material);
    // P L²/EI = 10.
    let end = rod.dead(DVec3::X * 1e-5) / rod.length;
    assert!(end.distance(DVec3::new(0.81061, 0.0, 1.0 - 0.55500)) < 2e-5, "{end}");
}
