//! Bodies that load the ground.

use super::Case;
use crate::material::Model;
use glam::DVec3;
use localshape::sim::{
    Contacts, Crew, Equilibrium, FrictionOf, Integrator, Material, Moment, Motion, Obstacle, Shape, Source, State,
    Stepping, Surroundings, World, equilibrium,
};
use std::sync::Arc;

const MATERIAL: Material = Material { young: 2e5, poisson: 0.0 };
const GRAVITY: DVec3 = DVec3::new(0.0, -9.8, 0.0);
/// Bodies in the stack, each a cube with this side (m), and what is between them at first (m).
const COUNT: usize = 2;
const SIDE: f64 = 0.2;
const GAP: f64 = 0.005;

pub(super) const CASE: Case = Case {
    name: "A stack on the ground",
    what: "The force of the ground on a stack of two bodies at rest, over `n m g` with friction 0.3: the mean over a hundred steps from rest.",
    measure,
    with_springs: true,
};

fn measure(model: &Model, refined: u32) -> Option<f64> {
    let cells = 1 << refined;
    let body = model.elements.block(&[cells; 3], SIDE / f64::from(cells), (0.0, 1), 1000.0);
    let made = model.on(&body, MATERIAL, SIDE / f64::from(cells))?;
    let low = body.rest().iter().fold(f64::INFINITY, |low, at| low.min(at.y));
    let lift = |at: usize| DVec3::Y * (GAP - low + at as f64 * (SIDE + GAP));
    let place = |at: usize| body.rest().iter().map(move |&rest| rest + lift(at));
    let start = State::at_rest((0..COUNT).flat_map(place).collect());
    let ground = Obstacle {
        shape: Shape::Floor { normal: DVec3::Y, height: 0.0 },
        motion: Motion::Still,
        pivot: DVec3::ZERO,
        restitution: 0.0,
        friction: 0.3,
        friction_of: FrictionOf::Path,
    };
    let contacts = Some(Contacts { friction: 0.3, ..Contacts::default() });
    let around = Surroundings { gravity: GRAVITY, obstacles: vec![ground], contacts, ..Surroundings::default() };
    let parts = vec![(Arc::clone(&body), made.as_ref()); COUNT];
    let step = made.properties(&body).shortest_period(&body) / 50.0;
    let Equilibrium { position, .. } = equilibrium(&parts, &start, &around, step, Crew::default()).ok()?;
    let stepping = Stepping::new(Integrator::SemiImplicitEuler, step);
    let mut world = World::of_parts(&parts, State::at_rest(position), around, stepping);
    world.keep_reactions(Moment::at(100.0 * step));
    world.advance(100);
    let reactions = world.reactions()?;
    let force = reactions.iter().filter(|one| one.from == Source::Obstacle(0)).map(|one| one.force.y).sum::<f64>();
    let mass: f64 = body.mass().iter().sum();
    Some(force / (COUNT as f64 * mass * 9.8))
}
