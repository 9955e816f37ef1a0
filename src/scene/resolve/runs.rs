//! The runs: models, steps and integrators.

use super::body::ResolvedBody;
use crate::reading::report::{Report, Way};
use crate::reading::words;
use crate::scene::Run;
use crate::scene::file::{RunFile, StepFile, TimeFile};
use crate::sim::integrate::Integrator;
use crate::sim::model::ElasticModel;
use crate::sim::world::Kernel;
use std::sync::Arc;

/// The most steps of a run: beyond, double precision cannot distinguish the times of two steps.
const MOST_STEPS: f64 = 9_007_199_254_740_992.0;

/// The runs, or `None` if a part they need has a mistake.
pub(super) fn resolve(
    typed: &[Option<RunFile>],
    time: Option<&TimeFile>,
    body: Option<&ResolvedBody>,
    report: &mut Report<'_>,
) -> Option<Vec<Run>> {
    check_names(typed, report);
    let body = body?;
    let models: Vec<_> = (0..)
        .zip(typed)
        .map(|(at, run)| {
            let run = run.as_ref()?;
            let typed = || run.model.resolve(&body.body, body.springs.as_deref());
            let model = run.own.clone().map_or_else(typed, Ok);
            let path = |key| [Way::Key("run"), Way::Index(at), Way::Key("model"), Way::Key(key)];
            model.map_err(|misfit| report.at(&path(misfit.key), misfit.message, None)).ok()
        })
        .collect();
    // Without one of the models T would differ, and steps would be reported wrongly.
    let models: Vec<Arc<dyn ElasticModel>> = models.into_iter().collect::<Option<_>>()?;
    let cycle = models.iter().map(|model| model.shortest_period(&body.body)).reduce(f64::min)?;
    let mut runs = Vec::with_capacity(models.len());
    for (at, (run, model)) in typed.iter().zip(models).enumerate() {
        let (run, time) = (run.as_ref()?, time?);
        let integrator = run.integrator.unwrap_or(time.integrator);
        if let Some((path, message, hint)) = misplaced(at, run, time, integrator) {
            report.at(&path, message, hint);
            return None;
        }
        let own = [Way::Key("run"), Way::Index(at), Way::Key("step")];
        let (step, path) = match &run.step {
            Some(step) => (step, &own[..]),
            None => (time.step.as_ref().unwrap_or(&StepFile::DEFAULT), &[Way::Key("time"), Way::Key("step")][..]),
        };
        let typed = run.tolerance.or(time.tolerance);
        let tolerance = integrator.is_adaptive().then(|| typed.unwrap_or(Integrator::TOLERANCE));
        let step = if tolerance.is_some() { 1.0 / time.frames_per_second } else { seconds(step, cycle) };
        if !(step.is_normal() && step > 0.0 && time.duration / step <= MOST_STEPS) {
            let message =
                format!("the time step comes out as {step:e} s with T = {cycle:.4e} s, which cannot be counted");
            report.at(path, message, "make it larger, or masses and stiffness less extreme".to_owned());
            return None;
        }
        if step > time.duration && time.duration > 0.0 && tolerance.is_none() {
            let message = format!(
                "the time step of {} is {} s, longer than the whole scene of {} s: nothing would move",
                words::quoted(&run.name),
                words::short(step),
                words::short(time.duration)
            );
            report.at(
                path,
                message,
                format!("T = {} s; make the step smaller or the duration longer", words::short(cycle)),
            );
            return None;
        }
        if let Some(reason) = integrator.refusal(|| model.prepare(&Arc::new(body.body.clone()))) {
            let path = match run.integrator {
                Some(_) => vec![Way::Key("run"), Way::Index(at), Way::Key("integrator")],
                None => vec![Way::Key("time"), Way::Key("integrator")],
            };
            let message = format!("{} {reason}", words::quoted(&crate::sim::words::typed(&integrator)));
            report.at(&path, message, None);
            return None;
        }
        let colour = run.colour.map(|colour| colour.0);
        let fastest = Kernel::of(model.as_ref(), integrator);
        let kernel = run.kernel.unwrap_or(fastest);
        if kernel == Kernel::Fast && fastest != Kernel::Fast {
            let path = [Way::Key("run"), Way::Index(at), Way::Key("kernel")];
            let message = format!(
                "`run[{at}].kernel` is \"fast\", but this `integrator`, `model.rotation` or `model.damping_of` has no vectorised steps"
            );
            report.at(&path, message, "remove it, or write \"reference\"".to_owned());
            return None;
        }
        runs.push(Run { name: run.name.clone(), model, integrator, step, tolerance, kernel, place: 0, colour });
    }
    Some(runs)
}

/// A step for an integrator that finds its own, or a tolerance for one that does not: where, what and what to do.
fn misplaced(
    at: usize,
    run: &RunFile,
    time: &TimeFile,
    integrator: Integrator,
) -> Option<(Vec<Way<'static>>, String, String)> {
    let own = |key| vec![Way::Key("run"), Way::Index(at), Way::Key(key)];
    let common = |key| vec![Way::Key("time"), Way::Key(key)];
    let name = words::quoted(&crate::sim::words::typed(&integrator));
    if integrator.is_adaptive() {
        let path = if run.step.is_some() { own("step") } else { common("step") };
        let is_typed = run.step.is_some() || time.step.is_some() && run.integrator.is_none();
        let message = format!("{name} finds its own steps");
        return is_typed.then(|| (path, message, "give `tolerance` in place of `step`, such as 1e-6".into()));
    }
    let path = if run.tolerance.is_some() { own("tolerance") } else { common("tolerance") };
    let is_typed = run.tolerance.is_some() || time.tolerance.is_some() && run.integrator.is_none();
    let message = format!("{name} has fixed steps and no tolerance");
    is_typed.then(|| (path, message, "give `step`, or `integrator = \"dormand-prince\"`".into()))
}

fn seconds(step: &StepFile, cycle: f64) -> f64 {
    match step {
        StepFile::Seconds(seconds) => *seconds,
        StepFile::Cycles(fraction) => fraction.of(cycle),
    }
}

/// Reports duplicate names, and names that cannot be used in files.
fn check_names(typed: &[Option<RunFile>], report: &mut Report<'_>) {
    for (at, run) in typed.iter().enumerate() {
        let Some(run) = run else { continue };
        let path = [Way::Key("run"), Way::Index(at), Way::Key("name")];
        let quoted = words::quoted(&run.name);
        let unfit = |c: char| matches!(c, '/' | '\\') || c.is_control();
        if run.name.trim() != run.name || run.name.contains(unfit) {
            let message = format!("the name {quoted} cannot be used in files");
            report.at(&path, message, "no slash, no control character, and no space at either end".to_owned());
        }
        let same = |other: &Option<RunFile>| other.as_ref().is_some_and(|other| other.name == run.name);
        if let Some(first) = typed[..at].iter().position(same) {
            let message = format!("two runs are called {quoted}: `run[{first}]` and `run[{at}]`");
            report.at(&path, message, "give each run a unique name".to_owned());
        }
    }
}
