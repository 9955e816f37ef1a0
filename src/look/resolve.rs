//! Resolves a `[view]` table for the body, the runs and the surroundings that it shows.

use super::compared;
use super::contrast;
use super::file::{ArrangementFile, ColourFile, EdgesFile, PanelsFile, ShowFile, ViewFile};
use super::framing;
use super::print::{TextScaleFile, unit};
use super::subject::Subject;
use super::view::{ColourScale, FontFiles, View, Visible};
use crate::reading::coordinates::vector;
use crate::reading::report::{Report, Way};
use crate::sim::body::Dimension;
use crate::sim::inside::is_inside;
use crate::sim::words::rounded;

/// The shortest side of a picture (px).
const LEAST_SIDE: u32 = 16;

/// The view, or `None` if there is a mistake in it.
pub(crate) fn resolve(
    typed: &ViewFile,
    scene: &Subject<'_>,
    font: Option<FontFiles>,
    report: &mut Report<'_>,
) -> Option<View> {
    let body = scene.body;
    let panels = scene.models.len();
    let dimension = body.dimension;
    let camera = |key| [Way::Key("view"), Way::Key("camera"), Way::Key(key)];
    let given = [("azimuth", typed.camera.azimuth), ("elevation", typed.camera.elevation)];
    for (key, _) in given.iter().filter(|(_, value)| dimension == Dimension::Plane && value.is_some()) {
        let message = format!("`view.camera.{key}` is given, but a body in the plane is seen from the front");
        report.at_key(&camera(key), message, format!("take `{key}` out"));
    }
    let target = match &typed.camera.target {
        Some(target) => Some(vector(target, dimension, &camera("target"), report)?),
        None => None,
    };
    let chosen = framing::camera(&typed.camera, target, scene);
    if dimension == Dimension::Space && !chosen.follow && is_inside(chosen.eye(), body, &scene.initial.position) {
        let [x, y, z] = chosen.eye().to_array().map(|length| rounded(length, 3));
        let message = format!("the camera is at [{x}, {y}, {z}], inside the body at its start");
        let help = "move it out with a larger `view.camera.distance` or another `target`".to_owned();
        report.at(&[Way::Key("view"), Way::Key("camera")], message, help);
    }
    let (size, print) = typed.size.resolve(LEAST_SIDE, &[Way::Key("view"), Way::Key("size")], report)?;
    let columns = typed.panels.map(|arranged| match arranged {
        PanelsFile::Columns(columns) => columns as usize,
        PanelsFile::Along(ArrangementFile::Row) => panels.max(1),
        PanelsFile::Along(ArrangementFile::Column) => 1,
    });
    let colour = match &typed.colour {
        Some(typed) => {
            let way = [Way::Key("view"), Way::Key("colour"), Way::Key("range")];
            Some(colour(typed, std::slice::from_ref(scene), &way, report)?)
        }
        None => None,
    };
    let visible = match &typed.show {
        Some(shown) => Visible {
            surfaces: shown.contains(&ShowFile::Surfaces),
            nodes: shown.contains(&ShowFile::Nodes),
            springs: shown.contains(&ShowFile::Springs),
            displacements: shown.contains(&ShowFile::Displacements),
        },
        None => Visible::usual(dimension, body.len()),
    };
    let usual = columns.unwrap_or(panels.clamp(1, 3));
    // Type in points holds for one arrangement.
    let columns = columns.or(matches!(typed.text_scale, TextScaleFile::Points(_)).then_some(usual));
    let panel = [size[0] / usual as u32, size[1] / panels.div_ceil(usual).max(1) as u32];
    let way = [Way::Key("view"), Way::Key("text_scale")];
    let text_scale = typed.text_scale.resolve(print.as_ref(), unit(size, panel), &way, report)?;
    let look = contrast::resolve(typed, font.unwrap_or_default(), text_scale, report)?;
    let (ghost, paths) = (compared::ghost(typed, scene, report), compared::paths(typed, scene, report));
    Some(View {
        size,
        print,
        look,
        camera: chosen,
        clock: typed
            .clock
            .clone()
            .unwrap_or_else(|| if scene.grips.is_empty() { "after release".into() } else { "after the start".into() }),
        columns,
        visible,
        colour,
        arrow_scale: typed.arrow_scale,
        side: scene.side,
        has_cells: scene.has_cells,
        title: typed.title.trim().to_owned(),
        caption: typed.caption.trim().to_owned(),
        labels: typed.labels,
        strip: typed.strip,
        ghost,
        paths,
        shadow: typed.shadow,
        floor: typed.floor,
        edges: match typed.edges {
            EdgesFile::All => [true, true],
            EdgesFile::Visible => [true, false],
            EdgesFile::Outline => [false, false],
        },
    })
}

/// The narrowest range of colours, in parts of its larger end: ticks still differ in a few digits.
const NARROWEST: f64 = 1e-9;

/// The colours of a field, over a range that is typed somewhere or else follows from the scenes.
pub(crate) fn colour(
    typed: &ColourFile,
    scenes: &[Subject<'_>],
    way: &[Way<'_>; 3],
    report: &mut Report<'_>,
) -> Option<ColourScale> {
    let range = match typed.range {
        Some(range) => rising(range, way, report)?,
        None => [0.0, scenes.iter().fold(0.0, |most: f64, scene| most.max(scene.largest(typed.by)))],
    };
    Some(ColourScale { field: typed.by, range, map: typed.map })
}

/// The ends of a scale, if they rise and differ enough.
fn rising([low, high]: [f64; 2], way: &[Way<'_>; 3], report: &mut Report<'_>) -> Option<[f64; 2]> {
    let keys = way.iter().filter_map(|step| if let Way::Key(key) = step { Some(*key) } else { None });
    let name = keys.collect::<Vec<_>>().join(".");
    if low >= high {
        report.at(way, format!("`{name}` runs from {low} to {high}; expected a rising range"), None);
        return None;
    }
    if high - low < NARROWEST * low.abs().max(high.abs()) {
        let message = format!("`{name}` from {low} to {high} is too narrow for its numbers");
        report.at(way, message, "move its ends apart".to_owned());
        return None;
    }
    Some([low, high])
}
