//! Polygons and other cells, and what becomes of them.

use super::{LIMITS, lines, surface, volume};
use glam::DVec3;
use localshape_mesh::{CellKind, Format, Volume, read, read_cells};
use localshape_sim::geometry::volume_by_faces;
use localshape_sim::{Dimension, ElementKind};

#[test]
fn a_concave_polygon_keeps_its_area_and_its_corners_on_straight_sides() {
    // A comb with a corner on its straight back, in several planes and from either side.
    let flat =
        [[0., 0.], [6., 0.], [6., 4.], [5., 4.], [5., 1.], [4., 1.], [4., 4.], [3., 4.], [3., 1.], [2., 1.], [2., 4.]];
    let flat = [&flat[..], &[[0., 4.], [0., 2.], [0., 1.]]].concat();
    let area = 6.0 * 4.0 - 2.0 * 3.0;
    for turn in 0..3 {
        for back in [false, true] {
            let mut points: Vec<DVec3> = flat
                .iter()
                .map(|&[x, y]| {
                    let mut point = [x, y, 0.25 * x];
                    point.rotate_right(turn);
                    DVec3::from(point)
                })
                .collect();
            if back {
                points.reverse();
            }
            let text = format!(
                "OFF\n{} 1 0\n{}{} {}\n",
                points.len(),
                lines(points.iter().copied()),
                points.len(),
                (0..points.len()).map(|at| at.to_string()).collect::<Vec<_>>().join(" ")
            );
            let found = surface(text.as_bytes(), Format::Off);
            assert_eq!(found.triangles.len(), points.len() - 2);
            let whole: DVec3 = (0..points.len()).map(|at| points[at].cross(points[(at + 1) % points.len()])).sum();
            let mut sum = 0.0;
            for &corners in &found.triangles {
                let [a, b, c] = corners.map(|corner| found.points[corner as usize]);
                let normal = (b - a).cross(c - a);
                assert!(normal.dot(whole) > 0.0, "{corners:?} is turned over or flat");
                sum += 0.5 * normal.length();
            }
            assert!((sum - area * (1.0f64 + 0.25 * 0.25).sqrt()).abs() < 1e-12, "{sum}");
        }
    }
}

#[test]
fn a_polygon_that_crosses_itself_is_divided_somehow() {
    let text = "OFF\n5 1 0\n0 0 0\n2 2 1\n2 0 0\n0 2 1\n1 3 0\n5 0 1 2 3 4\n";
    assert_eq!(surface(text.as_bytes(), Format::Off).triangles.len(), 3);
}

/// The time is bounded for hostile polygons, too.
#[test]
fn a_polygon_with_very_many_teeth_is_refused_or_read() {
    let teeth = 100_000;
    let mut text = format!("OFF\n{} 1 0\n", 2 * teeth + 1);
    for tooth in 0..2 * teeth {
        text +=
            &format!("{tooth} {} {}\n", if tooth % 2 == 0 { 1.0 } else { 1000.0 - 1e-3 * f64::from(tooth) }, tooth % 3);
    }
    text += &format!("{teeth} -1e6 0\n{}", 2 * teeth + 1);
    (0..=2 * teeth).for_each(|at| text += &format!(" {at}"));
    let found = read(text.as_bytes(), Format::Off, &LIMITS);
    let error = found.expect_err("too much work");
    assert!(error.message.starts_with("has concave faces that take too long to divide"), "{error}");
}

#[test]
fn faces_in_a_plane_are_a_volume_of_it_and_turned_counter_clockwise() {
    // A triangle, a clockwise one, and a quadrilateral whose corners are listed along its axes.
    let points = "9 9 9\n0 0 2\n1 0 2\n0 1 2\n1 1 2\n2 0 2\n2 1 2\n";
    let faces = "3 1 2 3\n3 2 3 4\n4 2 5 4 6\n";
    let text = format!(
        "# vtk DataFile Version 3.0\nfaces\nASCII\nDATASET POLYDATA\nPOINTS 7 double\n{points}POLYGONS 3 13\n{faces}"
    );
    let found = volume(text.as_bytes(), Format::Vtk);
    assert_eq!(found.dimension, Dimension::Plane);
    assert_eq!(found.points.len(), 6, "a point without faces is dropped");
    assert_eq!(found.turned, 2);
    let areas = found.cells.iter().map(|cell| volume_by_faces(ElementKind::Polygon, cell, &found.points));
    assert_eq!(areas.collect::<Vec<_>>(), [0.5, 0.5, 1.0]);
    // A format of surfaces alone says that they bound something.
    let text = format!("OFF\n7 3 0\n{points}{faces}");
    assert_eq!(surface(text.as_bytes(), Format::Off).triangles.len(), 4);
}

#[test]
fn cells_are_given_as_they_are_listed() {
    let text = "OFF\n4 2 0\n9 9 9\n0 0 0\n1 0 1\n0 1 1\n3 1 2 3\n2 1 2\n";
    let found = read_cells(text.as_bytes(), Format::Off, &LIMITS).expect("sound");
    assert_eq!(found.points.len(), 4);
    assert_eq!(found.kinds, [CellKind::Polygon, CellKind::Line]);
    assert_eq!(&found.corners[0], [1, 2, 3]);
}

#[test]
fn elements_of_files_without_solids_are_faces_or_else_lines() {
    let elements = |lists: &str, dimension| {
        let text = format!("OFF\n6 {} 0\n9 9 9\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n{lists}", lists.lines().count());
        read_cells(text.as_bytes(), Format::Off, &LIMITS).expect("sound").elements(dimension)
    };
    let found = |lists: &str, dimension| {
        let Volume { places, cells, turned, .. } = elements(lists, dimension).expect("elements");
        (places, cells.iter().map(<[u32]>::to_vec).collect::<Vec<_>>(), turned)
    };
    // Clockwise in the plane.
    assert_eq!(found("4 4 3 2 1\n2 1 5\n", Dimension::Plane), (vec![1, 2, 3, 4], vec![vec![0, 1, 2, 3]], 1));
    let triangles = vec![vec![0, 1, 2], vec![0, 2, 3]];
    assert_eq!(found("4 1 2 3 4\n2 1 5\n", Dimension::Space), (vec![1, 2, 3, 4], triangles, 0));
    assert_eq!(found("2 1 5\n2 5 3\n", Dimension::Space), (vec![1, 3, 5], vec![vec![0, 2], vec![2, 1]], 0));
    let error = elements("1 2\n", Dimension::Space).expect_err("points only");
    assert_eq!(error.message, "has 6 points, but neither faces nor cells");
}

#[test]
fn a_cell_listed_twice_is_turned_over_once() {
    let cell = "4 0 2 1 3\n";
    let text = format!(
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n0 0 0 1 0 0 0 1 0 0 0 1 2 2 2\n\
         CELLS 3 14\n{cell}{cell}3 0 1 4\nCELL_TYPES 3\n10 10 21\n"
    );
    let found = volume(text.as_bytes(), Format::Vtk);
    assert_eq!((found.cells.len(), found.turned, found.points.len()), (1, 1, 4));
    // The point between the ends of a line of second order is left out.
    let listed = read_cells(text.as_bytes(), Format::Vtk, &LIMITS).expect("sound");
    assert_eq!((listed.kinds[2], &listed.corners[2]), (CellKind::Line, &[0, 1][..]));
}
