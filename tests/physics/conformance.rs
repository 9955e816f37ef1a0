//! What any elastic model must do, whatever it is made of. A new model joins by one line in [`models`].

use crate::support::{Noise, body, forces, lattice, mass_spring, shape_based};
use glam::DVec3;
use localshape::sim::body::{Body, Dimension, IndexLists, State};
use localshape::sim::model::ElasticModel;
use localshape::sim::topology::Springs;
use std::sync::Arc;

const STIFFNESS: f64 = 1e4;

/// Every model, undamped, for a body.
fn models(body: &Body) -> Vec<Box<dyn ElasticModel>> {
    // Enough passes for round-off: the suite is about the model, not about the approximation of section 4.
    let shape = localshape::sim::model::shape_based::ShapeBased { passes: 8, ..shape_based(STIFFNESS, 0.0) };
    let mut all: Vec<Box<dyn ElasticModel>> = vec![Box::new(shape)];
    for named in [
        Springs::Edges,
        Springs::EdgesOneDiagonal,
        Springs::EdgesFaceDiagonals,
        Springs::EdgesBodyDiagonals,
        Springs::All,
    ] {
        let spring = mass_spring(body, STIFFNESS, 0.0, named);
        if !spring.springs.is_empty() {
            all.push(Box::new(spring));
        }
    }
    all
}

/// Bodies of every kind of element.
fn bodies() -> Vec<Arc<Body>> {
    let unit = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.1], [0.1, 1.0, 0.0], [0.0, 0.2, 1.0], [1.1, 0.9, 1.2], [2.0, 0.3, 0.9]];
    let flat = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.2, 0.9, 0.0], [0.4, 1.5, 0.0], [-0.3, 0.8, 0.0]];
    vec![
        lattice(1, 0.1),
        lattice(3, 0.1),
        body(Dimension::Space, &unit[..4], &[&[0, 1, 2, 3]]),
        body(Dimension::Space, &unit[..5], &[&[0, 1, 2, 3], &[1, 2, 3, 4]]),
        body(
            Dimension::Space,
            &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.4, 0.5, 1.0]],
            &[&[0, 1, 2, 3, 4]],
        ),
        body(
            Dimension::Space,
            &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.2]],
            &[&[0, 1, 2, 3, 4, 5]],
        ),
        // Seven nodes, whose hull has squares and triangles.
        body(
            Dimension::Space,
            &[
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [0.0, 0.0, 1.0],
                [1.0, 1.0, 0.0],
                [1.0, 0.0, 1.0],
                [0.0, 1.0, 1.0],
            ],
            &[&[0, 1, 2, 3, 4, 5, 6]],
        ),
        body(Dimension::Plane, &flat[..3], &[&[0, 1, 2]]),
        body(Dimension::Plane, &flat, &[&[0, 1, 2, 3, 4]]),
        body(Dimension::Plane, &flat, &[&[0, 1, 2], &[0, 2, 3], &[0, 3, 4]]),
    ]
}

/// A displacement that keeps a body in the plane there.
fn in_dimension(body: &Body, v: DVec3) -> DVec3 {
    match body.dimension {
        Dimension::Plane => v.with_z(0.0),
        Dimension::Space => v,
    }
}

fn deformed(body: &Body, amount: f64, seed: u64) -> State {
    let mut noise = Noise(seed);
    let scale = amount * body.extent();
    State::at_rest(body.rest.iter().map(|&rest| rest + in_dimension(body, noise.vector()) * scale).collect())
}

fn largest(forces: &[DVec3]) -> f64 {
    forces.iter().fold(0.0, |largest: f64, force| largest.max(force.length()))
}

fn each(check: impl Fn(&Arc<Body>, &dyn ElasticModel)) {
    for body in bodies() {
        for model in models(&body) {
            check(&body, model.as_ref());
        }
    }
}

#[test]
fn there_is_no_force_at_rest_nor_when_moved_rigidly() {
    each(|body, model| {
        let mut noise = Noise(11);
        for _ in 0..20 {
            let turn = match body.dimension {
                Dimension::Plane => glam::DQuat::from_rotation_z(3.0 * noise.next()),
                Dimension::Space => noise.rotation(),
            };
            let shift = in_dimension(body, noise.vector());
            let state = State::at_rest(body.rest.iter().map(|&rest| turn * rest + shift).collect());
            let force = largest(&forces(body, model, &state));
            assert!(force < 1e-14 * STIFFNESS * 10.0, "{model:?}: {force:e}");
        }
    });
}

#[test]
fn internal_forces_have_neither_resultant_nor_torque() {
    each(|body, model| {
        for seed in 0..10 {
            let state = deformed(body, 0.2, seed);
            let forces = forces(body, model, &state);
            let scale = largest(&forces) * body.len() as f64;
            let resultant: DVec3 = forces.iter().sum();
            let torque: DVec3 = state.position.iter().zip(&forces).map(|(p, f)| p.cross(*f)).sum();
            assert!(resultant.length() < 1e-14 * scale, "{model:?}: {resultant}");
            assert!(torque.length() < 1e-13 * scale, "{model:?}: {torque}");
        }
    });
}

#[test]
fn damping_has_neither_resultant_nor_work_that_is_gained() {
    for body in bodies() {
        for model in [
            Box::new(shape_based(STIFFNESS, 7.0)) as Box<dyn ElasticModel>,
            Box::new(mass_spring(&body, STIFFNESS, 7.0, Springs::Edges)),
        ] {
            let mut noise = Noise(5);
            let velocity: Vec<_> = body.rest.iter().map(|_| in_dimension(&body, noise.vector())).collect();
            let state = State { position: body.rest.clone(), velocity };
            let forces = forces(&body, model.as_ref(), &state);
            let resultant: DVec3 = forces.iter().sum();
            assert!(resultant.length() < 1e-11, "{model:?}: {resultant}");
            let power: f64 = forces.iter().zip(&state.velocity).map(|(f, v)| f.dot(*v)).sum();
            assert!(power < 0.0, "{model:?}: {power}");
        }
    }
}

#[test]
fn forces_push_back_towards_rest() {
    each(|body, model| {
        let state = deformed(body, 0.01, 3);
        let forces = forces(body, model, &state);
        let work: f64 =
            forces.iter().zip(state.position.iter().zip(&body.rest)).map(|(f, (now, rest))| f.dot(*rest - *now)).sum();
        assert!(work > 0.0, "{model:?}: {work}");
    });
}

#[test]
fn force_is_the_negative_gradient_of_energy() {
    each(|body, model| {
        let state = deformed(body, 0.15, 9);
        let worker = model.prepare(body, &state);
        let force = forces(body, model, &state);
        let energy = |state: &State| worker.measure(state).energy;
        if energy(&state).is_none() {
            return;
        }
        let h = 1e-6 * body.extent();
        for node in 0..body.len().min(9) {
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                if in_dimension(body, axis) == DVec3::ZERO {
                    continue;
                }
                let at = |offset: f64| {
                    let mut moved = state.clone();
                    moved.position[node] += axis * offset;
                    energy(&moved).expect("an energy at one state is an energy at every state")
                };
                let slope = (at(h) - at(-h)) / (2.0 * h);
                let error = (force[node].dot(axis) + slope).abs();
                assert!(error < 1e-7 * largest(&force), "{model:?} node {node}: {error:e} of {:e}", largest(&force));
            }
        }
    });
}

#[test]
fn the_order_of_nodes_and_elements_does_not_matter() {
    let body = lattice(2, 0.1);
    let count = body.len() as u32;
    // 10 has no factor in common with 27, so this is a permutation.
    let renamed = |node: u32| (node * 10 + 4) % count;
    let mut rest = vec![DVec3::ZERO; body.len()];
    for (node, &at) in (0u32..).zip(&body.rest) {
        rest[renamed(node) as usize] = at;
    }
    let mut elements = IndexLists::default();
    for nodes in body.elements.iter().collect::<Vec<_>>().into_iter().rev() {
        elements.push(&nodes.iter().map(|&node| renamed(node)).collect::<Vec<_>>());
    }
    let other = Arc::new(Body::new(Dimension::Space, rest, vec![1.0; body.len()], elements, None));
    let state = deformed(&body, 0.2, 1);
    let mut moved = State::at_rest(vec![DVec3::ZERO; body.len()]);
    for (node, &at) in (0u32..).zip(&state.position) {
        moved.position[renamed(node) as usize] = at;
    }
    for (a, b) in models(&body).iter().zip(models(&other)) {
        let first = forces(&body, a.as_ref(), &state);
        let second = forces(&other, b.as_ref(), &moved);
        for (node, force) in (0u32..).zip(&first) {
            let difference = (*force - second[renamed(node) as usize]).length();
            assert!(difference < 1e-12 * largest(&first), "{a:?}: {difference:e}");
        }
    }
}

/// A model that scenes can name but this suite does not know would be tested by nobody.
#[test]
fn every_model_of_the_scene_format_is_in_the_suite() {
    let schema = localshape::scene::schema();
    let variants = schema["properties"]["run"]["items"]["properties"]["model"]["oneOf"].as_array();
    let named: Vec<_> =
        variants.expect("models to choose from").iter().map(|model| &model["properties"]["kind"]["const"]).collect();
    assert_eq!(named, ["shape-based", "mass-spring"], "add the model to `models`, then here");
}
