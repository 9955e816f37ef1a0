//! The suite that every elastic model must pass, on elements of every kind. A new model or reading is added by one line
//! in [`cases`].

use super::example_model::Rods;
use super::support::{Noise, Remembering, body, forces, lattice, mass_spring, shape_based};
use glam::DVec3;
use localshape_sim::geometry::volumes_at_rest;
#[cfg(feature = "scene")]
use localshape_sim::model::ModelParameters;
use localshape_sim::model::limited_springs::LimitedSprings;
use localshape_sim::model::mass_spring::MassSpring;
use localshape_sim::model::metric::Metric;
use localshape_sim::model::shape_based::{DampingReading, RotationReading, ShapeBased};
use localshape_sim::model::volume_springs::VolumeSprings;
use localshape_sim::model::xpbd::Xpbd;
use localshape_sim::model::{ElasticModel, corotational, linear, neo_hookean};
use localshape_sim::{
    Body, Dimension, ElementKind, IndexLists, Integrator, Kernel, Material, Solids, Springs, State, Stepping,
    Surroundings, World,
};
use std::sync::Arc;

pub(crate) const STIFFNESS: f64 = 1e4;

/// A model, and which properties it does not have.
pub(crate) struct Case {
    pub(crate) model: Arc<dyn ElasticModel>,
    /// Whether its forces are the gradient of its energy. Those of Eq. (16) as printed are not: its matrix is not a
    /// rotation, so rotating it costs energy.
    pub(crate) has_potential: bool,
    /// Whether a body that is rotated during a simulation is free of forces again. With Eq. (16) it has grown.
    forgets_turns: bool,
    /// Whether rotation causes no forces, and forces no torque. Linear elements take rotation for strain.
    is_objective: bool,
}

/// All models and readings, for a body.
pub(crate) fn cases(body: &Body, damping: f64) -> Vec<Case> {
    of_stiffness(STIFFNESS, body, damping)
}

/// The same with an elastic constant (N/m); moduli are in proportion to it.
pub(crate) fn of_stiffness(k: f64, body: &Body, damping: f64) -> Vec<Case> {
    let sound =
        |model: Arc<dyn ElasticModel>| Case { model, has_potential: true, forgets_turns: true, is_objective: true };
    // Enough passes for round-off: the suite tests the model, not the approximation of section 4.
    let shape = ShapeBased { passes: 8, ..shape_based(k, damping) };
    let mut all = vec![sound(Arc::new(shape.clone()))];
    if damping > 0.0 {
        all.push(sound(Arc::new(ShapeBased { damping_of: DampingReading::Deformation, ..shape.clone() })));
    }
    let exact = ShapeBased { rotation: RotationReading::Robust, ..shape.clone() };
    let mut options = vec![ShapeBased { bending: 1.0 / 3.0, ..exact.clone() }];
    // Nothing breaks.
    options.push(ShapeBased { breaks_at: Some(10.0), ..exact.clone() });
    if volumes_at_rest(body).iter().all(|&volume| volume > 0.0) {
        let of_material = |young, poisson| {
            let material = Material { young, poisson };
            let stiffness = material.stiffness(body).into_iter().fold(0.0, f64::max);
            ShapeBased { stiffness, material: Some(material), ..exact.clone() }
        };
        options.push(of_material(2.0 * k, 0.0));
        options.push(of_material(k, 0.4));
        options.push(ShapeBased { bending: 0.25, damping_of: DampingReading::Deformation, ..of_material(k, 0.3) });
    }
    all.extend(options.into_iter().map(|option| sound(Arc::new(option))));
    // In the plane Eq. (9) is exact, and there are no readings.
    if body.dimension() == Dimension::Space {
        all.push(sound(Arc::new(ShapeBased { rotation: RotationReading::VectorLength, passes: 12, ..shape.clone() })));
        all.push(sound(Arc::new(ShapeBased { rotation: RotationReading::Robust, ..shape.clone() })));
        let linear = ShapeBased { rotation: RotationReading::LinearUpdate, ..shape };
        let model = Arc::new(linear);
        all.push(Case { model, has_potential: false, forgets_turns: false, is_objective: true });
    }
    for named in [
        Springs::Edges,
        Springs::EdgesOneDiagonal,
        Springs::EdgesFaceDiagonals,
        Springs::EdgesBodyDiagonals,
        Springs::All,
    ] {
        let spring = mass_spring(body, k, damping, named);
        assert!(!spring.springs.is_empty(), "{named:?} on {:?}", body.kinds());
        all.push(sound(Arc::new(spring)));
    }
    let springs = mass_spring(body, k, damping, Springs::EdgesFaceDiagonals);
    all.push(sound(Arc::new(MassSpring { breaks_at: Some(10.0), ..springs.clone() })));
    all.extend([0.3, 1.0].map(|limit| sound(Arc::new(LimitedSprings { springs: springs.clone(), limit }))));
    if volumes_at_rest(body).iter().any(|&volume| volume > 0.0) {
        all.push(sound(Arc::new(VolumeSprings { springs, bulk: 3.0 * k })));
    }
    // A metric is measured along the edges of cells.
    for poisson in [0.0, 0.3] {
        let material = Material { young: k, poisson };
        all.extend(Metric::new(body, material, damping).ok().map(|metric| sound(Arc::new(metric))));
    }
    if damping == 0.0 {
        all.push(sound(Arc::new(Xpbd::new(ShapeBased { bending: 0.5, ..exact.clone() }))));
        all.push(sound(Arc::new(Rods { stiffness: k })));
    }
    if is_continuum(body) {
        for poisson in [0.0, 0.4] {
            let material = Material { young: k, poisson };
            let made: [fn(&Body, Material, f64) -> _; 3] = [linear::model, corotational::model, neo_hookean::model];
            let [linear, others @ ..] = made.map(|make| make(body, material, damping).expect("elements that it takes"));
            all.push(Case { model: linear, has_potential: true, forgets_turns: false, is_objective: false });
            all.extend(others.map(sound));
        }
    }
    all
}

/// A model with twice the stiffness and three times the damping.
#[test]
fn scaled_models_have_scaled_forces_and_energies() {
    for body in bodies() {
        let flat = |v: DVec3| if body.dimension() == Dimension::Plane { v.with_z(0.0) } else { v };
        let mut noise = Noise(11);
        let position: Vec<_> = body.rest().iter().map(|&rest| rest + flat(noise.vector()) * 0.05).collect();
        let (still, velocity) = (State::at_rest(position.clone()), position.iter().map(|_| flat(noise.vector())));
        let moving = State::new(position.clone(), velocity.collect());
        let scaled = |damping| of_stiffness(2.0 * STIFFNESS, &body, 3.0 * damping);
        let pairs = [7.0, 0.0].into_iter().flat_map(|damping| cases(&body, damping).into_iter().zip(scaled(damping)));
        for (case, Case { model: scaled, .. }) in pairs {
            let [one, other] = [&*case.model, &*scaled].map(|model| {
                let of = Remembering::new(&body, model, &still);
                let ((elastic, _), (all, _)) = (of.evaluate(&still), of.evaluate(&moving));
                (elastic, all, of.report(&still).0.energy.expect("an energy"))
            });
            let most = one.0.iter().chain(&one.1).fold(0.0, |most: f64, force| most.max(force.length()));
            for node in 0..body.len() {
                let elastic = other.0[node] - one.0[node] * 2.0;
                let damping = (other.1[node] - other.0[node]) - (one.1[node] - one.0[node]) * 3.0;
                assert!(
                    elastic.length() < 1e-12 * most && damping.length() < 1e-12 * most,
                    "{scaled:?}: {elastic} {damping}"
                );
            }
            assert!((other.2 / one.2 - 2.0).abs() < 1e-12, "{scaled:?}: {} {}", other.2, one.2);
        }
    }
}

/// Whether finite elements take all elements of a body.
fn is_continuum(body: &Body) -> bool {
    let is_taken = |(kind, nodes): (&ElementKind, &[u32])| match kind {
        ElementKind::Tetrahedron | ElementKind::Hexahedron => true,
        ElementKind::Polygon => nodes.len() <= 4,
        _ => false,
    };
    body.kinds().iter().zip(body.elements().iter()).all(is_taken)
        && volumes_at_rest(body).iter().all(|&volume| volume > 0.0)
}

/// Bodies of every kind of element.
pub(crate) fn bodies() -> Vec<Arc<Body>> {
    let unit = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.1],
        [0.1, 1.0, 0.0],
        [0.0, 0.2, 1.0],
        [1.1, 0.9, 1.2],
        [2.0, 0.3, 0.9],
        [0.9, 1.4, 0.2],
    ];
    let flat = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.2, 0.9, 0.0], [0.4, 1.5, 0.0], [-0.3, 0.8, 0.0]];
    let pyramid = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.4, 0.5, 1.0]];
    let wedge = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.2]];
    // A cube, a wedge on it, a pyramid beside it and a bar from its corner.
    let mixed = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [0.0, 1.0, 1.0],
        [1.0, 1.0, 1.0],
        [0.0, 1.6, 0.5],
        [1.0, 1.7, 0.5],
        [1.8, 0.5, 0.5],
        [-0.7, -0.2, 0.1],
    ];
    // An irregular hexahedron and a tetrahedron on its side.
    let block = [
        [0.0, 0.0, 0.0],
        [1.0, 0.1, 0.0],
        [0.1, 1.2, -0.1],
        [1.1, 1.0, 0.2],
        [0.0, 0.1, 0.9],
        [1.2, 0.0, 1.0],
        [-0.1, 1.0, 1.1],
        [1.0, 1.1, 1.3],
        [1.9, 0.5, 0.5],
    ];
    let mut bodies = vec![
        lattice(1, 0.1),
        lattice(3, 0.1),
        body(Dimension::Space, &unit[..2], &[&[0, 1]]),
        body(Dimension::Space, &unit[..4], &[&[0, 1, 2], &[1, 2, 3]]),
        body(Dimension::Space, &unit[..4], &[&[0, 1, 2, 3]]),
        body(Dimension::Space, &unit[..5], &[&[0, 1, 2, 3], &[1, 2, 3, 4]]),
        body(Dimension::Space, &pyramid, &[&[0, 1, 2, 3, 4]]),
        body(Dimension::Space, &wedge, &[&[0, 1, 2, 3, 4, 5]]),
        body(Dimension::Space, &unit, &[&[0, 1, 2, 3, 4, 5, 6]]),
        // Seven nodes, whose hull has squares and triangles.
        body(Dimension::Space, &mixed[..7], &[&[0, 1, 2, 3, 4, 5, 6]]),
        octahedron(),
        body(Dimension::Space, &block, &[&[0, 1, 2, 3, 4, 5, 6, 7], &[1, 5, 3, 8]]),
        body(Dimension::Space, &mixed, &[&[0, 1, 2, 3, 4, 5, 6, 7], &[2, 8, 6, 3, 9, 7], &[1, 3, 7, 5, 10], &[0, 11]]),
        body(Dimension::Plane, &flat[..2], &[&[0, 1]]),
        body(Dimension::Plane, &flat[..3], &[&[0, 1, 2]]),
        body(Dimension::Plane, &flat[..4], &[&[0, 1, 2, 3]]),
        body(Dimension::Plane, &flat, &[&[0, 1, 2, 3, 4]]),
        body(Dimension::Plane, &flat, &[&[0, 1, 2], &[0, 2, 3, 4]]),
    ];
    // The same with different masses: the balance of forces must not depend on them.
    let unequal = bodies.iter().map(|body| {
        let mass = (1..=body.len()).map(|node| 0.3 + (node % 5) as f64).collect();
        Arc::new(Body::clone(body).with_masses(mass).expect("masses"))
    });
    let unequal: Vec<_> = unequal.collect();
    // And filled in part.
    let filled = bodies.iter().map(|body| {
        let fill: Vec<_> = (0..body.elements().len()).map(|element| [0.4, 1.0, 0.7][element % 3]).collect();
        Arc::new(Body::clone(body).with_fill(fill).expect("parts"))
    });
    let filled: Vec<_> = filled.collect();
    // And with elements that differ in stiffness, filled in part or not.
    let stiffened = bodies.iter().zip(&filled).enumerate().map(|(at, (full, filled))| {
        let body = if at % 2 == 0 { full } else { filled };
        let stiffness: Vec<_> = (0..body.elements().len()).map(|element| [0.6, 1.7, 1.0][element % 3]).collect();
        Arc::new(Body::clone(body).with_stiffness(stiffness).expect("parts"))
    });
    let stiffened: Vec<_> = stiffened.collect();
    bodies.extend(unequal);
    bodies.extend(filled);
    bodies.extend(stiffened);
    bodies
}

/// Six nodes that do not form a wedge, in any order.
fn octahedron() -> Arc<Body> {
    let corners = [DVec3::X, -DVec3::Y, DVec3::Z, -DVec3::X, DVec3::Y, -DVec3::Z];
    let elements = [&[0, 1, 2, 3, 4, 5][..]].into_iter().collect();
    let body = Body::builder(corners.to_vec()).elements(elements).solids(Solids::Convex).build().expect("a body");
    assert_eq!(body.topology().edges_of(0).len(), 12);
    Arc::new(body)
}

/// A displacement that keeps a plane body in its plane.
fn in_dimension(body: &Body, v: DVec3) -> DVec3 {
    match body.dimension() {
        Dimension::Plane => v.with_z(0.0),
        Dimension::Space => v,
    }
}

fn deformed(body: &Body, amount: f64, seed: u64) -> State {
    let mut noise = Noise(seed);
    let scale = amount * body.extent();
    State::at_rest(body.rest().iter().map(|&rest| rest + in_dimension(body, noise.vector()) * scale).collect())
}

fn largest(forces: &[DVec3]) -> f64 {
    forces.iter().fold(0.0, |largest: f64, force| largest.max(force.length()))
}

fn each(check: impl Fn(&Arc<Body>, &Case)) {
    for body in bodies() {
        for case in cases(&body, 0.0) {
            check(&body, &case);
        }
    }
}

#[test]
fn there_is_no_force_at_rest_nor_when_moved_rigidly() {
    each(|body, Case { model, is_objective, .. }| {
        let model = model.as_ref();
        let mut noise = Noise(11);
        for _ in 0..20 {
            let turn = match body.dimension() {
                _ if !is_objective => glam::DQuat::IDENTITY,
                Dimension::Plane => glam::DQuat::from_rotation_z(3.0 * noise.next()),
                Dimension::Space => noise.rotation(),
            };
            let shift = in_dimension(body, noise.vector());
            let state = State::at_rest(body.rest().iter().map(|&rest| turn * rest + shift).collect());
            let force = largest(&forces(body, model, &state));
            assert!(force < 1e-14 * STIFFNESS * 10.0, "{model:?}: {force:e}");
        }
    });
}

#[test]
fn internal_forces_have_neither_resultant_nor_torque() {
    each(|body, Case { model, is_objective, .. }| {
        let model = model.as_ref();
        for seed in 0..10 {
            let state = deformed(body, 0.2, seed);
            let forces = forces(body, model, &state);
            let scale = largest(&forces) * body.len() as f64;
            let resultant: DVec3 = forces.iter().sum();
            let torque: DVec3 = state.position.iter().zip(&forces).map(|(p, f)| p.cross(*f)).sum();
            assert!(resultant.length() < 1e-14 * scale, "{model:?}: {resultant}");
            assert!(torque.length() < 1e-13 * scale || !is_objective, "{model:?}: {torque}");
        }
    });
}

#[test]
fn damping_has_neither_resultant_nor_work_that_is_gained() {
    for body in bodies() {
        for Case { model, .. } in cases(&body, 7.0) {
            let mut noise = Noise(5);
            let velocity: Vec<_> = body.rest().iter().map(|_| in_dimension(&body, noise.vector())).collect();
            let state = State::new(body.rest().to_vec(), velocity);
            let forces = forces(&body, model.as_ref(), &state);
            let resultant: DVec3 = forces.iter().sum();
            assert!(resultant.length() < 1e-10, "{model:?}: {resultant}");
            let power: f64 = forces.iter().zip(&state.velocity).map(|(f, v)| f.dot(*v)).sum();
            assert!(power < 0.0, "{model:?}: {power}");
        }
    }
}

/// Except for damping as printed, rigid rotation causes no damping torque.
#[test]
fn damping_of_deformation_and_of_springs_leaves_rigid_motion_alone() {
    for body in bodies() {
        for Case { model, .. } in cases(&body, 7.0) {
            if format!("{model:?}").contains("RelativeMotion") {
                continue;
            }
            let spin = if body.dimension() == Dimension::Plane { DVec3::Z } else { DVec3::new(0.3, -1.0, 0.8) };
            let velocity = body.rest().iter().map(|&rest| spin.cross(rest) + in_dimension(&body, DVec3::ONE)).collect();
            let state = State::new(body.rest().to_vec(), velocity);
            let largest = largest(&forces(&body, model.as_ref(), &state));
            assert!(largest < 1e-10, "{model:?} {:?}: {largest:e}", body.kinds());
        }
    }
}

/// A body that is rotated during a simulation, a little with each evaluation, has no forces at the end.
#[test]
fn rotations_are_followed_all_the_way_round() {
    each(|body, Case { model, forgets_turns, .. }| {
        let mut worker = Remembering::new(body, model.as_ref(), &State::at_rest(body.rest().to_vec()));
        let axis = if body.dimension() == Dimension::Plane { DVec3::Z } else { DVec3::new(2.0, -1.0, 2.0) / 3.0 };
        let mut last = vec![];
        for step in 1..=200 {
            let turn = glam::DQuat::from_axis_angle(axis, 0.04 * f64::from(step));
            last = worker.follow(&State::at_rest(body.rest().iter().map(|&rest| turn * rest).collect()));
        }
        let force = largest(&last);
        match forgets_turns {
            true => assert!(force < 1e-13 * STIFFNESS * 10.0, "{model:?}: {force:e}"),
            // About 17 % of everything perpendicular to the axis.
            false => assert!(body.len() < 3 || force > 1e-3 * STIFFNESS * body.extent(), "{model:?}: {force:e}"),
        }
    });
}

#[test]
fn the_energy_of_the_nodes_is_that_of_the_body() {
    each(|body, Case { model, .. }| {
        let state = deformed(body, 0.2, 4);
        let (report, shares) = Remembering::new(body, model.as_ref(), &state).report(&state);
        let whole = report.energy.expect("an energy");
        assert!(shares.iter().all(|&share| share >= 0.0));
        assert!((shares.iter().sum::<f64>() - whole).abs() < 1e-12 * whole, "{model:?}");
    });
}

/// The same nodes and the same memory give the same forces and the same next memory, bit for bit, whatever was
/// evaluated in between; and the whole next memory is written.
#[test]
fn evaluations_leave_nothing_behind() {
    for body in bodies() {
        for Case { model, .. } in cases(&body, 7.0) {
            let start = State::at_rest(body.rest().to_vec());
            let model = Remembering::new(&body, model.as_ref(), &start);
            let (state, other) = (deformed(&body, 0.1, 3), deformed(&body, 0.3, 4));
            let first = model.evaluate(&state);
            assert!(first.1.iter().all(|number| number.is_finite()));
            model.evaluate(&other);
            model.report(&other);
            assert_eq!(model.evaluate(&state), first);
        }
    }
}

/// `is_damped` must be right, as integrators evaluate forces only once for a model without damping.
#[test]
fn forces_depend_on_velocities_if_and_only_if_the_model_says_so() {
    for body in bodies() {
        for (damping, Case { model, .. }) in [0.0, 7.0]
            .into_iter()
            .flat_map(|damping| cases(&body, damping).into_iter().map(move |case| (damping, case)))
        {
            let mut noise = Noise(31);
            let rest = deformed(&body, 0.05, 8);
            let velocity = body.rest().iter().map(|_| in_dimension(&body, noise.vector())).collect();
            let moving = State { velocity, ..rest.clone() };
            let depends = forces(&body, model.as_ref(), &rest) != forces(&body, model.as_ref(), &moving);
            assert_eq!(depends, damping > 0.0, "{model:?}");
            assert_eq!(model.prepare(&body).is_damped(), depends, "{model:?}");
        }
    }
}

/// The forces on a node are summed in the order of the elements or springs, bit for bit: so states do not depend on the
/// number of threads, and goldens do not change between versions that keep this order.
#[test]
fn a_node_sums_its_forces_in_the_order_of_the_elements() {
    let whole = lattice(2, 0.1);
    let mut noise = Noise(21);
    let position = whole.rest().iter().map(|&rest| rest + noise.vector() * 0.02).collect();
    let state = State::new(position, whole.rest().iter().map(|_| noise.vector()).collect());
    let shape = shape_based(STIFFNESS, 7.0);
    let spring = mass_spring(&whole, STIFFNESS, 7.0, Springs::EdgesOneDiagonal);
    let elements: Vec<Vec<u32>> = whole.elements().iter().map(<[u32]>::to_vec).collect();
    let springs: Vec<Vec<u32>> = spring.springs.iter().map(|ends| ends.to_vec()).collect();
    let pair = MassSpring { springs: [[0, 1]].into(), ..spring.clone() };
    for (model, parts, alone) in
        [(&shape as &dyn ElasticModel, elements, &shape as &dyn ElasticModel), (&spring, springs, &pair)]
    {
        let mut expected = vec![DVec3::ZERO; whole.len()];
        for nodes in &parts {
            let of = |all: &[DVec3]| -> Vec<DVec3> { nodes.iter().map(|&node| all[node as usize]).collect() };
            let own: IndexLists = [(0..nodes.len() as u32).collect::<Vec<_>>().as_slice()].into_iter().collect();
            let mass = vec![1.0; nodes.len()];
            let part = Body::builder(of(whole.rest())).elements(own).masses(mass).build().expect("a body");
            let now = State::new(of(&state.position), of(&state.velocity));
            for (&node, force) in nodes.iter().zip(forces(&Arc::new(part), alone, &now)) {
                expected[node as usize] += force;
            }
        }
        assert!(forces(&whole, model, &state) == expected, "{model:?}");
    }
}

/// With all its nodes at one point an element keeps its last rotation.
#[test]
fn an_element_at_a_point_keeps_its_rotation() {
    for body in bodies().into_iter().filter(|body| body.elements().len() == 1) {
        let turn = match body.dimension() {
            Dimension::Plane => glam::DQuat::from_rotation_z(0.7),
            Dimension::Space => glam::DQuat::from_rotation_y(0.7) * glam::DQuat::from_rotation_x(-0.4),
        };
        let turned: Vec<_> = body.rest().iter().map(|&rest| turn * rest).collect();
        let centre = turned.iter().sum::<DVec3>() / turned.len() as f64;
        let mut worker = Remembering::new(&body, &shape_based(STIFFNESS, 0.0), &State::at_rest(turned.clone()));
        for _ in 0..3 {
            let forces = worker.follow(&State::at_rest(vec![DVec3::ONE; body.len()]));
            for (force, corner) in forces.iter().zip(&turned) {
                let [part, relative] =
                    [&body.fill(), &body.stiffness()].map(|given| given.as_ref().map_or(1.0, |given| given[0]));
                let off = *force - (*corner - centre) * (part * relative * STIFFNESS);
                assert!(off.length() < 1e-11 * STIFFNESS, "{:?}: {off}", body.kinds());
            }
        }
    }
}

#[test]
fn forces_push_back_towards_rest() {
    each(|body, Case { model, .. }| {
        let model = model.as_ref();
        let state = deformed(body, 0.01, 3);
        let forces = forces(body, model, &state);
        let work: f64 =
            forces.iter().zip(state.position.iter().zip(body.rest())).map(|(f, (now, rest))| f.dot(*rest - *now)).sum();
        assert!(work > 0.0, "{model:?}: {work}");
    });
}

#[test]
fn force_is_the_negative_gradient_of_energy() {
    each(|body, Case { model, has_potential, .. }| {
        if !has_potential {
            return;
        }
        let model = model.as_ref();
        let state = deformed(body, 0.15, 9);
        let worker = Remembering::new(body, model, &state);
        let force = forces(body, model, &state);
        let energy = |state: &State| worker.report(state).0.energy;
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

/// Vectorised steps and energies are those of the forces, up to round-off.
#[test]
fn vectorised_steps_follow_the_forces() {
    for body in bodies() {
        for Case { model, .. } in [0.0, 7.0].into_iter().flat_map(|damping| cases(&body, damping)) {
            if model.vectorised().is_none() {
                continue;
            }
            let start = deformed(&body, 0.05, 2);
            let [fast, plain] = [Kernel::Fast, Kernel::Reference].map(|kernel| {
                let stepping = Stepping { kernel, ..Stepping::new(Integrator::VelocityVerlet, 1e-4) };
                let mut world = World::new(&body, start.clone(), model.as_ref(), Surroundings::default(), stepping);
                world.advance(20);
                (world.state().position.clone(), world.diagnostics().elastic)
            });
            let far = fast.0.iter().zip(&plain.0).fold(0.0, |far: f64, (a, b)| far.max(a.distance(*b)));
            assert!(far <= 1e-13 * body.extent(), "{model:?} on {:?}: {far:e}", body.kinds());
            assert!((fast.1 - plain.1).abs() <= 1e-9 * plain.1, "{model:?} on {:?}: {fast:?} {plain:?}", body.kinds());
        }
    }
}

#[test]
fn the_order_of_nodes_and_elements_does_not_matter() {
    for body in bodies() {
        let count = body.len() as u32;
        // A stride without a common factor gives a permutation.
        let step = [7, 5, 3, 1].into_iter().find(|step| !count.is_multiple_of(*step) || *step == 1).unwrap_or(1);
        let renamed = |node: u32| (node * step + 1) % count;
        let mut rest = vec![DVec3::ZERO; body.len()];
        let mut mass = vec![0.0; body.len()];
        for (node, (&at, &own)) in (0u32..).zip(body.rest().iter().zip(body.mass())) {
            rest[renamed(node) as usize] = at;
            mass[renamed(node) as usize] = own;
        }
        let mut elements = IndexLists::default();
        for nodes in body.elements().iter().collect::<Vec<_>>().into_iter().rev() {
            elements.push(&nodes.iter().map(|&node| renamed(node)).collect::<Vec<_>>());
        }
        let solids = if body.kinds() == [ElementKind::Other] { Solids::Convex } else { Solids::Ordered };
        let reversed = |given: Option<&[f64]>| given.map(|given| given.iter().rev().copied().collect::<Vec<_>>());
        let [fill, stiffness] = [body.fill(), body.stiffness()].map(reversed);
        let other = Body::builder(rest).dimension(body.dimension()).elements(elements).solids(solids).masses(mass);
        let other = Arc::new(other.fill(fill).stiffness(stiffness).build().expect("a body"));
        let state = deformed(&body, 0.2, 1);
        let mut moved = State::at_rest(vec![DVec3::ZERO; body.len()]);
        for (node, &at) in (0u32..).zip(&state.position) {
            moved.position[renamed(node) as usize] = at;
        }
        for (a, b) in cases(&body, 0.0).iter().zip(cases(&other, 0.0)) {
            let (a, b) = (&a.model, &b.model);
            let first = forces(&body, a.as_ref(), &state);
            let second = forces(&other, b.as_ref(), &moved);
            for (node, force) in (0u32..).zip(&first) {
                let difference = (*force - second[renamed(node) as usize]).length();
                assert!(difference < 1e-12 * largest(&first), "{a:?} on {:?}: {difference:e}", body.kinds());
            }
        }
    }
}

/// What a model says of itself makes it again.
#[cfg(feature = "scene")]
#[test]
fn the_properties_of_a_model_make_the_same_model() {
    for body in bodies() {
        for case in cases(&body, 7.0).iter().chain(&cases(&body, 0.0)) {
            let properties = case.model.properties(&body);
            let Some(parameters) = ModelParameters::of(&properties) else {
                assert_eq!(properties.kind, "rods", "{properties:?}");
                continue;
            };
            let springs = Some(case.model.springs()).filter(|springs| !springs.is_empty());
            let again = parameters.resolve(&body, springs).expect("a model of this body");
            assert_eq!(again.properties(&body), properties);
            let scaled = ModelParameters::of(&properties.clone().scaled(2.0, 3.0)).expect("a model of this kind");
            let scaled = scaled.resolve(&body, springs).expect("a model of this body").properties(&body);
            assert_eq!((scaled.stiffness, scaled.damping), (2.0 * properties.stiffness, 3.0 * properties.damping));
        }
    }
}

/// The names of the choices of a type, or of the property of one of its variants.
#[cfg(feature = "scene")]
fn names(schema: &serde_json::Value) -> Vec<String> {
    let text = schema.to_string();
    let consts = text.split("\"const\":\"").skip(1).filter_map(|rest| rest.split('"').next().map(String::from));
    consts.collect()
}

/// Fails if a model is missing in this suite.
#[cfg(feature = "scene")]
#[test]
fn every_model_is_in_the_suite() {
    let schema = schemars::schema_for!(ModelParameters).to_value();
    let variants = schema["oneOf"].as_array().expect("models to choose from");
    let named: Vec<_> = variants.iter().map(|model| &model["properties"]["kind"]["const"]).collect();
    let expected = [
        "shape-based",
        "mass-spring",
        "limited-springs",
        "volume-springs",
        "linear",
        "corotational",
        "neo-hookean",
        "metric",
        "xpbd",
    ];
    assert_eq!(named, expected, "add the model to `cases`, then here");
}

/// A new reading of a model, named topology or integrator fails here until the suites include it.
#[cfg(feature = "scene")]
#[test]
fn every_choice_is_in_the_suites() {
    let of = |schema: schemars::Schema| names(&schema.to_value());
    assert_eq!(of(schemars::schema_for!(RotationReading)), ["arctangent", "vector-length", "linear-update", "robust"]);
    assert_eq!(of(schemars::schema_for!(DampingReading)), ["relative-motion", "deformation"]);
    assert_eq!(
        of(schemars::schema_for!(Springs)),
        ["edges", "edges+one-diagonal", "edges+face-diagonals", "edges+body-diagonals", "all"]
    );
    assert_eq!(
        of(schemars::schema_for!(Integrator)),
        [
            "semi-implicit-euler",
            "explicit-euler",
            "velocity-verlet",
            "pefrl",
            "runge-kutta",
            "dormand-prince",
            "backward-euler"
        ]
    );
}
