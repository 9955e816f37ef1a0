//! The flat ends of a surface, to which the lattice of a fill is fitted.

use super::Fill;
use crate::{Measures, Surface};
use glam::DVec3;

/// Both ends of a box are flat if faces there are at least this part of it across an axis. Of 115 closed meshes of other projects, eight
/// change from .1 to .75 with 15 cells. Tetrahedra of a joint lose .4 % of its volume at .25, and 1.4 % at .5, those of a U 2.7 % up to .5
/// and 6.7 % at .75. At .1, polyhedra of an anchor fill 3.6 % too much in place of .7 %, with two fifths more of them. I-beams, the hare and
/// cylinders are alike with all four.
const FLAT: f64 = 0.25;
/// Points nearer than this to an end, in sides, are on it.
const ON: f64 = 1e-6;

/// The size of a surface, and across which axes it ends in flat faces to which the lattice of a fill is fitted.
pub(super) struct Ends {
    pub(super) measures: Measures,
    is_flat: [bool; 3],
}

impl Ends {
    pub(super) fn new(surface: &Surface, fill: Fill) -> Self {
        let measures = surface.measures();
        let size = measures.high - measures.low;
        let is_flat = [0, 1, 2].map(|axis| {
            let across = size.element_product() / size[axis];
            let is_end = |end: f64| at(surface, axis, end, ON * fill.side()) >= FLAT * across;
            fill.is_cut() && is_end(measures.low[axis]) && is_end(measures.high[axis])
        });
        Self { measures, is_flat }
    }

    /// The sides of its box (m).
    pub(super) fn size(&self) -> DVec3 {
        self.measures.high - self.measures.low
    }

    /// The size as it is filled with elements of a side (m), with as large an area as may be.
    pub(super) fn stretched(&self, side: f64) -> Measures {
        let (Measures { volume, area, low, high, .. }, stretch) = (self.measures, self.stretch(side));
        let all = stretch.element_product();
        let [low, high] = [low, high].map(|end| stretch * end);
        Measures { volume: all * volume, area: all / stretch.min_element() * area, low, high, ..self.measures }
    }

    /// The factors by which the surface is stretched along the axes. Elements are shorter for it, and as nearly cubes as they can be.
    pub(super) fn stretch(&self, side: f64) -> DVec3 {
        let size = self.size();
        // A body thinner than an element keeps its lattice: elements as thin would be flat, or too many.
        let is_flat = |axis: usize| self.is_flat[axis] && size[axis] >= side;
        let along = |axis: usize, cell: f64| match is_flat(axis) {
            // Nodes stand outside by a part of the cell, which is no longer than the side.
            true => size[axis] / (size[axis] / cell).round().max((size[axis] / side - ON).ceil()),
            false => cell,
        };
        let cells = |cell: f64| [0, 1, 2].map(|axis| along(axis, cell));
        let uneven = |cell: f64| cells(cell).into_iter().map(|own| (own / cell).max(cell / own)).fold(1.0, f64::max);
        let chosen = (0..3)
            .filter(|&axis| is_flat(axis))
            .map(|axis| along(axis, side))
            .min_by(|one, other| uneven(*one).total_cmp(&uneven(*other)));
        let Some(cell) = chosen else { return DVec3::ONE };
        let stretch = DVec3::from_array(cells(cell).map(|own| side / own));
        if (stretch - DVec3::ONE).abs().max_element() < ON { DVec3::ONE } else { stretch }
    }
}

/// The area of the faces of a surface that lie across an axis at a place, up to a distance from it.
fn at(surface: &Surface, axis: usize, place: f64, near: f64) -> f64 {
    let is_there = |corner: &DVec3| (corner[axis] - place).abs() <= near;
    let faces = surface.triangles.iter().map(|&of| surface.corners(of)).filter(|corners| corners.iter().all(is_there));
    faces.map(|[a, b, c]| 0.5 * (b - a).cross(c - a)[axis].abs()).sum()
}
