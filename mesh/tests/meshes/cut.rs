//! Surfaces filled with elements that end at the surface.

use crate::common::near::outside;
use crate::common::{ball, block, ring, scan, together};
use glam::{DMat3, DQuat, DVec3, Vec3Swizzles};
use localshape_mesh::{Fill, Filled, Format, Limits, Mesh, Surface, fill, read};
use localshape_sim::geometry::{around, bounds, volumes_at_rest};
use localshape_sim::{Body, Solids};
use std::collections::BTreeMap;
use std::collections::HashMap;

/// More elements than any test needs.
const MOST: usize = 2_000_000;

/// A ball and a tilted ring that fit no lattice.
fn round() -> [Surface; 2] {
    let tilt = DQuat::from_xyzw(0.3, -0.2, 0.1, 0.9).normalize();
    let mut ring = ring(0.5, 0.2, 120);
    ring.points.iter_mut().for_each(|point| *point = tilt * *point);
    [ball(DVec3::new(0.013, 0.021, 0.007), 0.5, 96), ring]
}

/// A scan, with the largest side 1.
fn real(name: &str) -> Option<Surface> {
    let mut surface = scan(name)?;
    let (low, high) = bounds(&surface.points);
    let size = (high - low).max_element();
    surface.points.iter_mut().for_each(|point| *point = (*point - low) / size);
    Some(surface)
}

fn volume(points: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
    let at = |node: u32| points[node as usize] - points[0];
    triangles.iter().map(|&[a, b, c]| at(a).dot(at(b).cross(at(c))) / 6.0).sum()
}

/// The elements as a body, after checks of what must hold for every fill.
fn checked(filled: &Filled) -> Body {
    let cage = &filled.cage;
    let solids = if cage.convex { Solids::Convex } else { Solids::Ordered };
    let mass = vec![1.0; cage.nodes.len()];
    let body = Body::builder(cage.nodes.clone())
        .elements(cage.elements.clone())
        .solids(solids)
        .masses(mass)
        .build()
        .expect("a body");
    // Elements fill the space between their outer faces once: none is turned inside out, and inner faces match.
    let volumes = volumes_at_rest(&body);
    assert!(volumes.iter().all(|&volume| volume > 0.0));
    let outer = || {
        body.faces().nodes.iter().zip(&body.faces().outer).filter(|(_, outer)| outer.is_none()).map(|(face, _)| face)
    };
    let triangles: Vec<_> =
        outer().flat_map(|face| (2..face.len()).map(|at| [face[0], face[at - 1], face[at]])).collect();
    let [inside, sum] = [volume(body.rest(), &triangles), volumes.iter().sum()];
    assert!((inside / sum - 1.0).abs() < 1e-10, "{inside} {sum}");
    let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
    for [a, b] in outer().flat_map(around) {
        *edges.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
    }
    assert!(edges.values().all(|&passed| passed == 0), "outer faces are closed");
    // Every node belongs to an element.
    let mut is_used = vec![false; cage.nodes.len()];
    cage.elements.indices().iter().for_each(|&node| is_used[node as usize] = true);
    assert!(is_used.iter().all(|&used| used));
    // Weights reproduce affine maps.
    let points = &filled.surface.points;
    assert_eq!(filled.weights.len(), points.len());
    let map = DMat3::from_cols_array(&[0.3, -0.9, 0.2, 0.8, 0.1, 0.5, -0.4, 0.6, 0.7]);
    let moved: Vec<_> = cage.nodes.iter().map(|&node| map * node + DVec3::new(0.1, 0.2, -0.3)).collect();
    for (at, &point) in points.iter().enumerate() {
        assert!((filled.weights.of(at).1.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        let error = filled.weights.place(at, &moved).distance(map * point + DVec3::new(0.1, 0.2, -0.3));
        assert!(error < 1e-14, "{error:e}");
    }
    body
}

/// The least and the greatest dihedral angle of tetrahedra (degrees).
fn angles(body: &Body) -> [f64; 2] {
    let mut extremes = [180.0f64, 0.0];
    for element in body.elements().iter() {
        let corners: Vec<_> = element.iter().map(|&node| body.rest()[node as usize]).collect();
        for [a, b, c, d] in [[0, 1, 2, 3], [0, 2, 1, 3], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 0, 2], [2, 3, 0, 1]] {
            let along = (corners[b] - corners[a]).normalize();
            let [one, other] = [c, d].map(|at| (corners[at] - corners[a]).reject_from_normalized(along));
            let angle = one.angle_between(other).to_degrees();
            extremes = [extremes[0].min(angle), extremes[1].max(angle)];
        }
    }
    extremes
}

/// How much more stiffness for its mass (1/s²) an element has than a whole one: the ratio of the squares of their radii.
fn stiffest(body: &Body, whole: f64) -> f64 {
    let spread = |element: &[u32]| {
        let mean = element.iter().map(|&node| body.rest()[node as usize]).sum::<DVec3>() / element.len() as f64;
        element.iter().map(|&node| body.rest()[node as usize].distance_squared(mean)).sum::<f64>()
            / element.len() as f64
    };
    whole / body.elements().iter().map(spread).fold(f64::MAX, f64::min)
}

/// The square of the distance of the nodes of a tetrahedron of the lattice from their mean, for sides of 1.
const OF_TETRAHEDRON: f64 = 0.3125;

/// The same for the corners of a cube.
const OF_CUBE: f64 = 0.75;

fn filled(surface: &Surface, with: Fill) -> (Filled, Body) {
    let filled = fill(surface, with, MOST).unwrap();
    let body = checked(&filled);
    (filled, body)
}

/// Both ways to fill a surface.
fn both(side: f64) -> [Fill; 2] {
    [Fill::Tetrahedra { side }, Fill::Polyhedra { side }]
}

#[test]
fn the_volume_of_elements_tends_to_that_of_the_surface() {
    for surface in round() {
        let expected = surface.measures().volume;
        let error =
            |with: Fill| (volumes_at_rest(&filled(&surface, with).1).iter().sum::<f64>() / expected - 1.0).abs();
        let errors = [0.1, 0.05, 0.025].map(|side| both(side).map(error));
        // Nodes of tetrahedra are on the surface: a quarter of the error for half of the side.
        for ([tetrahedra, polyhedra], most) in errors.into_iter().zip([0.04, 0.01, 0.0025]) {
            assert!(tetrahedra < most && polyhedra < 1.2 * most, "{errors:?}");
        }
    }
}

#[test]
fn elements_of_a_block_of_whole_cells_are_the_block() {
    let surface = block(DVec3::ZERO, DVec3::new(1.0, 0.5, 0.75));
    for with in both(0.25) {
        let (filled, body) = filled(&surface, with);
        assert!((volumes_at_rest(&body).iter().sum::<f64>() - 0.375).abs() < 1e-15);
        let place = |point: usize| filled.weights.place(point, &filled.cage.nodes);
        assert!((0..8).all(|point| place(point).distance(surface.points[point]) < 1e-15));
        if let Fill::Polyhedra { .. } = with {
            assert_eq!(filled.cage.elements.len(), 24);
            assert!(filled.cage.elements.iter().all(|element| element.len() == 8));
        }
    }
}

#[test]
fn outer_nodes_of_tetrahedra_are_on_the_surface() {
    let (size, tilt) = (DVec3::new(1.0, 0.7, 0.8), DQuat::from_xyzw(0.2, 0.3, -0.1, 0.9).normalize());
    let mut surface = block(-0.5 * size, 0.5 * size);
    surface.points.iter_mut().for_each(|point| *point = tilt * *point);
    let (filled, body) = filled(&surface, Fill::Tetrahedra { side: 0.05 });
    let parts = filled.cage.filled.clone().unwrap_or(vec![1.0; body.elements().len()]);
    let mut compared = 0;
    for face in (0..body.faces().nodes.len()).filter(|&face| body.faces().outer[face].is_none()) {
        // Elements filled in part are wider than the body.
        if parts[body.faces().inner[face].unwrap() as usize] == 1.0 {
            for &node in &body.faces().nodes[face] {
                let within = (tilt.inverse() * body.rest()[node as usize]).abs() - 0.5 * size;
                assert!(within.max_element().abs() < 1e-12);
                compared += 1;
            }
        }
    }
    assert!(compared > 1000);
}

/// Scans, with the largest side 1.
fn scans() -> impl Iterator<Item = (&'static str, Surface)> {
    let names = ["armadillo.off", "bunny00.off", "elephant.off", "homer.off", "camel.off", "mpi.off"];
    names.into_iter().filter_map(|name| Some((name, real(name)?)))
}

/// Checks that filled parts add up to the volume of the surface, about.
fn assert_filled(filled: &Filled, body: &Body, slack: f64) {
    let parts = filled.cage.filled.clone().unwrap_or(vec![1.0; body.elements().len()]);
    assert!(parts.iter().all(|&part| part > 0.0 && part <= 1.0));
    let sum: f64 = volumes_at_rest(body).iter().zip(&parts).map(|(volume, part)| volume * part).sum();
    let ratio = sum / filled.surface.measures().volume;
    assert!((ratio - 1.0).abs() < slack, "{ratio}");
}

/// Checks that no weight is far from those of points inside.
fn assert_gentle(filled: &Filled, most: f64) {
    let all = (0..filled.weights.len()).flat_map(|point| filled.weights.of(point).1);
    let found = all.fold(0.0f64, |most, weight| most.max(weight.abs()));
    assert!(found < most, "{found}");
}

/// Thin parts have elements as well, so that all of a scan hangs together at any side.
#[test]
fn dihedral_angles_of_tetrahedra_are_bounded() {
    let shapes = round().into_iter().chain([block(DVec3::ZERO, DVec3::new(1.0, 0.63, 0.77))]);
    for (name, surface) in scans().chain(shapes.map(|shape| ("shape", shape))) {
        for (cells, slack) in [(9.0, 0.12), (12.0, 0.07), (20.0, 0.04), (30.0, 0.03)] {
            let (filled, body) = filled(&surface, Fill::Tetrahedra { side: 1.0 / cells });
            let [least, greatest] = angles(&body);
            assert!(least > 10.7 && greatest < 164.8, "{name}, {cells} cells: {least}° to {greatest}°");
            // No element needs a step shorter by more than √8 than those of the lattice.
            let stiff = stiffest(&body, OF_TETRAHEDRON / cells / cells);
            assert!(stiff < 8.0, "{name}, {cells} cells: {stiff}");
            assert_filled(&filled, &body, slack);
            assert_gentle(&filled, 4.0);
        }
    }
}

#[test]
fn scans_are_filled_with_polyhedra_of_limited_stiffness() {
    let shapes = round().into_iter().chain([block(DVec3::ZERO, DVec3::new(1.0, 0.63, 0.77))]);
    for (name, surface) in scans().chain(shapes.map(|shape| ("shape", shape))) {
        for (cells, slack) in [(12.0, 0.12), (20.0, 0.07), (30.0, 0.04)] {
            let (filled, body) = filled(&surface, Fill::Polyhedra { side: 1.0 / cells });
            // The smallest element is a corner of a cube with edges of a quarter: a step shorter by √(64/3) = 4.6.
            let stiff = stiffest(&body, OF_CUBE / cells / cells);
            assert!(stiff < 21.34, "{name}, {cells} cells: {stiff}");
            assert_filled(&filled, &body, slack);
            assert_gentle(&filled, 6.0);
        }
    }
}

/// The shipped hare, with the largest side 1.
fn hare() -> Surface {
    let bytes = std::fs::read("../scenes/hare.ply").unwrap();
    let Ok(Mesh::Surface(mut hare)) = read(&bytes, Format::Ply, &Limits { points: 100_000, corners: 1_000_000 }) else {
        panic!("hare.ply is a surface")
    };
    let (low, high) = bounds(&hare.points);
    hare.points.iter_mut().for_each(|point| *point /= (high - low).max_element());
    hare
}

/// A bar that stands on the ground.
fn bar(wide: f64) -> Surface {
    block(DVec3::new(-0.5 * wide, 0.0, -0.5 * wide), DVec3::new(0.5 * wide, 1.0, 0.5 * wide))
}

#[test]
fn elements_stay_at_the_surface() {
    let sheet = block(DVec3::ZERO, DVec3::new(1.0, 0.03, 0.7));
    let notched = together(&[bar(0.5), block(DVec3::new(0.25, 0.0, -0.25), DVec3::new(0.5, 0.5, 0.25))]);
    let shapes =
        round().into_iter().chain([0.25, 0.26, 0.55].map(bar)).chain([hare(), sheet, notched, ring(0.5, 0.03, 60)]);
    for (name, surface) in scans().chain(shapes.map(|shape| ("shape", shape))) {
        let cells: &[f64] = if name == "shape" { &[9.0, 10.0, 15.0, 20.0] } else { &[12.0] };
        for &cells in cells {
            let side = 1.0 / cells;
            for with in both(side) {
                let (filled, body) = filled(&surface, with);
                let found = outside(&filled, &body, side);
                assert_eq!((found.far, found.empty), (0, 0), "{name}, {with:?}: {found:?}");
            }
        }
    }
}

/// Polyhedra have nodes at sharp edges and corners, on the lattice or beside it.
#[test]
fn polyhedra_fill_blocks_exactly() {
    for size in [DVec3::new(0.26, 1.0, 0.26), DVec3::new(0.55, 1.0, 0.25), DVec3::new(1.0, 0.63, 0.77)] {
        for cells in [9.0, 10.0, 15.0, 20.0] {
            let (filled, body) = filled(&block(-0.5 * size, 0.5 * size), Fill::Polyhedra { side: 1.0 / cells });
            let ratio = volumes_at_rest(&body).iter().sum::<f64>() / size.element_product();
            // A corner nearer than a thirty-second of a side to one of the lattice is moved to it.
            assert!((ratio - 1.0).abs() < 0.012, "{size}, {cells} cells: {ratio}");
            assert!(filled.weights.len() == filled.surface.points.len());
        }
    }
}

/// The volume of each part of a cage that hangs together.
fn volumes_of_parts(body: &Body) -> Vec<f64> {
    let mut part: Vec<usize> = (0..body.rest().len()).collect();
    for _ in 0..body.rest().len() {
        let before = part.clone();
        for element in body.elements().iter() {
            let least = element.iter().map(|&node| part[node as usize]).min().unwrap();
            element.iter().for_each(|&node| part[node as usize] = least);
        }
        if part == before {
            break;
        }
    }
    let mut sums = BTreeMap::new();
    for (element, volume) in body.elements().iter().zip(volumes_at_rest(body)) {
        *sums.entry(part[element[0] as usize]).or_insert(0.0) += volume;
    }
    sums.into_values().collect()
}

/// Also if they are nearer to each other than elements are long.
#[test]
fn parts_that_do_not_touch_stay_apart() {
    for gap in [0.3, 0.05, 1e-4] {
        let sizes = [DVec3::new(0.6, 0.7, 0.4), DVec3::new(0.6, 0.75, 0.4)];
        let far = DVec3::new(0.6 + gap, 0.0, 0.0);
        let surface = together(&[block(DVec3::ZERO, sizes[0]), block(far, far + sizes[1])]);
        for cells in [5.0, 10.0, 20.0] {
            let side = (1.2 + gap) / cells;
            // Tetrahedra cut off each edge by at most half of a side in both directions: an eighth of its square.
            let cut_off = |size: DVec3| 4.0 * size.element_sum() * side * side / 8.0 / size.element_product();
            for (with, slacks) in
                [(Fill::Polyhedra { side }, [0.012; 2]), (Fill::Tetrahedra { side }, sizes.map(cut_off))]
            {
                let (filled, body) = filled(&surface, with);
                let parts = volumes_of_parts(&body);
                assert_eq!(parts.len(), 2, "{gap} {with:?}");

                for ((volume, right), slack) in parts.into_iter().zip([0.168, 0.18]).zip(slacks) {
                    assert!((volume / right - 1.0).abs() < slack, "{gap} {with:?}: {volume} {right}");
                }
                // What the nodes of each part weigh is exact, with any elements.
                let volumes = filled.cage.volumes.expect("those of two parts");
                let (middle, mut exact) = (0.6 + 0.5 * gap, [0.0; 2]);
                for (node, volume) in body.rest().iter().zip(volumes) {
                    exact[usize::from(node.x > middle)] += volume;
                }
                for (volume, right) in exact.into_iter().zip([0.168, 0.18]) {
                    assert!((volume / right - 1.0).abs() < 1e-12, "{gap} {with:?}: {volume} {right}");
                }
            }
        }
    }
}

#[test]
fn a_sheet_thinner_than_the_elements_is_filled_in_part() {
    let surface = block(DVec3::ZERO, DVec3::new(1.0, 0.03, 0.7));
    for with in both(0.1) {
        let (filled, body) = filled(&surface, with);
        assert!(filled.cage.filled.is_some());
        assert_filled(&filled, &body, 0.05);
    }
}

/// An I-beam along x, ten cells of a twentieth high and five wide.
fn i_beam(web: f64, flange: f64) -> Surface {
    let [x, y, z] = [0.5, 0.25, 0.125];
    let foot = block(DVec3::new(-x, -y, -z), DVec3::new(x, flange - y, z));
    let head = block(DVec3::new(-x, y - flange, -z), DVec3::new(x, y, z));
    // The web ends in the flanges: what lies in both counts once.
    let web = block(DVec3::new(-x, 0.01 - y, -0.5 * web), DVec3::new(x, y - 0.01, 0.5 * web));
    together(&[foot, head, web])
}

/// Elements that are cut are full where a body is thinner than a cell, and still do not bend as it does.
#[test]
fn all_fills_tell_where_a_body_is_thinner_than_a_cell() {
    let side = 0.05;
    let tilt = DQuat::from_xyzw(0.2, 0.3, -0.1, 0.9).normalize();
    let mut tilted = block(DVec3::ZERO, DVec3::new(1.0, 0.033, 0.7));
    tilted.points.iter_mut().for_each(|point| *point = tilt * *point);
    let all = DVec3::new(1.0, 0.045, 0.7);
    for (name, surface, least, most) in [
        ("web", i_beam(0.033, 0.05), 0.3, 0.5),
        ("plate", block(DVec3::ZERO, all), 1.0, 1.0),
        ("bar", block(DVec3::ZERO, all.xyy()), 1.0, 1.0),
        ("tilted", tilted, 1.0, 1.0),
        ("sturdy", i_beam(0.11, 0.11), 0.0, 0.0),
        ("block", block(DVec3::ZERO, 3.0 * all), 0.0, 0.0),
        ("ball", ball(DVec3::ZERO, 0.5, 96), 0.0, 0.0),
    ] {
        for with in both(side).into_iter().chain([Fill::Cubes { side }, Fill::Graded { side }]) {
            let thin = fill(&surface, with, MOST).unwrap().cage.thin;
            let part = thin.cubes as f64 / thin.of as f64;
            assert!((least..=most).contains(&part), "{name}, {with:?}: {thin:?}");
        }
    }
}

#[test]
fn the_number_of_threads_decides_nothing() {
    let surface = ring(0.5, 0.03, 60);
    for with in both(0.1) {
        let fills = [1, 2, 5].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| fill(&surface, with, MOST).unwrap())
        });
        assert!(fills[0].cage.filled.is_some(), "thin parts are widened, too");
        assert!(fills[0] == fills[1] && fills[0] == fills[2]);
    }
}

#[test]
fn more_elements_than_allowed_are_refused() {
    let surface = ball(DVec3::ZERO, 0.5, 48);
    for (side, message) in [(0.05, "needs "), (1e-3, "needs about "), (1e-9, "needs about ")] {
        for with in both(side) {
            let refused = fill(&surface, with, 4000).unwrap_err();
            assert!(refused.message.starts_with(message), "{refused}");
            assert!(refused.message.ends_with("and at most 4000 are allowed"), "{refused}");
            assert!(refused.help.is_some());
        }
    }
}

/// Lattices with planes at flat ends may have up to eight times as many elements as others of their side.
#[test]
fn the_side_that_a_refusal_names_is_enough() {
    for layers in [1.05, 1.3, 1.7, 2.05, 3.3] {
        let thick = 0.05 * layers;
        let [plate, bar] = [0.7, thick].map(|wide| block(DVec3::ZERO, DVec3::new(1.0, thick, wide)));
        for surface in [plate, bar] {
            for with in both(0.05) {
                let all = fill(&surface, with, MOST).unwrap().cage.elements.len();
                for part in [1.01, 1.5, 3.0, 7.0] {
                    let most = (all as f64 / part) as usize;
                    let side = fill(&surface, with, most).unwrap_err().fitting.unwrap();
                    let fewer = if let Fill::Tetrahedra { .. } = with { both(side)[0] } else { both(side)[1] };
                    assert!(fill(&surface, fewer, most).is_ok(), "{layers} layers, {with:?}: {side} for {most}");
                }
            }
        }
    }
}

#[test]
fn what_has_no_inside_is_refused() {
    let sheet = Surface {
        points: vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Surface::default()
    };
    for with in both(0.1) {
        let refused = fill(&sheet, with, MOST).unwrap_err();
        assert!(refused.message.starts_with("has no inside"), "{refused}");
    }
}
