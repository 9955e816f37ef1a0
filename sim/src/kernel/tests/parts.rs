//! Contact between parts.

use super::*;
use crate::contact::ContactStage;
use crate::motion::Interval;
use crate::part::Part;
use crate::state::{Nodes, Status};

/// Nodes of the first two parts, in pairs, that do not pass each other along x.
struct Pairs {
    pairs: usize,
    restitution: f64,
}

impl ContactStage for Pairs {
    fn resolve(
        &self,
        parts: &[Part],
        _: Interval,
        inverse_mass: &[f64],
        before: Nodes<'_>,
        position: &mut [DVec3],
        velocity: &mut [DVec3],
    ) {
        for pair in 0..self.pairs {
            let [a, b] = [0, 1].map(|part| parts[part].nodes.start + pair);
            let (depth, sum) = (position[a].x - position[b].x, inverse_mass[a] + inverse_mass[b]);
            if before.position[a].x > before.position[b].x || depth <= 0.0 || sum == 0.0 {
                continue;
            }
            let approach = velocity[a].x - velocity[b].x;
            for (node, side) in [(a, -1.0), (b, 1.0)] {
                let share = side * (1.0 + self.restitution) * inverse_mass[node] / sum;
                position[node].x += share * depth;
                velocity[node].x += share * approach.max(0.0);
            }
        }
    }
}

const TOUCHING: Pairs = Pairs { pairs: 24, restitution: 0.5 };

/// Two bodies of kernels of different kinds that approach each other, above a floor; one node of the second is held.
fn meeting(kernel: Kernel, integrator: Integrator, damping: f64, stage: Option<Pairs>, threads: usize) -> World {
    let bodies = [whole([4, 2, 3], 0.0, 31), pieces([3, 2, 2], &[4, 6, 8], 32)];
    let springs = bodies[1].topology().springs(Springs::All);
    let models: [Box<dyn ElasticModel>; 2] = [
        Box::new(shape_based(Rotation::Optimum, damping)),
        Box::new(MassSpring { stiffness: STIFFNESS, damping: 0.0, springs: springs.into(), breaks_at: None }),
    ];
    let mut all = State::default();
    for (at, body) in bodies.iter().enumerate() {
        let State { position, velocity, .. } = start(body, 33);
        all.position.extend(position.iter().map(|&place| place + DVec3::X * [0.0, 0.5][at]));
        all.velocity.extend(velocity.iter().map(|&speed| speed + DVec3::X * [3.0, -3.0][at]));
    }
    let shape = Shape::Floor { normal: DVec3::Y, height: 0.4 };
    let floor = Obstacle {
        shape,
        motion: Motion::Still,
        pivot: DVec3::ZERO,
        restitution: 0.5,
        friction: 0.3,
        friction_of: Default::default(),
    };
    let held = bodies[0].len() as u32 + 3;
    let grips = vec![Grip { nodes: vec![held], from: 0.0, until: 0.1, motion: Motion::Still }];
    let around = Surroundings { gravity: GRAVITY, obstacles: vec![floor], grips, ..Surroundings::default() };
    let stepping = Stepping { kernel, ..Stepping::new(integrator, STEP) };
    let [first, second] = [0, 1].map(|at| (Arc::clone(&bodies[at]), &*models[at]));
    let mut world = World::of_parts(&[first, second], all, around, stepping);
    world.set_crew(Crew::new(threads));
    if let Some(stage) = stage {
        world.add_contact(Arc::new(stage));
    }
    world
}

const WITH_KERNELS: [Integrator; 4] =
    [Integrator::SemiImplicitEuler, Integrator::ExplicitEuler, Integrator::VelocityVerlet, Integrator::Pefrl];

/// A stage sees all nodes before and after each step of a kernel, as in the reference code.
#[test]
fn bodies_that_meet_step_like_the_reference() {
    for (integrator, damping) in WITH_KERNELS.into_iter().flat_map(|way| [(way, 0.0), (way, 10.0)]) {
        // Without damping its energy grows without bound.
        let steps = if integrator == Integrator::ExplicitEuler { STEPS / 2 } else { STEPS };
        let run = |kernel: Kernel, stage: Option<Pairs>, threads: usize, calls: &[u64]| {
            let mut world = meeting(kernel, integrator, damping, stage, threads);
            calls.iter().for_each(|&steps| world.advance(steps));
            assert_eq!(world.status(), Status::Ok);
            world.state().clone()
        };
        let fast = run(Kernel::Fast, Some(TOUCHING), 1, &[steps]);
        let plain = run(Kernel::Reference, Some(TOUCHING), 1, &[steps]);
        let far = distance(&fast, &plain);
        assert!(far <= 1e-12, "{integrator:?} {damping}: {far:e}");
        let cut = [1, 40, 1, 1, 7, steps - 50];
        assert!(run(Kernel::Fast, Some(TOUCHING), 2, &cut) == fast, "{integrator:?} {damping}");
        let free = run(Kernel::Fast, None, 1, &[steps]);
        assert!(distance(&fast, &free) > 1e-2, "{integrator:?} {damping} touched");
        // A stage without an effect changes no bit.
        assert!(run(Kernel::Fast, Some(Pairs { pairs: 0, ..TOUCHING }), 1, &[steps]) == free);
    }
}
