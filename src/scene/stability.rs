//! Predictions of the stability of a scene's runs.

use super::{Run, Scene};
use crate::reading::words::{quoted, short};
use crate::sim::Integrator;
use crate::sim::stability::{Restraint, Stability};

impl Scene {
    /// What keeps nodes of a run from vibrating.
    pub(crate) fn restraint(&self, run: usize) -> Restraint<'_> {
        Restraint { grips: &self.runs[run].grips, duration: self.duration, mass_damping: self.mass_damping }
    }

    /// The largest stable step of a run, and the name of the body that limits it; `None` if the run has only one, or no
    /// limit.
    pub(crate) fn stability(&self, run: usize) -> (Stability, Option<&str>) {
        let (restraint, run) = (self.restraint(run), &self.runs[run]);
        let each = Stability::of_each(&run.bodies, &run.models, run.integrator, restraint);
        let all = Stability::of_all(&each);
        let limiting = each.iter().position(|one| one.largest == all.largest);
        let limiting = limiting.filter(|_| each.len() > 1 && all.largest.is_finite());
        (all, limiting.map(|body| self.bodies[run.of[body]].name.as_str()))
    }

    /// The message and remedy for a run whose step is more than 0.9 of the largest stable one. Runs far below, nearly all, need no
    /// exact eigenvalue. Explicit Euler without damping has another message ([`Self::never_stable`]).
    pub(super) fn near_limit(&self, number: usize) -> Option<[String; 2]> {
        const NEAR: f64 = 0.9;
        let run = &self.runs[number];
        let Run { bodies, models, integrator, step, .. } = run;
        let is_far = || Stability::is_below(bodies, models, *integrator, self.restraint(number), *step / NEAR);
        if run.tolerance.is_some() || is_far() {
            return None;
        }
        let (Stability { largest, .. }, body) = self.stability(number);
        let share = run.step / largest;
        if largest == 0.0 || share <= NEAR {
            return None;
        }
        let (name, step, limit) = (quoted(&run.name), short(run.step), short(largest));
        let percent = (100.0 * share).round();
        let outcome = if share > 1.0 { "; the run may diverge" } else { "" };
        let body = body.map_or_else(String::new, |body| format!(" of {}", quoted(body)));
        let message = format!(
            "the time step of {name} is {step} s, {percent} % of the largest that is stable at rest, {limit} s{body}{outcome}"
        );
        let half = short(Stability::SHARE * largest);
        Some([message, format!("use {half} s or less, or `step = \"auto\"`")])
    }

    /// The message and remedy for a run whose step makes a body much softer than its model says, as `xpbd` does.
    pub(super) fn softened(&self, number: usize) -> Option<[String; 2]> {
        const MUCH: f64 = 0.1;
        let run = &self.runs[number];
        let Run { name, step, of, .. } = run;
        let of_each = run
            .models_and_bodies()
            .map(|(model, body)| model.projection(body).map_or(0.0, |projection| projection.softening(*step) - 1.0));
        let (body, excess) = of_each.enumerate().max_by(|one, other| one.1.total_cmp(&other.1))?;
        if run.recording.is_some() || excess <= MUCH {
            return None;
        }
        let body = if of.len() > 1 { format!(" of {}", quoted(&self.bodies[of[body]].name)) } else { String::new() };
        let (name, step, excess, longest) =
            (quoted(name), short(*step), (100.0 * excess).round(), short(step * (MUCH / excess).sqrt()));
        let message = format!(
            "with the time step of {name}, {step} s, the one iteration of `xpbd`{body} gives way about {excess} % more than its stiffness says"
        );
        Some([message, format!("use {longest} s or less for {} %", 100.0 * MUCH)])
    }

    /// The message and remedy for a run that is unstable with any step: explicit Euler without damping.
    pub(super) fn never_stable(&self, number: usize) -> Option<[String; 2]> {
        let run = &self.runs[number];
        (run.integrator == Integrator::ExplicitEuler && self.is_undamped(run)).then(|| {
            let name = quoted(&run.name);
            [
                format!("`explicit-euler` adds energy to {name} with any step, because the run has no damping"),
                "use \"semi-implicit-euler\", or give the run a `damping_ratio`".to_owned(),
            ]
        })
    }

    /// The approximate share of energy that each rebound adds to an undamped run with `e = 1`: elastic forces change
    /// within the step of the rebound. Measured for blocks of eight cubes that fall 1 m, with steps of T/25 to T/400:
    /// 0.14 to 0.23 times the square of the step over the limit, for the shape model and springs.
    pub(super) fn rebound_gain(&self, number: usize, largest: f64) -> Option<f64> {
        const GAIN: f64 = 0.2;
        let run = &self.runs[number];
        let is_elastic = self.obstacles.iter().any(|obstacle| obstacle.restitution == 1.0);
        let has_limit = run.tolerance.is_none() && largest > 0.0 && largest.is_finite();
        let share = run.step / largest;
        (is_elastic && has_limit && share < 1.0 && self.is_undamped(run)).then_some(GAIN * share * share)
    }

    /// Whether a body of a run has no damping.
    fn is_undamped(&self, run: &Run) -> bool {
        self.mass_damping == 0.0 && run.models_and_bodies().any(|(model, body)| !model.prepare(body).is_damped())
    }
}
