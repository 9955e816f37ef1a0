//! Obstacles, grips and the speed limit, with all kernels.

use super::*;
use crate::kernel::Vectorised;

#[test]
fn nodes_rebound_as_in_the_reference() {
    let body = pieces([4, 3, 4], &[4, 8], 14);
    let mut start = start(&body, 4);
    start.velocity.iter_mut().for_each(|velocity| velocity.y -= 3.0);
    let start = with_rotations(&body, start);
    let floor = obstacle(Shape::Floor { normal: DVec3::Y, height: 0.45 }, 0.5, 0.3);
    for scheme in [Scheme::SemiImplicitEuler, Scheme::VelocityVerlet, PEFRL] {
        let model = shape_based(TWICE, 10.0);
        let mut world = reference(&body, &start.0, &model, scheme, vec![floor.clone()]);
        world.advance(300);
        let resolve = |_: u64, _: usize, position: &mut DVec3, velocity: &mut DVec3, acceleration: DVec3| {
            floor.at(STEP, STEP).rebound(position, velocity, acceleration);
        };
        for bound in [
            Bound::HalfSpace { normal: DVec3::Y, height: 0.46 },
            Bound::Box { low: DVec3::splat(-9.0), high: DVec3::new(9.0, 0.47, 9.0) },
        ] {
            for set in Set::all() {
                let mut kernel = general(&body, &start, TWICE, 10.0, scheme, set);
                let around = Around { bounds: &[bound], row: &|_| 0..1, resolve: &resolve, ..FREE };
                assert_eq!(kernel.advance(300, around), Ok(()));
                let far = distance(&kernel.stored(&start).0, world.state());
                assert!(far <= 1e-12, "{scheme:?}: {far:e}");
            }
        }
    }
}

/// The step in which a node becomes too fast is rejected and those before are kept, for any division into calls and number of threads.
#[test]
fn a_runaway_leaves_the_state_before_its_step() {
    // It falls, and becomes too fast at some time.
    const LIMIT: f64 = 8.0;
    let around = Around { speed_limit: &|_| LIMIT, ..FREE };
    for body in [pieces([4, 3, 4], &[4, 8], 15), whole([4, 3, 6], 0.0, 15)] {
        let start = with_rotations(&body, start(&body, 5));
        let kernel = |start: &Whole, damping: f64, scheme: Scheme, threads: usize| {
            let compiled = shape_based(TWICE, damping).compile(&body, &conditions(scheme, Set::best()));
            Moving::new(compiled.stepper, start, scheme, threads)
        };
        for (scheme, damping) in SCHEMES.into_iter().flat_map(|scheme| [(scheme, 0.0), (scheme, 10.0)]) {
            let make = |threads| kernel(&start, damping, scheme, threads);
            let mut one_by_one = make(1);
            let taken = (0..10_000).take_while(|_| one_by_one.advance(1, around).is_ok()).count() as u64;
            assert!(taken > 40 && taken < 9_999, "{taken}");
            // Without a limit some node is the first to exceed it.
            let mut free = make(1);
            assert_eq!(free.advance(taken + 1, FREE), Ok(()));
            let speeds = free.stored(&start).0.velocity;
            let first = speeds.iter().position(|speed| speed.length() > LIMIT);
            for (threads, steps) in [(1, 10_000), (2, 10_000), (3, 10_000), (3, 7)] {
                let mut other = make(threads);
                let lost = (0..10_000).find_map(|_| other.advance(steps, around).err());
                let found = (lost.map(|lost| lost.node), other.0.steps());
                assert_eq!(found, (first, taken), "{scheme:?} {damping} {threads} {steps}");
                assert_eq!(other.stored(&start), one_by_one.stored(&start));
            }
        }
        let (mut state, memory) = start.clone();
        state.position[7] = DVec3::NAN;
        let mut kernel = kernel(&(state, memory), 0.0, SEMI, 1);
        assert!(kernel.advance(5, FREE).is_err() && kernel.0.steps() == 0);
        let (found, _) = kernel.stored(&start);
        assert!(found.position[7].is_nan() && found.position[0] == start.0.position[0]);
    }
}

/// A node that contact makes too fast is found at the end of the step, which velocity Verlet computes in the next pass, by the limit
/// of that step.
#[test]
fn the_end_of_a_step_has_the_limit_of_that_step() {
    let body = pieces([4, 3, 4], &[4, 8], 15);
    let start = with_rotations(&body, start(&body, 5));
    for damping in [0.0, 10.0] {
        let mut kernel = general(&body, &start, TWICE, damping, Scheme::VelocityVerlet, Set::best());
        let everywhere = Bound::HalfSpace { normal: DVec3::Y, height: f64::INFINITY };
        let around = Around {
            bounds: &[everywhere],
            row: &|_| 0..1,
            resolve: &|step, _, _, velocity, _| velocity.x = if step == 7 { 50.0 } else { velocity.x },
            speed_limit: &|step| if step == 7 { 40.0 } else { 1000.0 },
            ..FREE
        };
        assert!(kernel.advance(30, around).is_err(), "{damping}");
        assert_eq!(kernel.0.steps(), 7, "{damping}");
    }
}

/// Grips that become active and inactive, and moving obstacles, with every scheme and kernel: a lattice, any elements,
/// springs in families and others.
#[test]
fn what_holds_and_moves_is_that_of_the_reference() {
    let offset = |x: f64, turn: f64| Offset { shift: DVec3::new(x, 0.02, 0.0), rotation: DVec3::Z * turn };
    let keys = [(0.0, 0.0, 0.0), (0.1, 0.03, 0.2), (0.15, 0.01, 0.1)];
    let keys = keys.map(|(time, x, turn)| Key { time, offset: offset(x, turn) }).to_vec();
    let dragging = Motion::Keys { keys, ease: Ease::Smooth, repeat: false };
    let grip = |nodes: &[u32], from: f64, until: f64, motion: &Motion| Grip {
        nodes: nodes.to_vec(),
        from,
        until,
        motion: motion.clone(),
    };
    let still = Motion::Still;
    let grips = vec![
        grip(&[0, 3], 0.0, f64::INFINITY, &dragging),
        grip(&[17], 0.0101, 0.05, &still),
        grip(&[17, 11], 0.11, 0.12, &dragging),
    ];
    let some_time = vec![grip(&[5, 12], 0.02, 0.03, &dragging)];
    // It moves with the nodes and pushes them.
    let swing = Motion::Swing { period: 0.5, phase: 0.0, amplitude: offset(0.3, 0.4) };
    let ball = Shape::Sphere { centre: DVec3::new(-0.25, 0.7, 0.1), radius: 0.25 };
    let paddle = Obstacle { motion: swing, ..obstacle(ball, 0.0, 0.0) };
    let random = &mut Noise(21);
    let (lattice, any) = (whole([4, 2, 3], 0.0, 22), pieces([3, 2, 2], &[4, 6, 8], 23));
    let listed: Vec<[u32; 2]> = (0..60).map(|_| [random.below(30) as u32, 30 + random.below(30) as u32]).collect();
    let named = lattice.topology().springs(Springs::EdgesFaceDiagonals);
    for damping in [0.0, 10.0] {
        let models: [(&Arc<Body>, Box<dyn ElasticModel>); 4] = [
            (&lattice, Box::new(shape_based(TWICE, damping))),
            (&any, Box::new(shape_based(Rotation::Optimum, damping))),
            (&lattice, Box::new(mass_spring(&named, damping))),
            (&lattice, Box::new(mass_spring(&listed, damping))),
        ];
        for (body, model) in models {
            let all = [Integrator::SemiImplicitEuler, Integrator::ExplicitEuler, Integrator::VelocityVerlet];
            for integrator in all.into_iter().chain([Integrator::Pefrl]) {
                // Without damping its energy grows without bound.
                if integrator == Integrator::ExplicitEuler && damping == 0.0 {
                    continue;
                }
                for (grips, obstacles) in [(&grips, vec![]), (&some_time, vec![paddle.clone()])] {
                    let world = |kernel, obstacles: &[Obstacle]| {
                        let (obstacles, grips) = (obstacles.to_vec(), grips.clone());
                        let around = Surroundings { gravity: GRAVITY, obstacles, grips, ..Surroundings::default() };
                        let stepping = Stepping { kernel, ..Stepping::new(integrator, STEP) };
                        World::new(body, start(body, 8), model.as_ref(), around, stepping)
                    };
                    let [mut fast, mut plain] =
                        [Kernel::Fast, Kernel::Reference].map(|kernel| world(kernel, &obstacles));
                    fast.advance(STEPS);
                    plain.advance(STEPS);
                    let far = distance(fast.state(), plain.state());
                    let name = format!("{integrator:?} {damping} {} {model:?}", obstacles.len());
                    assert!(far <= 1e-12, "{far:e} {name}");
                    assert!(fast.state().memory.constraints.iter().any(|&gripped| gripped != 0.0));
                    let mut cut = world(Kernel::Fast, &obstacles);
                    for steps in [1, 49, 1, 33, 466, 1, STEPS - 551] {
                        cut.advance(steps);
                    }
                    assert!(cut.state() == fast.state(), "cut: {name}");
                    if !obstacles.is_empty() {
                        let mut free = world(Kernel::Fast, &[]);
                        free.advance(STEPS);
                        assert!(distance(fast.state(), free.state()) > 1e-3, "touched: {name}");
                    }
                }
            }
        }
    }
}
