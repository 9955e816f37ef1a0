//! The least and the greatest values of the diagnostics of a run.

use crate::sim::{Diagnostic, Diagnostics};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The least and the greatest value of each diagnostic at the recorded moments of a run: frames, rows between them, and the
/// moments of charts; of forces of single things and of displacements of probes, in frames and rows. What has no value has none.
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
        wanted.iter().for_each(|diagnostic| self.note_one(diagnostic.key(), time, diagnostic.of(all)));
    }

    /// Takes note of a value with a name at a time (s).
    pub(crate) fn note_one(&mut self, name: &str, time: f64, value: f64) {
        let own = Extreme { value, time };
        if !value.is_finite() {
            return;
        }
        let least = self.least.entry(name.to_owned()).or_insert(own);
        if own < *least {
            *least = own;
        }
        self.note_peak(name.to_owned(), time, value);
    }

    /// Takes note of the magnitude of what is 0 for most of the time: of its greatest value alone.
    pub(crate) fn note_peak(&mut self, name: String, time: f64, value: f64) {
        let own = Extreme { value, time };
        let greatest = self.greatest.entry(name).or_insert(own);
        if value > greatest.value || value == greatest.value && time < greatest.time {
            *greatest = own;
        }
    }
}

#[cfg(test)]
#[path = "../../tests/inside/extremes.rs"]
mod tests;
