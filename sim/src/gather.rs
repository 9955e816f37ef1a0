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
        let mut nodes = [nodes_of(first); MOST];
        for (lane, nodes) in nodes.iter_mut().enumerate().skip(1) {
            *nodes = nodes_of(first + lane.min(count - 1));
        }
        (Self { nodes }, count)
    }

    /// The number of corners of each element.
    #[inline(always)]
    pub(super) fn corners(&self) -> usize {
        self.nodes[0].len()
    }

    /// A number of the same corner of each element.
    #[inline(always)]
    pub(super) fn number<L: Lanes>(&self, corner: usize, values: &[f64]) -> L {
        let mut array = [0.0; MOST];
        for lane in 0..L::WIDTH {
            array[lane] = values[self.nodes[lane][corner] as usize];
        }
        L::from_array(array)
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

    /// The vectors of all corners, relative to their mean.
    #[inline(always)]
    pub(super) fn centred<L: Lanes>(&self, values: &[DVec3], centred: &mut Vec<[L; 3]>) {
        centred.clear();
        // Relative to the first corner before they are added, to keep precision far from the origin.
        let first = self.vector::<L>(0, values);
        let mut sum = [L::splat(0.0); 3];
        for corner in 0..self.corners() {
            let vector = self.vector::<L>(corner, values);
            let relative = each!(3, axis => vector[axis] - first[axis]);
            sum = each!(3, axis => sum[axis] + relative[axis]);
            centred.push(relative);
        }
        let count = L::splat(self.corners() as f64);
        let mean = each!(3, axis => sum[axis].div(count));
        for vector in centred {
            *vector = each!(3, axis => vector[axis] - mean[axis]);
        }
    }
}
