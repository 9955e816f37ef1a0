//! The marks of diagrams of forces: outlined arrows, smooth lines, the tint of the rest shape.

use crate::colour::{Colour, mixed};
use crate::look::Palette;
use crate::picture::Item;
use crate::picture::arrows::{HEAD, arrow, outline};
use crate::picture::layout::Scale;
use crate::picture::narrow::narrow;
use crate::picture::page::{Path, Pen, point};
use glam::DVec2;

/// Opacity of the rest shape, and of the inside and the outline of arrows for comparison.
const GHOST: f64 = 0.075;
const COMPARED: f64 = 0.16;
const OUTLINE_ALPHA: f64 = 0.75;
/// Widths of the outlines of the rest shape and of an arrow (px in the reference picture).
pub(super) const GHOST_LINE: f64 = 1.3;
const OUTLINE: f64 = 1.1;

/// The colour of the rest shape on the background.
pub(super) fn ghost_colour(palette: &Palette) -> Colour {
    mixed(palette.background, palette.edge_on_ground(), GHOST)
}

/// An arrow of the run for comparison: faintly filled, with an outline.
pub(super) fn outlined(ends: [DVec2; 2], scale: Scale, colour: Colour, ground: Colour, has_halo: bool) -> Vec<Item> {
    let (corners, _) = outline(ends, HEAD * scale.line());
    let path = Path::polygon(&corners.map(point));
    let pen = Pen::solid(narrow(OUTLINE * scale.line()));
    let fill = mixed(ground, colour, COMPARED);
    let filled = if has_halo { arrow(ends, scale.line(), fill, ground) } else { bare(ends, scale.line(), fill) };
    vec![filled, Item::stroke(path, pen, mixed(ground, colour, OUTLINE_ALPHA))]
}

/// An arrow without a halo, which would cover the lines beside it.
pub(super) fn bare(ends: [DVec2; 2], size: f64, colour: Colour) -> Item {
    let (corners, _) = outline(ends, HEAD * size);
    Item::part("arrow", [Item::fill(Path::polygon(&corners.map(point)), colour)])
}
