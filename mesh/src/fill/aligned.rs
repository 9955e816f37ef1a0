//! Lattices with planes on the flat ends of a surface.
//!
//! Where a body ends in flat faces across an axis, elements that are cut there are of other sizes than the rest. The shape-based model has
//! other stiffnesses along their axes, and tetrahedra cut off the edges between such faces.

use super::allowed::Allowed;
use super::{Fill, FillError, Filled};
use crate::Surface;
use glam::DVec3;

/// Fills a surface, stretched so that whole numbers of elements lie between its flat ends, and moves them back.
///
/// # Errors
/// Those of filling it.
pub(super) fn fill(
    mut surface: Surface,
    with: Fill,
    most: usize,
    fill: impl Fn(Surface, &Allowed) -> Result<Filled, FillError>,
) -> Result<Filled, FillError> {
    let allowed = Allowed::new(std::slice::from_ref(&surface), with, most);
    let stretch = allowed.parts[0].stretch(with.side());
    if stretch == DVec3::ONE {
        return fill(surface, &allowed);
    }
    surface.points.iter_mut().for_each(|point| *point *= stretch);
    let mut filled = fill(surface, &allowed)?;
    let Filled { cage, surface, .. } = &mut filled;
    surface.points.iter_mut().chain(&mut cage.nodes).for_each(|point| *point /= stretch);
    cage.overlap /= stretch.element_product();
    cage.volumes.iter_mut().flatten().for_each(|volume| *volume /= stretch.element_product());
    Ok(filled)
}
