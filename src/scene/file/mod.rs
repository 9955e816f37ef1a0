//! The structs that scene files are read into. The schema made from them is the only list of keys: files are checked
//! against it, and `localshape schema` prints it with the documentation of their fields.
//!
//! A length is in metres, a time in seconds, a mass in kilograms, an angle in radians. Vectors have three coordinates
//! in space and two in the plane.

mod body;
mod contact;
mod motion;
mod obstacle;
mod run;
mod time;

pub(in crate::scene) use body::{
    BarsFile, BodyFile, DiscFile, FillFile, FillKind, LISTS, PolygonFile, SideFile, SpinFile,
};
pub use body::{Cells, Lattice, Rotation, Start, StartShape, Up};
pub(in crate::scene) use contact::{ContactFile, ContactRule, PairFile};
pub(in crate::scene) use motion::{GrabFile, HoldFile, KeyFile, NodesFile, RegionFile};
pub use motion::{MotionPath, Side, Swing};
pub(in crate::scene) use obstacle::{ObstacleFile, ShapeFile};
pub(in crate::scene) use run::{ModelFile, RunFile, RunSource, StatesFile};
pub(in crate::scene) use time::{StepFile, TimeFile};

use super::structure::Checked;
use crate::look::{TypedView, View};
use crate::reading::collector::{Collector, PathPart, key_path};
pub use crate::reading::coordinates::Coordinates;
use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value as Json};
use std::slice;

/// The largest accepted magnitude of a number (SI). Squares and volumes of larger ones leave the range of double
/// precision.
pub(super) const LARGEST: f64 = 1e30;

// A part with a mistake is `None`.
/// A scene: bodies, one world, and several runs.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct SceneFile {
    /// The subject of the scene. Default: the file's name.
    #[schemars(length(max = 200))]
    pub(in crate::scene) title: Option<String>,
    /// Acceleration of gravity (m/s²), such as `[0, -9.8, 0]`. Default: none.
    pub(in crate::scene) gravity: Option<Coordinates>,
    /// Duration, time step and frame rate.
    #[schemars(with = "TimeFile")]
    pub(in crate::scene) time: Option<TimeFile>,
    /// The body, or several as `[[body]]`, each with a `name`. Several bodies are all in the plane or all in space. Their order is the order of rows in result files.
    #[serde(serialize_with = "body::written")]
    #[schemars(schema_with = "body::one_or_several")]
    pub(in crate::scene) body: Vec<Option<BodyFile>>,
    /// The runs, with one panel of the picture each.
    #[schemars(with = "Vec<RunFile>", length(min = 1, max = 256))]
    pub(in crate::scene) run: Vec<Option<RunFile>>,
    /// Obstacles that bodies collide with, in the order in which they act. Default: none.
    #[serde(default)]
    #[schemars(with = "Vec<ObstacleFile>")]
    pub(in crate::scene) obstacle: Vec<Option<ObstacleFile>>,
    /// How the surfaces of bodies meet. Default: as an empty table.
    pub(in crate::scene) contact: Option<ContactFile>,
    /// Nodes that are held in place. Default: none.
    #[serde(default)]
    #[schemars(with = "Vec<HoldFile>")]
    pub(in crate::scene) hold: Vec<Option<HoldFile>>,
    /// Nodes that are grabbed, dragged along a path and released. Default: none.
    #[serde(default)]
    #[schemars(with = "Vec<GrabFile>")]
    pub(in crate::scene) grab: Vec<Option<GrabFile>>,
    /// How the scene is drawn.
    #[serde(default)]
    #[schemars(with = "View")]
    pub(in crate::scene) view: TypedView,
}

impl SceneFile {
    /// The parts of a checked file that have no mistakes.
    pub(in crate::scene) fn of(checked: &Checked, report: &mut Collector<'_>) -> Self {
        let parts = &checked.parts;
        let body = match parts.get("body") {
            Some(Json::Array(_)) => entries(parts, "body", report),
            _ => vec![part(parts, "body", report)],
        };
        Self {
            title: part(parts, "title", report),
            gravity: part(parts, "gravity", report),
            time: part(parts, "time", report),
            body,
            run: entries(parts, "run", report),
            obstacle: entries(parts, "obstacle", report),
            contact: part(parts, "contact", report),
            hold: entries(parts, "hold", report),
            grab: entries(parts, "grab", report),
            view: part(parts, "view", report).unwrap_or_default(),
        }
    }

    /// Whether nodes alone meet obstacles, and nothing else meets.
    pub(in crate::scene) fn meets_by_nodes(&self) -> bool {
        self.contact.as_ref().is_some_and(|contact| contact.rule == Some(ContactRule::Nodes))
    }

    /// Leaves out the parts in which a check of this scene found mistakes.
    pub(in crate::scene) fn drop_mistakes(&mut self, checked: &Checked) {
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
        self.gravity = self.gravity.take().filter(|_| !checked.flawed.contains("gravity"));
        if checked.flawed.contains("view") {
            self.view = TypedView::default();
        }
    }
}

/// The part of a file at a key.
fn part<T: DeserializeOwned>(parts: &Map<String, Json>, key: &str, report: &mut Collector<'_>) -> Option<T> {
    typed(parts.get(key)?, &key_path![key], report)
}

/// The entries of a list in a file.
fn entries<T: DeserializeOwned>(parts: &Map<String, Json>, key: &str, report: &mut Collector<'_>) -> Vec<Option<T>> {
    let entries = parts.get(key).and_then(Json::as_array).into_iter().flatten().enumerate();
    entries.map(|(at, entry)| typed(entry, &key_path![key, at], report)).collect()
}

/// A checked value at a path of a file as its type; `None` after a mistake in it.
pub(in crate::scene) fn typed<T: DeserializeOwned>(
    checked: &Json,
    path: &[PathPart<'_>],
    report: &mut Collector<'_>,
) -> Option<T> {
    let known = report.total();
    // A required key may be missing after a mistake. Otherwise the schema has accepted the value, and an error of the
    // types is unexpected.
    let unexpected = |error: serde_json::Error| {
        if known == 0 {
            report.at(path, error.to_string(), None)
        }
    };
    T::deserialize(checked).map_err(unexpected).ok().filter(|_| !checked.is_null())
}

/// A number greater than zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub(in crate::scene) struct Positive(#[schemars(extend("exclusiveMinimum" = 0))] pub(in crate::scene) f64);
