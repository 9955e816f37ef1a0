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
const DOT: f64 = 3.6;
const STRONG_DOT: f64 = 5.0;
/// The gap from a dot to the name beside it (px).
const GAP: f64 = 8.0;
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
    chart: Chart,
    /// The lines of known slopes, and the curves.
    lines: Vec<Drawn>,
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
        Self { area, chart, lines }
    }

    fn draw(&self, diagram: &mut Diagram, plot: &Plot) {
        let [left, top, right, bottom] = self.area;
        write(diagram, &plot.name, NAME, 0.0, [left - NUMBERS, top - ABOVE + 20.0]);
        write(diagram, &plot.axes[1], SMALL, 0.0, [left - NUMBERS, top - 12.0]);
        write(diagram, &plot.axes[0], SMALL, 1.0, [right, bottom + 43.0]);
        diagram.chart(&self.chart, self.area);
        for (one, area) in self.lines.iter().zip(self.names(diagram)) {
            let Some([left, top, ..]) = area else { continue };
            let baseline = top + (0.5 * HIGH + MIDDLE) * SMALL.size;
            write(diagram, &one.name, label(one.colour), 0.0, [left, baseline]);
        }
    }

    /// The place of each line's name beside one of its points, where it covers least; `None` without points or name.
    fn names(&self, diagram: &Diagram) -> Vec<Option<Area>> {
        let lines = &self.lines;
        let places: Vec<Vec<(Area, f64)>> = lines.iter().map(|line| self.places(diagram, line)).collect();
        let mut chosen: Vec<Option<Area>> = vec![None; lines.len()];
        // Names of later curves are placed first. Then each is placed again, with the others in place.
        for at in (0..lines.len()).rev().cycle().take(3 * lines.len()) {
            let others: Vec<Area> = (0..lines.len()).filter(|&other| other != at).filter_map(|at| chosen[at]).collect();
            let cost = |&(area, cost): &(Area, f64)| {
                let on_names: f64 = others.iter().map(|&other| 60.0 * shared(area, other)).sum();
                let on_line = |(of, line): (usize, &Drawn)| match of == at {
                    true => 0.6 * covered(area, &line.points),
                    // Next to a dot of another curve, the name would seem to belong to it.
                    false => covered(area, &line.points) + near(area, &line.points),
                };
                cost + on_names + lines.iter().enumerate().map(on_line).sum::<f64>()
            };
            let best = places[at].iter().min_by(|one, other| cost(one).total_cmp(&cost(other)));
            chosen[at] = best.map(|(area, _)| *area);
        }
        chosen
    }

    /// The places of a name: beside, above and below each of its points, each with its own cost.
    fn places(&self, diagram: &Diagram, line: &Drawn) -> Vec<(Area, f64)> {
        let (wide, high) = (diagram.text_width(&line.name, label(line.colour)), HIGH * SMALL.size);
        let [low, top, far, bottom] = self.area;
        let anchors = if line.name.is_empty() { &[] } else { line.points.get(line.first..).unwrap_or_default() };
        let mut places = Vec::new();
        for (number, &[x, y]) in anchors.iter().enumerate() {
            let is_end = number == 0 || number + 1 == anchors.len();
            for further in [0.0, 1.0, 2.0] {
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
                    let area = [left, above, left + wide, above + high];
                    let is_inside = left >= low && area[2] <= far && above >= top && area[3] <= bottom;
                    let own = 2.0 * further + if is_end { 0.0 } else { 1.0 } + 0.1 * place as f64;
                    places.push((area, if is_inside { own } else { own + 100.0 }));
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

/// The number of dots beside an area.
fn near(area: Area, dots: &[[f64; 2]]) -> f64 {
    let is_near = |&&[x, y]: &&[f64; 2]| {
        let beside = (area[0] - x).max(x - area[2]).max(0.0);
        let above = (area[1] - y).max(y - area[3]).max(0.0);
        libm::hypot(beside, above) < 1.5 * GAP
    };
    dots.iter().filter(is_near).count() as f64
}

/// The cost of covering parts of a line through points: each dot counts, and each height of a letter along the line.
fn covered(area: Area, line: &[[f64; 2]]) -> f64 {
    let is_in = |[x, y]: [f64; 2], margin: f64| {
        x > area[0] - margin && x < area[2] + margin && y > area[1] - margin && y < area[3] + margin
    };
    let dots = line.iter().filter(|&&dot| is_in(dot, DOT)).count() as f64;
    let on_way = line.windows(2).map(|two| {
        let [dx, dy] = [two[1][0] - two[0][0], two[1][1] - two[0][1]];
        let pieces = libm::ceil(libm::hypot(dx, dy) / 4.0).max(1.0);
        let at = |piece: f64| [two[0][0] + dx * piece / pieces, two[0][1] + dy * piece / pieces];
        (0..=pieces as usize).filter(|&piece| is_in(at(piece as f64), 0.0)).count() as f64 * 4.0 / SMALL.size
    });
    3.0 * dots + on_way.sum::<f64>()
}

#[cfg(test)]
#[path = "../../tests/inside/page_plot.rs"]
mod tests;
