//! The time steps of runs.

use super::Typed;
use crate::reading::captions::typed;
use crate::reading::words;
use crate::scene::file::{RunFile, StepFile, TimeFile};
use crate::scene::step::NamedStep;
use crate::scene::{Recorded, Run};
use crate::sim::Integrator;
use crate::sim::stability::{Restraint, Stability};

/// The most steps of a run. Beyond, double precision cannot distinguish the times of two steps.
const MOST_STEPS: f64 = 9_007_199_254_740_992.0;

/// The steps of a recording between two frames, if the step of the program that made it is not known.
const STEPS_OF_FRAME: f64 = 1024.0;

/// What the time steps of all runs depend on.
pub(super) struct Steps<'a> {
    pub(super) scene: &'a Typed<'a>,
    pub(super) time: &'a TimeFile,
    /// The cycle T of all runs (s).
    cycle: f64,
    /// The largest step for `step = "auto"` of each run (s), and the run that limits it.
    limits: Vec<(f64, usize)>,
}

impl<'a> Steps<'a> {
    /// The steps of these runs.
    pub(super) fn new(scene: &'a Typed<'a>, found: &[Run]) -> Option<Self> {
        let cycle = found.iter().map(Run::shortest_period).fold(f64::INFINITY, f64::min);
        let steps = Self { scene, time: scene.file.time.as_ref()?, cycle, limits: Vec::new() };
        let own = steps.own_limits(found);
        steps.warn_of_held_steps(found, &own);
        Some(Self { limits: limits(own, &steps.sharing()), ..steps })
    }

    /// The integrator of a run.
    pub(super) fn integrator(&self, run: &RunFile) -> Integrator {
        run.integrator.unwrap_or(self.time.integrator)
    }

    /// The time step of a run (s), and its tolerance if its integrator chooses its steps; `None` after reporting a mistake.
    pub(super) fn of(&self, at: usize, run: &RunFile, recording: Option<&Recorded>) -> Option<(f64, Option<f64>)> {
        let (time, integrator) = (self.time, self.integrator(run));
        if recording.is_none() {
            self.check_use(at, run, integrator)?;
        }
        let frame = 1.0 / time.frames_per_second;
        let recorded = recording.map(|recording| recording.step.unwrap_or(frame / STEPS_OF_FRAME));
        let here = self.scene.of_run(at, if recorded.is_some() { "states" } else { "step" });
        let tolerance = run.tolerance.or(time.tolerance).unwrap_or(Integrator::TOLERANCE);
        let tolerance = (integrator.is_adaptive() && recorded.is_none()).then_some(tolerance);
        let typed = run.step.as_ref().or(time.step.as_ref()).unwrap_or(&StepFile::DEFAULT);
        let found = match (recorded, typed) {
            (Some(step), _) => Some(step),
            _ if tolerance.is_some() => Some(frame),
            (None, StepFile::Seconds(seconds)) => Some(*seconds),
            (None, StepFile::Named(named)) => named.of(self.cycle).or_else(|| automatic(self.limits[at].0, time)),
        };
        let Some(step) = found else {
            let (limit, of) = self.limits[at];
            let of = self.scene.file.run[of].as_ref()?;
            let (message, help) = no_limit(of, self.integrator(of), limit);
            here.wrong(message, help);
            return None;
        };
        if let Some((message, help)) = self.refusal(run, step, recorded.is_some(), tolerance.is_some()) {
            here.wrong(message, help);
            return None;
        }
        Some((step, tolerance))
    }

    /// Reports a `step` with an integrator that chooses its own steps, or a tolerance with another one.
    fn check_use(&self, at: usize, run: &RunFile, integrator: Integrator) -> Option<()> {
        let is_adaptive = integrator.is_adaptive();
        let (key, of_run, of_scene) = match is_adaptive {
            true => ("step", run.step.is_some(), self.time.step.is_some()),
            false => ("tolerance", run.tolerance.is_some(), self.time.tolerance.is_some()),
        };
        if !of_run && (!of_scene || run.integrator.is_some()) {
            return Some(());
        }
        let place = self.scene.of_run(at, key);
        let name = words::quoted(&typed(&integrator));
        if is_adaptive {
            let help = "give `tolerance` in place of `step`, such as 1e-6";
            place.wrong(format!("{name} chooses its own steps"), help);
        } else {
            let has_step = run.step.is_some() || self.time.step.is_some();
            let remedy = if has_step { "remove `tolerance`" } else { "give `step` in its place" };
            let help = format!("{remedy}, or write `integrator = \"dormand-prince\"`");
            place.wrong(format!("{name} has fixed steps and no tolerance"), help);
        }
        None
    }

    /// Why a step (s) cannot be taken, and the remedy.
    fn refusal(&self, run: &RunFile, step: f64, is_recorded: bool, is_chosen: bool) -> Option<(String, String)> {
        let (duration, cycle) = (self.time.duration, self.cycle);
        if !(step.is_normal() && step > 0.0 && duration / step <= MOST_STEPS) {
            let message = format!("the time step is {step:e} s with T = {cycle:.4e} s: such steps cannot be counted");
            return Some((message, "make it larger, or masses and stiffness less extreme".to_owned()));
        }
        (step > duration && duration > 0.0 && !is_chosen).then(|| {
            let [name, step, duration] = [words::quoted(&run.name), words::short(step), words::short(duration)];
            let help = match is_recorded {
                true => "make `step` in its archive smaller, or the duration longer".to_owned(),
                false => format!("T = {} s; make the step smaller or the duration longer", words::short(cycle)),
            };
            let scene = format!("longer than the whole scene of {duration} s: nothing would move");
            (format!("the time step of {name} is {step} s, {scene}"), help)
        })
    }

    /// The runs that share `step = "auto"` of the scene.
    fn sharing(&self) -> Vec<usize> {
        let shares = |run: &RunFile| run.step.is_none() && is_auto(&self.time.step);
        let runs = (0..).zip(&self.scene.file.run);
        runs.filter(|(_, run)| run.as_ref().is_some_and(shares)).map(|(at, _)| at).collect()
    }

    /// The largest step (s) for each run with `step = "auto"`, infinite for others: the largest stable one, or for a model that moves its
    /// nodes itself the one that is taken.
    fn own_limits(&self, found: &[Run]) -> Vec<f64> {
        let (sharing, mass_damping) = (self.sharing(), self.scene.file.mass_damping());
        let limit = |(at, (run, found)): (usize, (&Option<RunFile>, &Run))| {
            let Some(run) = run.as_ref().filter(|run| is_auto(&run.step) || sharing.contains(&at)) else {
                return f64::INFINITY;
            };
            let Run { bodies, models, grips, .. } = found;
            let restraint = Restraint { grips, duration: self.time.duration, mass_damping };
            let each = Stability::of_each(bodies, models, self.integrator(run), restraint);
            let largest = Stability::of_all(&each).largest;
            if is_projected(found) { largest.min(Stability::PROJECTED / Stability::SHARE) } else { largest }
        };
        self.scene.file.run.iter().zip(found).enumerate().map(limit).collect()
    }

    /// Warns of a model that moves its nodes itself, if its short steps are those of all runs that share `step = "auto"` of the scene.
    fn warn_of_held_steps(&self, found: &[Run], own: &[f64]) {
        let (holding, others): (Vec<usize>, Vec<usize>) =
            self.sharing().into_iter().partition(|&at| is_projected(&found[at]));
        let step = |of: &[usize]| automatic(of.iter().map(|&at| own[at]).fold(f64::INFINITY, f64::min), self.time);
        if let (Some(held), Some(free)) = (step(&holding), step(&others))
            && held < free
        {
            let names: Vec<_> = holding.iter().map(|&at| &found[at].name).collect();
            let names = words::list(&names, "and", words::quoted);
            let [held, free] = [held, free].map(words::short);
            let message =
                format!("all runs take steps of {held} s, because of {names}; the others would take {free} s");
            let help = format!("write `step = \"auto\"` for {names} alone, unless all runs need the same step");
            self.scene.report.to("time").to("step").warn(message, help);
        }
    }
}

/// Whether a model of a run moves its nodes itself.
fn is_projected(run: &Run) -> bool {
    run.models_and_bodies().any(|(model, body)| model.projection(body).is_some())
}

/// Whether a step is chosen by this program.
fn is_auto(step: &Option<StepFile>) -> bool {
    matches!(step, Some(StepFile::Named(NamedStep::Auto)))
}

/// The largest step (s) for each run, and the run that limits it: the run itself, or among the runs that share the scene's step the one
/// with the least.
fn limits(own: Vec<f64>, sharing: &[usize]) -> Vec<(f64, usize)> {
    let mut limits: Vec<_> = own.into_iter().zip(0..).collect();
    let least = sharing.iter().map(|&at| limits[at]).min_by(|one, other| one.0.total_cmp(&other.0));
    sharing.iter().zip(least.into_iter().cycle()).for_each(|(&at, least)| limits[at] = least);
    limits
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
    let (name, method) = (words::quoted(&run.name), words::quoted(&typed(&integrator)));
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
