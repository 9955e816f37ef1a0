//! Bodies in balance with loads, and the forces of bodies that do not move.

use glam::DVec3;
use localshape::sim::model::{ElasticModel, ForceModel, Report, Scratch};
use localshape::sim::{
    Body, Course, Crew, Equilibrium, Grip, Load, Loading, Motion, Nodes, State, Surroundings, equilibrium,
};
use std::sync::Arc;

/// The forces of a model on a body that does not move, with the memory that goes with them.
pub(super) struct Forces {
    forces: Box<dyn ForceModel>,
    memory: Vec<f64>,
    next: Vec<f64>,
    scratch: Scratch,
    still: Vec<DVec3>,
}

impl Forces {
    pub(super) fn new(body: &Arc<Body>, model: &dyn ElasticModel, start: &[DVec3]) -> Self {
        let memory = model.start(body, start);
        let (next, still) = (memory.clone(), vec![DVec3::ZERO; body.len()]);
        Self { forces: model.prepare(body), memory, next, scratch: Scratch::default(), still }
    }

    /// The forces on nodes at these places (N).
    fn at(&mut self, position: &[DVec3]) -> Vec<DVec3> {
        let mut forces = vec![DVec3::ZERO; position.len()];
        let at = Nodes { position, velocity: &self.still };
        self.forces.add_forces(at, &self.memory, &mut self.next, &mut self.scratch, &mut forces);
        forces
    }

    /// The elastic energy (J), of models that have one.
    pub(super) fn energy(&mut self, position: &[DVec3]) -> Option<f64> {
        self.at(position);
        let Report { energy, .. } =
            self.forces.report(Nodes { position, velocity: &self.still }, &self.next, &mut |_, _, _| ());
        energy
    }

    /// The forces of small displacements over their amplitude (N/m): the part that is linear in them. Of two differences, so that what is
    /// cubic cancels, too.
    pub(super) fn linear(&mut self, body: &Body, shape: &[DVec3], amplitude: f64) -> Vec<DVec3> {
        let mut by = |amplitude: f64| {
            let moved: Vec<_> = body.rest().iter().zip(shape).map(|(&rest, &shape)| rest + shape * amplitude).collect();
            self.at(&moved)
        };
        let [near, far] = [amplitude, 2.0 * amplitude].map(|amplitude| {
            let there_and_back = by(amplitude).into_iter().zip(by(-amplitude));
            there_and_back.map(|(there, back)| (there - back) / (2.0 * amplitude)).collect::<Vec<_>>()
        });
        near.into_iter().zip(far).map(|(near, far)| (near * 4.0 - far) / 3.0).collect()
    }
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
