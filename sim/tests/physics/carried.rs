//! Fine surfaces that coarse bodies carry.

use super::support::{Noise, floor, lattice, shape_based, world};
use glam::{DMat3, DVec3};
use localshape_sim::{Carried, State, Surroundings, Weights};
use std::collections::HashMap;

/// A block of 3³ cubes of 1 m, and its boundary in triangles whose sides are this part of a cube's.
fn block(parts: u32) -> (Vec<DVec3>, Carried) {
    let cells = 3;
    let n = cells * parts;
    let mut numbers = HashMap::new();
    let mut carried = Carried { rest: Vec::new(), triangles: Vec::new(), weights: Weights::default() };
    let mut point = |place: [u32; 3]| {
        *numbers.entry(place).or_insert_with(|| {
            let cell = place.map(|at| (at / parts).min(cells - 1));
            let inside = [0, 1, 2].map(|axis| f64::from(place[axis] - cell[axis] * parts) / f64::from(parts));
            let corners = [0u32, 1, 2, 3, 4, 5, 6, 7].map(|bits| {
                let bit = |axis: usize| bits >> axis & 1;
                let share = |axis: usize| if bit(axis) == 1 { inside[axis] } else { 1.0 - inside[axis] };
                let at = |axis: usize| cell[axis] + bit(axis);
                (at(0) + (cells + 1) * (at(1) + (cells + 1) * at(2)), share(0) * share(1) * share(2))
            });
            carried.weights.push(&corners.map(|corner| corner.0), &corners.map(|corner| corner.1));
            carried.rest.push(DVec3::from_array(place.map(f64::from)) / f64::from(parts));
            carried.rest.len() as u32 - 1
        })
    };
    let mut triangles = Vec::new();
    for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, n)]) {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        for (a, b) in (0..n).flat_map(|a| (0..n).map(move |b| (a, b))) {
            let corners = [[a, b], [a + 1, b], [a + 1, b + 1], [a, b + 1]].map(|[along, across]| {
                let mut place = [0; 3];
                (place[axis], place[u], place[v]) = (side, along, across);
                point(place)
            });
            let [p, q, r, s] = if side == 0 { [corners[0], corners[3], corners[2], corners[1]] } else { corners };
            triangles.extend([[p, q, r], [p, r, s]]);
        }
    }
    carried.triangles = triangles;
    (lattice(cells, 1.0).rest().to_vec(), carried)
}

/// By the divergence theorem (m³).
fn volume(points: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
    let of = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|point| points[point as usize] - points[0]);
        a.dot(b.cross(c)) / 6.0
    };
    triangles.iter().map(of).sum()
}

/// Weights of cubes reproduce affine maps, so the surface of a block has the block's volume.
#[test]
fn the_surface_of_a_block_has_its_volume_under_affine_maps() {
    let (nodes, carried) = block(4);
    let mut noise = Noise(7);
    for _ in 0..20 {
        let map = DMat3::from_cols(noise.vector(), noise.vector(), noise.vector());
        let shift = noise.vector() * 10.0;
        let place = |&at: &DVec3| map * at + shift;
        let points = carried.positions(&nodes.iter().map(place).collect::<Vec<_>>());
        let far = points.iter().zip(&carried.rest).fold(0.0, |far: f64, (at, rest)| far.max(at.distance(place(rest))));
        assert!(far < 1e-14 * 20.0, "{far:e}");
        let expected = 27.0 * map.determinant();
        let found = volume(&points, &carried.triangles);
        assert!((found - expected).abs() < 1e-13 * 27.0, "{found} {expected}");
    }
}

/// A block that falls and rebounds is deformed otherwise; its surface has the volume of its cells to the fineness of the triangles.
#[test]
fn the_surface_of_a_moving_block_follows_its_cells() {
    let body = lattice(3, 1.0);
    let up = body.rest().iter().map(|&rest| rest + DVec3::Y * 0.5).collect();
    let around = Surroundings { gravity: DVec3::Y * -9.8, obstacles: vec![floor(0.5, 0.3)], ..Surroundings::default() };
    let mut world = world(&body, State::at_rest(up), &shape_based(1e3, 10.0), 2e-3, around);
    let [coarse, fine] = [2, 8].map(block);
    let mut least = f64::INFINITY;
    for _ in 0..10 {
        world.advance(40);
        let ratio = world.diagnostics().volume_ratio;
        let off = [&coarse, &fine].map(|(_, carried)| {
            let points = carried.positions(&world.state().position);
            (volume(&points, &carried.triangles) / 27.0 - ratio).abs()
        });
        assert!(off[1] < 1e-4 && off[1] <= 0.1 * off[0] + 1e-12, "{ratio}: {off:?}");
        least = least.min(ratio);
    }
    assert!(least < 0.99, "it was pressed: {least}");
}
