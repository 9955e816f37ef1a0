//! The results as text and as tables.

use super::printed::as_printed;
use super::{Case, Orientation, Results, Statistics, Summary, Table1};
use crate::spread::Spread;
use crate::table::{Cell, Table, figure, or_dash};

impl Results {
    /// The results as text.
    pub(super) fn text(&self) -> String {
        let summaries = self.summaries();
        let (ours, others): (Vec<_>, Vec<_>) = summaries.iter().partition(|summary| summary.case.printed().is_some());
        let range =
            |spread: Spread| format!("{} ({} – {})", figure(spread.median), figure(spread.least), figure(spread.most));
        let ours = ours.into_iter().map(|&Summary { case, mean, deviation, maximum, .. }| {
            let printed = case.row.cases[case.stiffness].1;
            [
                ("k/m", format!("{:e}", case.stiffness_over_mass()).into()),
                ("row", case.row.name.into()),
                ("passes", case.row.passes.into()),
                ("ΔT (s)", Cell::Given(case.step())),
                ("μ, paper", or_dash(printed.mean.map(as_printed))),
                ("μ, here", range(mean).into()),
                ("σ, paper", or_dash(printed.deviation.map(as_printed))),
                ("σ, here", figure(deviation.median).into()),
                ("max, paper", or_dash(printed.maximum.map(as_printed))),
                ("max, here", range(maximum).into()),
            ]
        });
        let others = others.into_iter().map(|&Summary { case, mean, deviation, maximum, .. }| {
            [
                ("k/m", format!("{:e}", case.stiffness_over_mass()).into()),
                ("row", case.row.name.into()),
                ("passes", or_dash(case.passes().map(|passes| passes.to_string()))),
                ("ΔT (s)", Cell::Given(case.step())),
                ("μ", range(mean).into()),
                ("σ", figure(deviation.median).into()),
                ("max", range(maximum).into()),
            ]
        });
        let Table1 { orientations, duration, .. } = self.protocol;
        let mut text = format!(
            include_str!("text.md"),
            duration = duration,
            orientations = orientations,
            s = if orientations == 1 { "" } else { "s" },
            printed = Table::of(ours).markdown(2),
            exact = Table::of(others).markdown(2),
        );
        let diverged: usize = summaries.iter().map(|summary| summary.diverged).sum();
        if diverged > 0 {
            text += &format!(
                "\n{diverged} of {} simulations diverged; their values are those until then.\n",
                self.statistics.len()
            );
        }
        text
    }

    /// A row for each case, with all digits.
    pub(super) fn summary_table(&self) -> Table {
        let row = |Summary { case, mean, deviation, maximum, diverged }: Summary| {
            let printed = case.printed();
            [
                ("solver", case.solver.into()),
                ("row", case.row.name.into()),
                ("stiffness_over_mass", case.stiffness_over_mass().into()),
                ("passes", case.passes().into()),
                ("step", case.step().into()),
                ("paper_mean", printed.and_then(|printed| printed.mean).into()),
                ("paper_deviation", printed.and_then(|printed| printed.deviation).into()),
                ("paper_maximum", printed.and_then(|printed| printed.maximum).into()),
                ("orientations", self.orientations.len().into()),
                ("mean_median", mean.median.into()),
                ("mean_least", mean.least.into()),
                ("mean_most", mean.most.into()),
                ("deviation_median", deviation.median.into()),
                ("maximum_median", maximum.median.into()),
                ("maximum_least", maximum.least.into()),
                ("maximum_most", maximum.most.into()),
                ("diverged", diverged.into()),
            ]
        };
        Table::of(self.summaries().into_iter().map(row))
    }

    /// A row for each start in each case, with all digits.
    pub(super) fn start_table(&self) -> Table {
        let row = |case: &Case, number: usize, start: &Statistics| {
            let Orientation { axis, angle } = self.orientations[number];
            let [mean, deviation, maximum] = start.numbers();
            [
                ("solver", case.solver.into()),
                ("row", case.row.name.into()),
                ("stiffness_over_mass", case.stiffness_over_mass().into()),
                ("passes", case.passes().into()),
                ("step", case.step().into()),
                ("orientation", number.into()),
                ("axis_x", axis.x.into()),
                ("axis_y", axis.y.into()),
                ("axis_z", axis.z.into()),
                ("angle", angle.into()),
                ("evaluations", start.evaluations.into()),
                ("mean", mean.into()),
                ("deviation", deviation.into()),
                ("maximum", maximum.into()),
                ("status", if start.diverged { "diverged" } else { "ok" }.into()),
            ]
        };
        let rows = self.cases.iter().enumerate().flat_map(|(at, case)| {
            let statistics = self.statistics.iter().skip(at).step_by(self.cases.len());
            statistics.enumerate().map(move |(number, start)| row(case, number, start))
        });
        Table::of(rows)
    }
}
