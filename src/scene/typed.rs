//! A checked file as typed parts; parts with mistakes are left out.

use super::file::{ContactRule, MassDamping, SceneFile, TypedView};
use super::structure::Checked;
use crate::reading::collector::{Collector, Here};
use serde::de::DeserializeOwned;
use serde_json::{Map, Value as Json};
use std::slice;

impl SceneFile {
    /// The parts of a checked file that have no mistakes.
    pub(super) fn of(checked: &Checked, report: &Collector<'_>) -> Self {
        let (parts, file) = (&checked.parts, &report.root());
        let body = match parts.get("body") {
            Some(Json::Array(_)) => entries(parts, "body", file),
            _ => vec![part(parts, "body", file)],
        };
        Self {
            title: part(parts, "title", file),
            gravity: part(parts, "gravity", file),
            mass_damping: part(parts, "mass_damping", file),
            time: part(parts, "time", file),
            body,
            run: entries(parts, "run", file),
            obstacle: entries(parts, "obstacle", file),
            contact: part(parts, "contact", file),
            hold: entries(parts, "hold", file),
            grab: entries(parts, "grab", file),
            load: entries(parts, "load", file),
            probe: entries(parts, "probe", file),
            view: part(parts, "view", file).unwrap_or_default(),
        }
    }

    /// Whether nodes alone meet obstacles, and nothing else meets.
    pub(super) fn meets_by_nodes(&self) -> bool {
        self.contact.as_ref().is_some_and(|contact| contact.rule == Some(ContactRule::Nodes))
    }

    /// Whether bodies that overlap at the start are moved apart.
    pub(super) fn separates(&self) -> bool {
        self.contact.as_ref().is_some_and(|contact| contact.separate)
    }

    /// Damping in proportion to masses (1/s).
    pub(super) fn mass_damping(&self) -> f64 {
        self.mass_damping.map_or(0.0, MassDamping::rate)
    }

    /// Leaves out the parts in which a check of this scene found mistakes.
    pub(super) fn drop_mistakes(&mut self, checked: &Checked) {
        fn drop<T>(entries: &mut [Option<T>], key: &str, checked: &Checked) {
            for (at, entry) in entries.iter_mut().enumerate() {
                let is_flawed = match checked.parts.get(key) {
                    Some(Json::Array(parts)) => parts.get(at).is_none_or(Json::is_null),
                    _ => checked.flawed.contains(key),
                };
                *entry = entry.take().filter(|_| !is_flawed);
            }
        }
        drop(slice::from_mut(&mut self.time), "time", checked);
        drop(slice::from_mut(&mut self.contact), "contact", checked);
        drop(&mut self.body, "body", checked);
        drop(&mut self.run, "run", checked);
        drop(&mut self.obstacle, "obstacle", checked);
        drop(&mut self.hold, "hold", checked);
        drop(&mut self.grab, "grab", checked);
        drop(&mut self.load, "load", checked);
        drop(&mut self.probe, "probe", checked);
        self.gravity = self.gravity.take().filter(|_| !checked.flawed.contains("gravity"));
        self.mass_damping = self.mass_damping.filter(|_| !checked.flawed.contains("mass_damping"));
        if checked.flawed.contains("view") {
            self.view = TypedView::default();
        }
    }
}

/// The part of a table at a place in a file that has a key.
pub(super) fn part<T: DeserializeOwned>(parts: &Map<String, Json>, key: &str, table: &Here<'_>) -> Option<T> {
    typed(parts.get(key)?, &table.to(key))
}

/// The entries of a list in a file.
fn entries<T: DeserializeOwned>(parts: &Map<String, Json>, key: &str, file: &Here<'_>) -> Vec<Option<T>> {
    let entries = parts.get(key).and_then(Json::as_array).into_iter().flatten().enumerate();
    entries.map(|(at, entry)| typed(entry, &file.to(key).to(at))).collect()
}

/// A checked value at a place in a file as its type; `None` after a mistake in it.
fn typed<T: DeserializeOwned>(checked: &Json, here: &Here<'_>) -> Option<T> {
    let known = here.report.total();
    // A required key may be missing after a mistake. Otherwise the schema has accepted the value, and an error of the
    // types is unexpected.
    let unexpected = |error: serde_json::Error| {
        if known == 0 {
            here.wrong(error.to_string(), None)
        }
    };
    T::deserialize(checked).map_err(unexpected).ok().filter(|_| !checked.is_null())
}
