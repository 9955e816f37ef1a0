//! Bodies whose elements are filled in part, with stiffness, damping and mass in proportion, or differ in stiffness.

use super::conformance::cases;
use super::support::{Noise, Remembering, floor, lattice, mass_spring, shape_based, stepped};
use glam::DVec3;
use localshape_sim::geometry::node_volumes;
use localshape_sim::model::limited_springs::LimitedSprings;
use localshape_sim::model::mass_spring::MassSpring;
use localshape_sim::model::shape_based::{RotationReading, ShapeBased};
use localshape_sim::model::volume_springs::VolumeSprings;
use localshape_sim::model::{ElasticModel, ModelParameters};
use localshape_sim::stability::{Restraint, Stability};
use localshape_sim::{
    Body, Crew, Dimension, IndexLists, Integrator, Kernel, Springs, State, Stepping, Surroundings, World,
};
use std::sync::Arc;

/// A block of cubes, with elements filled in part, of which each node has an equal share of the mass of 1 kg for each full one.
fn filled(cells: u32, fill: impl Fn(usize) -> f64) -> Arc<Body> {
    let full = lattice(cells, 0.1);
    let fill: Vec<f64> = (0..full.elements().len()).map(fill).collect();
    let mut mass = vec![0.0; full.len()];
    for (nodes, part) in full.elements().iter().zip(&fill) {
        nodes.iter().for_each(|&node| mass[node as usize] += 0.125 * part);
    }
    let body = Body::clone(&full).with_masses(mass).and_then(|body| body.with_fill(fill));
    Arc::new(body.expect("parts"))
}

/// Deformed and moving.
fn start(body: &Body) -> State {
    let mut noise = Noise(3);
    let position = body.rest().iter().map(|&rest| rest + noise.vector() * 0.005).collect();
    State::new(position, body.rest().iter().map(|_| noise.vector()).collect())
}

/// A body half filled, with half the mass, moves like the full one, with the same bits.
#[test]
fn a_body_that_is_half_filled_everywhere_moves_like_the_full_one() {
    let [full, half] = [1.0, 0.5].map(|part| filled(3, |_| part));
    assert_eq!(full.lightest(), half.lightest());
    let models = |kind: &str| -> Arc<dyn ElasticModel> {
        let json = serde_json::json!({ "kind": kind, "stiffness": 1e4, "damping_ratio": 0.1 });
        let parameters: ModelParameters = serde_json::from_value(json).expect("a model");
        let [a, b] = [&full, &half].map(|body| parameters.resolve(body, None).expect("it fits"));
        let of = |model: &dyn ElasticModel, body: &Arc<Body>| {
            let own = model.properties(body);
            (own.damping, own.shortest_period(body))
        };
        assert_eq!(of(&*a, &full), of(&*b, &half));
        a
    };
    let gravity = DVec3::new(0.3, -9.8, 0.0);
    let around = Surroundings { gravity, obstacles: vec![floor(0.5, 0.3)], ..Surroundings::default() };
    for model in ["shape-based", "mass-spring"].map(models) {
        for (kernel, integrator) in [
            (Kernel::Fast, Integrator::SemiImplicitEuler),
            (Kernel::Fast, Integrator::VelocityVerlet),
            (Kernel::Reference, Integrator::SemiImplicitEuler),
            (Kernel::Reference, Integrator::RungeKutta),
        ] {
            let [a, b] = [&full, &half].map(|body| {
                let stepping = Stepping { kernel, ..Stepping::new(integrator, 2e-4) };
                let mut world = World::new(body, start(body), &*model, around.clone(), stepping);
                world.advance(300);
                (world.state().clone(), world.diagnostics())
            });
            assert_eq!((&a.0.position, &a.0.velocity), (&b.0.position, &b.0.velocity), "{model:?} {kernel:?}");
            assert_eq!((a.1.elastic, a.1.momentum), (2.0 * b.1.elastic, 2.0 * b.1.momentum));
            assert!(a.1.elastic > 0.0);
            assert_eq!((a.1.residual.to_bits(), a.1.volume_ratio), (b.1.residual.to_bits(), b.1.volume_ratio));
        }
    }
}

/// A full body moves by other code where its parts are given, with the same result.
#[test]
fn elements_of_which_all_is_filled_are_full() {
    let given = filled(4, |_| 1.0);
    let full = Arc::new(Body::clone(&given).with_fill(None).expect("full elements"));
    for case in cases(&full, 7.0) {
        let [a, b] = [&given, &full].map(|body| {
            let mut world = stepped(body, start(body), &*case.model, Integrator::SemiImplicitEuler, 2e-4);
            world.advance(100);
            (world.state().position.clone(), world.diagnostics().elastic)
        });
        let far = a.0.iter().zip(&b.0).fold(0.0, |far: f64, (a, b)| far.max(a.distance(*b)));
        assert!(far < 1e-13 && (a.1 / b.1 - 1.0).abs() < 1e-11, "{:?}: {far:e} {} {}", case.model, a.1, b.1);
    }
}

/// Forces (N) and energy (J) of a model in a state.
fn evaluated(body: &Arc<Body>, model: &dyn ElasticModel, state: &State) -> (Vec<DVec3>, f64) {
    let of = Remembering::new(body, model, state);
    (of.evaluate(state).0, of.report(state).0.energy.expect("an energy"))
}

/// A body with one of its elements, all of which is filled.
fn alone(body: &Body, element: usize) -> Arc<Body> {
    let one = [&body.elements()[element]].into_iter().collect();
    let alone = Body::builder(body.rest().to_vec()).dimension(body.dimension()).elements(one);
    Arc::new(alone.masses(body.mass().to_vec()).build().expect("a body"))
}

/// Every model on a body that is filled in part, beside the sum of its elements, and of its springs, each alone and full. A spring has the mean
/// part of the elements that hold its nodes.
#[test]
fn every_model_is_in_proportion_to_what_is_filled() {
    let body = filled(3, |cell| [1.0, 0.35, 0.02, 0.8][cell % 4]);
    let (fill, state) = (body.fill().expect("parts"), start(&body));
    let full = Arc::new(Body::clone(&body).with_fill(None).expect("full elements"));
    type Sum = (Vec<DVec3>, f64);
    let add = |sum: &mut Sum, part: f64, (forces, energy): Sum| {
        sum.0.iter_mut().zip(forces).for_each(|(sum, force)| *sum += force * part);
        sum.1 += energy * part;
    };
    let none = || (vec![DVec3::ZERO; body.len()], 0.0);
    let of_elements = |model: &dyn ElasticModel| {
        (0..fill.len()).fold(none(), |mut sum, at| {
            add(&mut sum, fill[at], evaluated(&alone(&body, at), model, &state));
            sum
        })
    };
    let springs = mass_spring(&body, 1e4, 7.0, Springs::EdgesFaceDiagonals);
    let of_springs = |with: &dyn Fn(MassSpring) -> Box<dyn ElasticModel>| {
        springs.springs.iter().fold(none(), |mut sum, &ends| {
            let holds = |at: &usize| ends.iter().all(|end| body.elements()[*at].contains(end));
            let parts: Vec<_> = (0..fill.len()).filter(holds).map(|at| fill[at]).collect();
            let part = parts.iter().sum::<f64>() / parts.len() as f64;
            let one = with(MassSpring { springs: [ends].into(), ..springs.clone() });
            add(&mut sum, part, evaluated(&full, &*one, &state));
            sum
        })
    };
    let compare = |model: &dyn ElasticModel, expected: Sum| {
        let found = evaluated(&body, model, &state);
        let most = expected.0.iter().fold(0.0, |most: f64, force| most.max(force.length()));
        let far = found.0.iter().zip(&expected.0).fold(0.0, |far: f64, (a, b)| far.max(a.distance(*b)));
        assert!(far < 1e-11 * most, "{model:?}: {far:e} {most}");
        assert!((found.1 / expected.1 - 1.0).abs() < 1e-11, "{model:?}: {} {}", found.1, expected.1);
        let [fast, plain] = [Kernel::Fast, Kernel::Reference].map(|kernel| {
            let stepping = Stepping { kernel, ..Stepping::new(Integrator::SemiImplicitEuler, 2e-4) };
            let mut world = World::new(&body, state.clone(), model, Surroundings::default(), stepping);
            world.advance(20);
            world.state().position.clone()
        });
        let far = fast.iter().zip(&plain).fold(0.0, |far: f64, (a, b)| far.max(a.distance(*b)));
        assert!(far < 1e-12, "{model:?}: {far:e}");
    };
    for case in cases(&full, 7.0).iter().chain(&cases(&full, 0.0)) {
        // Models of springs follow.
        if case.model.springs().is_empty() && !format!("{:?}", case.model).starts_with("Rods") {
            compare(&*case.model, of_elements(&*case.model));
        }
    }
    let boxed: [&dyn Fn(MassSpring) -> Box<dyn ElasticModel>; 3] = [
        &|springs| Box::new(springs),
        &|springs| Box::new(MassSpring { breaks_at: Some(10.0), ..springs }),
        &|springs| Box::new(LimitedSprings { springs, limit: 0.5 }),
    ];
    for with in boxed {
        compare(&*with(springs.clone()), of_springs(with));
    }
    let bulk = 3e4;
    let mut both = of_springs(&|springs| Box::new(springs));
    let volumes = VolumeSprings { springs: MassSpring { springs: [].into(), ..springs.clone() }, bulk };
    add(&mut both, 1.0, of_elements(&volumes));
    compare(&VolumeSprings { springs, bulk }, both);
}

/// Each element twice, with parts that are together one, is one full element.
#[test]
fn parts_of_an_element_add_up() {
    let full = filled(2, |_| 1.0);
    let (mut elements, mut fill) = (IndexLists::default(), Vec::new());
    for (at, nodes) in full.elements().iter().enumerate() {
        let part = [0.3, 0.25, 0.9][at % 3];
        elements.push(nodes);
        elements.push(nodes);
        fill.extend([part, 1.0 - part]);
    }
    let twice = Body::builder(full.rest().to_vec()).dimension(full.dimension()).elements(elements).fill(fill);
    let twice = Arc::new(twice.masses(full.mass().to_vec()).build().expect("a body"));
    for kernel in [Kernel::Fast, Kernel::Reference] {
        let [a, b] = [&full, &twice].map(|body| {
            let stepping = Stepping { kernel, ..Stepping::new(Integrator::SemiImplicitEuler, 2e-4) };
            let mut world = World::new(body, start(body), &shape_based(1e4, 7.0), Surroundings::default(), stepping);
            world.advance(100);
            (world.state().position.clone(), world.diagnostics().elastic)
        });
        let far = a.0.iter().zip(&b.0).fold(0.0, |far: f64, (a, b)| far.max(a.distance(*b)));
        assert!(far < 1e-14 && (a.1 / b.1 - 1.0).abs() < 1e-11, "{kernel:?}: {far:e} {} {}", a.1, b.1);
    }
}

/// Blocks of which many cells are hardly filled: at random, in layers so that nodes have only such cells, and all but one.
fn slivers(part: f64) -> [Arc<Body>; 3] {
    let mut noise = Noise(8);
    let random: Vec<bool> = (0..64).map(|_| noise.next() < 0.0).collect();
    [
        filled(4, |cell| if random[cell] { part } else { 1.0 }),
        filled(4, |cell| if cell / 16 >= 2 { part } else { 1.0 }),
        filled(4, |cell| if cell == 21 { 1.0 } else { part }),
    ]
}

fn models(body: &Body) -> Vec<Box<dyn ElasticModel>> {
    // ζ = 0.1 for the corner of a full cube.
    let damping = 2.0 * 0.1 * (1e4_f64 * 0.125).sqrt();
    let mut models: Vec<Box<dyn ElasticModel>> = Vec::new();
    for damping in [0.0, damping] {
        let rotation = RotationReading::Robust;
        models.push(Box::new(ShapeBased { rotation, ..shape_based(1e4, damping) }));
        for named in [Springs::EdgesFaceDiagonals, Springs::All] {
            models.push(Box::new(mass_spring(body, 1e4, damping, named)));
        }
    }
    models
}

/// The predicted step of a body with slivers is at least that of one full cube, however little of a cell is filled.
#[test]
fn slivers_do_not_shorten_the_predicted_step() {
    let cube = filled(1, |_| 1.0);
    for part in [0.1, 1e-6, 1e-12] {
        for body in slivers(part) {
            for (model, of_cube) in models(&body).iter().zip(models(&cube)) {
                for integrator in [Integrator::SemiImplicitEuler, Integrator::VelocityVerlet, Integrator::RungeKutta] {
                    let limit =
                        |body, model: &dyn ElasticModel| Stability::of(body, model, integrator, Restraint::default());
                    let (found, least) = (limit(&body, &**model), limit(&cube, &*of_cube));
                    // Of the search for eigenvalues.
                    let error = 1e-3;
                    assert!(found.largest > least.largest * (1.0 - error), "{part} {model:?}: {found:?} {least:?}");
                    let [found, least] = [found, least].map(|limit| limit.stretched.unwrap_or(f64::INFINITY));
                    assert!(found >= least * (1.0 - error), "{part} {model:?}: {found:?} {least:?}");
                }
            }
            let full = filled(4, |_| 1.0);
            let shape = shape_based(1e4, 3.0);
            let certain =
                |body: &Body| Stability::certain(body, &shape, Integrator::VelocityVerlet, 0.0).expect("a bound");
            assert!(certain(&body) > certain(&full) * (1.0 - 1e-12));
        }
    }
}

/// Near the largest step of a full cube, bodies with slivers swing without gaining energy, and keep their momentum.
#[test]
fn slivers_do_not_shorten_the_real_step() {
    let cube = filled(1, |_| 1.0);
    for body in slivers(1e-6) {
        for (model, of_cube) in models(&body).iter().zip(models(&cube)) {
            let integrator = Integrator::SemiImplicitEuler;
            let limit = Stability::of(&cube, &*of_cube, integrator, Restraint::default());
            let step = 0.95 * limit.stretched.unwrap_or(limit.largest).min(limit.largest);
            let mut noise = Noise(4);
            // A small deformation: the limit is about the vicinity of rest.
            let position = body.rest().iter().map(|&rest| rest + noise.vector() * 1e-5).collect();
            let drift = DVec3::new(0.3, -0.2, 0.1);
            let velocity = vec![drift; body.len()];
            let mut world = stepped(&body, State::new(position, velocity), &**model, integrator, step);
            let before = world.diagnostics();
            world.advance(3000);
            let after = world.diagnostics();
            let text = format!("{model:?}");
            assert!(after.elastic < 20.0 * before.elastic, "{text}: {} {}", before.elastic, after.elastic);
            // Round-off of the force that a node has once for all its elements, in proportion to the distance from the origin.
            let time = 3000.0 * step;
            let impulse = 1e4 * drift.length() * time * time;
            let lost = (after.momentum - before.momentum).length();
            assert!(lost < 2e-14 * impulse, "{text}: {lost:e} {impulse:e}");
        }
    }
}

/// The damping of a ratio is that of the full body: it does not follow the lightest sliver.
#[test]
fn slivers_do_not_lessen_the_damping() {
    let full = filled(4, |_| 1.0);
    for body in slivers(1e-9) {
        assert!((body.lightest() / full.lightest() - 1.0).abs() < 1e-14, "{} {}", body.lightest(), full.lightest());
    }
}

#[test]
fn bodies_filled_in_part_have_the_same_bits_for_1_2_and_8_threads() {
    let body = filled(14, |cell| [1.0, 0.3, 0.01][cell % 3]);
    let shape = ShapeBased { rotation: RotationReading::Robust, ..shape_based(1e4, 3.0) };
    let spring = mass_spring(&body, 1e4, 3.0, Springs::EdgesFaceDiagonals);
    for model in [&shape as &dyn ElasticModel, &spring] {
        let ends = [1, 2, 8].map(|threads| {
            let mut world = stepped(&body, start(&body), model, Integrator::VelocityVerlet, 2e-4);
            world.set_crew(Crew::new(threads));
            world.advance(20);
            (world.state().clone(), world.diagnostics().elastic)
        });
        assert!(ends[0] == ends[1] && ends[0] == ends[2], "{model:?}");
    }
}

/// A block of full cubes with elements of this relative stiffness.
fn stiffened(cells: u32, stiffness: impl Fn(usize) -> f64) -> Arc<Body> {
    let full = filled(cells, |_| 1.0);
    let stiffness = (0..full.elements().len()).map(stiffness).collect();
    let full = Body::clone(&full).with_fill(None).expect("full elements");
    Arc::new(full.with_stiffness(Some(stiffness)).expect("parts"))
}

/// Elements of twice the stiffness move like those of a model of twice the stiffness and the damping, with the same bits, and have
/// the same steps.
#[test]
fn relative_stiffness_multiplies_that_of_the_model() {
    let [one, two] = [1.0, 2.0].map(|stiffness| stiffened(3, |_| stiffness));
    let models = |stiffness: f64, damping: f64| -> [Box<dyn ElasticModel>; 2] {
        let springs = mass_spring(&one, stiffness, damping, Springs::EdgesFaceDiagonals);
        [Box::new(shape_based(stiffness, damping)), Box::new(springs)]
    };
    for (stiff, soft) in models(2e4, 14.0).iter().zip(models(1e4, 7.0)) {
        let pairs = [(&one, &**stiff), (&two, &*soft)];
        for kernel in [Kernel::Fast, Kernel::Reference] {
            let [a, b] = pairs.map(|(body, model)| {
                let stepping = Stepping { kernel, ..Stepping::new(Integrator::SemiImplicitEuler, 2e-4) };
                let mut world = World::new(body, start(body), model, Surroundings::default(), stepping);
                world.advance(200);
                (world.state().clone(), world.diagnostics().elastic)
            });
            assert!(a.1 > 0.0);
            assert!(a == b, "{soft:?} {kernel:?}: {} {}", a.1, b.1);
        }
        for integrator in [Integrator::SemiImplicitEuler, Integrator::VelocityVerlet, Integrator::RungeKutta] {
            let [a, b] = pairs.map(|(body, model)| {
                let Stability { largest, stretched, .. } = Stability::of(body, model, integrator, Restraint::default());
                [largest, stretched.unwrap_or(largest), Stability::certain(body, model, integrator, 0.0).unwrap_or(0.0)]
            });
            a.iter().zip(&b).for_each(|(a, b)| assert!((a - b).abs() <= 1e-12 * a, "{soft:?} {integrator:?}: {a} {b}"));
        }
    }
}

/// The predicted step of a body is at least that of its stiffest element alone, and at least the certain one, and in that step the
/// body swings without gaining energy.
#[test]
fn the_stiffest_element_bounds_the_step() {
    let most = 4.0;
    let cube = stiffened(1, |_| most);
    let mut noise = Noise(8);
    let random: Vec<f64> = (0..64).map(|_| if noise.next() < 0.0 { 0.01 } else { most }).collect();
    for body in [
        stiffened(4, |cell| random[cell]),
        stiffened(4, |cell| if cell == 21 { most } else { 0.1 }),
        stiffened(4, |cell| if cell / 16 >= 2 { 1.0 } else { most }),
    ] {
        for (model, of_cube) in models(&body).iter().zip(models(&cube)) {
            let integrator = Integrator::SemiImplicitEuler;
            let limit = |body, model: &dyn ElasticModel| Stability::of(body, model, integrator, Restraint::default());
            let (found, least) = (limit(&body, &**model), limit(&cube, &*of_cube));
            assert!(found.largest > least.largest * (1.0 - 1e-3), "{model:?}: {found:?} {least:?}");
            let certain = Stability::certain(&body, &**model, integrator, 0.0).unwrap_or(0.0);
            assert!(certain <= found.largest * (1.0 + 1e-3), "{model:?}: {found:?} {certain}");
            let step = 0.95 * found.stretched.unwrap_or(found.largest).min(found.largest);
            let mut noise = Noise(4);
            let position = body.rest().iter().map(|&rest| rest + noise.vector() * 1e-5).collect();
            let at_rest = vec![DVec3::ZERO; body.len()];
            let mut world = stepped(&body, State::new(position, at_rest), &**model, integrator, step);
            let before = world.diagnostics();
            world.advance(3000);
            let after = world.diagnostics();
            assert!(after.elastic < 20.0 * before.elastic, "{model:?}: {} {}", before.elastic, after.elastic);
        }
    }
}

#[test]
fn what_is_filled_of_an_element_is_shared_by_its_nodes() {
    let rest = (0..6).map(|at| DVec3::new(f64::from(at / 2), f64::from(at % 2), 0.0)).collect();
    let elements = [&[0, 2, 3, 1][..], &[2, 4, 5, 3]].into_iter().collect();
    let body = Body::builder(rest).dimension(Dimension::Plane).elements(elements).fill(vec![0.5, 1.0 / 256.0]);
    let body = body.build().expect("a body");
    assert_eq!(node_volumes(&body), [128.0, 128.0, 129.0, 129.0, 1.0, 1.0].map(|share| share / 1024.0));
}
