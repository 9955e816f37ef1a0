//! The integrators: the error of positions over the whole time against evaluations of the forces and time, for steps
//! and tolerances over decades, and the error of the paper's readings of rotations.
//!
//! The error of a run is the largest at a set of moments that all runs have in common. The reference is computed by two
//! different methods with small steps; their largest distance is its own error, and smaller errors are not reported. A
//! model counts evaluations; times are of the fastest code of each method. The runs take turns, in a rotated order, and
//! each time is the median of its turns.

mod count;
mod method;
mod page;
mod reference;
mod scenes;
mod text;

pub(crate) use scenes::usual;

use crate::spread::Spread;
use crate::study::{Findings, Study, Watch};
use crate::turns::{seconds, take_turns};
use count::Counting;
use localshape::Scene;
use localshape::scene::description;
use localshape::sim::Body;
use localshape::sim::model::ElasticModel;
use method::{Attempt, End, Method};
use reference::{farthest, larger, reference};
use std::sync::Arc;

/// The study.
pub(crate) struct WorkPrecision {
    pub(crate) effort: Effort,
    /// The runs that are measured.
    pub(crate) subjects: Vec<Subject>,
}

/// The amount of measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Effort {
    /// The approximate limit of evaluations in a run.
    pub(crate) evaluations: u32,
    /// The approximate limit of a run's time (s), which limits the evaluations of large bodies.
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
    /// The number of turns if nothing diverges, and one more for each way to advance a run.
    fn work(&self) -> u64 {
        self.subjects.iter().map(|subject| work(self.effort, subject)).sum()
    }

    fn measure(&self, watch: &Watch<'_>) -> Option<Findings> {
        let results = measure(self.effort, &self.subjects, watch)?;
        let (text, tables) = (results.text(), vec![("work-precision", results.table())]);
        Some(Findings { text, tables, page: Some(results.page()) })
    }
}

fn work(effort: Effort, subject: &Subject) -> u64 {
    (subject.methods().len() * STEPS) as u64 * u64::from(effort.rounds + 1)
}

/// The number of steps for each method, each half of the one before; tolerances fall by factors of ten.
const STEPS: usize = 11;

/// A run of a scene.
pub(crate) struct Subject {
    /// Its name.
    pub(crate) name: String,
    pub(crate) scene: Scene,
    /// The number of the run.
    pub(crate) run: usize,
}

impl Subject {
    /// The body of the run.
    fn body(&self) -> &Arc<Body> {
        self.scene.runs[self.run].body()
    }

    /// The methods that can advance the run, with their models.
    fn methods(&self) -> Vec<(Method, Arc<dyn ElasticModel>)> {
        let all = Method::ALL.into_iter().filter_map(|one| Some((one, one.model(self)?)));
        all.filter(|(one, model)| one.refusal(self, model.as_ref()).is_none()).collect()
    }
}

/// One method with one step or tolerance.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Measured {
    pub(crate) attempt: Attempt,
    /// Time step (s), or the tolerance of an adaptive method.
    pub(crate) step: f64,
    /// Evaluations of the forces of the whole body, from the start on.
    pub(crate) evaluations: u64,
    /// The greatest distance of a node from the reference at any moment, in sizes of the body; `None` without an end.
    pub(crate) error: Option<f64>,
    pub(crate) end: End,
    /// Time of the run (s); NaN without an error.
    pub(crate) time: Spread,
    /// Whether the steps are vectorised.
    pub(crate) is_fast: bool,
}

/// The reference course, on which two methods agree.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Reference {
    pub(crate) methods: [Method; 2],
    /// The greatest distance between the two, as a share of the body's size.
    pub(crate) error: f64,
}

/// The findings for one run.
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
    /// The measurements, method by method, from large steps to small ones.
    pub(crate) measured: Vec<Measured>,
    /// Methods that cannot advance it, and the reasons.
    pub(crate) refused: Vec<(Method, &'static str)>,
}

/// The findings on one machine.
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
    let (methods, size) = (subject.methods(), subject.body().extent());
    let usual = Method::DEFAULT.model(subject).expect("a model of scenes");
    let most = f64::from(effort.evaluations).min(effort.seconds / seconds_per_evaluation(subject, &usual)).max(1024.0);
    let why = |one: Method| Some((one, one.refusal(subject, one.model(subject)?.as_ref())?));
    let mut found = Comparison {
        name: name.clone(),
        words: description(usual.as_ref(), subject.body()),
        duration: scene.duration,
        cycle: scene.cycle(),
        reference: Err(String::new()),
        measured: Vec::new(),
        refused: Method::ALL.into_iter().filter_map(why).collect(),
    };
    let (exact, reference) = match reference(subject, &methods, most) {
        Ok(found) => found,
        Err(why) => {
            found.reference = Err(why);
            return watch(work(effort, subject)).then_some(found);
        }
    };
    let own_error = reference.error;
    found.reference = Ok(reference);
    let mut timed = Vec::new();
    for (method, model) in &methods {
        for at in 0..STEPS {
            let tolerance = libm::pow(10.0, -1.0 - at as f64);
            let attempt = Attempt::new(*method, most / f64::from(1 << (STEPS - 1 - at)), tolerance);
            let mut error = 0.0;
            let (end, evaluations) = attempt.run(subject, model, most, |moment, positions| {
                error = larger(error, farthest(positions, &exact[moment]) / size);
            });
            if !watch(1) {
                return None;
            }
            // An error below that of the reference is unknown.
            if end == End::Reached && error < own_error {
                break;
            }
            if end == End::Reached {
                timed.push((found.measured.len(), attempt, model));
            }
            found.measured.push(Measured {
                attempt,
                step: if method.is_adaptive() { tolerance } else { scene.duration / attempt.steps as f64 },
                evaluations,
                error: (end == End::Reached).then_some(error),
                end,
                time: Spread::of([]),
                is_fast: method.is_fast(model.as_ref()),
            });
            if evaluations as f64 > 1.5 * most {
                break;
            }
        }
    }
    // The earlier runs have warmed the caches.
    let times = take_turns(timed.len(), effort.rounds, watch, |turn| {
        let (_, attempt, model) = &timed[turn];
        let mut world = attempt.world(subject, Arc::clone(model));
        seconds(|| world.advance(attempt.steps))
    })?;
    timed.iter().zip(times).for_each(|(&(at, ..), times)| found.measured[at].time = Spread::of(times));
    Some(found)
}

/// The approximate time of an evaluation by the reference code (s).
fn seconds_per_evaluation(subject: &Subject, model: &Arc<dyn ElasticModel>) -> f64 {
    let attempt = Attempt { steps: 1 << 20, ..Attempt::new(Method::DEFAULT, 1.0, reference::TOLERANCE) };
    let mut world = attempt.world(subject, Arc::new(Counting::new(Arc::clone(model), u64::MAX)));
    world.advance(1);
    (seconds(|| world.advance(100)) / 100.0).max(1e-9)
}

/// The cost of an error with a method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cost {
    pub(crate) method: Method,
    /// Time step (s) or tolerance, evaluations and time (s).
    pub(crate) step: f64,
    pub(crate) evaluations: f64,
    pub(crate) time: f64,
}

impl Comparison {
    /// The measured methods.
    pub(crate) fn methods(&self) -> impl Iterator<Item = Method> {
        Method::ALL.into_iter().filter(|&one| self.of(one).next().is_some())
    }

    /// The measurements of a method.
    pub(crate) fn of(&self, method: Method) -> impl Iterator<Item = &Measured> {
        self.measured.iter().filter(move |one| one.attempt.method == method)
    }

    /// The cost of an error, interpolated on logarithmic axes: between the coarsest run from which on no error is
    /// larger, and the run before; `None` without such runs.
    pub(crate) fn cost(&self, method: Method, error: f64) -> Option<Cost> {
        let runs: Vec<_> = self.of(method).filter_map(|one| Some((one, one.error?))).collect();
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

    /// The order of convergence of a method with fixed steps, from the three finest runs whose errors are neither large
    /// nor round-off; `None` if there are fewer, or if the two orders between them differ by more than a half.
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
