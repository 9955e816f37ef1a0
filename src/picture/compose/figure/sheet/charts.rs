//! Charts below the tiles: diagnostics of all rows over the time of their scene, with the moments of the columns.

use crate::picture::caption::{self, Writer};
use crate::picture::chart::{Flag, Stack};
use crate::picture::layout::Room;
use crate::runner::history::History;
use crate::scene::figure::Sheet;

/// The largest share of the picture's width for names at the ends of curves.
const NAMES: f64 = 0.16;

/// The charts of a sheet in a picture of a width (px), with the time series of each of its scenes.
pub(super) fn stack(sheet: &Sheet, histories: &[History], writer: &Writer<'_>, width: f64) -> Stack {
    // A common label of all rows of a run replaces the run's name.
    let label = |run: &str| {
        let mut labels = sheet.rows.iter().filter(|row| row.run == run).map(|row| &row.label);
        labels.next().filter(|first| labels.all(|label| label == *first)).map_or(run, |label| label).to_owned()
    };
    let of_scenes: Vec<_> = sheet.scenes.iter().zip(histories).collect();
    Stack::new(&sheet.charts, &of_scenes, writer, NAMES * width, label)
}

/// Draws as many charts as have room, up to the last moment (s), with a line through all of them at the moment of each
/// column, with the column's letter in a ring above.
pub(super) fn draw(stack: &Stack, sheet: &Sheet, end: f64, writer: &mut Writer<'_>, room: &Room) {
    if end <= 0.0 {
        return;
    }
    let colour = writer.palette.second_text;
    let columns = sheet.columns.iter().enumerate();
    let flags = columns.filter_map(|(at, column)| Some(Flag { at: column.time?, text: caption::letter(at), colour }));
    let mut flags: Vec<_> = flags.collect();
    flags.sort_by(|one, other| one.at.total_cmp(&other.at));
    let mut curves = Writer::new(writer.palette, writer.fonts, writer.scale);
    stack.draw([writer, &mut curves], room, ([sheet.from, end], sheet.split), &flags);
    writer.marks.extend(curves.marks);
    writer.curves.extend(curves.curves);
    writer.words.extend(curves.words);
}
