//! Fig. 4(a): six triangles in the plane fall on a floor. Uses the shipped scene.

use super::support::{after, shipped};
use localshape::scene::Scene;
use localshape::sim::Snapshot;

/// Signed area of the triangle with the largest obtuse angle, divided by its area at rest.
fn obtuse(scene: &Scene, snapshot: &Snapshot) -> f64 {
    let nodes = &scene.bodies[0].body.elements()[5];
    let area = |at: &[glam::DVec3]| {
        let [a, b, c] = [0, 1, 2].map(|corner: usize| at[nodes[corner] as usize]);
        (b - a).cross(c - a).z
    };
    area(&snapshot.position) / area(scene.bodies[0].body.rest())
}

/// The shipped scene with another height of the fall (m), turn (rad) and stiffness (N/m).
fn fall(height: f64, turn: f64, stiffness: f64) -> Scene {
    shipped(
        "fig4a",
        &[
            ("lowest = 10.0", &format!("lowest = {height}")),
            ("angle = 0.1", &format!("angle = {turn}")),
            ("stiffness = 1e4", &format!("stiffness = {stiffness}")),
        ],
    )
}

#[test]
fn springs_leave_the_obtuse_triangle_turned_over_and_the_shape_model_restores_it() {
    for (scene, tolerance) in [(shipped("fig4a", &[]), 0.02), (fall(10.0, 0.0, 1e4), 0.005)] {
        let springs = after(&scene, "Mass-spring", 5.0);
        assert_eq!(springs.turned_over, [false, false, false, false, false, true]);
        // An independent implementation found −.99 and +.9997, without a tilt: here −.987 and +.9998.
        let ratio = obtuse(&scene, &springs);
        assert!((ratio + 0.99).abs() < tolerance, "{ratio}");
        let shape = after(&scene, "Local shape", 5.0);
        assert_eq!(shape.diagnostics.turned_over, 0);
        let ratio = obtuse(&scene, &shape);
        assert!((ratio - 0.9997).abs() < 3e-4, "{ratio}");
    }
}

#[test]
fn at_rest_the_body_lies_on_a_side_and_sags_there() {
    let scene = shipped("fig4a", &[]);
    let end = after(&scene, "Local shape", 12.0);
    assert!(end.diagnostics.kinetic < 0.05, "{}", end.diagnostics.kinetic);
    assert!((obtuse(&scene, &end) - 0.9917).abs() < 1e-3);
}

#[test]
fn it_holds_for_falls_of_5_to_20_m_and_tilts_both_ways() {
    for height in [5.0, 10.0, 20.0] {
        for turn in [-0.2, 0.0, 0.2] {
            let scene = fall(height, turn, 1e4);
            assert!(after(&scene, "Mass-spring", 5.0).turned_over[5], "{height} m, {turn}");
            assert_eq!(after(&scene, "Local shape", 5.0).diagnostics.turned_over, 0, "{height} m, {turn}");
        }
    }
}

#[test]
fn at_ten_times_the_stiffness_nothing_turns_over() {
    for height in [5.0, 10.0] {
        let scene = fall(height, 0.1, 1e5);
        for run in ["Mass-spring", "Local shape"] {
            assert_eq!(after(&scene, run, 5.0).diagnostics.turned_over, 0, "{run} {height} m");
        }
    }
}
