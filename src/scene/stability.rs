//! What is predicted of the stability of a scene's runs before they start.

use super::{RunSummary, Scene};
use crate::reading::words::{quoted, short};
use crate::sim::stability::Stability;

impl Scene {
    /// The largest stable step of a run.
    pub(crate) fn stability(&self, run: usize) -> Stability {
        let run = &self.runs[run];
        Stability::of(&self.body, run.model.as_ref(), run.integrator, &self.grips, self.duration)
    }

    /// What to say of a run whose step is above a share of the largest stable one, and what to do. No eigenvalue is computed for runs
    /// that are far below, as nearly all are. Nothing is said of explicit Euler without damping, which no step makes stable, and of
    /// models of the caller's own.
    pub(super) fn near_limit(&self, number: usize) -> Option<(String, String)> {
        const NEAR: f64 = 0.9;
        let run = &self.runs[number];
        if Stability::certain(&self.body, run.model.as_ref(), run.integrator).is_none_or(|step| run.step <= NEAR * step)
        {
            return None;
        }
        let Stability { largest, .. } = self.stability(number);
        let share = run.step / largest;
        if run.tolerance.is_some() || largest == 0.0 || share <= NEAR {
            return None;
        }
        let (name, step, limit) = (quoted(&run.name), short(run.step), short(largest));
        let percent = (100.0 * share).round();
        let outcome = if share > 1.0 { "; the run would diverge" } else { "" };
        let message = format!(
            "the time step of {name} is {step} s, {percent} % of the largest that is stable at rest, {limit} s{outcome}"
        );
        let half = short(Stability::SHARE * largest);
        Some((message, format!("use {half} s or less, or `step = \"auto\"`")))
    }

    /// The runs whose step is larger than the largest stable one, where there is one: what to say of each, and what to do.
    pub(crate) fn too_large_steps(&self) -> Vec<String> {
        let runs = (0..self.runs.len()).filter(|&run| {
            let step = self.runs[run].step;
            self.near_limit(run).is_some() && step > self.stability(run).largest
        });
        runs.filter_map(|run| self.near_limit(run)).map(|(message, help)| format!("{message}: {help}")).collect()
    }
}

/// The largest stable step of a run in words, and the share of it that its step takes.
pub(super) fn in_words(run: &RunSummary) -> String {
    let part =
        |limit: f64| format!("{} s ({} % used)", short(limit), short((1000.0 * run.step / limit).round() / 10.0));
    match run.largest_step {
        None => "stable with any step".to_owned(),
        Some(0.0) => format!("no step is stable: {} needs damping", run.integrator),
        Some(largest) => {
            let stretched = run.largest_stretched_step.map(|limit| format!(", {} with stretched springs", part(limit)));
            format!("largest stable step {}{}", part(largest), stretched.unwrap_or_default())
        }
    }
}
