//! One run of a scene, with evaluations counted.

use super::Subject;
use super::count::Counting;
use crate::sim::integrate::Integrator;
use crate::sim::model::ElasticModel;
use crate::sim::snapshot::Status;
use crate::sim::world::{Kernel, Stepping, Surroundings, World};
use glam::DVec3;
use std::sync::Arc;

/// One way to advance a scene from its start to its end.
#[derive(Clone, Copy)]
pub(super) struct Way {
    pub(super) integrator: Integrator,
    /// The number of steps, 1 for an adaptive method.
    pub(super) steps: u64,
    pub(super) tolerance: f64,
}

/// How a run ends.
pub(super) enum End {
    /// The positions (m).
    Reached(Vec<DVec3>),
    Diverged,
    /// After too many evaluations.
    GivenUp,
}

impl Way {
    /// A run is given up after so many times the evaluations that it should have. From one tolerance to the next they grow by a factor
    /// of 2.5 in free motion and 10 in contact, so a series is not cut short by this; but an adaptive method may take millions of
    /// substeps at its first tolerance, where a body rests on something.
    const PATIENCE: f64 = 16.0;

    /// With about so many evaluations, or the tolerance of an adaptive method.
    pub(super) fn new((integrator, stages): (Integrator, f64), evaluations: f64, tolerance: f64) -> Self {
        let steps = if integrator.is_adaptive() { 1 } else { (evaluations / stages).ceil().max(1.0) as u64 };
        Self { integrator, steps, tolerance }
    }

    /// The run of a scene at its start, with another model.
    pub(super) fn world(self, subject: &Subject, model: &dyn ElasticModel) -> World {
        let scene = &subject.scene;
        let surroundings =
            Surroundings { gravity: scene.gravity, obstacles: scene.obstacles.clone(), grips: scene.grips.clone() };
        let Self { integrator, steps, tolerance } = self;
        let step = scene.duration / steps as f64;
        let stepping = Stepping { integrator, step, tolerance, kernel: Kernel::of(model, integrator) };
        World::new(&scene.body, scene.initial.clone(), model, surroundings, stepping)
    }

    /// The end, and the number of evaluations, of which there should be no more than `most`.
    pub(super) fn run(self, subject: &Subject, model: &Arc<dyn ElasticModel>, most: f64) -> (End, u64) {
        let counting = Counting::new(Arc::clone(model), (Self::PATIENCE * most) as u64);
        let mut world = self.world(subject, &counting);
        world.advance(self.steps);
        let end = match world.status() {
            Status::Ok => End::Reached(world.state().position.clone()),
            Status::Diverged(_) if counting.is_exhausted() => End::GivenUp,
            Status::Diverged(_) => End::Diverged,
        };
        (end, counting.count())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Limits, Scene};

    /// A body that rests on a floor: nodes rebound again and again, and an adaptive method takes ever shorter substeps.
    #[test]
    fn a_run_that_takes_far_too_many_evaluations_is_given_up() {
        let rests = "
            gravity = [0, -9.8, 0]
            time.duration = 0.5
            body = { lattice = { cells = [1, 1, 1], side = 0.1 }, lowest = 0 }
            obstacle = [{ kind = 'floor', restitution = 0.5 }]
            run = [{ name = 'cube', model = { kind = 'shape-based', stiffness = 1e4, damping_ratio = 0.1 } }]
        ";
        let scene = Scene::parse(rests, "one.toml", &Limits::default()).unwrap();
        let subject = Subject { name: "one".to_owned(), scene, run: 0 };
        let models = subject.models();
        let way = Way::new((Integrator::DormandPrince, 6.0), 1e3, 1e-9);
        let (end, evaluations) = way.run(&subject, &models[0].1, 1e3);
        assert!(matches!(end, End::GivenUp) && (16_000..17_000).contains(&evaluations), "{evaluations}");
    }
}
