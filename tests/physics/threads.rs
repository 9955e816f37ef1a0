//! The same bits for any number of threads.

use crate::support::{Noise, floor, lattice, mass_spring, shape_based, world};
use glam::DVec3;
use localshape::sim::body::State;
use localshape::sim::model::ElasticModel;
use localshape::sim::topology::Springs;
use localshape::sim::world::Surroundings;

#[test]
fn states_have_the_same_bits_for_1_2_and_8_threads() {
    // Large enough that forces, springs and nodes are all handed out in several blocks.
    let body = lattice(12, 0.1);
    let mut noise = Noise(2);
    let position: Vec<_> = body.rest.iter().map(|&rest| rest + noise.vector() * 0.01).collect();
    let velocity = vec![DVec3::new(0.3, -5.0, 0.1); body.len()];
    let start = State { position, velocity };
    let around = Surroundings {
        gravity: DVec3::new(0.0, -9.8, 0.0),
        obstacles: vec![floor(0.5, 0.3)],
        ..Surroundings::default()
    };
    for model in
        [&shape_based(1e4, 20.0) as &dyn ElasticModel, &mass_spring(&body, 1e4, 20.0, Springs::EdgesOneDiagonal)]
    {
        let ends = [1, 2, 8].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads");
            pool.install(|| {
                let mut world = world(&body, start.clone(), model, 1e-3, around.clone());
                world.advance(60);
                world.state().clone()
            })
        });
        assert!(ends[0] == ends[1] && ends[0] == ends[2], "{model:?}");
        assert!(ends[0] != start);
    }
}
