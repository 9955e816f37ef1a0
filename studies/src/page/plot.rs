//! Curves on logarithmic axes, with their names beside them: errors against time, and against steps.
//!
//! ```text
//! title
//! caption
//! name of a plot             name of a plot
//! 1 ┼  what is upwards       1 ┼  what is upwards
//!   ┼  ●━━● one                ┼ ● four
//!   ┼     ╲━━● two             ┼    ●━━● five
//!   └──┼────┼─────             └──┼────┼─────
//!      1   10  to the right       1   10  to the right
//! ```

use super::power_of_ten;
use super::{
    AXIS, CAPTION, Colour, HAIRLINE, LINE, MARGIN, MIDDLE, Page, SECOND_TEXT, SMALL, Sketch, TEXT, USUAL, WIDE,
};

/// Several plots on one page.
pub(crate) struct Plots {
    /// The title.
    pub(crate) title: String,
    /// Lines below it.
    pub(crate) caption: Vec<String>,
    /// The plots, in rows of [`Self::columns`].
    pub(crate) plots: Vec<Plot>,
    /// How many stand beside each other.
    pub(crate) columns: usize,
}

/// One plot. Plots whose axes have the same name have the same range on it.
pub(crate) struct Plot {
    /// What it shows.
    pub(crate) name: String,
    /// The names of its axes, to the right and upwards, with units in parentheses.
    pub(crate) axes: [String; 2],
    /// The curves, in the order in which they are drawn; the last ones are named first.
    pub(crate) curves: Vec<Line>,
    /// Where lines of known slopes meet, and these slopes: powers of what is to the right. `None` for none.
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
    /// The points, to the right and upwards. What is not positive and finite is left out.
    pub(crate) points: Vec<[f64; 2]>,
}

/// Room between plots, and for what is written at the left of a plot (px).
const BETWEEN: f64 = 34.0;
const NUMBERS: f64 = 58.0;
/// From the caption to the first plots (px).
const BELOW_CAPTION: f64 = 14.0;
/// Above a plot for its name and that of its axis, its height in parts of its width, and room below it (px).
const NAMES: f64 = 54.0;
const SHAPE: f64 = 0.78;
const BELOW: f64 = 62.0;
/// How much a line of words takes up, in parts of the type's size.
const HIGH: f64 = 1.08;
/// Widths of curves, of strong ones, of slopes and of hairlines, and radii of dots (px).
const CURVE: f64 = 1.8;
const STRONG: f64 = 3.2;
const SLOPE: f64 = 1.2;
const THIN: f64 = 1.0;
const DOT: f64 = 3.6;
const STRONG_DOT: f64 = 5.0;
/// From a dot to the name beside it (px).
const GAP: f64 = 8.0;
/// Colours of families of curves.
const FAMILIES: [Colour; 6] = [
    [0x00, 0x72, 0xb2],
    [0x1e, 0xa0, 0x87],
    [0x4d, 0x20, 0x01],
    [0x3c, 0x43, 0x4d],
    [0x40, 0x00, 0x54],
    [0x24, 0x9d, 0xb1],
];
/// The largest number of powers of ten that are written upwards.
const MOST_ROWS: i32 = 7;
/// How far lines of known slopes reach, in decades to the right.
const REACH: f64 = 0.8;

/// A rectangle: left, top, right, bottom (px).
type Area = [f64; 4];

impl Page for Plots {
    fn title(&self) -> &str {
        &self.title
    }

    fn caption(&self) -> &[String] {
        &self.caption
    }

    fn size(&self) -> [u32; 2] {
        let rows = self.plots.len().div_ceil(self.columns) as f64;
        let high = self.top() + rows * (NAMES + SHAPE * self.wide() + BELOW);
        [WIDE as u32, high.round() as u32]
    }

    fn draw(&self, sketch: &mut Sketch) {
        let (wide, high) = (self.wide(), SHAPE * self.wide());
        for (at, plot) in self.plots.iter().enumerate() {
            let (column, row) = ((at % self.columns) as f64, (at / self.columns) as f64);
            let left = MARGIN + NUMBERS + column * (wide + BETWEEN + NUMBERS);
            let top = self.top() + NAMES + row * (NAMES + high + BELOW);
            let ranges = [0, 1].map(|axis| self.range(axis, &plot.axes[axis]));
            Room { area: [left, top, left + wide, top + high], ranges }.draw(sketch, plot);
        }
    }
}

impl Plots {
    /// Where the plots begin (px).
    fn top(&self) -> f64 {
        CAPTION + LINE * (self.caption.len() as f64 - 1.0) + BELOW_CAPTION
    }

    /// The width of a plot (px).
    fn wide(&self) -> f64 {
        let columns = self.columns as f64;
        (WIDE - 2.0 * MARGIN - columns * NUMBERS - (columns - 1.0) * BETWEEN) / columns
    }

    /// The logarithms at the ends of all axes of a name: in half decades to the right, whole ones upwards.
    fn range(&self, axis: usize, name: &str) -> [f64; 2] {
        let alike = self.plots.iter().filter(|plot| plot.axes[axis] == name);
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
}

impl Line {
    /// The logarithms of the points that are shown.
    fn shown(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let is_shown = |point: &&[f64; 2]| point.iter().all(|&number| number > 0.0 && number.is_finite());
        self.points.iter().filter(is_shown).map(|point| point.map(libm::log10))
    }
}

/// Where a plot stands (px), and the logarithms at the ends of its axes.
struct Room {
    area: Area,
    ranges: [[f64; 2]; 2],
}

/// A name that is to be placed beside one of several points (px).
struct Name<'a> {
    text: &'a str,
    colour: Colour,
    anchors: Vec<[f64; 2]>,
}

impl Room {
    /// The pixel of a pair of logarithms.
    fn pixel(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [left, top, right, bottom] = self.area;
        let share = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
        [left + share(x, self.ranges[0]) * (right - left), bottom - share(y, self.ranges[1]) * (bottom - top)]
    }

    fn draw(&self, sketch: &mut Sketch, plot: &Plot) {
        let [left, top, ..] = self.area;
        sketch.left(&plot.name, USUAL, true, TEXT, [left - NUMBERS, top - NAMES + 20.0]);
        sketch.left(&plot.axes[1], SMALL, false, SECOND_TEXT, [left - NUMBERS, top - 12.0]);
        self.grid(sketch, &plot.axes[0]);
        let mut lines: Vec<Vec<[f64; 2]>> = Vec::new();
        let mut names: Vec<Name<'_>> = Vec::new();
        let written: Vec<String> =
            plot.slopes.iter().flat_map(|(_, slopes)| slopes).map(|slope| format!("slope {slope}")).collect();
        if let Some((meet, slopes)) = &plot.slopes {
            let meet = meet.map(libm::log10);
            let is_inside = |axis: usize| (self.ranges[axis][0]..=self.ranges[axis][1]).contains(&meet[axis]);
            for (slope, text) in slopes.iter().zip(&written).filter(|_| is_inside(0) && is_inside(1)) {
                // Downwards, and not beyond the axes.
                let down = (meet[1] - self.ranges[1][0]) / slope.abs();
                let aside = if *slope > 0.0 { meet[0] - self.ranges[0][0] } else { self.ranges[0][1] - meet[0] };
                let reach = REACH.min(down).min(aside) * -slope.signum();
                let line = [meet, [meet[0] + reach, meet[1] + slope * reach]].map(|end| self.pixel(end));
                sketch.line(&line, SLOPE, AXIS);
                names.push(Name { text, colour: SECOND_TEXT, anchors: vec![line[1]] });
                lines.push(line.to_vec());
            }
        }
        for one in &plot.curves {
            let colour = FAMILIES[one.family % FAMILIES.len()];
            let points: Vec<_> = one.shown().map(|point| self.pixel(point)).collect();
            let (width, dot) = if one.is_strong { (STRONG, STRONG_DOT) } else { (CURVE, DOT) };
            if points.len() > 1 {
                sketch.line(&points, width, colour);
            }
            points.iter().for_each(|&point| sketch.dot(point, dot, colour));
            if !points.is_empty() {
                names.push(Name { text: &one.name, colour, anchors: points.clone() });
                lines.push(points);
            }
        }
        self.write(sketch, &names, &lines);
    }

    /// Lines at powers of ten, with their numbers.
    fn grid(&self, sketch: &mut Sketch, across: &str) {
        let [left, top, right, bottom] = self.area;
        let numbers = |[low, high]: [f64; 2]| libm::ceil(low - 1e-9) as i32..=libm::floor(high + 1e-9) as i32;
        let [[low, high], rows] = self.ranges;
        let apart = (1..).find(|apart| numbers(rows).count() as i32 <= MOST_ROWS * apart).unwrap_or(1);
        for power in numbers(rows).filter(|power| power.rem_euclid(apart) == 0) {
            let y = self.pixel([low, f64::from(power)])[1];
            sketch.rectangle([left, (y - 0.5 * THIN).round(), right - left, THIN], HAIRLINE);
            let text = power_of_ten(power);
            sketch.right(&text, SMALL, SECOND_TEXT, [left - GAP, y + MIDDLE * SMALL]);
        }
        // On a short axis twos and fives, too.
        let digits: &[f64] = if high - low < 2.5 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        for (power, digit) in
            (low as i32 - 1..=high as i32 + 1).flat_map(|power| digits.iter().map(move |&d| (power, d)))
        {
            let at = f64::from(power) + libm::log10(digit);
            if !(low - 1e-9..=high + 1e-9).contains(&at) {
                continue;
            }
            let x = self.pixel([at, rows[0]])[0];
            sketch.rectangle([(x - 0.5 * THIN).round(), top, THIN, bottom - top], HAIRLINE);
            let text = match power {
                -3..=4 => format!("{}", libm::round(digit * libm::exp10(f64::from(power)) * 1e6) / 1e6),
                _ => power_of_ten(power),
            };
            sketch.centred(&text, SMALL, SECOND_TEXT, [x, bottom + 22.0]);
        }
        sketch.right(across, SMALL, SECOND_TEXT, [right, bottom + 43.0]);
    }

    /// Writes names beside their points, each where it covers least.
    fn write(&self, sketch: &mut Sketch, names: &[Name<'_>], lines: &[Vec<[f64; 2]>]) {
        let places: Vec<Vec<(Area, f64)>> = names.iter().map(|name| self.places(sketch, name)).collect();
        let mut chosen: Vec<Option<Area>> = vec![None; names.len()];
        // Names of later curves first; then each again, as the others stand.
        for at in (0..names.len()).rev().chain((0..names.len()).rev()).chain((0..names.len()).rev()) {
            let others: Vec<Area> =
                chosen.iter().enumerate().filter(|(other, _)| *other != at).filter_map(|(_, area)| *area).collect();
            let cost = |&(area, cost): &(Area, f64)| {
                let on_names: f64 = others.iter().map(|&other| 60.0 * shared(area, other)).sum();
                let on_line = |(of, line): (usize, &Vec<[f64; 2]>)| match of == at {
                    true => 0.6 * covered(area, line),
                    // Next to a dot of another curve it would seem to be that one's name.
                    false => covered(area, line) + near(area, line),
                };
                cost + on_names + lines.iter().enumerate().map(on_line).sum::<f64>()
            };
            let best = places[at].iter().min_by(|one, other| cost(one).total_cmp(&cost(other)));
            chosen[at] = best.map(|(area, _)| *area);
        }
        for (name, area) in names.iter().zip(chosen) {
            let Some([left, top, ..]) = area else { continue };
            let baseline = top + 0.5 * HIGH * SMALL + MIDDLE * SMALL;
            sketch.label(name.text, name.colour, [left, baseline]);
        }
    }

    /// Where a name can stand: beside, above and below each of its points, and what that costs by itself.
    fn places(&self, sketch: &Sketch, name: &Name<'_>) -> Vec<(Area, f64)> {
        let (wide, high) = (sketch.width(name.text, SMALL, true), HIGH * SMALL);
        if name.text.is_empty() {
            return Vec::new();
        }
        let [low, top, far, bottom] = self.area;
        let mut places = Vec::new();
        for (number, &[x, y]) in name.anchors.iter().enumerate() {
            let is_end = number == 0 || number + 1 == name.anchors.len();
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

/// The part of the smaller of two areas that both share.
fn shared(one: Area, other: Area) -> f64 {
    let side = |axis: usize| (one[axis + 2].min(other[axis + 2]) - one[axis].max(other[axis])).max(0.0);
    let size = |area: Area| (area[2] - area[0]) * (area[3] - area[1]);
    side(0) * side(1) / size(one).min(size(other))
}

/// How many of the dots lie beside an area.
fn near(area: Area, dots: &[[f64; 2]]) -> f64 {
    let is_near = |&&[x, y]: &&[f64; 2]| {
        let beside = (area[0] - x).max(x - area[2]).max(0.0);
        let above = (area[1] - y).max(y - area[3]).max(0.0);
        libm::hypot(beside, above) < 1.5 * GAP
    };
    dots.iter().filter(is_near).count() as f64
}

/// How much of a line through points an area covers: each dot counts, and each height of a letter along the line.
fn covered(area: Area, line: &[[f64; 2]]) -> f64 {
    let is_in = |[x, y]: [f64; 2], margin: f64| {
        x > area[0] - margin && x < area[2] + margin && y > area[1] - margin && y < area[3] + margin
    };
    let dots = line.iter().filter(|&&dot| is_in(dot, DOT)).count() as f64;
    let on_way = line.windows(2).map(|two| {
        let [dx, dy] = [two[1][0] - two[0][0], two[1][1] - two[0][1]];
        let pieces = libm::ceil(libm::hypot(dx, dy) / 4.0).max(1.0);
        let at = |piece: f64| [two[0][0] + dx * piece / pieces, two[0][1] + dy * piece / pieces];
        (0..=pieces as usize).filter(|&piece| is_in(at(piece as f64), 0.0)).count() as f64 * 4.0 / SMALL
    });
    3.0 * dots + on_way.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::super::Drawn;
    use super::super::tests::curves;
    use super::*;

    fn page(points: Vec<[f64; 2]>) -> Plots {
        let curve = |name: &str, points| Line { name: name.to_owned(), family: 0, is_strong: false, points };
        let plot = |points: &Vec<[f64; 2]>| Plot {
            name: "plot".to_owned(),
            axes: ["time (ns)".to_owned(), "error (rad)".to_owned()],
            curves: vec![curve("one", points.clone()), curve("two", points.clone())],
            slopes: Some(([1e4, 1e-4], vec![2.0, 5.0])),
        };
        let (title, caption) = ("Title".to_owned(), vec!["Words".to_owned()]);
        Plots { title, caption, plots: vec![plot(&points), plot(&vec![[3e5, 1e-3]])], columns: 2 }
    }

    #[test]
    fn a_decade_is_equally_long_everywhere_and_plots_share_their_axes() {
        let curves = curves(&page(vec![[1.0, 1e-12], [10.0, 1e-9], [100.0, 1e-6]]));
        let dots: Vec<_> = curves.iter().filter(|curve| curve.len() == 1).map(|curve| curve[0]).collect();
        assert!((dots[1][0] - dots[0][0] - (dots[2][0] - dots[1][0])).abs() < 1e-3);
        assert!((dots[1][1] - dots[0][1] - (dots[2][1] - dots[1][1])).abs() < 1e-3 && dots[1][1] < dots[0][1]);
        // 3e5 is outside the first plot's own range, which it widens.
        let rightmost = dots[..6].iter().map(|dot| dot[0]).fold(0.0, f64::max);
        assert!(rightmost < 600.0 && dots[6][0] > 640.0);
    }

    #[test]
    fn names_do_not_cover_each_other() {
        let drawn = page(vec![[1.0, 1e-12], [10.0, 1e-9], [100.0, 1e-6]]).sketch().drawn;
        let names = drawn.into_iter().filter_map(|one| match one {
            Drawn::Text { span, baseline, is_label: true } => {
                Some([span[0], baseline - 0.8 * SMALL, span[1], baseline + 0.2 * SMALL])
            }
            _ => None,
        });
        let names: Vec<Area> = names.collect();
        // Two curves and two slopes in the first plot, and again in the second one.
        assert_eq!(names.len(), 8);
        for (at, one) in names.iter().enumerate() {
            for other in &names[..at] {
                let apart = |axis: usize| one[axis] >= other[axis + 2] - 6.0 || other[axis] >= one[axis + 2] - 6.0;
                assert!(apart(0) || apart(1), "{one:?} {other:?}");
            }
        }
    }

    #[test]
    fn all_is_on_the_page_whatever_the_numbers() {
        for points in [vec![], vec![[0.0, -1.0]], vec![[f64::NAN, 1.0]], vec![[1e-300, f64::INFINITY]], vec![[2.0; 2]]]
        {
            let page = page(points);
            let high = f64::from(page.size()[1]);
            assert!(curves(&page).iter().flatten().all(|[_, y]| (0.0..high).contains(y)));
        }
    }
}
