//! The integrators: the error of positions at the end of a run against evaluations of the forces and time, for steps and
//! tolerances over decades, and with each solver of rotations.
//!
//! The reference is computed by two different methods with small steps; how far apart they are is its own error.
//! Evaluations are counted by running a model that counts them; times are those of the fastest code of each method. The runs
//! take turns, in an order that is rotated, and each time is the median of its turns. Processor time is measured, or wall time if
//! the system does not provide it.

mod count;
mod reference;
mod scenes;
mod text;
mod way;

use crate::output::Clock;
use crate::scene::Scene;
use crate::sim::body::Dimension;
use crate::sim::integrate::Integrator;
use crate::sim::model::ElasticModel;
use crate::sim::model::shape_based::{RotationReading, ShapeBased};
use crate::sim::world::Kernel;
use crate::table::{Spread, Watch, take_turns};
use count::Counting;
use reference::{farthest, reference};
use std::sync::Arc;
use way::{End, Way};

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Protocol {
    /// The most evaluations in a run, about.
    pub(crate) evaluations: u32,
    /// The longest run (s), about, which limits the evaluations of large bodies.
    pub(crate) seconds: f64,
    /// The number of turns of each run.
    pub(crate) rounds: u32,
}

impl Protocol {
    /// Less than five minutes for the scenes of this module.
    pub(crate) const USUAL: Self = Self { evaluations: 65_536, seconds: 0.4, rounds: 3 };
    /// For smaller errors and steadier times.
    pub(crate) const FULL: Self = Self { evaluations: 524_288, seconds: 4.0, rounds: 9 };

    /// What [`measure`] reports in all: the turns, if nothing diverges, and one more for each way to advance a run.
    pub(crate) fn work(&self, subjects: &[Subject]) -> u64 {
        let series =
            |subject: &Subject| (0..subject.models().len()).map(|number| Series::of(number).count).sum::<usize>();
        let ways = INTEGRATORS.len() * subjects.iter().map(series).sum::<usize>();
        ways as u64 * u64::from(self.rounds + 1)
    }
}

/// All integrators, with the number of evaluations in a step, or about that.
const INTEGRATORS: [(Integrator, f64); 10] = [
    (Integrator::SemiImplicitEuler, 1.0),
    (Integrator::ExplicitEuler, 1.0),
    (Integrator::BackwardEuler, 40.0),
    (Integrator::VelocityVerlet, 1.0),
    (Integrator::ForestRuth, 3.0),
    (Integrator::RungeKutta, 4.0),
    (Integrator::Pefrl, 4.0),
    (Integrator::BlanesMoan, 14.0),
    (Integrator::DormandPrince, 6.0),
    (Integrator::QuinlanTremaine, 1.0),
];
/// The solvers of rotations. With the first one all steps are tried.
const SOLVERS: [RotationReading; 11] = [
    RotationReading::Robust,
    RotationReading::ClosedForm,
    RotationReading::Davenport,
    RotationReading::Arctangent,
    RotationReading::VectorLength,
    RotationReading::LinearUpdate,
    RotationReading::Symmetric,
    RotationReading::Cayley,
    RotationReading::Quintic,
    RotationReading::Kugelstadt,
    RotationReading::Mueller,
];

/// The steps that are tried with each integrator, each a part of the one before.
#[derive(Clone, Copy)]
struct Series {
    /// Their number.
    count: usize,
    /// That part is the inverse of this; tolerances fall by factors of `10^(ratio/2)`.
    ratio: u32,
    /// The evaluations of the finest run, as a share of the most that are allowed.
    share: f64,
}

impl Series {
    /// For the model with this number: all steps for the first, a quarter of the work for those that differ in their rotations
    /// alone.
    fn of(number: usize) -> Self {
        match number {
            0 => Self { count: 11, ratio: 2, share: 1.0 },
            _ => Self { count: 5, ratio: 4, share: 0.25 },
        }
    }
}

/// A run of a scene.
pub(crate) struct Subject {
    /// Its name.
    pub(crate) name: String,
    pub(crate) scene: Scene,
    /// The number of the run.
    pub(crate) run: usize,
}

/// A model, and the solver of its rotations if there is a choice.
type Choice = (Option<RotationReading>, Arc<dyn ElasticModel>);

impl Subject {
    /// The model with each solver of rotations; the model itself where there is no choice.
    fn models(&self) -> Vec<Choice> {
        let own = &self.scene.runs[self.run].model;
        match own.shape_based() {
            Some(shape) if self.scene.body.dimension == Dimension::Space => SOLVERS
                .map(|rotation| {
                    let model: Arc<dyn ElasticModel> = Arc::new(ShapeBased { rotation, ..shape.clone() });
                    (Some(rotation), model)
                })
                .into(),
            _ => vec![(None, Arc::clone(own))],
        }
    }

    /// Whether its rotations can be computed by several solvers.
    pub(crate) fn has_solvers(&self) -> bool {
        self.models().len() > 1
    }
}

/// The scenes that are measured if none is given.
pub(crate) fn usual() -> Vec<Subject> {
    scenes::all()
}

/// One integrator with one step or tolerance.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Measured {
    pub(crate) integrator: Integrator,
    /// The solver of rotations, where there is a choice.
    pub(crate) rotation: Option<RotationReading>,
    /// Time step (s), or the tolerance of an adaptive method.
    pub(crate) step: f64,
    /// Evaluations of the forces of the whole body, those of the start included.
    pub(crate) evaluations: u64,
    /// The greatest distance of a node from the reference at the end, as a share of the body's size; `None` if the run diverges or
    /// is given up.
    pub(crate) error: Option<f64>,
    /// Whether it was given up after too many evaluations.
    pub(crate) is_given_up: bool,
    /// Time of the run (s); NaN without an error.
    pub(crate) time: Spread,
    /// Whether the steps are vectorised.
    pub(crate) is_fast: bool,
}

/// What two methods agree on.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Reference {
    pub(crate) integrators: [Integrator; 2],
    /// The greatest distance between the two, as a share of the body's size.
    pub(crate) error: f64,
}

/// What was found for one run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Study {
    pub(crate) name: String,
    /// The body and the model.
    pub(crate) words: String,
    /// Simulated time (s), and the cycle T (s).
    pub(crate) duration: f64,
    pub(crate) cycle: f64,
    /// The reference, or why there is none.
    pub(crate) reference: Result<Reference, String>,
    /// What was measured, solver by solver and method by method, from large steps to small ones.
    pub(crate) measured: Vec<Measured>,
    /// Methods that cannot advance it with any solver, and why.
    pub(crate) refused: Vec<(Integrator, &'static str)>,
}

/// What was found on one machine.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Results {
    protocol: Protocol,
    pub(crate) studies: Vec<Study>,
    is_processor_time: bool,
}

/// Measures all scenes with the rayon thread pool of the caller, which has one thread; `None` if `watch` stops it.
pub(crate) fn measure(protocol: Protocol, subjects: &[Subject], watch: &Watch<'_>) -> Option<Results> {
    let is_processor_time = Clock::thread().spent().cpu.is_some();
    let studies = subjects.iter().map(|subject| study(protocol, subject, watch)).collect::<Option<_>>()?;
    Some(Results { protocol, studies, is_processor_time })
}

/// Why an integrator cannot advance a model; `None` if it can.
fn refusal(subject: &Subject, model: &dyn ElasticModel, integrator: Integrator) -> Option<&'static str> {
    integrator.refusal(|| model.prepare(&subject.scene.body))
}

/// The integrators that can advance a model, with their evaluations in a step.
fn accepted(subject: &Subject, model: &dyn ElasticModel) -> Vec<(Integrator, f64)> {
    INTEGRATORS.into_iter().filter(|&(one, _)| refusal(subject, model, one).is_none()).collect()
}

/// Measures one run.
fn study(protocol: Protocol, subject: &Subject, watch: &Watch<'_>) -> Option<Study> {
    let Subject { name, scene, .. } = subject;
    let models = subject.models();
    let (_, usual) = &models[0];
    let size = scene.body.extent();
    let most =
        f64::from(protocol.evaluations).min(protocol.seconds / seconds_per_evaluation(subject, usual)).max(1024.0);
    let methods = accepted(subject, usual.as_ref());
    let why = |one| refusal(subject, usual.as_ref(), one);
    let mut study = Study {
        name: name.clone(),
        words: usual.describe_fully(&scene.body),
        duration: scene.duration,
        cycle: scene.cycle(),
        reference: Err(String::new()),
        measured: Vec::new(),
        refused: INTEGRATORS.into_iter().filter_map(|(one, _)| Some((one, why(one)?))).collect(),
    };
    let (exact, reference) = match reference(subject, usual, &methods, most, size) {
        Ok(found) => found,
        Err(why) => {
            study.reference = Err(why);
            return watch(protocol.work(std::slice::from_ref(subject))).then_some(study);
        }
    };
    let error_of_reference = reference.error;
    study.reference = Ok(reference);
    let mut ways = Vec::new();
    for (number, (rotation, model)) in models.iter().enumerate() {
        let Series { count, ratio, share } = Series::of(number);
        let most = share * most;
        for method in accepted(subject, model.as_ref()) {
            for at in 0..count {
                let coarser = f64::from(ratio.pow((count - 1 - at) as u32));
                let way = Way::new(method, most / coarser, libm::pow(10.0, -1.0 - (at as u32 * ratio / 2) as f64));
                let (end, evaluations) = way.run(subject, model, most);
                let is_given_up = matches!(end, End::GivenUp);
                let error = match end {
                    End::Reached(positions) => Some(farthest(&positions, &exact) / size),
                    End::Diverged | End::GivenUp => None,
                };
                if !watch(1) {
                    return None;
                }
                // What is as good as the reference says nothing about the method.
                if error.is_some_and(|error| error < error_of_reference) {
                    break;
                }
                ways.push((way, model));
                study.measured.push(Measured {
                    integrator: method.0,
                    rotation: *rotation,
                    step: if method.0.is_adaptive() { way.tolerance } else { scene.duration / way.steps as f64 },
                    evaluations,
                    error,
                    is_given_up,
                    time: Spread::of([]),
                    is_fast: Kernel::of(model.as_ref(), method.0) == Kernel::Fast,
                });
                if evaluations as f64 > most {
                    break;
                }
            }
        }
    }
    let turns: Vec<_> = (0..ways.len()).filter(|&at| study.measured[at].error.is_some()).collect();
    // What counted evaluations has warmed caches.
    let times = take_turns(turns.len(), protocol.rounds, watch, |turn| {
        let (way, model) = ways[turns[turn]];
        let mut world = way.world(subject, model.as_ref());
        let clock = Clock::thread();
        world.advance(way.steps);
        let spent = clock.spent();
        spent.cpu.unwrap_or(spent.wall)
    })?;
    turns.into_iter().zip(times).for_each(|(at, times)| study.measured[at].time = Spread::of(times));
    Some(study)
}

/// The time of an evaluation by the reference code (s), about.
fn seconds_per_evaluation(subject: &Subject, model: &Arc<dyn ElasticModel>) -> f64 {
    let way = Way { integrator: Integrator::SemiImplicitEuler, steps: 1 << 20, tolerance: reference::TOLERANCE };
    let mut world = way.world(subject, &Counting::new(Arc::clone(model), u64::MAX));
    world.advance(1);
    let clock = Clock::thread();
    world.advance(100);
    let spent = clock.spent();
    (spent.cpu.unwrap_or(spent.wall) / 100.0).max(1e-9)
}

/// What an error costs with a method, between the two runs nearest to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cost {
    pub(crate) integrator: Integrator,
    /// Time step (s) or tolerance, evaluations and time (s).
    pub(crate) step: f64,
    pub(crate) evaluations: f64,
    pub(crate) time: f64,
}

impl Study {
    /// The methods that were measured.
    pub(crate) fn integrators(&self) -> impl Iterator<Item = Integrator> {
        INTEGRATORS.into_iter().map(|(one, _)| one).filter(|&one| self.of(one).next().is_some())
    }

    /// The solvers of rotations that were measured; none where there is no choice.
    pub(crate) fn solvers(&self) -> impl Iterator<Item = RotationReading> {
        let is_measured = |wanted: &RotationReading| self.measured.iter().any(|one| one.rotation == Some(*wanted));
        SOLVERS.into_iter().filter(is_measured)
    }

    /// The measurements of a method, with the default for rotations.
    pub(crate) fn of(&self, integrator: Integrator) -> impl Iterator<Item = &Measured> {
        self.with(integrator, RotationReading::default())
    }

    /// The measurements of a method with a solver of rotations; where there is no choice, with what the model has.
    pub(crate) fn with(&self, integrator: Integrator, rotation: RotationReading) -> impl Iterator<Item = &Measured> {
        self.measured
            .iter()
            .filter(move |one| one.integrator == integrator && one.rotation.is_none_or(|own| own == rotation))
    }

    /// What an error costs with a method, and the default for rotations; `None` if it was not reached.
    pub(crate) fn cost(&self, integrator: Integrator, error: f64) -> Option<Cost> {
        self.cost_with(integrator, RotationReading::default(), error)
    }

    /// What an error costs, interpolated on logarithmic axes; `None` if it was not reached.
    pub(crate) fn cost_with(&self, integrator: Integrator, rotation: RotationReading, error: f64) -> Option<Cost> {
        let runs: Vec<_> = self.with(integrator, rotation).filter_map(|one| Some((one, one.error?))).collect();
        let at = runs.iter().position(|&(_, own)| own <= error)?;
        let (fine, low) = runs[at];
        let cost = |share: f64, coarse: &Measured| {
            let between = |coarse: f64, fine: f64| coarse * libm::pow(fine / coarse, share);
            Cost {
                integrator,
                step: between(coarse.step, fine.step),
                evaluations: between(coarse.evaluations as f64, fine.evaluations as f64),
                time: between(coarse.time.median, fine.time.median),
            }
        };
        let Some(&(coarse, high)) = at.checked_sub(1).map(|at| &runs[at]) else { return Some(cost(1.0, fine)) };
        Some(cost(libm::log(high / error) / libm::log(high / low.max(f64::MIN_POSITIVE)), coarse))
    }

    /// The power of the step with which the error of a method falls, or for an adaptive one of evaluations: the median over those
    /// halvings in which the error is neither large nor round-off.
    pub(crate) fn order(&self, integrator: Integrator) -> Option<f64> {
        let least = 30.0 * self.reference.as_ref().ok()?.error.max(1e-12);
        let length = |one: &Measured| if integrator.is_adaptive() { 1.0 / one.evaluations as f64 } else { one.step };
        let runs: Vec<_> = self.of(integrator).filter_map(|one| Some((length(one), one.error?))).collect();
        let is_usual = |(_, error): &(f64, f64)| (least..1e-2).contains(error);
        let pairs = runs.windows(2).filter(|two| two.iter().all(is_usual));
        let slopes = pairs.map(|two| libm::log(two[0].1 / two[1].1) / libm::log(two[0].0 / two[1].0));
        let median = Spread::of(slopes).median;
        (!median.is_nan()).then_some(median)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Limits;

    const QUICK: Protocol = Protocol { evaluations: 4096, seconds: 10.0, rounds: 1 };

    fn scene(text: &str) -> Vec<Subject> {
        let scene = Scene::parse(text, "one.toml", &Limits::default()).unwrap();
        vec![Subject { name: "one".to_owned(), scene, run: 0 }]
    }

    const FREE: &str = "
        time.duration = 0.2
        body = { lattice = { cells = [1, 1, 1], side = 0.1 }, spin = { axis = [1, 2, 3], rate = 20 } }
        [[run]]
        name = 'cube'
        model = { kind = 'shape-based', stiffness = 1e4 }
    ";

    #[test]
    fn errors_fall_with_evaluations_and_the_reference_knows_its_own() {
        let watched = std::sync::atomic::AtomicU64::new(0);
        let watch = |more| watched.fetch_add(more, std::sync::atomic::Ordering::Relaxed) < u64::MAX;
        let subjects = scene(FREE);
        let results = measure(QUICK, &subjects, &watch).expect("it is never stopped");
        assert!(watched.into_inner() <= QUICK.work(&subjects));
        let study = &results.studies[0];
        assert!(study.reference.as_ref().is_ok_and(|reference| reference.error < 1e-9), "{:?}", study.reference);
        assert!(study.refused.is_empty());
        assert_eq!(study.integrators().count(), INTEGRATORS.len());
        let cost = |integrator| study.cost(integrator, 1e-5).expect("it is reached").evaluations;
        let [euler, pefrl] = [Integrator::SemiImplicitEuler, Integrator::Pefrl].map(cost);
        assert!(euler > 5.0 * pefrl, "{euler} {pefrl}");
        for (integrator, order) in [(Integrator::VelocityVerlet, 2.0), (Integrator::Pefrl, 4.0)] {
            let own = study.order(integrator).expect("it has one");
            assert!((own - order).abs() < 0.3, "{integrator:?}: {own}");
        }
        // Each solver with all methods, or with those of one evaluation a step if it has passes.
        assert_eq!(study.solvers().count(), SOLVERS.len());
        for rotation in SOLVERS {
            let count = INTEGRATORS.iter().filter(|(one, _)| study.with(*one, rotation).next().is_some()).count();
            assert_eq!(count, if rotation.has_passes() { 3 } else { INTEGRATORS.len() }, "{rotation:?}");
        }
        let least = |rotation| {
            let errors = study.with(Integrator::VelocityVerlet, rotation).filter_map(|one| one.error);
            errors.fold(f64::INFINITY, f64::min)
        };
        let [exact, printed, linear] =
            [RotationReading::Davenport, RotationReading::Arctangent, RotationReading::LinearUpdate].map(least);
        assert!(printed < 2.0 * exact && linear > 100.0 * exact, "{exact:e} {printed:e} {linear:e}");
        assert!(results.markdown("mark", "machine").starts_with("<!-- mark -->\n"));
        assert_eq!(results.csv().lines().count(), 1 + study.measured.len());
        assert!(measure(QUICK, &scene(FREE), &|_| false).is_none());
    }

    #[test]
    fn the_scenes_that_are_measured_by_default_have_no_mistakes() {
        let has_solvers: Vec<_> = usual().iter().map(Subject::has_solvers).collect();
        assert_eq!(has_solvers, [true, true, false], "the last one is in the plane");
    }

    #[test]
    fn methods_that_cannot_advance_a_run_are_named_with_the_reason() {
        let results = measure(QUICK, &scene(&FREE.replace("1e4 }", "1e4, damping = 1 }")), &|_| true);
        let results = results.expect("it is never stopped");
        let refused: Vec<_> = results.studies[0].refused.iter().map(|(one, _)| *one).collect();
        let symplectic = [Integrator::ForestRuth, Integrator::Pefrl, Integrator::BlanesMoan];
        assert!(refused.starts_with(&symplectic) && refused[3..] == [Integrator::QuinlanTremaine], "{refused:?}");
        assert!(results.markdown("mark", "machine").contains("pefrl has substeps backwards in time"));
    }

    #[test]
    fn a_scene_that_methods_do_not_agree_on_has_no_reference() {
        let results = measure(QUICK, &scene(&FREE.replace("1e4", "1e12")), &|_| true).expect("it is never stopped");
        let study = &results.studies[0];
        assert!(
            study.reference.as_ref().is_err_and(|why| why.contains("no finite reference")),
            "{:?}",
            study.reference
        );
        assert!(study.measured.is_empty());
        assert!(results.markdown("mark", "machine").contains("no finite reference"));
    }
}
