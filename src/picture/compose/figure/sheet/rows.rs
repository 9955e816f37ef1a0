//! The names and notes of the rows of a sheet.

use crate::picture::caption::Writer;
use crate::picture::chart::style;
use crate::picture::layout::tree::{Node, Solved};
use crate::picture::layout::{Part, Scale};
use crate::picture::number;
use crate::picture::text::Weight;
use crate::picture::wrap::wrapped;
use crate::scene::figure::{Row, Sheet};

/// The largest width of names and notes relative to the picture, for long words the second one.
const WIDEST: [f64; 2] = [0.125, 0.25];

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
    pub(super) fn new(sheet: &Sheet, writer: &Writer<'_>, with_sample: bool, picture: f64) -> Self {
        let (fonts, scale) = (writer.fonts, writer.scale);
        let words = sheet.rows.iter().flat_map(|row| row.label.split_whitespace());
        let longest = words.map(|word| fonts.width(word, Weight::SemiBold, scale.caption())).fold(0.0, f64::max);
        let [usual, widest] = WIDEST.map(|share| share * picture);
        let room = usual.max(longest.ceil()).min(widest.max(usual));
        let moment = number::moments(sheet.rows.iter().filter_map(|row| row.time));
        let mut width: f64 = 0.0;
        let mut lines = |text: &str, weight, size| {
            let lines = wrapped(fonts, text, weight, size, room);
            width = lines.iter().map(|line| fonts.width(line, weight, size)).fold(width, f64::max);
            lines
        };
        let row = |row: &Row| {
            let own = row.time.filter(|_| row.note.is_empty()).map(&moment);
            let note = own.as_deref().unwrap_or(&row.note);
            [lines(&row.label, Weight::SemiBold, scale.caption()), lines(note, Weight::Regular, scale.small())]
        };
        Self { rows: sheet.rows.iter().map(row).collect(), with_sample, width }
    }

    /// The boxes beside a row, around the middle of its bodies.
    pub(super) fn boxes(&self, row: usize, scale: Scale) -> Vec<Node<Part>> {
        let edge = || Node::new(Part::Edge, 0.0).stretched();
        let lines = |part: Part, count: usize| (0..count).map(move |_| part.line(scale));
        let [label, note] = self.rows[row].each_ref().map(Vec::len);
        let words = lines(Part::Label(row), label).chain(lines(Part::Sample(row), self.with_sample.into()));
        let words = words.chain(lines(Part::Note(row), note));
        let below = Node::new(Part::Edge, Part::Numbers.height(scale)).least(0.0);
        std::iter::once(edge()).chain(words).chain([edge(), below]).collect()
    }

    /// Writes the words beside all rows, as far as there is room.
    pub(super) fn write(&self, writer: &mut Writer<'_>, page: &Solved<Part>, sheet: &Sheet) {
        let (scale, palette) = (writer.scale, writer.palette);
        let Some([left, ..]) = page.get(Part::Words) else { return };
        for (row, [label, note]) in self.rows.iter().enumerate() {
            writer.lines(page, Part::Label(row), scale, label, left);
            writer.lines(page, Part::Note(row), scale, note, left);
            let found = sheet.scenes.first().and_then(|scene| {
                let run = scene.runs.iter().position(|run| run.name == sheet.rows[row].run)?;
                Some(style(&sheet.charts, run, scene, palette))
            });
            if let Some(([_, top, _, height], line)) = page.get(Part::Sample(row)).zip(found) {
                writer.sample([left, top + 0.5 * height], line);
            }
        }
    }
}
