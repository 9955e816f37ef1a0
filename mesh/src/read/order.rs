//! Cells of files in the order of elements.

use super::ReadError;
use super::cells::along;
use super::collapsed::{self, FLAT};
use glam::DVec3;
use localshape_sim::geometry::volume_by_faces;
use localshape_sim::{Dimension, ElementKind, IndexLists};
use std::collections::HashSet;

/// The elements of a volume.
pub(super) struct Parts {
    dimension: Dimension,
    cells: IndexLists,
    turned: usize,
    /// Cells without area or volume: how many, and the first in the file.
    flat: (usize, usize),
    /// How many cells with a corner that is listed more than once were read as simpler ones.
    simpler: usize,
    known: HashSet<[u32; 8]>,
}

impl Parts {
    /// The parts of a volume with about this number of cells.
    pub(super) fn new(dimension: Dimension, cells: usize) -> Self {
        Self {
            dimension,
            cells: IndexLists::default(),
            turned: 0,
            flat: (0, 0),
            simpler: 0,
            known: HashSet::with_capacity(cells),
        }
    }

    /// Adds a cell, in the right order and right side out, unless it is there already: Gmsh 2.2 lists a cell once for each group. One
    /// that lists a corner more than once becomes a simpler one.
    pub(super) fn add(&mut self, at: usize, kind: ElementKind, cell: &mut [u32], points: &[DVec3]) {
        let mut sorted = cell.to_vec();
        sorted.sort_unstable();
        sorted.dedup();
        if sorted.len() <= 8 {
            let mut key = [u32::MAX; 8];
            key[..sorted.len()].copy_from_slice(&sorted);
            if !self.known.insert(key) {
                return;
            }
        }
        let (before, turned) = (self.cells.len(), self.turned);
        if sorted.len() == cell.len() {
            self.push(kind, cell, points);
        } else if self.dimension == Dimension::Space {
            for (kind, mut cell) in collapsed::simpler(kind, cell, &sorted, points) {
                self.push(kind, &mut cell, points);
            }
            self.simpler += usize::from(self.cells.len() > before);
            // Their own order says nothing about that of the file.
            self.turned = turned;
        }
        if self.cells.len() == before {
            self.flat = (self.flat.0 + 1, if self.flat.0 == 0 { at } else { self.flat.1 });
        }
    }

    /// Adds a cell with different corners, unless it has no area or volume.
    fn push(&mut self, kind: ElementKind, cell: &mut [u32], points: &[DVec3]) {
        let least = if self.dimension == Dimension::Plane { 3 } else { 4 };
        if cell.len() >= least && (kind == ElementKind::Other || self.order(kind, cell, points)) {
            self.cells.push(cell);
        }
    }

    /// Puts the corners of a cell into the expected order. Returns false if it has no area or volume.
    fn order(&mut self, kind: ElementKind, cell: &mut [u32], points: &[DVec3]) -> bool {
        let corners = || cell.iter().map(|&corner| points[corner as usize]);
        let (low, high) = (corners().reduce(DVec3::min), corners().reduce(DVec3::max));
        let size = (high.unwrap_or_default() - low.unwrap_or_default()).max_element();
        let whole = if kind == ElementKind::Polygon { size * size } else { size * size * size };
        let mut measure = volume_by_faces(kind, cell, points);
        // A cell that is listed along its axes where it should be listed around, or the other way, crosses itself: it is nearly flat.
        let other = match (kind, &*cell) {
            (ElementKind::Hexahedron, &[a, b, c, d, e, f, g, h]) => along(&[a, b, c, d, e, f, g, h]).to_vec(),
            (ElementKind::Polygon, &[a, b, c, d]) => vec![a, b, d, c],
            _ => Vec::new(),
        };
        let mut is_other = false;
        if !other.is_empty() {
            let by_other = volume_by_faces(kind, &other, points);
            if by_other.abs() > (2.0 * measure.abs()).max(FLAT * whole) {
                (measure, is_other) = (by_other, true);
                cell.copy_from_slice(&other);
            }
        }
        if measure.abs() <= FLAT * whole {
            return false;
        }
        if measure < 0.0 {
            turn(kind, cell);
        }
        // Programs list wedges from either triangle: Gmsh from the lower, VTK from the upper.
        self.turned += usize::from(is_other || measure < 0.0 && kind != ElementKind::Wedge);
        true
    }

    /// The elements, how many were turned over, and what is told of those that became simpler ones and of those that are left out.
    ///
    /// # Errors
    /// If all are left out.
    pub(super) fn finished(
        self,
        cells: &IndexLists,
        points: &[DVec3],
    ) -> Result<(IndexLists, usize, Vec<String>), ReadError> {
        let mut notes = Vec::new();
        if self.simpler > 0 {
            let what = "has cells that list a corner more than once, which are read as wedges, pyramids and tetrahedra";
            notes.push(format!("{what}: {}", self.simpler));
        }
        let (flat, first) = self.flat;
        if flat == 0 {
            return Ok((self.cells, self.turned, notes));
        }
        let what = if self.dimension == Dimension::Plane { "area" } else { "volume" };
        // Files number points and cells in ways of their own.
        let places = cells[first].iter().map(|&corner| points[corner as usize].to_array());
        let shown: Vec<String> = places.take(4).map(|place| format!("{place:?}")).collect();
        let corners = shown.join(", ");
        if self.cells.is_empty() {
            let message = format!("has only cells without {what}: the first has corners at {corners}");
            return Err(ReadError::new(message, "mesh the object again"));
        }
        notes.push(match flat {
            1 => format!("has a cell without {what}, which is left out: it has corners at {corners}"),
            _ => format!("has {flat} cells without {what}, which are left out: the first has corners at {corners}"),
        });
        Ok((self.cells, self.turned, notes))
    }
}

fn turn(kind: ElementKind, cell: &mut [u32]) {
    match kind {
        ElementKind::Tetrahedron => cell.swap(1, 2),
        ElementKind::Pyramid => cell.swap(1, 3),
        ElementKind::Wedge | ElementKind::Hexahedron => cell.rotate_left(cell.len() / 2),
        _ => cell.reverse(),
    }
}
