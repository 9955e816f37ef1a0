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

use crate::look::{ColourScale, Ghost, Labels, View, print};
use crate::picture::caption::Writer;
use crate::picture::compose::Composer;
use crate::picture::compose::draft::Draft;
use crate::picture::layout::steps::{FREE, NEAR};
use crate::picture::layout::{self, Part, Room, Scale, Wanted};
use crate::picture::legend::Legend;
use crate::picture::text::Fonts;
use crate::picture::{Colour, Item, Picture};
use crate::runner::history::History;
use crate::runner::moments::Moments;
use crate::runner::{Frame, RunFrame};
use crate::scene::Scene;
use crate::scene::figure::{Figure, Sheet};
use below::{Below, Key};
use glam::DVec2;
use headings::Headings;
use rows::RowLabels;
use sheet_layout::SheetLayout;

/// Composes a sheet, and tells what has no room in it.
pub(super) fn compose(figure: &Figure, sheet: &Sheet, moments: &Moments) -> (Picture, Vec<String>) {
    let size = figure.size.map(|length| length.max(1));
    let scale = Scale::at(print::unit_of_sheet(size)).with(&View { look: figure.look.clone(), ..View::default() });
    let fonts = Fonts::new(&figure.look.font);
    let palette = &figure.look.palette();
    let mut writer = Writer::new(palette, &fonts, scale);
    let scenes = plain(figure, sheet);
    let reaches = cameras::reaches(&scenes, sheet, moments);
    // The tiles of a scene share data that is computed once.
    let traced = |scene: usize| moments.histories.get(scene).map_or_else(Vec::new, |history| history.series.clone());
    let composer =
        |(at, (scene, reach))| Composer { reach, traced: traced(at), ..Composer::new(scene, &History::default()) };
    let mut composers: Vec<_> = scenes.iter().zip(reaches).enumerate().map(composer).collect();
    let of_row = |row: &Vec<RunFrame>| -> Vec<_> {
        row.iter().zip(&sheet.columns).map(|(run, of)| [of.scene, run.run]).collect()
    };
    let shown: Vec<_> = moments.cells.iter().flat_map(of_row).collect();
    let (width, margin) = (f64::from(size[0]), scale.margin());
    let room = width - 2.0 * margin;

    let mut titles = writer.titles(scale, [&figure.title, &figure.caption], room);
    if titles[0].is_empty() {
        // The key stands beside the title or the caption.
        titles[0].push(String::new());
    }
    let legend = Legend::of(&scenes[0].view, scale);
    let has_charts = !sheet.charts.is_empty();
    let charts = has_charts.then(|| charts::stack(sheet, &moments.histories, &writer, width));
    let shows_runs = |scene: &Scene| matches!(scene.view.ghost, Some(Ghost::Run(_))) || !scene.view.paths.is_empty();
    let with_sample = has_charts || scenes.iter().any(shows_runs);
    let labels = RowLabels::new(sheet, &writer, with_sample, width);
    let wanted = Wanted {
        titles: titles.each_ref().map(Vec::len),
        is_figure: true,
        charts: charts.as_ref().map_or([0; 2], |charts| [charts.count(), charts.names()]),
        legend: legend.map(|legend| legend.height),
        ..Wanted::default()
    };
    let beside = charts.as_ref().map_or([0.0; 2], |charts| [charts.names_width, charts.numbers_width]);
    let plan = |wanted: Wanted, pitch: f64| SheetLayout::new(sheet, (size, scale), wanted, &labels, beside, pitch);
    // The width of tiles does not depend on what is above them.
    let layout = plan(wanted, f64::INFINITY);
    let pitch = f64::from(layout.tile_size()[0]);
    below::unify(&mut composers, &shown, scale, &layout);
    let headings = Headings::new(sheet, &writer, pitch);
    let wanted = Wanted { headings: headings.lines(), ..wanted };
    let layout = plan(wanted, pitch);
    let has_flat = moments.cells.iter().flatten().any(|run| run.snapshot.flat.contains(&true));
    let key = Key::new(&composers, &shown, has_flat);
    let is_beside = |text: &&String| {
        let length = key.width(&writer, text);
        writer.beside(&layout.page, scale, &titles, [length, room]).map(|baseline| [width - margin, baseline])
    };
    let key_place = key.wordings.iter().find_map(|text| Some((text, is_beside(&text)?)));
    if let Some((text, place)) = key_place {
        key.write(&mut writer, text, place);
    }
    for (part, lines) in [Part::Title, Part::Caption].into_iter().zip(&titles) {
        writer.lines(&layout.page, part, scale, lines, margin);
    }
    labels.write(&mut writer, &layout.page, sheet);
    headings.write(&mut writer, &layout);
    if let Some(charts) = &charts {
        let [left, _, tile, _] = layout.tile(0, 0).map(f64::from);
        let right = left + tile * sheet.columns.len() as f64 - charts.ends_width();
        let names = layout.page.get(Part::Words).map(|[left, ..]| left);
        if let Some(room) = Room::new(&layout.page, scale, [left, right], names, true) {
            charts::draw(charts, sheet, moments.histories[0].end, &mut writer, &room);
        }
    }

    let framings = cameras::framings(&scenes, sheet, moments, &layout);
    let mut below = Vec::new();
    for (row, cells) in moments.cells.iter().enumerate() {
        for (column, run) in cells.iter().enumerate() {
            let composer = &composers[sheet.columns[column].scene];
            below.push(([row, column], Below::new(&writer, &layout, composer, run, sheet.number)));
        }
    }
    // All tiles have the same parts.
    let fits = |&most: &usize| below.iter().all(|(_, below)| below.has_room(&writer, &layout, most));
    let most = [2, 1].into_iter().find(fits).filter(|_| layout.page.get(Part::Numbers).is_some());
    for (place, below) in &below {
        most.iter().for_each(|&most| below.write(&mut writer, &layout, *place, most));
    }
    if let Some((legend, [_, top, ..])) = legend.zip(layout.page.get(Part::Legend)) {
        let first = &composers[0];
        let samples = first.samples(legend, layout.tile(0, 0), &framings[0], layout.tile_scale);
        let of_first = sheet.columns.iter().enumerate().filter(|(_, column)| column.scene == 0);
        let runs = of_first.flat_map(|(at, _)| moments.cells.iter().map(move |row| row[at].clone())).collect();
        let frame = Frame { index: 0, time: 0.0, runs };
        legend.draw(&mut writer, [width, top], &samples, first.bar(&frame).as_ref());
    }
    let lost = [(key_place.is_none(), Part::Key), (headings.is_cut, Part::Heading), (most.is_none(), Part::Numbers)];
    let lost: Vec<_> = lost.into_iter().filter(|(is_lost, _)| *is_lost).map(|(_, part)| part).collect();
    let mut left_out = layout::told(&layout.page, &lost);
    if sheet.number.is_some() && most == Some(1) {
        left_out.push("panels do not show `sheet.number`".to_owned());
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
    (Picture { size, palette: *palette, fonts, ramp, panels, under, above: marks }, left_out)
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
    let width = scale.line() * if is_dot { NEAR } else { FREE };
    let points = ends.map(|end| end.to_array());
    Item::curve(&points[..if is_dot { 1 } else { 2 }], width, &[], colour)
}
