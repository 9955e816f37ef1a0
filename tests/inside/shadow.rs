//! Tests of `src/picture/shadow.rs`.

use super::*;

/// A box on the floor, with triangles counter-clockwise from outside.
fn block() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let points =
        (0..8).map(|at: u32| DVec3::new(f64::from(at & 1) - 0.5, f64::from(at >> 1 & 1), f64::from(at >> 2) - 0.5));
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]: &[u32; 4]| [[a, b, c], [a, c, d]]).collect();
    (points.collect(), triangles)
}

/// A surface that casts a shadow.
fn caster(points: Vec<DVec3>, triangles: &[[u32; 3]]) -> Casters {
    let mut casters = Casters::default();
    casters.add(points.into_iter(), triangles);
    casters
}

fn value(shade: &Shade, at: DVec2) -> u8 {
    let corner = DVec2::new(f64::from(shade.corner[0]), f64::from(shade.corner[1]));
    let cell = ((at - corner) * CELLS as f64 / f64::from(shade.length)).floor();
    if cell.min_element() < 0.0 || cell.max_element() >= CELLS as f64 {
        return 0;
    }
    shade.cells[cell.y as usize * CELLS + cell.x as usize]
}

#[test]
fn a_block_shades_what_lies_behind_it_and_nothing_before_it() {
    let (points, triangles) = block();
    let plane = Plane::new(DVec3::Y, 0.0);
    let key = DVec3::new(-1.0, 1.0, 0.0).normalize();
    let [of_key, of_sky] = caster(points, &triangles).shades(&plane, key, 4.0, 1.0);
    let on_floor = |x: f64, z: f64| DVec2::new(x * plane.axes[0].x + z * plane.axes[0].z, z * plane.axes[1].z);
    assert_eq!(value(&of_key, on_floor(0.0, 0.0)), 255);
    assert!(value(&of_key, on_floor(1.0, 0.0)) > 250);
    assert_eq!(value(&of_key, on_floor(-1.0, 0.0)), 0);
    assert_eq!(value(&of_key, on_floor(2.5, 0.0)), 0);
    let near = value(&of_sky, on_floor(0.7, 0.0));
    let far = value(&of_sky, on_floor(2.0, 0.0));
    assert!(near > 60 && far < near / 3, "{near} {far}");
}

#[test]
fn outlines_cover_what_triangles_cover() {
    // Two blocks that share an edge, one of them with a corner pushed right through it.
    let (mut points, mut triangles) = block();
    let (others, more) = block();
    let meets = |point: DVec3| [2, 6].into_iter().find(|&at: &usize| point == DVec3::new(-0.5, 1.0, others[at].z));
    let moved: Vec<_> = others.iter().map(|&point| point + DVec3::new(-1.0, 1.0, 0.0)).collect();
    let places: Vec<_> = moved.iter().map(|&point| meets(point).unwrap_or(usize::MAX)).collect();
    let places: Vec<_> = places
        .iter()
        .zip(&moved)
        .map(|(&place, &point)| match place {
            usize::MAX => {
                points.push(point);
                points.len() as u32 - 1
            }
            place => place as u32,
        })
        .collect();
    assert_eq!(points.len(), 14);
    triangles.extend(more.iter().map(|triangle| triangle.map(|at| places[at as usize])));
    points[0] = DVec3::new(1.7, 1.9, 0.3);
    let plane = Plane::new(DVec3::Y, 0.0);
    let feet: Vec<_> = points.iter().map(|&point| plane.foot(point)).collect();
    let slants: Vec<_> = (0..AT_ONCE).map(|at| DVec2::from_angle(at as f64) * (0.03 * at as f64)).collect();
    let edges = edges(&triangles);
    let turns: Vec<_> = triangles.iter().map(|triangle| turn(triangle.map(|at| feet[at as usize]))).collect();
    let mut outlines = Outlines::default();
    outlines.find(&turns, &edges, &slants);
    for (at, &slant) in slants.iter().enumerate() {
        let shadow = |end: u32| (feet[end as usize].shadow(slant) + DVec2::new(4.1, 3.9)) * 16.0;
        let mut cover = Cover::new();
        outlines.of(at, &edges).for_each(|ends| cover.bound(ends.map(shadow)));
        cover.count();
        for (row, column) in (0..CELLS).flat_map(|row| (0..CELLS).map(move |column| (row, column))) {
            let middle = DVec2::new(column as f64, row as f64) + 0.5;
            let holds = |triangle: &[u32; 3]| {
                let [a, b, c] = triangle.map(shadow);
                let areas = [[a, b], [b, c], [c, a]].map(|[a, b]| (b - a).perp_dot(middle - a));
                areas.iter().all(|&area| area > 0.0) || areas.iter().all(|&area| area < 0.0)
            };
            let count = cover.counts[row / LANES * COLUMNS + column][row % LANES];
            assert_eq!(count == 1, triangles.iter().any(holds), "{slant} at {middle}");
        }
    }
}

#[test]
fn floors_at_any_slope_have_right_angled_axes() {
    for normal in [DVec3::Y, DVec3::X, DVec3::new(1.0, 2.0, 3.0).normalize()] {
        let plane = Plane::new(normal, 0.0);
        let [a, b] = plane.axes;
        assert!(a.dot(b).abs() + a.dot(normal).abs() + b.dot(normal).abs() < 1e-12);
        assert!((a.length() - 1.0).abs() + (b.length() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn wild_coordinates_do_no_harm() {
    let (mut points, triangles) = block();
    points[3] = DVec3::new(1e300, -1e300, 1e6);
    points[5] = DVec3::splat(f64::MAX);
    let plane = Plane::new(DVec3::Y, 0.0);
    let key = DVec3::new(-0.3, 0.9, 0.1).normalize();
    let [a, b] = caster(points, &triangles).shades(&plane, key, 4.0, 1.0);
    assert!(a.length.is_finite() && b.length.is_finite() && a.corner.iter().all(|at| at.is_finite()));
}

#[test]
fn a_coarse_shape_is_closed_and_casts_nearly_the_same_shadow() {
    const ROWS: u32 = 60;
    const COLUMNS: u32 = 120;
    let place = |row: u32, column: u32| {
        let angles = [(row, ROWS, 1.0), (column, COLUMNS, 2.0)];
        let [polar, round] = angles.map(|(at, of, half)| half * std::f64::consts::PI * f64::from(at) / f64::from(of));
        let across = libm::sin(polar);
        DVec3::new(across * libm::cos(round), 1.0 + 0.15 * libm::cos(polar), across * libm::sin(round))
    };
    // A flat disc with round edges.
    let points: Vec<_> = (0..=ROWS).flat_map(|row| (0..COLUMNS).map(move |column| place(row, column))).collect();
    let at =
        |row: u32, column: u32| if row.is_multiple_of(ROWS) { row * COLUMNS } else { row * COLUMNS + column % COLUMNS };
    let cells = (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |column| (row, column)));
    let triangles: Vec<_> = cells
        .flat_map(|(row, column)| {
            let [a, b] = [0, 1].map(|right| at(row, column + right));
            let [d, c] = [0, 1].map(|right| at(row + 1, column + right));
            [[a, b, c], [a, c, d]].into_iter().filter(|[a, b, c]| a != b && b != c && c != a)
        })
        .collect();
    assert!(triangles.len() > 3 * OF_SHAPE);
    let shape = SurfaceCaster::new(&points, &triangles);
    assert!(shape.triangles.len() <= OF_SHAPE && shape.triangles.len() > OF_SHAPE / 4, "{}", shape.triangles.len());
    assert!(shape.edges.iter().all(|edge| edge.triangles().iter().all(Option::is_some)));
    let fine = caster(points.clone(), &triangles);
    let mut coarse = Casters::default();
    coarse.add_shape(shape.points.iter().map(|&at| points[at as usize]), &shape);
    let plane = Plane::new(DVec3::Y, 0.0);
    let key = DVec3::new(-1.0, 2.0, 0.5).normalize();
    let [fine, coarse] = [fine, coarse].map(|casters| casters.shades(&plane, key, 4.0, 1.0));
    for (one, other) in fine.iter().zip(&coarse) {
        assert_eq!(one.cells.len(), other.cells.len());
        let apart = one.cells.iter().zip(&other.cells).map(|(a, b)| a.abs_diff(*b));
        let (apart, darkest) = (apart.max(), one.cells.iter().max());
        assert!(darkest > Some(&100) && apart < Some(26), "{darkest:?} {apart:?}");
    }
}

/// However many triangles stay in the coarsest grid, the search for a coarser shape ends.
#[test]
fn a_thousand_boxes_in_each_other_cast_the_shadow_of_one() {
    let (of_one, sides) = block();
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for (at, first) in (0..8 * 1000).step_by(8).enumerate() {
        points.extend(of_one.iter().map(|point| *point * (1.0 - 1e-6 * at as f64)));
        triangles.extend(sides.iter().map(|of| of.map(|point| first + point)));
    }
    let shape = SurfaceCaster::new(&points, &triangles);
    let one = caster(of_one, &sides);
    let mut all = Casters::default();
    all.add_shape(shape.points.iter().map(|&at| points[at as usize]), &shape);
    let (plane, key) = (Plane::new(DVec3::Y, 0.0), DVec3::new(-1.0, 2.0, 0.5).normalize());
    let [one, all] = [one, all].map(|casters| casters.shades(&plane, key, 4.0, 1.0));
    for (one, all) in one.iter().zip(&all) {
        let apart = one.cells.iter().zip(&all.cells).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(one.cells.iter().max() > Some(&100) && apart < Some(40), "{apart:?}");
    }
}
