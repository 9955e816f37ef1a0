//! The faces of polyhedra, in the old layout or in that of VTK 9.4.

use crate::read::source::DAMAGED;
use crate::read::{ReadError, kinds};

/// The faces of polyhedra, in the old layout or in that of VTK 9.4.
pub(super) struct Polyhedra {
    /// The number of faces of each polyhedron, and for each face the number of its points and the points.
    pub(super) streams: Vec<i64>,
    /// Where the stream of each cell ends, or −1.
    pub(super) ends: Vec<i64>,
    /// The points of all faces, and where those of each end.
    pub(super) points: Vec<i64>,
    pub(super) faces: Vec<i64>,
    /// The faces of all polyhedra, and where those of each cell end.
    pub(super) members: Vec<i64>,
    pub(super) cells: Vec<i64>,
}

impl Polyhedra {
    pub(super) fn faces_of(&self, cell: usize) -> Result<Vec<&[i64]>, ReadError> {
        self.find(cell).ok_or_else(|| {
            let message = format!("has no sound faces of the polyhedron that is cell {cell}");
            ReadError::new(message, DAMAGED)
        })
    }

    fn find(&self, cell: usize) -> Option<Vec<&[i64]>> {
        if self.cells.is_empty() {
            let end = usize::try_from(*self.ends.get(cell)?).ok()?;
            let before = self.ends[..cell]
                .iter()
                .rev()
                .find(|&&end| end >= 0)
                .map_or(Some(0), |&end| usize::try_from(end).ok())?;
            return kinds::faces(self.streams.get(before..end)?);
        }
        let part = |ends: &[i64], at: usize| -> Option<std::ops::Range<usize>> {
            let end = usize::try_from(*ends.get(at)?).ok()?;
            let start = if at == 0 { 0 } else { usize::try_from(ends[at - 1]).ok()? };
            Some(start..end)
        };
        let members = self.members.get(part(&self.cells, cell)?)?;
        members.iter().map(|&face| self.points.get(part(&self.faces, usize::try_from(face).ok()?)?)).collect()
    }
}
