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

use super::{
    Colour, HAIRLINE, LINE, MARGIN, MIDDLE, Page, SECOND_TEXT, SMALL, Sketch, TEXT, TITLE, USUAL, power_of_ten,
};
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
    pub(crate) groups: Vec<(String, Vec<RangesRow>)>,
}

/// One row of a figure.
pub(crate) struct RangesRow {
    /// Its letter.
    pub(crate) letter: &'static str,
    /// What it is.
    pub(crate) words: String,
    /// For each axis the least, the median and the greatest number, and the ring if there is one.
    pub(crate) numbers: Vec<([f64; 3], Option<f64>)>,
}

/// Width and height of the page (px).
const SIZE: [u32; 2] = [1280, 820];
/// Where the parts of the figure stand (px).
const WORDS: f64 = 176.0;
const AXES: [f64; 2] = [384.0, 1240.0];
const BETWEEN: f64 = 44.0;
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
const THIN: f64 = 1.0;
/// The colours of medians and of ranges.
const STRONG: Colour = [0x00, 0x72, 0xb2];
const FAINT: Colour = [0x9c, 0xc7, 0xdf];

impl Page for Ranges {
    fn title(&self) -> &str {
        &self.title
    }

    fn caption(&self) -> &[String] {
        &self.caption
    }

    fn size(&self) -> [u32; 2] {
        SIZE
    }

    fn draw(&self, sketch: &mut Sketch) {
        self.key(sketch);
        let decades = self.decades();
        let wide = (AXES[1] - AXES[0] - BETWEEN * (self.axes.len() as f64 - 1.0)) / self.axes.len() as f64;
        let lefts: Vec<_> = (0..self.axes.len()).map(|at| AXES[0] + (wide + BETWEEN) * at as f64).collect();
        for (name, &left) in self.axes.iter().zip(&lefts) {
            sketch.left(name, USUAL, true, TEXT, [left, ROWS[0] - NAMES_ABOVE]);
            axis(sketch, left, wide, decades);
        }
        let rows: usize = self.groups.iter().map(|(_, rows)| rows.len()).sum();
        let row = (ROWS[1] - ROWS[0]) / (rows as f64 + 2.0 * BORDER * self.groups.len() as f64);
        let mut top = ROWS[0];
        for (at, (name, rows)) in self.groups.iter().enumerate() {
            if at > 0 {
                sketch.rectangle([MARGIN, top, AXES[1] - MARGIN, THIN], HAIRLINE);
            }
            top += BORDER * row;
            for (at, one) in rows.iter().enumerate() {
                let (middle, baseline) = (top + 0.5 * row, top + 0.5 * row + MIDDLE * USUAL);
                if at == 0 {
                    sketch.left(name, USUAL, true, TEXT, [MARGIN, baseline]);
                }
                sketch.left(one.letter, USUAL, true, TEXT, [WORDS, baseline]);
                sketch.left(&one.words, SMALL, false, SECOND_TEXT, [WORDS + 22.0, baseline]);
                for ((range, ring), &left) in one.numbers.iter().zip(&lefts) {
                    let place = |value: f64| left + wide * share(value, decades);
                    draw(sketch, range.map(place), ring.map(place), middle);
                }
                top += row;
            }
            top += BORDER * row;
        }
    }
}

impl Ranges {
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
    fn key(&self, sketch: &mut Sketch) {
        let wide = |words: &String| sketch.width(words, USUAL, false);
        let left = AXES[1] - self.key.iter().map(wide).fold(0.0, f64::max);
        for (at, words) in self.key.iter().enumerate() {
            let baseline = TITLE + 4.0 + (LINE + 3.0) * at as f64;
            sketch.left(words, USUAL, false, SECOND_TEXT, [left, baseline]);
            let (middle, right) = (baseline - MIDDLE * USUAL, left - 16.0);
            match at {
                0 => draw(sketch, [right - 56.0, right - 30.0, right], None, middle),
                _ => ring(sketch, [right - 28.0, middle]),
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
fn axis(sketch: &mut Sketch, left: f64, wide: f64, [low, high]: [i32; 2]) {
    for power in (low..=high).filter(|power| power % DECADES == 0) {
        let x = left + wide * f64::from(power - low) / f64::from(high - low);
        sketch.rectangle([x - 0.5 * THIN, ROWS[0], THIN, ROWS[1] - ROWS[0]], HAIRLINE);
        sketch.centred(&power_of_ten(power), SMALL, SECOND_TEXT, [x, ROWS[1] + NUMBERS_BELOW]);
    }
}

/// A range with its median, and a ring if there is one (px).
fn draw(sketch: &mut Sketch, [least, median, most]: [f64; 3], other: Option<f64>, middle: f64) {
    // Two points at the same place are a dot.
    sketch.line(&[[least, middle], [most, middle]], RANGE, FAINT);
    sketch.dot([median, middle], DOT, STRONG);
    if let Some(other) = other {
        ring(sketch, [other, middle]);
    }
}

/// A ring around a point (px).
fn ring(sketch: &mut Sketch, [x, y]: [f64; 2]) {
    const CORNERS: u32 = 72;
    let at = |corner: u32| {
        let (sine, cosine) = libm::sincos(TAU * f64::from(corner) / f64::from(CORNERS));
        [x + RING * cosine, y + RING * sine]
    };
    sketch.line(&(0..=CORNERS).map(at).collect::<Vec<_>>(), RING_LINE, TEXT);
}

#[cfg(test)]
mod tests {
    use super::super::tests::curves;
    use super::*;

    fn figure(range: [f64; 3], ring: Option<f64>) -> Ranges {
        let row = RangesRow { letter: "A", words: "one pass".to_owned(), numbers: vec![(range, ring); 2] };
        Ranges {
            title: "Title".to_owned(),
            caption: vec!["Words".to_owned()],
            key: ["ours".to_owned(), "theirs".to_owned()],
            axes: vec!["mean".to_owned(), "maximum".to_owned()],
            groups: vec![("group".to_owned(), vec![row])],
        }
    }

    #[test]
    fn numbers_stand_where_their_logarithm_is_and_rings_only_where_there_is_one() {
        let with = curves(&figure([1e-6, 1e-3, 1.0], Some(1e-3)));
        // The key's range, dot and ring come first.
        let [range, dot, ring] = [3, 4, 5].map(|at| &with[at]);
        let [[from, y], [to, _]] = [range[0], range[1]];
        assert!((dot[0][0] - (from + to) / 2.0).abs() < 1e-3 && dot[0][1] == y);
        let middle = (ring[0][0] + ring[36][0]) / 2.0;
        assert!((middle - dot[0][0]).abs() < 1e-3);
        assert_eq!(with.len(), curves(&figure([1e-6, 1e-3, 1.0], None)).len() + 2);
    }

    #[test]
    fn all_is_on_the_page_whatever_the_numbers() {
        for range in [[0.0; 3], [f64::NAN; 3], [1e-300, 1.0, f64::INFINITY], [2.0; 3]] {
            let curves = curves(&figure(range, Some(1e-6)));
            assert!(curves.iter().flatten().all(|[_, y]| (0.0..f64::from(SIZE[1])).contains(y)));
        }
    }
}
