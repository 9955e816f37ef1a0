//! Two bodies that fly at each other: momentum, angular momentum, energy, and what is entangled at the end.

use super::bodies::{MASS, Placed, SIDE, Setting, cubes};
use super::{Measured, Trial};
use crate::random::Random;
use glam::DVec3;
use localshape::sim::{State, Status, World};

/// The speed of each body (m/s).
const SPEED: f64 = 10.0;

/// Blocks of 27 cells, turned and offset at random.
fn pair(seed: u64) -> Vec<Placed> {
    let body = cubes([3; 3]);
    let mut random = Random(seed);
    let placed = |side: f64| {
        let aside = [(); 2].map(|()| 0.1 * (2.0 * random.next() - 1.0));
        let at = DVec3::new(side * 0.3, aside[0], aside[1]);
        Placed { turned: random.rotation(), speed: DVec3::X * (-SPEED * side), ..Placed::still(&body, at) }
    };
    [-1.0, 1.0].map(placed).to_vec()
}

/// The momentum (kg m/s) and the angular momentum (kg m²/s) of all nodes.
fn moments(world: &World, bodies: &[Placed]) -> [DVec3; 2] {
    let State { position, velocity, .. } = world.state();
    let mass = bodies.iter().flat_map(|placed| placed.body.mass());
    position.iter().zip(velocity).zip(mass).fold([DVec3::ZERO; 2], |[along, around], ((&at, &speed), &mass)| {
        [along + speed * mass, around + at.cross(speed) * mass]
    })
}

/// Momenta in every step of some impacts, and energies.
pub(super) fn trials(impacts: u64) -> Vec<Trial> {
    let momenta = [[1.0, 0.0], [0.0, 0.0], [0.5, 0.0], [0.5, 0.5], [1.0, 1.0]];
    let mut all: Vec<Trial> =
        momenta.map(|law| Box::new(move || momentum(law, impacts.min(4))) as Trial).into_iter().collect();
    all.extend(
        [(0.0, 50), (0.5, 50), (1.0, 50), (1.0, 100)]
            .map(|(restitution, parts)| Box::new(move || energy(restitution, parts, impacts)) as Trial),
    );
    for (stiffness, restitution) in [1e3, 1e4].into_iter().flat_map(|k| [0.0, 0.5, 1.0].map(|e| (k, e))) {
        all.push(Box::new(move || entangled(stiffness, restitution, impacts)));
    }
    all
}

fn momentum(law: [f64; 2], impacts: u64) -> Vec<Measured> {
    let mut worst = [0.0f64; 2];
    for seed in 1..=impacts {
        let bodies = pair(seed);
        let mut world = Setting::new(1e4, law).world(&bodies);
        let start = moments(&world, &bodies);
        let scale = 27.0 * MASS * SPEED;
        for _ in 0..400 {
            world.advance(1);
            let now = moments(&world, &bodies);
            for (at, scale) in [scale, scale * SIDE].into_iter().enumerate() {
                worst[at] = worst[at].max((now[at] - start[at]).length() / scale);
            }
        }
    }
    let named = |what: &str| format!("{what}, e = {}, μ = {}", law[0], law[1]);
    vec![
        Measured::most(named("change of momentum in any step"), worst[0], 1e-12),
        Measured::most(named("change of angular momentum in any step"), worst[1], 1e-12),
    ]
}

fn energy(restitution: f64, parts: u32, impacts: u64) -> Vec<Measured> {
    // The energy of semi-implicit Euler oscillates with the body, so that a mean over some oscillations counts.
    let mut gained = f64::NEG_INFINITY;
    for seed in 1..=impacts {
        let setting = Setting { share: 1.0 / f64::from(parts), ..Setting::new(1e4, [restitution, 0.0]) };
        let mut world = setting.world(&pair(seed));
        let start = world.diagnostics().energy;
        world.advance(u64::from(6 * parts));
        let energies = (0..4 * parts).map(|_| {
            world.advance(1);
            world.diagnostics().energy
        });
        gained = gained.max(energies.sum::<f64>() / f64::from(4 * parts) / start - 1.0);
    }
    let most = match (restitution < 1.0, parts) {
        (true, _) => 0.006,
        (false, 50) => 0.04,
        _ => 0.01,
    };
    vec![Measured::most(format!("gain of energy at the end, e = {restitution}, ΔT = T/{parts}"), gained, most)]
}

/// Impacts after which triangles still cross, or numbers are not finite.
fn entangled(stiffness: f64, restitution: f64, impacts: u64) -> Vec<Measured> {
    let is_entangled = |&seed: &u64| {
        let bodies = pair(100 + seed);
        let mut world = Setting::new(stiffness, [restitution, 0.0]).world(&bodies);
        world.advance(300);
        world.status() != Status::Ok || world.crossings().is_some_and(|found| !found.is_empty())
    };
    let count = (1..=impacts).filter(is_entangled).count();
    let what = format!("entangled of {impacts} impacts, k/m = {stiffness:e}/s², e = {restitution}");
    vec![Measured::most(what, count as f64, 0.0)]
}
