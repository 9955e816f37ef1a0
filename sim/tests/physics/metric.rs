//! The energy of a changed metric: as a material, and what it does not see.

use super::support::{Noise, Remembering, body, forces, lattice};
use glam::{DMat3, DVec3};
use localshape_sim::model::metric::{Metric, Parameters};
use localshape_sim::model::{ModelParameters, continuum};
use localshape_sim::{Body, Dimension, IndexLists, Material, State};
use std::sync::Arc;

const MATERIAL: Material = Material { young: 3e4, poisson: 0.3 };

/// A sheet of `cells`² quadrilaterals, whose inner nodes are moved by up to `irregular` sides (m).
fn sheet(cells: u32, side: f64, irregular: f64) -> Arc<Body> {
    let (n, mut noise) = (cells + 1, Noise(3));
    let mut rest = Vec::new();
    for (y, x) in (0..n).flat_map(|y| (0..n).map(move |x| (y, x))) {
        let is_inner = (1..cells).contains(&x) && (1..cells).contains(&y);
        let off = if is_inner { noise.vector().with_z(0.0) * irregular } else { DVec3::ZERO };
        rest.push((DVec3::new(f64::from(x), f64::from(y), 0.0) + off) * side);
    }
    let mut elements = IndexLists::default();
    for (y, x) in (0..cells).flat_map(|y| (0..cells).map(move |x| (y, x))) {
        let first = x + n * y;
        elements.push(&[first, first + 1, first + n + 1, first + n]);
    }
    let mass = vec![1.0; rest.len()];
    Arc::new(Body::builder(rest).dimension(Dimension::Plane).elements(elements).masses(mass).build().expect("a body"))
}

/// The energy density of St. Venant and Kirchhoff (Pa).
fn density(map: DMat3, dimension: Dimension) -> f64 {
    let strain = (map.transpose() * map - DMat3::IDENTITY) * 0.5;
    let trace = strain.x_axis.x + strain.y_axis.y + strain.z_axis.z;
    let squares: f64 = strain.to_cols_array().iter().map(|entry| entry * entry).sum();
    MATERIAL.shear() * squares + 0.5 * MATERIAL.lame(dimension) * trace * trace
}

fn energy(body: &Arc<Body>, position: Vec<DVec3>) -> f64 {
    let model = Metric::new(body, MATERIAL, 0.0).expect("cells");
    let state = State::at_rest(position);
    Remembering::new(body, &model, &state).report(&state).0.energy.expect("an energy")
}

/// Lattices of cells of any shape in uniform strain, however large.
#[test]
fn uniform_strain_has_the_energy_of_the_material() {
    let skew = DMat3::from_cols(DVec3::new(0.2, 0.05, 0.0), DVec3::new(-0.03, 0.1, 0.04), DVec3::new(0.1, 0.0, 0.3));
    let cubes = lattice(3, 1.0);
    let rest = cubes.rest().iter().map(|&rest| skew * rest).collect();
    let mass = vec![1.0; cubes.len()];
    let bricks = Body::builder(rest).elements(cubes.elements().clone()).masses(mass).build().expect("a body");
    let in_space = DMat3::from_cols(DVec3::new(1.4, 0.2, -0.1), DVec3::new(0.3, 0.7, 0.0), DVec3::new(0.0, -0.6, 1.1));
    let in_plane = DMat3::from_cols(DVec3::new(1.4, 0.2, 0.0), DVec3::new(0.3, 0.7, 0.0), DVec3::Z);
    let skewed = 27.0 * skew.determinant();
    for (body, map, volume) in [
        (Arc::new(bricks), in_space, skewed),
        (sheet(5, 0.1, 0.0), in_plane, 0.25),
        (sheet(5, 0.1, 0.3), in_plane, 0.25),
    ] {
        let found = energy(&body, body.rest().iter().map(|&rest| map * rest).collect());
        let expected = volume * density(map, body.dimension());
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
}

/// In irregular lattices in space it is a little too small.
#[test]
fn the_energy_of_irregular_cells_in_space_is_almost_that_of_the_material() {
    let (cubes, mut noise) = (lattice(4, 1.0), Noise(9));
    let is_inner = |rest: DVec3| rest.to_array().iter().all(|&at| at > 0.0 && at < 4.0);
    let rest =
        cubes.rest().iter().map(|&rest| if is_inner(rest) { rest + noise.vector() * 0.3 } else { rest }).collect();
    let mass = vec![1.0; cubes.len()];
    let body = Arc::new(Body::builder(rest).elements(cubes.elements().clone()).masses(mass).build().expect("a body"));
    let map = DMat3::from_cols(DVec3::new(1.2, 0.1, 0.0), DVec3::new(0.0, 0.9, 0.1), DVec3::new(0.2, 0.0, 1.1));
    let share =
        energy(&body, body.rest().iter().map(|&rest| map * rest).collect()) / (64.0 * density(map, body.dimension()));
    assert!((0.9995..1.0).contains(&share), "{share}");
}

/// The patch test in the plane.
#[test]
fn constant_stress_exerts_no_force_inside_irregular_sheets() {
    let sheet = sheet(6, 0.1, 0.3);
    let map = DMat3::from_cols(DVec3::new(1.1, 0.2, 0.0), DVec3::new(-0.1, 0.8, 0.0), DVec3::Z);
    let state = State::at_rest(sheet.rest().iter().map(|&rest| map * rest).collect());
    let forces = forces(&sheet, &Metric::new(&sheet, MATERIAL, 0.0).expect("cells"), &state);
    let largest = forces.iter().fold(0.0, |most: f64, force| most.max(force.length()));
    for (force, rest) in forces.iter().zip(sheet.rest()) {
        let is_inner = rest.x > 0.01 && rest.y > 0.01 && rest.x < 0.59 && rest.y < 0.59;
        assert!(!is_inner || force.length() < 1e-13 * largest, "{force}");
    }
}

/// The error of the energy of a bent and stretched body falls with the square of the side.
#[test]
fn the_limit_of_small_cells_is_the_material() {
    let bend = |p: DVec3| DVec3::new(p.x + 0.2 * p.y * p.y, p.y * (1.0 + 0.3 * p.x), p.z + 0.1 * p.x * p.y);
    let map = |p: DVec3| {
        DMat3::from_cols(
            DVec3::new(1.0, 0.3 * p.y, 0.1 * p.y),
            DVec3::new(0.4 * p.y, 1.0 + 0.3 * p.x, 0.1 * p.x),
            DVec3::Z,
        )
    };
    // The density is a polynomial of degree 8 at most in each of x and y: Gauss's rule of five points is exact.
    let rule = [
        (0.0, 128.0 / 225.0),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
        (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ];
    let mut exact = 0.0;
    for ((x, wx), (y, wy)) in rule.iter().flat_map(|x| rule.iter().map(move |y| (*x, *y))) {
        let at = DVec3::new(0.5 + 0.5 * x, 0.5 + 0.5 * y, 0.0);
        exact += 0.25 * wx * wy * density(map(at), Dimension::Space);
    }
    let errors = [4, 8, 16].map(|cells| {
        let cubes = lattice(cells, 1.0 / f64::from(cells));
        energy(&cubes, cubes.rest().iter().map(|&rest| bend(rest)).collect()) / exact - 1.0
    });
    assert!(errors[0].abs() < 0.05, "{errors:?}");
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.9..2.1).contains(&order), "{errors:?}");
    }
}

/// A metric does not see reflections: as springs, and unlike the shape model.
#[test]
fn a_mirrored_body_is_at_rest() {
    for body in [lattice(2, 0.1), sheet(3, 0.1, 0.2)] {
        let mirrored = State::at_rest(body.rest().iter().map(|&rest| rest * DVec3::new(-1.0, 1.0, 1.0)).collect());
        let forces = forces(&body, &Metric::new(&body, MATERIAL, 0.0).expect("cells"), &mirrored);
        assert!(forces.iter().all(|force| force.length() < 1e-12 * MATERIAL.young), "{forces:?}");
    }
}

#[test]
fn bodies_that_are_no_lattices_are_refused_with_what_it_takes() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let dart = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.2, 0.2, 0.0], [0.0, 1.0, 0.0]];
    let cases = [
        (body(Dimension::Space, &corners, &[&[0, 1, 2, 3]]), "element 0 has 4 nodes and is no cell"),
        (body(Dimension::Plane, &corners[..3], &[&[0, 1, 2]]), "`metric` takes quadrilaterals"),
        (body(Dimension::Plane, &dart, &[&[0, 1, 2, 3]]), "the edges of element 0 at node 2 span no"),
    ];
    for (body, expected) in cases {
        let parameters = ModelParameters::from(Parameters(continuum::Parameters { young: 1e4, ..Default::default() }));
        let misfit = parameters.resolve(&body, None).expect_err("no lattice");
        assert!(misfit.message.contains(expected) && misfit.message.contains("`shape-based`"), "{misfit}");
    }
}
