//! The state has everything that persists between steps.

use super::INTEGRATORS;
use super::conformance::{bodies, cases};
use super::support::{Noise, floor, lattice, shape_based};
use glam::DVec3;
use localshape_sim::{Grip, Integrator, Kernel, Moment, Motion, Offset, State, Status, Stepping, Surroundings, World};

/// Continues from a state that was written and read, in a new world.
fn revived(world: &World, mut fresh: World) -> World {
    let bytes = world.state().to_bytes();
    let state = State::from_bytes(&bytes).expect("what was written");
    assert!(state.to_bytes() == bytes);
    fresh.set_state(state);
    fresh
}

/// Elements of every kind, models and integrators, with a floor; damped with a grip that holds for some of the steps, and undamped
/// without.
#[test]
fn every_model_goes_on_from_what_was_written_with_the_same_bits() {
    // The second half is the first with unequal masses.
    let bodies = bodies();
    for body in &bodies[bodies.len() / 2..] {
        let grip = Grip { nodes: vec![0], from: 0.002, until: 0.006, motion: Motion::at(Offset::default()) };
        let ways = INTEGRATORS.into_iter().flat_map(|way| [(way, Kernel::Fast), (way, Kernel::Reference)]);
        // The last four have no vectorised steps.
        let ways = ways.filter(|(way, kernel)| *kernel == Kernel::Reference || INTEGRATORS[..4].contains(way));
        for (integrator, kernel) in ways {
            for (grips, damping) in [(vec![grip.clone()], 7.0), (vec![], 0.0)] {
                let around = Surroundings {
                    gravity: DVec3::Y * -9.8,
                    obstacles: vec![floor(0.5, 0.3)],
                    grips,
                    ..Surroundings::default()
                };
                for case in cases(body, damping) {
                    let start = State::new(body.rest().to_vec(), vec![DVec3::Y * -3.0; body.len()]);
                    let stepping = Stepping { kernel, ..Stepping::new(integrator, 1e-3) };
                    let begin = || World::new(body, start.clone(), case.model.as_ref(), around.clone(), stepping);
                    let mut whole = begin();
                    whole.advance(10);
                    let mut cut = begin();
                    for steps in [1, 3, 1, 5] {
                        cut.advance(steps);
                        cut = revived(&cut, begin());
                    }
                    let case = format!("{:?} {integrator:?} {kernel:?} {}", case.model, around.grips.len());
                    assert!(cut.state().to_bytes() == whole.state().to_bytes(), "{case}");
                }
            }
        }
    }
}

/// Between moments the state is that of the last moment reached.
#[test]
fn a_state_is_whole_also_on_the_way() {
    let body = lattice(2, 0.1);
    for kernel in [Kernel::Fast, Kernel::Reference] {
        let stepping = Stepping { kernel, ..Stepping::new(Integrator::SemiImplicitEuler, 1e-3) };
        let start = State::new(body.rest().to_vec(), vec![DVec3::Y; body.len()]);
        let begin = || World::new(&body, start.clone(), &shape_based(1e4, 0.0), Surroundings::default(), stepping);
        let mut world = begin();
        assert!(!world.advance_towards(Moment::at(0.1), 40) && world.steps() == 40);
        let mut other = begin();
        other.advance(world.state().steps);
        assert_eq!(world.state(), other.state(), "{kernel:?}");
        assert!(world.advance_towards(Moment::at(0.1), 60));
        other.advance(100 - other.steps());
        assert_eq!(world.state(), other.state(), "{kernel:?}");
    }
}

/// A rejected step has no effect: the state is that of a run that did not attempt it. The last two integrators reject none.
#[test]
fn a_rejected_step_leaves_nothing_behind() {
    let body = lattice(2, 0.1);
    let shape = shape_based(1e4, 0.0);
    let grip = |nodes: u32, until: f64| Grip { nodes: (0..nodes).collect(), from: 0.0, until, motion: Motion::Still };
    let ways = INTEGRATORS[..5].iter().flat_map(|&way| [(way, Kernel::Fast), (way, Kernel::Reference)]);
    // The last one lets all nodes go some steps before a node becomes too fast.
    let grips = [vec![], vec![grip(1, f64::INFINITY)], vec![grip(27, 2.6)]];
    for ((integrator, kernel), grips) in ways.flat_map(|way| grips.iter().map(move |grips| (way, grips.clone()))) {
        // Far beyond the limit of stability.
        let stepping = Stepping { kernel, ..Stepping::new(integrator, 0.5) };
        let mut noise = Noise(4);
        let start = State::at_rest(body.rest().iter().map(|&at| at + noise.vector() * 0.02).collect());
        let around = Surroundings { grips, ..Surroundings::default() };
        let begin = || World::new(&body, start.clone(), &shape, around.clone(), stepping);
        let mut world = begin();
        world.advance(1000);
        let Status::Diverged(divergence) = world.status() else { panic!("{integrator:?} is stable") };
        let mut before = begin();
        before.advance(divergence.step - 1);
        assert_eq!(before.status(), Status::Ok);
        let [ended, before] = [&world, &before].map(World::state);
        assert_eq!((&ended.position, &ended.velocity), (&before.position, &before.velocity), "{integrator:?}");
        assert_eq!(ended.memory, before.memory, "{integrator:?}");
    }
}

/// The reported element is that of the first node above the speed limit, also if contact stops it in the same step.
#[test]
fn kernels_tell_the_same_runaway() {
    for body in bodies() {
        for case in cases(&body, 0.0) {
            let around =
                Surroundings { gravity: DVec3::Y * -9.8, obstacles: vec![floor(0.0, 1.0)], ..Surroundings::default() };
            let mut noise = Noise(4);
            let start = State::at_rest(body.rest().iter().map(|&at| at + noise.vector().with_z(0.0) * 0.1).collect());
            let [fast, plain] = [Kernel::Fast, Kernel::Reference].map(|kernel| {
                let stepping = Stepping { kernel, ..Stepping::new(Integrator::SemiImplicitEuler, 5.0) };
                let mut world = World::new(&body, start.clone(), case.model.as_ref(), around.clone(), stepping);
                world.advance(100);
                world.status()
            });
            assert_eq!(fast, plain, "{:?}", case.model);
        }
    }
}
