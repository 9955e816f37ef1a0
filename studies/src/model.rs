//! The model of section 3 of the paper with any solver of rotations: a model of one's own, through the traits for that.

use crate::solver::Solver;
use glam::{DMat3, DQuat, DVec3};
use localshape::sim::model::{ElasticModel, ForceModel, Report, Scratch, Share};
use localshape::sim::rotation::davenport1968::optimum;
use localshape::sim::rotation::{moment, torque};
use localshape::sim::{Body, Nodes};
use std::sync::Arc;

/// The model. Its memory is the rotation of each element, as a quaternion.
#[derive(Clone, Debug)]
pub(crate) struct ShapeBy {
    /// `k` of Eq. (4) (N/m).
    pub(crate) stiffness: f64,
    /// `D` of Eq. (4) (N s/m).
    pub(crate) damping: f64,
    pub(crate) solver: Solver,
    /// The passes of a solver that has them.
    pub(crate) passes: u32,
}

impl ElasticModel for ShapeBy {
    fn stiffness(&self) -> f64 {
        self.stiffness
    }

    fn describe(&self, _: &Body) -> String {
        format!("k = {} N/m, rotations by {}", self.stiffness, self.solver.name())
    }

    fn start(&self, body: &Body, position: &[DVec3]) -> Vec<f64> {
        let rotation = |nodes: &[u32]| {
            let rest: Vec<_> = relative(nodes, &body.rest).collect();
            optimum(moment(&rest, relative(nodes, position)), DQuat::IDENTITY).to_array()
        };
        body.elements.iter().flat_map(rotation).collect()
    }

    fn prepare(&self, body: &Arc<Body>) -> Box<dyn ForceModel> {
        let rest = body.elements.iter().flat_map(|nodes| relative(nodes, &body.rest)).collect();
        Box::new(Forces { model: self.clone(), body: Arc::clone(body), rest })
    }
}

/// The values of the nodes of an element, relative to their mean.
fn relative<'a>(nodes: &'a [u32], values: &'a [DVec3]) -> impl Iterator<Item = DVec3> + 'a {
    let of = |&node: &u32| values[node as usize];
    let mean = nodes.iter().map(of).fold(DVec3::ZERO, |sum, value| sum + value) / nodes.len() as f64;
    nodes.iter().map(move |node| of(node) - mean)
}

struct Forces {
    model: ShapeBy,
    body: Arc<Body>,
    /// `R0` of each corner (m), element after element.
    rest: Vec<DVec3>,
}

/// An element: its nodes, their places at rest relative to their mean (m), and its rotation in the memory.
type Element<'a> = (&'a [u32], &'a [DVec3], &'a [f64]);

impl Forces {
    fn elements<'a>(&'a self, memory: &'a [f64]) -> impl Iterator<Item = Element<'a>> {
        let elements = &self.body.elements;
        let of = |(at, (nodes, memory))| (nodes, &self.rest[elements.range(at)], memory);
        elements.iter().zip(memory.chunks_exact(4)).enumerate().map(of)
    }

    /// The rotation of an element from its last one.
    fn rotation(&self, (nodes, rest, last): Element<'_>, position: &[DVec3]) -> DQuat {
        let at_rest = moment(rest, relative(nodes, position));
        self.model.solver.follow(at_rest, DQuat::from_slice(last), self.model.passes)
    }

    /// α of Eq. (18) of an element (rad/s²), with the inertia of Eq. (17).
    fn residual(&self, (nodes, rest, _): Element<'_>, position: &[DVec3], rotation: DMat3) -> f64 {
        let mass = |&node: &u32| self.body.mass[node as usize];
        let inertia: f64 = nodes.iter().zip(rest).map(|(node, rest)| mass(node) * rest.length_squared()).sum();
        self.model.stiffness * torque(rotation * moment(rest, relative(nodes, position))).length() / inertia
    }
}

impl ForceModel for Forces {
    fn add_forces(&self, at: Nodes<'_>, memory: &[f64], next: &mut [f64], _: &mut Scratch, forces: &mut [DVec3]) {
        let ShapeBy { stiffness, damping, .. } = self.model;
        for (element, next) in self.elements(memory).zip(next.chunks_exact_mut(4)) {
            let (nodes, rest, _) = element;
            let rotation = self.rotation(element, at.position);
            rotation.write_to_slice(next);
            let matrix = DMat3::from_quat(rotation);
            let corners = relative(nodes, at.position).zip(relative(nodes, at.velocity));
            for ((&node, &rest), (place, velocity)) in nodes.iter().zip(rest).zip(corners) {
                forces[node as usize] -= (place - matrix * rest) * stiffness + velocity * damping;
            }
        }
    }

    fn is_damped(&self) -> bool {
        self.model.damping > 0.0
    }

    fn depends_on_history(&self) -> bool {
        self.model.solver.has_passes()
    }

    fn report(&self, at: Nodes<'_>, memory: &[f64], share: &mut Share<'_>) -> Report {
        let (mut energy, mut residual) = (0.0, 0.0f64);
        for (number, element) in self.elements(memory).enumerate() {
            let (nodes, rest, _) = element;
            let matrix = DMat3::from_quat(self.rotation(element, at.position));
            let of_corner =
                |(place, &rest): (DVec3, &DVec3)| 0.5 * self.model.stiffness * (place - matrix * rest).length_squared();
            let energies: Vec<f64> = relative(nodes, at.position).zip(rest).map(of_corner).collect();
            share(number, nodes, &energies);
            energy += energies.iter().sum::<f64>();
            residual = residual.max(self.residual(element, at.position, matrix));
        }
        Report { energy: Some(energy), residuals: vec![(Report::ROTATION, residual)] }
    }

    fn residuals(&self, position: &[DVec3], memory: &[f64]) -> Vec<f64> {
        let residual =
            |element: Element<'_>| self.residual(element, position, DMat3::from_quat(DQuat::from_slice(element.2)));
        self.elements(memory).map(residual).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use localshape::scene::{Limits, Scene};

    /// With the solver of a scene, it is the model of scenes.
    #[test]
    fn it_is_the_model_of_scenes() {
        let text = "
            time.duration = 1
            body = { lattice = { cells = [2, 1, 1], side = 0.1 }, spin = { axis = [1, 2, 3], rate = 20 } }
            run = [{ name = 'one', kernel = 'reference', model = { kind = 'shape-based', stiffness = 1e4, damping = 1, passes = 2 } }]";
        let scene = Scene::parse(text, "one", &Limits::default()).unwrap_or_else(|error| panic!("{error}"));
        let own = ShapeBy { stiffness: 1e4, damping: 1.0, solver: Solver::PRINTED, passes: 2 };
        let mut other = scene.clone();
        other.runs[0].model = Arc::new(own);
        let [mut one, mut other] = [&scene, &other].map(|scene| scene.world(0));
        for _ in 0..50 {
            let before = [&one, &other].map(|world| world.state().position.clone());
            one.advance(1);
            other.advance(1);
            for (one, other) in one.state().position.iter().zip(&other.state().position) {
                assert!(one.distance(*other) < 1e-13, "{one} {other}");
            }
            assert!((one.diagnostics().elastic - other.diagnostics().elastic).abs() < 1e-10);
            let residuals = [one.residuals(&before[0]), other.residuals(&before[1])];
            assert!(
                residuals[0].iter().zip(&residuals[1]).all(|(one, other)| (one - other).abs() < 1e-7),
                "{residuals:?}"
            );
        }
    }
}
