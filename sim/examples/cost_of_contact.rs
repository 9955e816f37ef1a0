//! What contact costs: `cargo run --release -p localshape-sim --example cost_of_contact`.
//!
//! Ten blocks of 1000 cells stand in a wall, each row on the gaps of the row below. The same blocks far apart, with and without contact, are
//! measured in turn with them, and the median of the samples counts. The digest is of the state at the end.
use glam::DVec3;
use localshape_sim::model::shape_based::ShapeBased;
use localshape_sim::{
    Body, Contacts, Crew, IndexLists, Integrator, Motion, Obstacle, Shape, State, Stepping, Surroundings, World,
};
use std::f64::consts::TAU;
use std::sync::Arc;
use std::time::Instant;

const CELLS: u32 = 10;
/// The side of a cell (m).
const SIDE: f64 = 0.1;
/// k (N/m) and, for cells of 1 kg, k/m (1/s²).
const STIFFNESS: f64 = 1e6;
const SAMPLES: usize = 15;
const STEPS: u64 = 20;
/// Steps in which the wall comes to rest, and the rate (1/s) at which all motion is braked in them.
const REST: (u64, f64) = (6000, 60.0);

fn block() -> Arc<Body> {
    let n = CELLS + 1;
    let grid = |n: u32| (0..n).flat_map(move |z| (0..n).flat_map(move |y| (0..n).map(move |x| [x, y, z])));
    let rest: Vec<_> = grid(n).map(|at| DVec3::from_array(at.map(f64::from)) * SIDE).collect();
    let mut elements = IndexLists::default();
    let mut mass = vec![0.0; rest.len()];
    for [x, y, z] in grid(CELLS) {
        let corners =
            [0, 1, 2, 3, 4, 5, 6, 7].map(|bit: u32| x + (bit & 1) + n * (y + (bit >> 1 & 1) + n * (z + (bit >> 2))));
        corners.iter().for_each(|&node| mass[node as usize] += 0.125);
        elements.push(&corners);
    }
    Arc::new(Body::builder(rest).elements(elements).masses(mass).build().expect("a block"))
}

/// Rows of 3 and 2 blocks in turn, .2 cells apart sideways and just above each other, on a box; or all of them 3 m apart.
fn world(is_wall: bool, has_contact: bool, threads: usize) -> World {
    let (body, whole) = (block(), f64::from(CELLS) * SIDE);
    let (beside, above) = if is_wall { (whole + 0.2 * SIDE, whole + 0.052 * SIDE) } else { (4.0 * whole, 4.0 * whole) };
    let places = (0..4).flat_map(|row| {
        let count = 3 - row % 2;
        (0..count).map(move |at| DVec3::new(f64::from(at) + 0.5 * f64::from(row % 2), f64::from(row), 0.0))
    });
    let places: Vec<_> = places.map(|at| DVec3::new(beside * at.x, above * at.y, 0.0)).collect();
    let mut all = State::default();
    for at in &places {
        all.position.extend(body.rest().iter().map(|&rest| *at + rest));
        all.velocity.extend(vec![DVec3::ZERO; body.len()]);
    }
    let shape = Shape::Box {
        centre: DVec3::new(1.5, -0.5 - 0.026 * SIDE, 0.5),
        half: DVec3::new(4.0, 0.5, 2.0),
        rotation: Default::default(),
    };
    let obstacle = Obstacle {
        shape,
        motion: Motion::Still,
        pivot: DVec3::ZERO,
        restitution: 0.0,
        friction: 0.5,
        friction_of: Default::default(),
    };
    let around = Surroundings {
        gravity: if is_wall { DVec3::Y * -9.8 } else { DVec3::ZERO },
        obstacles: if is_wall { vec![obstacle] } else { Vec::new() },
        contacts: has_contact.then(|| Contacts { friction: 0.5, ..Contacts::default() }),
        ..Surroundings::default()
    };
    let model = ShapeBased::new(STIFFNESS);
    let parts: Vec<_> = places.iter().map(|_| (Arc::clone(&body), &model as _)).collect();
    let stepping = Stepping::new(Integrator::SemiImplicitEuler, TAU / STIFFNESS.sqrt() / 50.0);
    let mut world = World::of_parts(&parts, all, around, stepping);
    world.set_crew(Crew::new(threads));
    world
}

fn main() {
    let cases = [("apart, no contact", false, false, 1), ("apart", false, true, 1), ("wall", true, true, 1)];
    let cases = cases.into_iter().chain([("wall, two threads", true, true, 2)]);
    let mut worlds: Vec<_> =
        cases.map(|(name, wall, contact, threads)| (name, world(wall, contact, threads))).collect();
    for (_, world) in &mut worlds {
        world.set_mass_damping(REST.1).expect("a rate");
        world.advance(REST.0);
        world.set_mass_damping(0.0).expect("a rate");
    }
    let mut times = vec![Vec::new(); worlds.len()];
    for _ in 0..SAMPLES {
        for ((_, world), times) in worlds.iter_mut().zip(&mut times) {
            let start = Instant::now();
            world.advance(STEPS);
            times.push(start.elapsed().as_secs_f64() / STEPS as f64);
        }
    }
    let medians = times.iter_mut().map(|times| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    });
    let medians: Vec<f64> = medians.collect();
    for ((name, world), median) in worlds.iter().zip(&medians) {
        let bits = world.state().position.iter().flat_map(|at| at.to_array()).map(f64::to_bits);
        let digest = bits.fold(0_u64, |digest, bits| digest.rotate_left(7) ^ bits.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        println!("{name:20} {:8.1} µs a step, {:.2} ×, {digest:016x}", median * 1e6, median / medians[0]);
    }
}
