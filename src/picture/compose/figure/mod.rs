//! Figures: pictures of several scenes on one sheet.

mod forces;
mod labels;
mod sheet;

use crate::moments::Moments;
use crate::picture::Picture;
use crate::picture::caption::Writer;
use crate::picture::text::Weight;
use crate::scene::figure::{Content, Figure};

/// Composes a figure from what was simulated for it.
///
/// # Panics
/// If `moments` are those of another figure.
pub fn compose_figure(figure: &Figure, moments: &Moments) -> Picture {
    match &figure.content {
        Content::Sheet(sheet) => sheet::compose(figure, sheet, moments),
        Content::Forces(forces) => forces::compose(figure, forces),
    }
}

/// Baselines of a figure's title and caption, and what is free below each (px in the reference picture).
const TITLE: f64 = 58.0;
const CAPTION: f64 = 26.0;
const BELOW: f64 = 14.0;

/// Title and caption of a figure.
struct Header {
    /// Where they end (px); 0 if there are none.
    bottom: f64,
}

/// Writes title and caption at the top.
fn header(writer: &mut Writer<'_>, figure: &Figure) -> Header {
    let (scale, palette) = (writer.scale, writer.palette);
    let left = scale.margin();
    let room = f64::from(figure.size[0]) - 2.0 * left;
    let mut baseline = 0.0;
    for (text, weight, size, colour, below) in [
        (&figure.title, Weight::SemiBold, 1.16 * scale.title(), palette.text, TITLE),
        (&figure.caption, Weight::Regular, scale.caption(), palette.second_text, CAPTION),
    ] {
        if !text.is_empty() {
            baseline += if baseline == 0.0 { scale.row(TITLE) } else { scale.of_type(below) * scale.unit };
            let text = writer.fonts.shortened(text, weight, size, room);
            writer.left(&text, weight, size, colour, left, baseline);
        }
    }
    Header { bottom: if baseline > 0.0 { baseline + BELOW * scale.unit } else { 0.0 } }
}
