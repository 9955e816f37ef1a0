//! Shape matching, which for one element of equal masses is the paper's model.

use super::support::{Noise, lattice, world};
use glam::{DMat3, DQuat, DVec3};
use localshape_sim::model::shape_based::ShapeBased;
use localshape_sim::rotation::{davenport1968, moment};
use localshape_sim::{State, Surroundings};

/// The goal positions of shape matching for equal masses: `g = R (x⁰ − x⁰_cm) + x_cm`, of M. Müller, B. Heidelberger, M. Teschner, M.
/// Gross, Meshless Deformations Based on Shape Matching, SIGGRAPH 2005.
pub(crate) fn goals(rest: &[DVec3], now: &[DVec3]) -> Vec<DVec3> {
    let mean = |all: &[DVec3]| all.iter().sum::<DVec3>() / all.len() as f64;
    let (rest_mean, now_mean) = (mean(rest), mean(now));
    let relative: Vec<_> = rest.iter().map(|&rest| rest - rest_mean).collect();
    let at_rest = moment(&relative, now.iter().map(|&now| now - now_mean));
    let turn = DMat3::from_quat(davenport1968::optimum(at_rest, DQuat::IDENTITY));
    relative.iter().map(|&relative| turn * relative + now_mean).collect()
}

/// `v += α (g − x)/h + h f/m`, then `x += h v`: Eq. (4) of one element with `k = α m/h²`.
#[test]
fn shape_matching_of_one_element_of_equal_masses_is_the_shape_model() {
    let (body, mut noise) = (lattice(1, 0.1), Noise(7));
    let start = State::at_rest(body.rest().iter().map(|&rest| rest + noise.vector() * 0.02).collect());
    let gravity = DVec3::new(0.0, -9.8, 0.0);
    let (alpha, mass, step) = (0.4, 1.0, 1e-2);
    let model = ShapeBased::new(alpha * mass / (step * step));
    let around = Surroundings { gravity, ..Surroundings::default() };
    let mut world = world(&body, start.clone(), &model, step, around);
    let (mut position, mut velocity) = (start.position, start.velocity);
    for _ in 0..100 {
        let goals = goals(body.rest(), &position);
        for (node, goal) in goals.iter().enumerate() {
            velocity[node] += (*goal - position[node]) * (alpha / step) + gravity * step;
            position[node] += velocity[node] * step;
        }
        world.advance(1);
        let far = position.iter().zip(&world.state().position).fold(0.0, |far: f64, (a, b)| far.max(a.distance(*b)));
        assert!(far < 1e-12, "{far:e}");
    }
}
