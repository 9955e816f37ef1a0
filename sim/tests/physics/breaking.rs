//! Elements and springs that break at a strain.

use super::support::{Noise, Remembering, lattice, mass_spring};
use glam::DVec3;
use localshape_sim::model::ElasticModel;
use localshape_sim::model::mass_spring::MassSpring;
use localshape_sim::model::shape_based::{DampingReading, ShapeBased};
use localshape_sim::{
    Body, Crew, Dimension, Field, Integrator, Kernel, Snapshot, Springs, State, Stepping, Surroundings, World,
};
use std::sync::Arc;

const STIFFNESS: f64 = 1e4;
const LIMIT: f64 = 0.1;

/// Models of elements and of springs that break at [`LIMIT`], or never.
fn models(body: &Body, damping: f64) -> Vec<[Box<dyn ElasticModel>; 2]> {
    let shape = ShapeBased { damping, ..ShapeBased::new(STIFFNESS) };
    let deforming = ShapeBased { bending: 1.0 / 3.0, damping_of: DampingReading::Deformation, ..shape.clone() };
    let springs = mass_spring(body, STIFFNESS, damping, Springs::EdgesFaceDiagonals);
    let both = |model: &dyn Fn(Option<f64>) -> Box<dyn ElasticModel>| [Some(LIMIT), None].map(model);
    vec![
        both(&|breaks_at| Box::new(ShapeBased { breaks_at, ..shape.clone() })),
        both(&|breaks_at| Box::new(ShapeBased { breaks_at, ..deforming.clone() })),
        both(&|breaks_at| Box::new(MassSpring { breaks_at, ..springs.clone() })),
    ]
}

/// A lattice that is torn apart in its middle, and turns.
fn torn(cells: u32) -> (Arc<Body>, State) {
    let body = lattice(cells, 0.1);
    let middle = 0.05 * f64::from(cells);
    let mut noise = Noise(3);
    let velocity = |&rest: &DVec3| {
        let side = if rest.x > middle { 1.0 } else { -1.0 };
        DVec3::new(6.0 * side, 0.0, 0.0) + DVec3::new(0.0, 1.0, 2.0).cross(rest) + noise.vector()
    };
    let start = State::new(body.rest().to_vec(), body.rest().iter().map(velocity).collect());
    (body, start)
}

/// A body in the plane: a row of squares.
fn strip() -> Arc<Body> {
    let rest = (0..12).map(|at| DVec3::new(f64::from(at / 2), f64::from(at % 2), 0.0) * 0.1).collect();
    let squares: Vec<_> = (0..5).map(|at| [0, 2, 3, 1].map(|corner| 2 * at + corner)).collect();
    let elements = squares.iter().map(|square| &square[..]).collect();
    Arc::new(Body::builder(rest).dimension(Dimension::Plane).elements(elements).build().expect("a body"))
}

fn world(body: &Arc<Body>, start: &State, model: &dyn ElasticModel, kernel: Kernel) -> World {
    let stepping = Stepping { kernel, ..Stepping::new(Integrator::SemiImplicitEuler, 5e-4) };
    World::new(body, start.clone(), model, Surroundings::default(), stepping)
}

/// The energy of each element or spring (J).
fn energies(of: &Remembering, state: &State) -> Vec<f64> {
    let mut all = Vec::new();
    of.forces.report(state.nodes(), &of.memory, &mut |_, _, shares| all.push(shares.iter().sum()));
    all
}

fn count(of: &[bool]) -> usize {
    of.iter().filter(|&&one| one).count()
}

/// In a state in which some elements are strained too far: these have no energy, all others have what they have without
/// breaking, and the forces are those of the others.
#[test]
fn what_is_strained_too_far_is_gone_with_its_energy_and_its_forces() {
    for body in [lattice(3, 0.1), strip()] {
        let mut noise = Noise(8);
        let moved = |&rest: &DVec3| {
            let by = noise.vector() * 0.011;
            rest + if body.dimension() == Dimension::Plane { by.with_z(0.0) } else { by }
        };
        let state = State::at_rest(body.rest().iter().map(moved).collect());
        let mut world = world(&body, &state, &ShapeBased::new(STIFFNESS), Kernel::Fast);
        world.show(Some(Field::Strain));
        let strains = world.snapshot().field;
        for [breaking, whole] in models(&body, 3.0) {
            let [mut breaks, never] = [&breaking, &whole].map(|model| Remembering::new(&body, model.as_ref(), &state));
            let (found, full) = (energies(&breaks, &state), energies(&never, &state));
            let length = |[i, j]: [u32; 2], at: &[DVec3]| at[i as usize].distance(at[j as usize]);
            let strain = |at: usize| match breaking.springs().get(at) {
                Some(&ends) => length(ends, &state.position) / length(ends, body.rest()) - 1.0,
                None => strains[at],
            };
            let gone: Vec<_> = (0..found.len()).map(|at| strain(at) > LIMIT).collect();
            assert!(0 < count(&gone) && count(&gone) < gone.len(), "{breaking:?}: {gone:?}");
            for at in 0..found.len() {
                let expected = if gone[at] { 0.0 } else { full[at] };
                assert!(
                    (found[at] - expected).abs() <= 1e-12 * full[at],
                    "{breaking:?} {at}: {} {expected}",
                    found[at]
                );
            }
            // Only what is left resists: the gradient of the energy that is left.
            let (forces, next) = breaks.evaluate(&state);
            let most = forces.iter().fold(0.0, |most: f64, force| most.max(force.length()));
            let resultant: DVec3 = forces.iter().sum();
            assert!(resultant.length() < 1e-13 * most * body.len() as f64, "{breaking:?}: {resultant}");
            let energy = |node: usize, by: DVec3| {
                let mut other = state.clone();
                other.position[node] += by;
                energies(&breaks, &other).iter().sum::<f64>()
            };
            for (node, force) in forces.iter().enumerate().take(6) {
                let (axis, h) = (DVec3::X, 1e-7);
                let slope = (energy(node, axis * h) - energy(node, -axis * h)) / (2.0 * h);
                assert!((force.x + slope).abs() < 1e-6 * most, "{breaking:?} {node}: {} {slope}", force.x);
            }
            // And it stays gone, without any strain.
            breaks.memory = next;
            let rest = State::at_rest(body.rest().to_vec());
            let (_, again) = breaks.evaluate(&rest);
            let width = breaking.properties(&body).breakable.expect("a model that breaks");
            let told: Vec<_> = again.chunks(width).map(|numbers| numbers[width - 1] == 1.0).collect();
            assert_eq!(told, gone, "{breaking:?}");
        }
    }
}

/// Of an element that has burst to a million times its size the round-off alone would be a large residual.
#[test]
fn the_residual_is_that_of_what_holds() {
    let body = lattice(2, 0.1);
    let mut state = State::at_rest(body.rest().to_vec());
    state.position[0] = DVec3::new(-3e5, 2e5, -1e5);
    let breaks = ShapeBased { breaks_at: Some(LIMIT), ..ShapeBased::new(STIFFNESS) };
    for kernel in [Kernel::Fast, Kernel::Reference] {
        let of = |model: &dyn ElasticModel| {
            let report = world(&body, &state, model, kernel).report(0);
            report.residual.expect("rotations")
        };
        let (rest, all) = (of(&breaks), of(&ShapeBased::new(STIFFNESS)));
        assert!(rest < 1e-9 && all > 1e-6, "{kernel:?}: {rest:e} {all:e}");
    }
}

#[test]
fn pieces_keep_all_momenta_and_the_energy_falls_by_what_broke() {
    for damping in [0.0, 3.0] {
        let (body, start) = torn(4);
        for [breaking, _] in models(&body, damping) {
            let mut world = world(&body, &start, breaking.as_ref(), Kernel::Fast);
            let before = world.diagnostics();
            let mut broken = 0.0;
            for _ in 0..40 {
                let last = world.diagnostics();
                world.advance(5);
                let now = world.diagnostics();
                assert!(now.broken >= broken, "{breaking:?}");
                assert!(now.energy < last.energy + 2e-3 * before.energy, "{breaking:?}: {last:?} {now:?}");
                broken = now.broken;
            }
            let after = world.diagnostics();
            let mass = body.mass().iter().sum::<f64>();
            assert!(broken > 0.0, "{breaking:?}");
            assert!(after.energy < 0.995 * before.energy, "{breaking:?}: {} {}", before.energy, after.energy);
            let momentum = (after.momentum - before.momentum).length();
            assert!(momentum < 1e-11 * mass, "{breaking:?}: {momentum:e}");
            // Damping as printed takes angular momentum.
            if damping == 0.0 || !format!("{breaking:?}").contains("RelativeMotion") {
                let turning = (after.angular_momentum - before.angular_momentum).length();
                assert!(turning < 1e-11 * mass, "{breaking:?}: {turning:e}");
            }
            let Snapshot { broken: elements, broken_springs, turned_over, position, .. } = world.snapshot();
            let whole = if breaking.springs().is_empty() { &elements } else { &broken_springs };
            assert_eq!(count(whole) as f64, broken);
            assert!(count(&elements) > 0, "{breaking:?}");
            // Broken elements count as nothing else.
            assert!(elements.iter().zip(&turned_over).all(|(&gone, &over)| !(gone && over)));
            let width = position.iter().fold(0.0, |most: f64, at| most.max(at.x)) - position[0].x;
            assert!(width > 1.5 * body.extent(), "{breaking:?}: {width}");
        }
    }
}

#[test]
fn the_same_pieces_come_apart_for_any_number_of_threads_and_after_any_interruption() {
    let (body, start) = torn(9);
    for [breaking, _] in models(&body, 3.0) {
        for integrator in [Integrator::SemiImplicitEuler, Integrator::VelocityVerlet] {
            let stepping = Stepping::new(integrator, 5e-4);
            let new = || World::new(&body, start.clone(), breaking.as_ref(), Surroundings::default(), stepping);
            let mut whole = new();
            whole.advance(80);
            assert!(whole.diagnostics().broken > 0.0);
            for threads in [2, 8] {
                let mut world = new();
                world.set_crew(Crew::new(threads));
                world.advance(80);
                assert!(world.state() == whole.state(), "{breaking:?}, {threads} threads");
            }
            let mut first = new();
            first.advance(33);
            let read = State::from_bytes(&first.state().to_bytes()).expect("what was written");
            let mut second = new();
            second.set_state(read);
            assert_eq!(second.snapshot().broken, first.snapshot().broken);
            second.advance(47);
            assert!(second.state() == whole.state(), "{breaking:?}");
        }
    }
}

/// The reference code takes other sums, so that states differ by round-off: the same elements break.
#[test]
fn both_kernels_break_the_same() {
    let (body, start) = torn(3);
    for [breaking, _] in models(&body, 3.0) {
        let [fast, plain] = [Kernel::Fast, Kernel::Reference].map(|kernel| {
            let mut world = world(&body, &start, breaking.as_ref(), kernel);
            world.advance(60);
            let Snapshot { broken, broken_springs, .. } = world.snapshot();
            (broken, broken_springs)
        });
        assert!(count(&fast.0) > 0 && fast == plain, "{breaking:?}");
    }
}

/// A spring breaks beyond the elongation given, and never by being shortened.
#[test]
fn a_spring_breaks_in_tension_only() {
    let body = super::support::body(Dimension::Space, &[[0.0; 3], [2.0, 0.0, 0.0]], &[&[0, 1]]);
    let spring = MassSpring { breaks_at: Some(0.25), ..mass_spring(&body, 3.0, 0.0, Springs::Edges) };
    for (length, tension) in [(2.4, 1.2), (2.499_999, 1.499_997), (2.500_001, 0.0), (9.0, 0.0), (0.1, -5.7)] {
        let state = State::at_rest(vec![DVec3::ONE, DVec3::ONE + DVec3::Z * length]);
        let (forces, memory) = Remembering::new(&body, &spring, &state).evaluate(&state);
        assert!((forces[0].z - tension).abs() < 1e-9, "{length}: {forces:?}");
        assert_eq!(memory, [f64::from(u8::from(tension == 0.0))]);
    }
}
