//! The forces of Figs. 1 and 2, with `k = 1`, compared with an independent implementation: the seven rows of the table
//! in `docs/paper.md`.

use super::support::{body, forces, shape_based};
use glam::DVec3;
use localshape_sim::model::ElasticModel;
use localshape_sim::model::mass_spring::MassSpring;
use localshape_sim::{Dimension, State};

fn at(points: &[[f64; 2]]) -> Vec<[f64; 3]> {
    points.iter().map(|&[x, y]| [x, y, 0.0]).collect()
}

/// The forces (N) on a polygon deformed from `rest` to `now`.
fn on_polygon(rest: &[[f64; 2]], now: &[[f64; 2]], model: &dyn ElasticModel) -> Vec<DVec3> {
    let nodes: Vec<_> = (0..rest.len() as u32).collect();
    let body = body(Dimension::Plane, &at(rest), &[&nodes]);
    let now = at(now).into_iter().map(DVec3::from_array).collect();
    forces(&body, model, &State::at_rest(now))
}

fn agree(found: &[DVec3], expected: &[[f64; 2]]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        // The independent values have four decimals.
        let off = (found.truncate() - glam::DVec2::from_array(*expected)).abs();
        assert!(off.max_element() < 0.5001e-4 && found.z == 0.0, "{found} {expected:?}");
    }
}

fn springs(pairs: &[[u32; 2]]) -> MassSpring {
    MassSpring { stiffness: 1.0, damping: 0.0, springs: pairs.into(), breaks_at: None }
}

/// A regular triangle of side 1, its base on the x-axis around the origin.
fn triangle() -> [[f64; 2]; 3] {
    [[-0.5, 0.0], [0.5, 0.0], [0.0, 0.75f64.sqrt()]]
}

#[test]
fn fig_1_a_triangle_whose_apex_is_pressed_down() {
    let now = [[-0.5, 0.0], [0.5, 0.0], [0.1, 0.1]];
    let three = springs(&[[0, 1], [1, 2], [0, 2]]);
    agree(
        &on_polygon(&triangle(), &now, &shape_based(1.0, 0.0)),
        &[[0.0063, -0.2023], [0.0010, -0.3053], [-0.0072, 0.5076]],
    );
    agree(&on_polygon(&triangle(), &now, &three), &[[-0.3864, -0.0644], [0.5701, -0.1425], [-0.1837, 0.2069]]);
}

#[test]
fn fig_1_with_the_apex_turned_over_springs_push_the_wrong_way() {
    let now = [[-0.5, 0.0], [0.5, 0.0], [0.0, -0.2]];
    let three = springs(&[[0, 1], [1, 2], [0, 2]]);
    agree(&on_polygon(&triangle(), &now, &shape_based(1.0, 0.0)), &[[0.0, -0.3553], [0.0, -0.3553], [0.0, 0.7107]]);
    agree(&on_polygon(&triangle(), &now, &three), &[[-0.4285, 0.1714], [0.4285, 0.1714], [0.0, -0.3428]]);
}

#[test]
fn fig_2_a_square_pressed_flat() {
    let half = 0.5f64.sqrt();
    let rest = [[half, 0.0], [0.0, half], [-half, 0.0], [0.0, -half]];
    let now = rest.map(|[x, y]| [1.2 * x, 0.3 * y]);
    agree(
        &on_polygon(&rest, &now, &shape_based(1.0, 0.0)),
        &[[-0.1414, 0.0], [0.0, 0.4950], [0.1414, 0.0], [0.0, -0.4950]],
    );
    let sides = [[0, 1], [1, 2], [2, 3], [0, 3]];
    let with = |diagonal| springs(&[&sides[..], &[diagonal]].concat());
    agree(&on_polygon(&rest, &now, &with([1, 3])), &[[0.2432, 0.0], [0.0, 1.0508], [-0.2432, 0.0], [0.0, -1.0508]]);
    agree(&on_polygon(&rest, &now, &with([0, 2])), &[[-0.0396, 0.0], [0.0, 0.0608], [0.0396, 0.0], [0.0, -0.0608]]);
}
