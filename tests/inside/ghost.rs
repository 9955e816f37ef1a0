//! Tests of `src/picture/ghost.rs`.

use super::*;
use crate::look::View;
use crate::picture::Framing;
use crate::picture::camera::Lens;
use crate::sim::Dimension;
use glam::{DVec3, Vec2};

const ROOM: [f64; 4] = [0.0, 0.0, 640.0, 640.0];

/// The outline of triangles between points, seen from the right and above.
fn seen(position: &[DVec3], triangles: &[[u32; 3]]) -> Path {
    let mut view = View::default();
    (view.camera.azimuth, view.camera.elevation, view.camera.distance) = (0.5, 0.3, 8.0);
    let lens = Lens::new(&view, &Framing::still(&view.camera), Dimension::Space, [0.0, 0.0, 640.0, 640.0], 1.0);
    let pixel = |at: &DVec3| DVec2::from(lens.project(*at).expect("before the camera").0);
    outline(&position.iter().map(pixel).collect::<Vec<_>>(), triangles, &[], ROOM)
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
    assert_eq!(outline(&pixels, &triangles, &[], ROOM).points().len(), 7);
}

#[test]
fn nothing_is_drawn_outside_of_the_room() {
    // The room shows a part of one side of the triangle, and a part of the bar.
    let pixels = [[-1e9, 320.0], [600.0, -1e9], [600.0, 1e9], [-50.0, 100.0], [50.0, 100.0]].map(DVec2::from);
    let points = outline(&pixels, &[[0, 1, 2]], &[[3, 4]], ROOM).points();
    let expected = [[600.0, 0.0], [600.0, 640.0], [0.0, 100.0], [50.0, 100.0]].map(Vec2::from);
    assert_eq!(points, expected);
}

#[test]
fn bodies_of_many_triangles_are_outlined_at_once() {
    let cells = 200_u32;
    let node = |x: u32, y: u32| y * (cells + 1) + x;
    let at = |node: u32| 3.0 * DVec2::new(f64::from(node % (cells + 1)), f64::from(node / (cells + 1))) + 0.25;
    let pixels: Vec<_> = (0..(cells + 1).pow(2)).map(at).collect();
    let cell = |x, y| {
        // Each second cell is turned over.
        let [a, b, c, d] = [node(x, y), node(x + 1, y), node(x + 1, y + 1), node(x, y + 1)];
        if (x + y) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] }
    };
    let triangles: Vec<_> = (0..cells).flat_map(|y| (0..cells).flat_map(move |x| cell(x, y))).collect();
    let points = outline(&pixels, &triangles, &[], ROOM).points();
    let on_border = |at: &Vec2| [at.x, at.y].iter().any(|at| !(1.0..=600.0).contains(at));
    assert!(points.len() == 4 * cells as usize + 1 && points.iter().all(on_border), "{}", points.len());
}
