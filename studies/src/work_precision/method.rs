//! The methods that are compared, and one run of a scene by one of them, with evaluations counted.

use super::Subject;
use super::count::Counting;
use crate::methods::{BLANES_MOAN, FOREST_RUTH, QuinlanTremaine};
use glam::DVec3;
use localshape::sim::integrate::{self, ByComposition};
use localshape::sim::model::ElasticModel;
use localshape::sim::world::{Stepping, Surroundings};
use localshape::sim::{Integrator, Kernel, Status, World};
use std::sync::Arc;

/// An integrator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Method {
    /// One of scenes.
    Scene(Integrator),
    /// Forest–Ruth: of fourth order and symplectic, with three evaluations a step.
    ForestRuth,
    /// The Runge–Kutta–Nyström method of Blanes and Moan: of sixth order and symplectic, with 14 evaluations a step.
    BlanesMoan,
    /// A symmetric multistep method of eighth order, with one evaluation a step.
    QuinlanTremaine,
}

impl Method {
    /// The default of scenes.
    pub(crate) const DEFAULT: Self = Self::Scene(Integrator::SemiImplicitEuler);
    pub(crate) const VERLET: Self = Self::Scene(Integrator::VelocityVerlet);
    pub(crate) const PEFRL: Self = Self::Scene(Integrator::Pefrl);
    pub(crate) const RUNGE_KUTTA: Self = Self::Scene(Integrator::RungeKutta);
    pub(crate) const DORMAND_PRINCE: Self = Self::Scene(Integrator::DormandPrince);

    /// All of them.
    pub(crate) const ALL: [Self; 10] = [
        Self::DEFAULT,
        Self::Scene(Integrator::ExplicitEuler),
        Self::Scene(Integrator::BackwardEuler),
        Self::VERLET,
        Self::ForestRuth,
        Self::RUNGE_KUTTA,
        Self::PEFRL,
        Self::BlanesMoan,
        Self::DORMAND_PRINCE,
        Self::QuinlanTremaine,
    ];

    /// Its name; that in scenes, if it has one.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::ForestRuth => "forest-ruth",
            Self::BlanesMoan => "blanes-moan",
            Self::QuinlanTremaine => "quinlan-tremaine",
            Self::Scene(Integrator::SemiImplicitEuler) => "semi-implicit-euler",
            Self::Scene(Integrator::ExplicitEuler) => "explicit-euler",
            Self::Scene(Integrator::BackwardEuler) => "backward-euler",
            Self::Scene(Integrator::VelocityVerlet) => "velocity-verlet",
            Self::Scene(Integrator::Pefrl) => "pefrl",
            Self::Scene(Integrator::RungeKutta) => "runge-kutta",
            Self::Scene(_) => "dormand-prince",
        }
    }

    /// The evaluations of the forces in a step, or about that.
    fn evaluations(self) -> f64 {
        match self {
            Self::ForestRuth => 3.0,
            Self::BlanesMoan => 14.0,
            Self::Scene(Integrator::Pefrl | Integrator::RungeKutta) => 4.0,
            Self::Scene(Integrator::DormandPrince) => 6.0,
            Self::Scene(Integrator::BackwardEuler) => 40.0,
            Self::QuinlanTremaine | Self::Scene(_) => 1.0,
        }
    }

    /// Whether it finds its steps from a tolerance.
    pub(crate) fn is_adaptive(self) -> bool {
        self == Self::DORMAND_PRINCE
    }

    /// Why it cannot advance a model; `None` if it can.
    pub(crate) fn refusal(self, subject: &Subject, model: &dyn ElasticModel) -> Option<&'static str> {
        let integrator = match self {
            Self::Scene(integrator) => integrator,
            // What they need of forces is what this one needs.
            Self::ForestRuth | Self::BlanesMoan | Self::QuinlanTremaine => Integrator::Pefrl,
        };
        integrator.refusal(|| model.prepare(&subject.scene.body))
    }
}

/// The number of moments of a run, without its start, at which errors are measured: a power of two.
pub(crate) const MOMENTS: usize = 128;

/// One method with one step or tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Way {
    pub(super) method: Method,
    /// The number of steps. An adaptive method has that of the moments, and substeps between them.
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

impl Way {
    /// A run is given up after so many times the evaluations that it should have. From one tolerance to the next they grow by a factor
    /// of 2.5 in free motion and 10 in contact, so a series is not cut short by this; but an adaptive method may take millions of
    /// substeps at its first tolerance, where a body rests on something.
    const PATIENCE: f64 = 16.0;

    /// With about so many evaluations, or the tolerance of an adaptive method. The number of steps is a power of two, so that all
    /// states of runs with few steps are at [`MOMENTS`], and runs with many steps have a state at each.
    pub(super) fn new(method: Method, evaluations: f64, tolerance: f64) -> Self {
        let power = libm::round(libm::log2(evaluations / method.evaluations())).max(0.0);
        let steps = if method.is_adaptive() { MOMENTS as u64 } else { 1 << power as u32 };
        Self { method, steps, tolerance }
    }

    /// The same with half as many steps again, which is no power of two, and at least those of the moments.
    pub(super) fn finer(self) -> Self {
        let steps = if self.method.is_adaptive() { self.steps } else { self.steps.max(2 * MOMENTS as u64) / 2 * 3 };
        Self { steps, ..self }
    }

    /// The run of a scene at its start, with another model.
    pub(super) fn world(self, subject: &Subject, model: &dyn ElasticModel) -> World {
        let scene = &subject.scene;
        let around =
            Surroundings { gravity: scene.gravity, obstacles: scene.obstacles.clone(), grips: scene.grips.clone() };
        let (integrator, own): (_, Option<Box<dyn integrate::Method>>) = match self.method {
            Method::Scene(integrator) => (integrator, None),
            Method::ForestRuth => (Integrator::default(), Some(Box::new(ByComposition::new(FOREST_RUTH)))),
            Method::BlanesMoan => (Integrator::default(), Some(Box::new(ByComposition::new(BLANES_MOAN)))),
            Method::QuinlanTremaine => (Integrator::default(), Some(Box::new(QuinlanTremaine::new()))),
        };
        let kernel = if own.is_some() { Kernel::Reference } else { Kernel::of(model, integrator) };
        let step = scene.duration / self.steps as f64;
        let stepping = Stepping { integrator, step, tolerance: self.tolerance, kernel };
        let mut world = World::new(&scene.body, scene.initial.clone(), model, around, stepping);
        if let Some(method) = own {
            world.set_method(method);
        }
        world
    }

    /// Makes the run, calls `look` with the number of each moment at which it has a state and the positions there (m), and returns its
    /// end and the number of evaluations, of which there should be no more than `most`.
    pub(super) fn run(
        self,
        subject: &Subject,
        model: &Arc<dyn ElasticModel>,
        most: f64,
        mut look: impl FnMut(usize, &[DVec3]),
    ) -> (End, u64) {
        let counting = Counting::new(Arc::clone(model), (Self::PATIENCE * most) as u64);
        let mut world = self.world(subject, &counting);
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
mod tests {
    use super::*;
    use localshape::{Limits, Scene};

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
        let way = Way::new(Method::DORMAND_PRINCE, 1e3, 1e-9);
        let (end, evaluations) = way.run(&subject, &models[0].1, 1e3, |_, _| ());
        assert!(end == End::GivenUp && (16_000..17_000).contains(&evaluations), "{evaluations}");
    }

    #[test]
    fn all_runs_have_their_states_at_the_same_moments() {
        let numbers = |steps: u64| {
            let way = Way { steps, ..Way::new(Method::DEFAULT, 1.0, 1.0) };
            let mut numbers = Vec::new();
            let subject = &super::super::usual()[1];
            way.run(subject, &subject.models()[0].1, f64::INFINITY, |number, _| numbers.push(number));
            numbers
        };
        assert_eq!(numbers(4096), (0..MOMENTS).collect::<Vec<_>>());
        assert_eq!(numbers(Way::new(Method::DEFAULT, 4096.0, 1.0).finer().steps), (0..MOMENTS).collect::<Vec<_>>());
        assert_eq!(numbers(64), (0..MOMENTS).skip(1).step_by(2).collect::<Vec<_>>());
    }
}
