//! The least and the greatest values of the diagnostics of a run.

use crate::sim::{Diagnostic, Diagnostics};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The least and the greatest value of each diagnostic at the recorded moments of a run: frames, rows between them, and the
/// moments of charts. Diagnostics without a value have none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Extremes {
    least: BTreeMap<String, Extreme>,
    greatest: BTreeMap<String, Extreme>,
}

/// A value of a diagnostic, of vectors the length, and when it was first there.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize, Deserialize)]
struct Extreme {
    value: f64,
    /// Time (s).
    time: f64,
}

impl Extremes {
    /// Takes note of some diagnostics at a time (s). The order in which moments are noted does not count.
    pub(crate) fn note(&mut self, wanted: &[Diagnostic], time: f64, all: &Diagnostics) {
        for diagnostic in wanted {
            let own = Extreme { value: diagnostic.of(all), time };
            if !own.value.is_finite() {
                continue;
            }
            let least = self.least.entry(diagnostic.key().to_owned()).or_insert(own);
            if own < *least {
                *least = own;
            }
            let greatest = self.greatest.entry(diagnostic.key().to_owned()).or_insert(own);
            if own.value > greatest.value || own.value == greatest.value && time < greatest.time {
                *greatest = own;
            }
        }
    }
}

#[cfg(test)]
#[path = "../../tests/inside/extremes.rs"]
mod tests;
