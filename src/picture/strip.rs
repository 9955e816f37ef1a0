//! Time series of a diagnostic: the curves of several runs in one chart, with two scales of time if most changes are
//! early. Its name stands left of it, and the names of the runs at the ends of their curves.

use super::axis::{Axis, Kind};
use super::caption::Writer;
use super::chart::{Chart, GAP, MOST_TICKS, ROWS_APART, wide};
use super::ends::Ends;
use super::layout::Scale;
use super::number;
use super::series::{self, Series};
use super::text::{Fonts, Weight};
use crate::look::Palette;
use crate::reading::captions::elements;
use crate::runner::history::History;
use crate::scene::Scene;
use crate::sim::Diagnostic;

/// Size of the unit's type, and the gap from the name to the unit (px in the reference picture).
const UNIT: f64 = 14.0;
const UNIT_BELOW: f64 = 19.0;
/// The meaning of a band for a dense count, in one line and in two.
const BAND: [&[&str]; 2] = [&["band: least to most"], &["band:", "least to most"]];
/// The gap between the name and the numbers beside the chart (px in the reference picture).
const BESIDE_NAME: f64 = 14.0;
/// The largest extent of the first time left of the chart (px in the reference picture).
const BEFORE_TIMES: f64 = 5.0;
/// The share of the width before a change of the scale of time, and the gap (px in the reference picture).
const BEFORE: f64 = 0.8;
const SPLIT_GAP: f64 = 12.0;

/// The time series of a diagnostic.
#[derive(Debug)]
pub(super) struct Strip {
    pub(super) diagnostic: Diagnostic,
    name: String,
    unit: String,
    /// One for each run shown.
    pub(super) series: Vec<Series>,
    /// Explanations of curves and bands, if needed.
    notes: Vec<String>,
    /// The range of values; `None` if there are none.
    range: Option<[f64; 2]>,
    /// The size of the body (m).
    extent: f64,
}

impl Strip {
    /// A diagnostic of all runs, as the mean over scenes with runs of the same names, in the colours of a picture;
    /// `label` replaces names of runs.
    ///
    /// # Panics
    /// If there is no scene.
    pub(super) fn new(
        diagnostic: Diagnostic,
        of_scenes: &[(&Scene, &History)],
        palette: &Palette,
        label: impl Fn(&str) -> String,
    ) -> Self {
        let scene = of_scenes[0].0;
        let one = |(scene, history): &(&Scene, &History), name: &str| {
            let own = history.series.iter().find(|series| scene.runs[series.run].name == name);
            own.map(|own| Series::new(diagnostic, own, scene, palette))
        };
        let of_run = |run: usize| {
            let name = &scene.runs[run].name;
            let mean = Series::mean(of_scenes.iter().filter_map(|of_scene| one(of_scene, name)).collect());
            mean.map(|mean| Series { name: label(&mean.name), ..mean })
        };
        let series: Vec<_> = of_scenes[0].1.series.iter().filter_map(|series| of_run(series.run)).collect();
        let is_count = diagnostic == Diagnostic::TurnedOver;
        // Counts are bounded by the number of elements, so diverged runs are shown in full.
        let range = series::range(&series, !is_count);
        let mut name = series::name(diagnostic, scene).to_owned();
        if let Some(first) = name.get_mut(..1) {
            first.make_ascii_uppercase();
        }
        let notes = match of_scenes.len() {
            1 => Vec::new(),
            count => vec![format!("{count} scenes: mean, range")],
        };
        let one = Self { diagnostic, name, unit: String::new(), notes, series, range, extent: scene.body.extent() };
        let unit = match one.values(MOST_TICKS) {
            _ if is_count => match elements(&scene.body)[..] {
                _ if of_scenes.iter().any(|(other, _)| elements(&other.body) != elements(&scene.body)) => {
                    "elements".to_owned()
                }
                [(count, name)] => format!("of {} {name}", number::count(count)),
                _ => format!("of {} elements", number::count(scene.body.elements.len())),
            },
            Some(axis) => axis.unit,
            None => "none".to_owned(),
        };
        Self { unit, ..one }
    }

    /// The axis of values with at most `most` ticks; `None` if there are no values.
    fn values(&self, most: usize) -> Option<Axis> {
        let kind = if self.diagnostic == Diagnostic::TurnedOver { Kind::Count } else { Kind::Value };
        self.range.map(|range| Axis::new(kind, range, self.diagnostic.unit(), self.extent, most))
    }

    /// The axis of values in a chart.
    pub(super) fn values_in(&self, chart: Chart) -> Option<Axis> {
        let rows = ((chart.bottom - chart.top) / (ROWS_APART * chart.unit)) as usize + 1;
        self.values(rows.min(MOST_TICKS))
    }

    /// The width of the numbers beside it (px), for any number of ticks, with the gap to its name.
    pub(super) fn numbers_width(&self, fonts: &Fonts, type_unit: f64) -> f64 {
        let texts = (2..=MOST_TICKS).filter_map(|most| self.values(most)).flat_map(|axis| axis.texts);
        texts.map(|text| wide(fonts, &text, type_unit)).fold(0.0, f64::max) + (GAP + BESIDE_NAME) * type_unit
    }

    /// The width of its name (px).
    pub(super) fn name_width(&self, fonts: &Fonts, scale: Scale) -> f64 {
        let below = |text: &str| fonts.width(text, Weight::Regular, UNIT * scale.type_unit());
        let name = fonts.width(&self.name, Weight::SemiBold, scale.caption());
        self.notes.iter().map(|note| below(note)).fold(name.max(below(&self.unit)), f64::max)
    }

    /// The height of its name with the lines below it (px).
    pub(super) fn name_height(&self, scale: Scale) -> f64 {
        scale.caption() + (1 + self.notes.len()) as f64 * UNIT_BELOW * scale.type_unit()
    }

    /// Writes name and unit from a left end around a height (px).
    pub(super) fn write_name(&self, writer: &mut Writer<'_>, [left, middle]: [f64; 2]) {
        let (scale, palette) = (writer.scale, writer.palette);
        let unit = scale.type_unit();
        let below = std::iter::once(&self.unit)
            .chain(&self.notes)
            .filter(|text| !text.is_empty() && Scale::legible(UNIT * unit));
        let below: Vec<_> = below.collect();
        let baseline = middle + 0.36 * scale.caption() - 0.5 * below.len() as f64 * UNIT_BELOW * unit;
        writer.left(&self.name, Weight::SemiBold, scale.caption(), palette.text, left, baseline);
        for (text, line) in below.into_iter().zip(1..) {
            let baseline = baseline + f64::from(line) * UNIT_BELOW * unit;
            writer.left(text, Weight::Regular, UNIT * unit, palette.second_text, left, baseline);
        }
    }

    /// Explains bands if a curve has any in a chart and the explanation has room.
    pub(super) fn explain_bands(&mut self, fonts: &Fonts, parts: &SplitChart, has_room: impl Fn(&Self) -> bool) {
        let has_bands = parts.0.iter().any(|&(chart, span)| {
            let (times, values) = (chart.times(fonts, span), self.values_in(chart));
            let has_band = |one: &Series| values.as_ref().is_some_and(|values| one.has_band(chart, [&times, values]));
            self.series.iter().any(|one| has_band(&one.between(span)))
        });
        if !has_bands {
            return;
        }
        let without = self.notes.len();
        for lines in BAND {
            self.notes.extend(lines.iter().map(|&line| line.to_owned()));
            if has_room(self) {
                return;
            }
            self.notes.truncate(without);
        }
    }

    /// Draws the chart, optionally with times below, and with names at the ends of its curves between two heights (px).
    pub(super) fn draw(
        &self,
        writer: &mut Writer<'_>,
        parts: &SplitChart,
        with_times: bool,
        names: Option<&Ends>,
        between: [f64; 2],
    ) {
        let mut ends = vec![None; self.series.len()];
        for (at, &(chart, span)) in parts.0.iter().enumerate() {
            let times = chart.times(writer.fonts, span);
            let values = self.values_in(chart);
            let series: Vec<_> = self.series.iter().map(|one| one.between(span)).collect();
            if let Some(values) = &values {
                for one in series.iter().filter(|one| one.is_count) {
                    chart.area(writer, [&times, values], &one.points);
                }
                chart.rows(writer, values, at == 0);
            }
            if with_times || values.is_none() {
                // The start is beside the lowest value's number, or beside the times of the other scale.
                let from = chart.left - if at == 0 { BEFORE_TIMES * chart.unit } else { 0.0 };
                chart.columns(writer, &times, values.is_none(), from);
            }
            let Some(values) = &values else { continue };
            for (one, end) in series.iter().zip(&mut ends) {
                one.draw(writer, chart, [&times, values]);
                *end = one.end(chart, [&times, values]).or(*end);
            }
        }
        if let (Some(names), Some(&(chart, _))) = (names, parts.0.last()) {
            names.write(writer, chart, &self.series, &ends, between);
        }
    }
}

/// A chart, or two beside each other for two scales of time, each with its range of time (s).
#[derive(Clone, Debug)]
pub(super) struct SplitChart(Vec<(Chart, [f64; 2])>);

impl SplitChart {
    /// A chart over some pixels to the right and down, from a first time to a last one (s); the scale of time may
    /// change between.
    pub(super) fn new(
        scale: Scale,
        [left, right]: [f64; 2],
        [top, bottom]: [f64; 2],
        [from, to]: [f64; 2],
        split: Option<f64>,
    ) -> Self {
        let (unit, line) = (scale.type_unit(), scale.unit);
        let chart = |[left, right]: [f64; 2]| Chart { left, right, top, bottom, unit, line };
        let Some(split) = split else { return Self(vec![(chart([left, right]), [from, to])]) };
        let gap = (SPLIT_GAP * scale.unit).round();
        let middle = (left + BEFORE * (right - left - gap)).round();
        Self(vec![(chart([left, middle]), [from, split]), (chart([middle + gap, right]), [split, to])])
    }

    /// The chart that shows a time (s), and the time's place in it (px).
    pub(super) fn place(&self, time: f64) -> (Chart, f64) {
        let part = self.0.iter().find(|(_, [_, to])| time <= *to).unwrap_or(&self.0[self.0.len() - 1]);
        let &(chart, [from, to]) = part;
        let share = ((time - from) / (to - from)).clamp(0.0, 1.0);
        (chart, chart.left + share * (chart.right - chart.left))
    }
}
