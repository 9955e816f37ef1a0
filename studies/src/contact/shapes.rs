//! Soft bodies with tips, ridges, gaps and ledges that fall on each other, each from several disturbed starts: nothing crosses.
//!
//! The situations are those of K. Erleben, "Methodology for assessing mesh-based contact point methods", ACM Transactions on Graphics 37,
//! 39 (2018), with bodies of our own.

use super::bodies::{GRAVITY, MASS, Placed, SIDE, Setting, block, cubes, obstacle};
use super::{Measured, Trial};
use crate::random::Random;
use glam::{DQuat, DVec3};
use localshape::sim::{Body, Shape, Status};
use std::sync::Arc;

/// The ten situations.
const NAMES: [&str; 10] = [
    "tip on tip",
    "tip on ridge",
    "ridge along ridge",
    "ridge across ridge",
    "tip on face",
    "tip into a gap",
    "ridge into a gap",
    "half over a ledge",
    "over an inner edge",
    "edge on edges",
];

pub(super) fn trials(starts: u64) -> Vec<Trial> {
    let trial = |at: usize| Trial::new("shapes", move || vec![falls(at, starts)]);
    (0..NAMES.len()).map(trial).collect()
}

/// A block that becomes thin downwards along x, and along z too for a tip.
fn pointed(is_tip: bool) -> Arc<Body> {
    let place = |unit: DVec3, at: DVec3| {
        let wide = 0.525 + 0.475 * unit.y;
        DVec3::new(at.x * wide, at.y, at.z * if is_tip { wide } else { 1.0 })
    };
    block([3; 3], place)
}

/// The bodies of a situation, the upper one first.
fn situation(at: usize) -> Vec<Placed> {
    let upside = DQuat::from_rotation_z(std::f64::consts::PI);
    let quarter = DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2);
    let (tip, ridge, cube) = (pointed(true), pointed(false), cubes([3; 3]));
    let low = 1.51 * SIDE;
    let above =
        |body: &Arc<Body>, turned: DQuat| Placed { turned, ..Placed::still(body, DVec3::Y * (low + 3.1 * SIDE)) };
    let below = |body: &Arc<Body>, turned: DQuat| Placed { turned, ..Placed::still(body, DVec3::Y * low) };
    let beside = |apart: f64| [-1.0, 1.0].map(|side| Placed::still(&cube, DVec3::new(side * apart, low, 0.0)));
    let none = DQuat::IDENTITY;
    let with = |first: Placed, others: &[Placed]| [&[first], others].concat();
    match at {
        0 => vec![above(&tip, none), below(&tip, upside)],
        1 => vec![above(&tip, none), below(&ridge, upside)],
        2 => vec![above(&ridge, none), below(&ridge, upside)],
        3 => vec![above(&ridge, quarter), below(&ridge, upside)],
        4 => vec![above(&tip, none), below(&cube, none)],
        5 => with(above(&tip, none), &beside(1.7 * SIDE)),
        6 => with(above(&ridge, none), &beside(1.7 * SIDE)),
        7 => with(
            Placed { at: DVec3::new(1.5 * SIDE, low + 3.1 * SIDE, 0.0), ..above(&cube, none) },
            &[below(&cube, none)],
        ),
        8 => with(
            Placed { speed: DVec3::X * 2.0, at: DVec3::new(-1.5 * SIDE, low + 3.1 * SIDE, 0.0), ..above(&cube, none) },
            &beside(1.53 * SIDE),
        ),
        _ => {
            let turned = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_4);
            let first = Placed { at: DVec3::Y * (low + 3.75 * SIDE), ..above(&cube, turned) };
            with(first, &beside(1.7 * SIDE))
        }
    }
}

/// Frames of some disturbed starts in which any triangles cross.
fn falls(at: usize, starts: u64) -> Measured {
    let mut setting = Setting::new(1e4, [0.2, 0.3]);
    setting.damping = 0.1 * (setting.stiffness * MASS).sqrt();
    setting.around.gravity = DVec3::Y * -GRAVITY;
    setting.around.obstacles = vec![obstacle(Shape::Floor { normal: DVec3::Y, height: 0.0 }, [0.2, 0.5])];
    let mut crossed = 0;
    for start in 1..=starts {
        let mut random = Random(1000 * at as u64 + start);
        let mut bodies = situation(at);
        let mut small = || 0.1 * SIDE * (2.0 * random.next() - 1.0);
        bodies[0].at += DVec3::new(small(), small().abs(), small());
        bodies[0].turned *= DQuat::from_rotation_y(small());
        bodies[0].speed += DVec3::NEG_Y * 2.0;
        let mut world = setting.world(&bodies);
        for _ in 0..60 {
            world.advance(setting.steps(1.0 / 60.0));
            crossed +=
                u64::from(world.status() != Status::Ok || world.crossings().is_some_and(|found| !found.is_empty()));
        }
    }
    let what = format!("{}: frames of {starts} falls in which triangles cross", NAMES[at]);
    Measured::most(what, crossed as f64, 0.0)
}
