//! The headings of the columns of a sheet.

use super::sheet_layout::SheetLayout;
use crate::picture::caption::{self, Writer};
use crate::picture::layout::steps::NEAR;
use crate::picture::layout::{Part, baselines};
use crate::picture::number;
use crate::picture::text::Weight;
use crate::picture::wrap::{widest_word, wrapped};
use crate::scene::figure::{Column, Sheet};

/// The headings of all columns.
pub(super) struct Headings {
    /// The letter and the lines beside it, of each column.
    columns: Vec<(String, Vec<String>)>,
    /// The width of letters with the gap to the lines beside them (px); 0 for lines below them.
    beside: f64,
    /// Whether lines are left out, because a word is wider than its column.
    pub(super) is_cut: bool,
}

impl Headings {
    /// The headings of columns of a width (px).
    pub(super) fn new(sheet: &Sheet, writer: &Writer<'_>, pitch: f64) -> Self {
        let (scale, fonts) = (writer.scale, writer.fonts);
        let (size, count) = (Part::Heading.size(scale), sheet.columns.len());
        let moment = number::moments(sheet.columns.iter().filter_map(|column| column.time));
        // A time is left out if every row replaces it.
        let replaced = sheet.rows.iter().all(|row| row.time.is_some());
        let wide = |text: &str, weight| fonts.width(text, weight, size);
        let letters: Vec<_> = (0..count).map(caption::letter).collect();
        let widest = letters.iter().map(|letter| wide(letter, Weight::SemiBold)).fold(0.0, f64::max);
        let has_letters = (count > 1 || !sheet.charts.is_empty()) && widest < pitch;
        let text = |column: &Column| {
            let own = column.time.filter(|_| !replaced).map(&moment);
            // Columns of several scenes, such as one body with several seeds, have the names of their scenes.
            let scene = sheet.scenes.get(column.scene).filter(|_| sheet.scenes.len() > 1);
            let own: Vec<_> = scene.map(|scene| scene.name.clone()).into_iter().chain(own).collect();
            column.label.clone().unwrap_or_else(|| own.join(", "))
        };
        let texts: Vec<_> = sheet.columns.iter().map(text).collect();
        let widest_of = |text: &String| widest_word(fonts, text, Weight::Regular, size);
        let needed = texts.iter().map(widest_of).fold(0.0, f64::max);
        // Letters stand above texts that have no room beside them.
        let free = pitch - scale.gap();
        let beside = if has_letters { widest + NEAR * scale.unit } else { 0.0 };
        let is_beside = needed <= free - beside || needed > free;
        let beside = if is_beside { beside } else { 0.0 };
        let mut is_cut = false;
        let columns = texts.iter().zip(letters).map(|(text, letter)| {
            let fits = text.split_whitespace().all(|word| wide(word, Weight::Regular) <= free - beside);
            is_cut |= !fits;
            let mut lines = if fits { wrapped(fonts, text, Weight::Regular, size, free - beside) } else { Vec::new() };
            if !is_beside {
                lines.insert(0, String::new());
            }
            (if has_letters { letter } else { String::new() }, lines)
        });
        Self { columns: columns.collect(), beside, is_cut }
    }

    /// The number of lines. A letter alone takes one.
    pub(super) fn lines(&self) -> usize {
        self.columns.iter().map(|(letter, lines)| lines.len().max(usize::from(!letter.is_empty()))).max().unwrap_or(0)
    }

    /// Writes the headings above their columns.
    pub(super) fn write(&self, writer: &mut Writer<'_>, layout: &SheetLayout) {
        let (scale, palette) = (writer.scale, writer.palette);
        let Some(baseline) = baselines(&layout.page, Part::Heading, scale).next() else { return };
        let shown = baselines(&layout.page, Part::Heading, scale).count();
        for (at, (letter, lines)) in self.columns.iter().enumerate() {
            let left = f64::from(layout.tile(0, at)[0]);
            writer.left(letter, Weight::SemiBold, Part::Heading.size(scale), palette.text, left, baseline);
            // Below a letter without room for more there is nothing to cut.
            let lines = if shown == 1 && lines.first().is_some_and(String::is_empty) { &[][..] } else { lines };
            writer.lines(&layout.page, Part::Heading, scale, lines, left + self.beside);
        }
    }
}
