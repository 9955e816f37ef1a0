//! A damped body on a floor settles to the static equilibrium, and what motion remains is that of the rebound rule.

use super::support::{floor, lattice, shape_based};
use glam::DVec3;
use localshape_sim::model::shape_based::{RotationReading, ShapeBased};
use localshape_sim::{Integrator, State, Stepping, Surroundings, World};

const GRAVITY: f64 = 9.8;
const STEP: f64 = 1e-3;

/// After a fall onto an edge, with the default integrator. The equilibrium is that of velocity Verlet, which comes to rest
/// completely, without friction, which could hold the body out of it. A node on the floor that is pressed down by `A` leaves it
/// with at most `v = e/(1 − e) A ΔT`, and so rises by at most `v²/2A` before it turns; `A` is at most `g` times the mass of the
/// body divided by that of the node. For a single node with e = 1/3 the speed is `½ g ΔT`.
#[test]
fn a_damped_body_settles_to_the_static_equilibrium_within_the_bound_of_the_rebound_rule() {
    let body = lattice(2, 0.1);
    let model = ShapeBased { rotation: RotationReading::Robust, ..shape_based(1e4, 20.0) };
    let around = |restitution| Surroundings {
        gravity: DVec3::Y * -GRAVITY,
        obstacles: vec![floor(restitution, 0.0)],
        ..Surroundings::default()
    };
    let heights = |state: &State| {
        let mut heights: Vec<_> = state.position.iter().map(|at| at.y).collect();
        heights.sort_by(f64::total_cmp);
        heights
    };
    let start = State::at_rest(body.rest().to_vec());
    let mut world = World::new(&body, start, &model, around(0.0), Stepping::new(Integrator::VelocityVerlet, STEP));
    world.advance(20_000);
    assert!(world.state().velocity.iter().all(|velocity| velocity.length() < 1e-12));
    let still = heights(world.state());
    let load = GRAVITY * body.len() as f64;
    for restitution in [0.0, 1.0 / 3.0, 0.7] {
        let turned =
            body.rest().iter().map(|&at| DVec3::new(at.x + 0.6 * at.y, at.y - 0.6 * at.x + 0.3, at.z + 0.1 * at.y));
        let start = State::at_rest(turned.collect());
        let stepping = Stepping::new(Integrator::default(), STEP);
        let mut world = World::new(&body, start, &model, around(restitution), stepping);
        world.advance(30_000);
        let speed = restitution / (1.0 - restitution) * load * STEP;
        // A step may add what a node moves in it.
        let rise = speed * speed / (2.0 * load) + speed * STEP;
        for _ in 0..200 {
            world.advance(1);
            for (node, velocity) in world.state().velocity.iter().enumerate() {
                // Without friction it may slide for ever.
                assert!(velocity.y.abs() < speed + 1e-8, "e = {restitution}, node {node}: {velocity} of {speed}");
            }
            let now = heights(world.state());
            for (now, still) in now.iter().zip(&still) {
                assert!((now - still).abs() < rise + 1e-8, "e = {restitution}: {now} {still}, bound {rise}");
            }
        }
    }
}
