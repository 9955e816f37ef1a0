//! The results as text and as a table.

use super::method::{End, MOMENTS, Method};
use super::{Comparison, Cost, Measured, Results};
use crate::table::{Cell, Table, or_dash};
use crate::turns::{kind_of_time, machine};

/// The errors for which a method is recommended.
const WANTED: [f64; 7] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-9];

impl Results {
    /// The results as text.
    pub(super) fn text(&self) -> String {
        let head = format!(
            include_str!("text.md"),
            moments = MOMENTS,
            kind_of_time = kind_of_time(),
            machine = machine(),
            rounds = self.effort.rounds,
            s = if self.effort.rounds == 1 { "" } else { "s" },
        );
        [head].into_iter().chain(self.comparisons.iter().map(Comparison::text)).collect()
    }

    /// All runs, with all digits.
    pub(super) fn table(&self) -> Table {
        let rows = self.comparisons.iter().flat_map(|one| one.measured.iter().map(move |run| (one, run)));
        let row = |(comparison, run): (&Comparison, &Measured)| {
            let (is_adaptive, [integrator, rotation]) = (run.attempt.method.is_adaptive(), run.attempt.method.names());
            [
                ("scene", comparison.name.as_str().into()),
                ("integrator", integrator.into()),
                ("rotation", rotation.into()),
                ("kernel", if run.is_fast { "fast" } else { "reference" }.into()),
                ("step_s", if is_adaptive { Cell::Empty } else { run.step.into() }),
                ("tolerance", if is_adaptive { run.step.into() } else { Cell::Empty }),
                ("evaluations", run.evaluations.into()),
                ("error", run.error.into()),
                ("reference_error", comparison.reference.as_ref().ok().map(|reference| reference.error).into()),
                ("s_median", run.time.median.into()),
                ("s_lower", run.time.lower.into()),
                ("s_upper", run.time.upper.into()),
                ("s_least", run.time.least.into()),
                ("status", run.end.words().into()),
            ]
        };
        Table::of(rows.map(row))
    }
}

impl Comparison {
    fn text(&self) -> String {
        let (duration, cycles) = (self.duration, short(self.duration / self.cycle));
        let mut text = format!("\n## {}\n\n{}; {duration} s, {cycles} cycles T.", self.name, self.words);
        match &self.reference {
            Ok(reference) => {
                let [one, other] = reference.methods.map(Method::name);
                text += &format!(
                    " The reference is by {one} and {other} with small steps, which are at most {:.0e} of the body's size apart.\n",
                    reference.error
                );
                text += &format!(
                    "\n### Recommended\n\n{}\n\n### Orders, and the least errors\n\n{}\n",
                    self.recommendations().markdown(1),
                    self.orders().markdown(1)
                );
            }
            Err(why) => text += &format!("\n\n{why}.\n"),
        }
        for (method, why) in &self.refused {
            text += &format!("\n{} {why}.\n", method.name());
        }
        text
    }

    /// A row for each error that a method reaches.
    fn recommendations(&self) -> Table {
        let own = self.reference.as_ref().map_or(f64::INFINITY, |reference| reference.error);
        let wanted = WANTED.into_iter().filter(|&error| error > own);
        let rows = wanted.filter_map(|error| {
            let cost = |method| self.cost(method, error);
            let integrators = self.methods().filter(|method| method.reading.is_none());
            let costs: Vec<_> = integrators.filter_map(cost).collect();
            let least = |of: fn(&Cost) -> f64| costs.iter().min_by(|one, other| of(one).total_cmp(&of(other)));
            let (fewest, fastest) = (least(|one| one.evaluations)?, least(|one| one.time)?);
            let euler = cost(Method::DEFAULT);
            let times = |euler: Option<f64>| or_dash(euler.map(|times| format!("{} ×", short(times))));
            let named = |one: &Cost| format!("{}, {}", one.method.name(), self.step(one.method, one.step)).into();
            Some([
                ("error", format!("{error:e}").into()),
                ("fewest evaluations", named(fewest)),
                ("evaluations", short(fewest.evaluations).into()),
                ("semi-implicit Euler", times(euler.map(|euler| euler.evaluations / fewest.evaluations))),
                ("least time", named(fastest)),
                ("ms", short(1e3 * fastest.time).into()),
                ("semi-implicit Euler, time", times(euler.map(|euler| euler.time / fastest.time))),
            ])
        });
        Table::of(rows)
    }

    /// The step or the tolerance in words.
    fn step(&self, method: Method, step: f64) -> String {
        if method.is_adaptive() { format!("tolerance {step:.0e}") } else { format!("T/{}", short(self.cycle / step)) }
    }

    fn orders(&self) -> Table {
        let row = |method: Method| {
            let least = self.of(method).filter_map(|run| run.error).min_by(f64::total_cmp);
            let step = |run: Option<&Measured>| or_dash(run.map(|run| self.step(method, run.step)));
            [
                ("integrator", method.name().into()),
                ("order", or_dash(self.order(method).map(|order| format!("{order:.2}")))),
                ("largest step that does not diverge", step(self.of(method).find(|run| run.error.is_some()))),
                ("least error", or_dash(least.map(|error| format!("{error:.0e}")))),
                ("given up", step(self.of(method).find(|run| run.end == End::GivenUp))),
            ]
        };
        Table::of(self.methods().map(row))
    }
}

impl End {
    fn words(self) -> &'static str {
        match self {
            Self::Reached => "ok",
            Self::Diverged => "diverged",
            Self::GivenUp => "given up",
        }
    }
}

/// A number with two or three digits.
fn short(number: f64) -> String {
    let decimals = if number >= 100.0 { 0 } else { 1 + usize::from(number < 10.0) };
    format!("{number:.decimals$}")
}
