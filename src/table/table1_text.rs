//! The measured Table 1 as Markdown, CSV and JSON.

use super::printed::as_printed;
use super::sheet::figure;
use super::table1::{Case, Orientation, Protocol, Statistics, Summary, Table1};
use super::{Sheet, Spread};
use crate::output::exact;
use serde_json::{Value, json};

impl Table1 {
    /// The contents of [`FILES`](super::table1::FILES).
    pub(crate) fn files(&self) -> [String; 3] {
        [self.markdown(), self.summary_sheet().csv(), self.start_sheet().csv()]
    }

    pub(crate) fn markdown(&self) -> String {
        let Protocol { orientations, duration, .. } = self.protocol;
        let plural = if orientations == 1 { "" } else { "s" };
        let mut text = format!(
            "<!-- {} -->\n\
            # Table 1: evaluation values of approximation errors\n\n\
            α of Eq. (18) in rad/s², at every evaluation of the forces in the {duration} s from the first contact on, of \
            a free cube of side 0.1 m with 1 kg in each corner that falls 1 m onto a floor with restitution 1. g = 9.8 \
            m/s², neither damping nor friction, semi-implicit Euler. μ, σ and max are the mean of α, its standard deviation \
            and its largest value; k/m is in 1/s². Row A has one pass of the solver at each evaluation and steps of a tenth \
            of the cycle, row B steps of a hundredth, row C two passes, row D three. The paper does not give the orientation of \
            its cube; ours are medians over {orientations} start{plural} at rest with random orientation{plural}, for μ \
            and max with the range in parentheses. A dash in a column of the paper means that the value was below its \
            measurable range, a dash for passes that the solver has none. Values around 1e-9 and below are round-off.\n\n\
            ## The paper's solver: Eq. (15), θ = atan |w|, true rotations accumulated, each evaluation starting from \
            the last\n\n",
            self.protocol.mark()
        );
        let summaries = self.summaries();
        let (ours, others): (Vec<_>, Vec<_>) = summaries.iter().partition(|summary| summary.case.printed().is_some());
        let range =
            |spread: Spread| format!("{} ({} – {})", figure(spread.median), figure(spread.least), figure(spread.most));
        let dash = |printed: Option<f64>| printed.map_or("–".to_owned(), as_printed);
        let ours = ours.into_iter().map(|&Summary { case, mean, deviation, maximum, .. }| {
            let printed = case.row.cases[case.stiffness].1;
            [
                ("k/m", format!("{:e}", case.stiffness_over_mass())),
                ("row", case.row.name.to_owned()),
                ("passes", case.row.passes.to_string()),
                ("ΔT (s)", case.step().to_string()),
                ("μ, paper", dash(printed.mean)),
                ("μ, here", range(mean)),
                ("σ, paper", dash(printed.deviation)),
                ("σ, here", figure(deviation.median)),
                ("max, paper", dash(printed.maximum)),
                ("max, here", range(maximum)),
            ]
        });
        text += &Sheet::of(ours).markdown(2);
        text += "\n## Better solvers on the same starts\n\n";
        let others = others.into_iter().map(|&Summary { case, mean, deviation, maximum, .. }| {
            [
                ("solver", case.solver.words.to_owned()),
                ("k/m", format!("{:e}", case.stiffness_over_mass())),
                ("row", case.row.name.to_owned()),
                ("passes", case.passes().map_or("–".to_owned(), |passes| passes.to_string())),
                ("ΔT (s)", case.step().to_string()),
                ("μ", range(mean)),
                ("σ", figure(deviation.median)),
                ("max", range(maximum)),
            ]
        });
        text += &Sheet::of(others).markdown(3);
        let diverged: usize = summaries.iter().map(|summary| summary.diverged).sum();
        if diverged > 0 {
            text += &format!(
                "\n{diverged} of {} simulations diverged; their values are those until then.\n",
                self.statistics.len()
            );
        }
        text
    }

    /// The table as CSV data, with all digits.
    fn summary_sheet(&self) -> Sheet {
        let number = |number: Option<f64>| number.map_or(String::new(), exact);
        let row = |Summary { case, mean, deviation, maximum, diverged }: Summary| {
            let printed = case.printed();
            [
                ("solver", case.solver.name.to_owned()),
                ("row", case.row.name.to_owned()),
                ("stiffness_over_mass", exact(case.stiffness_over_mass())),
                ("passes", case.passes().map_or(String::new(), |passes| passes.to_string())),
                ("step", exact(case.step())),
                ("paper_mean", number(printed.and_then(|printed| printed.mean))),
                ("paper_deviation", number(printed.and_then(|printed| printed.deviation))),
                ("paper_maximum", number(printed.and_then(|printed| printed.maximum))),
                ("orientations", self.orientations.len().to_string()),
                ("mean_median", exact(mean.median)),
                ("mean_least", exact(mean.least)),
                ("mean_most", exact(mean.most)),
                ("deviation_median", exact(deviation.median)),
                ("maximum_median", exact(maximum.median)),
                ("maximum_least", exact(maximum.least)),
                ("maximum_most", exact(maximum.most)),
                ("diverged", diverged.to_string()),
            ]
        };
        Sheet::of(self.summaries().into_iter().map(row))
    }

    /// Each start in each case, with all digits.
    fn start_sheet(&self) -> Sheet {
        let row = |case: &Case, number: usize, start: &Statistics| {
            let Orientation { axis, angle } = self.orientations[number];
            [
                ("solver", case.solver.name.to_owned()),
                ("row", case.row.name.to_owned()),
                ("stiffness_over_mass", exact(case.stiffness_over_mass())),
                ("passes", case.passes().map_or(String::new(), |passes| passes.to_string())),
                ("step", exact(case.step())),
                ("orientation", number.to_string()),
                ("axis_x", exact(axis.x)),
                ("axis_y", exact(axis.y)),
                ("axis_z", exact(axis.z)),
                ("angle", exact(angle)),
                ("evaluations", start.evaluations.to_string()),
                ("mean", exact(start.mean)),
                ("deviation", exact(start.deviation)),
                ("maximum", exact(start.maximum)),
                ("status", if start.diverged { "diverged" } else { "ok" }.to_owned()),
            ]
        };
        let rows = self.cases.iter().enumerate().flat_map(|(at, case)| {
            let statistics = self.statistics.iter().skip(at).step_by(self.cases.len());
            statistics.enumerate().map(move |(number, start)| row(case, number, start))
        });
        Sheet::of(rows)
    }

    /// The table as one JSON document.
    pub(crate) fn json(&self) -> Value {
        let row = |summary: &Summary| {
            let Summary { case, mean, deviation, maximum, diverged } = summary;
            json!({
                "solver": case.solver.name,
                "row": case.row.name,
                "stiffness_over_mass": case.stiffness_over_mass(),
                "passes": case.passes(),
                "step": case.step(),
                "paper": case.printed(),
                "mean": mean,
                "deviation": deviation,
                "maximum": maximum,
                "diverged": diverged,
            })
        };
        let rows: Vec<_> = self.summaries().iter().map(row).collect();
        json!({ "orientations": self.orientations.len(), "duration": self.protocol.duration, "rows": rows })
    }
}
