//! A model that counts how often its forces are evaluated, and ends runs that evaluate them too often.

use glam::DVec3;
use localshape::sim::model::{ElasticModel, ForceModel, Properties, Report, Scratch, Share};
use localshape::sim::{Body, Nodes};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Another model, and the number of evaluations. It has the reference code only.
///
/// After `most` evaluations its forces are NaN, so that the run diverges: an adaptive method with unlimited substeps
/// can be stopped in no other way.
#[derive(Clone, Debug)]
pub(super) struct Counting {
    model: Arc<dyn ElasticModel>,
    count: Arc<AtomicU64>,
    most: u64,
}

impl Counting {
    pub(super) fn new(model: Arc<dyn ElasticModel>, most: u64) -> Self {
        Self { model, count: Arc::default(), most }
    }

    /// The number of evaluations so far.
    pub(super) fn count(&self) -> u64 {
        self.count.load(Ordering::Relaxed)
    }

    /// Whether there were too many.
    pub(super) fn is_exhausted(&self) -> bool {
        self.count() > self.most
    }
}

impl ElasticModel for Counting {
    fn properties(&self, body: &Body) -> Properties {
        self.model.properties(body)
    }

    fn start(&self, body: &Body, position: &[DVec3]) -> Vec<f64> {
        self.model.start(body, position)
    }

    fn prepare(&self, body: &Arc<Body>) -> Box<dyn ForceModel> {
        Box::new(CountingForces { forces: self.model.prepare(body), counting: self.clone() })
    }
}

struct CountingForces {
    forces: Box<dyn ForceModel>,
    counting: Counting,
}

impl ForceModel for CountingForces {
    fn add_forces(&self, at: Nodes<'_>, memory: &[f64], next: &mut [f64], scratch: &mut Scratch, forces: &mut [DVec3]) {
        self.counting.count.fetch_add(1, Ordering::Relaxed);
        self.forces.add_forces(at, memory, next, scratch, forces);
        if self.counting.is_exhausted() {
            forces.fill(DVec3::NAN);
        }
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
