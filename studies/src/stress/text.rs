//! The results as text and as a table.

use super::{Outcome, Promise, Results, Tried};
use crate::table::{Cell, Table};

/// The shape error of a body that counts as restored.
const RESTORED: f64 = 1e-3;

impl Results {
    /// The results as text.
    pub(super) fn text(&self) -> String {
        let words = |row: &Tried, one: &Option<Outcome>| match one {
            Some(outcome) => row.words(outcome).into(),
            None => Cell::from("does not take it"),
        };
        let row = |row: &Tried| -> Vec<Cell> {
            let name = Cell::from(row.trial.name.as_str());
            [name].into_iter().chain(row.outcomes.iter().map(|one| words(row, one))).collect()
        };
        let table = |group: &[Tried]| {
            let models = self.models.iter().map(|model| model.name.to_owned());
            let table = Table::wide(&[group[0].trial.group], models, group.iter().map(row).collect());
            table.markdown(table.heads.len())
        };
        let tables: Vec<_> = self.rows.chunk_by(|one, other| one.trial.group == other.trial.group).map(table).collect();
        let broken = self.rows.iter().filter(|row| !row.broken().is_empty());
        let broken =
            broken.map(|row| format!("- {}, {}: {}", row.trial.group, row.trial.name, row.broken().join("; ")));
        let promises = match &broken.collect::<Vec<_>>()[..] {
            [] => "The shape model keeps all its promises.".to_owned(),
            broken => format!("Promises that the shape model breaks:\n\n{}", broken.join("\n")),
        };
        format!(include_str!("text.md"), tables = tables.join("\n\n"), promises = promises)
    }

    /// All numbers, with all digits.
    pub(super) fn table(&self) -> Table {
        let rows = self.rows.iter().flat_map(|row| {
            row.outcomes.iter().zip(&self.models).filter_map(move |(one, model)| Some((row, one.as_ref()?, model.name)))
        });
        let number = |value: f64| if value.is_nan() { Cell::Empty } else { value.into() };
        Table::of(rows.map(|(row, one, model)| {
            [
                ("group", row.trial.group.into()),
                ("trial", row.trial.name.as_str().into()),
                ("model", model.into()),
                ("steps", row.trial.steps.into()),
                ("elements", row.trial.elements().into()),
                ("diverged_s", one.diverged.into()),
                ("turned_over", one.turned_over.into()),
                ("shape_error_sides", number(one.shape_error)),
                ("unsettled_sides", number(one.unsettled)),
                ("energy_ratio", number(one.energy)),
                ("momentum_change", number(one.momentum[0])),
                ("angular_momentum_change", number(one.momentum[1])),
                ("creep_sides", number(one.creep)),
            ]
        }))
    }
}

impl Tried {
    /// The outcome in a few words.
    fn words(&self, one: &Outcome) -> String {
        let size = |number: f64| if number < 0.01 { format!("{number:.0e}") } else { format!("{number:.2}") };
        if let Some(time) = one.diverged {
            return format!("diverged after {} s", size(time));
        }
        if one.turned_over > 0 && self.trial.promise != Promise::Bounded {
            return format!("{} of {} turned over ({})", one.turned_over, self.trial.elements(), size(one.shape_error));
        }
        match self.trial.promise {
            Promise::Restored(most) if one.shape_error <= most => {
                format!(
                    "{} ({})",
                    if one.shape_error <= RESTORED { "restored" } else { "whole" },
                    size(one.shape_error)
                )
            }
            Promise::Settled(most) if one.unsettled <= most => "at rest".to_owned(),
            Promise::Bounded => format!("energy at most × {:.2}", one.energy),
            Promise::Settled(_) => format!("not at rest by {} sides", size(one.unsettled)),
            Promise::Restored(_) => format!("out of shape ({})", size(one.shape_error)),
        }
    }
}
