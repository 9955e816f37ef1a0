//! Piles and towers that are to stay where they are.

use super::bodies::{GRAVITY, MASS, Placed, SIDE, Setting, cubes, mean, obstacle};
use super::{Measured, Trial};
use glam::DVec3;
use localshape::sim::{Body, Shape, World};
use std::sync::Arc;

/// The longest time (s) in which they settle.
const SETTLING: f64 = 5.0;

/// A pile of ten blocks for a time (s) with three restitutions, and a tower of ten.
pub(super) fn trials(time: f64) -> Vec<Trial> {
    let body = cubes([3; 3]);
    let wide = 3.0 * SIDE;
    let row = |level: u32| {
        let count = 4 - level;
        (0..count).map(move |at| (f64::from(at) - 0.5 * f64::from(count - 1), level))
    };
    let pile: Vec<_> = (0..4)
        .flat_map(row)
        .map(|(across, level)| DVec3::new(1.15 * wide * across, (0.55 + 1.1 * f64::from(level)) * wide, 0.0))
        .collect();
    let tower: Vec<_> = (0..10).map(|level| DVec3::Y * ((0.51 + 1.02 * f64::from(level)) * wide)).collect();
    let piles = [0.0, 0.5, 1.0].map(|restitution| {
        let (body, pile) = (Arc::clone(&body), pile.clone());
        let name = format!("pile of ten, e = {restitution}");
        Box::new(move || stay(&name, &body, &pile, 2e4, restitution, time)) as Trial
    });
    let tower: Trial = Box::new(move || stay("tower of ten, e = 0", &body, &tower, 1e6, 0.0, 0.25 * time));
    piles.into_iter().chain([tower]).collect()
}

fn stay(name: &str, body: &Arc<Body>, at: &[DVec3], stiffness: f64, restitution: f64, time: f64) -> Vec<Measured> {
    let bodies: Vec<_> = at.iter().map(|&at| Placed::still(body, at)).collect();
    let mut setting = Setting::new(stiffness, [restitution, 0.5]);
    // A tenth of critical damping of a cell.
    setting.damping = 0.2 * (stiffness * MASS).sqrt();
    setting.around.gravity = DVec3::Y * -GRAVITY;
    let floor = Shape::Floor { normal: DVec3::Y, height: 0.0 };
    setting.around.obstacles = vec![obstacle(floor, [restitution, 0.5])];
    let mut world = setting.world(&bodies);
    world.advance(setting.steps(SETTLING.min(time)));
    let centres =
        |world: &World| world.state().position.chunks(body.len()).map(|at| mean(body, at)).collect::<Vec<_>>();
    let momentum = |world: &World| {
        let masses = bodies.iter().flat_map(|placed| placed.body.mass());
        world.state().velocity.iter().zip(masses).map(|(speed, mass)| speed.y * mass).sum::<f64>()
    };
    let (first, pushed) = (centres(&world), momentum(&world));
    let (mut low, mut high) = (first.clone(), first.clone());
    for _ in 0..100 {
        world.advance(setting.steps(time / 100.0));
        for (at, centre) in centres(&world).into_iter().enumerate() {
            (low[at], high[at]) = (low[at].min(centre), high[at].max(centre));
        }
    }
    let passed = 100.0 * setting.steps(time / 100.0) as f64 * setting.step();
    let weight = body.mass().iter().sum::<f64>() * bodies.len() as f64 * GRAVITY;
    let force = (momentum(&world) - pushed) / passed / weight;
    let most = |of: fn(DVec3) -> f64| low.iter().zip(&high).map(|(low, high)| of(*high - *low)).fold(0.0, f64::max);
    let named = |what: &str| format!("{name}, {time} s: {what}");
    vec![
        Measured::most(named("range of heights (cells)"), most(|way| way.y) / SIDE, 0.01),
        Measured::most(named("range sideways (cells)"), most(|way| libm::hypot(way.x, way.z)) / SIDE, 0.1),
        Measured::most(named("force on the floor over n m g, less 1"), force.abs(), 1e-4),
    ]
}
