//! Figures: pictures of several scenes on one sheet.

mod forces;
mod labels;
mod sheet;

use crate::picture::Picture;
use crate::runner::moments::Moments;
use crate::scene::figure::{Content, Figure};

/// A figure is too small for its contents.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the figure is too small for its contents; draw it larger or with fewer scenes")]
pub(crate) struct NoRoom;

/// Composes a figure from its simulated states, and tells what has no room in it.
///
/// # Errors
/// If the figure is too small for its contents.
///
/// # Panics
/// If `moments` belong to another figure.
pub(crate) fn compose_figure(figure: &Figure, moments: &Moments) -> Result<(Picture, Vec<String>), NoRoom> {
    match &figure.content {
        Content::Sheet(sheet) => Ok(sheet::compose(figure, sheet, moments)),
        Content::Forces(forces) => forces::compose(figure, forces, moments),
    }
}
