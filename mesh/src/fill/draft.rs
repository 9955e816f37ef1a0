//! Elements made of points of a lattice and of cuts of its edges.

use super::Cage;
use super::cuts::{Cuts, EDGES, Lattice};

/// Elements made from a lattice.
pub(super) struct Draft {
    pub(super) cage: Cage,
    /// Whether each element has corners that count as inside because the body is thin there.
    pub(super) is_wide: Vec<bool>,
}

/// Elements that are listed one after the other.
pub(super) struct Drafting<'l> {
    lattice: &'l Lattice,
    cuts: &'l Cuts,
    wide: &'l [bool],
    most: usize,
    /// The number of elements, of which at most `most` are kept.
    count: usize,
    /// The number of each point of the lattice and then of each cut as a node, or [`u32::MAX`].
    numbers: Vec<u32>,
    draft: Draft,
}

impl<'l> Drafting<'l> {
    /// No elements. `wide` says which points of the lattice count as inside wherever they are.
    pub(super) fn new(lattice: &'l Lattice, cuts: &'l Cuts, wide: &'l [bool], convex: bool, most: usize) -> Self {
        let draft = Draft { cage: Cage { convex, ..Cage::default() }, is_wide: Vec::new() };
        let numbers = vec![u32::MAX; lattice.len() + cuts.parts.len()];
        Self { lattice, cuts, wide, most, count: 0, numbers, draft }
    }

    /// Appends an element between points of the lattice, by their places in lists, and cuts, counted on from the last point.
    pub(super) fn push(&mut self, corners: &[usize]) {
        self.count += 1;
        if self.count > self.most {
            return;
        }
        let Draft { cage: Cage { nodes, elements, .. }, is_wide } = &mut self.draft;
        let mut element = Vec::with_capacity(corners.len());
        let mut has_wide = false;
        for &corner in corners {
            let (position, ends) = match corner.checked_sub(self.lattice.len()) {
                None => (self.lattice.at(self.lattice.point(corner)), [corner; 2]),
                Some(cut) => {
                    let (from, edge) = self.cuts.edge(cut);
                    let point = self.lattice.point(from);
                    let to = self.lattice.index(point + EDGES[edge]);
                    (self.lattice.along(point, edge, self.cuts.parts[cut]), [from, to])
                }
            };
            has_wide |= ends.iter().any(|&end| self.wide[end]);
            if self.numbers[corner] == u32::MAX {
                self.numbers[corner] = nodes.len() as u32;
                nodes.push(position);
            }
            element.push(self.numbers[corner]);
        }
        elements.push(&element);
        is_wide.push(has_wide);
    }

    /// The elements, or their number if there are more than allowed.
    pub(super) fn finished(self) -> Result<Draft, usize> {
        if self.count > self.most { Err(self.count) } else { Ok(self.draft) }
    }
}
