//! Curves on logarithmic axes, with their names at the right: errors against time, and against steps.
//!
//! ```text
//! name of a plot                    name of a plot
//! 1 ┼  name of the axis             1 ┼  name of the axis
//!   ┼  ●━━●╌╌╌╌╌ one                  ┼ ●╌╌╌╌╌╌╌╌ four
//!   ┼     ╲━━━●╌ two                  ┼    ●━━━●╌ five
//!   └──┼────┼───                      └──┼────┼───
//!      1   10  its name                  1   10  its name
//! ```

use super::{Area, Colour, MIDDLE, NAME, Room, SECOND_TEXT, SMALL, write};
use localshape::picture::{Annotation, Axis, Chart, Diagram, Layer, Name, TextStyle, colours, dashes};
use std::collections::HashMap;

/// One plot. Axes of one name have one range on a page.
pub(crate) struct Plot {
    /// The heading.
    pub(crate) name: String,
    /// The names of its axes, to the right and upwards, with units in parentheses.
    pub(crate) axes: [&'static str; 2],
    /// The curves, in the order in which they are drawn.
    pub(crate) curves: Vec<Line>,
    /// The point at which lines of known slopes meet, and their slopes; `None` without such lines.
    pub(crate) slopes: Option<([f64; 2], Vec<f64>)>,
}

/// A curve through points, each with a dot.
pub(crate) struct Line {
    /// Its name; empty for none.
    pub(crate) name: String,
    /// Its family, which has a colour: a model by its key, or any other name. Further curves of a family have dashes.
    pub(crate) family: String,
    /// Whether it is drawn stronger than the others.
    pub(crate) is_strong: bool,
    /// The points, to the right and upwards. Points that are not positive and finite are left out.
    pub(crate) points: Vec<[f64; 2]>,
}

/// The room at the left of a plot for numbers, above it, and at its right for names (px).
const NUMBERS: f64 = 58.0;
const ABOVE: f64 = 54.0;
const NAMES: f64 = 210.0;
pub(super) const ROOM: Room = Room { around: [NUMBERS, ABOVE, NAMES, 62.0], shape: 1.05, legend: 0.0 };
/// The extent of names above and below a plot (px).
const BEYOND: [f64; 2] = [0.0, 30.0];
/// Widths of curves, of strong ones and of slopes, and radii of dots (px).
const CURVE: f64 = 1.8;
const STRONG: f64 = 3.2;
const SLOPE: f64 = 1.2;
const DOT: f64 = 3.6;
const STRONG_DOT: f64 = 5.0;
/// The gap from the end of a slope to its name (px).
const GAP: f64 = 4.0;
/// The colour of lines of known slopes.
const SLOPES: Colour = [0x7a, 0x84, 0x91];
/// The room beyond the data at both ends of an axis, as a share of its length, and half of the least length (decades).
const ROOM_OF_DOTS: f64 = 0.04;
const LEAST_DECADES: f64 = 0.55;
/// The most numbers along the axes.
const MOST: [usize; 2] = [7, 7];
/// The reach of lines of known slopes, in decades to the right.
const REACH: f64 = 0.8;

/// The dots of curves without a name, such as the least and the greatest value of others.
const UNNAMED: usize = 7;

/// The colours of the families of curves in plots.
fn families(plots: &[Plot]) -> HashMap<&str, Colour> {
    let mut families: Vec<&str> = Vec::new();
    for curve in plots.iter().flat_map(|plot| &plot.curves) {
        if !families.contains(&curve.family.as_str()) {
            families.push(&curve.family);
        }
    }
    let colours = colours(&families);
    families.into_iter().zip(colours).collect()
}

/// Draws plots, each in its area. The two beside each other have one range upwards if they have one axis there.
pub(super) fn draw(plots: &[Plot], areas: &[Area], diagram: &mut Diagram) {
    let families = families(plots);
    for (row, areas) in plots.chunks(2).zip(areas.chunks(2)) {
        for (plot, &area) in row.iter().zip(areas) {
            let [across, up] = plot.axes;
            plot.draw(diagram, area, &families, [range(plots, 0, across), range(row, 1, up)]);
        }
    }
}

/// The logarithms at the ends of all axes of a name: the axes end with the data.
fn range(plots: &[Plot], axis: usize, name: &str) -> [f64; 2] {
    let alike = plots.iter().filter(|plot| plot.axes[axis] == name);
    let points = alike.flat_map(|plot| plot.curves.iter().flat_map(Line::shown)).map(|point| point.map(libm::log10));
    let none = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = points.fold(none, |(low, high), point| (low.min(point[axis]), high.max(point[axis])));
    if low > high {
        return [0.0, 1.0];
    }
    // Room for dots, and for a tick.
    let beyond = (ROOM_OF_DOTS * (high - low)).max(LEAST_DECADES - 0.5 * (high - low));
    [low - beyond, high + beyond]
}

impl Line {
    /// The points that are shown.
    fn shown(&self) -> impl Iterator<Item = [f64; 2]> {
        self.points.iter().copied().filter(|point| point.iter().all(|&number| number > 0.0 && number.is_finite()))
    }
}

impl Plot {
    /// The names and the ends of lines of known slopes, downwards from their common point and within axes with these
    /// logarithms at their ends; none if that point is outside.
    fn slopes(&self, [across, up]: [[f64; 2]; 2]) -> Vec<(String, [[f64; 2]; 2])> {
        let Some((meet, slopes)) = &self.slopes else { return Vec::new() };
        let [x, y] = meet.map(libm::log10);
        if !(across[0]..=across[1]).contains(&x) || !(up[0]..=up[1]).contains(&y) {
            return Vec::new();
        }
        let line = |&slope: &f64| {
            let aside = if slope > 0.0 { x - across[0] } else { across[1] - x };
            let reach = REACH.min((y - up[0]) / slope.abs()).min(aside) * -slope.signum();
            (format!("slope {slope}").replace('-', "−"), [*meet, [x + reach, y + slope * reach].map(libm::exp10)])
        };
        slopes.iter().map(line).collect()
    }

    /// The plot in an area, on axes with these logarithms at their ends.
    fn chart(&self, area: Area, families: &HashMap<&str, Colour>, ranges: [[f64; 2]; 2]) -> Chart {
        let [x, y] = [0, 1].map(|axis| Axis::logarithmic(ranges[axis].map(libm::exp10), MOST[axis]));
        let mut chart = Chart { x, y, ..Chart::default() };
        let (mut layers, mut names) = (Vec::new(), Vec::new());
        for (_, ends) in self.slopes(ranges) {
            layers.push(Layer::Line { points: ends.into(), colour: SLOPES, width: SLOPE, dash: Vec::new() });
        }
        for (at, curve) in self.curves.iter().enumerate() {
            let points: Vec<_> = curve.shown().collect();
            let colour = families[curve.family.as_str()];
            let is_variant = |other: &&Line| other.family == curve.family && !other.name.is_empty();
            let variant =
                if curve.name.is_empty() { UNNAMED } else { self.curves[..at].iter().filter(is_variant).count() };
            let (width, radius) = if curve.is_strong { (STRONG, STRONG_DOT) } else { (CURVE, DOT) };
            let end = self.named(&chart, area, curve).filter(|_| !curve.name.is_empty());
            let dash = dashes(variant).to_vec();
            names.extend(end.map(|end| Name { text: curve.name.clone(), end, colour, dash: dash.clone() }));
            layers.push(Layer::Line { points: points.clone(), colour, width, dash });
            layers.push(Layer::Dots { points, colour, radius });
        }
        (chart.layers, chart.annotations) = (layers, vec![Annotation::Names { names, beyond: BEYOND }]);
        chart
    }

    /// The point from which a line leads to the right to a curve's name: the last one of those from where it crosses fewest curves.
    fn named(&self, chart: &Chart, area: Area, curve: &Line) -> Option<[f64; 2]> {
        let pixels = |curve: &Line| curve.shown().map(|point| chart.at(area, point)).collect::<Vec<_>>();
        let all: Vec<_> = self.curves.iter().map(pixels).collect();
        let crossed = |&point: &[f64; 2]| {
            let [x, y] = chart.at(area, point);
            let crosses = |two: &[[f64; 2]]| {
                let [left, right] = [two[0], two[1]];
                let share = (y - left[1]) / (right[1] - left[1]);
                // Curves through the same point are beside each other there.
                (0.0..=1.0).contains(&share) && left[0] + share * (right[0] - left[0]) > x + DOT
            };
            all.iter().filter(|curve| curve.windows(2).any(crosses)).count()
        };
        curve.shown().collect::<Vec<_>>().into_iter().rev().min_by_key(crossed)
    }

    fn draw(&self, diagram: &mut Diagram, area: Area, families: &HashMap<&str, Colour>, ranges: [[f64; 2]; 2]) {
        let [left, top, right, bottom] = area;
        write(diagram, &self.name, NAME, 0.0, [left - NUMBERS, top - ABOVE + 20.0]);
        write(diagram, self.axes[1], SMALL, 0.0, [left - NUMBERS, top - 12.0]);
        write(diagram, self.axes[0], SMALL, 1.0, [right, bottom + 43.0]);
        let chart = self.chart(area, families, ranges);
        diagram.chart(&chart, area);
        let style = TextStyle { has_halo: true, colour: SECOND_TEXT, ..SMALL };
        for (name, ends) in self.slopes(ranges) {
            let [meet, [x, y]] = ends.map(|end| chart.at(area, end));
            let (share, gap) = if x < meet[0] { (1.0, -GAP) } else { (0.0, GAP) };
            write(diagram, &name, style, share, [x + gap, y + MIDDLE * SMALL.size]);
        }
    }
}

#[cfg(test)]
#[path = "../../tests/inside/page_plot.rs"]
mod tests;
