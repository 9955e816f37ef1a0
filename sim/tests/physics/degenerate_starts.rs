//! Starts from which the shape model must recover and mass-spring need not (paper, section 3).

use super::support::{Noise, body, free, lattice, mass_spring, shape_based};
use glam::DVec3;
use localshape_sim::model::shape_based::{DampingReading, RotationReading, ShapeBased};
use localshape_sim::{Dimension, Springs, State, Status};
use std::f64::consts::TAU;

/// Corners of the unit cube moved by `map`, with a slight disorder: perfect symmetry would be an unstable equilibrium.
fn start(map: impl Fn(DVec3) -> DVec3, disorder: f64) -> State {
    let body = lattice(1, 1.0);
    let mut noise = Noise(21);
    State::at_rest(body.rest().iter().map(|&rest| map(rest - DVec3::splat(0.5)) + noise.vector() * disorder).collect())
}

fn after_long(model: &dyn localshape_sim::model::ElasticModel, start: State) -> localshape_sim::Snapshot {
    let mut world = free(&lattice(1, 1.0), start, model, TAU / 100.0 / 50.0);
    world.advance(5000);
    world.snapshot()
}

#[test]
fn the_shape_model_recovers_from_a_point_a_line_a_plane_and_mirror_images() {
    type Map = fn(DVec3) -> DVec3;
    let starts: [(&str, Map); 6] = [
        ("a point", |_| DVec3::ZERO),
        ("a line", |r| DVec3::X * r.x),
        ("a plane", |r| r.with_z(0.0)),
        ("a mirror image", |r| r * DVec3::new(1.0, 1.0, -1.0)),
        ("an inversion", |r| -r),
        ("half a turn", |r| r * DVec3::new(-1.0, -1.0, 1.0)),
    ];
    for (name, map) in starts {
        for disorder in [0.0, 1e-3] {
            let end = after_long(&shape_based(1e4, 40.0), start(map, disorder));
            let d = end.diagnostics;
            assert!(d.shape_error < 1e-9 && d.turned_over == 0, "{name} ({disorder}): {d:?}");
            assert!(end.position.iter().all(|p| p.is_finite()));
        }
    }
}

#[test]
fn mass_spring_stays_inverted() {
    let body = lattice(1, 1.0);
    let springs = mass_spring(&body, 1e4, 40.0, Springs::All);
    let end = after_long(&springs, start(|r| r * DVec3::new(1.0, 1.0, -1.0), 1e-3));
    assert_eq!(end.diagnostics.turned_over, 1);
    assert!((end.diagnostics.volume_ratio + 1.0).abs() < 1e-6);
}

#[test]
fn a_half_turn_at_the_start_has_no_force() {
    let half_turn = start(|r| r * DVec3::new(-1.0, -1.0, 1.0), 0.0);
    let force = super::support::forces(&lattice(1, 1.0), &shape_based(1e4, 0.0), &half_turn);
    assert!(force.iter().all(|f| f.length() < 1e-10));
}

/// In the plane: Eq. (9) with both sums zero keeps the last angle, and every shape is recovered.
#[test]
fn polygons_recover_from_a_point_a_line_a_mirror_image_and_half_a_turn() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.2, 0.9, 0.0], [0.4, 1.5, 0.0], [-0.3, 0.8, 0.0]];
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    type Map = fn(DVec3) -> DVec3;
    let starts: [(&str, Map); 4] = [
        ("a point", |_| DVec3::ZERO),
        ("a line", |r| DVec3::X * r.x),
        ("a mirror image", |r| r * DVec3::new(-1.0, 1.0, 1.0)),
        ("half a turn", |r| -r),
    ];
    for body in [
        body(Dimension::Plane, &corners, &[&[0, 1, 2, 3, 4]]),
        body(Dimension::Plane, &corners, &[&[0, 1, 2], &[0, 2, 3, 4]]),
        body(Dimension::Plane, &square, &[&[0, 1, 2, 3]]),
    ] {
        for (name, map) in starts {
            for disorder in [0.0, 1e-3] {
                let mut noise = Noise(8);
                let start = body.rest().iter().map(|&rest| map(rest) + noise.vector().with_z(0.0) * disorder).collect();
                let model = shape_based(1e4, 40.0);
                let mut world = free(&body, State::at_rest(start), &model, TAU / 100.0 / 50.0);
                world.advance(5000);
                let d = world.snapshot().diagnostics;
                assert!(d.shape_error < 1e-9 && d.turned_over == 0, "{name} ({disorder}): {d:?}");
            }
        }
    }
}

/// The readings for comparison: no start gives NaN, and a body flattened to a line or a point recovers.
#[test]
fn no_reading_fails_at_a_degenerate_start() {
    let maps: [fn(DVec3) -> DVec3; 4] =
        [|_| DVec3::ZERO, |r| DVec3::X * r.x, |r| r.with_z(0.0), |r| r * DVec3::new(1.0, 1.0, -1.0)];
    for rotation in [RotationReading::VectorLength, RotationReading::LinearUpdate] {
        for damping_of in [DampingReading::RelativeMotion, DampingReading::Deformation] {
            let model = ShapeBased { rotation, damping_of, ..shape_based(1e4, 40.0) };
            for map in maps {
                let end = after_long(&model, start(map, 1e-3));
                assert!(end.position.iter().chain(&end.velocity).all(|v| v.is_finite()), "{model:?}");
                assert_eq!(end.status, Status::Ok, "{model:?}");
            }
        }
    }
}
