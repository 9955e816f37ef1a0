//! Ranges of numbers on logarithmic axes, with the numbers of somebody else beside them as rings: Table 1 as a figure.
//!
//! ```text
//! title
//! caption                              key
//!                  mean              maximum
//! group   a words   ━━●━━  ○          ━●━━○━
//!         b words     ━●○━              ━●━
//! ────────────────────────────────────────────
//! group   a words  …
//!                 10⁻⁶   10⁻³   1   10³
//! ```

use super::caption::Writer;
use super::layout::Scale;
use super::narrow::narrow;
use super::text::{Fonts, Weight};
use super::{Colour, Curve, Mark, MarkShape, Picture};
use crate::look::{Style, Theme};
use std::f64::consts::TAU;

/// The figure.
pub(crate) struct Ranges {
    /// The title.
    pub(crate) title: String,
    /// Lines below it.
    pub(crate) caption: Vec<String>,
    /// What ranges and dots are, and what rings are.
    pub(crate) key: [String; 2],
    /// The names of the axes.
    pub(crate) axes: Vec<String>,
    /// The rows, in groups with names.
    pub(crate) groups: Vec<(String, Vec<RangeRow>)>,
}

/// One row of a figure.
pub(crate) struct RangeRow {
    /// Its letter.
    pub(crate) letter: &'static str,
    /// What it is.
    pub(crate) words: String,
    /// For each axis the least, the median and the greatest number, and the ring if there is one.
    pub(crate) numbers: Vec<([f64; 3], Option<f64>)>,
}

/// Width and height of the figure (px), and in print (mm).
const SIZE: [u32; 2] = [1280, 820];
pub(crate) const SIZE_MM: [f64; 2] = [180.0, 115.3125];
/// Where the parts of the figure stand (px).
const LEFT: f64 = 40.0;
const WORDS: f64 = 176.0;
const AXES: [f64; 2] = [384.0, 1240.0];
const BETWEEN: f64 = 44.0;
const TITLE: f64 = 56.0;
const CAPTION: f64 = 84.0;
const LINE: f64 = 21.0;
const ROWS: [f64; 2] = [172.0, 758.0];
const NAMES_ABOVE: f64 = 20.0;
const NUMBERS_BELOW: f64 = 24.0;
/// Room of a group's border, in rows.
const BORDER: f64 = 0.5;
/// Decades from one written number to the next.
const DECADES: i32 = 3;
/// Radius of rings and dots, thickness of ranges, of rings and of lines (px).
const RING: f64 = 6.5;
const DOT: f64 = 4.0;
const RANGE: f64 = 7.0;
const RING_LINE: f64 = 1.8;
const HAIRLINE: f64 = 1.0;
/// Sizes of type (px).
const USUAL: f64 = 16.0;
const SMALL: f64 = 14.5;
const NAME: f64 = 26.0;
/// How far the middle of small letters lies above their baseline, in parts of the type's size.
const MIDDLE: f64 = 0.34;
/// Opacity of ranges.
const FAINT: f32 = 0.38;

impl Ranges {
    /// Composes the figure.
    pub(crate) fn compose(&self) -> Picture {
        let look = Style::of(Theme::Light);
        let fonts = Fonts::new(&look.font);
        let (palette, scale) = (look.palette, Scale::REFERENCE);
        let (marks, curves, words) = Default::default();
        let mut writer = Writer { palette: &palette, fonts: &fonts, scale, marks, curves, words };
        writer.left(&self.title, Weight::SemiBold, NAME, palette.text, LEFT, TITLE);
        for (at, line) in self.caption.iter().enumerate() {
            writer.left(line, Weight::Regular, USUAL, palette.second_text, LEFT, CAPTION + LINE * at as f64);
        }
        self.key(&mut writer);
        let decades = self.decades();
        let wide = (AXES[1] - AXES[0] - BETWEEN * (self.axes.len() as f64 - 1.0)) / self.axes.len() as f64;
        let lefts: Vec<_> = (0..self.axes.len()).map(|at| AXES[0] + (wide + BETWEEN) * at as f64).collect();
        for (name, &left) in self.axes.iter().zip(&lefts) {
            writer.left(name, Weight::SemiBold, USUAL, palette.text, left, ROWS[0] - NAMES_ABOVE);
            axis(&mut writer, left, wide, decades);
        }
        let rows: usize = self.groups.iter().map(|(_, rows)| rows.len()).sum();
        let row = (ROWS[1] - ROWS[0]) / (rows as f64 + 2.0 * BORDER * self.groups.len() as f64);
        let mut top = ROWS[0];
        for (at, (name, rows)) in self.groups.iter().enumerate() {
            if at > 0 {
                let line = [LEFT, top, AXES[1] - LEFT, HAIRLINE];
                writer.marks.push(Mark::upright(line, MarkShape::Filled, palette.hairline));
            }
            top += BORDER * row;
            for (at, one) in rows.iter().enumerate() {
                let (middle, baseline) = (top + 0.5 * row, top + 0.5 * row + MIDDLE * USUAL);
                if at == 0 {
                    writer.left(name, Weight::SemiBold, USUAL, palette.text, LEFT, baseline);
                }
                writer.left(one.letter, Weight::SemiBold, USUAL, palette.text, WORDS, baseline);
                writer.left(&one.words, Weight::Regular, SMALL, palette.second_text, WORDS + 22.0, baseline);
                for ((range, ring), &left) in one.numbers.iter().zip(&lefts) {
                    let place = |value: f64| left + wide * share(value, decades);
                    draw(&mut writer, range.map(place), ring.map(place), middle);
                }
                top += row;
            }
            top += BORDER * row;
        }
        let Writer { marks, curves, words, .. } = writer;
        let (ramp, panels, under) = Default::default();
        Picture { size: SIZE, palette, fonts, ramp, panels, under, marks, curves, words }
    }

    /// The powers of ten at the ends of the axes.
    fn decades(&self) -> [i32; 2] {
        let rows = self.groups.iter().flat_map(|(_, rows)| rows);
        let numbers = rows.flat_map(|row| &row.numbers).flat_map(|(range, ring)| range.iter().chain(ring));
        let finite = numbers.copied().filter(|number| *number > 0.0 && number.is_finite()).map(libm::log10);
        let none = (f64::INFINITY, f64::NEG_INFINITY);
        let (low, high) = finite.fold(none, |(low, high), power| (low.min(power), high.max(power)));
        if low > high { [-1, 0] } else { [libm::floor(low) as i32, (libm::floor(high) as i32) + 1] }
    }

    /// What stands for what, upper right.
    fn key(&self, writer: &mut Writer<'_>) {
        let palette = writer.palette;
        let wide = |words: &String| writer.fonts.width(words, Weight::Regular, USUAL);
        let left = AXES[1] - self.key.iter().map(wide).fold(0.0, f64::max);
        for (at, words) in self.key.iter().enumerate() {
            let baseline = TITLE + 4.0 + (LINE + 3.0) * at as f64;
            writer.left(words, Weight::Regular, USUAL, palette.second_text, left, baseline);
            let (middle, right) = (baseline - MIDDLE * USUAL, left - 16.0);
            match at {
                0 => draw(writer, [right - 56.0, right - 30.0, right], None, middle),
                _ => ring(writer, [right - 28.0, middle], palette.text),
            }
        }
    }
}

/// Where a number stands on an axis, from 0 to 1; what is no positive number stands at its begin.
fn share(value: f64, [low, high]: [i32; 2]) -> f64 {
    let power = if value > 0.0 { libm::log10(value) } else { f64::from(low) };
    ((power - f64::from(low)) / f64::from(high - low)).clamp(0.0, 1.0)
}

/// An axis with its lines and numbers.
fn axis(writer: &mut Writer<'_>, left: f64, wide: f64, [low, high]: [i32; 2]) {
    let palette = writer.palette;
    for power in (low..=high).filter(|power| power % DECADES == 0) {
        let x = left + wide * f64::from(power - low) / f64::from(high - low);
        let line = [x - 0.5 * HAIRLINE, ROWS[0], HAIRLINE, ROWS[1] - ROWS[0]];
        writer.marks.push(Mark::upright(line, MarkShape::Filled, palette.hairline));
        let text = power_of_ten(power);
        let half = 0.5 * writer.fonts.width(&text, Weight::Regular, SMALL);
        writer.left(&text, Weight::Regular, SMALL, palette.second_text, x - half, ROWS[1] + NUMBERS_BELOW);
    }
}

/// A range with its median, and a ring if there is one (px).
fn draw(writer: &mut Writer<'_>, [least, median, most]: [f64; 3], other: Option<f64>, middle: f64) {
    let colour = writer.palette.runs[0];
    let line = |points: Vec<[f64; 2]>, width: f64, colour: Colour, alpha: f32| Curve {
        points: points.into_iter().map(|point| point.map(narrow)).collect(),
        width: narrow(width),
        dash: Vec::new(),
        colour,
        alpha,
    };
    // Two points at the same place are a dot.
    writer.curves.push(line(vec![[least, middle], [most, middle]], RANGE, colour, FAINT));
    writer.curves.push(line(vec![[median, middle]], 2.0 * DOT, colour, 1.0));
    if let Some(other) = other {
        ring(writer, [other, middle], writer.palette.text);
    }
}

/// A ring around a point (px).
fn ring(writer: &mut Writer<'_>, [x, y]: [f64; 2], colour: Colour) {
    const CORNERS: u32 = 72;
    let at = |corner: u32| {
        let (sine, cosine) = libm::sincos(TAU * f64::from(corner) / f64::from(CORNERS));
        [x + RING * cosine, y + RING * sine].map(narrow)
    };
    let points = (0..=CORNERS).map(at).collect();
    writer.curves.push(Curve { points, width: narrow(RING_LINE), dash: Vec::new(), colour, alpha: 1.0 });
}

/// A power of ten as one writes it.
pub(crate) fn power_of_ten(power: i32) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    match power {
        0 => "1".to_owned(),
        1 => "10".to_owned(),
        _ => {
            let digits = power.to_string();
            let raised = digits.chars().map(|sign| sign.to_digit(10).map_or('⁻', |digit| RAISED[digit as usize]));
            format!("10{}", raised.collect::<String>())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(range: [f64; 3], ring: Option<f64>) -> Picture {
        let row = RangeRow { letter: "A", words: "one pass".to_owned(), numbers: vec![(range, ring); 2] };
        Ranges {
            title: "Title".to_owned(),
            caption: vec!["Words".to_owned()],
            key: ["ours".to_owned(), "theirs".to_owned()],
            axes: vec!["mean".to_owned(), "maximum".to_owned()],
            groups: vec![("group".to_owned(), vec![row])],
        }
        .compose()
    }

    #[test]
    fn powers_are_written_with_raised_digits() {
        assert_eq!([-12, -3, 0, 1, 4].map(power_of_ten), ["10⁻¹²", "10⁻³", "1", "10", "10⁴"]);
    }

    #[test]
    fn numbers_stand_where_their_logarithm_is_and_rings_only_where_there_is_one() {
        let with = figure([1e-6, 1e-3, 1.0], Some(1e-3));
        // The key's range, dot and ring come first.
        let [range, dot, ring] = [3, 4, 5].map(|at| &with.curves[at]);
        let [[from, y], [to, _]] = [range.points[0], range.points[1]];
        assert!((dot.points[0][0] - (from + to) / 2.0).abs() < 1e-3 && dot.points[0][1] == y);
        let middle = (ring.points[0][0] + ring.points[36][0]) / 2.0;
        assert!((middle - dot.points[0][0]).abs() < 1e-3);
        assert_eq!(with.curves.len(), figure([1e-6, 1e-3, 1.0], None).curves.len() + 2);
    }

    #[test]
    fn all_is_on_the_page_whatever_the_numbers() {
        for range in [[0.0; 3], [f64::NAN; 3], [1e-300, 1.0, f64::INFINITY], [2.0; 3]] {
            let picture = figure(range, Some(1e-6));
            let points = picture.curves.iter().flat_map(|curve| &curve.points);
            assert!(points.clone().all(|[x, y]| (0.0..1280.0).contains(x) && (0.0..820.0).contains(y)), "{range:?}");
            assert!(picture.words.iter().all(|word| word.span[0] >= 0.0 && word.span[1] <= 1280.0));
        }
    }
}
