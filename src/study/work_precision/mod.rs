//! The integrators: the error of positions at the end of a scene against evaluations of the forces and time, for steps and
//! tolerances over decades.
//!
//! The reference is computed by two different methods with small steps; how far apart they are is its own error.
//! Evaluations are counted by running a model that counts them; times are those of the fastest code of each method. The runs
//! take turns, in an order that is rotated, and each time is the median of its turns. Processor time is measured, or wall time if
//! the system does not provide it.

mod count;
mod scenes;
mod text;

use crate::output::Clock;
use crate::scene::Scene;
use crate::sim::integrate::Integrator;
use crate::sim::snapshot::Status;
use crate::sim::state::State;
use crate::sim::world::{Kernel, Stepping, Surroundings, World};
use crate::table::{Spread, Watch};
use count::Counting;
use glam::DVec3;

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

    /// What [`measure`] reports in all for a number of scenes: the turns, if no run diverges, and one more for each run.
    pub(crate) fn work(&self, scenes: usize) -> u64 {
        (scenes * INTEGRATORS.len() * HALVINGS) as u64 * u64::from(self.rounds + 1)
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
/// How many steps are tried with each integrator, each half of the one before; tolerances fall by factors of ten.
const HALVINGS: usize = 11;
/// The reference has so many times the evaluations of the finest run: not a power of two, so that no run is the reference.
const FINER: f64 = 1.4;
/// The tolerance of the reference, and the least that is tried: below, round-off is larger.
const TOLERANCE: f64 = 1e-11;

/// The name of a scene, the scene, and which of its runs is measured.
pub(crate) type Subject = (String, Scene);

/// The scenes that are measured if none is given.
pub(crate) fn usual() -> Vec<Subject> {
    scenes::all()
}

/// One integrator with one step or tolerance.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Measured {
    pub(crate) integrator: Integrator,
    /// Time step (s), or the tolerance of an adaptive method.
    pub(crate) step: f64,
    /// Evaluations of the forces of the whole body, those of the start included.
    pub(crate) evaluations: u64,
    /// The greatest distance of a node from the reference at the end, as a share of the body's size; `None` if the run diverges.
    pub(crate) error: Option<f64>,
    /// Time of the run (s); NaN if it diverges.
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

/// What was found for one scene.
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
    /// The runs, method by method, from large steps to small ones.
    pub(crate) measured: Vec<Measured>,
    /// Methods that cannot advance the scene, and why.
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

/// One way to advance a scene from its start to its end.
#[derive(Clone, Copy)]
struct Way {
    integrator: Integrator,
    /// The number of steps, 1 for an adaptive method.
    steps: u64,
    tolerance: f64,
}

impl Way {
    /// With about so many evaluations, or the tolerance of an adaptive method.
    fn new((integrator, stages): (Integrator, f64), evaluations: f64, tolerance: f64) -> Self {
        let steps = if integrator.is_adaptive() { 1 } else { (evaluations / stages).ceil().max(1.0) as u64 };
        Self { integrator, steps, tolerance }
    }

    /// The first run of a scene at its start.
    fn world(self, scene: &Scene, counting: Option<&Counting>) -> World {
        let run = &scene.runs[0];
        let surroundings =
            Surroundings { gravity: scene.gravity, obstacles: scene.obstacles.clone(), grips: scene.grips.clone() };
        let Self { integrator, steps, tolerance } = self;
        let step = scene.duration / steps as f64;
        let kernel = Kernel::of(run.model.as_ref(), integrator);
        let stepping = Stepping { integrator, step, tolerance, kernel };
        let model = counting.map_or(run.model.as_ref(), |counting| counting);
        World::new(&scene.body, scene.initial.clone(), model, surroundings, stepping)
    }

    /// The positions at the end (m), `None` if the run diverges, and the number of evaluations.
    fn run(self, scene: &Scene) -> (Option<Vec<DVec3>>, u64) {
        let counting = Counting::new(scene.runs[0].model.clone());
        let mut world = self.world(scene, Some(&counting));
        world.advance(self.steps);
        let State { position, .. } = world.state();
        ((world.status() == Status::Ok).then(|| position.clone()), counting.count())
    }
}

/// Measures one scene.
fn study(protocol: Protocol, (name, scene): &Subject, watch: &Watch<'_>) -> Option<Study> {
    let run = &scene.runs[0];
    let size = scene.body.extent();
    let most = f64::from(protocol.evaluations).min(protocol.seconds / seconds_per_evaluation(scene)).max(1024.0);
    let refusal = |integrator: Integrator| integrator.refusal(|| run.model.prepare(&scene.body));
    let (refused, accepted): (Vec<_>, Vec<_>) =
        INTEGRATORS.into_iter().partition(|&(integrator, _)| refusal(integrator).is_some());
    let mut study = Study {
        name: name.clone(),
        words: run.model.describe_fully(&scene.body),
        duration: scene.duration,
        cycle: scene.cycle(),
        reference: Err(String::new()),
        measured: Vec::new(),
        refused: refused.into_iter().filter_map(|(one, _)| Some((one, refusal(one)?))).collect(),
    };
    let (exact, reference) = match reference(scene, &accepted, most, size) {
        Ok(found) => found,
        Err(why) => {
            study.reference = Err(why);
            let skipped = protocol.work(1);
            return watch(skipped).then_some(study);
        }
    };
    let error_of_reference = reference.error;
    study.reference = Ok(reference);
    let mut ways = Vec::new();
    for &method in &accepted {
        for at in 0..HALVINGS {
            let way = Way::new(method, most / (1 << (HALVINGS - 1 - at)) as f64, libm::pow(10.0, -1.0 - at as f64));
            let (end, evaluations) = way.run(scene);
            let error = end.map(|end| farthest(&end, &exact) / size);
            if !watch(1) {
                return None;
            }
            // What is as good as the reference says nothing about the method.
            if error.is_some_and(|error| error < error_of_reference) {
                break;
            }
            ways.push(way);
            study.measured.push(Measured {
                integrator: method.0,
                step: if method.0.is_adaptive() { way.tolerance } else { scene.duration / way.steps as f64 },
                evaluations,
                error,
                time: Spread::of([]),
                is_fast: Kernel::of(run.model.as_ref(), method.0) == Kernel::Fast,
            });
            if evaluations as f64 > most {
                break;
            }
        }
    }
    let turns: Vec<_> = (0..ways.len()).filter(|&at| study.measured[at].error.is_some()).collect();
    let mut times = vec![Vec::new(); ways.len()];
    // What counted evaluations has warmed caches.
    for round in 0..protocol.rounds as usize {
        for turn in 0..turns.len() {
            let at = turns[(round + turn) % turns.len()];
            let mut world = ways[at].world(scene, None);
            let clock = Clock::thread();
            world.advance(ways[at].steps);
            let spent = clock.spent();
            times[at].push(spent.cpu.unwrap_or(spent.wall));
            if !watch(1) {
                return None;
            }
        }
    }
    for (one, times) in study.measured.iter_mut().zip(times) {
        one.time = Spread::of(times);
    }
    Some(study)
}

/// The time of an evaluation by the reference code (s), about.
fn seconds_per_evaluation(scene: &Scene) -> f64 {
    let way = Way { integrator: Integrator::SemiImplicitEuler, steps: 1 << 20, tolerance: TOLERANCE };
    let counting = Counting::new(scene.runs[0].model.clone());
    let mut world = way.world(scene, Some(&counting));
    world.advance(1);
    let clock = Clock::thread();
    world.advance(100);
    let spent = clock.spent();
    (spent.cpu.unwrap_or(spent.wall) / 100.0).max(1e-9)
}

/// The positions at the end (m) by two different methods; why there are none otherwise.
fn reference(
    scene: &Scene,
    accepted: &[(Integrator, f64)],
    most: f64,
    size: f64,
) -> Result<(Vec<DVec3>, Reference), String> {
    // With obstacles only the adaptive method is of high order, and of the others that with the smallest steps is best.
    let best: &[Integrator] = if scene.obstacles.is_empty() {
        &[Integrator::BlanesMoan, Integrator::QuinlanTremaine, Integrator::DormandPrince, Integrator::RungeKutta]
    } else {
        &[Integrator::DormandPrince]
    };
    let rest = [Integrator::VelocityVerlet, Integrator::SemiImplicitEuler];
    let methods = best.iter().chain(&rest).filter_map(|wanted| accepted.iter().find(|(one, _)| one == wanted));
    let mut ends = methods.map(|&method| (method.0, finest(scene, method, FINER * most)));
    let mut next = || ends.next().unwrap_or((Integrator::default(), None));
    let ((first, one), (second, other)) = (next(), next());
    let (Some(one), Some(other)) = (one, other) else {
        return Err("the body diverges also with small steps: there is no finite reference".to_owned());
    };
    let error = farthest(&one, &other) / size;
    // NaN is no agreement.
    if error.is_nan() || error > MOST_APART {
        return Err(format!(
            "{} and {} end {error:.0e} of the body's size apart also with small steps: the motion is chaotic, and there is no \
             finite reference; shorten `time.duration`",
            crate::sim::words::typed(&first),
            crate::sim::words::typed(&second),
        ));
    }
    Ok((one, Reference { integrators: [first, second], error }))
}

/// The positions at the end (m) with about so many evaluations, or the tolerance of an adaptive method that leads to them.
fn finest(scene: &Scene, method: (Integrator, f64), evaluations: f64) -> Option<Vec<DVec3>> {
    let mut tolerance = if method.0.is_adaptive() { 1e-4 } else { TOLERANCE };
    loop {
        let (end, count) = Way::new(method, evaluations, tolerance).run(scene);
        if tolerance <= TOLERANCE || count as f64 > evaluations {
            return end;
        }
        tolerance = (0.1 * tolerance).max(TOLERANCE);
    }
}

/// Two methods that end farther apart than this share of the body's size do not agree.
const MOST_APART: f64 = 0.03;

/// The greatest distance of a node from its place (m).
fn farthest(ones: &[DVec3], others: &[DVec3]) -> f64 {
    // Unlike the maximum of two numbers, this keeps NaN.
    ones.iter()
        .zip(others)
        .map(|(one, other)| one.distance(*other))
        .fold(0.0, |far, one| if one <= far { far } else { one })
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

    /// The runs of a method.
    pub(crate) fn of(&self, integrator: Integrator) -> impl Iterator<Item = &Measured> {
        self.measured.iter().filter(move |one| one.integrator == integrator)
    }

    /// What an error costs with a method, interpolated on logarithmic axes; `None` if it was not reached.
    pub(crate) fn cost(&self, integrator: Integrator, error: f64) -> Option<Cost> {
        let runs: Vec<_> = self.of(integrator).filter_map(|one| Some((one, one.error?))).collect();
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
        vec![("one".to_owned(), Scene::parse(text, "one.toml", &Limits::default()).unwrap())]
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
        let results = measure(QUICK, &scene(FREE), &watch).expect("it is never stopped");
        assert!(watched.into_inner() <= QUICK.work(1));
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
        assert!(results.markdown("mark", "machine").starts_with("<!-- mark -->\n"));
        assert_eq!(results.csv().lines().count(), 1 + study.measured.len());
        assert!(measure(QUICK, &scene(FREE), &|_| false).is_none());
    }

    #[test]
    fn a_scene_that_methods_do_not_agree_on_has_no_reference() {
        let explicit = FREE.replace("1e4 }", "1e4, damping = 1e9, passes = 2 }");
        let results = measure(QUICK, &scene(&explicit), &|_| true).expect("it is never stopped");
        let study = &results.studies[0];
        assert!(
            study.reference.as_ref().is_err_and(|why| why.contains("no finite reference")),
            "{:?}",
            study.reference
        );
        assert_eq!(study.refused.len(), 7);
        assert!(results.markdown("mark", "machine").contains("no finite reference"));
    }
}
