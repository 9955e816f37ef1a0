//! The shape model as a material: its moduli, its bending, its modes and its waves, compared with closed forms.

use super::settled::settled;
use super::support::{self, Noise, Remembering, bricks, forces};
use glam::{DMat3, DVec3};
use localshape_sim::geometry::volumes_at_rest;
use localshape_sim::model::shape_based::ShapeBased;
use localshape_sim::model::{ElasticModel, ModelParameters};
use localshape_sim::{Body, Dimension, Material, Springs, State};
use serde_json::json;
use std::f64::consts::PI;
use std::sync::Arc;

/// Elastic constant of an element (N/m), and the side of a cube (m).
const STIFFNESS: f64 = 1e4;
const SIDE: f64 = 0.1;

/// Cubes of a material with shear modulus `k/a`.
fn cubes(cells: [u32; 3]) -> Arc<Body> {
    bricks(cells, DVec3::splat(SIDE))
}

fn of_material(body: &Body, material: Material, bending: f64) -> ShapeBased {
    let stiffness = material.stiffness(body).into_iter().fold(0.0, f64::max);
    ShapeBased { material: Some(material), bending, ..ShapeBased::new(stiffness) }
}

fn bent(bending: f64) -> ShapeBased {
    ShapeBased { bending, ..ShapeBased::new(STIFFNESS) }
}

fn energy(body: &Arc<Body>, model: &dyn ElasticModel, position: Vec<DVec3>) -> f64 {
    let state = State::at_rest(position);
    Remembering::new(body, model, &state).report(&state).0.energy.expect("an energy")
}

/// Nodes of the layer at this height (m) along z.
fn layer(body: &Body, height: f64) -> impl Iterator<Item = usize> {
    (0..body.len()).filter(move |&node| (body.rest()[node].z - height).abs() < 1e-9)
}

/// A load (N) on the end of a bar along z: each face of its last cells distributes it to its corners alike.
fn end_load(body: &Body, total: DVec3) -> Vec<DVec3> {
    let end = body.rest()[body.len() - 1].z;
    let mut load = vec![DVec3::ZERO; body.len()];
    for nodes in body.elements().iter() {
        nodes.iter().for_each(|&node| load[node as usize] += DVec3::ONE);
    }
    let loaded: Vec<_> = layer(body, end).collect();
    let sum: f64 = loaded.iter().map(|&node| load[node].x).sum();
    let mut of_nodes = vec![DVec3::ZERO; body.len()];
    loaded.into_iter().for_each(|node| of_nodes[node] = total * (load[node].x / sum));
    of_nodes
}

/// `W = (k/a) |ε|²`, and with a material `μ |ε|² + ½ λ (J − 1)²`, for any symmetric map `1 + ε`, however large.
#[test]
fn uniform_strain_has_the_energy_of_the_material() {
    let mut noise = Noise(5);
    let body = cubes([3, 2, 4]);
    let tetrahedron = {
        let half = 0.5 * SIDE;
        let corner = [[half, half, half], [half, -half, -half], [-half, half, -half], [-half, -half, half]];
        support::body(Dimension::Space, &corner, &[&[0, 2, 1, 3]])
    };
    for _ in 0..10 {
        let (mut rows, turn) = ([[0.0; 3]; 3], DMat3::from_quat(noise.rotation()));
        for (row, column) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)] {
            let entry = 0.3 * noise.next();
            (rows[row][column], rows[column][row]) = (entry, entry);
        }
        let strain = DMat3::from_cols_array_2d(&rows);
        let squares: f64 = strain.to_cols_array().iter().map(|entry| entry * entry).sum();
        let map = turn * (DMat3::IDENTITY + strain);
        let energy = |body: &Arc<Body>, model: &ShapeBased| {
            let volume: f64 = volumes_at_rest(body).into_iter().sum();
            energy(body, model, body.rest().iter().map(|&rest| map * rest).collect()) / volume
        };
        let is = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-11, "{found} {expected}");
        for bending in [1.0, 1.0 / 3.0] {
            is(energy(&body, &bent(bending)), STIFFNESS / SIDE * squares);
        }
        for (body, poisson) in [(&body, 0.0), (&body, 0.3), (&tetrahedron, 0.0), (&tetrahedron, 0.45)] {
            let material = Material { young: 3e5, poisson };
            let excess = map.determinant() - 1.0;
            let expected = material.shear() * squares + 0.5 * material.lame(Dimension::Space) * excess * excess;
            is(energy(body, &of_material(body, material, 0.5)), expected);
        }
    }
    // k = 6 μ V / Σ |R0|²: μ a for a cube, (√2/3) μ s for a regular tetrahedron of side s.
    let material = Material { young: 2.0, poisson: 0.0 };
    let side = SIDE * f64::sqrt(2.0);
    assert!((material.stiffness(&body)[7] / SIDE - 1.0).abs() < 1e-13);
    assert!((material.stiffness(&tetrahedron)[0] / (f64::sqrt(2.0) / 3.0 * side) - 1.0).abs() < 1e-13);
    let found = ShapeBased::new(STIFFNESS).material(&body).expect("a material");
    assert!((found.young / (2.0 * STIFFNESS / SIDE) - 1.0).abs() < 1e-12 && found.poisson == 0.0);
}

/// A bar that is pulled grows by `σ/E`, and becomes thinner by `ν` times that.
#[test]
fn a_bar_that_is_pulled_has_the_moduli_of_the_material() {
    let body = cubes([2, 3, 4]);
    let (strain, thickness) = (1e-7, DVec3::new(2.0, 3.0, 4.0) * SIDE);
    for (poisson, bending) in [(0.0, 1.0), (0.3, 1.0), (0.3, 1.0 / 3.0), (0.45, 0.5)] {
        let material = Material { young: 3e5, poisson };
        let model = of_material(&body, material, bending);
        let load = end_load(&body, DVec3::Z * (material.young * strain * thickness.x * thickness.y));
        // The middle planes of symmetry do not move across themselves: here those at x = 0, y = 0 and z = 0.
        let held: Vec<_> = body.rest().iter().map(|rest| rest.to_array().map(|at| at == 0.0)).collect();
        let found = settled(&body, &model, &load, &held, body.rest());
        for (found, &rest) in found.iter().zip(body.rest()) {
            let expected = rest * DVec3::new(-poisson, -poisson, 1.0);
            let off = ((*found - rest) / strain - expected).abs().max_element();
            assert!(off < 1e-6 * thickness.z, "ν = {poisson}, β = {bending}: {off:e}");
        }
    }
}

/// A bar of N cells that is bent uniformly is stiffer than the material by `1 + (3 β − 1)/N²`, and in balance but for its ends.
#[test]
fn a_bent_bar_is_stiffer_by_its_discretisation() {
    let curvature = 1e-5;
    for cells in 1..=6u32 {
        for bending in [1.0, 0.5, 1.0 / 3.0, 0.0] {
            let (body, model) = (cubes([cells, 1, 6]), bent(bending));
            let (depth, length) = (f64::from(cells) * SIDE, 6.0 * SIDE);
            let bow = |rest: &DVec3| {
                let (x, z) = (rest.x - 0.5 * depth, rest.z - 0.5 * length);
                DVec3::new(0.5 * z * z, 0.0, -x * z)
            };
            let bow: Vec<_> = body.rest().iter().map(bow).collect();
            let (young, inertia) = (2.0 * STIFFNESS / SIDE, SIDE * depth.powi(3) / 12.0);
            let beam = 0.5 * young * inertia * curvature * curvature * length;
            let position = body.rest().iter().zip(&bow).map(|(&rest, &bow)| rest + bow * curvature).collect();
            let factor = energy(&body, &model, position) / beam;
            let expected = 1.0 + (3.0 * bending - 1.0) / f64::from(cells * cells);
            assert!((factor - expected).abs() < 1e-8, "{cells} {bending}: {factor} {expected}");
            let forces = linear_forces(&body, &model, &bow, curvature);
            for node in (1..6).flat_map(|between| layer(&body, f64::from(between) * SIDE)) {
                let relative = forces[node].length() / (STIFFNESS * SIDE * SIDE);
                assert!(relative < 1e-8, "{cells} {bending}: {relative:e}");
            }
        }
    }
}

/// The deflection of the end of a cantilever N cells thick over Timoshenko's (κ = 5/6), under a load on its end.
fn of_timoshenko(cells: u32, slenderness: u32, bending: f64) -> f64 {
    let body = cubes([cells, 1, slenderness * cells]);
    let (depth, young) = (f64::from(cells) * SIDE, 2.0 * STIFFNESS / SIDE);
    let (length, area) = (f64::from(slenderness) * depth, depth * SIDE);
    let (inertia, shear) = (area * depth * depth / 12.0, 0.5 * young);
    let strain = 1e-6;
    let load = strain * young * inertia / (length * length);
    let expected = load * length * (length * length / (3.0 * young * inertia) + 1.0 / (5.0 / 6.0 * shear * area));
    let held: Vec<_> = body.rest().iter().map(|rest| [rest.z == 0.0; 3]).collect();
    let found = settled(&body, &bent(bending), &end_load(&body, DVec3::X * load), &held, body.rest());
    let end: Vec<_> = layer(&body, length).collect();
    end.iter().map(|&node| found[node].x - body.rest()[node].x).sum::<f64>() / end.len() as f64 / expected
}

/// The figures are from an independent implementation. With β = ½ they are those of hexahedral finite elements.
#[test]
fn a_cantilever_bends_by_the_parts_of_timoshenko_that_were_computed_independently() {
    for (cells, printed, finite_elements) in
        [(1, 0.3367, 0.6656), (2, 0.6676, 0.8875), (3, 0.8185, 0.9466), (4, 0.8890, 0.9692)]
    {
        for (bending, expected) in [(1.0, printed), (0.5, finite_elements)] {
            let found = of_timoshenko(cells, 8, bending);
            assert!((found - expected).abs() < 5e-4, "{cells} cells, β = {bending}: {found} instead of {expected}");
        }
    }
    for (slenderness, expected) in [(8, 0.9946), (16, 0.9986)] {
        let found = of_timoshenko(1, slenderness, 1.0 / 3.0);
        assert!((found - expected).abs() < 5e-4, "L = {slenderness} h: {found} instead of {expected}");
    }
}

/// The elastica: a thin cantilever under a load on its end that keeps its direction. Deflections across and along over its
/// length, by integration of `θ'' = −(P L²/EI) cos θ`; Mattiasson (1981) has the same from the load 1 on.
#[test]
fn a_thin_bar_bends_as_the_elastica() {
    let table = [
        (0.5, 0.16214, 0.01592),
        (1.0, 0.30172, 0.05643),
        (2.0, 0.49346, 0.16064),
        (5.0, 0.71379, 0.38763),
        (10.0, 0.81061, 0.55500),
    ];
    let (body, model) = (cubes([2, 2, 32]), bent(1.0 / 3.0));
    let (length, depth) = (32.0 * SIDE, 2.0 * SIDE);
    let rigidity = 2.0 * STIFFNESS / SIDE * depth.powi(4) / 12.0;
    let held: Vec<_> = body.rest().iter().map(|rest| [rest.z == 0.0; 3]).collect();
    let (mut position, mut before) = (body.rest().to_vec(), 0.0);
    for (load, across, along) in table {
        // In parts, each from the shape before.
        let parts = ((load - before) / 2.5_f64).ceil() as u32;
        for part in 1..=parts {
            let load = before + (load - before) * f64::from(part) / f64::from(parts);
            let of_nodes = end_load(&body, DVec3::X * (load * rigidity / (length * length)));
            position = settled(&body, &model, &of_nodes, &held, &position);
        }
        before = load;
        let end: Vec<_> = layer(&body, length).collect();
        let moved =
            end.iter().map(|&node| position[node] - body.rest()[node]).sum::<DVec3>() / (end.len() as f64 * length);
        assert!((moved.x / across - 1.0).abs() < 0.01, "{load}: w/L = {} instead of {across}", moved.x);
        assert!((-moved.z / along - 1.0).abs() < 0.01, "{load}: u/L = {} instead of {along}", -moved.z);
    }
}

/// The forces of small displacements (N/m of the amplitude), without what is even in them.
fn linear_forces(body: &Arc<Body>, model: &dyn ElasticModel, shape: &[DVec3], amplitude: f64) -> Vec<DVec3> {
    let by = |amplitude: f64| {
        let moved = body.rest().iter().zip(shape).map(|(&rest, &shape)| rest + shape * amplitude).collect();
        forces(body, model, &State::at_rest(moved))
    };
    let (there, back) = (by(amplitude), by(-amplitude));
    there.into_iter().zip(back).map(|(there, back)| (there - back) / (2.0 * amplitude)).collect()
}

/// `ω_j = √(2k/m) sin(jπ / 2(N + 1))`, for the modes along a free column of N cubes, with any bending.
#[test]
fn a_free_column_has_the_frequencies_of_a_chain() {
    for cells in [1, 2, 5, 8] {
        let body = cubes([1, 1, cells]);
        for mode in 1..=cells {
            let phase = f64::from(mode) * PI / f64::from(cells + 1);
            let shape: Vec<_> =
                body.rest().iter().map(|rest| DVec3::Z * (phase * ((rest.z / SIDE).round() + 0.5)).cos()).collect();
            let expected = 2.0 * STIFFNESS * (0.5 * phase).sin().powi(2);
            for bending in [1.0, 1.0 / 3.0] {
                let forces = linear_forces(&body, &bent(bending), &shape, 0.01);
                for (force, shape) in forces.iter().zip(&shape) {
                    assert!((*force + *shape * expected).length() < 1e-9 * expected, "{cells} {mode} {bending}");
                }
            }
        }
    }
}

/// Along an axis of a large lattice `ω = √(8k/m) |sin(qa/2)|` for waves of pressure, whose limit is the bound of the model, and
/// `√(4k/m) |sin(qa/2)|` for waves of shear.
#[test]
fn plane_waves_have_the_speeds_of_the_material() {
    let body = cubes([2, 2, 9]);
    let is_inside = |rest: &DVec3| {
        let [x, y, z] = rest.to_array().map(|at| (at / SIDE).round() as u32);
        x == 1 && y == 1 && (1..9).contains(&z)
    };
    for phase in [0.1, 1.0, 2.0, PI] {
        for (along, share) in [(DVec3::Z, 8.0), (DVec3::X, 4.0)] {
            let expected = share * STIFFNESS * (0.5 * phase).sin().powi(2);
            let shape: Vec<_> = body.rest().iter().map(|rest| along * (phase * (rest.z / SIDE) + 0.3).cos()).collect();
            for bending in [1.0, 1.0 / 3.0] {
                let forces = linear_forces(&body, &bent(bending), &shape, 3e-6 * SIDE);
                for ((force, shape), _) in
                    forces.iter().zip(&shape).zip(body.rest()).filter(|(_, rest)| is_inside(rest))
                {
                    let off = (*force + *shape * expected).length();
                    assert!(off < 1e-9 * share * STIFFNESS, "qa = {phase}, {along}, β = {bending}: {off:e}");
                }
            }
        }
    }
}

/// What scenes are told to write for springs of a given `E`: the energies of a stretch along the six axes of an icosahedron, whose mean is that
/// over all directions, are those of a material with `ν = 1/4`, `(1.2 E/2) ε²`.
#[test]
fn springs_have_the_modulus_of_their_lengths() {
    const YOUNG: f64 = 2e5;
    const SMALL: f64 = 1e-6;
    let cubes = cubes([3, 2, 2]);
    let mut tetrahedra = localshape_sim::IndexLists::default();
    for cell in cubes.elements().iter() {
        for [a, b] in [[1, 3], [3, 2], [2, 6], [6, 4], [4, 5], [5, 1]] {
            tetrahedra.push(&[0, a, b, 7].map(|corner| cell[corner]));
        }
    }
    let (rest, mass) = (cubes.rest().to_vec(), cubes.mass().to_vec());
    let tetrahedra = Arc::new(Body::builder(rest).elements(tetrahedra).masses(mass).build().expect("a body"));
    for (body, named) in
        [(&cubes, Springs::EdgesFaceDiagonals), (&cubes, Springs::EdgesOneDiagonal), (&tetrahedra, Springs::Edges)]
    {
        let volume: f64 = volumes_at_rest(body).iter().sum();
        let springs = support::mass_spring(body, 1.0, 0.0, named).springs;
        let squared = |&[i, j]: &[u32; 2]| (body.rest()[i as usize] - body.rest()[j as usize]).length_squared();
        let stiffness = 6.0 * YOUNG * volume / springs.iter().map(squared).sum::<f64>();
        let model = support::mass_spring(body, stiffness, 0.0, named);
        let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
        let axes = [1.0, -1.0].into_iter().flat_map(|one| [[0.0, one, golden], [one, golden, 0.0], [golden, 0.0, one]]);
        let mean = axes
            .map(|axis| DVec3::from_array(axis).normalize())
            .map(|n| energy(body, &model, body.rest().iter().map(|&at| at + n * (n.dot(at) * SMALL)).collect()));
        let density = mean.sum::<f64>() / 6.0 / volume;
        assert!((density / (0.6 * YOUNG * SMALL * SMALL) - 1.0).abs() < 1e-5, "{named:?}: {density}");
    }
}

/// Two tetrahedra, of which a node of the small one moves: each is damped in proportion to its elastic constant, whatever the model. With
/// `stiffness` both have the same.
#[test]
fn damping_is_in_proportion_to_the_stiffness_of_elements() {
    const DAMPING: f64 = 3.0;
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.25, 0.25, -0.25]];
    let both = support::body(Dimension::Space, &corners, &[&[0, 1, 2, 3], &[0, 2, 1, 4]]);
    let small = support::body(Dimension::Space, &corners, &[&[0, 2, 1, 4]]);
    let [large, low] = Material { young: 1e3, poisson: 0.0 }.stiffness(&both)[..] else { panic!("two elements") };
    assert!((large - 222.2).abs() < 0.1 && (low - 89.9).abs() < 0.1, "{large} {low}");
    let mut moving = State::at_rest(both.rest().to_vec());
    moving.velocity[4] = DVec3::Z;
    let force = |body: &Arc<Body>, parameters: serde_json::Value| {
        let parameters: ModelParameters = serde_json::from_value(parameters).expect("a model");
        forces(body, &*parameters.resolve(body, None).expect("it fits"), &moving)[4]
    };
    let of = |kind: &str, key: &str| json!({ "kind": kind, key: 1e3, "damping": DAMPING });
    // −3 (1 − 1/4) N.
    let [given, material] = ["stiffness", "young"].map(|key| force(&both, of("shape-based", key)).z);
    assert!((given + 2.25).abs() < 1e-12 && (material + 2.25 * low / large).abs() < 1e-12, "{given} {material}");
    for kind in ["linear", "corotational", "neo-hookean"] {
        let [found, alone] = [&both, &small].map(|body| force(body, of(kind, "young")));
        assert!(alone.length() > 0.1 && (found - alone * (low / large)).length() < 1e-12, "{kind}: {found} {alone}");
    }
    // Cells of a lattice, one of them half as long: k = 6 μ V/Σ|R0|².
    let corners: Vec<_> = (0..12).map(|at| [[0.0, 1.0, 1.5][at % 3], (at / 3 % 2) as f64, (at / 6) as f64]).collect();
    let cells = [0, 1].map(|x: u32| [0, 1, 3, 4, 6, 7, 9, 10].map(|node| node + x));
    let both = support::body(Dimension::Space, &corners, &[&cells[0], &cells[1]]);
    let half = support::body(Dimension::Space, &corners, &[&cells[1]]);
    let [large, low] = Material { young: 1e3, poisson: 0.0 }.stiffness(&both)[..] else { panic!("two elements") };
    let mut moving = State::at_rest(both.rest().to_vec());
    moving.velocity[2] = DVec3::new(1.0, 0.5, 0.2);
    for kind in ["metric", "linear", "corotational", "neo-hookean"] {
        let [found, alone] = [&both, &half].map(|body| {
            let parameters: ModelParameters = serde_json::from_value(of(kind, "young")).expect("a model");
            forces(body, &*parameters.resolve(body, None).expect("it fits"), &moving)[2]
        });
        assert!(alone.length() > 0.1 && (found - alone * (low / large)).length() < 1e-12, "{kind}: {found} {alone}");
    }
}

/// The cycle of springs with volumes has the stiffness of an element against changes of its volume, `3κa/2` of a cube and `2κ` of a square, if that
/// is greater than a spring's; the damping ratio has that of the springs.
#[test]
fn volumes_count_in_the_cycle_and_not_in_the_damping_ratio() {
    let cubes = bricks([2, 1, 1], DVec3::splat(SIDE));
    let cubes = Arc::new(Body::clone(&cubes).with_masses(vec![0.01; cubes.len()]).expect("masses"));
    let square = [[0.0; 3], [SIDE, 0.0, 0.0], [SIDE, SIDE, 0.0], [0.0, SIDE, 0.0]];
    let square = support::body(Dimension::Plane, &square, &[&[0, 1, 2, 3]]);
    for (body, bulk, stiffest) in [(&cubes, 1e4, 1500.0), (&cubes, 1e3, 500.0), (&square, 1e3, 2000.0)] {
        let parameters = json!({ "kind": "volume-springs", "stiffness": 500.0, "bulk": bulk, "damping_ratio": 0.1 });
        let parameters: ModelParameters = serde_json::from_value(parameters).expect("a model");
        let model = parameters.resolve(body, None).expect("it fits");
        let cycle = 2.0 * PI * (body.mass()[0] / stiffest).sqrt();
        let own = model.properties(body);
        assert!((own.shortest_period(body) / cycle - 1.0).abs() < 1e-12, "{bulk}: {}", own.shortest_period(body));
        assert!((own.damping / (0.2 * (500.0 * body.mass()[0]).sqrt()) - 1.0).abs() < 1e-12, "{}", own.damping);
    }
}
