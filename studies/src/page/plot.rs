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

use super::{Area, Colour, HAIRLINE, MIDDLE, NAME, Room, SECOND_TEXT, SMALL, power_of_ten, write};
use localshape::picture::{Diagram, TextStyle};

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
/// Widths of curves, of strong ones, of slopes and of hairlines, and radii of dots (px).
const CURVE: f64 = 1.8;
const STRONG: f64 = 3.2;
const SLOPE: f64 = 1.2;
const THIN: f64 = 1.0;
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
/// The largest number of powers of ten along the upward axis.
const MOST_ROWS: i32 = 7;
/// The reach of lines of known slopes, in decades to the right.
const REACH: f64 = 0.8;

/// Draws plots, each in its area.
pub(super) fn draw(plots: &[Plot], areas: &[Area], diagram: &mut Diagram) {
    for (plot, &area) in plots.iter().zip(areas) {
        Frame { area, ranges: [0, 1].map(|axis| range(plots, axis, &plot.axes[axis])) }.draw(diagram, plot);
    }
}

/// The logarithms at the ends of all axes of a name: in quarters of decades to the right, whole ones upwards.
fn range(plots: &[Plot], axis: usize, name: &str) -> [f64; 2] {
    let alike = plots.iter().filter(|plot| plot.axes[axis] == name);
    let points = alike.flat_map(|plot| plot.curves.iter().flat_map(Line::shown));
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
    /// The logarithms of the points that are shown.
    fn shown(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let is_shown = |point: &&[f64; 2]| point.iter().all(|&number| number > 0.0 && number.is_finite());
        self.points.iter().filter(is_shown).map(|point| point.map(libm::log10))
    }
}

/// The place of a plot, and the logarithms at the ends of its axes.
struct Frame {
    area: Area,
    ranges: [[f64; 2]; 2],
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
    /// The pixel of a pair of logarithms.
    fn pixel(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [left, top, right, bottom] = self.area;
        let share = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
        [left + share(x, self.ranges[0]) * (right - left), bottom - share(y, self.ranges[1]) * (bottom - top)]
    }

    fn draw(&self, diagram: &mut Diagram, plot: &Plot) {
        let [left, top, ..] = self.area;
        write(diagram, &plot.name, NAME, 0.0, [left - NUMBERS, top - ABOVE + 20.0]);
        write(diagram, &plot.axes[1], SMALL, 0.0, [left - NUMBERS, top - 12.0]);
        self.grid(diagram, &plot.axes[0]);
        let (slopes, curves) = (self.slopes(plot), self.curves(plot));
        slopes.iter().for_each(|slope| diagram.curve(&slope.points, SLOPE, SLOPES, &[]));
        for (one, Drawn { points, colour, .. }) in plot.curves.iter().zip(&curves) {
            let (width, dot) = if one.is_strong { (STRONG, STRONG_DOT) } else { (CURVE, DOT) };
            if points.len() > 1 {
                diagram.curve(points, width, *colour, &[]);
            }
            points.iter().for_each(|&point| diagram.curve(&[point], 2.0 * dot, *colour, &[]));
        }
        let all: Vec<_> = slopes.into_iter().chain(curves).collect();
        for (one, area) in all.iter().zip(self.names(diagram, &all)) {
            let Some([left, top, ..]) = area else { continue };
            let baseline = top + (0.5 * HIGH + MIDDLE) * SMALL.size;
            write(diagram, &one.name, label(one.colour), 0.0, [left, baseline]);
        }
    }

    /// The curves of a plot.
    fn curves(&self, plot: &Plot) -> Vec<Drawn> {
        let drawn = |one: &Line| Drawn {
            points: one.shown().map(|point| self.pixel(point)).collect(),
            first: 0,
            name: one.name.clone(),
            colour: FAMILIES[one.family % FAMILIES.len()],
        };
        plot.curves.iter().map(drawn).collect()
    }

    /// The lines of known slopes, downwards from their common point and within the axes; none if that point is outside.
    fn slopes(&self, plot: &Plot) -> Vec<Drawn> {
        let Some((meet, slopes)) = &plot.slopes else { return Vec::new() };
        let meet = meet.map(libm::log10);
        if [0, 1].iter().any(|&axis| !(self.ranges[axis][0]..=self.ranges[axis][1]).contains(&meet[axis])) {
            return Vec::new();
        }
        let line = |&slope: &f64| {
            let down = (meet[1] - self.ranges[1][0]) / slope.abs();
            let aside = if slope > 0.0 { meet[0] - self.ranges[0][0] } else { self.ranges[0][1] - meet[0] };
            let reach = REACH.min(down).min(aside) * -slope.signum();
            let points = [meet, [meet[0] + reach, meet[1] + slope * reach]].map(|end| self.pixel(end));
            Drawn { points: points.into(), first: 1, name: format!("slope {slope}"), colour: SECOND_TEXT }
        };
        slopes.iter().map(line).collect()
    }

    /// Lines at powers of ten, with their numbers.
    fn grid(&self, diagram: &mut Diagram, across: &str) {
        let [left, top, right, bottom] = self.area;
        let numbers = |[low, high]: [f64; 2]| libm::ceil(low - 1e-9) as i32..=libm::floor(high + 1e-9) as i32;
        let [[low, high], rows] = self.ranges;
        let apart = (1..).find(|apart| numbers(rows).count() as i32 <= MOST_ROWS * apart).unwrap_or(1);
        for power in numbers(rows).filter(|power| power.rem_euclid(apart) == 0) {
            let y = self.pixel([low, f64::from(power)])[1];
            diagram.rectangle([left, (y - 0.5 * THIN).round(), right - left, THIN], HAIRLINE);
            write(diagram, &power_of_ten(power), SMALL, 1.0, [left - GAP, y + MIDDLE * SMALL.size]);
        }
        // Numbers far from 1 are powers of ten, on the whole axis. On a short axis there are twos and fives, too.
        let is_plain = low > -3.5 && high < 4.5;
        let digits: &[f64] = if is_plain && high - low < 2.5 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let all = (low as i32 - 1..=high as i32 + 1).flat_map(|power| digits.iter().map(move |&digit| (power, digit)));
        for (power, digit) in all {
            let at = f64::from(power) + libm::log10(digit);
            if !(low - 1e-9..=high + 1e-9).contains(&at) {
                continue;
            }
            let x = self.pixel([at, rows[0]])[0];
            diagram.rectangle([(x - 0.5 * THIN).round(), top, THIN, bottom - top], HAIRLINE);
            let number = libm::round(digit * libm::exp10(f64::from(power)) * 1e6) / 1e6;
            let text = if is_plain { number.to_string() } else { power_of_ten(power) };
            write(diagram, &text, SMALL, 0.5, [x, bottom + 22.0]);
        }
        write(diagram, across, SMALL, 1.0, [right, bottom + 43.0]);
    }

    /// The place of each line's name beside one of its points, where it covers least; `None` without points or name.
    fn names(&self, diagram: &Diagram, lines: &[Drawn]) -> Vec<Option<Area>> {
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
