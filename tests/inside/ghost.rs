//! Tests of `src/picture/ghost.rs`.

use super::*;
use crate::look::View;
use crate::picture::Framing;
use crate::picture::camera::Lens;
use crate::sim::Dimension;
use glam::DVec3;

/// The outline of triangles between points, seen from the right and above.
fn seen(position: &[DVec3], triangles: &[[u32; 3]]) -> Path {
    let mut view = View::default();
    (view.camera.azimuth, view.camera.elevation, view.camera.distance) = (0.5, 0.3, 8.0);
    let lens = Lens::new(&view, &Framing::still(&view.camera), Dimension::Space, [0.0, 0.0, 640.0, 640.0], 1.0);
    let pixel = |at: &DVec3| DVec2::from(lens.project(*at).expect("before the camera").0);
    outline(&position.iter().map(pixel).collect::<Vec<_>>(), triangles, &[])
}

/// A cube with outward triangles.
fn cube() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let half = |at: u32, bit: u32| f64::from(at >> bit & 1) - 0.5;
    let position = (0..8).map(|at| DVec3::new(half(at, 0), half(at, 1), half(at, 2))).collect();
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    (position, faces.into_iter().flat_map(|[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]]).collect())
}

#[test]
fn a_cube_has_one_closed_outline_of_six_edges() {
    let (position, triangles) = cube();
    let points = seen(&position, &triangles).points();
    assert_eq!((points.len(), points[0]), (7, points[6]));
}

#[test]
fn edges_inside_the_outline_are_left_out() {
    // A small cube inside of a large one also turns away from the viewer, but not at the border.
    let (mut position, mut triangles) = cube();
    let alone = seen(&position, &triangles);
    let inner: Vec<_> = position.iter().map(|&at| 0.2 * at).collect();
    triangles.extend(triangles.clone().iter().map(|corners| corners.map(|at| at + 8)));
    position.extend(inner);
    assert_eq!(seen(&position, &triangles), alone);
}

#[test]
fn a_body_in_the_plane_is_outlined_without_its_inner_edges() {
    let pixels: Vec<_> = (0..6).map(|at| 100.0 * DVec2::new(f64::from(at % 3), f64::from(at / 3))).collect();
    let triangles = [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]];
    assert_eq!(outline(&pixels, &triangles, &[]).points().len(), 7);
}
