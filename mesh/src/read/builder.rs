//! Points and cells while a file is read.

mod finish;

pub(super) use finish::beyond;

use super::cells::along;
use super::source::{Coding, Source};
use super::{CellKind, Cells, Limits, ReadError};
use glam::DVec3;
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

/// What VTK tells of a point or a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Ghost {
    /// It is one of this piece.
    #[default]
    None,
    /// It is a copy of one in another piece.
    Copy,
    /// It is no part of the body.
    Hidden,
}

/// A dimension and the number of a set of points.
type Key = (i64, i64);

/// Cells while they are read.
#[derive(Debug, Default)]
pub(super) struct Builder {
    pub(super) cells: Cells,
    /// What VTK tells of the first points and cells.
    ghosts: [Vec<Ghost>; 2],
    groups: BTreeMap<String, Vec<u32>>,
    /// Sets of points by their numbers, and the names of some of them.
    numbered: BTreeMap<Key, Vec<u32>>,
    pub(super) set_names: HashMap<Key, String>,
    /// The number of points in all sets that the file does not list one by one.
    grouped: usize,
    most_points: usize,
    /// The most corners of all cells.
    pub(super) most_corners: usize,
    /// Whether cells of higher order gave their corners only.
    pub(super) is_curved: bool,
    /// The number of polyhedra that are not convex.
    pub(super) concave: usize,
    /// The highest index of a corner, and the place where it was found. Points may follow the cells that name them.
    highest: (u32, usize),
    /// The points without coordinates, and the places where they were found.
    lost: Vec<(u32, usize)>,
    /// The names of cells from now on, of three kinds, and the first cell that has them.
    names: [(Vec<String>, usize); 3],
    /// The cells of each name.
    named: BTreeMap<String, Vec<Range<usize>>>,
}

impl Builder {
    pub(super) fn new(limits: &Limits) -> Self {
        Self { most_points: limits.points, most_corners: limits.corners, ..Self::default() }
    }

    pub(super) fn points(&self) -> usize {
        self.cells.points.len()
    }

    /// Whether there are no cells so far.
    pub(super) fn is_empty(&self) -> bool {
        self.cells.kinds.is_empty()
    }

    /// Refuses numbers of points and cells beyond the limits, before they are read.
    pub(super) fn expect(&self, points: u64, cells: u64) -> Result<(), ReadError> {
        for (count, most, what) in [(points, self.most_points, "points"), (cells, self.most_corners / 3, "cells")] {
            if count > most as u64 {
                return Err(too_many(&count.to_string(), what, most));
            }
        }
        Ok(())
    }

    /// Adds a point, and returns its index.
    pub(super) fn point(&mut self, point: DVec3) -> Result<u32, ReadError> {
        /// Coordinates beyond this are not lengths, and products of them would overflow.
        const FAR: f64 = 1e100;
        let index = self.cells.points.len();
        if !(point.abs().max_element() <= FAR && point.is_finite()) {
            let [x, y, z] = point.to_array();
            let message = format!("has point {index} at [{x:?}, {y:?}, {z:?}]; expected coordinates up to 1e100");
            return Err(ReadError::damaged(message));
        }
        let most = self.most_points.min(u32::MAX as usize - 1);
        if index >= most {
            return Err(too_many(&format!("more than {most}"), "points", most));
        }
        self.cells.points.push(point);
        Ok(index as u32)
    }

    /// Adds a point that was found at a place. Programs write some that no cell names without coordinates: those are left out.
    pub(super) fn point_at(&mut self, point: DVec3, at: usize) -> Result<u32, ReadError> {
        if point.is_finite() {
            return self.point(point);
        }
        self.lost.push((self.points() as u32, at));
        self.point(DVec3::ZERO)
    }

    /// Tells of what is left behind the points and faces that a header counts.
    pub(super) fn tell_rest(&mut self, source: &mut Source<'_>) {
        if source.coding == Coding::Text {
            if !source.is_done() {
                let place = source.place(source.at);
                self.cells.notes.push(format!("has more than its header counts, which begins {place} and is not read"));
            }
        // Files may end with zeros or with the end of a line.
        } else if source.rest().iter().any(|byte| !byte.is_ascii_whitespace() && *byte != 0) {
            let rest = source.rest().len();
            self.cells.notes.push(format!("has {rest} bytes more than its header counts, which are not read"));
        }
    }

    /// The index of a point, counted from 0, that was found at a place.
    pub(super) fn corner(&mut self, index: i64, at: usize, source: &Source<'_>) -> Result<u32, ReadError> {
        let corner = u32::try_from(index)
            .map_err(|_| ReadError::damaged(format!("names a point that it does not have {}", source.place(at))))?;
        if corner > self.highest.0 {
            self.highest = (corner, at);
        }
        Ok(corner)
    }

    pub(super) fn cell(&mut self, kind: CellKind, corners: &[u32]) -> Result<(), ReadError> {
        let most = self.most_corners.min(u32::MAX as usize - 1);
        if corners.is_empty() {
            return Ok(());
        }
        if self.cells.corners.indices().len() + corners.len() > most {
            return Err(too_many(&format!("more than {most}"), "corners", most));
        }
        self.cells.kinds.push(kind);
        self.cells.corners.push(corners);
        Ok(())
    }

    /// Adds a cell whose corners, if it is a hexahedron, are listed around one side and then around the other.
    pub(super) fn around(&mut self, kind: CellKind, corners: &[u32]) -> Result<(), ReadError> {
        match corners.try_into() {
            Ok(all) if kind == CellKind::Hexahedron => self.cell(kind, &along(all)),
            _ => self.cell(kind, corners),
        }
    }

    /// Adds a polygon, or what is left of one with less than three corners.
    pub(super) fn face(&mut self, corners: &[u32]) -> Result<(), ReadError> {
        let kind = match corners.len() {
            1 => CellKind::Point,
            2 => CellKind::Line,
            _ => CellKind::Polygon,
        };
        self.cell(kind, corners)
    }

    pub(super) fn strip(&mut self, corners: &[u32]) -> Result<(), ReadError> {
        for (at, triangle) in corners.windows(3).enumerate() {
            let [a, b, c] = [triangle[0], triangle[1], triangle[2]];
            self.face(&if at.is_multiple_of(2) { [a, b, c] } else { [b, a, c] })?;
        }
        Ok(())
    }

    /// Adds points to the set of this name.
    pub(super) fn group(&mut self, name: String, points: Vec<u32>) {
        self.groups.entry(name).or_default().extend(points);
    }

    /// Refuses sets with very many members, of which so many are added.
    pub(super) fn spend(&mut self, members: usize) -> Result<(), ReadError> {
        let most = self.most_corners.saturating_mul(4);
        self.grouped = self.grouped.saturating_add(members);
        if self.grouped > most {
            let message = format!("has groups with more than {most} nodes");
            return Err(ReadError::new(message, "put each element into one group or few"));
        }
        Ok(())
    }

    /// Adds points to the set of a number, which names it unless `set_names` does.
    pub(super) fn number(&mut self, set: Key, points: &[u32]) -> Result<(), ReadError> {
        self.spend(points.len())?;
        self.numbered.entry(set).or_default().extend(points);
        Ok(())
    }

    /// Gives cells from now on other names of a kind, 0 to 2. Their points become groups.
    pub(super) fn name(&mut self, kind: usize, names: Vec<String>) {
        let now = self.cells.kinds.len();
        let (before, start) = std::mem::replace(&mut self.names[kind], (names, now));
        for name in before.into_iter().filter(|name| start < now && !name.is_empty()) {
            self.named.entry(name).or_default().push(start..now);
        }
    }

    /// Tells what the points from an index on are.
    pub(super) fn ghosts(&mut self, from: usize, ghosts: Vec<Ghost>) {
        self.ghosts[0].resize(from, Ghost::None);
        self.ghosts[0].extend(ghosts);
    }

    /// Tells what cells of the file are, if anything, by the first cell that each became.
    pub(super) fn ghosts_of_cells(&mut self, starts: &[usize], ghosts: &[Ghost]) {
        let ends = starts.iter().skip(1).copied().chain([self.cells.kinds.len()]);
        for ((&start, end), &ghost) in starts.iter().zip(ends).zip(ghosts) {
            self.ghosts[1].resize(start, Ghost::None);
            self.ghosts[1].resize(end, ghost);
        }
    }
}

pub(super) fn too_many(found: &str, what: &str, most: usize) -> ReadError {
    let message = format!("has {found} {what}; at most {most} are read");
    ReadError::new(message, "make the mesh coarser, with a decimation of the program that wrote it")
}
