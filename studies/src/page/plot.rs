//! Curves on logarithmic axes, with their names beside them: errors against time, and against steps.
//!
//! ```text
//! name of a plot             name of a plot
//! 1 ┼  name of the axis      1 ┼  name of the axis
//!   ┼  ●━━● one                ┼ ● four
//!   ┼     ╲━━● two             ┼    ●━━● five
//!   └──┼────┼─────             └──┼────┼─────
//!      1   10  its name          1   10  its name
//! ```

use super::{Area, Colour, MIDDLE, NAME, Room, SECOND_TEXT, SMALL, write};
use localshape::picture::{Axis, Chart, Diagram, Layer, TextStyle};

/// One plot. Axes of one name have one range on a page.
pub(crate) struct Plot {
    /// The heading.
    pub(crate) name: String,
    /// The names of its axes, to the right and upwards, with units in parentheses.
    pub(crate) axes: [String; 2],
    /// The curves, in the order in which they are drawn; the last ones are named first.
    pub(crate) curves: Vec<Line>,
    /// The point at which lines of known slopes meet, and their slopes; `None` without such lines.
    pub(crate) slopes: Option<([f64; 2], Vec<f64>)>,
}

/// A curve through points, each with a dot.
pub(crate) struct Line {
    /// Its name; empty for none.
    pub(crate) name: String,
    /// The number of its family's colour.
    pub(crate) family: usize,
    /// Whether it is drawn stronger than the others.
    pub(crate) is_strong: bool,
    /// The points, to the right and upwards. Points that are not positive and finite are left out.
    pub(crate) points: Vec<[f64; 2]>,
}

/// The room for numbers at the left of a plot, and for names above it (px).
const NUMBERS: f64 = 58.0;
const ABOVE: f64 = 54.0;
pub(super) const ROOM: Room = Room { around: [NUMBERS, ABOVE, 0.0, 62.0], shape: 0.78, legend: 0.0 };
/// The height of a line of words, in sizes of type.
const HIGH: f64 = 1.08;
/// Widths of curves, of strong ones and of slopes, and radii of dots (px).
const CURVE: f64 = 1.8;
const STRONG: f64 = 3.2;
const SLOPE: f64 = 1.2;
const LEADER: f64 = 1.0;
const DOT: f64 = 3.6;
const STRONG_DOT: f64 = 5.0;
/// The distance of points along curves, by which names keep away from them (px).
const APART: f64 = 4.0;
/// The gap from a dot to the name beside it (px), and the number of gaps, each greater by most of the height of a name.
const GAP: f64 = 8.0;
const FARTHEST: u32 = 7;
/// Colours of families of curves, and of lines of known slopes.
const FAMILIES: [Colour; 6] = [
    [0x00, 0x72, 0xb2],
    [0x1e, 0xa0, 0x87],
    [0x4d, 0x20, 0x01],
    [0x3c, 0x43, 0x4d],
    [0x40, 0x00, 0x54],
    [0x24, 0x9d, 0xb1],
];
const SLOPES: Colour = [0x7a, 0x84, 0x91];
/// The most numbers along the axes.
const MOST: [usize; 2] = [9, 7];
/// The reach of lines of known slopes, in decades to the right.
const REACH: f64 = 0.8;

/// Draws plots, each in its area.
pub(super) fn draw(plots: &[Plot], areas: &[Area], diagram: &mut Diagram) {
    for (plot, &area) in plots.iter().zip(areas) {
        Frame::new(plot, area, [0, 1].map(|axis| range(plots, axis, &plot.axes[axis]))).draw(diagram, plot);
    }
}

/// The logarithms at the ends of all axes of a name: in quarters of decades to the right, whole ones upwards.
fn range(plots: &[Plot], axis: usize, name: &str) -> [f64; 2] {
    let alike = plots.iter().filter(|plot| plot.axes[axis] == name);
    let points = alike.flat_map(|plot| plot.curves.iter().flat_map(Line::shown)).map(|point| point.map(libm::log10));
    let none = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = points.fold(none, |(low, high), point| (low.min(point[axis]), high.max(point[axis])));
    if low > high {
        return [0.0, 1.0];
    }
    // Room for dots and names.
    let (parts, below) = if axis == 0 { (4.0, 0.1) } else { (1.0, 1.0) };
    let rounded = [libm::floor((low - below) * parts) / parts, libm::ceil((high + 0.1) * parts) / parts];
    if rounded[0] < rounded[1] { rounded } else { [rounded[0], rounded[0] + 1.0] }
}

impl Line {
    /// The points that are shown.
    fn shown(&self) -> impl Iterator<Item = &[f64; 2]> {
        self.points.iter().filter(|point| point.iter().all(|&number| number > 0.0 && number.is_finite()))
    }
}

/// The names and the logarithms of the ends of lines of known slopes, downwards from their common point and within the
/// axes; none if that point is outside.
fn slopes(plot: &Plot, [across, up]: [[f64; 2]; 2]) -> Vec<(String, [[f64; 2]; 2])> {
    let Some((meet, slopes)) = &plot.slopes else { return Vec::new() };
    let [x, y] = meet.map(libm::log10);
    if !(across[0]..=across[1]).contains(&x) || !(up[0]..=up[1]).contains(&y) {
        return Vec::new();
    }
    let line = |&slope: &f64| {
        let aside = if slope > 0.0 { x - across[0] } else { across[1] - x };
        let reach = REACH.min((y - up[0]) / slope.abs()).min(aside) * -slope.signum();
        (format!("slope {slope}"), [[x, y], [x + reach, y + slope * reach]])
    };
    slopes.iter().map(line).collect()
}

/// A plot at its place.
struct Frame {
    area: Area,
    /// The logarithms at the ends of its axes.
    ranges: [[f64; 2]; 2],
    chart: Chart,
    /// The lines of known slopes, and the curves.
    lines: Vec<Drawn>,
}

/// A place of a name.
#[derive(Clone, Copy, Debug)]
struct Place {
    area: Area,
    /// The point that it names.
    dot: [f64; 2],
    /// Whether a thin line leads there.
    leads: bool,
    /// Its cost, whatever else is there.
    cost: f64,
}

impl Place {
    /// The ends of the line that leads from the point to the name.
    fn leader(&self) -> [[f64; 2]; 2] {
        let Self { area: [left, top, right, bottom], dot: [x, y], .. } = *self;
        [[x, y], [x.clamp(left, right), y.clamp(top, bottom)]]
    }
}

/// Joined points (px) with a name beside one of them.
struct Drawn {
    points: Vec<[f64; 2]>,
    /// The first point that the name may stand beside.
    first: usize,
    name: String,
    colour: Colour,
}

impl Frame {
    /// A plot whose axes have the given logarithms at their ends.
    fn new(plot: &Plot, area: Area, ranges: [[f64; 2]; 2]) -> Self {
        let [x, y] = [0, 1].map(|axis| Axis::logarithmic(ranges[axis].map(libm::exp10), MOST[axis]));
        let mut chart = Chart { x, y, layers: Vec::new(), annotations: Vec::new() };
        let mut lines = Vec::new();
        for (name, points) in slopes(plot, ranges) {
            let points: Vec<_> = points.iter().map(|point| point.map(libm::exp10)).collect();
            let pixels = points.iter().map(|&point| chart.at(area, point)).collect();
            lines.push(Drawn { points: pixels, first: 1, name, colour: SECOND_TEXT });
            chart.layers.push(Layer::Line { points, colour: SLOPES, width: SLOPE, dash: Vec::new() });
        }
        for one in &plot.curves {
            let points: Vec<_> = one.shown().copied().collect();
            let pixels = points.iter().map(|&point| chart.at(area, point)).collect();
            let colour = FAMILIES[one.family % FAMILIES.len()];
            let (width, radius) = if one.is_strong { (STRONG, STRONG_DOT) } else { (CURVE, DOT) };
            lines.push(Drawn { points: pixels, first: 0, name: one.name.clone(), colour });
            chart.layers.push(Layer::Line { points: points.clone(), colour, width, dash: Vec::new() });
            chart.layers.push(Layer::Dots { points, colour, radius });
        }
        Self { area, ranges, chart, lines }
    }

    fn draw(&self, diagram: &mut Diagram, plot: &Plot) {
        let [left, top, right, bottom] = self.area;
        write(diagram, &plot.name, NAME, 0.0, [left - NUMBERS, top - ABOVE + 20.0]);
        write(diagram, &plot.axes[1], SMALL, 0.0, [left - NUMBERS, top - 12.0]);
        write(diagram, &plot.axes[0], SMALL, 1.0, [right, bottom + 43.0]);
        let named: Vec<_> =
            self.lines.iter().zip(self.names(diagram)).filter_map(|(one, at)| Some((one, at?))).collect();
        let mut chart = self.chart.clone();
        for (one, place) in named.iter().filter(|(_, place)| place.leads) {
            let points = place.leader().map(|point| self.value(point)).into();
            chart.layers.insert(0, Layer::Line { points, colour: one.colour, width: LEADER, dash: Vec::new() });
        }
        diagram.chart(&chart, self.area);
        for (one, Place { area: [left, top, ..], .. }) in named {
            let baseline = top + (0.5 * HIGH + MIDDLE) * SMALL.size;
            write(diagram, &one.name, label(one.colour), 0.0, [left, baseline]);
        }
    }

    /// The pair of numbers at a point (px).
    fn value(&self, point: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| {
            let [start, end] = [[0, 3][axis], [2, 1][axis]].map(|side| self.area[side]);
            let [low, high] = self.ranges[axis];
            libm::exp10(low + (point[axis] - start) / (end - start) * (high - low))
        })
    }

    /// The place of each line's name near one of its points, where it covers least; `None` without points or name.
    fn names(&self, diagram: &Diagram) -> Vec<Option<Place>> {
        let lines = &self.lines;
        let places: Vec<Vec<Place>> = lines.iter().map(|line| self.places(diagram, line)).collect();
        let mut chosen: Vec<Option<Place>> = vec![None; lines.len()];
        // Names of later curves are placed first. Then each is placed again, with the others in place.
        for at in (0..lines.len()).rev().cycle().take(3 * lines.len()) {
            let others: Vec<Place> =
                (0..lines.len()).filter(|&other| other != at).filter_map(|at| chosen[at]).collect();
            let cost = |place: &Place| {
                let (area, leader) = (place.area, place.leader());
                let own = apart(area, &lines[at].points) + 0.5 * GAP;
                let on_name = |other: &Place| {
                    let leaders = covered(other.area, &leader) + covered(area, &other.leader());
                    60.0 * shared(area, other.area) + 5.0 * leaders + 5.0 * crossings(leader, &other.leader())
                };
                let on_line = |(of, line): (usize, &Drawn)| {
                    let covered = covered(area, &line.points);
                    match (of == at, place.leads) {
                        (true, _) => 0.6 * covered,
                        (false, true) => 3.0 * covered + crossings(leader, &line.points),
                        // Nearer to another curve, the name would seem to belong to it.
                        (false, false) => 3.0 * covered + if apart(area, &line.points) < own { 4.0 } else { 0.0 },
                    }
                };
                let on_lines: f64 = lines.iter().enumerate().map(on_line).sum();
                place.cost + others.iter().map(on_name).sum::<f64>() + on_lines
            };
            let best = places[at].iter().min_by(|one, other| cost(one).total_cmp(&cost(other)));
            chosen[at] = best.copied();
        }
        chosen
    }

    /// The places of a name: beside, above and below each of its points.
    fn places(&self, diagram: &Diagram, line: &Drawn) -> Vec<Place> {
        let (wide, high) = (diagram.text_width(&line.name, label(line.colour)), HIGH * SMALL.size);
        let [low, top, far, bottom] = self.area;
        let anchors = if line.name.is_empty() { &[] } else { line.points.get(line.first..).unwrap_or_default() };
        let mut places = Vec::new();
        for (number, &[x, y]) in anchors.iter().enumerate() {
            let is_end = number == 0 || number + 1 == anchors.len();
            for further in (0..FARTHEST).map(f64::from) {
                let gap = GAP + 0.9 * further * high;
                let corners = [
                    [x + gap, y - 0.5 * high],
                    [x - gap - wide, y - 0.5 * high],
                    [x - 0.5 * wide, y - gap - high],
                    [x - 0.5 * wide, y + gap],
                    [x + 0.6 * gap, y - 0.6 * gap - high],
                    [x + 0.6 * gap, y + 0.6 * gap],
                    [x - 0.6 * gap - wide, y - 0.6 * gap - high],
                    [x - 0.6 * gap - wide, y + 0.6 * gap],
                ];
                for (place, [left, above]) in corners.into_iter().enumerate() {
                    // Above and below, a name may be shifted.
                    let left = if place < 2 { left } else { left.min(far - wide).max(low) };
                    let area = [left, above, left + wide, above + high];
                    let is_inside = left >= low && area[2] <= far && above >= top && area[3] <= bottom;
                    let leads = further > 0.0;
                    let away = if leads { 1.0 + 0.5 * further } else { 0.0 };
                    let cost = away + if is_end { 0.0 } else { 1.0 } + 0.1 * place as f64;
                    places.push(Place { area, dot: [x, y], leads, cost: if is_inside { cost } else { cost + 100.0 } });
                }
            }
        }
        places
    }
}

fn label(colour: Colour) -> TextStyle {
    TextStyle { is_bold: true, colour, has_halo: true, ..SMALL }
}

/// The share of the smaller of two areas that both have in common.
fn shared(one: Area, other: Area) -> f64 {
    let side = |axis: usize| (one[axis + 2].min(other[axis + 2]) - one[axis].max(other[axis])).max(0.0);
    let size = |area: Area| (area[2] - area[0]) * (area[3] - area[1]);
    side(0) * side(1) / size(one).min(size(other))
}

/// The cost of crossing a line through points: each dot counts as four pieces.
fn crossings([start, end]: [[f64; 2]; 2], line: &[[f64; 2]]) -> f64 {
    let side = |from: [f64; 2], to: [f64; 2], at: [f64; 2]| {
        (to[0] - from[0]) * (at[1] - from[1]) - (to[1] - from[1]) * (at[0] - from[0])
    };
    let is_crossed = |two: &&[[f64; 2]]| {
        side(start, end, two[0]) * side(start, end, two[1]) < 0.0
            && side(two[0], two[1], start) * side(two[0], two[1], end) < 0.0
    };
    let dots = line.iter().filter(|[x, y]| apart([*x, *y, *x, *y], &[start, end]) < 2.0 * DOT).count();
    (4 * dots + line.windows(2).filter(is_crossed).count()) as f64
}

/// The distance of an area from a line through points (px).
fn apart(area: Area, line: &[[f64; 2]]) -> f64 {
    let away = |[x, y]: [f64; 2]| {
        libm::hypot((area[0] - x).max(x - area[2]).max(0.0), (area[1] - y).max(y - area[3]).max(0.0))
    };
    sampled(line).chain(line.iter().copied()).map(away).fold(f64::INFINITY, f64::min)
}

/// Points along a line through points, a few px apart.
fn sampled(line: &[[f64; 2]]) -> impl Iterator<Item = [f64; 2]> {
    line.windows(2).flat_map(|two| {
        let [dx, dy] = [two[1][0] - two[0][0], two[1][1] - two[0][1]];
        let pieces = libm::ceil(libm::hypot(dx, dy) / APART).max(1.0);
        (0..=pieces as usize).map(move |piece| [0, 1].map(|axis| two[0][axis] + [dx, dy][axis] * piece as f64 / pieces))
    })
}

/// The cost of covering parts of a line through points: each dot counts, and each height of a letter along the line.
fn covered(area: Area, line: &[[f64; 2]]) -> f64 {
    let is_in = |[x, y]: [f64; 2], margin: f64| {
        x > area[0] - margin && x < area[2] + margin && y > area[1] - margin && y < area[3] + margin
    };
    let dots = line.iter().filter(|&&dot| is_in(dot, DOT)).count() as f64;
    3.0 * dots + sampled(line).filter(|&at| is_in(at, 0.0)).count() as f64 * APART / SMALL.size
}

#[cfg(test)]
#[path = "../../tests/inside/page_plot.rs"]
mod tests;
