//! Points in use, and their new indices.

use crate::Group;

/// Stands for a point that is left out.
pub(super) const NONE: u32 = u32::MAX;

/// New indices of the points in use.
pub(crate) struct Used {
    /// The new index of each point, or [`NONE`].
    pub(crate) new: Vec<u32>,
}

impl Used {
    pub(crate) fn new(points: usize, corners: &[u32]) -> Self {
        let mut new = vec![NONE; points];
        corners.iter().for_each(|&corner| new[corner as usize] = 0);
        Self::numbered(new)
    }

    /// Numbers the points that are not left out.
    pub(super) fn numbered(mut new: Vec<u32>) -> Self {
        let used = new.iter_mut().filter(|new| **new != NONE);
        used.zip(0..).for_each(|(new, index)| *new = index);
        Self { new }
    }

    /// The values of these points among those of all.
    pub(crate) fn of<T: Copy>(&self, all: &[T]) -> Vec<T> {
        all.iter().zip(&self.new).filter(|&(_, &new)| new != NONE).map(|(value, _)| *value).collect()
    }

    /// The groups with their points in use. Those that have none stay, empty, so that who names one is told.
    pub(crate) fn groups(&self, groups: &[Group]) -> Vec<Group> {
        let group = |group: &Group| {
            let points = group.points.iter().map(|&point| self.new[point as usize]);
            Group { name: group.name.clone(), points: points.filter(|&point| point != NONE).collect() }
        };
        groups.iter().map(group).collect()
    }
}
