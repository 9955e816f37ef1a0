//! Sheets: rows of runs and columns of moments, with diagnostics over the time of the whole scene below them.
//!
//! ```text
//! title
//! caption                                    key
//!              a 0 ms     b 20 ms     c 3.0 s
//! Local shape  ┌ tile ──┐ ┌ tile ──┐ ┌ tile ──┐
//! ─────────    │  body  │ │  body  │ │  body  │
//!              └ tally ─┘ └ tally ─┘ └ tally ─┘
//! Mass-spring  ┌ tile ──┐ …
//! ─ ─ ─ ─ ─
//!              ⓐ    ⓑ                       ⓒ
//! Turned over  ┴────┴────────────────────────┴─
//! ```

mod below;
mod cameras;
mod charts;
mod headings;
mod rows;
mod sheet_layout;

use super::header;
use crate::look::{ColourScale, Ghost, Labels, View, print};
use crate::picture::caption::Writer;
use crate::picture::compose::Composer;
use crate::picture::compose::draft::Draft;
use crate::picture::layout::Scale;
use crate::picture::layout::steps::GAP;
use crate::picture::legend::Legend;
use crate::picture::text::Fonts;
use crate::picture::{Colour, Item, Picture};
use crate::runner::history::History;
use crate::runner::moments::Moments;
use crate::scene::Scene;
use crate::scene::figure::{Figure, Sheet};
use crate::sim::Frame;
use below::Below;
use glam::DVec2;
use rows::RowLabels;
use sheet_layout::SheetLayout;

/// Width of bodies that are a line or a point (px at the tile's scale).
const COLLAPSED: [f64; 2] = [3.0, 9.0];

pub(super) fn compose(figure: &Figure, sheet: &Sheet, moments: &Moments) -> Picture {
    let size = figure.size.map(|length| length.max(1));
    let unit = print::unit_of_sheet(size);
    let scale = Scale::at(unit).with(&View { look: figure.look.clone(), ..View::default() });
    let fonts = Fonts::new(&figure.look.font);
    let palette = &figure.look.palette();
    let mut writer = Writer::new(palette, &fonts, scale);
    let scenes = plain(figure, sheet);

    let legend = legend(&scenes, size, scale);
    let has_charts = !sheet.charts.is_empty();
    let charts = has_charts.then(|| charts::stack(sheet, &moments.histories, &writer, f64::from(size[0])));
    let shows_runs = |scene: &Scene| matches!(scene.view.ghost, Some(Ghost::Run(_))) || !scene.view.paths.is_empty();
    let with_sample = has_charts || scenes.iter().any(shows_runs);
    let labels = RowLabels::new(sheet, &fonts, scale, with_sample, f64::from(size[0]));
    let below = legend.map_or(0, |legend| (legend.height + GAP * unit).round() as u32);
    let bottom = size[1] - below.min(size[1] / 2);
    let layout_below = |header: f64, writer: &Writer<'_>| {
        SheetLayout::new(sheet, writer, [size[0], bottom], header, labels.width, charts.as_ref())
    };
    // The width of tiles does not depend on the header, whose key explains tallies.
    let layout = layout_below(0.0, &writer);
    let tallies = below::tallies(&scenes, scale, &layout);
    let has_flat = moments.cells.iter().flatten().any(|run| run.snapshot.flat.contains(&true));
    let key = below::key(&scenes, &tallies, scale, &layout);
    let header = header::write(&mut writer, figure, &key, has_flat);
    let layout = layout_below(header, &writer);
    labels.write(&mut writer, &layout, sheet);
    for (column, heading) in layout.headings.iter().enumerate() {
        let left = f64::from(layout.tile(0, column)[0]);
        heading.write(&mut writer, [left, layout.headings_baseline]);
    }
    if let (Some(charts), Some(room)) = (&charts, &layout.charts) {
        charts::draw(charts, sheet, moments.histories[0].end, &mut writer, room);
    }

    let framings = cameras::framings(&scenes, sheet, moments, &layout);
    let reaches = cameras::reaches(&scenes, sheet, moments);
    // The tiles of a scene share data that is computed once.
    let traced = |scene: usize| moments.histories.get(scene).map_or_else(Vec::new, |history| history.series.clone());
    let composers = scenes.iter().zip(reaches).zip(tallies).enumerate();
    let composer = |(at, ((scene, reach), tally))| Composer {
        reach,
        tally,
        traced: traced(at),
        ..Composer::new(scene, &History::default())
    };
    let composers: Vec<_> = composers.map(composer).collect();
    let mut below = Vec::new();
    for (row, cells) in moments.cells.iter().enumerate() {
        for (column, run) in cells.iter().enumerate() {
            let composer = &composers[sheet.columns[column].scene];
            below.push(([row, column], Below::new(&writer, &layout, composer, run, sheet.number)));
        }
    }
    let with_number = below.iter().all(|(_, below)| below.has_room(&writer, &layout));
    below.into_iter().for_each(|(place, below)| below.write(&mut writer, &layout, place, with_number));
    if let Some(legend) = legend.filter(|_| bottom < size[1]) {
        let first = &composers[0];
        let samples = first.samples(legend, layout.tile(0, 0), &framings[0], layout.tile_scale);
        let of_first = sheet.columns.iter().enumerate().filter(|(_, column)| column.scene == 0);
        let runs = of_first.flat_map(|(at, _)| moments.cells.iter().map(move |row| row[at].clone())).collect();
        let frame = Frame { index: 0, time: 0.0, runs };
        legend.draw(&mut writer, [size[0], bottom].map(f64::from), &samples, first.bar(&frame).as_ref());
    }

    let (mut under, mut marks, mut panels) = (Vec::new(), Vec::new(), Vec::new());
    for (row, cells) in moments.cells.iter().enumerate() {
        for (column, run) in cells.iter().enumerate() {
            let (composer, framing) = (&composers[sheet.columns[column].scene], &framings[column]);
            let draft = Draft::new(composer, layout.tile(row, column), run, framing, layout.tile_scale);
            let [left, top, width, height] = draft.viewport;
            let room = [left, top, width, height - (layout.below_body.ceil() as u32).min(height)];
            draft.ghost(&moments.others[row][column], room, &mut writer.curves);
            draft.paths(&composer.traced, room, &mut writer.curves);
            panels.push(draft.panel(&mut under, &mut marks));
            // Surfaces without width are invisible.
            let ends = cameras::collapsed(&draft);
            writer.curves.extend(ends.map(|ends| collapsed(ends, layout.tile_scale, palette.outline)));
        }
    }
    writer.over_bodies(&panels);
    marks.extend(writer.items());
    let ramp = composers.first().map_or_else(Vec::new, |composer| composer.ramp.clone());
    Picture { size, palette: *palette, fonts, ramp, panels, under, above: marks }
}

/// The scenes for their tiles: without words, in the look of the figure.
fn plain(figure: &Figure, sheet: &Sheet) -> Vec<Scene> {
    let scale = |scene: &Scene| {
        let run = |scale: ColourScale| scale.to.map(|run| scene.runs[run].name.clone());
        scene.view.colour.map(|scale| (run(scale), ColourScale { to: None, ..scale }))
    };
    let is_shared = sheet.scenes.windows(2).all(|two| scale(&two[0]) == scale(&two[1]));
    let one = |scene: &Scene| {
        let mut scene = scene.clone();
        let view = &mut scene.view;
        view.size = figure.size;
        view.look = figure.look.clone();
        view.labels = Labels { legend: view.labels.legend, ..Labels::NONE };
        view.charts.clear();
        // One colour scale for all, or none.
        view.colour = view.colour.filter(|_| is_shared);
        scene
    };
    sheet.scenes.iter().map(one).collect()
}

/// A collapsed body, as a line or a dot.
fn collapsed(ends: [DVec2; 2], scale: Scale, colour: Colour) -> Item {
    let is_dot = ends[0].distance(ends[1]) < 1.0;
    let width = scale.line() * if is_dot { COLLAPSED[1] } else { COLLAPSED[0] };
    let points = ends.map(|end| end.to_array());
    Item::curve(&points[..if is_dot { 1 } else { 2 }], width, &[], colour)
}

/// The key of colours and arrows, if there are any.
fn legend(scenes: &[Scene], size: [u32; 2], scale: Scale) -> Option<Legend> {
    let view = &scenes.first()?.view;
    let samples = [view.visible.displacements, view.ghost.is_some(), !view.paths.is_empty()];
    let samples = samples.iter().filter(|&&is_shown| is_shown).count();
    let any = view.labels.legend && (samples > 0 || view.colour.is_some());
    any.then(|| Legend::new(size, scale, samples, view.colour.is_some())).flatten()
}
