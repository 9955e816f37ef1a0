//! The layers of charts: areas, bands, lines, tiles and dots.

use super::axis::Stretch;
use super::{Chart, PlotArea};
use crate::colour::Colour;
use crate::picture::caption::Writer;
use crate::picture::layout::steps::{BESIDE, FREE, HAIR, MARGIN, STRONG};
use crate::picture::page::{self, Item, Path};
use crate::picture::plane::pieces;

/// The strengths of the colours of areas and of bands.
const AREA: f64 = 0.16;
const BAND: f64 = 0.3;
/// Curves are simplified as long as no point moves by more than this (px).
const EXACT: f64 = 0.08;

/// A layer of a chart, in the values of its axes.
#[derive(Clone, Debug, PartialEq)]
pub enum Layer {
    /// The area between zero and level steps.
    Area {
        /// The corners of the steps.
        points: Vec<[f64; 2]>,
        /// The colour, of which the area has a tint.
        colour: Colour,
    },
    /// The band from the least to the greatest value of several curves, up to the earliest end.
    Band {
        /// The points of each curve.
        curves: Vec<Vec<[f64; 2]>>,
        /// The colour, of which the band has a tint.
        colour: Colour,
    },
    /// A line through points. Where it goes up and down too densely to be seen, it is a band, unless it goes back, as a loop does.
    Line {
        /// The points.
        points: Vec<[f64; 2]>,
        /// Its colour.
        colour: Colour,
        /// Its width (px).
        width: f64,
        /// The lengths of dashes and gaps in turn (px); empty for a solid line.
        dash: Vec<f64>,
    },
    /// Rectangles side by side.
    Tiles {
        /// The middle of each.
        points: Vec<[f64; 2]>,
        /// How many of them fit beside and above each other into the chart.
        counts: [usize; 2],
        /// Their colour.
        colour: Colour,
        /// The colour of a rising diagonal on each, so that the tiles stand out in grey, too; `None` without.
        diagonal: Option<Colour>,
    },
    /// A dot at each point.
    Dots {
        /// The points.
        points: Vec<[f64; 2]>,
        /// Their colour.
        colour: Colour,
        /// Their radius (px).
        radius: f64,
    },
}

impl Layer {
    /// Draws the layer.
    pub(super) fn draw(&self, writer: &mut Writer<'_>, chart: &Chart, place: PlotArea) {
        for stretch in &chart.x.0 {
            let pixels = |points: &Vec<[f64; 2]>| pixels(points, chart, stretch, place);
            match self {
                Self::Area { points, colour } => {
                    let (mut points, zero) = (pixels(points), place.y(&chart.y, 0.0));
                    let ends = [points.last(), points.first()].map(|end| end.map(|&[x, _]| [x, zero]));
                    points.extend(ends.into_iter().flatten());
                    writer.marks.extend(inside(&points, place, (*colour, AREA)));
                }
                Self::Band { curves, colour } => {
                    let curves: Vec<_> = curves.iter().map(pixels).collect();
                    let [left, right] = place.ends(stretch);
                    let ends = curves.iter().map(|points| points.last().map_or(left, |end| end[0]));
                    band(writer, place, &curves, [left, ends.fold(right, f64::min)], 0.0, *colour);
                }
                Self::Line { points, colour, width, dash } if !goes_on(points) => {
                    // Once, over all stretches of the axis.
                    if *stretch == chart.x.0[0] {
                        let at = |&[x, y]: &[f64; 2]| [place.x(&chart.x, x), place.y(&chart.y, y)];
                        let points: Vec<_> = points.iter().map(at).collect();
                        let ways = if dash.is_empty() { vec![points] } else { ways(&points, BESIDE * place.line) };
                        for part in ways.iter().flat_map(|way| pieces(way, place.borders())) {
                            writer.curves.push(place.curve(&simplified(&part), *width, dash, *colour));
                        }
                    }
                }
                Self::Line { points, colour, width, dash } => {
                    let (dense, points) = (self.dense(chart, stretch, place), pixels(points));
                    let of_line = std::slice::from_ref(&points);
                    dense
                        .iter()
                        .for_each(|&span| band(writer, place, of_line, span, 0.5 * BESIDE * place.line, *colour));
                    for part in outside(&points, &dense).iter().flat_map(|part| pieces(part, place.borders())) {
                        writer.curves.push(place.curve(&simplified(&part), *width, dash, *colour));
                    }
                }
                &Self::Tiles { ref points, counts, colour, diagonal } => {
                    let half = [place.right - place.left, place.bottom - place.top];
                    let half: [_; 2] = std::array::from_fn(|axis| 0.5 * half[axis] / counts[axis].max(1) as f64);
                    for [x, y] in pixels(points) {
                        // Whole pixels make all gaps equal.
                        let [left, top] = [x - half[0], y - half[1]].map(f64::round);
                        let [right, bottom] = [x + half[0], y + half[1]].map(|end| end.round() - HAIR);
                        let tile = [left, top, right - left, bottom - top];
                        writer.curves.push(Item::rectangle(tile, colour));
                        let inset = 0.2 * tile[2].min(tile[3]);
                        let ends = [[left + inset, bottom - inset], [right - inset, top + inset]];
                        let line = diagonal.map(|colour| place.curve(&ends, STRONG, &[], colour));
                        writer.curves.extend(line);
                    }
                }
                Self::Dots { points, colour, radius } => {
                    writer.curves.extend(pixels(points).iter().map(|&at| Item::disc(at, radius * place.line, *colour)));
                }
            }
        }
    }

    /// Whether a part of a line is a band.
    pub(super) fn has_band(&self, chart: &Chart, place: PlotArea) -> bool {
        chart.x.0.iter().any(|stretch| !self.dense(chart, stretch, place).is_empty())
    }

    /// The dense parts of a line on a stretch of the axis to the right (px).
    fn dense(&self, chart: &Chart, stretch: &Stretch, place: PlotArea) -> Vec<[f64; 2]> {
        match self {
            Self::Line { points, .. } if goes_on(points) => dense(&pixels(points, chart, stretch, place), place.line),
            _ => Vec::new(),
        }
    }
}

/// Whether a line never goes back to the left.
fn goes_on(points: &[[f64; 2]]) -> bool {
    points.is_sorted_by(|one, other| one[0] <= other[0])
}

/// The ways of a line to the right and back, each from left to right: dashes of the way back lie on those of the way there. A way back that is
/// shorter than a length (px) is none.
fn ways(points: &[[f64; 2]], least: f64) -> Vec<Vec<[f64; 2]>> {
    let (mut ways, mut first, mut farthest, mut sense) = (Vec::new(), 0, 0, 1.0);
    for (at, [x, _]) in points.iter().enumerate() {
        let ahead = (x - points[farthest][0]) * sense;
        if ahead >= 0.0 {
            farthest = at;
        } else if -ahead > least {
            ways.push(points[first..=farthest].to_vec());
            (first, farthest, sense) = (farthest, at, -sense);
        }
    }
    ways.push(points[first..].to_vec());
    ways.retain(|way| way.len() > 1);
    ways.iter_mut().filter(|way| way[0][0] > way[way.len() - 1][0]).for_each(|way| way.reverse());
    ways
}

/// The part of a line on a stretch of the axis to the right (px), without values that have no place: infinite ones, and zero on a
/// logarithmic axis.
pub(super) fn pixels(points: &[[f64; 2]], chart: &Chart, stretch: &Stretch, place: PlotArea) -> Vec<[f64; 2]> {
    let [left, right] = place.ends(stretch);
    let at = |[x, y]: [f64; 2]| [left + stretch.share(x).clamp(0.0, 1.0) * (right - left), place.y(&chart.y, y)];
    cut(points, stretch.range).into_iter().map(at).filter(|place| place.iter().all(|at| at.is_finite())).collect()
}

/// The part of a line between two places, with its ends there.
fn cut(points: &[[f64; 2]], [start, end]: [f64; 2]) -> Vec<[f64; 2]> {
    let is_new = |at: &f64| points.iter().all(|&[x, _]| x != *at);
    let ends = [start, end].map(|at| Some(at).filter(is_new).and_then(|at| Some([at, value(points, at)?])));
    let inside = points.iter().copied().filter(|[x, _]| (start..=end).contains(x));
    ends[0].into_iter().chain(inside).chain(ends[1]).collect()
}

/// The height of a line at a place; `None` before its start and after its end.
pub(super) fn value(points: &[[f64; 2]], at: f64) -> Option<f64> {
    let after = points.partition_point(|&[x, _]| x <= at);
    let &[from, one] = points.get(after.checked_sub(1)?)?;
    let Some(&[to, other]) = points.get(after) else { return (from == at).then_some(one) };
    Some(one + (at - from) / (to - from) * (other - one))
}

/// Draws the band that lines cover between two places, in each column with all places up to `reach` beside it (px).
fn band(
    writer: &mut Writer<'_>,
    place: PlotArea,
    lines: &[Vec<[f64; 2]>],
    [from, to]: [f64; 2],
    reach: f64,
    colour: Colour,
) {
    let [high, mut low] = envelope(lines, [from, to], reach);
    low.reverse();
    writer.marks.extend(inside(&[high, low].concat(), place, (colour, BAND)));
}

/// The inside of a closed line, as far as it is inside of a chart.
fn inside(points: &[[f64; 2]], place: PlotArea, paint: (Colour, f64)) -> Option<Item> {
    let points = points.iter().map(|&[x, y]| page::point([x, y.clamp(place.top, place.bottom)].into()));
    let path = Path::polygon(&points.collect::<Vec<_>>());
    (!path.is_empty()).then(|| Item::fill(path, paint))
}

/// The highest and the lowest places that lines cover between two places, at each pixel with all places up to `reach`
/// beside it (px).
fn envelope(lines: &[Vec<[f64; 2]>], [from, to]: [f64; 2], reach: f64) -> [Vec<[f64; 2]>; 2] {
    let mut both = [Vec::new(), Vec::new()];
    let mut at = from;
    while at <= to {
        let ends = [at - reach, at + reach].map(|end| end.clamp(from, to));
        let heights = lines.iter().flat_map(|points| {
            let first = points.partition_point(|&[x, _]| x < ends[0]);
            let last = points.partition_point(|&[x, _]| x <= ends[1]);
            let inside = points[first..last].iter().map(|&[_, y]| y);
            inside.chain(ends.into_iter().filter_map(|x| value(points, x)))
        });
        let [high, low] = heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[high, low], y| [high.min(y), low.max(y)]);
        if high <= low {
            both[0].push([at, high]);
            both[1].push([at, low]);
        }
        at = if at < to { (at + 1.0).min(to) } else { f64::INFINITY };
    }
    both
}

/// The stretches, from left to right, in which a line of a thickness is dense (px): it goes up and down four times over
/// a short length.
fn dense(points: &[[f64; 2]], thickness: f64) -> Vec<[f64; 2]> {
    let [length, height, long] = [BESIDE, FREE, MARGIN].map(|length| length * thickness);
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
    spans.retain(|[from, to]| to - from >= long);
    spans
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

/// A curve with fewer points, with all others hardly away from it (Douglas and Peucker).
pub(in crate::picture) fn simplified(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    points.iter().zip(needed(points, EXACT)).filter_map(|(&point, kept)| kept.then_some(point)).collect()
}

/// Whether each point of a line is needed, so that the straight lines between the needed ones lie nowhere farther from it than a
/// distance.
pub(in crate::picture) fn needed(points: &[[f64; 2]], distance: f64) -> Vec<bool> {
    let mut kept = vec![false; points.len()];
    let Some(last) = points.len().checked_sub(1) else { return kept };
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
    kept
}

#[cfg(test)]
mod tests {
    use super::super::axis::{Axis, Kind};
    use super::*;

    #[test]
    fn parts_of_a_line_begin_and_end_on_it() {
        let whole = [[0.0, 1.0], [1.0, 3.0], [2.0, 2.0], [3.0, 2.0]];
        assert_eq!(cut(&whole, [0.5, 2.25]), [[0.5, 2.0], [1.0, 3.0], [2.0, 2.0], [2.25, 2.0]]);
        // An existing point is not repeated, and there is none beyond the end.
        assert_eq!(cut(&whole, [1.0, 2.0]), [[1.0, 3.0], [2.0, 2.0]]);
        assert_eq!(cut(&whole, [2.5, 9.0]), [[2.5, 2.0], [3.0, 2.0]]);
        assert!(cut(&whole, [5.0, 9.0]).is_empty());
    }

    #[test]
    fn values_without_a_place_are_left_out() {
        let x = Axis(vec![Stretch::new(Kind::Fixed, [0.0, 4.0], "s", 1.0, 5)]);
        let y = Axis::logarithmic([0.01, 1.0], 4);
        let chart = Chart { x, y, layers: Vec::new(), annotations: Vec::new() };
        let place = PlotArea { left: 0.0, right: 400.0, top: 0.0, bottom: 100.0, unit: 1.0, line: 1.0 };
        let points = [[0.0, 0.0], [1.0, 0.01], [2.0, f64::NAN], [3.0, f64::INFINITY], [4.0, 1.0]];
        let found = pixels(&points, &chart, &chart.x.0[0], place);
        assert!(found.len() == 2 && found[0][0] == 100.0 && found[1] == [400.0, 0.0], "{found:?}");
    }

    #[test]
    fn ways_back_begin_at_the_left_as_ways_there_do() {
        let line = |places: &[f64]| places.iter().map(|&x| [x, 0.0]).collect::<Vec<_>>();
        let there_and_back = line(&[0.0, 10.0, 20.0, 19.0, 30.0, 15.0, 0.0, 12.0]);
        let ways = ways(&there_and_back, 2.0);
        assert_eq!(ways, [line(&[0.0, 10.0, 20.0, 19.0, 30.0]), line(&[0.0, 15.0, 30.0]), line(&[0.0, 12.0])]);
        assert_eq!(super::ways(&line(&[9.0, 5.0, 1.0]), 2.0), [line(&[1.0, 5.0, 9.0])]);
    }

    #[test]
    fn dense_stretches_are_cut_out() {
        let calm = |from: i32| (from..from + 50).map(|x| [f64::from(x), 10.0]);
        let busy = (50..100).map(|x| [f64::from(x), if x % 2 == 0 { 10.0 } else { 30.0 }]);
        let points: Vec<_> = calm(0).chain(busy).chain(calm(100)).collect();
        let spans = dense(&points, 1.0);
        let [[from, to]] = spans[..] else { panic!("{spans:?}") };
        assert!((45.0..55.0).contains(&from) && (95.0..105.0).contains(&to), "{spans:?}");
        let parts = outside(&points, &spans);
        assert!(parts.len() == 2 && parts[0][0] == points[0] && parts[1].last() == points.last());
        let [high, low] = envelope(&[points], spans[0], 6.0);
        assert!(high.iter().all(|at| at[1] == 10.0) && low.iter().all(|at| at[1] == 30.0), "{high:?}");
        // Steep, but only upwards.
        let rise: Vec<_> = (0..50).map(|x| [f64::from(x), f64::from(x * x)]).collect();
        assert!(dense(&rise, 1.0).is_empty());
    }

    #[test]
    fn simpler_curves_stay_near() {
        let points: Vec<_> = (0..1000).map(|at| f64::from(at) * 0.4).map(|x| [x, 30.0 * libm::sin(x / 20.0)]).collect();
        let simple = simplified(&points);
        assert!(simple.len() > 20 && simple.len() < 150, "{}", simple.len());
        assert_eq!((simple[0], simple[simple.len() - 1]), (points[0], points[999]));
        for [x, y] in points {
            let at = simple.iter().rposition(|point| point[0] <= x).unwrap().min(simple.len() - 2);
            let [from, to] = [simple[at], simple[at + 1]];
            let on = from[1] + (to[1] - from[1]) * (x - from[0]) / (to[0] - from[0]);
            assert!((on - y).abs() < 0.15, "{x}: {on} {y}");
        }
        assert_eq!(simplified(&[[1.0, 2.0]]), [[1.0, 2.0]]);
        assert!(simplified(&[]).is_empty());
    }
}
