//! Kinematic constraints: nodes that are held, gripped, dragged and released.

use super::INTEGRATORS;
use super::conformance::{STIFFNESS, of_stiffness};
use super::support::{bricks, lattice, shape_based, world};
use glam::{DQuat, DVec3};
use localshape_sim::model::ElasticModel;
use localshape_sim::model::metric::Metric;
use localshape_sim::{
    Ease, Grip, Integrator, Kernel, Key, Material, Motion, Offset, State, Status, Stepping, Surroundings, World,
};

const GRAVITY: DVec3 = DVec3::new(0.0, -9.8, 0.0);

fn around(grip: Grip) -> Surroundings {
    Surroundings { gravity: GRAVITY, grips: vec![grip], ..Surroundings::default() }
}

#[test]
fn held_nodes_stay_where_they_are_and_the_body_hangs_from_them() {
    let body = lattice(2, 0.1);
    let held: Vec<u32> = (0..27).filter(|&node| body.rest()[node as usize].y > 0.19).collect();
    let grip = Grip { nodes: held.clone(), from: 0.0, until: f64::INFINITY, motion: Motion::Still };
    let mut start = State::at_rest(body.rest().to_vec());
    start.velocity.fill(DVec3::new(0.3, 0.2, 0.1));
    let mut world = world(&body, start, &shape_based(1e4, 40.0), 1e-3, around(grip));
    world.advance(5000);
    for &node in &held {
        assert_eq!(world.state().position[node as usize], body.rest()[node as usize]);
        assert_eq!(world.state().velocity[node as usize], DVec3::ZERO);
    }
    // At rest the held nodes carry the weight of all others: the springs below have k times their sag.
    let sag = body.rest()[0].y - world.state().position[0].y;
    assert!((1e-4..0.02).contains(&sag), "{sag}");
    assert!(world.state().velocity.iter().all(|v| v.length() < 1e-6));
}

#[test]
fn dragged_nodes_follow_the_hand_and_keep_its_speed_when_let_go() {
    let body = lattice(1, 0.1);
    let keys = vec![
        Key { time: 0.1, offset: Offset::default() },
        Key { time: 0.3, offset: Offset { shift: DVec3::new(0.5, 0.2, 0.0), rotation: DVec3::Y * 1.5 } },
    ];
    let motion = Motion::Keys { keys, ease: Ease::Linear, repeat: false };
    let nodes: Vec<u32> = (0..8).collect();
    let grip = Grip { nodes, from: 0.1, until: 0.3, motion };
    let step = 1e-3;
    let mut world = world(&body, State::at_rest(body.rest().to_vec()), &shape_based(1e4, 0.0), step, around(grip));
    world.advance(100);
    let before = world.state().position.clone();
    world.advance(100);
    let half = DQuat::from_rotation_y(0.75);
    let middle = before.iter().sum::<DVec3>() / 8.0;
    for (now, start) in world.state().position.iter().zip(&before) {
        let expected = middle + DVec3::new(0.25, 0.1, 0.0) + half * (*start - middle);
        assert!((*now - expected).length() < 1e-12, "{now} {expected}");
    }
    world.advance(100);
    let thrown = world.snapshot().diagnostics.momentum / 8.0;
    assert!((thrown - DVec3::new(2.5, 1.0, 0.0)).length() < 1e-6, "{thrown}");
    // After the release only gravity acts.
    world.advance(200);
    let later = world.snapshot().diagnostics.momentum / 8.0;
    assert!((later - thrown - GRAVITY * 0.2).length() < 1e-11, "{later}");
}

/// A grip that begins while another ends takes the nodes at their present positions, and stretching a body to twenty
/// times its length is not a divergence.
#[test]
fn one_hand_takes_over_from_another_and_may_pull_far() {
    let body = lattice(1, 0.1);
    let out = |until: f64, way: f64| {
        let keys = vec![
            Key { time: 0.0, offset: Offset::default() },
            Key { time: until, offset: Offset { shift: DVec3::X * way, rotation: DVec3::ZERO } },
        ];
        Motion::Keys { keys, ease: Ease::Linear, repeat: false }
    };
    let left = Grip { nodes: vec![0, 2, 4, 6], from: 0.0, until: f64::INFINITY, motion: Motion::Still };
    let pull = Grip { nodes: vec![1, 3, 5, 7], from: 0.0, until: 0.5, motion: out(0.5, 2.0) };
    let hold = Grip { nodes: vec![1, 3, 5, 7], from: 0.5, until: 0.6, motion: Motion::Still };
    let around = Surroundings { grips: vec![left, pull, hold], ..Surroundings::default() };
    let mut world = world(&body, State::at_rest(body.rest().to_vec()), &shape_based(1e4, 0.0), 1e-3, around);
    world.advance(500);
    let drawn = world.state().position.clone();
    assert!((drawn[1] - body.rest()[1] - DVec3::X * 2.0).length() < 1e-12);
    world.advance(100);
    assert_eq!(world.state().position, drawn, "the second hand holds them where the first has left them");
    world.advance(500);
    assert_eq!(world.status(), Status::Ok);
    assert!(world.state().position[1].distance(drawn[1]) > 1.0, "let go, the body comes back");
}

/// The nodes of the bottom stay, and those of the top go 0.2 m along x in a second. No node is free, so that no step is too long, and forces
/// as large as those of a body sheared to `γ` = 2 move nothing.
#[test]
fn nodes_that_are_held_have_no_speed_of_their_own() {
    let body = bricks([3, 1, 2], DVec3::splat(0.1));
    let side = |y: f64| (0..body.len() as u32).filter(|&node| body.rest()[node as usize].y == y).collect::<Vec<_>>();
    let end = Offset { shift: DVec3::X * 0.2, rotation: DVec3::ZERO };
    let keys = vec![Key { time: 0.0, offset: Offset::default() }, Key { time: 1.0, offset: end }];
    let motion = Motion::Keys { keys, ease: Ease::Smooth, repeat: false };
    let grips = vec![
        Grip { nodes: side(0.0), from: 0.0, until: f64::INFINITY, motion: Motion::Still },
        Grip { nodes: side(0.1), from: 0.0, until: f64::INFINITY, motion },
    ];
    let around = Surroundings { grips, ..Surroundings::default() };
    let stiff = Metric::new(&body, Material { young: 1e5, poisson: 0.49 }, 0.0).expect("it fits");
    // Other models a thousand times as stiff as their step bears.
    let cases = of_stiffness(1e6 * STIFFNESS, &body, 0.0);
    for model in cases.iter().map(|case| &*case.model).chain([&stiff as &dyn ElasticModel]) {
        let takes = |integrator: &Integrator| integrator.refusal(model, &body, 0.0).is_none();
        for (integrator, kernel) in INTEGRATORS
            .into_iter()
            .filter(takes)
            .flat_map(|integrator| [(integrator, Kernel::Fast), (integrator, Kernel::Reference)])
        {
            let stepping = Stepping { kernel, ..Stepping::new(integrator, 1e-2) };
            let mut world = World::new(&body, State::at_rest(body.rest().to_vec()), model, around.clone(), stepping);
            world.advance(100);
            let text = format!("{integrator:?} {kernel:?} {model:?}");
            assert_eq!(world.status(), Status::Ok, "{text}");
            for (now, rest) in world.state().position.iter().zip(body.rest()) {
                assert!(now.distance(*rest + DVec3::X * (2.0 * rest.y)) < 1e-14, "{text}");
            }
        }
    }
    // W = μ/4 (2γ² + γ⁴) + λ/8 γ⁴.
    let mut world = world(&body, State::at_rest(body.rest().to_vec()), &stiff, 1e-3, around);
    world.advance(1000);
    let (shear, ratio) = (1e5 / (2.0 * 1.49), 2.0 * 0.49 / (1.0 - 2.0 * 0.49));
    let density = shear * (0.25 * (2.0 * 4.0 + 16.0) + 0.125 * ratio * 16.0);
    let found = world.diagnostics().elastic / 0.006;
    assert!((found / density - 1.0).abs() < 1e-12, "{found} {density}");
}
