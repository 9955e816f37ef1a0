//! The results as text and as tables.

use super::printed::as_printed;
use super::{Case, Orientation, Results, Statistics, Summary, Table1};
use crate::spread::Spread;
use crate::table::{Cell, Table, figure};

impl Results {
    /// The results as text.
    pub(super) fn text(&self) -> String {
        let Table1 { orientations, duration, .. } = self.protocol;
        let plural = if orientations == 1 { "" } else { "s" };
        let mut text = format!(
            "# Table 1: evaluation values of approximation errors\n\n\
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
        );
        let summaries = self.summaries();
        let (ours, others): (Vec<_>, Vec<_>) = summaries.iter().partition(|summary| summary.case.printed().is_some());
        let range =
            |spread: Spread| format!("{} ({} – {})", figure(spread.median), figure(spread.least), figure(spread.most));
        let dash = |printed: Option<f64>| printed.map_or("–".to_owned(), as_printed);
        let ours = ours.into_iter().map(|&Summary { case, mean, deviation, maximum, .. }| {
            let printed = case.row.cases[case.stiffness].1;
            [
                ("k/m", format!("{:e}", case.stiffness_over_mass()).into()),
                ("row", case.row.name.into()),
                ("passes", case.row.passes.into()),
                ("ΔT (s)", Cell::Given(case.step())),
                ("μ, paper", dash(printed.mean).into()),
                ("μ, here", range(mean).into()),
                ("σ, paper", dash(printed.deviation).into()),
                ("σ, here", figure(deviation.median).into()),
                ("max, paper", dash(printed.maximum).into()),
                ("max, here", range(maximum).into()),
            ]
        });
        text += &Table::of(ours).markdown(2);
        text += "\n## Exact rotations (`robust`) on the same starts\n\n";
        let others = others.into_iter().map(|&Summary { case, mean, deviation, maximum, .. }| {
            [
                ("k/m", format!("{:e}", case.stiffness_over_mass()).into()),
                ("row", case.row.name.into()),
                ("passes", case.passes().map_or("–".into(), Cell::from)),
                ("ΔT (s)", Cell::Given(case.step())),
                ("μ", range(mean).into()),
                ("σ", figure(deviation.median).into()),
                ("max", range(maximum).into()),
            ]
        });
        text += &Table::of(others).markdown(2);
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
                ("mean", start.mean.into()),
                ("deviation", start.deviation.into()),
                ("maximum", start.maximum.into()),
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
