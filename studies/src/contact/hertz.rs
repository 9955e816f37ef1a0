//! A rigid ball that is pressed into an elastic half-space without contraction: `F = 4/3 E √R d^1.5` (H. Hertz, Journal für die reine und
//! angewandte Mathematik 92, 156 (1882)).
//!
//! The half-space is a block of linear bricks that become larger with the distance from the contact. It is brought to rest by taking a part
//! of its velocities away.

use super::bodies::{block, obstacle};
use super::{Measured, Trial};
use crate::material::hold;
use crate::models::Alike;
use glam::DVec3;
use localshape::sim::{
    Body, BodyContact, Contacts, Ease, Integrator, Key, Material, Motion, Obstacle, Offset, Shape, State, Stepping,
    Surroundings, World,
};
use std::sync::Arc;

/// The radius of the ball (m), how deep it is pressed (m), and half of the width of the block, its height (m).
const RADIUS: f64 = 1.0;
const DEEP: [f64; 3] = [0.01, 0.02, 0.04];
const WIDE: f64 = 2.5;
/// Young's modulus (Pa), and the steps of each depth.
const YOUNG: f64 = 1.0;
const STEPS: u64 = 2000;
/// How much cells grow outwards.
const GROWTH: f64 = 2.5;

pub(super) fn trials(refined: u32) -> Vec<Trial> {
    (0..refined.min(3)).map(|at| Box::new(move || pressed(16 + 8 * at)) as Trial).collect()
}

/// The block of so many cells across, with its top at the height 0, and the least distance of its nodes (m).
fn half_space(cells: u32) -> (Arc<Body>, f64) {
    let spread = |share: f64| libm::sinh(GROWTH * share) / libm::sinh(GROWTH);
    let place = |unit: DVec3, _: DVec3| DVec3::new(spread(unit.x), -spread(0.5 - 0.5 * unit.y), spread(unit.z)) * WIDE;
    let graded = block([cells, cells / 2, cells], place);
    // Masses that give all cells the same step: the stiffness of a brick grows with its size.
    let mut mass = vec![0.0; graded.len()];
    for cell in graded.elements().iter() {
        let ends = [0, 7].map(|at| graded.rest()[cell[at] as usize]);
        let size = (ends[1] - ends[0]).abs();
        let share = size.element_product() / size.min_element().powi(2);
        cell.iter().for_each(|&node| mass[node as usize] += share);
    }
    let body = Body::builder(graded.rest().to_vec()).elements(graded.elements().clone()).masses(mass).build();
    (Arc::new(body.expect("a graded block")), WIDE * spread(2.0 / f64::from(cells)))
}

fn pressed(cells: u32) -> Vec<Measured> {
    let (body, small) = half_space(cells);
    let material = Material { young: YOUNG, poisson: 0.0 };
    let model = Alike::material(material, 0.5 * small).model(&body, "linear", 0.0, None).expect("bricks");
    // Nodes have eight times the mass with which waves would pass a brick in the time 1, so that this is half of the largest stable step.
    let step = 1.0;
    let thin = 0.025 * small;
    let time = |stage: usize, share: f64| (stage as f64 + share) * STEPS as f64 * step;
    let keys = DEEP.iter().enumerate().map(|(stage, &deep)| (time(stage, 0.3), deep));
    let key =
        |(time, deep): (f64, f64)| Key { time, offset: Offset { shift: DVec3::Y * -deep, rotation: DVec3::ZERO } };
    let holding = DEEP.iter().enumerate().map(|(stage, &deep)| (time(stage, 1.0), deep));
    let mut moves: Vec<_> = [(0.0, 0.0)].into_iter().chain(keys).chain(holding).collect();
    moves.sort_by(|one, other| one.0.total_cmp(&other.0));
    let shape = Shape::Sphere { centre: DVec3::Y * (RADIUS + thin), radius: RADIUS };
    let motion = Motion::Keys { keys: moves.into_iter().map(key).collect(), ease: Ease::Smooth, repeat: false };
    let ball = Obstacle { motion, ..obstacle(shape, [0.0; 2]) };
    let held: Vec<_> = (0..body.len()).filter(|&node| body.rest()[node].y < -0.999 * WIDE).collect();
    let around = Surroundings {
        obstacles: vec![ball],
        contacts: Some(Contacts {
            bodies: vec![BodyContact { thickness: Some(thin), itself: false }],
            ..Contacts::default()
        }),
        grips: vec![hold(&held)],
        ..Surroundings::default()
    };
    let stepping = Stepping::new(Integrator::SemiImplicitEuler, step);
    let mut world = World::new(&body, State::at_rest(body.rest().to_vec()), model.as_ref(), around, stepping);
    let measured: Vec<_> = DEEP
        .iter()
        .map(|_| {
            rest(&mut world, cells);
            let all = world.forces();
            -held.iter().map(|&node| all[node].y).sum::<f64>()
        })
        .collect();
    let wanted = |deep: f64| 4.0 / 3.0 * YOUNG * RADIUS.sqrt() * libm::pow(deep, 1.5);
    let named = |what: String| format!("{cells} cells across: {what}");
    let axes = ["depth over radius", "force over E R²"];
    let mut found: Vec<_> = DEEP
        .iter()
        .zip(&measured)
        .map(|(&deep, &force)| {
            Measured::shown(named(format!("force over Hertz's, d = {deep} R")), force / wanted(deep)).at(
                "A ball on a block",
                axes,
                &format!("{cells} cells"),
                [deep, force],
            )
        })
        .collect();
    let [first, last] = [0, DEEP.len() - 1];
    let exponent = libm::log(measured[last] / measured[first]) / libm::log(DEEP[last] / DEEP[first]);
    found.push(Measured::near(named("exponent of the depth".to_owned()), exponent, 1.5, 0.02));
    found
}

/// Steps to the end of a stage, with the slowest waves just not oscillating.
fn rest(world: &mut World, cells: u32) {
    /// Steps between two cuts of the velocities.
    const BETWEEN: u64 = 10;
    // Waves pass √(1/8) of a brick in a step, less along the longer sides of bricks. The slowest one is four heights long.
    let slowest = 0.5 * std::f64::consts::PI / f64::from(cells) * 0.125f64.sqrt();
    let left = libm::exp(-2.0 * slowest * BETWEEN as f64);
    for _ in 0..STEPS / BETWEEN {
        world.advance(BETWEEN);
        let mut state = world.state().clone();
        state.velocity.iter_mut().for_each(|speed| *speed *= left);
        world.set_state(state);
    }
}
