//! Bodies in balance with loads, and the forces of bodies that do not move.

use glam::DVec3;
use localshape::sim::model::ElasticModel;
use localshape::sim::{
    Body, Course, Crew, Equilibrium, Grip, Integrator, Load, Loading, Motion, State, Stepping, Surroundings, World,
    equilibrium,
};
use std::sync::Arc;

/// A world of one body at rest, for its forces and its energy.
pub(super) fn still(body: &Arc<Body>, model: &dyn ElasticModel, position: Vec<DVec3>) -> World {
    let stepping = Stepping::new(Integrator::default(), 1.0);
    World::new(body, State::at_rest(position), model, Surroundings::default(), stepping)
}

/// The forces of small displacements over their amplitude (N/m): the part that is linear in them. Of two differences, so that what is
/// cubic cancels, too.
pub(super) fn linear_forces(world: &mut World, body: &Body, shape: &[DVec3], amplitude: f64) -> Vec<DVec3> {
    let mut by = |amplitude: f64| {
        let mut state = world.state().clone();
        state.position = body.rest().iter().zip(shape).map(|(&rest, &shape)| rest + shape * amplitude).collect();
        world.set_state(state);
        world.forces()
    };
    let [near, far] = [amplitude, 2.0 * amplitude].map(|amplitude| {
        let there_and_back = by(amplitude).into_iter().zip(by(-amplitude));
        there_and_back.map(|(there, back)| (there - back) / (2.0 * amplitude)).collect::<Vec<_>>()
    });
    near.into_iter().zip(far).map(|(near, far)| (near * 4.0 - far) / 3.0).collect()
}

/// Nodes that do not move.
pub(crate) fn hold(nodes: &[usize]) -> Grip {
    let nodes = nodes.iter().map(|&node| node as u32).collect();
    Grip { nodes, from: 0.0, until: f64::INFINITY, motion: Motion::Still }
}

/// Bodies, each with its model.
pub(crate) type Parts<'a> = [(Arc<Body>, &'a dyn ElasticModel)];

/// The same force (N) on each node at all times.
pub(crate) fn dead(forces: Vec<DVec3>) -> Arc<dyn Load> {
    Arc::new(Loading::dead((0..forces.len() as u32).collect(), forces, Course::ALWAYS))
}

/// Where bodies are at rest, from a start (m). Models that step themselves do so in steps (s). `None` if they do not come to rest.
pub(crate) fn rest_of(parts: &Parts<'_>, start: Vec<DVec3>, around: &Surroundings, step: f64) -> Option<Vec<DVec3>> {
    let found = equilibrium(parts, &State::at_rest(start), around, step, Crew::default());
    found.ok().map(|Equilibrium { position, .. }| position)
}
