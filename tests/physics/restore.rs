//! Starts from which the body recovers its shape with the shape model and not with springs: the figure `restore`.

use super::support::{after, shipped};
use localshape::sim::Status;

#[test]
fn every_start_comes_back_with_local_shapes_and_none_with_springs() {
    for start in ["point", "line", "plane", "mirror", "cloud-1", "cloud-2"] {
        let scene = shipped(&format!("elements/restore-{start}"), &[]);
        let extent = scene.bodies[0].body.extent();
        let shape = after(&scene, "Local shape", 3.0).diagnostics;
        assert!(shape.shape_error < 1e-6 * extent && shape.turned_over == 0, "{start}: {shape:?}");
        assert!((shape.volume_ratio - 1.0).abs() < 1e-6, "{start}: {shape:?}");
        let springs = after(&scene, "Mass-spring", 3.0);
        let found = springs.diagnostics;
        assert!(found.shape_error > 0.3 * extent, "{start}: {found:?}");
        assert_eq!(springs.status, Status::Ok);
        // Flat elements stay flat, inverted ones stay inverted, and the rest is entangled.
        match start {
            "point" | "line" | "plane" => assert!(found.volume_ratio.abs() < 1e-9, "{start}: {found:?}"),
            "mirror" => assert_eq!(found.turned_over, 27),
            _ => assert!(found.turned_over >= 9 && found.volume_ratio < 0.5, "{start}: {found:?}"),
        }
    }
}

/// The two random starts of the figure are the first two, not selected.
#[test]
fn other_clouds_come_back_too() {
    for seed in 3..9 {
        let scene = shipped("elements/restore-cloud-1", &[("seed = 1", &format!("seed = {seed}"))]);
        let found = after(&scene, "Local shape", 3.0).diagnostics;
        assert!(
            found.shape_error < 1e-6 * scene.bodies[0].body.extent() && found.turned_over == 0,
            "{seed}: {found:?}"
        );
        let springs = after(&scene, "Mass-spring", 3.0).diagnostics;
        assert!(springs.turned_over >= 9, "{seed}: {springs:?}");
    }
}
