//! A cube that is pushed off a lift, in a loop of your own: `cargo run -p localshape-sim --example own_engine`.
use glam::DVec3;
use localshape_sim::model::shape_based::ShapeBased;
use localshape_sim::{
    Body, Course, FrictionOf, Integrator, Loading, Motion, Obstacle, Pose, Shape, State, Stepping, Surroundings, World,
};
use std::sync::Arc;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The corners of a cube of 1 m, 1 kg each, with x fastest.
    let corner = |at: u32| DVec3::new(f64::from(at & 1), f64::from(at >> 1 & 1), f64::from(at >> 2));
    let rest: Vec<_> = (0..8).map(corner).collect();
    let start = State::at_rest(rest.clone());
    let body = Arc::new(Body::builder(rest).elements([&[0, 1, 2, 3, 4, 5, 6, 7][..]].into_iter().collect()).build()?);
    // Any type with the traits of `model` will do.
    let model = ShapeBased { damping: 5.0, ..ShapeBased::new(1e4) };
    let around = Surroundings { gravity: DVec3::Y * -9.8, ..Surroundings::default() };
    let mut world = World::new(&body, start, &model, around, Stepping::new(Integrator::VelocityVerlet, 1e-3));
    // A plate that goes up and down, by any function of time.
    let shape = Shape::Box { centre: DVec3::Y * -0.5, half: DVec3::new(2.0, 0.5, 2.0), rotation: Default::default() };
    let lift = |time: f64| Pose { shift: DVec3::Y * (0.2 * (2.0 * time).sin()), ..Pose::NONE };
    let (motion, pivot, friction_of) = (Motion::Along(Arc::new(lift)), DVec3::ZERO, FrictionOf::Path);
    world.set_obstacles(vec![Obstacle { shape, motion, pivot, restitution: 0.2, friction: 0.3, friction_of }])?;
    for frame in 0..120 {
        if frame == 30 {
            // A hand at the left side, which stays there.
            let hand = Loading::dead(vec![0, 2, 4, 6], vec![DVec3::X * 20.0; 4], Course::ALWAYS);
            world.set_loads(vec![Arc::new(hand)])?;
        }
        world.advance(16);
        println!("{}", world.state().position[7]); // Draw here.
    }
    Ok(())
}
