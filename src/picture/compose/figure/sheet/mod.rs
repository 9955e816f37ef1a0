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

use crate::look::{ColourScale, Labels, View, print};
use crate::picture::caption::Writer;
use crate::picture::chart::Stack;
use crate::picture::compose::Composer;
use crate::picture::compose::draft::Draft;
use crate::picture::compose::overlay::{KeyPlace, have_colours_of_runs};
use crate::picture::compose::plane_marks::have_slopes;
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
use below::{Below, TallyKey, Written};
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
    let mut composers = composers(&scenes, sheet, moments);
    let plan = Plan::new((figure, size), (sheet, moments), &mut composers, &writer);
    let layout = &plan.layout;
    let has_key = plan.write(&mut writer, sheet, moments);

    let framings = cameras::framings(&scenes, sheet, moments, layout);
    let written = write_below(&mut writer, layout, &composers, sheet, moments);
    if let Some((legend, [_, top, ..])) = plan.legend.zip(layout.page.get(Part::Legend)) {
        let first = &composers[0];
        let place = KeyPlace::new(first, legend, layout.tile(0, 0), &framings[0], layout.tile_scale);
        let samples = first.samples(&place);
        let of_first = sheet.columns.iter().enumerate().filter(|(_, column)| column.scene == 0);
        let runs = of_first.flat_map(|(at, _)| moments.cells.iter().map(move |row| row[at].clone())).collect();
        let frame = Frame { index: 0, time: 0.0, runs };
        legend.draw(&mut writer, [f64::from(size[0]), top], &samples, first.bar(&frame).as_ref());
    }
    let lost = [(!has_key, Part::Key), (plan.headings.is_cut, Part::Heading), (written.is_none(), Part::Numbers)];
    let lost: Vec<_> = lost.into_iter().filter(|(is_lost, _)| *is_lost).map(|(_, part)| part).collect();
    let mut left_out = layout::told(&layout.page, &lost);
    if sheet.number.is_some() && written == Some(false) {
        left_out.push("panels do not show `sheet.number`".to_owned());
    }

    let (mut under, mut marks, mut panels) = (Vec::new(), Vec::new(), Vec::new());
    for ([row, column], run) in cells(moments) {
        let (composer, framing) = (&composers[sheet.columns[column].scene], &framings[column]);
        let [left, top, width, height] = layout.tile(row, column);
        let room = [left, top, width, height - (layout.below_body.ceil() as u32).min(height)];
        let draft = Draft::new(composer, [left, top, width, height], run, framing, layout.tile_scale);
        let draft = Draft { room, others: &moments.others[row][column], ..draft };
        panels.push(draft.panel(&mut under, &mut marks));
        draft.overlays(&mut marks, &mut writer.curves);
        // Surfaces without width are invisible.
        let ends = cameras::collapsed(&draft);
        writer.curves.extend(ends.map(|ends| collapsed(ends, layout.tile_scale, palette.outline)));
    }
    writer.over_bodies(&panels, scenes.iter().any(have_slopes));
    marks.extend(writer.items());
    let ramp = composers.first().map_or_else(Vec::new, |composer| composer.ramp.clone());
    (Picture { size, palette: *palette, fonts, ramp, panels, under, above: marks }, left_out)
}

/// The composers of the scenes. The tiles of a scene share data that is computed once.
fn composers<'s>(scenes: &'s [Scene], sheet: &Sheet, moments: &Moments) -> Vec<Composer<'s>> {
    let traced = |scene: usize| moments.histories.get(scene).map_or_else(Vec::new, |history| history.series.clone());
    let composer =
        |(at, (scene, reach))| Composer { reach, traced: traced(at), ..Composer::new(scene, &History::default()) };
    scenes.iter().zip(cameras::reaches(scenes, sheet, moments)).enumerate().map(composer).collect()
}

/// The cells of a sheet with their rows and columns.
fn cells(moments: &Moments) -> impl Iterator<Item = ([usize; 2], &RunFrame)> {
    let rows = moments.cells.iter().enumerate();
    rows.flat_map(|(row, cells)| cells.iter().enumerate().map(move |(column, run)| ([row, column], run)))
}

/// The words of a sheet, and their places.
struct Plan {
    /// The lines of the title and of the caption.
    titles: [Vec<String>; 2],
    key: TallyKey,
    legend: Option<Legend>,
    charts: Option<Stack>,
    labels: RowLabels,
    headings: Headings,
    layout: SheetLayout,
    /// The width of the picture (px).
    width: f64,
}

impl Plan {
    /// Plans a sheet of a size (px) in the type of a writer, and gives the tallies of all composers one style.
    fn new(
        (figure, size): (&Figure, [u32; 2]),
        (sheet, moments): (&Sheet, &Moments),
        composers: &mut [Composer<'_>],
        writer: &Writer<'_>,
    ) -> Self {
        let (width, scale) = (f64::from(size[0]), writer.scale);
        let mut titles = writer.titles(scale, [&figure.title, &figure.caption], width - 2.0 * scale.margin());
        if titles[0].is_empty() {
            // The key stands beside the title or the caption.
            titles[0].push(String::new());
        }
        let legend = Legend::of(&composers[0].scene.view, scale);
        let has_charts = !sheet.charts.is_empty();
        let charts = has_charts.then(|| charts::stack(sheet, &moments.histories, writer, width));
        let with_sample = has_charts || composers.iter().any(|composer| have_colours_of_runs(&composer.scene.view));
        let labels = RowLabels::new(sheet, writer, with_sample, width);
        let wanted = Wanted {
            titles: titles.each_ref().map(Vec::len),
            is_figure: true,
            charts: charts.as_ref().map_or([0; 2], |charts| [charts.count(), charts.names()]),
            own_axes: charts.as_ref().map_or(0, |charts| charts.count() - charts.over_time()),
            legend: legend.map(|legend| legend.height),
            ..Wanted::default()
        };
        let beside = charts.as_ref().map_or([0.0; 2], |charts| [charts.names_width, charts.numbers_width]);
        let plan = |wanted: Wanted, pitch: f64| SheetLayout::new(sheet, (size, scale), wanted, &labels, beside, pitch);
        // The width of tiles does not depend on what is above them.
        let layout = plan(wanted, f64::INFINITY);
        let pitch = f64::from(layout.tile_size[0]);
        let shown: Vec<_> = cells(moments).map(|([_, at], run)| [sheet.columns[at].scene, run.run]).collect();
        below::unify(composers, &shown, scale, &layout);
        let headings = Headings::new(sheet, writer, pitch);
        let layout = plan(Wanted { headings: headings.lines(), ..wanted }, pitch);
        let has_flat = cells(moments).any(|(_, run)| run.snapshot.flat.contains(&true));
        let key = TallyKey::new(composers, &shown, has_flat);
        Self { titles, key, legend, charts, labels, headings, layout, width }
    }

    /// Writes the words around the tiles, and draws the charts. Returns whether the key of tallies has room.
    fn write(&self, writer: &mut Writer<'_>, sheet: &Sheet, moments: &Moments) -> bool {
        let Self { titles, key, charts, layout, width, .. } = self;
        let (scale, margin) = (writer.scale, writer.scale.margin());
        let is_beside = |text: &String| {
            let room = [key.width(writer, text), width - 2.0 * margin];
            writer.beside(&layout.page, scale, titles, room).map(|baseline| [width - margin, baseline])
        };
        let place = key.wordings.iter().find_map(|text| Some((text, is_beside(text)?)));
        place.into_iter().for_each(|(text, place)| key.write(writer, text, place));
        for (part, lines) in [Part::Title, Part::Caption].into_iter().zip(titles) {
            writer.lines(&layout.page, part, scale, lines, margin);
        }
        self.labels.write(writer, &layout.page, sheet);
        self.headings.write(writer, layout);
        if let Some(charts) = charts {
            let [left, _, tile, _] = layout.tile(0, 0).map(f64::from);
            let right = left + tile * sheet.columns.len() as f64 - charts.ends_width();
            let names = layout.page.get(Part::Words).map(|[left, ..]| left);
            if let Some(room) = Room::new(&layout.page, scale, ([left, right], charts.over_time()), names, true) {
                charts::draw(charts, sheet, moments.histories[0].end, writer, &room);
            }
        }
        place.is_some()
    }
}

/// Writes tallies and numbers below the bodies. All tiles have the same parts: returns whether they have the diagnostic, `None` without room for any.
fn write_below(
    writer: &mut Writer<'_>,
    layout: &SheetLayout,
    composers: &[Composer<'_>],
    sheet: &Sheet,
    moments: &Moments,
) -> Option<bool> {
    let below = |(at, run): ([usize; 2], _)| {
        (at, Below::new(writer, layout, &composers[sheet.columns[at[1]].scene], run, sheet.number))
    };
    let all: Vec<_> = cells(moments).map(below).collect();
    let fits = |&written: &Written| all.iter().all(|(_, below)| below.has_room(writer, layout, written));
    let wordings = [[true, true], [false, true], [true, false], [false, false]];
    let written = wordings.into_iter().find(fits).filter(|_| layout.page.get(Part::Numbers).is_some())?;
    all.iter().for_each(|(at, below)| below.write(writer, layout, *at, written));
    Some(written[1])
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
