//! The corners of elements in lanes.

use super::lanes::{Lanes, MOST, each};
use glam::DVec3;
use std::ops::Range;

/// Consecutive elements that are alike, one in each lane. The last element fills the lanes that are left.
pub(super) struct Group<'a> {
    nodes: [&'a [u32]; MOST],
}

impl<'a> Group<'a> {
    /// The first elements of a range that are like its first one, and their number. Elements that are alike have the
    /// same number of corners.
    #[inline(always)]
    pub(super) fn take<L: Lanes>(
        range: Range<usize>,
        nodes_of: impl Fn(usize) -> &'a [u32],
        is_alike: impl Fn(usize) -> bool,
    ) -> (Self, usize) {
        let first = range.start;
        let mut count = 1;
        while count < L::WIDTH.min(range.len()) && is_alike(first + count) {
            count += 1;
        }
        (Self::of(|lane| nodes_of(first + lane.min(count - 1))), count)
    }

    /// The elements with these nodes, one for each lane.
    #[inline(always)]
    pub(super) fn of(nodes: impl Fn(usize) -> &'a [u32]) -> Self {
        Self { nodes: each!(8, lane => nodes(lane)) }
    }

    /// The number of corners of each element.
    #[inline(always)]
    pub(super) fn corners(&self) -> usize {
        self.nodes[0].len()
    }

    /// The node at a corner of the element in a lane.
    #[inline(always)]
    pub(super) fn node(&self, lane: usize, corner: usize) -> usize {
        self.nodes[lane][corner] as usize
    }

    /// A vector of the same corner of each element.
    #[inline(always)]
    pub(super) fn vector<L: Lanes>(&self, corner: usize, values: &[DVec3]) -> [L; 3] {
        let mut arrays = [[0.0; MOST]; 3];
        for lane in 0..L::WIDTH {
            let value = values[self.nodes[lane][corner] as usize].to_array();
            (arrays[0][lane], arrays[1][lane], arrays[2][lane]) = (value[0], value[1], value[2]);
        }
        each!(3, axis => L::from_array(arrays[axis]))
    }
}
