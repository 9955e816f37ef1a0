//! Runs in which the damping as printed brakes a body that turns.

use super::{Run, Scene};
use crate::reading::words::quoted;
use crate::sim::model::shape_based::DampingReading;
use crate::sim::model::{ElasticModel, Setting};
use crate::sim::{Body, Motion, Obstacle, Shape};
use glam::DVec3;

impl Scene {
    /// Why a body of a run will turn while damping brakes every rotation; `None` if no body does, or none is damped so.
    pub(crate) fn braked(&self, run: &Run) -> Option<&'static str> {
        let mut parts = run.models_and_bodies().enumerate().filter(|(_, (model, body))| brakes_rotation(*model, body));
        parts.find_map(|(body, _)| self.turning(run, body))
    }

    /// The message and the remedy for a run whose damping brakes a body that turns, beside a run whose does not.
    pub(super) fn brakes_rotation(&self, number: usize) -> Option<[String; 2]> {
        let run = &self.runs[number];
        let reason = self.braked(run)?;
        let mut all = self.runs.iter().flat_map(Run::models_and_bodies);
        let is_compared = all.any(|(model, body)| !brakes_rotation(model, body));
        is_compared.then(|| {
            let name = quoted(&run.name);
            let message = format!("the damping of {name} also brakes rotation, and its body will turn: {reason}");
            let help = "write damping_of = \"deformation\" to compare with the other runs, or damping_of = \"relative-motion\" to keep the paper's damping";
            [message, help.to_owned()]
        })
    }

    /// Why a body of a run will turn, as far as the scene shows.
    fn turning(&self, run: &Run, body: usize) -> Option<&'static str> {
        /// The least part of a speed, and the least slope, that counts.
        const PART: f64 = 0.1;
        let (nodes, of) = (run.bodies.nodes(body), &run.bodies.bodies()[body]);
        let (position, velocity) = (&run.initial.position[nodes.clone()], &run.initial.velocity[nodes.clone()]);
        let mass: f64 = of.mass().iter().sum();
        let mean =
            |of_node: &[DVec3]| of_node.iter().zip(of.mass()).map(|(&at, mass)| at * *mass).sum::<DVec3>() / mass;
        let (centre, drift) = (mean(position), mean(velocity));
        let (mut momentum, mut size) = (DVec3::ZERO, 0.0);
        for ((&at, &speed), &mass) in position.iter().zip(velocity).zip(of.mass()) {
            momentum += (at - centre).cross(speed - drift) * mass;
            size += (at - centre).length() * (speed - drift).length() * mass;
        }
        if momentum.length() > PART * size && size > 0.0 {
            return Some("it starts with a spin");
        }
        let own = |node: &u32| nodes.contains(&(*node as usize));
        let gripping: Vec<_> = run.grips.iter().filter(|grip| grip.nodes.iter().any(own)).collect();
        let down = self.gravity.normalize_or_zero();
        if let [grip] = gripping[..]
            && grip.motion == Motion::Still
            && grip.holds(0.0)
            && grip.holds(self.duration)
            && down != DVec3::ZERO
            && self.obstacles.is_empty()
        {
            return Some("it is held at one side");
        }
        let slopes = self.obstacles.iter().flat_map(normals).any(|normal| {
            let up = -normal.dot(down);
            up > PART && normal.cross(down).length() > PART
        });
        if slopes {
            return Some("there is a slope");
        }
        let rough = self.obstacles.iter().filter(|obstacle| obstacle.friction > 0.0).flat_map(normals);
        let is_oblique = rough.into_iter().any(|normal| {
            let (into, along) = (-normal.dot(drift), (drift - normal * normal.dot(drift)).length());
            // Gravity makes it faster.
            (into > 0.0 || normal.dot(down) < 0.0) && along > PART * drift.length().max(into) && along > 0.0
        });
        is_oblique.then_some("it meets an obstacle at an angle")
    }
}

/// Whether the damping of a model brakes the rotation of a rigid body.
pub(crate) fn brakes_rotation(model: &dyn ElasticModel, body: &Body) -> bool {
    let properties = model.properties(body);
    let relative = Setting::Choice(DampingReading::RelativeMotion.name());
    properties.damping > 0.0 && properties.get("damping_of") == Some(relative)
}

/// The normals of the flat faces of an obstacle.
fn normals(obstacle: &Obstacle) -> Vec<DVec3> {
    match obstacle.shape {
        Shape::Floor { normal, .. } | Shape::Plate { normal, .. } => vec![normal],
        Shape::Box { rotation, .. } => {
            [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [rotation * axis, -(rotation * axis)]).collect()
        }
        Shape::Sphere { .. } | Shape::Capsule { .. } => Vec::new(),
    }
}
