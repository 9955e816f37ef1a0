//! The integrators: the error of positions over the whole time against evaluations of the forces and time, for steps and tolerances
//! over decades, and with each solver of rotations.
//!
//! The error of a run is the largest at any of a set of moments that all runs have in common. The reference is computed by two
//! different methods with small steps; how far apart they are at most is its own error, and no error below it is told. Evaluations
//! are counted by running a model that counts them; times are those of the fastest code of each method. The runs take turns, in an
//! order that is rotated, and each time is the median of its turns.

mod count;
mod method;
#[cfg(feature = "render")]
mod page;
mod reference;
mod scenes;
mod text;

pub(crate) use scenes::usual;

use crate::folder::Notes;
use crate::model::ShapeBy;
use crate::solver::Solver;
use crate::spread::Spread;
use crate::study::{Findings, Study, Watch};
use crate::turns::{Clock, take_turns};
use count::Counting;
use localshape::Scene;
use localshape::sim::model::ElasticModel;
use localshape::sim::model::shape_based::ShapeBased;
use localshape::sim::{Dimension, Kernel};
use method::{End, Method, Way};
use reference::{farthest, larger, reference};
use std::sync::Arc;

/// The study.
pub(crate) struct WorkPrecision {
    pub(crate) effort: Effort,
    /// The runs that are measured.
    pub(crate) subjects: Vec<Subject>,
    /// The arguments that repeat it.
    pub(crate) arguments: String,
}

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Effort {
    /// The most evaluations in a run, about.
    pub(crate) evaluations: u32,
    /// The longest run (s), about, which limits the evaluations of large bodies.
    pub(crate) seconds: f64,
    /// The number of turns of each run.
    pub(crate) rounds: u32,
}

impl Effort {
    /// Less than five minutes for the scenes of this module.
    pub(crate) const USUAL: Self = Self { evaluations: 65_536, seconds: 0.4, rounds: 3 };
    /// For smaller errors and steadier times.
    pub(crate) const FULL: Self = Self { evaluations: 524_288, seconds: 4.0, rounds: 9 };
}

impl Study for WorkPrecision {
    fn name(&self) -> &'static str {
        "work-precision"
    }

    fn command(&self) -> String {
        format!("localshape-study work-precision{}", self.arguments)
    }

    /// The turns, if nothing diverges, and one more for each way to advance a run.
    fn work(&self) -> u64 {
        self.subjects.iter().map(|subject| work(self.effort, subject)).sum()
    }

    fn measure(&self, watch: &Watch<'_>, _: &Notes) -> Option<Findings> {
        Some(measure(self.effort, &self.subjects, watch)?.findings())
    }
}

fn work(effort: Effort, subject: &Subject) -> u64 {
    let steps: usize = (0..subject.models().len()).map(|number| Series::of(number).count).sum();
    (Method::ALL.len() * steps) as u64 * u64::from(effort.rounds + 1)
}

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
type Choice = (Option<Solver>, Arc<dyn ElasticModel>);

impl Subject {
    /// The model with each solver of rotations; the model itself where there is no choice.
    fn models(&self) -> Vec<Choice> {
        let own = &self.scene.runs[self.run].model;
        let with = |shape: &ShapeBased, solver| -> Arc<dyn ElasticModel> {
            match solver {
                Solver::Scene(rotation) => Arc::new(ShapeBased { rotation, ..shape.clone() }),
                _ => {
                    let ShapeBased { stiffness, damping, passes, .. } = *shape;
                    Arc::new(ShapeBy { stiffness, damping, solver, passes })
                }
            }
        };
        match own.shape_based() {
            Some(shape) if self.scene.body.dimension == Dimension::Space => {
                Solver::ALL.map(|solver| (Some(solver), with(shape, solver))).into()
            }
            _ => vec![(None, Arc::clone(own))],
        }
    }

    /// The methods that can advance a model.
    fn accepted(&self, model: &dyn ElasticModel) -> Vec<Method> {
        Method::ALL.into_iter().filter(|one| one.refusal(self, model).is_none()).collect()
    }
}

/// One integrator with one step or tolerance.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Measured {
    pub(crate) way: Way,
    /// The solver of rotations, where there is a choice.
    pub(crate) solver: Option<Solver>,
    /// Time step (s), or the tolerance of an adaptive method.
    pub(crate) step: f64,
    /// Evaluations of the forces of the whole body, those of the start included.
    pub(crate) evaluations: u64,
    /// The greatest distance of a node from the reference at any moment, as a share of the body's size; `None` if the run diverges or
    /// is given up.
    pub(crate) error: Option<f64>,
    pub(crate) end: End,
    /// Time of the run (s); NaN without an error.
    pub(crate) time: Spread,
    /// Whether the steps are vectorised.
    pub(crate) is_fast: bool,
}

/// What two methods agree on.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Reference {
    pub(crate) methods: [Method; 2],
    /// The greatest distance between the two, as a share of the body's size.
    pub(crate) error: f64,
}

/// What was found for one run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Comparison {
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
    /// Methods that cannot advance it, and why.
    pub(crate) refused: Vec<(Method, &'static str)>,
}

/// What was found on one machine.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Results {
    pub(crate) effort: Effort,
    pub(crate) comparisons: Vec<Comparison>,
}

/// Measures all runs with the rayon thread pool of the caller, which has one thread; `None` if `watch` stops it.
pub(crate) fn measure(effort: Effort, subjects: &[Subject], watch: &Watch<'_>) -> Option<Results> {
    let comparisons = subjects.iter().map(|subject| compare(effort, subject, watch)).collect::<Option<_>>()?;
    Some(Results { effort, comparisons })
}

/// Measures one run.
fn compare(effort: Effort, subject: &Subject, watch: &Watch<'_>) -> Option<Comparison> {
    let Subject { name, scene, .. } = subject;
    let models = subject.models();
    let (_, usual) = &models[0];
    let affordable = effort.seconds / seconds_per_evaluation(subject, usual);
    let most = f64::from(effort.evaluations).min(affordable).max(1024.0);
    let why = |one: Method| Some((one, one.refusal(subject, usual.as_ref())?));
    let mut found = Comparison {
        name: name.clone(),
        words: usual.describe_fully(&scene.body),
        duration: scene.duration,
        cycle: scene.cycle(),
        reference: Err(String::new()),
        measured: Vec::new(),
        refused: Method::ALL.into_iter().filter_map(why).collect(),
    };
    let (exact, reference) = match reference(subject, usual, &subject.accepted(usual.as_ref()), most) {
        Ok(found) => found,
        Err(why) => {
            found.reference = Err(why);
            return watch(work(effort, subject)).then_some(found);
        }
    };
    let error_of_reference = reference.error;
    found.reference = Ok(reference);
    let mut timed = Vec::new();
    for (number, (solver, model)) in models.iter().enumerate() {
        let Series { count, ratio, share } = Series::of(number);
        let most = share * most;
        for method in subject.accepted(model.as_ref()) {
            for at in 0..count {
                let coarser = f64::from(ratio.pow((count - 1 - at) as u32));
                let way = Way::new(method, most / coarser, libm::pow(10.0, -1.0 - (at as u32 * ratio / 2) as f64));
                let mut error = 0.0;
                let (end, evaluations) = way.run(subject, model, most, |moment, positions| {
                    error = larger(error, farthest(positions, &exact[moment]) / scene.body.extent());
                });
                if !watch(1) {
                    return None;
                }
                // What is as good as the reference says nothing about the method.
                if end == End::Reached && error < error_of_reference {
                    break;
                }
                let is_fast = match method {
                    Method::Scene(integrator) => Kernel::of(model.as_ref(), integrator) == Kernel::Fast,
                    _ => false,
                };
                if end == End::Reached {
                    timed.push((found.measured.len(), way, model));
                }
                found.measured.push(Measured {
                    way,
                    solver: *solver,
                    step: if method.is_adaptive() { way.tolerance } else { scene.duration / way.steps as f64 },
                    evaluations,
                    error: (end == End::Reached).then_some(error),
                    end,
                    time: Spread::of([]),
                    is_fast,
                });
                if evaluations as f64 > 1.5 * most {
                    break;
                }
            }
        }
    }
    // What counted evaluations has warmed caches.
    let times = take_turns(timed.len(), effort.rounds, watch, |turn| {
        let (_, way, model) = &timed[turn];
        let mut world = way.world(subject, model.as_ref());
        let clock = Clock::start();
        world.advance(way.steps);
        clock.seconds()
    })?;
    timed.iter().zip(times).for_each(|(&(at, ..), times)| found.measured[at].time = Spread::of(times));
    Some(found)
}

/// The time of an evaluation by the reference code (s), about.
fn seconds_per_evaluation(subject: &Subject, model: &Arc<dyn ElasticModel>) -> f64 {
    let way = Way { steps: 1 << 20, ..Way::new(Method::DEFAULT, 1.0, reference::TOLERANCE) };
    let mut world = way.world(subject, &Counting::new(Arc::clone(model), u64::MAX));
    world.advance(1);
    let clock = Clock::start();
    world.advance(100);
    (clock.seconds() / 100.0).max(1e-9)
}

/// What an error costs with a method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cost {
    pub(crate) method: Method,
    /// Time step (s) or tolerance, evaluations and time (s).
    pub(crate) step: f64,
    pub(crate) evaluations: f64,
    pub(crate) time: f64,
}

impl Comparison {
    /// The methods that were measured.
    pub(crate) fn methods(&self) -> impl Iterator<Item = Method> {
        Method::ALL.into_iter().filter(|&one| self.of(one).next().is_some())
    }

    /// The solvers of rotations that were measured; none where there is no choice.
    pub(crate) fn solvers(&self) -> impl Iterator<Item = Solver> {
        let is_measured = |wanted: &Solver| self.measured.iter().any(|one| one.solver == Some(*wanted));
        Solver::ALL.into_iter().filter(is_measured)
    }

    /// The measurements of a method, with the default for rotations.
    pub(crate) fn of(&self, method: Method) -> impl Iterator<Item = &Measured> {
        self.with(method, Solver::DEFAULT)
    }

    /// The measurements of a method with a solver of rotations; where there is no choice, with what the model has.
    pub(crate) fn with(&self, method: Method, solver: Solver) -> impl Iterator<Item = &Measured> {
        let is_of = move |one: &&Measured| one.way.method == method && one.solver.is_none_or(|own| own == solver);
        self.measured.iter().filter(is_of)
    }

    /// What an error costs, interpolated on logarithmic axes between the coarsest run from which on no error is larger and the one
    /// before; `None` if there is none.
    pub(crate) fn cost(&self, method: Method, solver: Solver, error: f64) -> Option<Cost> {
        let runs: Vec<_> = self.with(method, solver).filter_map(|one| Some((one, one.error?))).collect();
        let larger = runs.iter().rposition(|&(_, own)| own > error);
        let &(fine, low) = runs.get(larger.map_or(0, |at| at + 1))?;
        let cost = |share: f64, coarse: &Measured| {
            let between = |coarse: f64, fine: f64| coarse * libm::pow(fine / coarse, share);
            Cost {
                method,
                step: between(coarse.step, fine.step),
                evaluations: between(coarse.evaluations as f64, fine.evaluations as f64),
                time: between(coarse.time.median, fine.time.median),
            }
        };
        let Some((coarse, high)) = larger.map(|at| runs[at]) else { return Some(cost(1.0, fine)) };
        Some(cost(libm::log(high / error) / libm::log(high / low.max(f64::MIN_POSITIVE)), coarse))
    }

    /// The power of the step with which the error of a method with fixed steps falls, from the three finest runs whose errors are
    /// neither large nor round-off; `None` if there are fewer, or if the two powers between them differ by more than a half.
    pub(crate) fn order(&self, method: Method) -> Option<f64> {
        let least = 30.0 * self.reference.as_ref().ok()?.error.max(1e-12);
        let usual = self.of(method).filter_map(|one| Some((one.step, one.error?)));
        let usual: Vec<_> = usual.filter(|(_, error)| (least..1e-2).contains(error)).collect();
        let &[coarse, middle, fine] = usual.last_chunk()?;
        let slope =
            |(step, error): (f64, f64), (finer, less): (f64, f64)| libm::log(error / less) / libm::log(step / finer);
        let slopes = [slope(coarse, middle), slope(middle, fine)];
        let agree = (slopes[0] - slopes[1]).abs() <= 0.5;
        (agree && !method.is_adaptive()).then(|| 0.5 * (slopes[0] + slopes[1]))
    }
}

#[cfg(test)]
#[path = "../../tests/inside/work_precision.rs"]
mod tests;
