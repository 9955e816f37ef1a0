//! Bodies slide over flat surfaces of others as over a plane: the edges within these do not brake them.

use super::surfaces::{Placed, SIDE, block, by, with_contacts};
use super::touching::mean;
use glam::{DQuat, DVec3};
use localshape_sim::{Body, Dimension, Grip, IndexLists, Integrator, Kernel, Motion, Surroundings};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A rectangle of square cells around the origin of the plane.
fn rectangle([wide, high]: [u32; 2]) -> Arc<Body> {
    let across = wide + 1;
    let half = DVec3::new(f64::from(wide), f64::from(high), 0.0) * 0.5;
    let place = |at: u32| (DVec3::new(f64::from(at % across), f64::from(at / across), 0.0) - half) * SIDE;
    let rest = (0..across * (high + 1)).map(place).collect();
    let mut elements = IndexLists::default();
    for cell in 0..wide * high {
        let low = cell % wide + across * (cell / wide);
        elements.push(&[low, low + 1, low + across + 1, low + across]);
    }
    Arc::new(Body::builder(rest).dimension(Dimension::Plane).elements(elements).build().expect("a rectangle"))
}

/// The speed that is left after .15 s of a body that slides over another one, which is held, without friction. The step is a share of the period
/// of one element.
fn left([lower, upper]: [&Arc<Body>; 2], at: [f64; 2], speed: f64, share: f64) -> f64 {
    let nodes = (0..lower.len() as u32).collect();
    let grip = Grip { nodes, from: 0.0, until: f64::INFINITY, motion: Motion::Still };
    let around = Surroundings { grips: vec![grip], gravity: DVec3::Y * -10.0, ..with_contacts(0.0, 0.0) };
    let top = |body: &Body| body.rest().iter().map(|at| at.y).fold(0.0, f64::max);
    let above = DVec3::new(at[0], top(lower) + top(upper) + 0.051 * SIDE, at[1]);
    let placed = |at, speed| Placed { at, turned: DQuat::IDENTITY, speed };
    let bodies =
        [(Arc::clone(lower), placed(DVec3::ZERO, DVec3::ZERO)), (Arc::clone(upper), placed(above, DVec3::X * speed))];
    let stiffness: f64 = 1e4;
    let mut world = by(Integrator::SemiImplicitEuler, Kernel::Fast, &bodies, stiffness, share, around);
    world.advance((0.15 / (share * TAU / stiffness.sqrt())) as u64);
    mean(&world.state().velocity[lower.len()..]).x
}

/// Steps of T/50, in which a node moves by a tenth of a cell, and of T/200.
#[test]
fn edges_of_flat_surfaces_do_not_brake() {
    let plane = [rectangle([20, 1]), rectangle([3, 3])];
    let space = [block([14, 1, 4]), block([2; 3])];
    for (share, lost) in [(0.02, [0.05, 2e-3]), (0.005, [2e-4; 2])] {
        for from in [-0.5, -0.47] {
            let in_plane = left([&plane[0], &plane[1]], [from, 0.0], 8.0, share) / 8.0;
            let in_space = left([&space[0], &space[1]], [from, 0.013], 5.0, share) / 5.0;
            let off = [in_plane, in_space].map(|left| (left - 1.0).abs());
            assert!(off[0] < lost[0] && off[1] < lost[1], "{off:?}");
        }
    }
}
