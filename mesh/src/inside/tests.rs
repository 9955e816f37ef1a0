//! Points inside surfaces, closed and open ones.

use super::winding::HalfAngle;
use super::*;

struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next())
    }
}

fn cube() -> Surface {
    let points = (0..8u32).map(|n| DVec3::from_array([n & 1, n >> 1 & 1, n >> 2].map(f64::from))).collect();
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Surface { points, triangles, ..Surface::default() }
}

/// The triangles of a surface as caps, for their winding number.
fn all(surface: &Surface) -> Caps {
    Caps::new(surface.triangles.iter().map(|&of| surface.corners(of)).collect())
}

#[test]
fn the_winding_number_of_a_cube_is_the_part_of_the_sphere_that_it_hides() {
    let caps = all(&cube());
    for (point, expected) in [
        ([0.5, 0.5, 0.5], 1.0),
        ([0.1, 0.9, 0.01], 1.0),
        ([0.5, 0.25, 0.0], 0.5),
        ([0.5, 0.0, 1.0], 0.25),
        ([0.0, 1.0, 1.0], 0.125),
        ([1.5, 0.5, 0.5], 0.0),
        ([2.0, 2.0, 1.0], 0.0),
    ] {
        let found = caps.winding(DVec3::from_array(point));
        assert!((found - expected).abs() < 1e-12, "{point:?}: {found}");
    }
}

/// Points on faces, edges and corners are inside or outside, but never both for two cubes that share a face.
#[test]
fn each_point_is_inside_one_of_the_blocks_that_fill_space() {
    let blocks: Vec<_> = (0..27u32)
        .map(|n| {
            let shift = DVec3::from_array([n % 3, n / 3 % 3, n / 9].map(f64::from));
            let cube = cube();
            Inside::new(&Surface { points: cube.points.iter().map(|point| point + shift).collect(), ..cube })
        })
        .collect();
    let grid = Grid { first: DVec3::splat(0.5), side: 0.25, counts: [9; 3] };
    let all: Vec<Vec<bool>> = blocks.iter().map(|block| block.grid(&grid)).collect();
    for at in 0..729 {
        assert_eq!(all.iter().filter(|inside| inside[at]).count(), 1, "{at}");
        let point = grid.first + grid.side * DVec3::from_array([at % 9, at / 9 % 9, at / 81].map(|at| at as f64));
        assert!(blocks.iter().zip(&all).all(|(block, inside)| block.contains(point) == inside[at]));
    }
}

/// A point in a slanted face counts as moved along y, and along z only if that leaves it in the face.
#[test]
fn points_in_faces_are_moved_along_y_before_z() {
    for [a, b] in [[0.5, 0.25], [0.5, -0.25], [-0.5, 0.25], [-0.5, -0.25], [0.0, 0.25], [0.0, -0.25]] {
        // All numbers are exact.
        let slanted = |at: DVec3| DVec3::new(at.x + a * at.y + b * at.z, at.y, at.z);
        let cube = cube();
        let inside = Inside::new(&Surface { points: cube.points.iter().map(|&at| slanted(at)).collect(), ..cube });
        let is_inside = if a == 0.0 { b > 0.0 } else { a > 0.0 };
        for [y, z] in [[0.25, 0.5], [0.75, 0.25]] {
            assert_eq!(inside.contains(slanted(DVec3::new(1.0, y, z))), is_inside, "{a} {b}");
            assert_eq!(inside.contains(slanted(DVec3::new(0.0, y, z))), !is_inside, "{a} {b}");
        }
    }
}

/// The same move decides which of two faces counts for a point on the edge between them.
#[test]
fn points_on_slanted_edges_are_moved_along_y_before_z() {
    let mut ridge = cube();
    ridge.points[3].x = 2.0;
    // Towards +y the surface rises from the diagonal at x = 1, towards +z it stays level.
    assert!(Inside::new(&ridge).contains(DVec3::new(1.0, 0.5, 0.5)));
}

#[test]
fn open_edges_that_are_divided_are_closed_by_few_triangles() {
    let mut surface = cube();
    surface.triangles.truncate(10);
    assert_eq!(Inside::new(&surface).hiding.triangles.len(), 2);
    surface.refine(0.05, 100_000);
    let inside = Inside::new(&surface);
    assert!(inside.caps().len() > 80 && inside.hiding.triangles.len() == 2);
    // A triangle by itself is closed by its back.
    surface = Surface { triangles: vec![[0, 1, 2]], ..cube() };
    surface.refine(0.05, 100_000);
    assert_eq!(Inside::new(&surface).hiding.triangles.len(), 1);
}

fn solid_angle(triangle: [DVec3; 3], point: DVec3) -> f64 {
    let mut half = HalfAngle::default();
    half.add(&[triangle], point);
    half.solid_angle()
}

#[test]
fn points_are_inside_where_the_winding_number_says_so() {
    let mut noise = Noise(7);
    // A cube whose corners are shaken, divided into small triangles, and the same with holes.
    let mut surface = cube();
    surface.points.iter_mut().for_each(|point| *point += (noise.vector() - 0.5) * 0.4);
    surface.refine(0.1, 100_000);
    let whole = surface.triangles.len();
    for kept in [whole, whole - 1, whole * 9 / 10, whole / 2] {
        surface.triangles.truncate(kept);
        let (inside, caps) = (Inside::new(&surface), all(&surface));
        assert_eq!(inside.caps().is_empty(), kept == whole);
        let mut unclear = 0;
        for _ in 0..2000 {
            let point = noise.vector() * 2.0 - 0.5;
            let direct: f64 = caps.triangles.iter().map(|&triangle| solid_angle(triangle, point)).sum();
            let direct = direct / (4.0 * std::f64::consts::PI);
            let lumped = caps.winding(point);
            assert!((lumped - direct).abs() < 0.03, "{lumped} {direct}");
            match (direct - 0.5).abs() < 0.03 {
                true => unclear += 1,
                false => assert_eq!(inside.contains(point), direct > 0.5, "{point}: {direct}"),
            }
        }
        assert!(unclear < 200, "{unclear}");
    }
}
