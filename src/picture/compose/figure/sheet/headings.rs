//! The headings of the columns of a sheet.

use crate::picture::caption::{self, Writer};
use crate::picture::layout::Scale;
use crate::picture::number;
use crate::picture::text::{Fonts, Weight};
use crate::picture::wrap::wrapped;
use crate::scene::figure::Sheet;

/// The distance of two lines of a heading, the gap between a column's letter and its lines, and the gap between columns
/// (px in the reference picture).
pub(super) const HEADING_LINE: f64 = 20.0;
const LETTER_GAP: f64 = 10.0;
const HEADINGS_APART: f64 = 14.0;

/// The heading of a column.
pub(super) struct Heading {
    /// The letter; empty for none.
    letter: String,
    /// The lines beside the letter.
    pub(super) lines: Vec<String>,
}

impl Heading {
    /// The headings of all columns, which are `pitch` apart (px); none if not all fit.
    pub(super) fn all(sheet: &Sheet, writer: &Writer<'_>, pitch: f64, with_charts: bool) -> Vec<Self> {
        let (scale, fonts) = (writer.scale, writer.fonts);
        let size = scale.caption();
        let apart = HEADINGS_APART * scale.unit;
        let count = sheet.columns.len();
        let times = || sheet.columns.iter().filter_map(|column| column.time);
        let moment = number::moments(times());
        // A time is left out if every row replaces it.
        let replaced = sheet.rows.iter().all(|row| row.time.is_some());
        let text = |at: usize| {
            let column = &sheet.columns[at];
            let own = column.time.filter(|_| !replaced).map(&moment);
            // Columns of several scenes, such as one body with several seeds, have the names of their scenes.
            let scene = sheet.scenes.get(column.scene).map(|scene| scene.name.clone());
            let own: Vec<_> = scene.filter(|_| sheet.scenes.len() > 1).into_iter().chain(own).collect();
            column.label.clone().unwrap_or_else(|| own.join(", "))
        };
        let letter = |at: usize| if count > 1 || with_charts { caption::letter(at) } else { String::new() };
        let all = (0..count).map(|at| {
            let letter = letter(at);
            let beside = beside_letter(&letter, fonts, scale);
            let room = pitch - apart - beside;
            let lines = wrapped(fonts, &text(at), Weight::Regular, size, room.max(0.0));
            let lines = lines.into_iter().filter(|line| !line.is_empty()).collect();
            Self { letter, lines }
        });
        let mut all: Vec<_> = all.collect();
        let wide = |text: &str| fonts.width(text, Weight::Regular, size);
        let fits = |heading: &Self| {
            let room = pitch - apart - beside_letter(&heading.letter, fonts, scale);
            let whole = |line: &String| wide(line) <= room && line.chars().count() > 1 || wide(line) <= 0.0;
            heading.lines.is_empty() || heading.lines.len() <= 2 && heading.lines.iter().all(whole)
        };
        if !all.iter().all(fits) {
            // Labels are shortened to one line each; moments are left out.
            let least = 4.0 * size;
            for (at, heading) in all.iter_mut().enumerate() {
                let room = pitch - apart - beside_letter(&heading.letter, fonts, scale);
                let label = sheet.columns[at].label.as_deref().filter(|_| room >= least).unwrap_or_default();
                let short = fonts.shortened(label, Weight::Regular, size, room.max(0.0));
                heading.lines = if short.is_empty() { Vec::new() } else { vec![short] };
            }
        }
        let letters_fit = |heading: &Self| fonts.width(&heading.letter, Weight::SemiBold, size) + 2.0 <= pitch;
        let has_lines = all.iter().any(|heading| !heading.lines.is_empty());
        if !Scale::legible(size) || !all.iter().all(letters_fit) && !has_lines {
            return Vec::new();
        }
        for heading in &mut all {
            // A letter alone still takes a line.
            if heading.lines.is_empty() && !heading.letter.is_empty() {
                heading.lines.push(String::new());
            }
        }
        all
    }

    /// Writes the heading from a left end and a first baseline (px).
    pub(super) fn write(&self, writer: &mut Writer<'_>, [left, baseline]: [f64; 2]) {
        let (scale, palette) = (writer.scale, writer.palette);
        writer.left(&self.letter, Weight::SemiBold, scale.caption(), palette.text, left, baseline);
        let left = left + beside_letter(&self.letter, writer.fonts, scale);
        for (at, line) in self.lines.iter().enumerate() {
            let baseline = baseline + at as f64 * HEADING_LINE * scale.type_unit();
            writer.left(line, Weight::Regular, scale.caption(), palette.second_text, left, baseline);
        }
    }
}

/// The width of a letter with its gap (px).
fn beside_letter(letter: &str, fonts: &Fonts, scale: Scale) -> f64 {
    if letter.is_empty() {
        return 0.0;
    }
    fonts.width(letter, Weight::SemiBold, scale.caption()) + LETTER_GAP * scale.unit
}
