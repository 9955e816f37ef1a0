//! A model that counts how often its forces are evaluated.

use crate::sim::body::Body;
use crate::sim::model::{ElasticModel, ForceModel, Report, Scratch, Share};
use crate::sim::state::Nodes;
use glam::DVec3;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Another model, and the number of evaluations. It has the reference code only.
#[derive(Clone, Debug)]
pub(super) struct Counting {
    model: Arc<dyn ElasticModel>,
    count: Arc<AtomicU64>,
}

impl Counting {
    pub(super) fn new(model: Arc<dyn ElasticModel>) -> Self {
        Self { model, count: Arc::default() }
    }

    /// The number of evaluations so far.
    pub(super) fn count(&self) -> u64 {
        self.count.load(Ordering::Relaxed)
    }
}

impl ElasticModel for Counting {
    fn stiffness(&self) -> f64 {
        self.model.stiffness()
    }

    fn shortest_period(&self, body: &Body) -> f64 {
        self.model.shortest_period(body)
    }

    fn describe(&self, body: &Body) -> String {
        self.model.describe(body)
    }

    fn start(&self, body: &Body, position: &[DVec3]) -> Vec<f64> {
        self.model.start(body, position)
    }

    fn prepare(&self, body: &Arc<Body>) -> Box<dyn ForceModel> {
        Box::new(CountingForces { forces: self.model.prepare(body), count: Arc::clone(&self.count) })
    }
}

struct CountingForces {
    forces: Box<dyn ForceModel>,
    count: Arc<AtomicU64>,
}

impl ForceModel for CountingForces {
    fn add_forces(&self, at: Nodes<'_>, memory: &[f64], next: &mut [f64], scratch: &mut Scratch, forces: &mut [DVec3]) {
        self.count.fetch_add(1, Ordering::Relaxed);
        self.forces.add_forces(at, memory, next, scratch, forces);
    }

    fn is_damped(&self) -> bool {
        self.forces.is_damped()
    }

    fn depends_on_history(&self) -> bool {
        self.forces.depends_on_history()
    }

    fn report(&self, at: Nodes<'_>, memory: &[f64], share: &mut Share<'_>) -> Report {
        self.forces.report(at, memory, share)
    }
}
