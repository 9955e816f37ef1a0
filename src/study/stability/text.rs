//! The results as Markdown, CSV and JSON, and single cells as lines, from which an interrupted study goes on.

use super::{Cell, Grid, Outcome, Results};
use crate::output::exact;
use crate::table::Sheet;
use serde_json::{Value, json};

impl Outcome {
    /// In words, as in tables.
    fn words(self) -> &'static str {
        match self {
            Self::Whole => "whole",
            Self::TurnedOver(_) => "turned over",
            Self::Diverged => "diverged",
        }
    }

    /// How many elements are turned over at the end.
    fn turned_over(self) -> Option<usize> {
        match self {
            Self::Whole => Some(0),
            Self::TurnedOver(count) => Some(count),
            Self::Diverged => None,
        }
    }
}

impl Cell {
    /// What distinguishes a cell from the others of its study.
    pub(crate) fn key(&self) -> String {
        let numbers =
            [self.rate, self.speed, self.damping, self.share, self.step].map(|number| number.to_bits().to_string());
        format!("{} {}", self.run, numbers.join(" "))
    }
}

impl Outcome {
    /// A line from which [`read`] reads the key of a cell and its outcome again.
    pub(crate) fn line(self, key: &str) -> String {
        let outcome = self.turned_over().map_or_else(|| "diverged".to_owned(), |count| count.to_string());
        format!("{key} {outcome};\n")
    }
}

/// The keys and outcomes of cells from their lines. Lines that are not complete, as the last one may be, are left out.
pub(crate) fn read(lines: &str) -> impl Iterator<Item = (String, Outcome)> {
    lines.split_inclusive('\n').filter_map(|line| {
        let (key, outcome) = line.strip_suffix(";\n")?.rsplit_once(' ')?;
        let outcome = match outcome {
            "diverged" => Outcome::Diverged,
            "0" => Outcome::Whole,
            count => Outcome::TurnedOver(count.parse().ok()?),
        };
        Some((key.to_owned(), outcome))
    })
}

impl Results {
    /// The results for people; `mark` is the command that repeats them.
    pub(crate) fn markdown(&self, mark: &str) -> String {
        let mut text = format!(
            "<!-- {mark} -->\n\
            # Stability: what becomes of each run\n\n\
            {}; {} s. The stiffness is multiplied by {} to {}, with the same damping ratio. Steps are shares of the largest one that is \
            predicted to be stable at rest; of a run that has none, of T/π. `whole`: no element is turned over at the end.\n\n",
            self.told.title,
            self.told.duration,
            short(self.protocol.stiffnesses.first().copied().unwrap_or(1.0)),
            short(self.protocol.stiffnesses.last().copied().unwrap_or(1.0)),
        );
        let row = |(grid, speed): (&Grid, f64)| {
            let [name, conditions, model] = self.words(grid, speed);
            let at_most = |share: f64| if share > 0.0 { short(share) } else { "–".to_owned() };
            [
                ("run", name),
                ("model", if conditions.is_empty() { model } else { format!("{conditions}, {model}") }),
                (
                    "predicted limit",
                    grid.limit.map_or_else(|| "–".to_owned(), |limit| format!("T/{}", short(1.0 / limit))),
                ),
                ("stretched springs", grid.stretched.map_or_else(|| "–".to_owned(), short)),
                ("none diverges up to", at_most(self.up_to(grid, speed, |outcome| outcome != Outcome::Diverged))),
                ("all are whole up to", at_most(self.up_to(grid, speed, |outcome| outcome == Outcome::Whole))),
            ]
        };
        text += &Sheet::of(self.maps().map(row)).markdown(2);
        for name in &self.told.skipped {
            text += &format!("\n{name} finds its own steps and is left out.\n");
        }
        text
    }

    /// All cells, with all digits.
    pub(crate) fn csv(&self) -> String {
        let row = |cell: &Cell| {
            let [name, _, integrator] = &self.told.runs[cell.run];
            let grid = self.grids.iter().find(|grid| grid.run == cell.run && grid.damping == cell.damping);
            let has_limit = grid.is_some_and(|grid| grid.limit.is_some());
            [
                ("run", name.clone()),
                ("integrator", integrator.clone()),
                ("stiffness_over_mass", exact(cell.rate)),
                ("speed", exact(cell.speed)),
                ("damping", exact(cell.damping)),
                ("step_s", exact(cell.step)),
                ("step_over_limit", if has_limit { exact(cell.share) } else { String::new() }),
                ("step_over_cycle", exact(cell.step * cell.rate.sqrt() / std::f64::consts::TAU)),
                ("outcome", cell.outcome.words().to_owned()),
                ("turned_over", cell.outcome.turned_over().map_or_else(String::new, |count| count.to_string())),
            ]
        };
        Sheet::of(self.cells.iter().map(row)).csv()
    }

    /// The results as one JSON document.
    pub(crate) fn json(&self) -> Value {
        let cell = |cell: &Cell| {
            json!({
                "run": self.told.runs[cell.run][0],
                "stiffness_over_mass": cell.rate,
                "speed": cell.speed,
                "damping": cell.damping,
                "step": cell.step,
                "outcome": cell.outcome.words(),
                "turned_over": cell.outcome.turned_over(),
            })
        };
        json!({ "scene": self.told.title, "cells": self.cells.iter().map(cell).collect::<Vec<_>>() })
    }
}

/// A number with at most four digits.
fn short(number: f64) -> String {
    crate::sim::words::rounded(number, 4).to_string()
}
