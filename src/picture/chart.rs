//! A chart without a box: hairlines at round values, ticks at round times.

use super::Item;
use super::axis::{Axis, Kind};
use super::caption::Writer;
use super::text::{Fonts, Weight};
use crate::colour::{Colour, mixed};

/// Size of the numbers at ticks (px in the reference picture).
pub(super) const NUMBERS: f64 = 14.0;
/// The height below the chart for its times (px in the reference picture).
pub(super) const BELOW: f64 = 20.0;
/// The gap between the numbers at the left and the chart, the length of a tick of time, and the least vertical and
/// horizontal distances of numbers (px in the reference picture).
pub(super) const GAP: f64 = 8.0;
const TICK: f64 = 4.0;
pub(super) const ROWS_APART: f64 = 21.0;
const COLUMNS_APART: f64 = 30.0;
/// The most ticks of values and of time.
pub(super) const MOST_TICKS: usize = 4;
const MOST_TIMES: usize = 6;
/// Width of the line of a moment (px in the reference picture), its opacity, and the opacity of the area below a count.
const MOMENT: f64 = 1.3;
const MOMENT_ALPHA: f64 = 0.75;
const AREA: f64 = 0.16;
/// Curves that leave the chart end at this distance outside (px in the reference picture).
const OUTSIDE: f64 = 5.0;

/// The place and the scale of a chart (px).
#[derive(Clone, Copy, Debug)]
pub(super) struct Chart {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
    /// Pixels for one pixel of type in the reference picture.
    pub(super) unit: f64,
    /// Thickness of lines, relative to the reference picture.
    pub(super) line: f64,
}

impl Chart {
    /// The place of a time (px).
    pub(super) fn x(self, times: &Axis, time: f64) -> f64 {
        self.left + times.share(time).clamp(0.0, 1.0) * (self.right - self.left)
    }

    /// The place of a value (px), which may be far outside.
    pub(super) fn y(self, values: &Axis, value: f64) -> f64 {
        self.bottom - values.share(value) * (self.bottom - self.top)
    }

    /// Thickness of hairlines, which depends on the type, in whole pixels.
    fn hairline(self) -> f64 {
        self.unit.round().max(1.0)
    }

    /// The colour of a hairline. A hairline thinner than a pixel is fainter instead.
    fn thinned(self, colour: Colour, ground: Colour) -> Colour {
        mixed(ground, colour, (1.25 * self.unit / self.hairline()).min(1.0))
    }

    pub(super) fn outside(self) -> f64 {
        OUTSIDE * self.unit
    }

    /// An axis of time between two moments (s) with as many ticks as fit.
    pub(super) fn times(self, fonts: &Fonts, [start, end]: [f64; 2]) -> Axis {
        let axis = |most: usize| Axis::new(Kind::Time, [start, end], "s", 1.0, most);
        let fits = |axis: &Axis| {
            let widest = axis.texts.iter().map(|text| wide(fonts, text, self.unit)).fold(0.0, f64::max);
            let shares = [0, 1].map(|at| axis.ticks.get(at).map_or(at as f64, |&tick| axis.share(tick)));
            widest + COLUMNS_APART * self.unit <= (self.right - self.left) * (shares[1] - shares[0])
        };
        (3..=MOST_TIMES).rev().map(axis).find(fits).unwrap_or_else(|| axis(2))
    }

    /// Grid lines at round values, a stronger one at zero, and optionally their numbers. A chart that is too low for
    /// two has only the upper one.
    pub(super) fn rows(self, writer: &mut Writer<'_>, values: &Axis, with_numbers: bool) {
        let palette = writer.palette;
        let thickness = self.hairline();
        for (at, (&tick, text)) in values.ticks.iter().zip(&values.texts).enumerate() {
            let y = self.y(values, tick);
            let colour = self.thinned(if tick == 0.0 { palette.axis } else { palette.hairline }, palette.background);
            let line = [self.left, (y - thickness / 2.0).round(), self.right - self.left, thickness];
            writer.marks.push(Item::rectangle(line, colour));
            let above = values.ticks.get(at + 1).map(|&next| self.y(values, next));
            if !with_numbers || above.is_some_and(|above| y - above < NUMBERS * self.unit) {
                continue;
            }
            let left = self.left - GAP * self.unit - wide(writer.fonts, text, self.unit);
            self.write(writer, text, palette.second_text, left, y + 5.0 * self.unit);
        }
    }

    /// Ticks at round times with their numbers, the last one with the unit, and a line along them if requested. Numbers
    /// end with the chart, and none begins left of `from` (px).
    pub(super) fn columns(self, writer: &mut Writer<'_>, times: &Axis, with_line: bool, from: f64) {
        let palette = writer.palette;
        let thickness = self.hairline();
        let [hairline, axis] = [palette.hairline, palette.axis].map(|colour| self.thinned(colour, palette.background));
        if with_line {
            let line = [self.left, (self.bottom - thickness / 2.0).round(), self.right - self.left, thickness];
            writer.marks.push(Item::rectangle(line, hairline));
        }
        let mut free = f64::INFINITY;
        // Numbers are written backwards from the last one, which has the unit. Numbers that would overlap are left out.
        for (at, (&tick, text)) in times.ticks.iter().zip(&times.texts).enumerate().rev() {
            let x = self.x(times, tick);
            let top = (self.bottom + thickness / 2.0).round();
            let length = (TICK * self.unit).round().max(2.0);
            writer.marks.push(Item::rectangle([(x - thickness / 2.0).round(), top, thickness, length], axis));
            let left = x - wide(writer.fonts, text, self.unit) / 2.0;
            let is_last = at + 1 == times.ticks.len();
            let text = if is_last { format!("{text} {}", times.unit) } else { text.clone() };
            let width = wide(writer.fonts, &text, self.unit);
            let left = left.min(self.right - width).max(from);
            if left + width + GAP * self.unit <= free {
                self.write(writer, &text, palette.second_text, left, self.bottom + (BELOW - 3.0) * self.unit);
                free = left;
            }
        }
    }

    /// The area below the steps of a count.
    pub(super) fn area(self, writer: &mut Writer<'_>, [times, values]: [&Axis; 2], points: &[[f64; 2]]) {
        let colour = mixed(writer.palette.background, writer.palette.alarm, AREA);
        let until = points.last().map(|&[time, _]| time);
        let ends = points.iter().skip(1).map(|&[time, _]| time).chain(until);
        let mut pieces: Vec<[f64; 3]> = Vec::new();
        for (&[from, value], to) in points.iter().zip(ends) {
            match pieces.last_mut() {
                Some(last) if last[2] == value => last[1] = to,
                _ => pieces.push([from, to, value]),
            }
        }
        for [from, to, value] in pieces.into_iter().filter(|&[_, _, value]| value > 0.0) {
            let [left, right] = [from, to].map(|time| self.x(times, time).round());
            let [top, bottom] = [value, 0.0].map(|value| self.y(values, value).clamp(self.top, self.bottom).round());
            if right > left && bottom > top {
                writer.marks.push(Item::rectangle([left, top, right - left, bottom - top], colour));
            }
        }
    }

    /// The line of a moment.
    pub(super) fn moment(self, x: f64, colour: Colour) -> Item {
        let ends = [[x, self.top - self.outside()], [x, self.bottom + TICK * self.unit]];
        Item::curve(&ends, MOMENT * self.line, &[], (colour, MOMENT_ALPHA))
    }

    fn write(self, writer: &mut Writer<'_>, text: &str, colour: Colour, left: f64, baseline: f64) {
        writer.words.push(writer.fonts.lay_out(text, Weight::Regular, NUMBERS * self.unit, colour, left, baseline));
    }
}

/// Width of a number (px).
pub(super) fn wide(fonts: &Fonts, text: &str, unit: f64) -> f64 {
    fonts.width(text, Weight::Regular, NUMBERS * unit)
}
