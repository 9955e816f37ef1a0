//! Figures: pictures of several scenes on one sheet.

mod forces;
mod header;
mod labels;
mod sheet;

use crate::moments::Moments;
use crate::picture::Picture;
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
