//! A cube in a loop of your own: `cargo run -p localshape-sim --example own_engine`.
use glam::DVec3;
use localshape_sim::model::shape_based::ShapeBased;
use localshape_sim::{Body, Dimension, Integrator, Solids, State, Stepping, Surroundings, World};
use std::sync::Arc;

fn main() {
    // The corners of a cube of 1 m, 1 kg each, with x fastest.
    let corner = |at: u32| DVec3::new(f64::from(at & 1), f64::from(at >> 1 & 1), f64::from(at >> 2));
    let rest: Vec<_> = (0..8).map(corner).collect();
    let cube = [&[0, 1, 2, 3, 4, 5, 6, 7][..]].into_iter().collect();
    let start = State::at_rest(rest.iter().map(|&node| node * 1.1).collect());
    let body = Arc::new(Body::new(Dimension::Space, rest, vec![1.0; 8], cube, Solids::Ordered, None));
    // Any type with the traits of `model` will do.
    let model = ShapeBased::new(1e3);
    let stepping = Stepping::new(Integrator::SemiImplicitEuler, 1e-3);
    let mut world = World::new(&body, start, &model, Surroundings::default(), stepping);
    for _frame in 0..60 {
        world.advance(16);
        println!("{}", world.state().position[7]); // Draw here.
    }
}
