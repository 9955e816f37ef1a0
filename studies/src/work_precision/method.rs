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
pub(crate) struct Method {
    /// An integrator of scenes, or one with the same requirements on forces as the composition.
    integrator: Integrator,
    /// A symplectic composition that scenes do not offer, with its name.
    composition: Option<(&'static str, Composition)>,
    /// A reading of the paper for rotations.
    pub(crate) reading: Option<RotationReading>,
    /// The approximate number of evaluations of the forces in a step.
    evaluations: f64,
    /// The name of the methods of its order.
    pub(crate) family: &'static str,
}

impl Method {
    /// The default of scenes.
    pub(crate) const DEFAULT: Self = Self::of_scenes(Integrator::SemiImplicitEuler, 1.0, "order 1");
    pub(crate) const VERLET: Self = Self::of_scenes(Integrator::VelocityVerlet, 1.0, "order 2");
    pub(crate) const RUNGE_KUTTA: Self = Self::of_scenes(Integrator::RungeKutta, 4.0, "order 4");
    pub(crate) const PEFRL: Self = Self::of_scenes(Integrator::Pefrl, 4.0, "order 4");
    pub(crate) const DORMAND_PRINCE: Self = Self::of_scenes(Integrator::DormandPrince, 6.0, "order 5");
    pub(crate) const FOREST_RUTH: Self = Self::composed("forest-ruth", methods::FOREST_RUTH, 3.0, "order 4");
    pub(crate) const BLANES_MOAN: Self = Self::composed("blanes-moan", methods::BLANES_MOAN, 14.0, "order 6");
    pub(crate) const KAHAN_LI: Self = Self::composed("kahan-li", methods::KAHAN_LI, 17.0, "order 8");

    /// All methods.
    pub(crate) const ALL: [Self; 13] = [
        Self::DEFAULT,
        Self::of_scenes(Integrator::ExplicitEuler, 1.0, "order 1"),
        Self::of_scenes(Integrator::BackwardEuler, 40.0, "order 1"),
        Self::VERLET,
        Self::of_reading(RotationReading::Arctangent),
        Self::of_reading(RotationReading::VectorLength),
        Self::of_reading(RotationReading::LinearUpdate),
        Self::FOREST_RUTH,
        Self::RUNGE_KUTTA,
        Self::PEFRL,
        Self::BLANES_MOAN,
        Self::KAHAN_LI,
        Self::DORMAND_PRINCE,
    ];

    const fn of_scenes(integrator: Integrator, evaluations: f64, family: &'static str) -> Self {
        Self { integrator, composition: None, reading: None, evaluations, family }
    }

    const fn composed(name: &'static str, composition: Composition, evaluations: f64, family: &'static str) -> Self {
        Self { composition: Some((name, composition)), ..Self::of_scenes(Integrator::Pefrl, evaluations, family) }
    }

    /// Velocity Verlet with a reading of the paper for rotations.
    pub(crate) const fn of_reading(reading: RotationReading) -> Self {
        Self { reading: Some(reading), ..Self::VERLET }
    }

    /// The names of the integrator and of a solver of rotations that is not the default; as in scenes, if they are
    /// there.
    pub(crate) fn names(self) -> [String; 2] {
        let integrator = self.composition.map_or_else(|| typed(&self.integrator), |(name, _)| name.to_owned());
        [integrator, self.reading.map_or_else(String::new, |reading| typed(&reading))]
    }

    /// Both names.
    pub(crate) fn name(self) -> String {
        let [integrator, rotation] = self.names();
        if rotation.is_empty() { integrator } else { format!("{integrator}, {rotation}") }
    }

    /// Whether it chooses its steps by a tolerance.
    pub(crate) fn is_adaptive(self) -> bool {
        self == Self::DORMAND_PRINCE
    }

    /// The model of a run, with the rotations of this method; `None` if the model has no choice of them.
    pub(crate) fn model(self, subject: &Subject) -> Option<Arc<dyn ElasticModel>> {
        let model = &subject.scene.runs[subject.run].models[0];
        let with = |rotation| with_rotation(&**model, subject.body(), rotation);
        match self.reading {
            Some(rotation) => with(rotation),
            None => with(RotationReading::Robust).or_else(|| Some(Arc::clone(model))),
        }
    }

    /// Why it cannot advance a model; `None` if it can.
    pub(crate) fn refusal(self, subject: &Subject, model: &dyn ElasticModel) -> Option<&'static str> {
        self.integrator.refusal(model, subject.body(), 0.0)
    }

    /// Whether it has vectorised steps for a model.
    pub(crate) fn is_fast(self, model: &dyn ElasticModel) -> bool {
        self.composition.is_none() && Kernel::of(model, self.integrator) == Kernel::Fast
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
        let power = libm::round(libm::log2(evaluations / method.evaluations)).max(0.0);
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
        let Method { integrator, composition, .. } = self.method;
        let run = &mut scene.runs[subject.run];
        run.kernel = if self.method.is_fast(model.as_ref()) { Kernel::Fast } else { Kernel::Reference };
        run.step = scene.duration / self.steps as f64;
        (run.integrator, run.tolerance, run.models[0]) = (integrator, Some(self.tolerance), model);
        let mut world = scene.world(subject.run);
        if let Some((_, composition)) = composition {
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
