//! The runs: their bodies, models and integrators.

use super::Typed;
use super::choice::{self, Choice, TypedModel};
use super::grips::SceneGrip;
use super::loads::SceneLoad;
use super::recordings::{ReadRecording, Shown};
use super::steps::Steps;
use crate::reading::captions::typed;
use crate::reading::collector::{Collector, key_path};
use crate::reading::words;
use crate::scene::file::RunFile;
use crate::scene::{ALL_BODIES, Recorded, Run, SceneBody};
use crate::sim::model::{ElasticModel, Misfit};
use crate::sim::{Assembly, Body, Grip, Integrator, Kernel, Loading, State};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The bodies of a run with their models and constraints.
pub(super) struct Parts {
    /// Their places in the scene.
    of: Vec<usize>,
    pub(super) bodies: Arc<Assembly>,
    /// The initial state of all of them.
    initial: State,
    pub(super) models: Vec<Arc<dyn ElasticModel>>,
    pub(super) grips: Vec<Grip>,
    grip_names: Vec<String>,
    loads: Vec<Arc<Loading>>,
    recording: Option<Arc<Recorded>>,
}

impl Parts {
    /// Each model with its body.
    pub(super) fn iter(&self) -> impl Iterator<Item = (&dyn ElasticModel, &Arc<Body>)> {
        self.models.iter().map(|model| &**model).zip(self.bodies.bodies())
    }

    /// Whether a model moves its nodes itself.
    pub(super) fn is_projected(&self) -> bool {
        self.iter().any(|(model, body)| model.projection(body).is_some())
    }

    /// The code that computes steps fastest.
    fn fastest(&self, integrator: Integrator) -> Kernel {
        let mut kernels = self.models.iter().map(|model| Kernel::of(&**model, integrator));
        kernels.find(|kernel| *kernel != Kernel::Fast).unwrap_or(Kernel::Fast)
    }
}

/// Some bodies together, and the initial state of all of them.
fn together<'a>(all: impl Iterator<Item = &'a SceneBody> + Clone) -> (Arc<Assembly>, State) {
    let joined = |part: fn(&State) -> &[glam::DVec3]| all.clone().flat_map(|one| part(&one.initial)).copied().collect();
    let initial = State::new(joined(|state| &state.position), joined(|state| &state.velocity));
    (Arc::new(Assembly::new(all.map(|one| Arc::clone(&one.body)).collect())), initial)
}

/// The resolved parts that runs consist of.
#[derive(Clone, Copy)]
pub(super) struct Resolved<'a> {
    /// The bodies and models of each run.
    pub(super) choices: &'a [Option<Choice<'a>>],
    /// The bodies of the scene.
    pub(super) bodies: &'a [SceneBody],
    pub(super) grips: &'a [SceneGrip],
    pub(super) loads: &'a [SceneLoad],
}

impl Resolved<'_> {
    /// The bodies of each run with their models, and the own bodies of recordings; `None` after a mistake in a model or a
    /// recording.
    fn parts(
        self,
        runs: &[Option<RunFile>],
        recordings: Vec<Option<ReadRecording>>,
        report: &mut Collector<'_>,
    ) -> Option<(Vec<Parts>, Vec<SceneBody>)> {
        let mut own = Vec::new();
        // Runs of the same bodies share them.
        let mut known: BTreeMap<&[usize], (Arc<Assembly>, State)> = BTreeMap::new();
        let mut parts = |at: usize, run: &Option<RunFile>, read: Option<ReadRecording>| {
            let (Choice { of, models }, run) = self.choices[at].as_ref().zip(run.as_ref())?;
            let all = || together(of.iter().map(|&body| &self.bodies[body]));
            let (bodies, initial) = known.entry(of).or_insert_with(all).clone();
            if run.states.is_none() {
                let models = self.models(of, models, report)?;
                let (grips, grip_names) = self.grips.iter().flat_map(|grip| grip.in_run(of, &bodies)).unzip();
                let loads = self.loads.iter().flat_map(|load| load.in_run(of, &bodies)).map(Arc::new).collect();
                return Some(Parts {
                    of: of.clone(),
                    bodies,
                    initial,
                    models,
                    grips,
                    grip_names,
                    loads,
                    recording: None,
                });
            }
            let (recorded, shown) = read?.shown(run, bodies.whole(), report)?;
            let (of, bodies, initial) = match shown {
                Shown::Bodies(start) => (of.clone(), bodies, *start),
                Shown::Own(body) => {
                    if self.bodies.iter().any(|other| other.name == body.name) || body.name == ALL_BODIES {
                        let name = words::quoted(&run.name);
                        let message =
                            format!("{name} shows a body of its own, which has this name, too, as has another");
                        report.at(&key_path!["run", at, "name"], message, "give the run another name");
                        return None;
                    }
                    let (bodies, initial) = together(std::iter::once(&*body));
                    own.push(*body);
                    (vec![self.bodies.len() + own.len() - 1], bodies, initial)
                }
            };
            let (models, grips, grip_names, loads) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
            Some(Parts { of, bodies, initial, models, grips, grip_names, loads, recording: Some(recorded) })
        };
        // Mistakes of all runs are reported.
        let all: Vec<_> = (0..).zip(runs).zip(recordings).map(|((at, run), read)| parts(at, run, read)).collect();
        Some((all.into_iter().collect::<Option<_>>()?, own))
    }

    /// The models of some bodies, or `None` after reporting all that do not fit.
    fn models(
        self,
        of: &[usize],
        typed: &[TypedModel<'_>],
        report: &mut Collector<'_>,
    ) -> Option<Vec<Arc<dyn ElasticModel>>> {
        let resolved = of.iter().zip(typed).map(|(&at, typed)| {
            let body = &self.bodies[at];
            let misfit = |Misfit { key, message }| {
                let of = if of.len() > 1 { format!("{}: ", body.in_words()) } else { String::new() };
                report.at(&key_path![typed.path; key], of + &message, None);
            };
            typed.model.resolve(&body.body, body.springs.as_deref()).map_err(misfit).ok()
        });
        let resolved: Vec<_> = resolved.collect();
        let models = resolved.into_iter().collect::<Option<Vec<_>>>()?;
        warn_without_effect(of.iter().map(|&at| &self.bodies[at].body), typed, report);
        Some(models)
    }

    /// A run; `None` after reporting a mistake.
    fn run(self, at: usize, run: &RunFile, parts: Parts, steps: &Steps<'_>, report: &mut Collector<'_>) -> Option<Run> {
        let integrator = steps.integrator(run);
        let (step, tolerance) = steps.of(at, run, parts.recording.as_deref(), report)?;
        let refusals =
            parts.iter().map(|(model, body)| integrator.refusal(model, body, steps.mass_damping)).enumerate();
        if let Some((body, reason)) = refusals.into_iter().find_map(|(body, reason)| Some((body, reason?))) {
            let name = words::quoted(&typed(&integrator));
            // The integrator of the scene suits other runs.
            match (run.integrator, &self.choices[at]) {
                (None, Some(choice)) => {
                    let message = format!("{name}, which is `time.integrator`, {reason}");
                    report.at(&choice.models[body].path, message, "or give this run an `integrator` of its own");
                }
                _ => report.at(&key_path!["run", at, "integrator"], format!("{name} {reason}"), None),
            }
            return None;
        }
        let fastest = parts.fastest(integrator);
        let kernel = run.kernel.unwrap_or(fastest);
        if kernel == Kernel::Fast && fastest != Kernel::Fast {
            let slow = parts.iter().position(|(model, _)| Kernel::of(model, integrator) != Kernel::Fast);
            let slow = slow.filter(|_| parts.of.len() > 1).and_then(|slow| self.bodies.get(parts.of[slow]));
            let of = slow.map_or(String::new(), |body| format!(" of {}", body.in_words()));
            let message = format!(
                "`run[{at}].kernel` is \"fast\", but this `integrator`, `model.kind` or `model.rotation`{of} has no vectorised steps"
            );
            report.at(&key_path!["run", at, "kernel"], message, "remove it, or write \"reference\"");
            return None;
        }
        let Parts { of, bodies, initial, models, grips, grip_names, loads, recording } = parts;
        let (name, colour) = (run.name.clone(), run.colour.map(|colour| colour.0));
        let place = 0;
        Some(Run {
            name,
            of,
            bodies,
            initial,
            rest: None,
            comes_to_rest: None,
            placed: None,
            models,
            recording,
            grips,
            grip_names,
            loads,
            integrator,
            step,
            tolerance,
            kernel,
            place,
            colour,
        })
    }
}

/// Warns of parameters that have no effect on any of the bodies of their model.
fn warn_without_effect<'a>(
    bodies: impl Iterator<Item = &'a Arc<Body>>,
    typed: &[TypedModel<'_>],
    report: &mut Collector<'_>,
) {
    let parts: Vec<_> = bodies.zip(typed).collect();
    for models in parts.chunk_by(|(_, one), (_, other)| one.path == other.path) {
        let idle = models.iter().map(|(body, typed)| typed.model.without_effect(body)).collect::<Option<Vec<_>>>();
        if let Some(Misfit { key, message }) = idle.and_then(|idle| idle.into_iter().next()) {
            report.warn(&key_path![models[0].1.path; key], message, None);
        }
    }
}

/// Reports names of runs that are not unique, or cannot be used in files.
pub(super) fn check_names<'a>(runs: &'a [Option<RunFile>], report: &mut Collector<'_>) {
    let name = |run: &'a Option<RunFile>| Some(run.as_ref()?.name.as_str());
    let named = runs.iter().enumerate().map(|(at, run)| (key_path!["run", at].to_vec(), name(run)));
    choice::check_names(["run", "runs"], named, report);
}

/// The runs, and the own bodies of recordings, or `None` if a part that they need has a mistake.
pub(super) fn resolve(
    scene: &Typed<'_>,
    recordings: Vec<Option<ReadRecording>>,
    resolved: Resolved<'_>,
    report: &mut Collector<'_>,
) -> Option<(Vec<Run>, Vec<SceneBody>)> {
    let runs = &scene.file.run;
    // T depends on all models: without one of them, steps would be reported wrongly.
    let (parts, own) = resolved.parts(runs, recordings, report)?;
    let steps = Steps::new(scene.file, &parts, report)?;
    let run =
        |(at, (run, parts)): (usize, (&Option<RunFile>, Parts))| resolved.run(at, run.as_ref()?, parts, &steps, report);
    let runs = runs.iter().zip(parts).enumerate().map(run).collect::<Option<_>>()?;
    Some((runs, own))
}
