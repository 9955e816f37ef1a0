//! The runs: their bodies, models and integrators.

use super::Typed;
use super::choice::{Choice, TypedModel};
use super::grips::SceneGrip;
use super::loads::SceneLoad;
use super::recordings::ReadRecording;
use super::steps::Steps;
use crate::look::LinePlace;
use crate::reading::captions;
use crate::reading::words;
use crate::scene::file::RunFile;
use crate::scene::{ALL_BODIES, Run, SceneBody};
use crate::sim::model::{ElasticModel, Misfit};
use crate::sim::{Assembly, Body, Integrator, Kernel, State};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The code that computes the steps of a run fastest.
fn fastest(run: &Run, integrator: Integrator) -> Kernel {
    let mut kernels = run.models.iter().map(|model| Kernel::of(&**model, integrator));
    kernels.find(|kernel| *kernel != Kernel::Fast).unwrap_or(Kernel::Fast)
}

/// A run of some bodies without models. Its step depends on all runs, and is not known yet.
fn bare(typed: &RunFile, of: Vec<usize>, (bodies, initial): (Arc<Assembly>, State)) -> Run {
    Run {
        name: typed.name.clone(),
        of,
        bodies,
        initial,
        rest: None,
        comes_to_rest: None,
        placed: None,
        models: Vec::new(),
        recording: None,
        grips: Vec::new(),
        grip_names: Vec::new(),
        loads: Vec::new(),
        integrator: Integrator::default(),
        step: f64::NAN,
        tolerance: None,
        kernel: Kernel::Reference,
        place: LinePlace::default(),
        colour: typed.colour.map(|colour| colour.0),
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
    pub(super) scene: &'a Typed<'a>,
    /// The bodies and models of each run.
    pub(super) choices: &'a [Option<Choice<'a>>],
    /// The bodies of the scene.
    pub(super) bodies: &'a [SceneBody],
    pub(super) grips: &'a [SceneGrip<'a>],
    pub(super) loads: &'a [SceneLoad<'a>],
}

impl Resolved<'_> {
    /// The runs, and the own bodies of recordings, or `None` if a part that they need has a mistake.
    pub(super) fn runs(self, recordings: Vec<Option<ReadRecording<'_>>>) -> Option<(Vec<Run>, Vec<SceneBody>)> {
        // T depends on all models: without one of them, steps would be reported wrongly.
        let (found, own) = self.without_steps(recordings)?;
        let steps = Steps::new(self.scene, &found)?;
        let run =
            |(at, (typed, run)): (usize, (&Option<RunFile>, Run))| self.with_step(at, (typed.as_ref()?, run), &steps);
        let runs = self.scene.file.run.iter().zip(found).enumerate().map(run).collect::<Option<_>>()?;
        Some((runs, own))
    }

    /// The runs without their steps, and the own bodies of recordings; `None` after a mistake in a model or a recording.
    fn without_steps(self, recordings: Vec<Option<ReadRecording<'_>>>) -> Option<(Vec<Run>, Vec<SceneBody>)> {
        let is_beside = self.scene.file.run.iter().flatten().any(|run| run.states.is_none());
        let mut own = Vec::new();
        // Runs of the same bodies share them.
        let mut known: BTreeMap<&[usize], (Arc<Assembly>, State)> = BTreeMap::new();
        let mut resolved = |at: usize, typed: &Option<RunFile>, read: Option<ReadRecording<'_>>| {
            let (Choice { of, models }, typed) = self.choices[at].as_ref().zip(typed.as_ref())?;
            let all = || together(of.iter().map(|&body| &self.bodies[body]));
            let (bodies, initial) = known.entry(of).or_insert_with(all).clone();
            if typed.states.is_none() {
                let models = self.models(of, models)?;
                let (grips, grip_names) = self.grips.iter().flat_map(|grip| grip.in_run(of, &bodies)).unzip();
                let loads = self.loads.iter().flat_map(|load| load.in_run(of, &bodies)).map(Arc::new).collect();
                return Some(Run { models, grips, grip_names, loads, ..bare(typed, of.clone(), (bodies, initial)) });
            }
            let (recorded, start, shown) = read?.shown(typed, bodies.whole(), is_beside)?;
            let run = match shown {
                None => bare(typed, of.clone(), (bodies, start)),
                Some(body) => {
                    if self.bodies.iter().any(|other| other.name == body.name) || body.name == ALL_BODIES {
                        let name = words::quoted(&typed.name);
                        let message =
                            format!("{name} shows a body of its own, which has this name, too, as has another");
                        self.scene.report.to("run").to(at).to("name").wrong(message, "give the run another name");
                        return None;
                    }
                    let together = together(std::iter::once(&body));
                    own.push(body);
                    bare(typed, vec![self.bodies.len() + own.len() - 1], together)
                }
            };
            Some(Run { recording: Some(recorded), ..run })
        };
        // Mistakes of all runs are reported.
        let all: Vec<_> =
            (0..).zip(&self.scene.file.run).zip(recordings).map(|((at, run), read)| resolved(at, run, read)).collect();
        Some((all.into_iter().collect::<Option<_>>()?, own))
    }

    /// The models of some bodies, or `None` after reporting all that do not fit.
    fn models(self, of: &[usize], typed: &[TypedModel<'_>]) -> Option<Vec<Arc<dyn ElasticModel>>> {
        let resolved = of.iter().zip(typed).map(|(&at, typed)| {
            let body = &self.bodies[at];
            let misfit = |Misfit { key, message }| {
                let of = if of.len() > 1 { format!("{}: ", body.in_words()) } else { String::new() };
                typed.here.to(key).wrong(of + &message, None);
            };
            typed.model.resolve(&body.body, body.springs.as_deref()).map_err(misfit).ok()
        });
        let resolved: Vec<_> = resolved.collect();
        let models = resolved.into_iter().collect::<Option<Vec<_>>>()?;
        warn_without_effect(of.iter().map(|&at| &self.bodies[at].body), typed);
        Some(models)
    }

    /// A run with its step; `None` after reporting a mistake.
    fn with_step(self, at: usize, (typed, run): (&RunFile, Run), steps: &Steps<'_>) -> Option<Run> {
        let here = self.scene.report.to("run").to(at);
        let integrator = steps.integrator(typed);
        let (step, tolerance) = steps.of(at, typed, run.recording.as_deref())?;
        let parts = run.models_and_bodies();
        let refusals =
            parts.map(|(model, body)| integrator.refusal(model, body, self.scene.file.mass_damping())).enumerate();
        if let Some((body, reason)) = refusals.into_iter().find_map(|(body, reason)| Some((body, reason?))) {
            let name = words::quoted(&captions::typed(&integrator));
            // The integrator of the scene suits other runs.
            match (typed.integrator, &self.choices[at]) {
                (None, Some(choice)) => {
                    let message = format!("{name}, which is `time.integrator`, {reason}");
                    choice.models[body].here.wrong(message, "or give this run an `integrator` of its own");
                }
                _ => here.to("integrator").wrong(format!("{name} {reason}"), None),
            }
            return None;
        }
        let fastest = fastest(&run, integrator);
        let kernel = typed.kernel.unwrap_or(fastest);
        if kernel == Kernel::Fast && fastest != Kernel::Fast {
            let slow = run.models.iter().position(|model| Kernel::of(&**model, integrator) != Kernel::Fast);
            let slow = slow.filter(|_| run.of.len() > 1).and_then(|slow| self.bodies.get(run.of[slow]));
            let of = slow.map_or(String::new(), |body| format!(" of {}", body.in_words()));
            let message = format!(
                "`{here}.kernel` is \"fast\", but this `integrator`, `model.kind` or `model.rotation`{of} has no vectorised steps"
            );
            here.to("kernel").wrong(message, "remove it, or write \"reference\"");
            return None;
        }
        Some(Run { integrator, step, tolerance, kernel, ..run })
    }
}

/// Warns of parameters that have no effect on any of the bodies of their model.
fn warn_without_effect<'a>(bodies: impl Iterator<Item = &'a Arc<Body>>, typed: &[TypedModel<'_>]) {
    let parts: Vec<_> = bodies.zip(typed).collect();
    for models in parts.chunk_by(|(_, one), (_, other)| one.here.path() == other.here.path()) {
        let idle = models.iter().map(|(body, typed)| typed.model.without_effect(body)).collect::<Option<Vec<_>>>();
        if let Some(Misfit { key, message }) = idle.and_then(|idle| idle.into_iter().next()) {
            models[0].1.here.to(key).warn(message, None);
        }
    }
}
