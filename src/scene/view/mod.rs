//! Reads a `[view]` table into the view of a body, its runs and its surroundings.

mod camera;
mod compared;
mod subject;

use crate::look::file::{ColourFile, PanelsFile};
use crate::look::print::{SizeFile, TextScaleFile, unit};
use crate::look::typed::TypedColour;
use crate::look::{CameraFile, ColourScale, FontFiles, Palette, View, Visible};
use crate::reading::collector::{Collector, Here, key_path};
use crate::scene::{Run, Scene};
use crate::sim::Field;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value as Json};

/// The shortest side of a picture (px).
const LEAST_SIDE: u32 = 16;

/// A `[view]` table as typed, of the right structure.
pub(super) type TypedView = Map<String, Json>;

/// A value as typed, if there is one.
fn get<T: DeserializeOwned>(typed: &TypedView, key: &str, report: &Collector<'_>) -> Option<T> {
    let read = T::deserialize(typed.get(key)?);
    // The structure of the value is right, so an error is unexpected.
    read.map_err(|error| report.at(&key_path!["view", key], error.to_string(), None)).ok()
}

/// Sets a field to the typed value, if there is one.
fn set<T: DeserializeOwned>(place: &mut T, typed: &TypedView, key: &str, report: &Collector<'_>) {
    if let Some(value) = get(typed, key, report) {
        *place = value;
    }
}

impl View {
    /// The view of a scene: typed values, and defaults that depend on the scene. `None` after a mistake.
    pub(super) fn read(typed: &TypedView, scene: &Scene, font: FontFiles, report: &Collector<'_>) -> Option<Self> {
        let (panels, known) = (scene.runs.len(), report.total());
        let mut view = Self { side: scene.mean_side(), has_cells: scene.has_cells(), ..Self::default() };
        view.camera = get::<CameraFile>(typed, "camera", report).unwrap_or_default().resolve(scene, report)?;
        let size = get(typed, "size", report).unwrap_or(SizeFile::Pixels(view.size));
        (view.size, view.print) = size.resolve(LEAST_SIDE, &report.here(&key_path!["view", "size"]))?;
        view.columns = get(typed, "panels", report).map(|arranged| match arranged {
            PanelsFile::Columns(columns) => columns as usize,
            PanelsFile::Row => panels.max(1),
            PanelsFile::Column => 1,
        });
        if let Some(typed) = get::<ColourFile>(typed, "colour", report) {
            view.colour = colour(&typed, std::slice::from_ref(scene), "view", report)?.pop();
        }
        view.visible = Visible::usual(scene.dimension(), scene.nodes_of_runs().into_iter().max().unwrap_or(0));
        set(&mut view.visible, typed, "show", report);
        view.visible.surfaces |= view.visible.cage;
        let text_scale = get(typed, "text_scale", report).unwrap_or(TextScaleFile::Times(view.look.text_scale));
        let usual = view.columns.unwrap_or(panels.clamp(1, 3));
        if let TextScaleFile::Points { .. } = text_scale {
            // Type in points has a fixed arrangement.
            view.columns = Some(usual);
        }
        let panel = [view.size[0] / usual as u32, view.size[1] / panels.div_ceil(usual).max(1) as u32];
        let unit = unit(view.size, panel);
        let here = report.here(&key_path!["view", "text_scale"]);
        view.look.text_scale = text_scale.resolve(view.print.as_ref(), unit, &here)?;
        view.look.background = get::<TypedColour>(typed, "background", report).map(|colour| colour.0);
        set(&mut view.look.theme, typed, "theme", report);
        view.look.theme = Palette::theme_on(view.look.background, view.look.theme);
        view.look.font = font;
        view.clock = get(typed, "clock", report).unwrap_or_else(|| {
            // A result of another program may begin anywhere.
            let is_released = |run: &Run| run.grips.is_empty() && run.loads.is_empty() && run.recording.is_none();
            let moment = if scene.runs.iter().all(is_released) { "release" } else { "the start" };
            format!("after {moment}")
        });
        let ghost: Option<String> = get(typed, "ghost", report);
        view.ghost = ghost.and_then(|name| compared::ghost(&name, scene, report));
        set(&mut view.paths, typed, "paths", report);
        compared::check_paths(&view.paths, scene, report);
        set(&mut view.title, typed, "title", report);
        set(&mut view.caption, typed, "caption", report);
        [&mut view.title, &mut view.caption].into_iter().for_each(|text| *text = text.trim().to_owned());
        set(&mut view.charts, typed, "charts", report);
        set(&mut view.arrow_scale, typed, "arrow_scale", report);
        set(&mut view.labels, typed, "labels", report);
        set(&mut view.shadow, typed, "shadow", report);
        set(&mut view.floor, typed, "floor", report);
        set(&mut view.edges, typed, "edges", report);
        (report.total() == known).then_some(view)
    }
}

/// The narrowest range of colours, relative to its larger end: ticks still differ in a few digits.
const NARROWEST: f64 = 1e-9;

/// The colours of a field in each of some scenes, typed in a table. A range that is not typed follows from the scenes.
pub(super) fn colour(
    typed: &ColourFile,
    scenes: &[Scene],
    table: &'static str,
    report: &Collector<'_>,
) -> Option<Vec<ColourScale>> {
    let here = report.here(&key_path![table, "colour"]);
    let range = match typed.range {
        Some(range) => rising(range, &here.to("range"))?,
        None => [0.0, scenes.iter().fold(0.0, |most: f64, scene| most.max(scene.largest_value(typed.by)))],
    };
    let mut runs = scenes.iter().flat_map(|scene| &scene.runs).peekable();
    if typed.by == Field::ElasticEnergy && runs.peek().is_some() && runs.all(|run| run.models.is_empty()) {
        let message = format!("`{here}.by` is \"elastic-energy\", which no run has");
        here.to("by").wrong(message, "recordings have none; colour by another field, such as \"strain\"");
        return None;
    }
    let (to, is_compared) = (here.to("to"), typed.by == Field::Distance);
    match &typed.to {
        None if is_compared => {
            let message = format!("`{here}` has no `to`, the run to which the distance is measured");
            here.wrong(message, "name a run, such as `to = \"Mass-spring\"`");
            return None;
        }
        Some(_) if !is_compared => {
            let message = format!("`{to}` is given, but only `by = \"distance\"` compares runs");
            to.wrong_key(message, "remove `to`");
            return None;
        }
        _ => {}
    }
    let one = |scene| {
        let to = typed.to.as_ref().map(|name| compared::run(name, &[], &to, scene));
        let to = if let Some(to) = to { Some(to?) } else { None };
        Some(ColourScale { field: typed.by, to, range, map: typed.map })
    };
    scenes.iter().map(one).collect()
}

/// The ends of a scale, if they rise and differ enough.
fn rising([low, high]: [f64; 2], here: &Here<'_>) -> Option<[f64; 2]> {
    if low >= high {
        here.wrong(format!("`{here}` runs from {low} to {high}; expected a rising range"), None);
        return None;
    }
    if high - low < NARROWEST * low.abs().max(high.abs()) {
        let message = format!("`{here}` from {low} to {high} is too narrow for its numbers");
        here.wrong(message, "move its ends apart");
        return None;
    }
    Some([low, high])
}
