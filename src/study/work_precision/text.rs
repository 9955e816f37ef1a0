//! The results as Markdown, CSV and JSON.

use super::{Cost, Measured, Results, Study};
use crate::output::exact;
use crate::sim::integrate::Integrator;
use crate::sim::rotation::RotationReading;
use crate::sim::words::typed;
use crate::table::Sheet;
use serde_json::{Value, json};

/// The errors for which a method is recommended.
const WANTED: [f64; 7] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-9];

/// The error for which solvers of rotations are compared.
const SOLVERS_FOR: f64 = 1e-2;

impl Results {
    /// The results for people; `mark` is the command that repeats them.
    pub(crate) fn markdown(&self, mark: &str, machine: &str) -> String {
        let time = if self.is_processor_time { "Processor" } else { "Wall" };
        let mut text = format!(
            "<!-- {mark} -->\n\
            # Integrators: error against work\n\n\
            Errors are the greatest distances of nodes from the reference at the end of the scene, as shares of the body's size. \
            Rotations are those of `robust`, if nothing else is said. Evaluations of the forces include those of the start. {time} time of one thread on {machine}: medians of {} turn{} in \
            which all runs take turns. Other machines give other times.\n",
            self.protocol.rounds,
            if self.protocol.rounds == 1 { "" } else { "s" },
        );
        for study in &self.studies {
            text += &study.markdown();
        }
        text
    }

    /// All runs, with all digits.
    pub(crate) fn csv(&self) -> String {
        let rows = self.studies.iter().flat_map(|study| study.measured.iter().map(move |one| (study, one)));
        let row = |(study, one): (&Study, &Measured)| {
            let own = study.reference.as_ref().map_or(f64::NAN, |reference| reference.error);
            let is_adaptive = one.integrator.is_adaptive();
            [
                ("scene", study.name.clone()),
                ("integrator", typed(&one.integrator)),
                ("rotation", one.rotation.map_or_else(String::new, |rotation| typed(&rotation))),
                ("kernel", if one.is_fast { "fast" } else { "reference" }.to_owned()),
                ("step_s", if is_adaptive { String::new() } else { exact(one.step) }),
                ("tolerance", if is_adaptive { exact(one.step) } else { String::new() }),
                ("evaluations", one.evaluations.to_string()),
                ("error", one.error.map_or_else(String::new, exact)),
                ("reference_error", exact(own)),
                ("s_median", exact(one.time.median)),
                ("s_lower", exact(one.time.lower)),
                ("s_upper", exact(one.time.upper)),
                ("s_least", exact(one.time.least)),
                ("status", status(one).to_owned()),
            ]
        };
        Sheet::of(rows.map(row)).csv()
    }

    /// The results as one JSON document.
    pub(crate) fn json(&self, machine: &str) -> Value {
        let run = |one: &Measured| {
            json!({
                "integrator": one.integrator,
                "rotation": one.rotation,
                "kernel": if one.is_fast { "fast" } else { "reference" },
                "step": (!one.integrator.is_adaptive()).then_some(one.step),
                "tolerance": one.integrator.is_adaptive().then_some(one.step),
                "evaluations": one.evaluations,
                "error": one.error,
                "status": status(one),
                "seconds": one.time,
            })
        };
        let study = |study: &Study| {
            let refused = study.refused.iter().map(|(one, why)| json!({ "integrator": one, "reason": why }));
            json!({
                "scene": study.name,
                "reference_error": study.reference.as_ref().ok().map(|reference| reference.error),
                "no_reference": study.reference.as_ref().err(),
                "runs": study.measured.iter().map(run).collect::<Vec<_>>(),
                "refused": refused.collect::<Vec<_>>(),
            })
        };
        json!({ "machine": machine, "studies": self.studies.iter().map(study).collect::<Vec<_>>() })
    }
}

impl Study {
    fn markdown(&self) -> String {
        let (duration, cycles) = (self.duration, short(self.duration / self.cycle));
        let mut text = format!("\n## {}\n\n{}; {duration} s, {cycles} cycles T.", self.name, self.words);
        match &self.reference {
            Ok(reference) => {
                let [one, other] = reference.integrators.map(|one| typed(&one));
                text += &format!(
                    " The reference is by {one} and {other} with small steps, which end {:.0e} of the body's size apart.\n",
                    reference.error
                );
                text += "\n### Recommended\n\n";
                text += &self.recommendations().markdown(1);
                text += "\n### Orders, and the least errors\n\n";
                text += &self.orders().markdown(1);
                if self.solvers().next().is_some() {
                    text += &format!(
                        "\n### Solvers of rotations\n\nTime (ms) for an error of {SOLVERS_FOR:e}, and the least error \
                         with any of these integrators. Solvers with a fixed number of passes give forces that depend on the \
                         evaluation before, which methods of several evaluations a step cannot use.\n\n",
                    );
                    text += &self.rotations().markdown(1);
                }
            }
            Err(why) => text += &format!("\n\n{why}.\n"),
        }
        for (integrator, why) in &self.refused {
            text += &format!("\n{} {why}.\n", typed(integrator));
        }
        text
    }

    /// A row for each error that some method reaches.
    fn recommendations(&self) -> Sheet {
        let own = self.reference.as_ref().map_or(f64::INFINITY, |reference| reference.error);
        let wanted = WANTED.into_iter().filter(|&error| error > own);
        let rows = wanted.filter_map(|error| {
            let costs: Vec<_> = self.integrators().filter_map(|one| self.cost(one, error)).collect();
            let least = |of: fn(&Cost) -> f64| costs.iter().min_by(|one, other| of(one).total_cmp(&of(other)));
            let (fewest, fastest) = (least(|one| one.evaluations)?, least(|one| one.time)?);
            let euler = self.cost(Integrator::SemiImplicitEuler, error);
            let times =
                |euler: Option<f64>| euler.map_or_else(|| "–".to_owned(), |times| format!("{} ×", short(times)));
            Some([
                ("error", format!("{error:e}")),
                ("fewest evaluations", format!("{}, {}", typed(&fewest.integrator), self.step(fewest))),
                ("evaluations", short(fewest.evaluations)),
                ("semi-implicit Euler", times(euler.map(|euler| euler.evaluations / fewest.evaluations))),
                ("least time", format!("{}, {}", typed(&fastest.integrator), self.step(fastest))),
                ("ms", short(1e3 * fastest.time)),
                ("semi-implicit Euler, time", times(euler.map(|euler| euler.time / fastest.time))),
            ])
        });
        Sheet::of(rows)
    }

    /// A row for each solver of rotations.
    fn rotations(&self) -> Sheet {
        let columns = [
            ("semi-implicit-euler", Integrator::SemiImplicitEuler),
            ("velocity-verlet", Integrator::VelocityVerlet),
            ("pefrl", Integrator::Pefrl),
            ("runge-kutta", Integrator::RungeKutta),
        ];
        let row = |rotation: RotationReading| {
            let times = columns.map(|(head, integrator)| {
                let time = self.cost_with(integrator, rotation, SOLVERS_FOR).map(|cost| short(1e3 * cost.time));
                (head, time.unwrap_or_else(|| "–".to_owned()))
            });
            let of_all = columns.iter().flat_map(|&(_, one)| self.with(one, rotation)).filter_map(|one| one.error);
            let [one, two, three, four] = times;
            let least = of_all.fold(f64::INFINITY, f64::min);
            [("solver", typed(&rotation)), one, two, three, four, ("least error", format!("{least:.0e}"))]
        };
        Sheet::of(self.solvers().map(row))
    }

    /// The step or the tolerance in words.
    fn step(&self, cost: &Cost) -> String {
        match cost.integrator.is_adaptive() {
            true => format!("tolerance {:.0e}", cost.step),
            false => format!("T/{}", short(self.cycle / cost.step)),
        }
    }

    fn orders(&self) -> Sheet {
        let row = |one: Integrator| {
            let runs = || self.of(one).filter_map(|run| Some((run, run.error?)));
            let coarsest = runs().next().map(|(run, _)| run);
            let least = runs().map(|(_, error)| error).fold(f64::INFINITY, f64::min);
            let step = |run: &Measured| {
                let Measured { integrator, step, .. } = *run;
                self.step(&Cost { integrator, step, evaluations: 0.0, time: 0.0 })
            };
            [
                ("integrator", typed(&one)),
                ("order", self.order(one).map_or_else(|| "–".to_owned(), |order| format!("{order:.2}"))),
                ("largest step that does not diverge", coarsest.map_or_else(|| "–".to_owned(), step)),
                ("least error", format!("{least:.0e}")),
                ("given up", self.of(one).find(|run| run.is_given_up).map_or_else(|| "–".to_owned(), step)),
            ]
        };
        Sheet::of(self.integrators().map(row))
    }
}

/// How a run ended.
fn status(one: &Measured) -> &'static str {
    match one.error {
        Some(_) => "ok",
        None if one.is_given_up => "given up",
        None => "diverged",
    }
}

/// A number with two or three digits.
fn short(number: f64) -> String {
    if number >= 100.0 {
        format!("{number:.0}")
    } else if number >= 10.0 {
        format!("{number:.1}")
    } else {
        format!("{number:.2}")
    }
}
