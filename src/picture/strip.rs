//! The strip below a panel: a diagnostic of its run over the whole scene, the other runs faintly behind it, and the
//! present moment. All strips of a picture have the same scales, and nothing in them moves but that moment.

use super::axis::{Axis, Kind};
use super::caption::{DASHES, Writer};
use super::layout::{LEAST_STRIP_UNIT, Rectangle, Scale};
use super::narrow::narrow;
use super::palette::Colour;
use super::text::{Fonts, Weight};
use super::{Curve, Mark, MarkShape};
use crate::colour::mixed;
use crate::history::{Course, History};
use crate::scene::Scene;
use crate::sim::body::Dimension;
use crate::sim::snapshot::{Diagnostic, RunFrame, Status};

/// Sizes of type (px in the reference picture).
const NAME: f64 = 16.0;
const NUMBERS: f64 = 14.0;
/// From the top of the strip to the baseline of its name and to its chart, and from the chart to the strip's bottom (px
/// in the reference picture).
const NAME_BASELINE: f64 = 13.0;
const ABOVE: f64 = 26.0;
const BELOW: f64 = 20.0;
/// The smallest chart (px).
const LEAST_WIDTH: f64 = 40.0;
const LEAST_HEIGHT: f64 = 14.0;
/// Between the numbers at the left and the chart, the length of a tick of time, and the least distances between numbers
/// above and beside each other (px in the reference picture).
const GAP: f64 = 8.0;
const TICK: f64 = 4.0;
const ROWS_APART: f64 = 21.0;
const COLUMNS_APART: f64 = 30.0;
/// Where there are more other runs than this, they would only be a thicket, and take their time.
const MOST_OTHERS: usize = 8;
/// Ticks of values and of time, at most.
const MOST_TICKS: usize = 4;
const MOST_TIMES: usize = 6;
/// Widths of the panel's own curve and of the others, of the line of the present moment and of a cross;
/// radius of the dot, its halo, and the arms of a cross (px in the reference picture).
const OWN: f64 = 2.2;
const OTHER: f64 = 1.4;
const MOMENT: f64 = 1.3;
const CROSS: f64 = 1.8;
const DOT: f64 = 4.5;
const HALO: f64 = 2.2;
const ARM: f64 = 4.0;
/// Opacity of other runs' curves, of the line of the present moment and of the area below a count.
const FAINT: f64 = 0.4;
const MOMENT_ALPHA: f64 = 0.75;
const AREA: f64 = 0.16;
/// What leaves the chart is seen so far outside of it (px in the reference picture).
const OUTSIDE: f64 = 5.0;
/// Curves are simplified as long as no point moves by more than this (px).
const EXACT: f64 = 0.08;

/// What a run that blew up shows beyond this many times the largest value of the others sets no scale and leaves the chart.
const BEYOND: f64 = 3.0;
/// The range holds zero unless zero is farther away than this many times its width.
const NEAR_ZERO: f64 = 1.5;
/// A range is at least this part of its values, so that no rounding error fills a strip.
const LEAST_RANGE: f64 = 0.02;

/// What the strips of a scene show.
#[derive(Debug)]
pub(super) struct Strips {
    diagnostic: Diagnostic,
    /// What a reader calls it.
    name: &'static str,
    /// The last time shown (s).
    end: f64,
    lines: Vec<Line>,
    /// The values that all strips show; `None` if there are none.
    range: Option<[f64; 2]>,
}

/// The diagnostic of one run.
#[derive(Debug)]
struct Line {
    run: usize,
    /// Whether its model has springs.
    has_springs: bool,
    /// Times (s) and values, as far as they are numbers.
    points: Vec<[f64; 2]>,
    /// When it blew up (s).
    diverged: Option<f64>,
}

/// Where the chart is (px).
#[derive(Clone, Copy, Debug)]
struct Chart {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
    /// Pixels for one pixel of type in the reference picture.
    unit: f64,
    /// Thickness of lines, in parts of that in the reference picture.
    line: f64,
    /// That of hairlines, which go with the type.
    thin: f64,
}

impl Strips {
    /// Prepares to show a diagnostic of all runs of a history.
    pub(super) fn new(diagnostic: Diagnostic, history: &History, scene: &Scene) -> Self {
        let line = |course: &Course| {
            let values = course.diagnostics.iter().map(|all| diagnostic.of(all));
            let points = course.times.iter().zip(values).map(|(&time, value)| [time, value]);
            Line {
                run: course.run,
                has_springs: scene.runs.get(course.run).is_some_and(|run| !run.model.springs().is_empty()),
                points: points.filter(|[_, value]| value.is_finite()).collect(),
                diverged: course.divergence.map(|divergence| divergence.time),
            }
        };
        let lines: Vec<_> = history.courses.iter().map(line).collect();
        // Counts blow up to the number of elements at the most, and all of them are shown.
        let range = range(&lines, diagnostic != Diagnostic::TurnedOver);
        let name = match (diagnostic, scene.body.dimension) {
            (Diagnostic::VolumeRatio, Dimension::Plane) => "area ratio",
            _ => diagnostic.name(),
        };
        Self { diagnostic, name, end: history.end, range, lines }
    }

    /// Draws the strip of a run into a rectangle; nothing if that is too small to be read.
    pub(super) fn draw(&self, writer: &mut Writer<'_>, rectangle: Rectangle, shown: &RunFrame) {
        let unit = writer.scale.of_type(writer.scale.unit.max(LEAST_STRIP_UNIT));
        let [left, top, width, height] = rectangle.map(f64::from);
        let [top, bottom] = [top + (ABOVE * unit).round(), top + height - (BELOW * unit).round()];
        let chart = Chart {
            left,
            right: left + width,
            top,
            bottom,
            unit,
            line: writer.scale.line_factor * writer.scale.unit.max(LEAST_STRIP_UNIT),
            thin: writer.scale.line_factor * unit,
        };
        let enough = width >= LEAST_WIDTH && bottom - top >= LEAST_HEIGHT && Scale::legible(NUMBERS * unit);
        if !enough || self.end <= 0.0 {
            return;
        }
        let kind = if self.is_count() { Kind::Count } else { Kind::Value };
        let rows = ((bottom - top) / (ROWS_APART * unit)) as usize + 1;
        let values = self.range.map(|range| Axis::new(kind, range, self.diagnostic.unit(), rows.min(MOST_TICKS)));
        let own = self.lines.iter().find(|line| line.run == shown.run && !line.points.is_empty());
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
        let chart = Chart { left: (left + indent).round(), ..chart };
        if chart.right - chart.left < LEAST_WIDTH {
            return;
        }
        self.write_name(writer, [left, top - (ABOVE - NAME_BASELINE) * unit, width], &note, unit);
        let times = chart.times(writer.fonts, self.end);
        if let Some(values) = &values {
            if let Some(own) = own.filter(|_| self.is_count()) {
                chart.area(writer, &times, values, own);
            }
            chart.rows(writer, values);
        }
        chart.columns(writer, &times, values.is_none());
        let palette = writer.palette;
        if let Some(values) = &values {
            let others = self.lines.iter().filter(|line| line.run != shown.run);
            for line in others.filter(|_| self.lines.len() <= MOST_OTHERS + 1) {
                let look = Look::new(OTHER, palette.arrows[usize::from(line.has_springs)], line.has_springs, FAINT);
                self.line(writer, chart, [&times, values], line, look);
            }
        }
        let now = chart.x(&times, shown.snapshot.time);
        writer.curves.push(chart.moment(now, palette.text));
        let Some((line, values)) = own.zip(values.as_ref()) else { return };
        let colour = palette.arrows[usize::from(line.has_springs)];
        self.line(writer, chart, [&times, values], line, Look::new(OWN, colour, line.has_springs, 1.0));
        let value = self.diagnostic.of(&shown.snapshot.diagnostics);
        let y = chart.y(values, value);
        if shown.snapshot.status == Status::Ok && (chart.top - 1.0..=chart.bottom + 1.0).contains(&y) {
            for (radius, colour) in [(DOT + HALO, palette.background), (DOT, colour)] {
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
            // What is shortened would lose its space, so it is all or nothing.
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

    /// The curve of one run, with a cross where it blew up.
    fn line(&self, writer: &mut Writer<'_>, chart: Chart, [times, values]: [&Axis; 2], line: &Line, look: Look) {
        let points = line.points.iter().map(|&[time, value]| [chart.x(times, time), chart.y(values, value)]);
        let mut points: Vec<_> = points.collect();
        if self.is_count() {
            points = steps(&points);
        }
        let borders = [chart.top - chart.outside(), chart.bottom + chart.outside()];
        let thickness = chart.thickness();
        let curve = |points: &[[f64; 2]], width: f64, dash: Option<[f32; 2]>| Curve {
            points: points.iter().map(|point| point.map(narrow)).collect(),
            width: narrow(width * thickness),
            dash,
            colour: look.colour,
            alpha: narrow(look.alpha),
        };
        let dash = look.dashed.then(|| DASHES.map(|length| narrow(length * thickness)));
        for part in within(&points, borders) {
            writer.curves.push(curve(&simplified(&part, EXACT), look.width, dash));
        }
        if let Some((time, &[_, last])) = line.diverged.zip(points.last()) {
            let [x, y] = [chart.x(times, time), last.clamp(chart.top, chart.bottom)];
            let arm = ARM * thickness;
            for slope in [-1.0, 1.0] {
                let ends = [[x - arm, y - slope * arm], [x + arm, y + slope * arm]];
                writer.curves.push(curve(&ends, CROSS.min(look.width), None));
            }
        }
    }
}

/// How a curve looks.
#[derive(Clone, Copy)]
struct Look {
    width: f64,
    colour: Colour,
    dashed: bool,
    alpha: f64,
}

impl Look {
    fn new(width: f64, colour: Colour, dashed: bool, alpha: f64) -> Self {
        Self { width, colour, dashed, alpha }
    }
}

impl Chart {
    /// Where a time stands (px).
    fn x(self, times: &Axis, time: f64) -> f64 {
        self.left + times.share(time).clamp(0.0, 1.0) * (self.right - self.left)
    }

    /// Where a value stands (px), which may be far outside.
    fn y(self, values: &Axis, value: f64) -> f64 {
        self.bottom - values.share(value) * (self.bottom - self.top)
    }

    /// How thick lines are, in parts of those in the reference picture.
    fn thickness(self) -> f64 {
        self.line
    }

    /// Thickness of hairlines, in whole pixels.
    fn hairline(self) -> f64 {
        self.thin.round().max(1.0)
    }

    /// The colour of a hairline: one that would be thinner than a pixel is fainter instead.
    fn thinned(self, colour: Colour, ground: Colour) -> Colour {
        mixed(ground, colour, (1.25 * self.thin / self.hairline()).min(1.0))
    }

    fn outside(self) -> f64 {
        OUTSIDE * self.unit
    }

    /// The axis of time with as many ticks as there is room for.
    fn times(self, fonts: &Fonts, end: f64) -> Axis {
        let axis = |most: usize| Axis::new(Kind::Time, [0.0, end], "s", most);
        let fits = |axis: &Axis| {
            let widest = axis.texts.iter().map(|text| wide(fonts, text, self.unit)).fold(0.0, f64::max);
            let apart = (self.right - self.left) * axis.share(axis.ticks.get(1).copied().unwrap_or(end));
            widest + COLUMNS_APART * self.unit <= apart
        };
        (3..=MOST_TIMES).rev().map(axis).find(fits).unwrap_or_else(|| axis(2))
    }

    /// Hairlines at round values with their numbers, a stronger one at zero.
    fn rows(self, writer: &mut Writer<'_>, values: &Axis) {
        let palette = writer.palette;
        let thickness = self.hairline();
        for (&tick, text) in values.ticks.iter().zip(&values.texts) {
            let y = self.y(values, tick);
            let colour = self.thinned(if tick == 0.0 { palette.axis } else { palette.hairline }, palette.background);
            let line = [self.left, (y - thickness / 2.0).round(), self.right - self.left, thickness];
            writer.marks.push(filled(line, colour));
            let left = self.left - GAP * self.unit - wide(writer.fonts, text, self.unit);
            self.write(writer, text, palette.second_text, left, y + 5.0 * self.unit);
        }
    }

    /// Ticks at round times with their numbers, the last one with the unit; a line along them if there is no other.
    fn columns(self, writer: &mut Writer<'_>, times: &Axis, with_line: bool) {
        let palette = writer.palette;
        let thickness = self.hairline();
        let [hairline, axis] = [palette.hairline, palette.axis].map(|colour| self.thinned(colour, palette.background));
        if with_line {
            let line = [self.left, (self.bottom - thickness / 2.0).round(), self.right - self.left, thickness];
            writer.marks.push(filled(line, hairline));
        }
        let mut free = f64::INFINITY;
        // The last one, which has the unit, comes first: a number for which it leaves no room is not written.
        for (at, (&tick, text)) in times.ticks.iter().zip(&times.texts).enumerate().rev() {
            let x = self.x(times, tick);
            let top = (self.bottom + thickness / 2.0).round();
            let length = (TICK * self.unit).round().max(2.0);
            writer.marks.push(filled([(x - thickness / 2.0).round(), top, thickness, length], axis));
            let left = x - wide(writer.fonts, text, self.unit) / 2.0;
            let is_last = at + 1 == times.ticks.len();
            let text = if is_last { format!("{text} {}", times.unit) } else { text.clone() };
            let width = wide(writer.fonts, &text, self.unit);
            let left = left.min(self.right - width);
            if left + width + GAP * self.unit <= free {
                self.write(writer, &text, palette.second_text, left, self.bottom + (BELOW - 3.0) * self.unit);
                free = left;
            }
        }
    }

    /// What a count has covered, below its steps.
    fn area(self, writer: &mut Writer<'_>, times: &Axis, values: &Axis, line: &Line) {
        let colour = mixed(writer.palette.background, writer.palette.alarm, AREA);
        let until = line.points.last().map(|&[time, _]| time);
        let ends = line.points.iter().skip(1).map(|&[time, _]| time).chain(until);
        let mut pieces: Vec<[f64; 3]> = Vec::new();
        for (&[from, value], to) in line.points.iter().zip(ends) {
            match pieces.last_mut() {
                Some(last) if last[2] == value => last[1] = to,
                _ => pieces.push([from, to, value]),
            }
        }
        for [from, to, value] in pieces.into_iter().filter(|&[_, _, value]| value > 0.0) {
            let [left, right] = [from, to].map(|time| self.x(times, time).round());
            let [top, bottom] = [value, 0.0].map(|value| self.y(values, value).clamp(self.top, self.bottom).round());
            if right > left && bottom > top {
                writer.marks.push(filled([left, top, right - left, bottom - top], colour));
            }
        }
    }

    /// The line of the present moment.
    fn moment(self, x: f64, colour: Colour) -> Curve {
        let ends = [[x, self.top - self.outside()], [x, self.bottom + TICK * self.unit]];
        Curve {
            points: ends.iter().map(|end| end.map(narrow)).collect(),
            width: narrow(MOMENT * self.thickness()),
            dash: None,
            colour,
            alpha: narrow(MOMENT_ALPHA),
        }
    }

    fn write(self, writer: &mut Writer<'_>, text: &str, colour: Colour, left: f64, baseline: f64) {
        writer.words.push(writer.fonts.lay_out(text, Weight::Regular, NUMBERS * self.unit, colour, left, baseline));
    }
}

/// Width of a number (px).
fn wide(fonts: &Fonts, text: &str, unit: f64) -> f64 {
    fonts.width(text, Weight::Regular, NUMBERS * unit)
}

fn filled(rectangle: [f64; 4], colour: Colour) -> Mark {
    Mark { rectangle: rectangle.map(narrow), along: Mark::UPRIGHT, colour, second: colour, shape: MarkShape::Filled }
}

fn dot(at: [f64; 2], radius: f64, colour: Colour) -> Curve {
    Curve { points: vec![at.map(narrow)], width: narrow(2.0 * radius), dash: None, colour, alpha: 1.0 }
}

/// The largest size of values.
fn peak(points: &[[f64; 2]]) -> f64 {
    points.iter().fold(0.0, |most, [_, value]| value.abs().max(most))
}

/// The values that strips show: all of runs that go on, and of those that blew up what is not far beyond those.
fn range(lines: &[Line], may_blow_up: bool) -> Option<[f64; 2]> {
    let with_values = || lines.iter().filter(|line| !line.points.is_empty());
    let is_wild = |line: &Line| may_blow_up && line.diverged.is_some();
    let calm = with_values().filter(|line| !is_wild(line)).map(|line| peak(&line.points)).reduce(f64::max);
    let limit = match calm {
        Some(calm) if calm > 0.0 => BEYOND * calm,
        // With nothing to compare with, half of what there is counts as ordinary.
        _ => {
            let mut sizes: Vec<_> = with_values().flat_map(|line| &line.points).map(|[_, value]| value.abs()).collect();
            sizes.sort_by(f64::total_cmp);
            BEYOND * sizes.get(sizes.len() / 2).copied()?
        }
    };
    let shown = |line: &Line, value: f64| value.abs() <= limit || !is_wild(line);
    let values = with_values().flat_map(|line| {
        let shown = line.points.iter().filter(|[_, value]| shown(line, *value));
        shown.map(|&[_, value]| value).collect::<Vec<_>>()
    });
    let ends = values.fold(None, |ends: Option<[f64; 2]>, value| {
        Some(ends.map_or([value; 2], |[low, high]| [low.min(value), high.max(value)]))
    });
    ends.map(widened)
}

/// A range with zero, unless that is far away, and not too narrow.
fn widened([low, high]: [f64; 2]) -> [f64; 2] {
    let nearest = if low > 0.0 { low } else { (-high).max(0.0) };
    if nearest <= NEAR_ZERO * (high - low) {
        return [low.min(0.0), high.max(0.0)];
    }
    let largest = low.abs().max(high.abs());
    let missing = (LEAST_RANGE * largest - (high - low)).max(0.0) / 2.0;
    [low - missing, high + missing]
}

/// A count's course: level until it changes, and then straight up or down.
fn steps(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut steps: Vec<[f64; 2]> = Vec::new();
    for &[x, y] in points {
        if let Some(&[_, before]) = steps.last().filter(|&&[_, before]| before != y) {
            steps.push([x, before]);
        }
        steps.push([x, y]);
    }
    steps
}

/// The parts of a curve between an upper and a lower border.
fn within(points: &[[f64; 2]], [top, bottom]: [f64; 2]) -> Vec<Vec<[f64; 2]>> {
    let mut parts: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut open = false;
    if let &[[x, y]] = points
        && (top..=bottom).contains(&y)
    {
        parts.push(vec![[x, y]]);
    }
    for two in points.windows(2) {
        let ([from, to], way) = ([two[0], two[1]], two[1][1] - two[0][1]);
        let at = |y: f64| [from[0] + (to[0] - from[0]) * ((y - from[1]) / way).clamp(0.0, 1.0), y];
        let clamped = [from[1], to[1]].map(|y| y.clamp(top, bottom));
        // Wholly on one side of both borders, or all of it inside.
        let outside = (from[1] < top && to[1] < top) || (from[1] > bottom && to[1] > bottom);
        if outside {
            open = false;
            continue;
        }
        let end = |y: f64, inside: f64, whole: [f64; 2]| if y == inside { whole } else { at(inside) };
        let ends = [end(from[1], clamped[0], from), end(to[1], clamped[1], to)];
        if !open {
            parts.push(vec![ends[0]]);
        }
        if let Some(part) = parts.last_mut() {
            part.push(ends[1]);
        }
        open = to[1] == clamped[1];
    }
    parts
}

/// A curve with fewer points, none of those left out farther from it than a distance (Douglas and Peucker).
fn simplified(points: &[[f64; 2]], distance: f64) -> Vec<[f64; 2]> {
    let mut kept = vec![false; points.len()];
    let Some(last) = points.len().checked_sub(1) else { return Vec::new() };
    (kept[0], kept[last]) = (true, true);
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        let [[ax, ay], [bx, by]] = [points[from], points[to]];
        let [wx, wy] = [bx - ax, by - ay];
        let squared = wx * wx + wy * wy;
        let off = |&[x, y]: &[f64; 2]| {
            let share = if squared > 0.0 { (((x - ax) * wx + (y - ay) * wy) / squared).clamp(0.0, 1.0) } else { 0.0 };
            let [dx, dy] = [x - ax - share * wx, y - ay - share * wy];
            dx * dx + dy * dy
        };
        let between = points[from..to].iter().enumerate().skip(1);
        let farthest =
            between.map(|(at, point)| (off(point), from + at)).max_by(|one, other| one.0.total_cmp(&other.0));
        if let Some((_, at)) = farthest.filter(|(off, _)| *off > distance * distance) {
            kept[at] = true;
            open.extend([(from, at), (at, to)]);
        }
    }
    points.iter().zip(kept).filter_map(|(&point, kept)| kept.then_some(point)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(values: &[f64], diverged: bool) -> Line {
        let points = values.iter().enumerate().map(|(at, &value)| [at as f64, value]).collect();
        Line { run: 0, has_springs: false, points, diverged: diverged.then_some(values.len() as f64) }
    }

    #[test]
    fn one_range_holds_all_runs_and_zero() {
        let range = |lines: &[&[f64]]| range(&lines.iter().map(|values| line(values, false)).collect::<Vec<_>>(), true);
        assert_eq!(range(&[&[1.0, 2.0, 3.0], &[-0.5, 0.2]]), Some([-0.5, 3.0]));
        assert_eq!(range(&[&[3.0, 2.0, 5.0]]), Some([0.0, 5.0]));
        // A short peak is no blow-up, and neither is one run that does much more than the other.
        assert_eq!(range(&[&[3000.0, 1.0, 0.1, 0.1, 0.1]]), Some([0.0, 3000.0]));
        assert_eq!(range(&[&[0.001; 8], &[0.1; 8]]), Some([0.0, 0.1]));
        // Zero is far from a volume that hardly changes, and what does not change has some room.
        assert_eq!(range(&[&[1.0, 1.05, 0.97]]), Some([0.97, 1.05]));
        let [low, high] = range(&[&[1.0, 1.0]]).unwrap();
        assert!(low < 1.0 && 1.0 < high && high - low < 0.03, "{low} {high}");
        assert_eq!((range(&[]), range(&[&[]])), (None, None));
        assert_eq!(range(&[&[0.0, 0.0]]), Some([0.0, 0.0]));
    }

    #[test]
    fn what_blows_up_flattens_nothing() {
        let calm = line(&[1.0, 2.0, 1.5, 1.0, 1.0, 1.0], false);
        let blown = line(&[1.0, 2.0, 5.0, 40.0, 1e9, 1e300], true);
        assert_eq!(range(&[calm, blown], true), Some([0.0, 5.0]));
        // What goes on is shown as it is, however late it begins.
        let late = line(&[0.0, 0.0, 0.0, 0.0, 9.0, 9.0], false);
        assert_eq!(range(&[line(&[0.0; 6], false), late], true), Some([0.0, 9.0]));
        // Counts are bounded by themselves.
        let counted = line(&[0.0, 0.0, 8.0], true);
        assert_eq!(range(&[line(&[1.0; 3], false), counted], false), Some([0.0, 8.0]));
        // Alone, half of its values count.
        let alone = line(&[1.0, 1.0, 1.0, 2.0, 1e3, 1e9], true);
        assert_eq!(range(&[alone], true), Some([0.0, 2.0]));
    }

    #[test]
    fn counts_go_in_steps() {
        let steps = steps(&[[0.0, 0.0], [1.0, 0.0], [2.0, 3.0], [3.0, 3.0]]);
        assert_eq!(steps, [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 3.0], [3.0, 3.0]]);
    }

    #[test]
    fn curves_leave_at_the_border_and_come_back() {
        let points = [[0.0, 5.0], [1.0, -5.0], [2.0, -50.0], [3.0, 5.0], [4.0, 25.0], [5.0, -15.0]];
        let parts = within(&points, [0.0, 10.0]);
        let expected: [&[[f64; 2]]; 3] = [
            &[[0.0, 5.0], [0.5, 0.0]],
            &[[2.0 + 50.0 / 55.0, 0.0], [3.0, 5.0], [3.25, 10.0]],
            &[[4.375, 10.0], [4.625, 0.0]],
        ];
        assert_eq!(parts, expected);
        assert_eq!(within(&points, [-100.0, 100.0]), [points]);
        assert!(within(&[], [0.0, 1.0]).is_empty());
        assert_eq!(within(&[[3.0, 0.5]], [0.0, 1.0]), [[[3.0, 0.5]]]);
        assert!(within(&[[0.0, 1e300], [1.0, 1e300]], [0.0, 1.0]).is_empty());
    }

    #[test]
    fn simpler_curves_stay_near() {
        let points: Vec<_> = (0..1000).map(|at| f64::from(at) * 0.4).map(|x| [x, 30.0 * libm::sin(x / 20.0)]).collect();
        let simple = simplified(&points, 0.1);
        assert!(simple.len() > 20 && simple.len() < 150, "{}", simple.len());
        assert_eq!((simple[0], simple[simple.len() - 1]), (points[0], points[999]));
        for [x, y] in points {
            let at = simple.iter().rposition(|point| point[0] <= x).unwrap().min(simple.len() - 2);
            let [from, to] = [simple[at], simple[at + 1]];
            let on = from[1] + (to[1] - from[1]) * (x - from[0]) / (to[0] - from[0]);
            assert!((on - y).abs() < 0.15, "{x}: {on} {y}");
        }
        assert_eq!(simplified(&[[1.0, 2.0]], 0.1), [[1.0, 2.0]]);
        assert!(simplified(&[], 0.1).is_empty());
    }
}
