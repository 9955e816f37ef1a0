//! Bodies that are crumpled until they meet themselves everywhere.

use super::support::{Noise, bricks, mass_spring, shape_based};
use glam::DVec3;
use localshape_sim::model::ElasticModel;
use localshape_sim::model::shape_based::ShapeBased;
use localshape_sim::{
    Body, BodyContact, Contacts, Ease, Grip, Integrator, Key, Motion, Offset, Springs, State, Stepping, Surroundings,
    World,
};

/// A grip that turns the nodes at a place along x by a turn and a quarter in three seconds, and moves them by .2 m.
fn turning(body: &Body, x: f64, sign: f64) -> Grip {
    let nodes = (0..body.len() as u32).filter(|&at| (body.rest()[at as usize].x - x).abs() < 1e-9).collect();
    let end = Offset { shift: DVec3::X * 0.2 * sign, rotation: DVec3::X * 7.854 * sign };
    let keys = vec![Key { time: 0.0, offset: Offset::default() }, Key { time: 3.0, offset: end }];
    Grip { nodes, from: 0.0, until: 3.0, motion: Motion::Keys { keys, ease: Ease::Smooth, repeat: false } }
}

/// A soft block whose nodes fly about keeps its momenta while it meets itself, to round-off, with friction and rebounds.
#[test]
fn a_crumpled_block_keeps_its_momenta() {
    let body = bricks([3, 3, 3], DVec3::splat(0.1));
    let mut noise = Noise(7);
    for (restitution, friction) in [(0.0, 0.0), (0.5, 0.5), (1.0, 0.3)] {
        let bodies = vec![BodyContact { itself: true, thickness: None }];
        let contacts = Contacts { restitution, friction, bodies, ..Contacts::default() };
        let around = Surroundings { contacts: Some(contacts), ..Surroundings::default() };
        let velocity = (0..body.len()).map(|_| 3.0 * noise.vector()).collect();
        let stepping = Stepping::new(Integrator::SemiImplicitEuler, 1e-3);
        let start = State::new(body.rest().to_vec(), velocity);
        let mut world = World::new(&body, start, &ShapeBased::new(100.0), around, stepping);
        let before = world.diagnostics();
        let mut met = 0;
        for _ in 0..100 {
            world.advance(4);
            met += world.contact_points().len();
        }
        let after = world.diagnostics();
        assert!(met > 5, "{met} contacts");
        for (name, change) in [
            ("momentum", after.momentum - before.momentum),
            ("angular momentum", after.angular_momentum - before.angular_momentum),
        ] {
            assert!(change.length() < 1e-11, "{name}: {change} with e = {restitution}, μ = {friction}");
        }
    }
}

/// Mats that are twisted between their ends by two turns and a half do not cross themselves, be their folds within an element, between
/// neighbours or far from each other.
#[test]
fn twisted_mats_do_not_cross_themselves() {
    for ([long, wide], side) in
        [([12, 1], [0.125, 0.05, 0.2]), ([12, 3], [0.125, 0.05, 0.2]), ([10, 4], [0.15, 0.06, 0.15])]
    {
        let body = bricks([long, 1, wide], side.into());
        let grips = vec![turning(&body, 0.0, 1.0), turning(&body, f64::from(long) * side[0], -1.0)];
        let bodies = vec![BodyContact { itself: true, thickness: None }];
        let contacts = Contacts { friction: 0.2, bodies, ..Contacts::default() };
        let around = Surroundings { grips, contacts: Some(contacts), ..Surroundings::default() };
        let springs = mass_spring(&body, 14e3, 48.0, Springs::EdgesFaceDiagonals);
        for model in [&shape_based(14e3, 48.0) as &dyn ElasticModel, &springs] {
            let stepping = Stepping::new(Integrator::SemiImplicitEuler, 5.77e-4);
            let start = State::at_rest(body.rest().to_vec());
            let mut world = World::new(&body, start, model, around.clone(), stepping);
            for _ in 0..90 {
                world.advance(58);
                assert_eq!(world.crossings(), Some(Vec::new()), "{long} × {wide} cells");
            }
        }
    }
}
