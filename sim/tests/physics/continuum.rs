//! Finite elements: linear, corotational and stable neo-Hookean.

use super::support::{Noise, Remembering, body, forces, free, lattice, stepped};
use glam::{DMat3, DVec3};
use localshape_sim::geometry::volumes_at_rest;
use localshape_sim::model::continuum::Parameters;
use localshape_sim::model::metric::Metric;
use localshape_sim::model::shape_based::{DampingReading, RotationReading, ShapeBased};
use localshape_sim::model::{ElasticModel, Misfit, ModelParameters, corotational, linear, neo_hookean};
use localshape_sim::stability::{Restraint, Stability};
use localshape_sim::{Body, Dimension, IndexLists, Integrator, Material, Solids, State, Status};
use std::sync::Arc;

const YOUNG: f64 = 1e4;

type Model = Arc<dyn ElasticModel>;

type Make = fn(Parameters, &Body) -> Result<Model, Misfit>;

const LINEAR: Make = |parameters, body| ModelParameters::from(linear::Parameters(parameters)).resolve(body, None);
const COROTATIONAL: Make =
    |parameters, body| ModelParameters::from(corotational::Parameters(parameters)).resolve(body, None);
const NEO_HOOKEAN: Make =
    |parameters, body| ModelParameters::from(neo_hookean::Parameters(parameters)).resolve(body, None);

fn made(make: Make, body: &Body, poisson: f64, damping_ratio: f64) -> Model {
    let (poisson, damping_ratio) = (Some(poisson), Some(damping_ratio).filter(|&ratio| ratio > 0.0));
    make(Parameters { young: YOUNG, poisson, damping_ratio, damping: None }, body).expect("elements that it takes")
}

fn all(body: &Body, poisson: f64, damping_ratio: f64) -> [Model; 3] {
    [LINEAR, COROTATIONAL, NEO_HOOKEAN].map(|make| made(make, body, poisson, damping_ratio))
}

/// Elements into which cells of a lattice are divided.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Cells {
    Hexahedra,
    Tetrahedra,
    Quadrilaterals,
    Triangles,
}

const CELLS: [Cells; 4] = [Cells::Hexahedra, Cells::Tetrahedra, Cells::Quadrilaterals, Cells::Triangles];

/// A block of cells of a side of 1 m, with nodes of 1 kg moved by up to a share of it.
fn block(cells: Cells, count: [u32; 3], irregular: f64) -> Arc<Body> {
    let in_plane = matches!(cells, Cells::Quadrilaterals | Cells::Triangles);
    let [nx, ny, nz] = [count[0], count[1], if in_plane { 0 } else { count[2] }];
    let at = |x: u32, y: u32, z: u32| x + (nx + 1) * (y + (ny + 1) * z);
    let mut noise = Noise(3);
    let mut rest = Vec::new();
    for (z, y, x) in (0..=nz).flat_map(|z| (0..=ny).flat_map(move |y| (0..=nx).map(move |x| (z, y, x)))) {
        let moved = noise.vector() * irregular;
        rest.push(DVec3::new(x.into(), y.into(), z.into()) + if in_plane { moved.with_z(0.0) } else { moved });
    }
    let mut elements = IndexLists::default();
    for (z, y, x) in (0..nz.max(1)).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| (z, y, x)))) {
        let corner = |bit: u32| at(x + (bit & 1), y + (bit >> 1 & 1), z + (bit >> 2));
        match cells {
            Cells::Hexahedra => elements.push(&[0, 1, 2, 3, 4, 5, 6, 7].map(corner)),
            Cells::Quadrilaterals => elements.push(&[0, 1, 3, 2].map(corner)),
            Cells::Triangles => {
                elements.push(&[0, 1, 3].map(corner));
                elements.push(&[0, 3, 2].map(corner));
            }
            // H. Kuhn's six, along the ways from corner 0 to corner 7.
            Cells::Tetrahedra => {
                for [a, b] in [[1, 3], [3, 2], [2, 6], [6, 4], [4, 5], [5, 1]] {
                    elements.push(&[0, a, b, 7].map(corner));
                }
            }
        }
    }
    let (dimension, mass) = (if in_plane { Dimension::Plane } else { Dimension::Space }, vec![1.0; rest.len()]);
    Arc::new(Body::builder(rest).dimension(dimension).elements(elements).masses(mass).build().expect("a body"))
}

/// A regular tetrahedron of this side (m), turned.
fn regular(side: f64) -> Arc<Body> {
    let corners = [[1.0, 1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0], [-1.0, -1.0, 1.0]].map(DVec3::from_array);
    let turn = Noise(4).rotation();
    let rest: Vec<_> = corners.iter().map(|&corner| turn * corner * (side / 8.0_f64.sqrt())).collect();
    let elements = [&[0, 1, 2, 3][..]].into_iter().collect();
    let body = Body::builder(rest).elements(elements).build().expect("a body");
    assert!(volumes_at_rest(&body)[0] > 0.0);
    Arc::new(body)
}

fn largest(forces: &[DVec3]) -> f64 {
    forces.iter().fold(0.0, |largest: f64, force| largest.max(force.length()))
}

/// Some matrix with entries up to 1, without effect on z in the plane.
fn matrix(noise: &mut Noise, dimension: Dimension) -> DMat3 {
    let [x, y, z] = [noise.vector(), noise.vector(), noise.vector()];
    match dimension {
        Dimension::Plane => DMat3::from_cols(x.with_z(0.0), y.with_z(0.0), DVec3::ZERO),
        Dimension::Space => DMat3::from_cols(x, y, z),
    }
}

fn mapped(body: &Body, map: DMat3) -> State {
    State::at_rest(body.rest().iter().map(|&rest| map * rest).collect())
}

fn squares(matrix: DMat3) -> f64 {
    matrix.to_cols_array().iter().map(|entry| entry * entry).sum()
}

fn trace(matrix: DMat3) -> f64 {
    matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z
}

/// In a map that is the same everywhere, the energy is the volume times the density of the documentation.
#[test]
fn energies_of_affine_maps_are_those_of_the_material() {
    let mut noise = Noise(17);
    // Cells that are boxes but for a hundredth of a per cent are no boxes.
    for (cells, irregular) in CELLS.into_iter().flat_map(|cells| [0.0, 1e-4, 0.15].map(|part| (cells, part))) {
        let body = block(cells, [2, 1, 2], irregular);
        let volume: f64 = volumes_at_rest(&body).iter().sum();
        let material = Material { young: YOUNG, poisson: 0.3 };
        let (mu, lambda) = (material.shear(), material.lame(body.dimension()));
        let d = if body.dimension() == Dimension::Plane { 2.0 } else { 3.0 };
        for scale in [1e-3, 0.3, 1.0] {
            let f = DMat3::IDENTITY + matrix(&mut noise, body.dimension()) * scale;
            let strain = (f + f.transpose()) * 0.5 - DMat3::IDENTITY;
            let r = match body.dimension() {
                Dimension::Plane => {
                    let (cosine, sine) = (f.x_axis.x + f.y_axis.y, f.x_axis.y - f.y_axis.x);
                    DMat3::from_rotation_z(libm::atan2(sine, cosine))
                }
                Dimension::Space => {
                    let optimum = localshape_sim::rotation::davenport1968::optimum;
                    DMat3::from_quat(optimum(f.transpose(), glam::DQuat::IDENTITY))
                }
            };
            let alpha = 1.0 + mu / (lambda + mu);
            let of_volume = |j: f64| (lambda + mu) * (j - alpha) * (j - alpha);
            // Out of the plane the map is 1.
            let f2 = squares(f) - (3.0 - d);
            let stretch = trace(r.transpose() * f) - 3.0;
            let expected = [
                mu * squares(strain) + 0.5 * lambda * trace(strain).powi(2),
                mu * squares(f - r) + 0.5 * lambda * stretch * stretch,
                0.5 * (mu * (f2 - d) + of_volume(f.determinant())) - 0.5 * of_volume(1.0),
            ];
            for (model, expected) in all(&body, 0.3, 0.0).iter().zip(expected) {
                let state = mapped(&body, f);
                let energy =
                    Remembering::new(&body, model.as_ref(), &state).report(&state).0.energy.expect("an energy");
                let error = (energy - volume * expected).abs();
                let tolerance = 1e-12 * volume * (expected + 1e-3 * YOUNG);
                assert!(error < tolerance, "{model:?} {cells:?} {irregular} {scale}: {energy} {}", volume * expected);
            }
        }
    }
}

/// An affine displacement leaves the inner nodes of irregular bodies without forces, whatever the material.
#[test]
fn elements_pass_the_patch_test() {
    let mut noise = Noise(8);
    for cells in CELLS {
        let body = block(cells, [3, 3, 3], 0.2);
        let inner: Vec<usize> = (0..body.len())
            .filter(|&node| {
                let axes = if body.dimension() == Dimension::Plane { 2 } else { 3 };
                let at = [node % 4, node / 4 % 4, node / 16];
                at[..axes].iter().all(|&at| at == 1 || at == 2)
            })
            .collect();
        assert!(inner.len() >= 4);
        for (poisson, scale) in [(0.0, 0.01), (0.3, 0.01), (0.3, 0.5)] {
            let state = mapped(&body, DMat3::IDENTITY + matrix(&mut noise, body.dimension()) * scale);
            for model in all(&body, poisson, 0.0) {
                let forces = forces(&body, model.as_ref(), &state);
                let most = inner.iter().map(|&node| forces[node].length()).fold(0.0, f64::max);
                // The round-off of the stresses that cancel.
                assert!(
                    most < 1e-14 * YOUNG && largest(&forces) > 1e-3 * scale * YOUNG,
                    "{model:?} {cells:?}: {most:e}"
                );
            }
        }
    }
}

/// At small strain all three have Hooke's law, and no stress at rest.
#[test]
fn small_strains_have_one_law() {
    const SMALL: f64 = 1e-7;
    for (cells, irregular) in CELLS.into_iter().flat_map(|cells| [(cells, 0.0), (cells, 0.15)]) {
        for poisson in [0.0, 0.3, 0.49] {
            let body = block(cells, [2, 2, 1], irregular);
            let flat = |v: DVec3| if body.dimension() == Dimension::Plane { v.with_z(0.0) } else { v };
            let mut noise = Noise(2);
            let moved = body.rest().iter().map(|&rest| rest + flat(noise.vector()) * SMALL).collect();
            let (rest, moved) = (State::at_rest(body.rest().to_vec()), State::at_rest(moved));
            let [linear, others @ ..] = all(&body, poisson, 0.0);
            let expected = forces(&body, linear.as_ref(), &moved);
            for model in others {
                let still = largest(&forces(&body, model.as_ref(), &rest));
                assert!(still < 1e-14 * YOUNG, "{model:?} {cells:?}: {still:e}");
                let found = forces(&body, model.as_ref(), &moved);
                let far = found.iter().zip(&expected).fold(0.0, |far: f64, (a, b)| far.max(a.distance(*b)));
                assert!(far < 20.0 * SMALL * largest(&expected), "{model:?} {cells:?}: {far:e}");
            }
        }
    }
}

/// On regular tetrahedra, and without a Poisson's ratio, corotational elements are the paper's model.
#[test]
fn corotational_regular_tetrahedra_are_the_shape_model() {
    for side in [0.1, 1.0] {
        let body = regular(side);
        let material = Material { young: YOUNG, poisson: 0.0 };
        let stiffness = material.stiffness(&body)[0];
        assert!((stiffness / (2.0_f64.sqrt() / 3.0 * material.shear() * side) - 1.0).abs() < 1e-14);
        let rotation = RotationReading::Robust;
        let shape = ShapeBased { material: Some(material), rotation, ..ShapeBased::new(stiffness) };
        let element = made(COROTATIONAL, &body, 0.0, 0.0);
        let mut noise = Noise(6);
        for scale in [1e-3, 0.1, 1.0, 3.0] {
            for _ in 0..50 {
                // Some of these are turned inside out.
                let map = DMat3::from_quat(noise.rotation()) + matrix(&mut noise, Dimension::Space) * scale;
                let state = mapped(&body, map);
                let [a, b] = [&shape as &dyn ElasticModel, element.as_ref()].map(|model| forces(&body, model, &state));
                let far = a.iter().zip(&b).fold(0.0, |far: f64, (a, b)| far.max(a.distance(*b)));
                assert!(far < 1e-12 * stiffness * side * (1.0 + scale), "{scale}: {far:e}");
            }
        }
    }
}

/// A rigid rotation by φ counts as a strain of `cos φ − 1` along both axes across it.
#[test]
fn linear_elements_take_rotation_for_strain() {
    let body = lattice(2, 0.1);
    let model = made(LINEAR, &body, 0.25, 0.0);
    let material = Material { young: YOUNG, poisson: 0.25 };
    for angle in [0.01, 0.5, 2.0_f64] {
        let state = mapped(&body, DMat3::from_rotation_z(angle));
        let energy = Remembering::new(&body, model.as_ref(), &state).report(&state).0.energy.expect("an energy");
        let strain = angle.cos() - 1.0;
        let density = (2.0 * material.shear() + 2.0 * material.lame(body.dimension())) * strain * strain;
        assert!((energy / (0.008 * density) - 1.0).abs() < 1e-9, "{angle}: {energy}");
    }
}

/// From a point, a line, a plane, a mirror image or half a turn bodies end in finite states, or are told to diverge.
#[test]
fn degenerate_and_inverted_elements_end_well() {
    type Map = fn(DVec3) -> DVec3;
    let starts: [(&str, Map); 6] = [
        ("a point", |_| DVec3::ZERO),
        ("a line", |r| DVec3::X * r.x),
        ("a plane", |r| r.with_z(0.0) * DVec3::new(1.0, 0.5, 0.0)),
        ("a mirror image", |r| r * DVec3::new(-1.0, 1.0, 1.0)),
        ("an inversion", |r| r * DVec3::new(-1.0, -1.0, -1.0)),
        ("huge", |r| r * 1e3),
    ];
    for cells in CELLS {
        let body = block(cells, [2, 1, 1], 0.1);
        for (poisson, (name, map)) in [0.0, 0.4].into_iter().flat_map(|poisson| starts.map(|start| (poisson, start))) {
            for (disorder, model) in [0.0, 1e-3].into_iter().flat_map(|off| all(&body, poisson, 0.2).map(|m| (off, m)))
            {
                let mut noise = Noise(7);
                let flat = |v: DVec3| if body.dimension() == Dimension::Plane { v.with_z(0.0) } else { v };
                let place = |&rest: &DVec3| flat(map(rest) + noise.vector() * disorder);
                let start = State::at_rest(body.rest().iter().map(place).collect());
                let found = forces(&body, model.as_ref(), &start);
                assert!(found.iter().all(|force| force.is_finite()), "{model:?} {cells:?} {name}");
                let mut world = free(&body, start, model.as_ref(), 2e-3);
                world.advance(4000);
                let is_finite = world.state().position.iter().chain(&world.state().velocity).all(|v| v.is_finite());
                match world.status() {
                    Status::Ok => assert!(is_finite, "{model:?} {cells:?} {name}"),
                    _ => assert!(name == "huge", "{model:?} {cells:?} {name}"),
                }
            }
        }
    }
}

/// Corotational and neo-Hookean bodies that are mirrored turn back, with their energy damped away.
#[test]
fn mirrored_elements_turn_back() {
    for cells in CELLS {
        let body = block(cells, [1, 1, 1], 0.05);
        for model in [made(COROTATIONAL, &body, 0.2, 0.2), made(NEO_HOOKEAN, &body, 0.2, 0.2)] {
            let mut noise = Noise(7);
            let flat = |v: DVec3| if body.dimension() == Dimension::Plane { v.with_z(0.0) } else { v };
            let place = |&rest: &DVec3| flat(rest * DVec3::new(-1.0, 1.0, 1.0) + noise.vector() * 1e-2);
            let mut world = free(&body, State::at_rest(body.rest().iter().map(place).collect()), model.as_ref(), 2e-3);
            world.advance(20_000);
            let d = world.diagnostics();
            assert!(d.turned_over == 0 && d.elastic < 1e-9 * YOUNG, "{model:?} {cells:?}: {d:?}");
        }
    }
}

/// The predicted largest stable step lies within 1 % of the largest one that is stable.
#[test]
fn predicted_steps_are_the_largest_stable_ones() {
    for (cells, integrator) in CELLS
        .into_iter()
        .flat_map(|cells| [Integrator::SemiImplicitEuler, Integrator::VelocityVerlet].map(|one| (cells, one)))
    {
        let body = block(cells, [3, 2, 2], 0.1);
        for (poisson, damping) in [(0.0, 0.0), (0.4, 0.0), (0.3, 0.1)] {
            // For other methods than the first the prediction with damping is a lower bound.
            if damping > 0.0 && integrator != Integrator::SemiImplicitEuler {
                continue;
            }
            for model in all(&body, poisson, damping) {
                let largest = Stability::of(&body, model.as_ref(), integrator, Restraint::default()).largest;
                let grows = |share: f64| {
                    let mut noise = Noise(12);
                    let flat = |v: DVec3| if body.dimension() == Dimension::Plane { v.with_z(0.0) } else { v };
                    let start = body.rest().iter().map(|&rest| rest + flat(noise.vector()) * 1e-9).collect();
                    let mut world = stepped(&body, State::at_rest(start), model.as_ref(), integrator, share * largest);
                    world.advance(1500);
                    let far = world.state().position.iter().zip(body.rest()).map(|(p, rest)| p.distance(*rest));
                    world.status() != Status::Ok || far.fold(0.0, f64::max) > 1e-5
                };
                assert!(!grows(0.99) && grows(1.01), "{model:?} {cells:?} {integrator:?}: {largest}");
            }
        }
    }
}

/// The tip of a cantilever of square section and eight heights long over S. Timoshenko's beam, by hexahedra with full integration: too stiff
/// by about `1 + 1/2N²` with `N` cells in the height.
#[test]
fn cantilevers_bend_as_known() {
    for (cells, expected) in [(1, 0.6656), (2, 0.8875)] {
        let length = 8 * cells;
        let body = block(Cells::Hexahedra, [length, cells, cells], 0.0);
        let (height, load) = (f64::from(cells), 1e-3);
        let poisson = 0.0;
        let model = made(LINEAR, &body, poisson, 0.0);
        // A uniform traction at the end: each face there has a quarter of its force at each of its nodes.
        let mut given = vec![DVec3::ZERO; body.len()];
        let side = cells + 1;
        for (y, z) in (0..side).flat_map(|y| (0..side).map(move |z| (y, z))) {
            let share = |at: u32| if at == 0 || at == cells { 0.5 } else { 1.0 };
            let node = length + (length + 1) * (y + side * z);
            given[node as usize].z = load * share(y) * share(z) / f64::from(cells * cells);
        }
        let held: Vec<bool> = body.rest().iter().map(|rest| rest.x == 0.0).collect();
        let stiffness = |u: &[DVec3]| -> Vec<DVec3> {
            let moved = State::at_rest(body.rest().iter().zip(u).map(|(rest, u)| *rest + *u).collect());
            let forces = forces(&body, model.as_ref(), &moved);
            forces.iter().zip(&held).map(|(force, &held)| if held { DVec3::ZERO } else { -*force }).collect()
        };
        let u = conjugate_gradients(stiffness, &given);
        let tip: f64 = given.iter().zip(&u).map(|(force, u)| force.dot(*u)).sum::<f64>() / load;
        let (long, inertia, area) = (8.0 * height, height.powi(4) / 12.0, height * height);
        let shear = YOUNG / 2.0;
        let timoshenko = load * long.powi(3) / (3.0 * YOUNG * inertia) + load * long / (5.0 / 6.0 * shear * area);
        assert!((tip / timoshenko - expected).abs() < 5e-5, "{cells}: {}", tip / timoshenko);
    }
}

/// `u` with `K u = f`.
fn conjugate_gradients(product: impl Fn(&[DVec3]) -> Vec<DVec3>, given: &[DVec3]) -> Vec<DVec3> {
    let dot = |a: &[DVec3], b: &[DVec3]| a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum::<f64>();
    let add = |a: &[DVec3], b: &[DVec3], factor: f64| -> Vec<DVec3> {
        a.iter().zip(b).map(|(a, b)| *a + *b * factor).collect()
    };
    let mut solution = vec![DVec3::ZERO; given.len()];
    let (mut residual, mut direction) = (given.to_vec(), given.to_vec());
    let first = dot(given, given);
    for _ in 0..5 * given.len() {
        let (image, before) = (product(&direction), dot(&residual, &residual));
        if before < 1e-20 * first {
            break;
        }
        let step = before / dot(&direction, &image);
        solution = add(&solution, &direction, step);
        residual = add(&residual, &image, -step);
        direction = add(&residual, &direction, dot(&residual, &residual) / before);
    }
    solution
}

/// Damping by hand, `−D (v − v̄ − ω × r)`, of elements a hundred times as long as thick, and none of their rigid motion.
#[test]
fn thin_elements_are_damped_without_their_rigid_motion() {
    const DAMPING: f64 = 3.0;
    let mut noise = Noise(5);
    let turn = noise.rotation();
    let corners = |of: &Body| of.rest().iter().map(|&rest| turn * (rest * DVec3::new(1.0, 0.01, 0.01))).collect();
    let [cube, four] = [lattice(1, 1.0), regular(1.0)].map(|of| {
        let body = Body::builder(corners(&of)).elements(of.elements().clone()).masses(of.mass().to_vec());
        Arc::new(body.build().expect("a body"))
    });
    let given = Parameters { young: YOUNG, damping: Some(DAMPING), ..Parameters::default() };
    let damping_of = DampingReading::Deformation;
    for body in [cube, four] {
        let shape = ShapeBased { damping: DAMPING, damping_of, ..ShapeBased::new(YOUNG) };
        let mut models: Vec<Model> = vec![
            LINEAR(given.clone(), &body).expect("it fits"),
            NEO_HOOKEAN(given.clone(), &body).expect("it fits"),
            Arc::new(shape),
        ];
        let material = Material { young: YOUNG, poisson: 0.0 };
        models.extend(Metric::new(&body, material, DAMPING).ok().map(|metric| -> Model { Arc::new(metric) }));
        let count = body.len() as f64;
        let middle = body.rest().iter().sum::<DVec3>() / count;
        let r: Vec<_> = body.rest().iter().map(|&rest| rest - middle).collect();
        let spin = turn * DVec3::new(2.0, 0.3, -0.1);
        let rigid: Vec<_> = r.iter().map(|&r| DVec3::new(0.3, 0.2, 0.1) + spin.cross(r)).collect();
        let random: Vec<_> = r.iter().map(|_| noise.vector()).collect();
        let drift = random.iter().sum::<DVec3>() / count;
        let inertia = r.iter().fold(DMat3::ZERO, |sum, &r| {
            sum + DMat3::from_diagonal(DVec3::splat(r.length_squared())) - DMat3::from_cols(r * r.x, r * r.y, r * r.z)
        });
        let omega = inertia.inverse() * r.iter().zip(&random).map(|(r, v)| r.cross(*v)).sum::<DVec3>();
        let by_hand: Vec<_> = r.iter().zip(&random).map(|(&r, &v)| (v - drift - omega.cross(r)) * -DAMPING).collect();
        for (velocity, expected) in [(rigid, vec![DVec3::ZERO; r.len()]), (random, by_hand)] {
            for model in &models {
                let found = forces(&body, model.as_ref(), &State::new(body.rest().to_vec(), velocity.clone()));
                let far = found.iter().zip(&expected).fold(0.0, |far: f64, (a, b)| far.max(a.distance(*b)));
                assert!(far < 1e-9, "{model:?}: {far:e}");
            }
        }
    }
}

/// What does not fit is told, with the element and with what the models take.
#[test]
fn bodies_and_numbers_that_do_not_fit_are_told() {
    let corners =
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.4, 0.5, 1.0], [0.4, 0.5, 2.0]];
    let flat = corners.map(|[x, y, _]| [x, y, 0.0]);
    let (plane, space) = (Dimension::Plane, Dimension::Space);
    let hexahedron = |moved: DVec3| {
        let cube = lattice(1, 1.0);
        let mut rest = cube.rest().to_vec();
        rest[7] += moved;
        Body::builder(rest).dimension(space).elements(cube.elements().clone()).build().expect("a body")
    };
    let cube = lattice(1, 1.0);
    let any_order = Body::builder(cube.rest().to_vec()).elements(cube.elements().clone()).solids(Solids::Convex);
    let any_order = any_order.build().expect("a body");
    let quadrilateral =
        |x: f64| body(plane, &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [x, x, 0.0], [0.0, 1.0, 0.0]], &[&[0, 1, 2, 3]]);
    let in_space = "`corotational` takes tetrahedra and hexahedra; element 0 is";
    for (body, expected) in [
        (body(space, &corners, &[&[0, 1, 2, 3, 4]]), format!("{in_space} a pyramid")),
        (body(space, &corners, &[&[0, 1, 2, 3, 4, 5]]), format!("{in_space} a wedge")),
        (body(space, &corners, &[&[0, 1]]), format!("{in_space} a segment")),
        (body(space, &corners, &[&[0, 1, 2]]), format!("{in_space} a triangle, which has no volume")),
        (Arc::new(any_order), format!("{in_space} a polyhedron of 8 nodes in any order")),
        (
            body(plane, &flat, &[&[0, 1, 2], &[0, 1, 2, 3, 4]]),
            "`corotational` takes triangles and quadrilaterals; element 1 is a polygon of 5 nodes".into(),
        ),
        (Arc::new(hexahedron(DVec3::splat(-0.8))), "element 0 is folded".into()),
        (quadrilateral(0.2), "element 0 is folded".into()),
        (body(space, &corners, &[&[0, 1, 2, 3]]), "element 0 has no volume".into()),
    ] {
        let parameters = Parameters { young: YOUNG, ..Parameters::default() };
        let message = COROTATIONAL(parameters, &body).expect_err("it does not fit").message;
        assert!(message.starts_with(&expected), "{message}");
    }
    for sound in [Arc::new(hexahedron(DVec3::splat(-0.3))), quadrilateral(0.7)] {
        assert_eq!(all(&sound, 0.3, 0.1).len(), 3);
    }
    let half = Parameters { young: YOUNG, poisson: Some(0.5), ..Parameters::default() };
    let misfit = NEO_HOOKEAN(half, &lattice(1, 1.0)).expect_err("not a half");
    assert_eq!(misfit.key, "poisson");
    let typed = |json: serde_json::Value| serde_json::from_value::<ModelParameters>(json);
    for kind in ["linear", "corotational", "neo-hookean"] {
        let json = serde_json::json!({ "kind": kind, "young": 1e4, "poisson": 0.3, "damping_ratio": 0.1 });
        let model = typed(json).expect("a model").resolve(&lattice(1, 0.1), None).expect("it fits");
        assert_eq!(model.material(&lattice(1, 0.1)), Some(Material { young: 1e4, poisson: 0.3 }));
        let own = model.properties(&lattice(1, 0.1));
        assert!(own.damping > 0.0 && own.stiffness > 0.0);
        assert!(typed(serde_json::json!({ "kind": kind, "young": 1e4, "stiffness": 1.0 })).is_err());
        assert!(typed(serde_json::json!({ "kind": kind })).is_err());
    }
}
