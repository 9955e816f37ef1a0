//! Bodies that are crumpled until they meet themselves everywhere.

use super::support::{bricks, mass_spring, shape_based};
use glam::DVec3;
use localshape_sim::model::ElasticModel;
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
