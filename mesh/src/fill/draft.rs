//! Elements made of points of a lattice and of points between them.

use super::Cage;
use glam::DVec3;

/// Elements made from a lattice.
pub(super) struct Draft {
    pub(super) cage: Cage,
    /// Whether each element stands where the body is thin, and may be filled in part.
    pub(super) is_wide: Vec<bool>,
    /// Whether some elements were left out on trial.
    pub(super) is_bold: bool,
}

/// Elements that are listed one after the other.
pub(super) struct Drafting {
    most: usize,
    /// The number of elements, of which at most `most` are kept.
    count: usize,
    /// The number of each point as a node, or [`u32::MAX`].
    numbers: Vec<u32>,
    draft: Draft,
}

impl Drafting {
    /// No elements between so many points.
    pub(super) fn new(convex: bool, points: usize, most: usize) -> Self {
        let draft = Draft { cage: Cage { convex, ..Cage::default() }, is_wide: Vec::new(), is_bold: false };
        Self { most, count: 0, numbers: vec![u32::MAX; points], draft }
    }

    /// Appends an element between points, which are at places (m).
    pub(super) fn push(&mut self, corners: &[usize], is_wide: bool, place: impl Fn(usize) -> DVec3) {
        self.count += 1;
        if self.count > self.most {
            return;
        }
        let Draft { cage: Cage { nodes, elements, .. }, is_wide: all, .. } = &mut self.draft;
        let mut element = Vec::with_capacity(corners.len());
        for &corner in corners {
            if self.numbers[corner] == u32::MAX {
                self.numbers[corner] = nodes.len() as u32;
                nodes.push(place(corner));
            }
            element.push(self.numbers[corner]);
        }
        elements.push(&element);
        all.push(is_wide);
    }

    /// The elements, or their number if there are more than allowed.
    pub(super) fn finished(self) -> Result<Draft, usize> {
        if self.count > self.most { Err(self.count) } else { Ok(self.draft) }
    }
}
