//! The compared methods, and one run of a scene by one of them, with evaluations counted.

use super::Subject;
use super::count::Counting;
use crate::methods;
use glam::DVec3;
use localshape::internals::typed;
use localshape::sim::integrate::{ByComposition, Composition};
use localshape::sim::model::shape_based::RotationReading;
use localshape::sim::model::{ElasticModel, ModelParameters, Setting};
use localshape::sim::{Body, Integrator, Kernel, Status, World};
use std::sync::Arc;

/// An integrator, with a solver of rotations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Method {
    /// An integrator of scenes.
    Scene(Integrator),
    /// Velocity Verlet with a reading of the paper for rotations.
    Reading(RotationReading),
    /// A symplectic composition that scenes do not offer, by its name.
    Composed(&'static str, Composition),
}

impl Method {
    /// The default of scenes.
    pub(crate) const DEFAULT: Self = Self::Scene(Integrator::SemiImplicitEuler);
    pub(crate) const VERLET: Self = Self::Scene(Integrator::VelocityVerlet);
    pub(crate) const PEFRL: Self = Self::Scene(Integrator::Pefrl);
    pub(crate) const DORMAND_PRINCE: Self = Self::Scene(Integrator::DormandPrince);
    /// Of fourth, of sixth and of eighth order.
    pub(crate) const FOREST_RUTH: Self = Self::Composed("forest-ruth", methods::FOREST_RUTH);
    pub(crate) const BLANES_MOAN: Self = Self::Composed("blanes-moan", methods::BLANES_MOAN);
    pub(crate) const KAHAN_LI: Self = Self::Composed("kahan-li", methods::KAHAN_LI);

    /// All methods.
    pub(crate) const ALL: [Self; 13] = [
        Self::DEFAULT,
        Self::Scene(Integrator::ExplicitEuler),
        Self::Scene(Integrator::BackwardEuler),
        Self::VERLET,
        Self::Reading(RotationReading::Arctangent),
        Self::Reading(RotationReading::VectorLength),
        Self::Reading(RotationReading::LinearUpdate),
        Self::FOREST_RUTH,
        Self::Scene(Integrator::RungeKutta),
        Self::PEFRL,
        Self::BLANES_MOAN,
        Self::KAHAN_LI,
        Self::DORMAND_PRINCE,
    ];

    /// The names of the integrator and of a solver of rotations that is not the default; as in scenes, if they are
    /// there.
    pub(crate) fn names(self) -> [String; 2] {
        let (integrator, rotation) = match self {
            Self::Scene(integrator) => (typed(&integrator), String::new()),
            Self::Reading(rotation) => (typed(&Integrator::VelocityVerlet), typed(&rotation)),
            Self::Composed(name, _) => (name.to_owned(), String::new()),
        };
        [integrator, rotation]
    }

    /// Both names.
    pub(crate) fn name(self) -> String {
        let [integrator, rotation] = self.names();
        if rotation.is_empty() { integrator } else { format!("{integrator}, {rotation}") }
    }

    /// The approximate number of evaluations of the forces in a step.
    fn evaluations(self) -> f64 {
        match self {
            Self::Scene(Integrator::Pefrl | Integrator::RungeKutta) => 4.0,
            Self::Scene(Integrator::DormandPrince) => 6.0,
            Self::Scene(Integrator::BackwardEuler) => 40.0,
            Self::Scene(_) | Self::Reading(_) => 1.0,
            Self::Composed(_, composition) => composition.evaluations() as f64,
        }
    }

    /// Whether it chooses its steps by a tolerance.
    pub(crate) fn is_adaptive(self) -> bool {
        self == Self::DORMAND_PRINCE
    }

    /// The integrator of scenes, or one with the same requirements on forces together with the composition.
    fn integrator(self) -> (Integrator, Option<Composition>) {
        match self {
            Self::Scene(integrator) => (integrator, None),
            Self::Reading(_) => (Integrator::VelocityVerlet, None),
            Self::Composed(_, composition) => (Integrator::Pefrl, Some(composition)),
        }
    }

    /// The model of a run, with the rotations of this method; `None` if the model has no choice of them.
    pub(crate) fn model(self, subject: &Subject) -> Option<Arc<dyn ElasticModel>> {
        let model = &subject.scene.runs[subject.run].models[0];
        let with = |rotation| with_rotation(&**model, subject.body(), rotation);
        match self {
            Self::Reading(rotation) => with(rotation),
            _ => with(RotationReading::Robust).or_else(|| Some(Arc::clone(model))),
        }
    }

    /// Why it cannot advance a model; `None` if it can.
    pub(crate) fn refusal(self, subject: &Subject, model: &dyn ElasticModel) -> Option<&'static str> {
        self.integrator().0.refusal(model, subject.body(), 0.0)
    }

    /// Whether it has vectorised steps for a model.
    pub(crate) fn is_fast(self, model: &dyn ElasticModel) -> bool {
        let (integrator, composition) = self.integrator();
        composition.is_none() && Kernel::of(model, integrator) == Kernel::Fast
    }
}

/// A model with its rotations computed by another method; `None` if it has no choice of them.
fn with_rotation(model: &dyn ElasticModel, body: &Body, rotation: RotationReading) -> Option<Arc<dyn ElasticModel>> {
    let mut properties = model.properties(body);
    let own = properties.parameters.iter_mut().find(|parameter| parameter.name == "rotation")?;
    own.value = Setting::Choice(rotation.name());
    properties.parameters.retain(|parameter| parameter.name != "passes" || rotation.has_passes());
    ModelParameters::of(&properties)?.resolve(body, None).ok()
}

/// The number of moments of a run, without its start, at which errors are measured: a power of two.
pub(crate) const MOMENTS: usize = 128;

/// One method with one step or tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Attempt {
    pub(super) method: Method,
    /// The number of steps. An adaptive method has a step for each moment, with substeps between.
    pub(super) steps: u64,
    pub(super) tolerance: f64,
}

/// How a run ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    Reached,
    Diverged,
    /// After too many evaluations.
    GivenUp,
}

impl Attempt {
    /// A run is stopped after this many times the expected evaluations. From one tolerance to the next, evaluations
    /// grow by a factor of 2.5 in free motion and 10 in contact, so this does not cut a series short. But an adaptive
    /// method may take millions of substeps at its first tolerance, if a body rests on something.
    const PATIENCE: f64 = 16.0;

    /// An attempt with about this many evaluations, or with the tolerance of an adaptive method. The number of steps is
    /// a power of two: runs with few steps have all their states at [`MOMENTS`], and runs with many steps have a state
    /// at each.
    pub(super) fn new(method: Method, evaluations: f64, tolerance: f64) -> Self {
        let power = libm::round(libm::log2(evaluations / method.evaluations())).max(0.0);
        let steps = if method.is_adaptive() { MOMENTS as u64 } else { 1 << power as u32 };
        Self { method, steps, tolerance }
    }

    /// Half as many steps again, which is not a power of two, and at least one and a half for each moment.
    pub(super) fn finer(self) -> Self {
        let steps = if self.method.is_adaptive() { self.steps } else { self.steps.max(2 * MOMENTS as u64) / 2 * 3 };
        Self { steps, ..self }
    }

    /// The run of a scene at its start, with another model.
    pub(super) fn world(self, subject: &Subject, model: Arc<dyn ElasticModel>) -> World {
        let mut scene = subject.scene.clone();
        let (integrator, composition) = self.method.integrator();
        let run = &mut scene.runs[subject.run];
        run.kernel = if self.method.is_fast(model.as_ref()) { Kernel::Fast } else { Kernel::Reference };
        run.step = scene.duration / self.steps as f64;
        (run.integrator, run.tolerance, run.models[0]) = (integrator, Some(self.tolerance), model);
        let mut world = scene.world(subject.run);
        if let Some(composition) = composition {
            world.set_method(Box::new(ByComposition::new(composition)));
        }
        world
    }

    /// Makes the run and returns its end and the number of evaluations; `most` should suffice. Calls `look` with the
    /// number of each moment at which the run has a state, and with the positions there (m).
    pub(super) fn run(
        self,
        subject: &Subject,
        model: &Arc<dyn ElasticModel>,
        most: f64,
        mut look: impl FnMut(usize, &[DVec3]),
    ) -> (End, u64) {
        let counting = Counting::new(Arc::clone(model), (Self::PATIENCE * most) as u64);
        let mut world = self.world(subject, Arc::new(counting.clone()));
        let looks = self.steps.min(MOMENTS as u64);
        for number in 1..=looks as usize {
            world.advance(self.steps / looks);
            if world.status() != Status::Ok {
                let end = if counting.is_exhausted() { End::GivenUp } else { End::Diverged };
                return (end, counting.count());
            }
            look(number * MOMENTS / looks as usize - 1, &world.state().position);
        }
        (End::Reached, counting.count())
    }
}

#[cfg(test)]
#[path = "../../tests/inside/work_precision_method.rs"]
mod tests;
