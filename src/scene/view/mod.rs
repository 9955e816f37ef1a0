//! Reads a `[view]` table into the view of a body, its runs and its surroundings.

mod camera;
mod compared;
mod subject;

use crate::look::file::{ColourFile, PanelsFile};
use crate::look::print::{SizeFile, TextScaleFile, unit};
use crate::look::typed::TypedColour;
use crate::look::{CameraFile, ColourScale, FontFiles, Palette, View, Visible};
use crate::reading::collector::{Collector, Here};
use crate::scene::file::TypedView;
use crate::scene::typed::part;
use crate::scene::{Run, Scene};
use crate::sim::Field;
use serde::de::DeserializeOwned;

/// The shortest side of a picture (px).
const LEAST_SIDE: u32 = 16;

/// Sets a field to the value at a key of the table as typed, if there is one.
fn set<T: DeserializeOwned>(place: &mut T, typed: &TypedView, key: &str, table: &Here<'_>) {
    if let Some(value) = part(typed, key, table) {
        *place = value;
    }
}

impl View {
    /// The view of a scene: typed values, and defaults that depend on the scene. `None` after a mistake.
    pub(super) fn read(typed: &TypedView, scene: &Scene, font: FontFiles, report: &Collector<'_>) -> Option<Self> {
        let (panels, known, here) = (scene.runs.len(), report.total(), &report.to("view"));
        let mut view = Self { side: scene.mean_side(), has_cells: scene.has_cells(), ..Self::default() };
        view.camera = part::<CameraFile>(typed, "camera", here).unwrap_or_default().resolve(scene, report)?;
        let size = part(typed, "size", here).unwrap_or(SizeFile::Pixels(view.size));
        (view.size, view.print) = size.resolve(LEAST_SIDE, &here.to("size"))?;
        view.columns = part(typed, "panels", here).map(|arranged| match arranged {
            PanelsFile::Columns(columns) => columns as usize,
            PanelsFile::Row => panels.max(1),
            PanelsFile::Column => 1,
        });
        if let Some(typed) = part::<ColourFile>(typed, "colour", here) {
            view.colour = colour(&typed, std::slice::from_ref(scene), "view", report)?.pop();
        }
        view.visible = Visible::usual(scene.dimension(), scene.nodes_of_runs().into_iter().max().unwrap_or(0));
        set(&mut view.visible, typed, "show", here);
        view.visible.surfaces |= view.visible.cage;
        let text_scale = part(typed, "text_scale", here).unwrap_or(TextScaleFile::Times(view.look.text_scale));
        let usual = view.columns.unwrap_or(panels.clamp(1, 3));
        if let TextScaleFile::Points { .. } = text_scale {
            // Type in points has a fixed arrangement.
            view.columns = Some(usual);
        }
        let panel = [view.size[0] / usual as u32, view.size[1] / panels.div_ceil(usual).max(1) as u32];
        let unit = unit(view.size, panel);
        view.look.text_scale = text_scale.resolve(view.print.as_ref(), unit, &here.to("text_scale"))?;
        view.look.background = part::<TypedColour>(typed, "background", here).map(|colour| colour.0);
        set(&mut view.look.theme, typed, "theme", here);
        view.look.theme = Palette::theme_on(view.look.background, view.look.theme);
        view.look.font = font;
        view.clock = part(typed, "clock", here).unwrap_or_else(|| {
            // A result of another program may begin anywhere.
            let is_released = |run: &Run| run.grips.is_empty() && run.loads.is_empty() && run.recording.is_none();
            let moment = if scene.runs.iter().all(is_released) { "release" } else { "the start" };
            format!("after {moment}")
        });
        let ghost: Option<String> = part(typed, "ghost", here);
        view.ghost = ghost.and_then(|name| compared::ghost(&name, scene, report));
        set(&mut view.paths, typed, "paths", here);
        compared::check_paths(&view.paths, scene, report);
        set(&mut view.title, typed, "title", here);
        set(&mut view.caption, typed, "caption", here);
        [&mut view.title, &mut view.caption].into_iter().for_each(|text| *text = text.trim().to_owned());
        set(&mut view.charts, typed, "charts", here);
        set(&mut view.arrow_scale, typed, "arrow_scale", here);
        set(&mut view.labels, typed, "labels", here);
        set(&mut view.shadow, typed, "shadow", here);
        set(&mut view.floor, typed, "floor", here);
        set(&mut view.edges, typed, "edges", here);
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
    let here = report.to(table).to("colour");
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
