//! The names and notes of the rows of a sheet.

use super::sheet_layout::SheetLayout;
use crate::picture::caption::Writer;
use crate::picture::chart::style;
use crate::picture::compose::cut;
use crate::picture::layout::Scale;
use crate::picture::number;
use crate::picture::text::{Fonts, Weight};
use crate::picture::wrap::wrapped;
use crate::scene::Scene;
use crate::scene::figure::{Row, Sheet};

/// The largest width of names and notes relative to the picture, for long words the second one, and their most lines.
const WIDEST: [f64; 2] = [0.125, 0.25];
const NAME_LINES: usize = 2;
const NOTE_LINES: usize = 3;
/// Size of notes, distances of the lines of names and notes, and the distance from a name to the sample of its line and
/// on to the notes (px in the reference picture).
const NOTE: f64 = 14.0;
const NAME_LINE: f64 = 20.0;
const NOTE_LINE: f64 = 18.0;
const SAMPLE_BELOW: f64 = 13.0;
const NOTE_BELOW: f64 = 21.0;

/// The words beside the rows.
pub(super) struct RowLabels {
    /// Lines of the name and of the note of each row.
    rows: Vec<[Vec<String>; 2]>,
    /// Whether a sample of the row's line stands below its name.
    with_sample: bool,
    /// The width of all (px).
    pub(super) width: f64,
}

impl RowLabels {
    /// The words beside the rows of a sheet in a picture of a width (px).
    pub(super) fn new(sheet: &Sheet, fonts: &Fonts, scale: Scale, with_sample: bool, picture: f64) -> Self {
        let words = sheet.rows.iter().flat_map(|row| row.label.split_whitespace());
        let longest = words.map(|word| fonts.width(word, Weight::SemiBold, scale.caption())).fold(0.0, f64::max);
        let [usual, widest] = WIDEST.map(|share| share * picture);
        let room = usual.max(longest.ceil()).min(widest.max(usual));
        let note_size = NOTE * scale.type_unit();
        let lines = |text: &str, weight, size, most: usize| {
            let all = wrapped(fonts, text, weight, size, room);
            let all: Vec<_> = all.into_iter().filter(|line| !line.is_empty()).collect();
            cut(all, most)
        };
        let moment = number::moments(sheet.rows.iter().filter_map(|row| row.time));
        let one = |row: &Row| {
            let own = row.time.filter(|_| row.note.is_empty()).map(&moment);
            let note = own.as_deref().unwrap_or(&row.note);
            let name = lines(&row.label, Weight::SemiBold, scale.caption(), NAME_LINES);
            let legible = Scale::legible(note_size);
            [name, if legible { lines(note, Weight::Regular, note_size, NOTE_LINES) } else { Vec::new() }]
        };
        let rows: Vec<_> =
            if Scale::legible(scale.caption()) { sheet.rows.iter().map(one).collect() } else { Vec::new() };
        let wide = |lines: &[String], weight, size| {
            lines.iter().map(|line| fonts.width(line, weight, size)).fold(0.0, f64::max)
        };
        let widths = rows.iter().map(|[name, note]| {
            wide(name, Weight::SemiBold, scale.caption()).max(wide(note, Weight::Regular, note_size))
        });
        Self { width: widths.fold(0.0, f64::max), rows, with_sample }
    }

    /// Writes the words beside the middle of their rows' bodies, as far as there is room.
    pub(super) fn write(&self, writer: &mut Writer<'_>, layout: &SheetLayout, sheet: &Sheet) {
        let Some([left, _]) = layout.labels else { return };
        let (scale, palette) = (writer.scale, writer.palette);
        let unit = scale.type_unit();
        for (row, [name, note]) in self.rows.iter().enumerate() {
            let [_, top, _, height] = layout.tile(row, 0).map(f64::from);
            let room = height - 4.0 * scale.unit;
            let heights = |names: usize, with_sample: bool, notes: usize| {
                let sample = if with_sample { SAMPLE_BELOW } else { 0.0 };
                let notes = if notes > 0 { NOTE_BELOW + (notes - 1) as f64 * NOTE_LINE } else { 0.0 };
                (names as f64 * NAME_LINE + sample + notes) * unit
            };
            // If not all fit, first the note is left out, then the sample, then further lines of the name.
            let choices = [
                (name.len(), self.with_sample, note.len()),
                (name.len(), self.with_sample, 0),
                (name.len(), false, 0),
                (1, false, 0),
            ];
            let fitting = choices.into_iter().find(|&(names, sample, notes)| heights(names, sample, notes) <= room);
            let Some((names, with_sample, notes)) = fitting else { continue };
            let middle = top + 0.5 * (height - layout.below_body);
            let highest = top + room - heights(names, with_sample, notes);
            let mut baseline = (middle - 0.5 * heights(names, with_sample, notes)).clamp(top, highest) + 15.0 * unit;
            for line in &cut(name.clone(), names) {
                writer.left(line, Weight::SemiBold, scale.caption(), palette.text, left, baseline);
                baseline += NAME_LINE * unit;
            }
            baseline -= NAME_LINE * unit;
            if with_sample {
                baseline += SAMPLE_BELOW * unit;
                let run = |scene: &Scene| scene.runs.iter().position(|run| run.name == sheet.rows[row].run);
                if let Some((scene, run)) = sheet.scenes.first().and_then(|scene| Some((scene, run(scene)?))) {
                    writer.sample([left, baseline], style(&sheet.charts, scene.runs[run].line(palette)));
                }
            }
            baseline += NOTE_BELOW * unit;
            for line in note.iter().take(notes) {
                writer.left(line, Weight::Regular, NOTE * unit, palette.second_text, left, baseline);
                baseline += NOTE_LINE * unit;
            }
        }
    }
}
