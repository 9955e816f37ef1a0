//! The time series of a diagnostic of one run, as a curve in a chart.

use super::Item;
use super::axis::Axis;
use super::caption::Writer;
use super::chart::Chart;
use crate::colour::mixed;
use crate::look::{LineStyle, Palette};
use crate::runner::history::TimeSeries;
use crate::scene::Scene;
use crate::sim::{Diagnostic, Dimension};

/// Widths of a curve and of a cross, and the arms of a cross (px in the reference picture).
pub(super) const OWN: f64 = 2.2;
const CROSS: f64 = 1.8;
const ARM: f64 = 4.0;
/// Lengths of dots and gaps of thin lines (px in the reference picture).
pub(super) const DOTS: [f64; 2] = [1.0, 3.5];
/// Half the width and the length of the arrowhead where the curve of a diverged run leaves its chart, and the width of
/// the dotted line from the arrowhead to the cross (px in the reference picture).
const HEAD: [f64; 2] = [4.0, 6.0];
const DOT: f64 = 1.0;
/// A curve is dense where it turns four times within this length, by more than the second one (px in the reference
/// picture). A count has a band there, with this strength of its colour.
const DENSE: f64 = 12.0;
const TURN: f64 = 3.0;
const BAND: f64 = 0.35;
/// Curves are simplified as long as no point moves by more than this (px).
pub(super) const EXACT: f64 = 0.08;

/// Values of a diverged run do not determine the scale above this many times the largest value of the other runs.
const BEYOND: f64 = 3.0;
/// The range includes zero unless zero is farther away than this many times its width.
const NEAR_ZERO: f64 = 1.5;
/// A range is at least this part of its values, so that round-off does not fill a strip.
const LEAST_RANGE: f64 = 0.02;

/// The time series of a diagnostic of one run.
#[derive(Clone, Debug)]
pub(super) struct Series {
    pub(super) run: usize,
    /// The name beside its curve.
    pub(super) name: String,
    /// Colour and dashes of its curve.
    pub(super) style: LineStyle,
    /// Whether it is a count, which is drawn in steps.
    pub(super) is_count: bool,
    /// Times (s) and finite values.
    pub(super) points: Vec<[f64; 2]>,
    /// For a mean of several scenes, the time series of each: a band shows their least and greatest values. Empty
    /// otherwise.
    pub(super) members: Vec<Vec<[f64; 2]>>,
    /// When the run diverged (s).
    pub(super) diverged: Option<f64>,
}

impl Series {
    /// A diagnostic of a run of a scene, in the colours of a picture.
    pub(super) fn new(diagnostic: Diagnostic, of_run: &TimeSeries, scene: &Scene, palette: &Palette) -> Self {
        let values = of_run.diagnostics.iter().map(|all| diagnostic.of(all));
        let points = of_run.times.iter().zip(values).map(|(&time, value)| [time, value]);
        let run = &scene.runs[of_run.run];
        Self {
            run: of_run.run,
            name: run.name.clone(),
            style: style(diagnostic, run.line(palette)),
            is_count: diagnostic == Diagnostic::TurnedOver,
            points: points.filter(|[_, value]| value.is_finite()).collect(),
            members: Vec::new(),
            diverged: of_run.divergence.map(|divergence| divergence.time),
        }
    }

    /// The part of it between two moments (s).
    pub(super) fn between(&self, [start, end]: [f64; 2]) -> Self {
        let between = |points: &Vec<[f64; 2]>| {
            let inside = points.iter().copied().filter(|[time, _]| (start..=end).contains(time));
            let is_new = |moment: &f64| points.iter().all(|&[time, _]| time != *moment);
            let ends = [start, end].map(|moment| Some(moment).filter(is_new));
            let ends = ends.map(|moment| Some([moment?, value(points, moment?, self.is_count)?]));
            ends[0].into_iter().chain(inside).chain(ends[1]).collect::<Vec<_>>()
        };
        let (points, members) = (between(&self.points), self.members.iter().map(between).collect());
        let diverged = self.diverged.filter(|time| (start..=end).contains(time));
        Self { points, members, diverged, name: self.name.clone(), ..*self }
    }

    /// The end of the curve in a chart (px); `None` if it has no values.
    pub(super) fn end(&self, chart: Chart, [times, values]: [&Axis; 2]) -> Option<[f64; 2]> {
        let &[time, value] = self.points.last()?;
        Some([chart.x(times, time), chart.y(values, value).clamp(chart.top, chart.bottom)])
    }

    /// The points of the curve in a chart (px).
    fn pixels(&self, chart: Chart, [times, values]: [&Axis; 2]) -> Vec<[f64; 2]> {
        let points = self.points.iter().map(|&[time, value]| [chart.x(times, time), chart.y(values, value)]);
        let points: Vec<_> = points.collect();
        if self.is_count { steps(&points) } else { points }
    }

    /// Whether a part of the curve in a chart is a band.
    pub(super) fn has_band(&self, chart: Chart, axes: [&Axis; 2]) -> bool {
        self.is_count && !dense(&self.pixels(chart, axes), [DENSE, TURN].map(|length| length * chart.line)).is_empty()
    }

    /// Draws the curve, with a cross at a divergence. Counts are solid steps; if they go up and down too densely for a
    /// line, a band covers the range between their least and greatest values. Dense parts of other curves have no
    /// dashes, which would look like a hatch.
    pub(super) fn draw(&self, writer: &mut Writer<'_>, chart: Chart, [times, values]: [&Axis; 2]) {
        self.draw_range(writer, chart, [times, values]);
        let points = self.pixels(chart, [times, values]);
        let borders = [chart.top - chart.outside(), chart.bottom + chart.outside()];
        let thickness = chart.line;
        let curve = |points: &[[f64; 2]], width: f64, dash: &[f64]| {
            Item::curve(points, width * thickness, dash, self.style.colour)
        };
        let dash: Vec<_> = self.style.dash.iter().map(|length| length * thickness).collect();
        let dense = dense(&points, [DENSE, TURN].map(|length| length * thickness));
        for &[from, to] in &dense {
            if !self.is_count {
                let inside: Vec<_> = points.iter().copied().filter(|&[x, _]| (from..=to).contains(&x)).collect();
                for part in within(&inside, borders) {
                    writer.curves.push(curve(&simplified(&part, EXACT), OWN, &[]));
                }
                continue;
            }
            let colour = mixed(writer.palette.background, self.style.colour, BAND);
            for [left, right, high, low] in band(&points, [from, to], DENSE * thickness) {
                let [high, low] = [high, low].map(|y| y.clamp(chart.top, chart.bottom));
                writer
                    .marks
                    .push(Item::rectangle([left, high.round(), right - left, (low - high).round().max(1.0)], colour));
            }
        }
        for part in outside(&points, &dense).iter().flat_map(|part| within(part, borders)) {
            writer.curves.push(curve(&simplified(&part, EXACT), OWN, &dash));
        }
        if let Some(time) = self.diverged {
            let to = chart.x(times, time) - ARM * thickness;
            if let Some(part) = leaving(&points, borders).filter(|[_, tip]| tip[0] + HEAD[0] * thickness < to) {
                // An arrowhead, and dots along the border to the cross, which has the name.
                let [from, tip] = part;
                let up = if tip[1] < from[1] { -1.0 } else { 1.0 };
                let [wing, back] = HEAD.map(|length| length * thickness);
                let corner = |side: f64| [tip[0] + side * wing, tip[1] - up * back];
                writer.curves.push(curve(&[corner(-1.0), tip, corner(1.0)], CROSS, &[]));
                let dots = DOTS.map(|length| length * thickness);
                let y = tip[1].clamp(chart.top, chart.bottom);
                writer.curves.push(curve(&[[tip[0] + wing, y], [to, y]], DOT, &dots));
            }
        }
        if let Some((time, &[_, last])) = self.diverged.zip(points.last()) {
            let [x, y] = [chart.x(times, time), last.clamp(chart.top, chart.bottom)];
            let arm = ARM * thickness;
            for slope in [-1.0, 1.0] {
                let ends = [[x - arm, y - slope * arm], [x + arm, y + slope * arm]];
                writer.curves.push(curve(&ends, CROSS, &[]));
            }
        }
    }
}

/// The last piece of a curve within the borders of its chart, if the curve leaves it there for good.
fn leaving(points: &[[f64; 2]], borders: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let inside = |y: f64| (borders[0]..=borders[1]).contains(&y);
    let at = points.iter().rposition(|&[_, y]| inside(y)).filter(|&at| at + 1 < points.len())?;
    let part = within(&points[at..at + 2], borders).pop()?;
    part.last_chunk().copied()
}

/// A value of a time series at a time (s); `None` before its start and after its end. Counts keep their value until the
/// next one.
pub(super) fn value(points: &[[f64; 2]], at: f64, is_count: bool) -> Option<f64> {
    let after = points.partition_point(|&[time, _]| time <= at);
    let &[from, one] = points.get(after.checked_sub(1)?)?;
    let Some(&[to, other]) = points.get(after) else { return (from == at).then_some(one) };
    let share = if is_count { 0.0 } else { (at - from) / (to - from) };
    Some(one + share * (other - one))
}

/// The line of a run in a chart of a diagnostic: counts are solid steps.
pub(super) fn style(diagnostic: Diagnostic, line: LineStyle) -> LineStyle {
    if diagnostic == Diagnostic::TurnedOver { LineStyle { dash: &[], ..line } } else { line }
}

/// The name of a diagnostic of a scene in a picture.
pub(super) fn name(diagnostic: Diagnostic, scene: &Scene) -> &'static str {
    match (diagnostic, scene.body.dimension) {
        (Diagnostic::VolumeRatio, Dimension::Plane) => "area ratio",
        _ => diagnostic.name(),
    }
}

/// The largest absolute value.
fn peak(one: &Series) -> f64 {
    one.all().fold(0.0, |most, [_, value]| value.abs().max(most))
}

/// The range of shown values: all values of runs that did not diverge, and the values of diverged runs that are not far
/// larger.
pub(super) fn range(series: &[Series], may_diverge: bool) -> Option<[f64; 2]> {
    let with_values = || series.iter().filter(|one| !one.points.is_empty());
    let is_wild = |one: &Series| may_diverge && one.diverged.is_some();
    let calm = with_values().filter(|one| !is_wild(one)).map(peak).reduce(f64::max);
    let limit = match calm {
        Some(calm) if calm > 0.0 => BEYOND * calm,
        // If all runs diverged, the median counts as ordinary.
        _ => {
            let mut sizes: Vec<_> = with_values().flat_map(Series::all).map(|[_, value]| value.abs()).collect();
            sizes.sort_by(f64::total_cmp);
            BEYOND * sizes.get(sizes.len() / 2).copied()?
        }
    };
    let shown = |one: &Series, value: f64| value.abs() <= limit || !is_wild(one);
    let values = with_values().flat_map(|one| {
        let shown = one.all().filter(|[_, value]| shown(one, *value));
        shown.map(|&[_, value]| value).collect::<Vec<_>>()
    });
    let ends = values.fold(None, |ends: Option<[f64; 2]>, value| {
        Some(ends.map_or([value; 2], |[low, high]| [low.min(value), high.max(value)]))
    });
    ends.map(widened)
}

/// A range that is not too narrow and includes zero unless that is far away.
fn widened([low, high]: [f64; 2]) -> [f64; 2] {
    let nearest = if low > 0.0 { low } else { (-high).max(0.0) };
    if nearest <= NEAR_ZERO * (high - low) {
        return [low.min(0.0), high.max(0.0)];
    }
    let largest = low.abs().max(high.abs());
    let missing = (LEAST_RANGE * largest - (high - low)).max(0.0) / 2.0;
    [low - missing, high + missing]
}

/// A count as steps: level until it changes, then straight up or down.
pub(super) fn steps(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut steps: Vec<[f64; 2]> = Vec::new();
    for &[x, y] in points {
        if let Some(&[_, before]) = steps.last().filter(|&&[_, before]| before != y) {
            steps.push([x, before]);
        }
        steps.push([x, y]);
    }
    steps
}

/// The stretches, from left to right, in which a curve turns up and down four times within a length, by more than a
/// height (px).
fn dense(points: &[[f64; 2]], [length, height]: [f64; 2]) -> Vec<[f64; 2]> {
    let Some(&[first, start]) = points.first() else { return Vec::new() };
    // The turns: the last extreme value is one as soon as the curve has left it by that height.
    let mut turns = Vec::new();
    let (mut extreme, mut sense) = ([first, start], 0.0);
    for &[x, y] in points {
        let way = y - extreme[1];
        if way * sense > 0.0 || sense == 0.0 && way.abs() > height {
            (extreme, sense) = ([x, y], way.signum());
        } else if way.abs() > height {
            turns.push(extreme[0]);
            (extreme, sense) = ([x, y], -sense);
        }
    }
    let mut spans: Vec<[f64; 2]> = Vec::new();
    for four in turns.windows(4).filter(|four| four[3] - four[0] <= length) {
        // A short stretch between two dense ones is dense, too.
        match spans.last_mut().filter(|last| four[0] <= last[1] + 3.0 * length) {
            Some(last) => last[1] = four[3],
            None => spans.push([four[0], four[3]]),
        }
    }
    spans
}

/// The area around a curve in a stretch, up to `reach` on both sides of each place (px): left and right side, upper and
/// lower end of each part.
fn band(points: &[[f64; 2]], [from, to]: [f64; 2], reach: f64) -> Vec<[f64; 4]> {
    let inside = &points[points.partition_point(|&[x, _]| x < from)..points.partition_point(|&[x, _]| x <= to)];
    let mut parts: Vec<[f64; 4]> = Vec::new();
    let mut left = from.floor();
    while left < to {
        let first = inside.partition_point(|&[x, _]| x < left - 0.5 * reach);
        let last = inside.partition_point(|&[x, _]| x <= left + 1.0 + 0.5 * reach);
        let ends = inside[first..last].iter().fold(None, |ends: Option<[f64; 2]>, &[_, y]| {
            Some(ends.map_or([y; 2], |[high, low]| [high.min(y), low.max(y)]))
        });
        if let Some([high, low]) = ends {
            match parts.last_mut().filter(|last| last[1] == left && [last[2], last[3]] == [high, low]) {
                Some(last) => last[1] = left + 1.0,
                None => parts.push([left, left + 1.0, high, low]),
            }
        }
        left += 1.0;
    }
    parts
}

/// The parts of a curve outside of stretches (px).
fn outside(points: &[[f64; 2]], spans: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    let ends = std::iter::once(f64::NEG_INFINITY).chain(spans.iter().map(|span| span[1]));
    let starts = spans.iter().map(|span| span[0]).chain([f64::INFINITY]);
    let part = |(from, to): (f64, f64)| -> Vec<[f64; 2]> {
        points.iter().copied().filter(|&[x, _]| (from..=to).contains(&x)).collect()
    };
    ends.zip(starts).map(part).filter(|part| !part.is_empty()).collect()
}

/// The parts of a curve between an upper and a lower border.
pub(super) fn within(points: &[[f64; 2]], [top, bottom]: [f64; 2]) -> Vec<Vec<[f64; 2]>> {
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
        // Both ends are on one side of both borders, or both are inside.
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

/// A curve with fewer points; omitted points are at most a distance away from it (Douglas and Peucker).
pub(super) fn simplified(points: &[[f64; 2]], distance: f64) -> Vec<[f64; 2]> {
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
pub(super) mod tests {
    use super::*;

    /// Values at 0, 1, 2 … s.
    pub(in crate::picture) fn series(values: &[f64], diverged: bool) -> Series {
        let points = values.iter().enumerate().map(|(at, &value)| [at as f64, value]).collect();
        let style = LineStyle { colour: [0; 3], dash: &[] };
        let diverged = diverged.then_some(values.len() as f64);
        Series { run: 0, name: String::new(), style, is_count: false, points, members: Vec::new(), diverged }
    }

    #[test]
    fn one_range_holds_all_runs_and_zero() {
        let range = |all: &[&[f64]]| range(&all.iter().map(|values| series(values, false)).collect::<Vec<_>>(), true);
        assert_eq!(range(&[&[1.0, 2.0, 3.0], &[-0.5, 0.2]]), Some([-0.5, 3.0]));
        assert_eq!(range(&[&[3.0, 2.0, 5.0]]), Some([0.0, 5.0]));
        // A short peak is not a divergence, and neither is one run with much larger values than the other.
        assert_eq!(range(&[&[3000.0, 1.0, 0.1, 0.1, 0.1]]), Some([0.0, 3000.0]));
        assert_eq!(range(&[&[0.001; 8], &[0.1; 8]]), Some([0.0, 0.1]));
        // Zero is far from a volume that hardly changes, and a constant value has some room.
        assert_eq!(range(&[&[1.0, 1.05, 0.97]]), Some([0.97, 1.05]));
        let [low, high] = range(&[&[1.0, 1.0]]).unwrap();
        assert!(low < 1.0 && 1.0 < high && high - low < 0.03, "{low} {high}");
        assert_eq!((range(&[]), range(&[&[]])), (None, None));
        assert_eq!(range(&[&[0.0, 0.0]]), Some([0.0, 0.0]));
    }

    #[test]
    fn diverged_runs_do_not_set_the_scale() {
        let calm = series(&[1.0, 2.0, 1.5, 1.0, 1.0, 1.0], false);
        let blown = series(&[1.0, 2.0, 5.0, 40.0, 1e9, 1e300], true);
        assert_eq!(range(&[calm, blown], true), Some([0.0, 5.0]));
        // Lasting values are shown in full, however late they begin.
        let late = series(&[0.0, 0.0, 0.0, 0.0, 9.0, 9.0], false);
        assert_eq!(range(&[series(&[0.0; 6], false), late], true), Some([0.0, 9.0]));
        // Counts are bounded by themselves.
        let counted = series(&[0.0, 0.0, 8.0], true);
        assert_eq!(range(&[series(&[1.0; 3], false), counted], false), Some([0.0, 8.0]));
        // A single run shows half of its values.
        let alone = series(&[1.0, 1.0, 1.0, 2.0, 1e3, 1e9], true);
        assert_eq!(range(&[alone], true), Some([0.0, 2.0]));
    }

    #[test]
    fn counts_go_in_steps() {
        let steps = steps(&[[0.0, 0.0], [1.0, 0.0], [2.0, 3.0], [3.0, 3.0]]);
        assert_eq!(steps, [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 3.0], [3.0, 3.0]]);
    }

    #[test]
    fn parts_of_a_line_begin_and_end_on_it() {
        let whole = series(&[1.0, 3.0, 2.0, 2.0], true);
        let part = whole.between([0.5, 2.25]);
        assert_eq!(part.points, [[0.5, 2.0], [1.0, 3.0], [2.0, 2.0], [2.25, 2.0]]);
        assert_eq!((part.diverged, whole.between([2.0, 9.0]).diverged), (None, Some(4.0)));
        // An existing point is not repeated, and there is none beyond the end.
        assert_eq!(whole.between([1.0, 2.0]).points, [[1.0, 3.0], [2.0, 2.0]]);
        assert_eq!(whole.between([2.5, 9.0]).points, [[2.5, 2.0], [3.0, 2.0]]);
        assert!(whole.between([5.0, 9.0]).points.is_empty());
        // Counts keep their number until the next one.
        let count = Series { is_count: true, ..whole };
        assert_eq!(count.between([0.5, 1.5]).points, [[0.5, 1.0], [1.0, 3.0], [1.5, 3.0]]);
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
    fn dense_stretches_are_cut_out() {
        let calm = |from: i32| (from..from + 50).map(|x| [f64::from(x), 10.0]);
        let busy = (50..100).map(|x| [f64::from(x), if x % 2 == 0 { 10.0 } else { 30.0 }]);
        let points: Vec<_> = calm(0).chain(busy).chain(calm(100)).collect();
        let spans = dense(&points, [12.0, 2.0]);
        let [[from, to]] = spans[..] else { panic!("{spans:?}") };
        assert!((45.0..55.0).contains(&from) && (95.0..105.0).contains(&to), "{spans:?}");
        let parts = outside(&points, &spans);
        assert!(parts.len() == 2 && parts[0][0] == points[0] && parts[1].last() == points.last());
        let band = band(&points, spans[0], 12.0);
        assert!(band.iter().all(|&[left, right, high, low]| right > left && high == 10.0 && low == 30.0), "{band:?}");
        // Steep, but only upwards.
        let rise: Vec<_> = (0..50).map(|x| [f64::from(x), f64::from(x * x)]).collect();
        assert!(dense(&rise, [12.0, 2.0]).is_empty());
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
