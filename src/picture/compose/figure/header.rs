//! The header of a figure: title and caption at the left, a key at the right.

use crate::picture::caption::Writer;
use crate::picture::compose::cut;
use crate::picture::layout::Scale;
use crate::picture::layout::steps::ROW;
use crate::picture::tally::{hollow, struck};
use crate::picture::text::Weight;
use crate::picture::wrap::wrapped;
use crate::scene::figure::Figure;

/// The baselines of title and caption without a title, and from the title to the caption (px in the reference picture).
const TITLE_BASELINE: f64 = 60.0;
const FIRST_BASELINE: f64 = 54.0;
const BELOW_TITLE: f64 = 27.0;
/// The largest number of lines of captions, and the largest share of the picture for the header.
const MOST_LINES: usize = 3;
const MOST_HEIGHT: f64 = 0.34;
/// Side of the key's square, gap between the square and its words, and gap between caption and key (px in the reference
/// picture).
const SQUARE: f64 = 13.0;
const SQUARE_GAP: f64 = 9.0;
const APART: f64 = 36.0;
/// Between the keys of two squares (px in the reference picture).
const KEYS_APART: f64 = 22.0;
/// The meaning of a hollow square.
const FLAT: &str = "flat: volume below 1 %";

/// Writes title, caption and a key into a picture of a width (px). The key explains struck squares, in the first of its
/// wordings that fits, and hollow ones if there are any. Returns the last baseline (px), 0 if nothing is written.
pub(super) fn write(writer: &mut Writer<'_>, figure: &Figure, wordings: &[String], has_flat: bool) -> f64 {
    let (scale, palette, fonts) = (writer.scale, writer.palette, writer.fonts);
    let [width, height] = figure.size.map(f64::from);
    let (margin, room) = (scale.margin(), width - 2.0 * scale.margin());
    let [large, small] = [scale.title(), scale.caption()];
    let most = MOST_HEIGHT * height;
    let mut last = 0.0;
    // Each line, and its end (px).
    let mut lines: Vec<[f64; 2]> = Vec::new();
    let title = fonts.shortened(&figure.title, Weight::SemiBold, large, room);
    let baseline = scale.row(TITLE_BASELINE);
    if !title.is_empty() && Scale::legible(large) && baseline < most {
        writer.left(&title, Weight::SemiBold, large, palette.text, margin, baseline);
        last = baseline;
        lines.push([baseline, margin + fonts.width(&title, Weight::SemiBold, large)]);
    }
    let step = ROW * scale.type_unit();
    let next = |last: f64| {
        if last > 0.0 { last + scale.of_type(BELOW_TITLE * scale.unit) } else { scale.row(FIRST_BASELINE) }
    };
    if !figure.caption.is_empty() && Scale::legible(small) {
        let first = next(last);
        let fitting = ((most - first) / step).floor().max(-1.0) as i64 + 1;
        let wrapped = wrapped(fonts, &figure.caption, Weight::Regular, small, room);
        for line in cut(wrapped, MOST_LINES.min(fitting.max(0) as usize)) {
            last = if lines.len() == 1 && last < first || last == 0.0 { first } else { last + step };
            writer.left(&line, Weight::Regular, small, palette.second_text, margin, last);
            lines.push([last, margin + fonts.width(&line, Weight::Regular, small)]);
        }
    }
    if !Scale::legible(small) {
        return last;
    }
    let [side, gap] = [SQUARE, SQUARE_GAP].map(|length| (length * scale.type_unit()).round().max(2.0));
    let one = |text: &str| side + gap + fonts.width(text, Weight::Regular, small);
    let of_flat = if has_flat { one(FLAT) + KEYS_APART * scale.unit } else { 0.0 };
    let wide = |text: &String| of_flat + one(text);
    // Beside the last line, or else a line above it.
    let beside = wordings.iter().find_map(|text| {
        let free = |line: &&[f64; 2]| line[1] + APART * scale.unit + wide(text) <= width - margin;
        lines.iter().rev().find(free).map(|line| (text, line[0], width - margin - wide(text)))
    });
    let below = || {
        let baseline = next(last);
        let text = wordings.iter().find(|text| wide(text) <= room && baseline < most)?;
        Some((text, baseline, if lines.is_empty() { width - margin - wide(text) } else { margin }))
    };
    if let Some((text, baseline, left)) = beside.or_else(below) {
        let top = (baseline - 0.36 * small - side / 2.0).round();
        if has_flat {
            writer.marks.extend(hollow([left.round(), top, side, side], palette));
            writer.left(FLAT, Weight::Regular, small, palette.second_text, left + side + gap, baseline);
        }
        let left = left + of_flat;
        let rectangle = [left.round(), top, side, side];
        writer.marks.push(struck(rectangle, palette));
        writer.left(text, Weight::Regular, small, palette.second_text, left + side + gap, baseline);
        last = last.max(baseline);
    }
    last
}
