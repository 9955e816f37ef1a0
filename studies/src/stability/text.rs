//! The results as text and as a table.

use super::{Axes, MapCell, Results, Stability};
use crate::table::{Table, or_dash};
use localshape::internals::typed;

impl Results {
    /// The results as text.
    pub(super) fn text(&self) -> String {
        let row = |(axes, speed): (&Axes, f64)| {
            let [name, conditions, model] = self.words(axes, speed);
            let up_to = |is_good: fn(Option<usize>) -> bool| {
                Some(self.up_to(axes, speed, is_good)).filter(|&share| share > 0.0)
            };
            [
                ("run", name.into()),
                ("model", if conditions.is_empty() { model } else { format!("{conditions}, {model}") }.into()),
                ("predicted limit", or_dash(axes.limit.map(|limit| format!("T/{}", short(1.0 / limit))))),
                ("stretched springs", or_dash(axes.stretched.map(short))),
                ("none diverges up to", or_dash(up_to(|turned_over| turned_over.is_some()).map(short))),
                ("all are whole up to", or_dash(up_to(|turned_over| turned_over == Some(0)).map(short))),
            ]
        };
        let Stability { stiffnesses, .. } = &self.study;
        let [least, most] =
            [stiffnesses.first(), stiffnesses.last()].map(|factor| short(factor.copied().unwrap_or(1.0)));
        let mut text = format!(
            include_str!("text.md"),
            title = self.study.scene.title,
            duration = self.study.scene.duration,
            least = least,
            most = most,
            table = Table::of(self.maps().map(row)).markdown(2),
        );
        for run in self.study.scene.runs.iter().filter(|run| run.tolerance.is_some()) {
            text += &format!("\n{} chooses its own steps and is left out.\n", run.name);
        }
        text
    }

    /// All cells, with all digits.
    pub(super) fn table(&self) -> Table {
        let row = |cell: &MapCell| {
            let run = &self.study.scene.runs[cell.run];
            let axes = self.axes.iter().find(|axes| axes.run == cell.run && axes.damping == cell.damping);
            let outcome = match cell.turned_over {
                Some(0) => "whole",
                Some(_) => "turned over",
                None => "diverged",
            };
            let has_limit = axes.is_some_and(|axes| axes.limit.is_some());
            [
                ("run", run.name.as_str().into()),
                ("integrator", typed(&run.integrator).into()),
                ("stiffness_over_mass", cell.rate.into()),
                ("speed", cell.speed.into()),
                ("damping", cell.damping.into()),
                ("step_s", cell.step.into()),
                ("step_over_limit", has_limit.then_some(cell.share).into()),
                ("step_over_cycle", (cell.step * cell.rate.sqrt() / std::f64::consts::TAU).into()),
                ("outcome", outcome.into()),
                ("turned_over", cell.turned_over.into()),
            ]
        };
        Table::of(self.cells.iter().map(row))
    }
}

/// A number with at most four digits.
pub(super) fn short(number: f64) -> String {
    let text = format!("{number:.3e}");
    text.parse::<f64>().unwrap_or(number).to_string()
}
