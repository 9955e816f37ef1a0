//! The runs: models, steps and integrators.

use super::body::ResolvedBody;
use super::choice::{Choice, TypedModel, check_names};
use super::grips::SceneGrip;
use super::recordings::{ReadRecording, Shown};
use crate::reading::collector::{Collector, PathPart, key_path};
use crate::reading::words;
use crate::scene::file::{RunFile, StepFile, TimeFile};
use crate::scene::step::NamedStep;
use crate::scene::{ALL_BODIES, Recorded, Run, Together};
use crate::sim::model::{ElasticModel, Misfit};
use crate::sim::stability::Stability;
use crate::sim::{Body, Dimension, Grip, Integrator, Kernel};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The most steps of a run. Beyond, double precision cannot distinguish the times of two steps.
const MOST_STEPS: f64 = 9_007_199_254_740_992.0;

/// The bodies of a run with their models and constraints.
struct Parts {
    /// Their places in the scene.
    of: Vec<usize>,
    together: Together,
    models: Vec<Arc<dyn ElasticModel>>,
    grips: Vec<Grip>,
    recording: Option<Arc<Recorded>>,
}

impl Parts {
    /// Each model with its body.
    fn iter(&self) -> impl Iterator<Item = (&dyn ElasticModel, &Arc<Body>)> {
        self.models.iter().map(|model| &**model).zip(self.together.bodies.bodies())
    }

    /// Whether a model moves its nodes itself.
    fn is_projected(&self) -> bool {
        self.iter().any(|(model, body)| model.projection(body).is_some())
    }

    /// The code that computes steps fastest.
    fn fastest(&self, integrator: Integrator) -> Kernel {
        let mut kernels = self.models.iter().map(|model| Kernel::of(&**model, integrator));
        kernels.find(|kernel| *kernel != Kernel::Fast).unwrap_or(Kernel::Fast)
    }
}

/// The bodies of a scene at some places.
fn together(bodies: &[ResolvedBody], of: &[usize]) -> Together {
    Together::new(of.iter().map(|&body| (&bodies[body].body, &bodies[body].initial)))
}

/// What runs are made of.
pub(super) struct Around<'a> {
    /// The bodies and models of each run.
    pub(super) choices: &'a [Option<Choice<'a>>],
    /// The recording of each run.
    pub(super) recordings: Vec<Option<ReadRecording>>,
    /// The bodies of the scene, in the plane or in space.
    pub(super) bodies: Option<(&'a [ResolvedBody], Dimension)>,
    pub(super) grips: Option<&'a [SceneGrip]>,
}

/// The bodies of each run with their models, and the own bodies of recordings; `None` after a mistake in a model or a
/// recording.
fn parts(
    typed: &[Option<RunFile>],
    around: Around<'_>,
    report: &mut Collector<'_>,
) -> Option<(Vec<Parts>, Vec<ResolvedBody>)> {
    let Around { choices, recordings, bodies, grips } = around;
    let ((bodies, dimension), grips) = (bodies?, grips.unwrap_or_default());
    let mut own = Vec::new();
    // Runs of the same bodies share them.
    let mut known: BTreeMap<&[usize], Together> = BTreeMap::new();
    let mut all = Vec::with_capacity(choices.len());
    for (at, ((choice, run), read)) in choices.iter().zip(typed).zip(recordings).enumerate() {
        let Some((Choice { of, models }, run)) = choice.as_ref().zip(run.as_ref()) else {
            all.push(None);
            continue;
        };
        let mut together = known.entry(of).or_insert_with(|| together(bodies, of)).clone();
        if run.states.is_some() {
            let shown = read.and_then(|read| {
                let mut of = of.clone();
                let (recorded, shown) = read.shown(at, run, &together, dimension, report)?;
                match shown {
                    Shown::Bodies(start) => together.initial = start,
                    Shown::Own(body) => {
                        if bodies.iter().any(|other| other.name == body.name) || body.name == ALL_BODIES {
                            let quoted = words::quoted(&run.name);
                            let message =
                                format!("{quoted} shows a body of its own, which has this name, too, as has another");
                            report.at(&key_path!["run", at, "name"], message, "give the run another name");
                            return None;
                        }
                        together = Together::new(std::iter::once((&body.body, &body.initial)));
                        of = vec![bodies.len() + own.len()];
                        own.push(*body);
                    }
                }
                let (models, grips, recording) = (Vec::new(), Vec::new(), Some(recorded));
                Some(Parts { of, together, models, grips, recording })
            });
            all.push(shown);
            continue;
        }
        let resolved = of.iter().zip(models).map(|(&at, typed)| {
            let ResolvedBody { body, springs, .. } = &bodies[at];
            let misfit = |Misfit { key, message }| {
                let of = if of.len() > 1 { format!("{}: ", bodies[at].in_words()) } else { String::new() };
                report.at(&key_path![typed.path; key], of + &message, None);
            };
            typed.model.resolve(body, springs.as_deref()).map_err(misfit).ok()
        });
        // All misfits are reported.
        let resolved: Vec<_> = resolved.collect();
        let resolved = resolved.into_iter().collect::<Option<Vec<_>>>();
        if let Some(resolved) = &resolved {
            warn_without_effect(of.iter().map(|&at| &bodies[at].body).zip(resolved), models, report);
        }
        let grips = grips.iter().flat_map(|grip| grip.in_run(of, &together.bodies)).collect();
        all.push(resolved.map(|models| Parts { of: of.clone(), together, models, grips, recording: None }));
    }
    Some((all.into_iter().collect::<Option<_>>()?, own))
}

/// Warns of parameters that have no effect on any of the bodies of their model.
fn warn_without_effect<'a>(
    parts: impl Iterator<Item = (&'a Arc<Body>, &'a Arc<dyn ElasticModel>)>,
    typed: &[TypedModel<'_>],
    report: &mut Collector<'_>,
) {
    let parts: Vec<_> = parts.zip(typed).collect();
    for models in parts.chunk_by(|(_, one), (_, other)| one.path == other.path) {
        let idle = models.iter().map(|((body, model), _)| model.without_effect(body)).collect::<Option<Vec<_>>>();
        if let Some(Misfit { key, message }) = idle.and_then(|idle| idle.into_iter().next()) {
            report.warn(&key_path![models[0].1.path; key], message, None);
        }
    }
}

/// The steps of a recording between two frames, if the step of the program that made it is not known.
const STEPS_OF_FRAME: f64 = 1024.0;

/// The runs, and the own bodies of recordings, or `None` if a part that they need has a mistake.
pub(super) fn resolve<'a>(
    typed: &'a [Option<RunFile>],
    time: Option<&TimeFile>,
    around: Around<'_>,
    report: &mut Collector<'_>,
) -> Option<(Vec<Run>, Vec<ResolvedBody>)> {
    let name = |run: &'a Option<RunFile>| Some(run.as_ref()?.name.as_str());
    let named = typed.iter().enumerate().map(|(at, run)| (key_path!["run", at].to_vec(), name(run)));
    check_names(["run", "runs"], named, report);
    // T depends on all models: without one of them, steps would be reported wrongly.
    let (bodies, choices) = (around.bodies, around.choices);
    let (parts, own) = parts(typed, around, report)?;
    let periods = parts.iter().flat_map(Parts::iter).map(|(model, body)| model.shortest_period(body));
    let cycle = periods.fold(f64::INFINITY, f64::min);
    let most = own_limits(typed, time?, &parts);
    warn_of_held_steps(typed, time?, &parts, &most, report);
    let limits = limits(most, &sharing(typed, time?));
    let mut runs = Vec::with_capacity(parts.len());
    for (at, (run, parts)) in typed.iter().zip(parts).enumerate() {
        let (run, time) = (run.as_ref()?, time?);
        let integrator = run.integrator.unwrap_or(time.integrator);
        let misplaced = if parts.recording.is_none() { misplaced(at, run, time, integrator) } else { None };
        if let Some((path, message, hint)) = misplaced {
            report.at(&path, message, hint);
            return None;
        }
        let recorded = parts.recording.as_ref().map(|recording| {
            StepFile::Seconds(recording.step.unwrap_or(1.0 / time.frames_per_second / STEPS_OF_FRAME))
        });
        let of_run = if recorded.is_some() { "states" } else { "step" };
        let (of_run, shared) = (key_path!["run", at, of_run], key_path!["time", "step"]);
        let (step, path) = match recorded.as_ref().or(run.step.as_ref()) {
            Some(step) => (step, &of_run[..]),
            None => (time.step.as_ref().unwrap_or(&StepFile::DEFAULT), &shared[..]),
        };
        let tolerance = run.tolerance.or(time.tolerance).unwrap_or(Integrator::TOLERANCE);
        let tolerance = (integrator.is_adaptive() && recorded.is_none()).then_some(tolerance);
        let step = match step {
            _ if tolerance.is_some() => 1.0 / time.frames_per_second,
            StepFile::Seconds(seconds) => *seconds,
            StepFile::Named(named) => match named.of(cycle) {
                Some(step) => step,
                None => match automatic(limits[at].0, time) {
                    Some(step) => step,
                    None => {
                        let (limit, of) = limits[at];
                        let of = typed[of].as_ref()?;
                        let (message, help) = no_limit(of, of.integrator.unwrap_or(time.integrator), limit);
                        report.at(path, message, help);
                        return None;
                    }
                },
            },
        };
        if !(step.is_normal() && step > 0.0 && time.duration / step <= MOST_STEPS) {
            let message = format!("the time step is {step:e} s with T = {cycle:.4e} s: such steps cannot be counted");
            report.at(path, message, "make it larger, or masses and stiffness less extreme");
            return None;
        }
        if step > time.duration && time.duration > 0.0 && tolerance.is_none() {
            let message = format!(
                "the time step of {} is {} s, longer than the whole scene of {} s: nothing would move",
                words::quoted(&run.name),
                words::short(step),
                words::short(time.duration)
            );
            let help = match recorded {
                Some(_) => "make `step` in its archive smaller, or the duration longer".to_owned(),
                None => format!("T = {} s; make the step smaller or the duration longer", words::short(cycle)),
            };
            report.at(path, message, help);
            return None;
        }
        let refusals = parts.iter().map(|(model, body)| integrator.refusal(model, body)).enumerate();
        if let Some((body, reason)) = refusals.into_iter().find_map(|(body, reason)| Some((body, reason?))) {
            let name = words::quoted(&crate::reading::captions::typed(&integrator));
            // The integrator of the scene suits other runs.
            match (run.integrator, &choices[at]) {
                (None, Some(choice)) => {
                    let message = format!("{name}, which is `time.integrator`, {reason}");
                    report.at(&choice.models[body].path, message, "or give this run an `integrator` of its own");
                }
                _ => report.at(&key_path!["run", at, "integrator"], format!("{name} {reason}"), None),
            }
            return None;
        }
        let colour = run.colour.map(|colour| colour.0);
        let fastest = parts.fastest(integrator);
        let kernel = run.kernel.unwrap_or(fastest);
        if kernel == Kernel::Fast && fastest != Kernel::Fast {
            let path = key_path!["run", at, "kernel"];
            let slow = parts.iter().position(|(model, _)| Kernel::of(model, integrator) != Kernel::Fast);
            let slow = slow.filter(|_| parts.of.len() > 1).and_then(|slow| bodies?.0.get(parts.of[slow]));
            let of = slow.map_or(String::new(), |body| format!(" of {}", body.in_words()));
            let message = format!(
                "`run[{at}].kernel` is \"fast\", but this `integrator`, `model.kind` or `model.rotation`{of} has no vectorised steps"
            );
            report.at(&path, message, "remove it, or write \"reference\"");
            return None;
        }
        runs.push(Run {
            name: run.name.clone(),
            of: parts.of,
            bodies: parts.together.bodies,
            initial: parts.together.initial,
            models: parts.models,
            recording: parts.recording,
            grips: parts.grips,
            integrator,
            step,
            tolerance,
            kernel,
            place: 0,
            colour,
        });
    }
    Some((runs, own))
}

/// The place, message and remedy for a `step` with an integrator that chooses its own steps, or a tolerance with
/// another integrator.
fn misplaced(
    at: usize,
    run: &RunFile,
    time: &TimeFile,
    integrator: Integrator,
) -> Option<(Vec<PathPart<'static>>, String, String)> {
    let own = |key| key_path!["run", at, key].to_vec();
    let common = |key| key_path!["time", key].to_vec();
    let name = words::quoted(&crate::reading::captions::typed(&integrator));
    if integrator.is_adaptive() {
        let path = if run.step.is_some() { own("step") } else { common("step") };
        let is_typed = run.step.is_some() || time.step.is_some() && run.integrator.is_none();
        let message = format!("{name} chooses its own steps");
        return is_typed.then(|| (path, message, "give `tolerance` in place of `step`, such as 1e-6".into()));
    }
    let path = if run.tolerance.is_some() { own("tolerance") } else { common("tolerance") };
    let is_typed = run.tolerance.is_some() || time.tolerance.is_some() && run.integrator.is_none();
    let message = format!("{name} has fixed steps and no tolerance");
    let has_step = run.step.is_some() || time.step.is_some();
    let remedy = if has_step { "remove `tolerance`" } else { "give `step` in its place" };
    is_typed.then(|| (path, message, format!("{remedy}, or write `integrator = \"dormand-prince\"`")))
}

fn is_auto(step: &Option<StepFile>) -> bool {
    matches!(step, Some(StepFile::Named(NamedStep::Auto)))
}

/// The runs that share `step = "auto"` of the scene.
fn sharing(typed: &[Option<RunFile>], time: &TimeFile) -> Vec<usize> {
    let shares = |run: &RunFile| run.step.is_none() && is_auto(&time.step);
    (0..typed.len()).filter(|&at| typed[at].as_ref().is_some_and(shares)).collect()
}

/// The largest step (s) for each run with `step = "auto"`, infinite for others: the largest stable one, or for a model that moves its
/// nodes itself the one that is taken.
fn own_limits(typed: &[Option<RunFile>], time: &TimeFile, parts: &[Parts]) -> Vec<f64> {
    let sharing = sharing(typed, time);
    let limit = |(at, (run, parts)): (usize, (&Option<RunFile>, &Parts))| {
        let Some(run) = run.as_ref().filter(|run| is_auto(&run.step) || sharing.contains(&at)) else {
            return f64::INFINITY;
        };
        let integrator = run.integrator.unwrap_or(time.integrator);
        let Parts { together, models, grips, .. } = parts;
        let each = Stability::of_each(&together.bodies, models, integrator, grips, time.duration);
        let largest = Stability::of_all(&each).largest;
        if parts.is_projected() { largest.min(Stability::PROJECTED / Stability::SHARE) } else { largest }
    };
    typed.iter().zip(parts).enumerate().map(limit).collect()
}

/// The largest step (s) for each run, and the run that limits it: the run itself, or among the runs that share the scene's step the one
/// with the least.
fn limits(own: Vec<f64>, sharing: &[usize]) -> Vec<(f64, usize)> {
    let mut limits: Vec<_> = own.into_iter().zip(0..).collect();
    let least = sharing.iter().map(|&at| limits[at]).min_by(|one, other| one.0.total_cmp(&other.0));
    sharing.iter().zip(least.into_iter().cycle()).for_each(|(&at, least)| limits[at] = least);
    limits
}

/// Warns of a model that moves its nodes itself, if its short steps are those of all runs that share `step = "auto"` of the scene.
fn warn_of_held_steps(
    runs: &[Option<RunFile>],
    time: &TimeFile,
    parts: &[Parts],
    own: &[f64],
    report: &mut Collector<'_>,
) {
    let (holding, others): (Vec<usize>, Vec<usize>) =
        sharing(runs, time).into_iter().partition(|&at| parts[at].is_projected());
    let step = |of: &[usize]| automatic(of.iter().map(|&at| own[at]).fold(f64::INFINITY, f64::min), time);
    if let (Some(held), Some(free)) = (step(&holding), step(&others))
        && held < free
    {
        let names: Vec<_> = holding.iter().filter_map(|&at| Some(&runs[at].as_ref()?.name)).collect();
        let names = words::list(&names, "and", words::quoted);
        let [held, free] = [held, free].map(words::short);
        let message = format!("all runs take steps of {held} s, because of {names}; the others would take {free} s");
        let help = format!("write `step = \"auto\"` for {names} alone, unless all runs need the same step");
        report.warn(&key_path!["time", "step"], message, help);
    }
}

/// The longest step (s) that divides the time between two frames into a whole number of steps, and is at most the
/// documented share of the largest stable one (s); `None` if there is none.
fn automatic(limit: f64, time: &TimeFile) -> Option<f64> {
    let frame = 1.0 / time.frames_per_second;
    // In a scene with one frame steps divide its duration.
    let frame = if time.duration > 0.0 { frame.min(time.duration) } else { frame };
    (limit > 0.0 && limit.is_finite()).then(|| frame / (frame / (Stability::SHARE * limit)).ceil())
}

/// The message and remedy for a run without a step by `step = "auto"`.
fn no_limit(run: &RunFile, integrator: Integrator, limit: f64) -> (String, String) {
    let (name, method) = (words::quoted(&run.name), words::quoted(&crate::reading::captions::typed(&integrator)));
    match limit > 0.0 {
        true => (
            format!("`step = \"auto\"` finds no limit for {name}: {method} is stable with any step"),
            "give a step that resolves the motion".into(),
        ),
        false => (
            format!("`step = \"auto\"` finds no step for {name}: {method} is never stable without damping"),
            "give a step, or use another integrator".into(),
        ),
    }
}
