//! The numbers by which files name their nodes and elements.

use super::ReadError;
use super::builder::Builder;
use super::source::{DAMAGED, Source};
use glam::DVec3;
use std::collections::HashMap;

/// The index of each number of a node or an element. Most files count them one after the other.
#[derive(Clone, Default)]
pub(super) struct Tags {
    first: i64,
    from: u32,
    count: u32,
    /// The indices of numbers, once either are not consecutive.
    other: Option<HashMap<i64, u32>>,
}

impl Tags {
    pub(super) fn push(&mut self, tag: i64, index: u32) {
        if self.count == 0 {
            (self.first, self.from) = (tag, index);
        }
        let (first, from, count) = (self.first, self.from, self.count);
        if self.other.is_none() && (first.checked_add(count.into()) != Some(tag) || from + count != index) {
            self.other = Some((0..count).map(|at| (first + i64::from(at), from + at)).collect());
        }
        if let Some(other) = &mut self.other {
            other.insert(tag, index);
        }
        self.count += 1;
    }

    pub(super) fn get(&self, tag: i64) -> Option<u32> {
        match &self.other {
            Some(other) => other.get(&tag).copied(),
            None => {
                let at = u32::try_from(tag.checked_sub(self.first)?).ok().filter(|&at| at < self.count)?;
                Some(self.from + at)
            }
        }
    }

    /// The index of a node with this number and position, which were found at a place: a new one, or that of an equal one before.
    pub(super) fn node(
        &mut self,
        tag: i64,
        point: DVec3,
        at: usize,
        source: &Source<'_>,
        builder: &mut Builder,
    ) -> Result<u32, ReadError> {
        let Some(index) = self.get(tag) else {
            let index = builder.point_at(point, at)?;
            self.push(tag, index);
            return Ok(index);
        };
        let is_equal = !point.is_finite() || builder.cells.points.get(index as usize) == Some(&point);
        if is_equal { Ok(index) } else { Err(twice("node", tag, ", at another place", source.place(at))) }
    }

    /// The index of a number that was found at a place.
    pub(super) fn find(&self, tag: i64, what: &str, at: usize, source: &Source<'_>) -> Result<u32, ReadError> {
        self.get(tag).ok_or_else(|| {
            ReadError::new(format!("names {what} {tag} {}, which it does not have", source.place(at)), DAMAGED)
        })
    }
}

/// The error of a number that was found at a place and has another meaning before.
pub(super) fn twice(what: &str, tag: i64, how: &str, place: String) -> ReadError {
    let message = format!("has {what} {tag} again {place}{how}; expected each number once");
    ReadError::new(message, format!("remove one of the two, or give each {what} a number of its own"))
}
