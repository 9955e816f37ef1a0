//! Figures: pictures of several scenes on one sheet.

mod forces;
mod header;
mod labels;
mod sheet;

use crate::picture::Picture;
use crate::runner::moments::Moments;
use crate::scene::figure::{Content, Figure};

/// There is no room for a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no room for what the figure shows; draw it larger or with fewer scenes")]
pub(crate) struct NoRoom;

/// Composes a figure from what was simulated for it.
///
/// # Errors
/// If the figure is too small for all that it shows.
///
/// # Panics
/// If `moments` are those of another figure.
pub(crate) fn compose_figure(figure: &Figure, moments: &Moments) -> Result<Picture, NoRoom> {
    match &figure.content {
        Content::Sheet(sheet) => Ok(sheet::compose(figure, sheet, moments)),
        Content::Forces(forces) => forces::compose(figure, forces, moments),
    }
}
