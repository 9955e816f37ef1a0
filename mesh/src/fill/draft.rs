//! Elements made of points of a lattice and of points between them.

use super::Cage;
use glam::DVec3;

/// Elements made from a lattice, listed one after the other.
pub(super) struct Draft {
    pub(super) cage: Cage,
    /// Whether each element stands where the body is thin, and may be filled in part.
    pub(super) is_wide: Vec<bool>,
    /// Whether some elements were left out on trial.
    pub(super) is_bold: bool,
    /// The number of elements, of which at most `most` are kept.
    count: usize,
    most: usize,
    nodes: Nodes,
}

impl Draft {
    /// No elements between so many points.
    pub(super) fn new(convex: bool, points: usize, most: usize) -> Self {
        let cage = Cage { convex, ..Cage::default() };
        Self { cage, is_wide: Vec::new(), is_bold: false, count: 0, most, nodes: Nodes::new(points) }
    }

    /// Appends an element between points, which are at places (m).
    pub(super) fn push(&mut self, corners: &[usize], is_wide: bool, place: impl Fn(usize) -> DVec3) {
        self.count += 1;
        if self.count > self.most {
            return;
        }
        let element: Vec<u32> = corners.iter().map(|&corner| self.nodes.of(corner, || place(corner))).collect();
        self.cage.elements.push(&element);
        self.is_wide.push(is_wide);
    }

    /// The elements with their nodes, or their number if there are more than allowed.
    pub(super) fn finished(mut self) -> Result<Self, usize> {
        self.cage.nodes = std::mem::take(&mut self.nodes).places;
        if self.count > self.most { Err(self.count) } else { Ok(self) }
    }
}

/// Points numbered as nodes in the order in which they are met.
#[derive(Default)]
pub(super) struct Nodes {
    /// The number of each point, or [`u32::MAX`].
    numbers: Vec<u32>,
    /// Where each node is (m).
    pub(super) places: Vec<DVec3>,
}

impl Nodes {
    pub(super) fn new(points: usize) -> Self {
        Self { numbers: vec![u32::MAX; points], places: Vec::new() }
    }

    /// The node of a point, which is at a place (m).
    pub(super) fn of(&mut self, point: usize, place: impl FnOnce() -> DVec3) -> u32 {
        let number = &mut self.numbers[point];
        if *number == u32::MAX {
            *number = self.places.len() as u32;
            self.places.push(place());
        }
        *number
    }
}
