//! Elements read from lists of nodes into the records that laws take.

use super::{Corners, Element, Law, RECORD, constants};
use crate::body::Body;
use crate::gather::Group;
use crate::lanes::{Lanes, MOST};
use crate::lists::IndexLists;
use glam::DVec3;
use std::mem::take;
use std::ops::Range;

/// The first elements of a range with the same number of corners, and their number.
#[inline(always)]
pub(crate) fn alike<L: Lanes>(elements: &IndexLists, range: Range<usize>) -> (Group<'_>, usize) {
    let corners = elements[range.start].len();
    Group::take::<L>(range, |element| &elements[element], |element| elements[element].len() == corners)
}

/// Elements with the same number of corners, one in each lane.
pub(crate) struct Reader<L> {
    corners: usize,
    offsets: Vec<u32>,
    now: Vec<f64>,
    rest: Vec<f64>,
    /// As in [`Element`], in rows of [`MOST`].
    constants: Vec<f64>,
    pub(crate) memory: Vec<[f64; MOST]>,
    of_element: Vec<L>,
    of_corner: Vec<L>,
}

impl<L: Lanes> Reader<L> {
    pub(crate) fn new() -> Self {
        Self {
            corners: 0,
            offsets: Vec::new(),
            now: Vec::new(),
            rest: Vec::new(),
            constants: Vec::new(),
            memory: Vec::new(),
            of_element: Vec::new(),
            of_corner: Vec::new(),
        }
    }

    /// Reads elements at rest, and with positions (m) and velocities (m/s) of the nodes; without velocities they are at rest.
    /// `parts` are the relative stiffnesses of the elements.
    pub(crate) fn read(
        &mut self,
        group: &Group<'_>,
        body: &Body,
        position: &[DVec3],
        velocity: Option<&[DVec3]>,
        parts: &[f64; MOST],
    ) {
        self.corners = group.corners();
        let rows = self.corners * MOST;
        if self.offsets.len() < rows {
            self.offsets.extend((self.offsets.len()..rows).map(|row| (row * RECORD) as u32));
            self.now.resize(rows * RECORD, 0.0);
            self.rest.resize(rows * RECORD, 0.0);
        }
        for corner in 0..self.corners {
            for (lane, &part) in parts.iter().enumerate().take(L::WIDTH) {
                let node = group.node(lane, corner);
                let (at, p, r) = ((corner * MOST + lane) * RECORD, position[node], body.rest[node]);
                let v = velocity.map_or(DVec3::ZERO, |velocity| velocity[node]);
                self.now[at..][..6].copy_from_slice(&[p.x, p.y, v.x, v.y, p.z, v.z]);
                self.rest[at..][..RECORD].copy_from_slice(&[r.x, r.y, 0.0, 0.0, r.z, 0.0, part, body.mass[node]]);
            }
        }
    }

    /// Computes the constants of a law, and returns them.
    #[inline(always)]
    pub(crate) fn prepare<W: Law>(&mut self, law: &W) -> &[f64] {
        let zero = L::splat(0.0);
        self.of_element.clear();
        self.of_element.resize(W::OF_ELEMENT, zero);
        self.of_corner.clear();
        self.of_corner.resize(self.corners * W::OF_CORNER, zero);
        // Apart from the vector that is borrowed.
        let (mut of_element, mut of_corner) = (take(&mut self.of_element), take(&mut self.of_corner));
        law.prepare(&self.rest(), &mut of_element, &mut of_corner);
        self.constants.clear();
        for value in of_corner.iter().chain(&of_element) {
            self.constants.extend_from_slice(&value.to_array());
        }
        (self.of_element, self.of_corner) = (of_element, of_corner);
        &self.constants
    }

    /// Reads the memory of `count` elements from one on.
    pub(crate) fn recall(&mut self, memory: &[f64], first: usize, count: usize, width: usize) {
        self.memory.clear();
        self.memory.resize(width, [0.0; MOST]);
        for (entry, row) in self.memory.iter_mut().enumerate() {
            for lane in 0..L::WIDTH {
                row[lane] = memory[(first + lane.min(count - 1)) * width + entry];
            }
        }
    }

    /// The corners now.
    #[inline(always)]
    pub(crate) fn now(&self) -> Corners<'_, L> {
        // SAFETY: the vectors have these offsets and records.
        unsafe { Corners::new(self.now.as_ptr(), self.offsets.as_ptr(), self.corners) }
    }

    /// The elements at rest.
    #[inline(always)]
    pub(crate) fn rest(&self) -> Corners<'_, L> {
        // SAFETY: as above.
        unsafe { Corners::new(self.rest.as_ptr(), self.offsets.as_ptr(), self.corners) }
    }

    /// The first `count` lanes now and at rest, for a law whose constants are prepared and whose memory is recalled.
    #[inline(always)]
    pub(crate) fn elements<W: Law>(&mut self, count: usize) -> (Element<'_, L>, Corners<'_, L>) {
        assert!(self.memory.len() == W::MEMORY && self.constants.len() == constants::<W>(self.corners) * MOST);
        let (constants, memory) = (self.constants.as_ptr(), self.memory.as_mut_ptr().cast());
        // SAFETY: there are as many rows.
        let element = unsafe { Element::new::<W>(self.now(), constants, memory, true, (1 << count) - 1, None) };
        (element, self.rest())
    }
}
