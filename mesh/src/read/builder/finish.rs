//! What is left out at the end of a file, and checks of the rest.

use super::super::source::Source;
use super::super::used::{NONE, Used};
use super::super::{Cells, ReadError};
use super::{Builder, Ghost};
use crate::Group;
use std::ops::Range;

impl Builder {
    /// Takes copies of cells out, with the points that are copies, and leaves out what is no part of the body.
    fn drop_ghosts(&mut self) {
        let [points, cells] = std::mem::take(&mut self.ghosts);
        let of = |all: &[Ghost], at: usize| all.get(at).copied().unwrap_or_default();
        let (kinds, corners) = (std::mem::take(&mut self.cells.kinds), std::mem::take(&mut self.cells.corners));
        for (at, (kind, cell)) in kinds.into_iter().zip(corners.iter()).enumerate() {
            let is_hidden = cell.iter().any(|&point| of(&points, point as usize) == Ghost::Hidden);
            match of(&cells, at) {
                Ghost::Copy => self.cells.copies.push(cell),
                Ghost::None if !is_hidden => {
                    self.cells.kinds.push(kind);
                    self.cells.corners.push(cell);
                }
                _ => {}
            }
        }
        let copies = (0..).zip(&points).filter(|(_, ghost)| **ghost == Ghost::Copy);
        copies.for_each(|(point, _)| self.cells.copies.push(&[point]));
    }

    /// Leaves points without coordinates out, if no cell names them.
    fn drop_lost(&mut self, source: &Source<'_>, first: u64) -> Result<(), ReadError> {
        let cells = &mut self.cells;
        let named = Used::new(cells.points.len(), cells.corners.indices());
        if let Some(&(index, at)) = self.lost.iter().find(|(index, _)| named.new[*index as usize] != NONE) {
            let (index, place) = (u64::from(index) + first, source.place(at));
            let message =
                format!("has point {index} without coordinates {place}, and a face with it; expected numbers");
            return Err(ReadError::new(message, "remove its faces, or write the file again"));
        }
        let mut new = vec![0; cells.points.len()];
        self.lost.iter().for_each(|(index, _)| new[*index as usize] = NONE);
        let kept = Used::numbered(new);
        cells.notes.push(match self.lost.len() {
            1 => "has a point without coordinates, which is left out".to_owned(),
            lost => format!("has {lost} points without coordinates, which are left out"),
        });
        cells.points = kept.of(&cells.points);
        cells.velocities = cells.velocities.take().map(|all| kept.of(&all));
        cells.displacements = cells.displacements.take().map(|all| kept.of(&all));
        cells.rename(&kept.new);
        let renamed = |list: &[u32]| -> Vec<u32> { list.iter().map(|&point| kept.new[point as usize]).collect() };
        let copies = std::mem::take(&mut cells.copies);
        copies.iter().map(renamed).filter(|list| !list.contains(&NONE)).for_each(|list| cells.copies.push(&list));
        for points in self.groups.values_mut() {
            *points = renamed(points);
            points.retain(|&point| point != NONE);
        }
        Ok(())
    }

    /// All cells, if each names points that are there. Errors count points from `first`.
    pub(in crate::read) fn finish(mut self, source: &Source<'_>, first: u64) -> Result<Cells, ReadError> {
        let count = self.cells.points.len();
        if !self.cells.corners.indices().is_empty() && self.highest.0 as usize >= count {
            let (index, place) = (u64::from(self.highest.0) + first, source.place(self.highest.1));
            return Err(beyond(format!("{index} {place}"), first, count as u64));
        }
        for (set, points) in std::mem::take(&mut self.numbered) {
            let kind = ["point", "curve", "surface", "volume"].get(set.0 as usize).copied().unwrap_or("group");
            let name = self.set_names.get(&set).cloned().unwrap_or_else(|| format!("{kind} {}", set.1));
            self.group(name, points);
        }
        if self.is_curved {
            let note = "has cells of higher order, of which the corners are read: their edges become straight";
            self.cells.notes.push(note.to_owned());
        }
        if self.concave > 0 {
            let what = "has polyhedra that are not convex, which become the hulls of their points";
            self.cells.notes.push(format!("{what}: {}", self.concave));
        }
        // Some pieces may have none.
        self.cells.velocities = self.cells.velocities.filter(|all| all.len() == count);
        self.cells.displacements = self.cells.displacements.filter(|all| all.len() == count);
        if self.ghosts.iter().flatten().any(|&ghost| ghost != Ghost::None) {
            self.drop_ghosts();
        }
        if !self.lost.is_empty() {
            self.drop_lost(source, first)?;
        }
        (0..self.names.len()).for_each(|kind| self.name(kind, Vec::new()));
        let (count, corners) = (self.cells.points.len(), &self.cells.corners);
        let of = |cells: &Range<usize>| {
            &corners.indices()[corners.range(cells.start).start..corners.range(cells.end - 1).end]
        };
        let named =
            self.named.into_iter().map(|(name, cells)| (name, cells.iter().map(of).collect::<Vec<_>>().concat()));
        let groups =
            self.groups.into_iter().chain(named).map(|(name, points)| Group::new(name, points, count)).collect();
        self.cells.groups = groups;
        Ok(self.cells)
    }
}

/// The error of a point that is not one of so many from a first one.
pub(in crate::read) fn beyond(point: impl std::fmt::Display, first: u64, count: u64) -> ReadError {
    let known = match count {
        0 => "no points".to_owned(),
        _ => format!("points {first} to {}", first + count - 1),
    };
    ReadError::damaged(format!("names point {point}, but has {known}"))
}
