//! Tests of `src/picture/ghost.rs`.

use super::*;
use crate::look::View;
use crate::picture::{Framing, Paint, Pen};
use crate::sim::Dimension;
use glam::Vec2;

const ROOM: Rectangle = [0, 0, 640, 640];

#[test]
fn short_pieces_that_touch_nothing_are_dropped() {
    let line = |from: [f64; 2], to: [f64; 2]| vec![DVec2::from(from), DVec2::from(to)];
    let (long, beside) = (line([0.0, 0.0], [20.0, 0.0]), line([20.4, 0.0], [23.0, 1.0]));
    let stray = line([10.0, 5.0], [12.0, 5.0]);
    let all = vec![stray.clone(), long.clone(), beside.clone()];
    assert_eq!(without_stray(all, 6.5), [long, beside]);
    assert_eq!(without_stray(vec![stray.clone()], 6.5), [stray]);
}

fn lens(dimension: Dimension) -> Lens {
    let mut view = View::default();
    (view.camera.azimuth, view.camera.elevation, view.camera.distance) = (0.5, 0.3, 8.0);
    Lens::new(&view, &Framing::still(&view.camera), dimension, ROOM.map(f64::from), 1.0)
}

fn outline(lens: &Lens, position: &[DVec3], triangles: &[[u32; 3]], room: Rectangle) -> Vec<Vec<DVec2>> {
    let nodes: Vec<u32> = (0..position.len() as u32).collect();
    Ghost { lens, position, nodes: &nodes, triangles, bars: &[], room }.outline()
}

/// The points, the pen and the paint of lines.
fn lines(items: &[Item]) -> Vec<(Vec<Vec2>, Pen, Paint)> {
    let one = |item: &Item| match item {
        Item::Stroke { path, pen, paint } => (path.points(), pen.clone(), *paint),
        other => panic!("{other:?}"),
    };
    items.iter().map(one).collect()
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
    let lens = lens(Dimension::Space);
    let (position, triangles) = cube();
    let lines = outline(&lens, &position, &triangles, ROOM);
    let [line] = &lines[..] else { panic!("{lines:?}") };
    assert_eq!((line.len(), line[0]), (7, line[6]));
    // Dashes are whole, and hardly longer or shorter than usual.
    let length: f64 = line.windows(2).map(|two| two[0].distance(two[1])).sum();
    let [dash, gap] = dashes(line, 1.0);
    let count = length / (dash + gap);
    assert!((count - count.round()).abs() < 1e-9 && (dash / DASH[0] - 1.0).abs() < 0.1, "{count}");
}

#[test]
fn an_arrow_points_to_what_lies_outside() {
    let lens = lens(Dimension::Space);
    let (mut position, triangles) = cube();
    position.iter_mut().for_each(|at| at.y += 20.0);
    let nodes: Vec<u32> = (0..8).collect();
    let ghost = Ghost { lens: &lens, position: &position, nodes: &nodes, triangles: &triangles, bars: &[], room: ROOM };
    let mut curves = Vec::new();
    ghost.draw(Scale::REFERENCE, [0; 3], [255; 3], &mut curves);
    let curves = lines(&curves);
    // A shaft and a head, each with a halo, at the upper border.
    assert_eq!(curves.iter().map(|curve| curve.0.len()).collect::<Vec<_>>(), [2, 3, 2, 3]);
    let [tail, tip] = [0, 1].map(|at| curves[0].0[at]);
    assert_eq!((tip, tip.y < tail.y, curves[0].1.dash.len()), (curves[1].0[1], true, 0));
    assert!((tip.y - POINTER[2] as f32).abs() < 1e-3, "{tip:?}");
    // Both wings mirror each other about the shaft.
    let [tail, tip, wing, other] = [tail, tip, curves[1].0[0], curves[1].0[2]];
    let [shaft, one, other] = [tail, wing, other].map(|end| end - tip);
    let mirrored = 2.0 * one.project_onto(shaft) - one;
    assert!(other.distance(mirrored) < 1e-3 && one.perp_dot(shaft).abs() > 1.0, "{one} {other}");
}

#[test]
fn a_ghost_fades_where_it_leaves() {
    let lens = lens(Dimension::Space);
    let (mut position, triangles) = cube();
    position.iter_mut().for_each(|at| at.x += 0.3);
    let nodes: Vec<u32> = (0..8).collect();
    let drawn = |room: Rectangle| {
        let (lens, position, nodes, triangles) = (&lens, &position, &nodes, &triangles);
        let ghost = Ghost { lens, position, nodes, triangles, bars: &[], room };
        let mut curves = Vec::new();
        ghost.draw(Scale::REFERENCE, [0; 3], [255; 3], &mut curves);
        let mut curves = lines(&curves);
        curves.retain(|(_, _, paint)| paint.colour == [0; 3]);
        curves
    };
    let whole = drawn(ROOM);
    assert!(whole.len() == 1 && !whole[0].1.dash.is_empty() && whole[0].2.alpha == 1.0);
    let xs = || whole[0].0.iter().map(|at| at.x);
    let middle = xs().fold(0.0, |sum: f32, x| sum + x) / xs().count() as f32;
    // In a room that ends within the body, each dash is separate, and fainter towards the side.
    let cut = drawn([0, 0, middle as u32 + 30, 640]);
    let right = |(points, ..): &(Vec<Vec2>, Pen, Paint)| points.iter().fold(0.0, |most: f32, at| most.max(at.x));
    let last = cut.iter().max_by(|a, b| right(a).total_cmp(&right(b))).unwrap();
    assert!(last.1.dash.is_empty() && last.2.alpha < 0.2, "{last:?}");
    assert!(cut.iter().any(|(_, _, paint)| paint.alpha == 1.0));
}

#[test]
fn edges_inside_the_outline_are_left_out() {
    // A small cube in front of a large one also turns away from the viewer, but not at the border.
    let lens = lens(Dimension::Space);
    let (mut position, mut triangles) = cube();
    let [towards, small]: [DVec3; 2] = [(lens.eye - DVec3::ZERO).normalize(), DVec3::splat(0.2)];
    let inner: Vec<_> = position.iter().map(|&at| 1.2 * towards + small * at).collect();
    triangles.extend(triangles.clone().iter().map(|corners| corners.map(|at| at + 8)));
    let alone = outline(&lens, &position, &triangles[..12], ROOM);
    position.extend(inner);
    assert_eq!(outline(&lens, &position, &triangles, ROOM), alone);
}

#[test]
fn a_body_in_the_plane_is_outlined_without_its_inner_edges() {
    let lens = lens(Dimension::Plane);
    let position: Vec<_> = (0..6).map(|at| DVec3::new(f64::from(at % 3) - 1.0, f64::from(at / 3), 0.0)).collect();
    let triangles = [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]];
    let lines = outline(&lens, &position, &triangles, ROOM);
    assert_eq!(lines.iter().map(Vec::len).collect::<Vec<_>>(), [7]);
    // Nothing is drawn outside of the room.
    let room = [380, 250, 200, 200];
    let lines = outline(&lens, &position, &triangles, room);
    let [left, top, right, bottom] = sides(room.map(f64::from));
    assert!(!lines.is_empty());
    for point in lines.iter().flatten() {
        let inside = (left - 1e-9..=right + 1e-9).contains(&point.x) && (top - 1e-9..=bottom + 1e-9).contains(&point.y);
        assert!(inside, "{point}");
    }
}
