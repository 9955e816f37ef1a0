//! Energies, residuals and strains.

use super::*;
use crate::kernel::strains;
use crate::law::Energy;
use crate::model::{Report, Share};
use crate::state::Nodes;

/// What was shared: the nodes of each element or spring, with their energies (J).
type Shares = Vec<(Vec<u32>, Vec<f64>)>;

fn with_shares(report: impl FnOnce(&mut Share<'_>) -> Report) -> (Report, Shares) {
    let mut shares = Shares::new();
    let report = report(&mut |at, nodes, own| {
        assert_eq!(at, shares.len());
        shares.push((nodes.to_vec(), own.to_vec()));
    });
    (report, shares)
}

/// The reports of the vectorised code, with the same bits for every set and number of threads, and of the
/// reference.
fn reports(
    energy: &dyn Fn(Set) -> Box<dyn Energy>,
    model: &dyn ElasticModel,
    body: &Arc<Body>,
    position: &[DVec3],
    memory: &[f64],
) -> [(Report, Shares); 2] {
    let found = same(Set::all(), &[1, 2, 3], |set, threads| {
        let (energy, crew) = (energy(set), Crew::new(threads));
        let here = with_shares(|share| energy.report(position, memory, Some(share), &crew));
        assert_eq!(here.0, energy.report(position, memory, None, &crew));
        here
    });
    let still = vec![DVec3::ZERO; position.len()];
    let at = Nodes { position, velocity: &still };
    [found, with_shares(|share| model.prepare(body).report(at, memory, share))]
}

fn assert_near(name: &str, [found, expected]: [(Report, Shares); 2], largest_alpha: f64, is_unique: bool) {
    let [energy, reference] = [&found, &expected].map(|all| all.0.energy.expect("an energy"));
    assert!((energy - reference).abs() <= 1e-12 * reference, "{name}: {energy} instead of {reference}");
    let residuals = [&found, &expected].map(|all| all.0.residual);
    let [residual, reference] = residuals.map(|residual| residual.unwrap_or(f64::NAN));
    let is_near = (residual - reference).abs() <= 1e-12 * largest_alpha;
    assert!(is_near || residuals == [None; 2], "{name}: {residuals:?}");
    assert_eq!(found.1.len(), expected.1.len());
    let whole: f64 = found.1.iter().flat_map(|(_, shares)| shares).sum();
    assert!((whole - energy).abs() <= 1e-12 * energy, "{name}");
    let largest = expected.1.iter().flat_map(|(_, shares)| shares).fold(0.0, |most: f64, share| most.max(*share));
    for ((nodes, shares), (own, expected)) in found.1.iter().zip(&expected.1) {
        assert_eq!(nodes, own);
        let far = shares.iter().zip(expected).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        // Where several rotations are optimal, round-off may select another one.
        assert!(far <= 1e-12 * largest || !is_unique, "{name}: {shares:?} instead of {expected:?}");
    }
}

/// The angular acceleration (rad/s²) that the largest possible torque would cause.
fn largest_alpha(body: &Body, stiffness: f64, position: &[DVec3]) -> f64 {
    let largest = |nodes: &[u32]| {
        let arms = |places: &[DVec3]| -> Vec<f64> { centred(nodes, places).into_iter().map(DVec3::length).collect() };
        let (rest, now) = (arms(&body.rest), arms(position));
        let inertia: f64 = nodes.iter().zip(&rest).map(|(&node, r)| body.mass[node as usize] * r * r).sum();
        stiffness * rest.iter().zip(&now).map(|(rest, now)| rest * now).sum::<f64>() / inertia
    };
    body.elements.iter().map(largest).fold(0.0, f64::max)
}

/// The strain of an element by its definition.
fn strain(body: &Body, nodes: &[u32], position: &[DVec3]) -> f64 {
    let (rest, now) = (centred(nodes, &body.rest), centred(nodes, position));
    let best = best(body.dimension, moment(&rest, now.iter().copied()));
    let off: f64 = rest.iter().zip(&now).map(|(&rest, &now)| (now - best * rest).length_squared()).sum();
    (off / rest.iter().map(|rest| rest.length_squared()).sum::<f64>()).sqrt()
}

/// From the identity, and from a rotation that is far from all.
fn assert_strains(name: &str, body: &Body, position: &[DVec3]) {
    let expected: Vec<_> = body.elements.iter().map(|nodes| strain(body, nodes, position)).collect();
    for near in [DMat3::IDENTITY, DMat3::from_quat(DQuat::from_xyzw(0.7, -0.1, 0.1, 0.7).normalize())] {
        let found = same(Set::all(), &[1, 3], |set, threads| strains(set, body, position, near, &Crew::new(threads)));
        for (found, &expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() <= 1e-14 * (1.0 + expected), "{name}: {found} instead of {expected}");
        }
    }
}

#[test]
fn energies_residuals_and_strains_are_those_of_the_reference() {
    let crushes = [DVec3::new(1.0, 1.0, -1.0), DVec3::new(1.0, 1.0, 0.0), DVec3::new(0.0, 1.0, 0.0), DVec3::ZERO];
    let mut bodies = vec![("a block", whole([11, 12, 10], 0.1, 1)), ("squares", whole([9, 3, 0], 0.1, 2))];
    for corners in 2..9 {
        bodies.push(("one kind", pieces([4, 3, 3], &[corners], corners as u64)));
    }
    bodies.push(("anything", pieces([5, 4, 4], &[2, 3, 4, 5, 6, 7, 8], 9)));
    bodies.push(("anything flat", pieces([7, 5, 0], &[3, 4], 10)));
    bodies.push(("one tetrahedron", pieces([1, 1, 1], &[4], 11)));
    bodies.push(("a block, filled in part", filled(whole([5, 4, 3], 0.1, 1))));
    bodies.push(("anything, filled in part", filled(pieces([5, 4, 4], &[2, 3, 4, 5, 6, 7, 8], 9))));
    bodies.push(("flat, filled in part", filled(pieces([7, 5, 0], &[3, 4], 10))));
    bodies.push(("a block of unequal stiffness", stiffened(whole([5, 4, 3], 0.1, 1))));
    bodies.push(("flat, of unequal stiffness", stiffened(pieces([7, 5, 0], &[3, 4], 10))));
    bodies.push(("both", filled(stiffened(pieces([5, 4, 4], &[2, 3, 4, 5, 6, 7, 8], 9)))));
    for (name, body) in &bodies {
        let springs = body.topology().springs(Springs::All);
        for crush in [None].into_iter().chain(crushes.map(Some)) {
            let mut state = start(body, 3);
            let memory = rotations(body, &state);
            let random = &mut Noise(4);
            state.position.iter_mut().for_each(|place| *place += vector(random, body.dimension) * 0.002);
            // Some elements among others are turned inside out, flattened or collapsed to a line or a point.
            for nodes in crush.into_iter().flat_map(|_| body.elements.iter().step_by(5)) {
                let middle = state.position[nodes[0] as usize];
                for &node in nodes {
                    let place = &mut state.position[node as usize];
                    *place = middle + (*place - middle) * crush.unwrap_or(DVec3::ONE);
                }
            }
            let position = &state.position;
            let name = format!("{name}, {} corners, {crush:?}", body.elements[0].len());
            assert_strains(&name, body, position);
            for rotation in [Rotation::Optimum, TWICE] {
                let model = shape_based(rotation, 0.0);
                let energy = |set| model.by_law(body, &conditions(SEMI, set), None).energy;
                let both = reports(&energy, &model, body, position, &memory);
                let name = format!("{name}, {rotation:?}");
                assert_near(&name, both, largest_alpha(body, STIFFNESS, position), crush.is_none());
            }
            let model = mass_spring(&springs, 0.0);
            let energy = |set| model.by_law(body, &conditions(SEMI, set), None).energy;
            assert_near(&name, reports(&energy, &model, body, position, &[]), 0.0, true);
        }
    }
}
