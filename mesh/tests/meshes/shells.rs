//! Fillings of surfaces of several shells: apart, crossing, and in each other.

use crate::common::{ball, block, ring, together};
use glam::{DQuat, DVec3};
use localshape_mesh::{Cage, Fill, Filled, Format, Limits, Mesh, Surface, fill, read};
use localshape_sim::geometry::bounds;

const MOST: usize = 1_000_000;

/// A surface of a file.
fn file(name: &str) -> Surface {
    let bytes = std::fs::read(format!("{}/tests/files/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap();
    let format = Format::of(name.rsplit('.').next().unwrap()).unwrap();
    match read(&bytes, format, &Limits { points: 10_000, corners: 100_000 }).unwrap() {
        Mesh::Surface(surface) => surface,
        Mesh::Volume(_) => panic!("{name} has cells"),
    }
}

fn turned(surface: Surface) -> Surface {
    Surface { triangles: surface.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(), ..surface }
}

/// A surface turned about a slanted axis, so that none of its triangles is in a plane of the lattice.
fn slanted(surface: &Surface) -> Surface {
    let turn = DQuat::from_xyzw(0.3, -0.2, 0.4, 0.8).normalize();
    Surface { points: surface.points.iter().map(|&point| turn * point).collect(), ..surface.clone() }
}

/// The lowest node that each node hangs together with.
fn bodies(cage: &Cage) -> Vec<usize> {
    let mut body_of: Vec<usize> = (0..cage.nodes.len()).collect();
    let mut changed = true;
    while changed {
        changed = false;
        for element in cage.elements.iter() {
            let least = element.iter().map(|&node| body_of[node as usize]).min().unwrap();
            for &node in element {
                changed |= std::mem::replace(&mut body_of[node as usize], least) != least;
            }
        }
    }
    body_of
}

/// What is filled of each body whose elements share nodes (m³), in rising order. Elements are cubes, or nodes have their volumes.
fn volumes(filled: &Filled) -> Vec<f64> {
    let cage = &filled.cage;
    let body_of = bodies(cage);
    let mut volumes = vec![0.0; cage.nodes.len()];
    if let (Some(own), true) = (&cage.volumes, cage.elements.iter().any(|nodes| nodes.len() != 8)) {
        own.iter().zip(&body_of).for_each(|(own, &body)| volumes[body] += own);
    } else {
        for (element, nodes) in cage.elements.iter().enumerate() {
            let places: Vec<_> = nodes.iter().map(|&node| cage.nodes[node as usize]).collect();
            let (low, high) = bounds(&places);
            let part = cage.filled.as_ref().map_or(1.0, |filled| filled[element]);
            volumes[body_of[nodes[0] as usize]] += part * (high - low).element_product();
        }
    }
    volumes.retain(|&volume| volume > 0.0);
    volumes.sort_by(f64::total_cmp);
    volumes
}

/// Checks the volume of each body that cubes and graded cubes make, and that of what lies in several shells.
fn assert_volumes(surface: &Surface, sides: &[f64], expected: &[f64], overlap: f64) {
    for &side in sides {
        for with in [Fill::Cubes { side }, Fill::Graded { side }] {
            let filled = fill(surface, with, MOST).unwrap();
            let found = volumes(&filled);
            // Points near to planes of the lattice are moved to them.
            let is_right = |(one, other): (&f64, &f64)| (one - other).abs() < 2e-5 * side;
            assert!(
                found.len() == expected.len() && found.iter().zip(expected).all(is_right),
                "{found:?} in place of {expected:?}, {with:?}"
            );
            assert!((filled.cage.overlap - overlap).abs() < 2e-5 * side, "{}", filled.cage.overlap);
        }
    }
}

#[test]
fn each_piece_has_its_own_volume() {
    let boxes = file("boxes-apart.obj");
    assert_volumes(&boxes, &[0.2, 0.1, 0.07], &[0.168, 0.18], 0.0);
    assert_volumes(&slanted(&boxes), &[0.2, 0.1, 0.07], &[0.168, 0.18], 0.0);
    // Three plates in one layer of cells, and a gap that no cell resolves.
    let plate = |low: f64, high: f64| block(DVec3::new(0.0, low, 0.0), DVec3::new(1.0, high, 0.6));
    let plates = together(&[plate(0.0, 0.02), plate(0.03, 0.06), plate(0.06001, 0.1)]);
    let expected = [0.012, 0.018, 0.6 * (0.1 - 0.06001)];
    assert_volumes(&plates, &[0.2, 0.1], &expected, 0.0);
    assert_volumes(&slanted(&plates), &[0.15, 0.08], &expected, 0.0);
    // Rings through each other, which do not touch.
    let lying = ring(1.0, 0.2, 60);
    let along =
        Surface { points: lying.points.iter().map(|at| DVec3::new(at.x + 0.7, at.z, at.y)).collect(), ..lying.clone() };
    let own = lying.mended().0.measures().volume;
    assert_volumes(&together(&[lying, along]), &[0.3, 0.11], &[own, own], 0.0);
}

#[test]
fn shells_that_cross_are_filled_once() {
    let cube = block(DVec3::ZERO, DVec3::ONE);
    let moved = |by: DVec3| Surface { points: cube.points.iter().map(|&point| point + by).collect(), ..cube.clone() };
    let crossing = file("boxes-crossing.obj");
    let sides = [0.2, 0.13, 0.5, 3.0];
    assert_volumes(&crossing, &sides, &[1.625], 0.375);
    assert_volumes(&slanted(&crossing), &sides, &[1.625], 0.375);
    // Faces that lie on each other, to the same side.
    let long = together(&[cube.clone(), moved(DVec3::new(0.437, 0.0, 0.0))]);
    assert_volumes(&long, &sides, &[1.437], 0.563);
    assert_volumes(&slanted(&long), &sides, &[1.437], 0.563);
    // Two squares at 45° make a star of eight points.
    let eighth = DQuat::from_rotation_z(std::f64::consts::FRAC_PI_4);
    let middle = DVec3::splat(0.5);
    let star = Surface {
        points: cube.points.iter().map(|&point| eighth * (point - middle) + middle).collect(),
        ..cube.clone()
    };
    let star = together(&[cube.clone(), star]);
    let overlap = 2.0 * (std::f64::consts::SQRT_2 - 1.0);
    assert_volumes(&star, &sides, &[2.0 - overlap], overlap);
    assert_volumes(&slanted(&star), &sides, &[2.0 - overlap], overlap);
    // Three at once: by inclusion and exclusion.
    let [x, y] = [DVec3::new(0.3, 0.2, 0.1), DVec3::new(-0.2, 0.4, 0.3)];
    let three = together(&[cube.clone(), moved(x), moved(y)]);
    let common = |by: &[DVec3]| {
        let low = by.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let high = by.iter().copied().fold(DVec3::INFINITY, DVec3::min) + 1.0;
        (high - low).max(DVec3::ZERO).element_product()
    };
    let zero = DVec3::ZERO;
    let overlap = common(&[zero, x]) + common(&[zero, y]) + common(&[x, y]) - common(&[zero, x, y]);
    assert_volumes(&three, &sides, &[3.0 - overlap], overlap);
    assert_volumes(&slanted(&three), &sides, &[3.0 - overlap], overlap);
}

#[test]
fn shells_in_each_other_are_filled_once_and_cavities_are_not() {
    let sides = [0.2, 0.5, 0.37, 3.0];
    let outer = block(DVec3::ZERO, DVec3::splat(3.0));
    for (low, high) in [(1.0, 2.0), (0.05, 2.95), (0.6, 1.1)] {
        let inner = block(DVec3::splat(low), DVec3::splat(high));
        let size = (high - low) * (high - low) * (high - low);
        let nested = together(&[outer.clone(), inner.clone()]);
        assert_volumes(&nested, &sides, &[27.0], size);
        assert_volumes(&slanted(&nested), &sides, &[27.0], size);
        let hollow = together(&[outer.clone(), turned(inner)]);
        assert_volumes(&hollow, &sides, &[27.0 - size], 0.0);
        assert_volumes(&slanted(&hollow), &sides, &[27.0 - size], 0.0);
    }
    // Round shells, one through the other's side.
    let [one, other] = [0.0, 0.9].map(|x| ball(DVec3::new(x, 0.0, 0.0), 1.0, 40));
    let alone = fill(&one, Fill::Cubes { side: 0.1 }, MOST).unwrap();
    let both = fill(&together(&[one, other]), Fill::Cubes { side: 0.1 }, MOST).unwrap();
    let [alone, all] = [2.0 * volumes(&alone)[0], volumes(&both)[0] + both.cage.overlap];
    assert!((all / alone - 1.0).abs() < 1e-7, "{all} {alone}");
    // The lens that two balls at a distance d share: π (4 + d) (2 − d)² / 12, of 40 corners around a little less.
    let lens = std::f64::consts::PI * 4.9 * 1.1 * 1.1 / 12.0;
    assert!((both.cage.overlap / lens - 1.0).abs() < 0.03, "{} {lens}", both.cage.overlap);
}

/// However near they are, and also where their boxes meet.
#[test]
fn pieces_that_do_not_touch_stay_apart_with_every_filling() {
    let boxes = |gap: f64| {
        let far = DVec3::new(0.6 + gap, 0.0, 0.0);
        slanted(&together(&[
            block(DVec3::ZERO, DVec3::new(0.6, 0.7, 0.4)),
            block(far, far + DVec3::new(0.6, 0.75, 0.4)),
        ]))
    };
    let ring = ring(1.0, 0.2, 60).mended().0;
    let lying = |along: f64| {
        let points = ring.points.iter().map(|at| DVec3::new(at.x + along, -at.z, at.y)).collect();
        together(&[ring.clone(), Surface { points, ..ring.clone() }])
    };
    let [core, cavity, outside] = [0.7, 0.8, 1.0].map(|radius| ball(DVec3::ZERO, radius, 24).mended().0);
    let volume = |surface: &Surface| surface.measures().volume;
    let within = [volume(&core), volume(&outside) - volume(&cavity)];
    // Also on the axes of the lattice, where lines of sight meet edges of triangles.
    let loose = together(&[outside, turned(cavity), core]);
    let of_boxes = [0.168, 0.18];
    let of_rings = [volume(&ring); 2];
    for (surface, expected) in [
        (boxes(0.3), of_boxes),
        (boxes(0.05), of_boxes),
        (lying(0.7), of_rings),
        (lying(1.55), of_rings),
        (slanted(&loose), within),
        (loose, within),
    ] {
        let (low, high) = bounds(&surface.points);
        for cells in [5.0, 10.0, 17.0] {
            let side = (high - low).max_element() / cells;
            for with in
                [Fill::Cubes { side }, Fill::Graded { side }, Fill::Tetrahedra { side }, Fill::Polyhedra { side }]
            {
                let found = volumes(&fill(&surface, with, MOST).unwrap());
                let is_right = |(one, other): (&f64, &f64)| (one - other).abs() < 2e-5 * side;
                assert!(
                    found.len() == 2 && found.iter().zip(&expected).all(is_right),
                    "{found:?} in place of {expected:?}, {with:?}"
                );
            }
        }
    }
}

/// A hole in one piece does not join it to another, and what encloses nothing by itself goes with the nearest.
#[test]
fn open_pieces_are_filled_by_themselves() {
    let side = 0.25;
    let boxes = [0.0, 1.0 + side / 2.0, 5.0].map(|x| block(DVec3::new(x, 0.0, 0.0), DVec3::new(x + 1.0, 1.0, 1.0)));
    let mut holed = boxes.clone();
    holed[1].triangles.pop();
    // A triangle, and two that are a roof.
    let triangle = Surface {
        points: vec![DVec3::new(6.2, 0.1, 0.1), DVec3::new(6.3, 0.9, 0.1), DVec3::new(6.25, 0.1, 0.9)],
        triangles: vec![[0, 1, 2]],
        ..Surface::default()
    };
    let mut roof = triangle.clone();
    roof.points.push(DVec3::new(6.6, 0.9, 0.9));
    roof.triangles.push([2, 1, 3]);
    let [all, with_hole] = [together(&boxes), together(&holed)];
    for with in [Fill::Tetrahedra { side }, Fill::Polyhedra { side }] {
        let filled = |surface: &Surface| fill(surface, with, MOST).unwrap();
        let closed = filled(&all);
        assert_eq!(volumes(&closed).len(), 3, "{with:?}");
        assert_eq!(volumes(&filled(&with_hole)).len(), 3, "{with:?}");
        let beside = filled(&together(&[all.clone(), triangle.clone()]));
        // The triangle changes the lattice of the third box only.
        let others = |filled: &Filled| filled.cage.nodes.iter().copied().filter(|at| at.x < 4.0).collect::<Vec<_>>();
        assert_eq!(others(&beside), others(&closed), "{with:?}");
        assert_ne!(beside.cage.nodes, closed.cage.nodes, "{with:?}");
        assert_eq!(volumes(&filled(&together(&[all.clone(), roof.clone()]))).len(), 4, "{with:?}");
    }
}

/// Random numbers from 0 to 1, always the same.
fn noise() -> impl FnMut() -> f64 {
    let mut state = 7u64;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// The part of the sphere about a point that a triangle hides, positive from behind (A. van Oosterom and J. Strackee, 1983).
fn hidden(corners: [DVec3; 3], from: DVec3) -> f64 {
    let [a, b, c] = corners.map(|corner| (corner - from).normalize());
    let below = 1.0 + a.dot(b) + b.dot(c) + c.dot(a);
    libm::atan2(a.dot(b.cross(c)), below) / (2.0 * std::f64::consts::PI)
}

/// A hundred random triangles are no solid. Cubes fill where they go around points by more than a half; elements that end at the surface
/// are refused before the work.
#[test]
fn a_random_soup_is_filled_with_cubes_only() {
    let (soup, side) = (file("soup.stl"), 0.05);
    let (low, high) = bounds(&soup.points);
    let (mut next, mut inside, tries) = (noise(), 0, 20_000);
    for _ in 0..tries {
        let point = low + (high - low) * DVec3::new(next(), next(), next());
        let corners = |of: &[u32; 3]| of.map(|corner| soup.points[corner as usize]);
        inside += usize::from(soup.triangles.iter().map(|of| hidden(corners(of), point)).sum::<f64>() > 0.5);
    }
    let expected = (high - low).element_product() * inside as f64 / tries as f64;
    assert!(inside > 100, "{inside} points are inside");
    for with in [Fill::Cubes { side }, Fill::Graded { side }] {
        let filled = fill(&soup, with, MOST).unwrap();
        assert_eq!((filled.flaws.boundary, filled.flaws.pieces, filled.cage.overlap), (300, 100, 0.0));
        let found: f64 = volumes(&filled).iter().sum();
        assert!((found / expected - 1.0).abs() < 0.1, "{with:?}: {found} in place of {expected}");
    }
    for with in [Fill::Tetrahedra { side }, Fill::Polyhedra { side }] {
        let refused = fill(&soup, with, MOST).unwrap_err();
        assert_eq!(refused.message, "is 100 triangles in 100 pieces that do not join");
        assert!(refused.help.unwrap().ends_with("fill it with cubes"));
    }
}

/// Triangles that miss each other's corners by little are no soup.
#[test]
fn triangles_with_corners_of_their_own_are_a_surface() {
    let (mut next, cube) = (noise(), block(DVec3::ZERO, DVec3::ONE));
    let mut vector = move || DVec3::new(next(), next(), next());
    let corners = cube.triangles.as_flattened().iter();
    let points = corners.map(|&corner| cube.points[corner as usize] + 1e-6 * vector()).collect();
    let loose =
        Surface { points, triangles: (0..12).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect(), ..Surface::default() };
    assert_eq!(loose.mended().1.pieces, 12);
    for with in [Fill::Tetrahedra { side: 0.25 }, Fill::Polyhedra { side: 0.25 }] {
        let found: f64 = volumes(&fill(&loose, with, MOST).unwrap()).iter().sum();
        assert!(found > 0.5, "{with:?}: {found}");
    }
}

/// Tetrahedra all over a box, each a shell of its own.
fn tetrahedra(count: u32) -> Surface {
    let mut next = noise();
    let mut vector = move || DVec3::new(next(), next(), next());
    let mut all = Surface::default();
    for first in (0..4 * count).step_by(4) {
        let middle = vector();
        let mut corners = [(); 4].map(|()| middle + 0.5 * (vector() - 0.5));
        // All look out: one that looks in is a cavity of those around it.
        let [along, beside, up] = [1, 2, 3].map(|at: usize| corners[at] - corners[0]);
        if along.cross(beside).dot(up) < 0.0 {
            corners.swap(0, 1);
        }
        all.points.extend(corners);
        all.triangles
            .extend([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]].map(|of| of.map(|corner: u32| first + corner)));
    }
    all.mended().0
}

#[test]
fn crossing_tetrahedra_are_filled_once() {
    let (surface, side) = (tetrahedra(60), 0.15);
    let (low, high) = bounds(&surface.points);
    let (mut next, mut inside, tries) = (noise(), 0, 20_000);
    for _ in 0..tries {
        let point = low + (high - low) * DVec3::new(next(), next(), next());
        let is_behind = |of: &[u32; 3]| {
            let [a, b, c] = of.map(|corner| surface.points[corner as usize]);
            (b - a).cross(c - a).dot(point - a) < 0.0
        };
        inside += usize::from(surface.triangles.chunks(4).any(|shell| shell.iter().all(is_behind)));
    }
    let expected = (high - low).element_product() * inside as f64 / tries as f64;
    for with in [Fill::Cubes { side }, Fill::Graded { side }] {
        let filled = fill(&surface, with, MOST).unwrap();
        let found: f64 = volumes(&filled).iter().sum();
        assert!((found / expected - 1.0).abs() < 0.03, "{with:?}: {found} in place of {expected}");
        let all = filled.surface.measures().volume;
        assert!(
            ((found + filled.cage.overlap) / all - 1.0).abs() < 1e-6,
            "{with:?}: {found} + {} of {all}",
            filled.cage.overlap
        );
    }
}

/// What would take minutes is refused before it begins.
#[test]
fn very_many_shells_in_one_cell_are_refused() {
    let (surface, side) = (tetrahedra(4000), 3.0);
    for with in [Fill::Cubes { side }, Fill::Graded { side }, Fill::Tetrahedra { side }, Fill::Polyhedra { side }] {
        let refused = fill(&surface, with, MOST).unwrap_err();
        assert_eq!(
            refused.message,
            "has 4000 separate parts of its surface in single cells, too many to tell what each bounds"
        );
        assert!(refused.help.unwrap().starts_with("unite its shells"));
    }
}

/// A band of four arms that goes around and ends in its own beginning: one piece, which passes through itself by less than a side.
#[test]
fn a_shell_that_crosses_itself_is_filled_once() {
    let (wide, deep, high) = (0.3, 0.1, 0.25);
    let outer = [[-0.2, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, wide - deep]];
    let inner = [[-0.2, wide], [1.0 - wide, wide], [1.0 - wide, 1.0 - wide], [wide, 1.0 - wide], [wide, wide - deep]];
    let at = |[x, y]: [f64; 2], z: f64| DVec3::new(x, y, z);
    let points =
        outer.iter().zip(&inner).flat_map(|(&out, &inn)| [at(out, 0.0), at(inn, 0.0), at(out, high), at(inn, high)]);
    let mut band = Surface { points: points.collect(), ..Surface::default() };
    let mut side = |[a, b, c, d]: [u32; 4]| band.triangles.extend([[a, b, c], [a, c, d]]);
    for first in (0..16).step_by(4) {
        // Below, above, outside and inside, from one station to the next.
        for [one, other] in [[1, 0], [2, 3], [0, 2], [3, 1]] {
            side([one, other, other + 4, one + 4].map(|corner| first + corner));
        }
    }
    side([0, 1, 3, 2]);
    side([17, 16, 18, 19]);
    assert!(band.measures().closed);
    let overlap = wide * deep * high;
    for surface in [band.clone(), slanted(&band)] {
        for side in [0.1, 0.06, 0.3] {
            for with in
                [Fill::Cubes { side }, Fill::Graded { side }, Fill::Tetrahedra { side }, Fill::Polyhedra { side }]
            {
                let filled = fill(&surface, with, MOST).unwrap();
                assert_eq!(filled.flaws.pieces, 1);
                let found = filled.cage.overlap;
                assert!((found / overlap - 1.0).abs() < 1e-3, "{with:?}: {found} in place of {overlap}");
            }
        }
    }
}
