//! Charts below the tiles: diagnostics of all rows over the time of their scene, and the moments of the columns.

use crate::history::History;
use crate::look::Palette;
use crate::picture::Curve;
use crate::picture::axis::{Axis, Kind};
use crate::picture::caption::{self, Writer};
use crate::picture::chart::{Chart, GAP, MOST_TICKS, NUMBERS, ROWS_APART, dot, wide};
use crate::picture::ends::{Ends, spread};
use crate::picture::layout::{CURVE_NAME, Scale};
use crate::picture::narrow::narrow;
use crate::picture::series::{self, OWN, Series};
use crate::picture::text::{Fonts, Weight};
use crate::scene::figure::Sheet;
use crate::sim::snapshot::Diagnostic;
use crate::sim::words::elements;

/// Size of the units' type, and from a name to its unit (px in the reference picture).
const UNIT: f64 = 14.0;
const UNIT_BELOW: f64 = 19.0;
/// Between names and numbers (px in the reference picture).
const BESIDE_NAMES: f64 = 14.0;
/// The first time begins at most so far left of the chart (px in the reference picture).
const BEFORE_TIMES: f64 = 5.0;
/// Where the scale of time changes: the part of the width before, and the gap (px in the reference picture).
const BEFORE: f64 = 0.8;
const SPLIT_GAP: f64 = 12.0;
/// Radius of a ring, thickness of its rim, size of the letter in it, free beside this, and between rings (px in the
/// reference picture).
const RING: f64 = 10.0;
const RIM: f64 = 1.3;
const LETTER: f64 = 14.0;
const BESIDE_LETTER: f64 = 4.0;
const RINGS_APART: f64 = 3.0;
/// The part of the margin into which crowded rings reach at each end at the most.
const BEYOND: f64 = 0.35;
/// How far above the charts the lines of moments become upright, their width (px in the reference picture), and their
/// opacity.
const UPRIGHT_ABOVE: f64 = 9.0;
const MOMENT: f64 = 1.1;
const MOMENT_ALPHA: f64 = 0.62;
/// The part of the picture's width that names at the ends of curves take at most, and half of what is free between those
/// of two charts (px in the reference picture).
const NAMES: f64 = 0.16;
const NAMES_APART: f64 = 3.0;

/// Where charts stand (px).
pub(super) struct ChartsRoom {
    /// The middle of the rings above all charts.
    pub(super) rings: f64,
    /// Left and right end of all charts.
    pub(super) span: [f64; 2],
    /// Where their names begin.
    pub(super) names: Option<f64>,
    /// Top and bottom of each chart.
    pub(super) charts: Vec<[f64; 2]>,
    /// What is free between them.
    pub(super) between: f64,
}

/// What charts show.
pub(super) struct Charts<'a> {
    sheet: &'a Sheet,
    /// The last moment (s).
    end: f64,
    charts: Vec<One>,
    /// Names at the ends of curves, if there is room for them; the same beside all charts.
    ends: Option<Ends>,
    /// The room that names take, and that the numbers beside the charts take with gaps (px).
    pub(super) names_width: f64,
    pub(super) numbers_width: f64,
}

/// One chart.
struct One {
    diagnostic: Diagnostic,
    name: String,
    unit: String,
    /// One for each run shown.
    series: Vec<Series>,
    /// The values shown; `None` if there are none.
    range: Option<[f64; 2]>,
}

impl<'a> Charts<'a> {
    /// The charts of a sheet.
    pub(super) fn new(sheet: &'a Sheet, history: &History, writer: &Writer<'_>, width: f64) -> Self {
        let (fonts, scale) = (writer.fonts, writer.scale);
        let one = |&diagnostic: &Diagnostic| One::new(diagnostic, history, sheet, writer.palette);
        let charts: Vec<_> = sheet.strips.iter().map(one).collect();
        // The lines of all charts have the same names.
        let room = [NAMES * width, f64::INFINITY];
        let ends = charts.iter().find_map(|one| Ends::new(fonts, &one.series, scale.type_unit(), room));
        let type_unit = scale.type_unit();
        let numbers = charts.iter().map(|one| one.numbers_width(fonts, type_unit)).fold(0.0, f64::max);
        let names = charts.iter().map(|one| one.name_width(fonts, scale)).fold(0.0, f64::max);
        let numbers_width = numbers + (GAP + BESIDE_NAMES) * type_unit;
        Self { sheet, end: history.end, charts, ends, names_width: names, numbers_width }
    }

    /// The width of the names right of the charts (px).
    pub(super) fn ends_width(&self) -> f64 {
        self.ends.as_ref().map_or(0.0, |ends| ends.width)
    }

    /// The height that the names of all curves of a chart need (px in the reference picture).
    pub(super) fn ends_height(&self) -> f64 {
        let names = self.charts.iter().map(|one| one.series.len()).max().unwrap_or(0);
        self.ends.as_ref().map_or(0.0, |_| names as f64 * CURVE_NAME + 2.0 * NAMES_APART)
    }

    pub(super) fn count(&self) -> usize {
        self.charts.len()
    }

    /// Draws as many charts as there is room for.
    pub(super) fn draw(&self, writer: &mut Writer<'_>, room: &ChartsRoom) {
        let scale = writer.scale;
        if !Scale::legible(NUMBERS * scale.type_unit()) || self.end <= 0.0 {
            return;
        }
        let bottom = room.charts.last().map_or(0.0, |chart| chart[1]);
        self.moments(writer, room, bottom);
        for (at, (one, &[top, bottom])) in self.charts.iter().zip(&room.charts).enumerate() {
            let parts = self.parts(scale, room.span, [top, bottom]);
            // Names may stand beside the gaps between charts, too, but not next to those of another chart.
            let beyond = 0.5 * room.between - NAMES_APART * scale.type_unit();
            let between = [top - beyond, bottom + beyond];
            one.draw(writer, &parts, at + 1 == room.charts.len(), self.ends.as_ref(), between);
            if let Some(left) = room.names {
                one.write_name(writer, [left, 0.5 * (top + bottom)]);
            }
        }
    }

    /// The charts, each with the time that it shows (s), that stand beside each other for two scales of time.
    fn parts(&self, scale: Scale, [left, right]: [f64; 2], [top, bottom]: [f64; 2]) -> Vec<(Chart, [f64; 2])> {
        let line = scale.line_factor * scale.unit;
        let [unit, thin] = [1.0, scale.line_factor].map(|factor| factor * scale.type_unit());
        let chart = |[left, right]: [f64; 2]| Chart { left, right, top, bottom, unit, line, thin };
        let Some(split) = self.sheet.split else { return vec![(chart([left, right]), [self.sheet.from, self.end])] };
        let gap = (SPLIT_GAP * scale.unit).round();
        let middle = (left + BEFORE * (right - left - gap)).round();
        vec![(chart([left, middle]), [self.sheet.from, split]), (chart([middle + gap, right]), [split, self.end])]
    }

    /// A line through all charts at the moment of each column, with the column's letter in a ring above.
    fn moments(&self, writer: &mut Writer<'_>, room: &ChartsRoom, bottom: f64) {
        let (scale, palette, fonts) = (writer.scale, writer.palette, writer.fonts);
        let top = room.charts[0][0] - UPRIGHT_ABOVE * scale.type_unit();
        let parts = self.parts(scale, room.span, [top, bottom]);
        let place = |time: f64| {
            let (chart, [from, to]) = parts.iter().find(|(_, [_, to])| time <= *to).or(parts.last())?;
            let share = ((time - from) / (to - from)).clamp(0.0, 1.0);
            Some((chart.left + share * (chart.right - chart.left)).floor() + 0.5)
        };
        let columns = self.sheet.columns.iter().enumerate();
        let times = columns.filter_map(|(at, column)| Some((place(column.time?)?, caption::letter(at))));
        let mut moments: Vec<_> = times.collect();
        moments.sort_by(|one, other| one.0.total_cmp(&other.0));
        let wide = |text: &str| fonts.width(text, Weight::SemiBold, LETTER * scale.type_unit());
        let widest = moments.iter().map(|(_, letter)| wide(letter)).fold(0.0, f64::max);
        let radius = (RING * scale.type_unit()).max(0.5 * widest + BESIDE_LETTER * scale.type_unit());
        let apart = 2.0 * radius + RINGS_APART * scale.type_unit();
        // The outermost ones reach into the margins, but not to the picture's sides.
        let span = room.span[1] - room.span[0] + 2.0 * radius.min(BEYOND * scale.margin());
        // Many rings become smaller as long as their letters can be read, and are then left out.
        let smaller = (span / (apart * moments.len().max(1) as f64)).min(1.0);
        let letter = LETTER * scale.type_unit() * smaller;
        let with_rings = Scale::legible(letter);
        let places: Vec<_> = moments.iter().map(|&(x, _)| x).collect();
        let rings = spread(&places, apart * smaller, room.span);
        let curve = |points: &[[f64; 2]], alpha: f64| Curve {
            points: points.iter().map(|point| point.map(narrow)).collect(),
            width: narrow(MOMENT * scale.line()),
            dash: Vec::new(),
            colour: palette.second_text,
            alpha: narrow(alpha),
        };
        for (&x, &ring) in places.iter().zip(&rings) {
            let from = if with_rings { [ring, room.rings] } else { [x, top] };
            let is_straight = (ring - x).abs() < 0.75 || !with_rings;
            let points: &[_] = if is_straight { &[[x, from[1]], [x, bottom]] } else { &[from, [x, top], [x, bottom]] };
            writer.curves.push(curve(points, MOMENT_ALPHA));
        }
        if !with_rings {
            return;
        }
        let rim = RIM * scale.line();
        for ((x, text), &ring) in moments.iter().zip(&rings) {
            let at = [if (ring - x).abs() < 0.75 { *x } else { ring }, room.rings];
            for (radius, colour) in
                [(radius * smaller, palette.second_text), (radius * smaller - rim, palette.background)]
            {
                writer.curves.push(dot(at, radius, colour));
            }
            let left = at[0] - 0.5 * wide(text) * smaller;
            writer.left(text, Weight::SemiBold, letter, palette.text, left, at[1] + 0.36 * letter);
        }
    }
}

impl One {
    fn new(diagnostic: Diagnostic, history: &History, sheet: &Sheet, palette: &Palette) -> Self {
        let scene = &sheet.scenes[0];
        let one = |of_run| {
            let one = Series::new(diagnostic, of_run, scene, palette);
            // A label shared by all rows of a run replaces its name.
            let mut labels = sheet.rows.iter().filter(|row| row.run == one.name).map(|row| &row.label);
            let label = labels.next().filter(|first| labels.all(|label| label == *first)).cloned();
            Series { name: label.unwrap_or(one.name.clone()), ..one }
        };
        let series: Vec<_> = history.series.iter().map(one).collect();
        let is_count = diagnostic == Diagnostic::TurnedOver;
        let range = series::range(&series, !is_count);
        let mut name = series::name(diagnostic, scene).to_owned();
        if let Some(first) = name.get_mut(..1) {
            first.make_ascii_uppercase();
        }
        let one = Self { diagnostic, name, unit: String::new(), series, range };
        let unit = match one.values(MOST_TICKS) {
            _ if is_count => match elements(&scene.body)[..] {
                [(count, name)] => format!("of {count} {name}"),
                _ => format!("of {} elements", scene.body.elements.len()),
            },
            Some(axis) => axis.unit,
            None => "none".to_owned(),
        };
        Self { unit, ..one }
    }

    /// The axis of values with so many ticks at most; `None` if there are no values.
    fn values(&self, most: usize) -> Option<Axis> {
        let kind = if self.diagnostic == Diagnostic::TurnedOver { Kind::Count } else { Kind::Value };
        self.range.map(|range| Axis::new(kind, range, self.diagnostic.unit(), most))
    }

    /// The width of the widest number beside it (px), however many ticks there are.
    fn numbers_width(&self, fonts: &Fonts, type_unit: f64) -> f64 {
        let texts = (2..=MOST_TICKS).filter_map(|most| self.values(most)).flat_map(|axis| axis.texts);
        texts.map(|text| wide(fonts, &text, type_unit)).fold(0.0, f64::max)
    }

    fn name_width(&self, fonts: &Fonts, scale: Scale) -> f64 {
        let unit = fonts.width(&self.unit, Weight::Regular, UNIT * scale.type_unit());
        fonts.width(&self.name, Weight::SemiBold, scale.caption()).max(unit)
    }

    /// Name and unit around a place (px).
    fn write_name(&self, writer: &mut Writer<'_>, [left, middle]: [f64; 2]) {
        let (scale, palette) = (writer.scale, writer.palette);
        let unit = scale.type_unit();
        let has_unit = !self.unit.is_empty() && Scale::legible(UNIT * unit);
        let baseline = middle + 0.36 * scale.caption() - if has_unit { 0.5 * UNIT_BELOW * unit } else { 0.0 };
        writer.left(&self.name, Weight::SemiBold, scale.caption(), palette.text, left, baseline);
        let below = baseline + UNIT_BELOW * unit;
        writer.left(&self.unit, Weight::Regular, UNIT * unit, palette.second_text, left, below);
    }

    /// Draws it, with the times below if it is the last one, and names at the ends of its curves between two heights (px).
    fn draw(
        &self,
        writer: &mut Writer<'_>,
        parts: &[(Chart, [f64; 2])],
        is_last: bool,
        names: Option<&Ends>,
        between: [f64; 2],
    ) {
        let mut ends = vec![None; self.series.len()];
        for (at, &(chart, span)) in parts.iter().enumerate() {
            let times = chart.times(writer.fonts, span);
            let rows = ((chart.bottom - chart.top) / (ROWS_APART * chart.unit)) as usize + 1;
            let values = self.values(rows.min(MOST_TICKS));
            let series: Vec<_> = self.series.iter().map(|one| one.between(span)).collect();
            if let Some(values) = &values {
                for one in series.iter().filter(|one| one.is_count) {
                    chart.area(writer, [&times, values], &one.points);
                }
                chart.rows(writer, values, at == 0);
            }
            if is_last || values.is_none() {
                // Beside the lowest value's number, and beside the times of the other scale.
                let from = chart.left - if at == 0 { BEFORE_TIMES * chart.unit } else { 0.0 };
                chart.columns(writer, &times, values.is_none(), from);
            }
            let Some(values) = &values else { continue };
            for (one, end) in series.iter().zip(&mut ends) {
                one.draw(writer, chart, [&times, values], [OWN, 1.0]);
                *end = one.end(chart, [&times, values]).or(*end);
            }
        }
        if let (Some(names), Some(&(chart, _))) = (names, parts.last()) {
            names.write(writer, chart, &self.series, &ends, None, between);
        }
    }
}
