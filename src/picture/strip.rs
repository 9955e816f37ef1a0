//! The strip below a panel: the time series of a diagnostic of its run, those of the other runs faintly behind it, and a
//! mark at the present time. All strips of a picture have the same axes, and nothing in them moves but that mark.

use super::axis::{Axis, Kind};
use super::caption::Writer;
use super::chart::{BELOW, Chart, GAP, MOST_TICKS, NUMBERS, ROWS_APART, dot, wide};
use super::ends::Ends;
use super::layout::{LEAST_CHART, LEAST_STRIP_UNIT, MOST_OTHERS, Rectangle, Scale};
use super::series::{self, OWN, Series};
use super::text::Weight;
use crate::history::History;
use crate::scene::Scene;
use crate::sim::snapshot::{Diagnostic, RunFrame, Status};

/// Size of the name's type (px in the reference picture).
const NAME: f64 = 16.0;
/// From the top of the strip to the baseline of its name and to its chart (px in the reference picture).
const NAME_BASELINE: f64 = 13.0;
const ABOVE: f64 = 26.0;
/// The narrowest chart (px).
const LEAST_WIDTH: f64 = 40.0;
/// Width of other runs' curves, and their opacity; radius of the dot, and its halo (px in the reference picture).
const OTHER: f64 = 1.4;
const FAINT: f64 = 0.55;
const DOT: f64 = 4.5;
const HALO: f64 = 2.2;
/// The part of a strip's width that the names at the ends of curves take at most, and how far above the chart they begin
/// at most (px in the reference picture).
const NAMES: f64 = 0.4;
const NAMES_ABOVE: f64 = 8.0;

/// What the strips of a scene show.
#[derive(Debug)]
pub(super) struct Strips {
    diagnostic: Diagnostic,
    /// Its name in the picture.
    name: &'static str,
    /// The last time shown (s).
    end: f64,
    series: Vec<Series>,
    /// The values that all strips show; `None` if there are none.
    range: Option<[f64; 2]>,
}

impl Strips {
    /// Prepares to show a diagnostic of all runs of a history.
    pub(super) fn new(diagnostic: Diagnostic, history: &History, scene: &Scene) -> Self {
        let palette = &scene.view.look.palette;
        let one = |of_run| Series::new(diagnostic, of_run, scene, palette);
        let series: Vec<_> = history.series.iter().map(one).collect();
        // Counts are bounded by the number of elements, so diverged runs are shown whole.
        let range = series::range(&series, diagnostic != Diagnostic::TurnedOver);
        let name = series::name(diagnostic, scene);
        Self { diagnostic, name, end: history.end, series, range }
    }

    /// Draws the strip of a run into a rectangle; nothing if that is too small to be read.
    pub(super) fn draw(&self, writer: &mut Writer<'_>, rectangle: Rectangle, shown: &RunFrame) {
        let unit = writer.scale.of_type(writer.scale.unit.max(LEAST_STRIP_UNIT));
        let [left, top_of_all, width, height] = rectangle.map(f64::from);
        let [top, bottom] = [top_of_all + (ABOVE * unit).round(), top_of_all + height - (BELOW * unit).round()];
        let chart = Chart {
            left,
            right: left + width,
            top,
            bottom,
            unit,
            line: writer.scale.line_factor * writer.scale.unit.max(LEAST_STRIP_UNIT),
            thin: writer.scale.line_factor * unit,
        };
        let enough = width >= LEAST_WIDTH && bottom - top >= LEAST_CHART && Scale::legible(NUMBERS * unit);
        if !enough || self.end <= 0.0 {
            return;
        }
        let kind = if self.is_count() { Kind::Count } else { Kind::Value };
        let rows = ((bottom - top) / (ROWS_APART * unit)) as usize + 1;
        let values = self.range.map(|range| Axis::new(kind, range, self.diagnostic.unit(), rows.min(MOST_TICKS)));
        let own = self.series.iter().find(|one| one.run == shown.run && !one.points.is_empty());
        let unit_text = values.as_ref().map_or("", |axis| &axis.unit);
        let note = match (unit_text, own) {
            ("", Some(_)) => String::new(),
            ("", None) => ": none".to_owned(),
            (unit_text, Some(_)) => format!(" ({unit_text})"),
            (unit_text, None) => format!(" ({unit_text}): none"),
        };
        let numbers =
            values.iter().flat_map(|axis| &axis.texts).map(|text| wide(writer.fonts, text, unit)).fold(0.0, f64::max);
        let indent = if numbers > 0.0 { numbers + GAP * unit } else { 0.0 };
        let between = [chart.top - NAMES_ABOVE * unit, top_of_all + height];
        let few = self.series.len() <= MOST_OTHERS + 1;
        let room = [NAMES * width, between[1] - between[0]];
        let names = few.then(|| Ends::new(writer.fonts, &self.series, unit, room)).flatten();
        let taken = names.as_ref().map_or(0.0, |names| names.width);
        let chart = Chart { left: (left + indent).round(), right: (chart.right - taken).round(), ..chart };
        if chart.right - chart.left < LEAST_WIDTH {
            return;
        }
        self.write_name(writer, [left, top - (ABOVE - NAME_BASELINE) * unit, width], &note, unit);
        let times = chart.times(writer.fonts, [0.0, self.end]);
        if let Some(values) = &values {
            if let Some(own) = own.filter(|_| self.is_count()) {
                chart.area(writer, [&times, values], &own.points);
            }
            chart.rows(writer, values, true);
        }
        chart.columns(writer, &times, values.is_none(), f64::NEG_INFINITY);
        let palette = writer.palette;
        if let Some(values) = &values {
            let others = self.series.iter().filter(|one| one.run != shown.run);
            for one in others.filter(|_| few) {
                one.draw(writer, chart, [&times, values], [OTHER, FAINT]);
            }
            if let Some(names) = &names {
                let ends: Vec<_> = self.series.iter().map(|one| one.end(chart, [&times, values])).collect();
                names.write(writer, chart, &self.series, &ends, Some(shown.run), between);
            }
        }
        let now = chart.x(&times, shown.snapshot.time);
        writer.curves.push(chart.moment(now, palette.text));
        let Some((own, values)) = own.zip(values.as_ref()) else { return };
        own.draw(writer, chart, [&times, values], [OWN, 1.0]);
        let value = self.diagnostic.of(&shown.snapshot.diagnostics);
        let y = chart.y(values, value);
        if shown.snapshot.status == Status::Ok && (chart.top - 1.0..=chart.bottom + 1.0).contains(&y) {
            for (radius, colour) in [(DOT + HALO, palette.background), (DOT, own.style.colour)] {
                writer.curves.push(dot([now, y], radius * chart.thickness(), colour));
            }
        }
    }

    fn is_count(&self) -> bool {
        self.diagnostic == Diagnostic::TurnedOver
    }

    /// The name with a note behind it.
    fn write_name(&self, writer: &mut Writer<'_>, [left, baseline, room]: [f64; 3], note: &str, unit: f64) {
        let size = NAME * unit;
        let fonts = writer.fonts;
        let name = fonts.shortened(self.name, Weight::SemiBold, size, room);
        let after = left + fonts.width(&name, Weight::SemiBold, size);
        writer.words.push(writer.fonts.lay_out(&name, Weight::SemiBold, size, writer.palette.text, left, baseline));
        if !note.is_empty() && fonts.width(note, Weight::Regular, size) <= left + room - after {
            // Shortening would lose the space before it, so the note is written whole or not at all.
            writer.words.push(writer.fonts.lay_out(
                note,
                Weight::Regular,
                size,
                writer.palette.second_text,
                after,
                baseline,
            ));
        }
    }
}
