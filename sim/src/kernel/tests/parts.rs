//! Contact between parts.

use super::*;
use crate::contact::Contacts;
use crate::state::Status;

/// Two bodies of kernels of different kinds that approach each other, above a floor; one node of the second is held.
fn meeting(kernel: Kernel, integrator: Integrator, damping: f64, contacts: Option<Contacts>, threads: usize) -> World {
    let bodies = [whole([4, 2, 3], 0.0, 31), pieces([3, 2, 2], &[4, 6, 8], 32)];
    let springs = bodies[1].topology().springs(Springs::All);
    let models: [Box<dyn ElasticModel>; 2] =
        [Box::new(shape_based(Rotation::Optimum, damping)), Box::new(mass_spring(&springs, 0.0))];
    let mut all = State::default();
    let starts = [0, 1].map(|at| start(&bodies[at], 33));
    let [end, begin] = [crate::hull::bounds(&starts[0].position).1, crate::hull::bounds(&starts[1].position).0];
    for (at, State { position, velocity, .. }) in starts.into_iter().enumerate() {
        // Near each other.
        let beside = end.x - begin.x + 0.05;
        all.position.extend(position.iter().map(|&place| place + DVec3::X * [0.0, beside][at]));
        all.velocity.extend(velocity.iter().map(|&speed| speed + DVec3::X * [3.0, -3.0][at]));
    }
    let floor = obstacle(Shape::Floor { normal: DVec3::Y, height: 0.4 }, 0.5, 0.3);
    let held = bodies[0].len() as u32 + 3;
    let grips = vec![Grip { nodes: vec![held], from: 0.0, until: 0.1, motion: Motion::Still }];
    let around = Surroundings { gravity: GRAVITY, obstacles: vec![floor], contacts, grips, ..Surroundings::default() };
    let stepping = Stepping { kernel, ..Stepping::new(integrator, STEP) };
    let [first, second] = [0, 1].map(|at| (Arc::clone(&bodies[at]), &*models[at]));
    let mut world = World::of_parts(&[first, second], all, around, stepping);
    world.set_crew(Crew::new(threads));
    world
}

const WITH_KERNELS: [Integrator; 4] =
    [Integrator::SemiImplicitEuler, Integrator::ExplicitEuler, Integrator::VelocityVerlet, Integrator::Pefrl];

/// Contact sees all nodes before and after each step of a kernel, as in the reference code.
#[test]
fn bodies_that_meet_step_like_the_reference() {
    let touching = || Some(Contacts { restitution: 0.5, friction: 0.3, ..Contacts::default() });
    for (integrator, damping) in WITH_KERNELS.into_iter().flat_map(|way| [(way, 0.0), (way, 10.0)]) {
        // Without damping its energy grows without bound.
        let steps = if integrator == Integrator::ExplicitEuler { STEPS / 2 } else { STEPS };
        let run = |kernel: Kernel, contacts: Option<Contacts>, threads: usize, calls: &[u64]| {
            let mut world = meeting(kernel, integrator, damping, contacts, threads);
            calls.iter().for_each(|&steps| world.advance(steps));
            assert_eq!(world.status(), Status::Ok);
            world.state().clone()
        };
        let fast = run(Kernel::Fast, touching(), 1, &[steps]);
        let plain = run(Kernel::Reference, touching(), 1, &[steps]);
        let far = distance(&fast, &plain);
        assert!(far <= 1e-12, "{integrator:?} {damping}: {far:e}");
        let cut = [1, 40, 1, 1, 7, steps - 50];
        assert!(run(Kernel::Fast, touching(), 2, &cut) == fast, "{integrator:?} {damping}");
        let free = run(Kernel::Fast, None, 1, &[steps]);
        assert!(distance(&fast, &free) > 1e-2, "{integrator:?} {damping} touched");
        // Where nothing touches, contact changes no bit.
        let apart = run(Kernel::Fast, touching(), 2, &[1, 2]);
        assert!(apart == run(Kernel::Fast, None, 1, &[3]), "{integrator:?} {damping}");
    }
}
