//! What surfaces are, and how they are mended.

use crate::common::{apart, ball, block, ring, scan, together};
use glam::DVec3;
use localshape_mesh::{Fill, Flaws, Surface, fill};

#[test]
fn a_sound_surface_stays_as_it_is() {
    let cube = block(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0));
    let (mended, flaws) = cube.mended();
    assert_eq!(mended, cube);
    assert_eq!(flaws, Flaws { pieces: 1, ..Flaws::default() });
    let measures = cube.measures();
    assert_eq!((measures.volume, measures.area, measures.euler), (6.0, 22.0, 2));
    assert!(measures.closed);
    assert_eq!((measures.low, measures.high), (DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)));
    assert_eq!(ring(1.0, 0.3, 40).measures().euler, 0);
    assert!(Surface::default().mended().0.triangles.is_empty());
}

#[test]
fn points_at_one_place_are_welded_and_triangles_without_area_dropped() {
    let cube = block(DVec3::ZERO, DVec3::ONE);
    let (mended, flaws) = apart(&cube).mended();
    assert_eq!((mended.measures(), flaws.welded, flaws.boundary), (cube.measures(), 28, 0));
    // A ball's poles are many points at one place.
    let (mended, flaws) = ball(DVec3::ONE, 1.0, 20).mended();
    assert_eq!((flaws.welded, flaws.degenerate, flaws.boundary), (38, 40, 0));
    assert_eq!(mended.measures().euler, 2);
    // A triangle without area that closes a surface stays.
    let mut split = cube.clone();
    split.points.push(DVec3::new(0.0, 0.5, 0.5));
    let [a, b] = [split.triangles[0], split.triangles[1]];
    assert_eq!([a, b], [[0, 4, 6], [0, 6, 2]]);
    split.triangles[1] = [0, 8, 2];
    split.triangles.push([8, 6, 2]);
    split.triangles.push([0, 6, 8]);
    assert_eq!(split.mended().1, Flaws { pieces: 1, ..Flaws::default() });
    // One that does not, one with a corner that is no number, and one with a corner that is missing, are dropped.
    let mut loose = cube;
    loose.points.extend([DVec3::splat(2.0), DVec3::splat(3.0), DVec3::splat(4.0), DVec3::splat(f64::NAN)]);
    loose.triangles.extend([[8, 9, 10], [0, 1, 11], [0, 1, 12]]);
    assert_eq!(loose.mended().1, Flaws { degenerate: 3, pieces: 1, ..Flaws::default() });
}

#[test]
fn doubled_triangles_are_dropped_and_walls_stay() {
    let cube = block(DVec3::ZERO, DVec3::ONE);
    let mut doubled = cube.clone();
    doubled.triangles.extend([[4, 6, 0], [1, 3, 7]]);
    let (mended, flaws) = doubled.mended();
    assert_eq!((mended, flaws.doubled), (cube.clone(), 2));
    // A surface drawn from both sides has one.
    let mut two_sided = cube.clone();
    two_sided.triangles.extend(cube.triangles.iter().map(|&[a, b, c]| [c, b, a]));
    let (mended, flaws) = two_sided.mended();
    assert_eq!((mended, flaws.doubled), (cube.clone(), 12));
    // Two blocks side by side keep their wall, and have the volume of both.
    let pair = together(&[cube, block(DVec3::X, DVec3::new(2.0, 1.0, 1.0))]);
    let (mended, flaws) = pair.mended();
    assert_eq!((flaws.doubled, flaws.non_manifold, flaws.boundary, flaws.turned), (0, 5, 0, 0));
    assert!(mended.measures().closed && mended.measures().volume == 2.0);
}

#[test]
fn pieces_are_turned_out_and_cavities_in() {
    let turned = |surface: &Surface| Surface {
        triangles: surface.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(),
        ..surface.clone()
    };
    let cube = block(DVec3::ZERO, DVec3::ONE);
    let (mended, flaws) = turned(&cube).mended();
    assert_eq!((mended, flaws.turned), (cube.clone(), 12));
    let mut partly = cube.clone();
    for triangle in [1, 5, 6] {
        partly.triangles[triangle].swap(0, 1);
    }
    let (mended, flaws) = partly.mended();
    assert_eq!((mended.measures(), flaws.turned, flaws.inconsistent), (cube.measures(), 3, 0));
    let hole = block(DVec3::splat(0.25), DVec3::splat(0.75));
    let far = block(DVec3::splat(2.0), DVec3::splat(3.0));
    // However all of a file looks, a piece that looks the other way than the one around it is a cavity.
    let hollow = together(&[cube.clone(), turned(&hole), far.clone()]);
    let volume = |surface: &Surface| surface.mended().0.measures().volume;
    assert!([hollow.clone(), turned(&hollow)].iter().all(|hollow| (volume(hollow) - 1.875).abs() < 1e-14));
    assert_eq!(hollow.mended().1, Flaws { pieces: 3, ..Flaws::default() });
    assert_eq!(turned(&hollow).mended().1.turned, 36);
    assert!((volume(&together(&[hole, cube])) - 1.125).abs() < 1e-14);
}

#[test]
fn edges_that_are_open_or_cannot_agree_are_counted() {
    let mut open = block(DVec3::ZERO, DVec3::ONE);
    open.triangles.pop();
    let flaws = open.mended().1;
    assert_eq!((flaws.boundary, flaws.inconsistent), (3, 0));
    assert!(!open.measures().closed);
    // A strip with half a turn.
    let count = 12;
    let strip = (0..count).flat_map(|n| {
        let turn = std::f64::consts::TAU * f64::from(n) / f64::from(count);
        let (sin, cos, s, c) = (libm::sin(turn), libm::cos(turn), libm::sin(turn / 2.0), libm::cos(turn / 2.0));
        [-0.3, 0.3].map(|w| DVec3::new((1.0 + w * c) * cos, (1.0 + w * c) * sin, w * s))
    });
    let points: Vec<_> = strip.collect();
    let triangles = (0..count).flat_map(|n| {
        let [a, b] = [2 * n, 2 * n + 1];
        let [c, d] = if n == count - 1 { [1, 0] } else { [2 * n + 2, 2 * n + 3] };
        [[a, b, c], [b, d, c]]
    });
    let flaws = Surface { points, triangles: triangles.collect(), ..Surface::default() }.mended().1;
    assert_eq!((flaws.boundary, flaws.inconsistent, flaws.pieces), (24, 1, 1));
}

/// Of a triangle with two edges longer than the elements, four corners are left behind the third: the shorter diagonal divides them.
#[test]
fn triangles_with_two_long_edges_are_cut_along_the_shorter_diagonal() {
    let base = [DVec3::ZERO, DVec3::new(0.5, 0.0, 0.1), DVec3::new(0.2, 0.0, 0.45)];
    let apex = DVec3::new(0.9, 1.0, 0.1);
    let points = vec![base[0], base[1], base[2], apex];
    for triangles in
        [vec![[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]], vec![[1, 2, 0], [3, 1, 0], [3, 2, 1], [0, 2, 3]]]
    {
        let surface = Surface { points: points.clone(), triangles, ..Surface::default() };
        let filled = fill(&surface, Fill::Cubes { side: 1.0 }, 1000).expect("an inside").surface;
        assert_eq!((filled.points.len(), filled.triangles.len()), (7, 10), "each long edge is halved once");
        let at =
            |place: DVec3| filled.points.iter().position(|point| point.distance(place) < 1e-4).expect("a point") as u32;
        let is_edge = |[one, other]: [DVec3; 2]| {
            let ends = [at(one), at(other)];
            filled.triangles.iter().any(|triangle| ends.iter().all(|end| triangle.contains(end)))
        };
        for (one, other) in [(0, 1), (1, 2), (2, 0)] {
            let [middle, next] = [one, other].map(|corner: usize| base[corner].midpoint(apex));
            let diagonals = [[base[one], next], [base[other], middle]];
            let [first, second] = diagonals.map(|[one, other]| one.distance(other));
            let (shorter, longer) = if first < second { (0, 1) } else { (1, 0) };
            assert!(is_edge(diagonals[shorter]) && !is_edge(diagonals[longer]), "{one}–{other}: {first} {second}");
        }
    }
}

#[test]
fn scans_are_measured() {
    for (name, points, euler, boundary) in
        [("armadillo.off", 26_002, 2, 0), ("elephant.off", 2775, -4, 0), ("cheese.off", 8629, -264, 0)]
    {
        let Some(surface) = scan(name) else { return };
        let (mended, flaws) = surface.mended();
        let measures = mended.measures();
        println!("{name}: {flaws:?} {measures:?}");
        assert_eq!((mended.points.len(), measures.euler, flaws.boundary), (points, euler, boundary), "{name}");
        assert!(measures.closed && measures.volume > 0.0);
    }
}
