//! Signs and words in charts: divergences, names, and flags with letters or numbers.

use super::layer::pixels;
use super::names::{self, DOTS, Name, spread};
use super::{Chart, PlotArea};
use crate::colour::Colour;
use crate::picture::caption::Writer;
use crate::picture::layout::Scale;
use crate::picture::layout::steps::{CLOSE, FREE, HAIR, NEAR, RING, SMALL, STRONG, THIN, TICK};
use crate::picture::page::Item;
use crate::picture::plane::pieces;
use crate::picture::text::Weight;

/// The opacity of the lines of flags.
const FLAG: f64 = 0.62;
/// The largest share of the margin for crowded rings at each end.
const BEYOND: f64 = 0.35;

/// A sign or words in a chart, in the values of its axes.
#[derive(Clone, Debug, PartialEq)]
pub enum Annotation {
    /// A cross at the end of a line that is cut off, with an arrowhead where it leaves the chart.
    Cross {
        /// The points of the line.
        line: Vec<[f64; 2]>,
        /// The place of the cross to the right.
        at: f64,
        /// Its colour.
        colour: Colour,
    },
    /// Names at the ends of lines, right of the chart. Names of close ends are moved apart, and thin lines lead to them.
    Names {
        /// The names.
        names: Vec<Name>,
        /// The extent of the names above and below the chart (px).
        beyond: [f64; 2],
    },
}

/// A letter or a number in a ring above charts, with a line down to its place on their common axis.
#[derive(Clone, Debug)]
pub(in crate::picture) struct Flag {
    /// The place on the axis.
    pub at: f64,
    pub text: String,
    /// The colour of its line and rim.
    pub colour: Colour,
}

impl Annotation {
    pub(super) fn draw(&self, writer: &mut Writer<'_>, chart: &Chart, place: PlotArea) {
        match self {
            Self::Cross { line, at, colour } => cross(writer, chart, place, (line, *at), *colour),
            Self::Names { names, beyond } => names::write(writer, chart, place, names, *beyond),
        }
    }
}

/// Draws a cross at the end of a line that is cut off at a place.
fn cross(writer: &mut Writer<'_>, chart: &Chart, place: PlotArea, (line, at): (&[[f64; 2]], f64), colour: Colour) {
    let (arm, x) = (TICK * place.line, place.x(&chart.x, at));
    let (Some(last), Some(stretch)) = (line.last(), chart.x.stretch(at)) else { return };
    let mut curve = |points: &[[f64; 2]], width, dash: &[f64]| {
        writer.curves.push(place.curve(points, width, dash, colour));
    };
    let [wing, back] = [TICK, CLOSE].map(|length| length * place.line);
    let left = leaving(&pixels(line, chart, stretch, place), place.borders());
    if let Some([from, tip]) = left.filter(|[_, tip]| tip[0] + wing < x - arm) {
        // An arrowhead, and dots along the border to the cross, which has the name.
        let up = if tip[1] < from[1] { -1.0 } else { 1.0 };
        let corner = |side: f64| [tip[0] + side * wing, tip[1] - up * back];
        curve(&[corner(-1.0), tip, corner(1.0)], STRONG, &[]);
        let y = tip[1].clamp(place.top, place.bottom);
        curve(&[[tip[0] + wing, y], [x - arm, y]], HAIR, &DOTS);
    }
    let y = place.y(&chart.y, last[1]).clamp(place.top, place.bottom);
    for slope in [-1.0, 1.0] {
        curve(&[[x - arm, y - slope * arm], [x + arm, y + slope * arm]], STRONG, &[]);
    }
}

/// The last piece of a line within the borders of its chart, if the line leaves it there for good.
fn leaving(points: &[[f64; 2]], borders: [f64; 4]) -> Option<[[f64; 2]; 2]> {
    let inside = |y: f64| (borders[1]..=borders[3]).contains(&y);
    let at = points.iter().rposition(|&[_, y]| inside(y)).filter(|&at| at + 1 < points.len())?;
    let part = pieces(&points[at..at + 2], borders).pop()?;
    part.last_chunk().copied()
}

/// Draws flags, sorted by their places: rings at a height, side by side within the width of the first chart, with lines
/// from the top of all charts to the bottom of the last one (px).
pub(super) fn flags(
    writer: &mut Writer<'_>,
    flags: &[Flag],
    middle: f64,
    (chart, place): (&Chart, PlotArea),
    bottom: f64,
) {
    let (scale, fonts, palette) = (writer.scale, writer.fonts, writer.palette);
    let PlotArea { left, right, .. } = place;
    let unit = scale.type_unit();
    let top = place.top - NEAR * unit;
    let wide = |text: &str| fonts.width(text, Weight::SemiBold, SMALL * unit);
    let widest = flags.iter().map(|flag| wide(&flag.text)).fold(0.0, f64::max);
    let radius = (RING * unit).max(0.5 * widest + TICK * unit);
    let apart = 2.0 * radius + FREE * unit;
    // The outermost rings reach into the margins, but not to the picture's sides.
    let span = right - left + 2.0 * radius.min(BEYOND * scale.margin());
    // Many rings become smaller while their letters can be read; otherwise they are left out.
    let smaller = (span / (apart * flags.len().max(1) as f64)).min(1.0);
    let letter = SMALL * unit * smaller;
    let with_rings = Scale::legible(letter);
    let places: Vec<_> = flags.iter().map(|flag| place.x(&chart.x, flag.at).floor() + 0.5).collect();
    let rings = spread(&places, apart * smaller, [left, right]);
    let rings = rings.iter().zip(&places).map(|(&ring, &x)| if (ring - x).abs() < 0.75 { x } else { ring });
    let rings: Vec<_> = rings.collect();
    for ((flag, &x), &ring) in flags.iter().zip(&places).zip(&rings) {
        let from = if with_rings { [ring, middle] } else { [x, top] };
        let points: &[_] = if from[0] == x { &[from, [x, bottom]] } else { &[from, [x, top], [x, bottom]] };
        writer.curves.push(place.curve(points, HAIR, &[], (flag.colour, FLAG)));
    }
    for (flag, &at) in flags.iter().zip(&rings).filter(|_| with_rings) {
        let colours = [flag.colour, palette.background, palette.text];
        ring(writer, [at, middle], [radius * smaller, letter], colours, &flag.text);
    }
}

/// A ring with a letter of a size around a place (px), and the colours of its rim, its ground and the letter.
pub(in crate::picture) fn ring(
    writer: &mut Writer<'_>,
    at: [f64; 2],
    [radius, size]: [f64; 2],
    [rim, ground, letter]: [Colour; 3],
    text: &str,
) {
    let thickness = THIN * writer.scale.line();
    for (radius, colour) in [(radius, rim), (radius - thickness, ground)] {
        writer.curves.push(Item::disc(at, radius, colour));
    }
    let left = at[0] - 0.5 * writer.fonts.width(text, Weight::SemiBold, size);
    writer.left(text, Weight::SemiBold, size, letter, left, at[1] + 0.36 * size);
}
