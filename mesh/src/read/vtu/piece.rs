//! A piece of a grid: its points, its cells, and the arrays about them.

use super::polyhedra::Polyhedra;
use super::{Array, CELL_DATA, ELEMENTS, Layout, POINT_DATA, Piece};
use crate::read::builder::{Builder, Ghost, beyond};
use crate::read::source::{Coding, DAMAGED, Source, vector};
use crate::read::{ReadError, arrays, kinds};
use glam::DVec3;

/// A piece that is read, and the points of it.
struct Reading<'r, 'b> {
    layout: &'r Layout<'b>,
    piece: &'r Piece,
    first: usize,
    count: usize,
}

impl Layout<'_> {
    pub(super) fn piece(&self, piece: &Piece, builder: &mut Builder) -> Result<(), ReadError> {
        let first = builder.points();
        if let Some(((_, name), array)) = piece.iter().find(|((parent, _), _)| parent == b"Points") {
            let name = if name.is_empty() { b"Points" } else { &**name };
            self.each(array, name, 3 * self.limits.points, |source| {
                let at = if source.coding == Coding::Text { source.at } else { array.at };
                builder.point_at(vector(array.columns, || source.coordinate(array.scalar))?, at).map(drop)
            })?;
        }
        let reading = Reading { layout: self, piece, first, count: builder.points() - first };
        reading.vectors(arrays::VELOCITY, "a velocity", &mut builder.cells.velocities)?;
        let displacement = arrays::displacement(|name| reading.get(POINT_DATA, name).is_some());
        reading.vectors(displacement, "a displacement", &mut builder.cells.displacements)?;
        builder.ghosts(first, reading.ghosts(POINT_DATA, reading.count)?);
        let starts = reading.cells(builder)?;
        builder.ghosts_of_cells(&starts, &reading.ghosts(CELL_DATA, starts.len())?);
        Ok(())
    }
}

impl Reading<'_, '_> {
    fn get(&self, parent: &[u8], name: &[u8]) -> Option<&Array> {
        self.piece.get(&(parent.to_vec(), name.to_vec()))
    }

    fn integers(&self, parent: &[u8], name: &[u8]) -> Result<Vec<i64>, ReadError> {
        let array = self.get(parent, name);
        array.map_or(Ok(Vec::new()), |array| self.layout.integers(array, name, 4 * self.layout.limits.corners))
    }

    /// Refuses an array that has not one entry for each of the points or cells.
    fn check(&self, array: &Array, found: usize, expected: usize, of_cells: bool) -> Result<(), ReadError> {
        arrays::check(&array.name, found, expected, of_cells, || Source::text(self.layout.bytes).place(array.at))
    }

    /// Appends the vectors of the points, if there are some.
    fn vectors(&self, name: &[u8], expected: &str, all: &mut Option<Vec<DVec3>>) -> Result<(), ReadError> {
        let Some(array) = self.get(POINT_DATA, name) else { return Ok(()) };
        let mut vectors = Vec::new();
        self.layout.each(array, &array.name, 3 * self.layout.limits.points, |source| {
            vectors.push(vector(array.columns, || source.float(array.scalar, expected))?);
            Ok(())
        })?;
        self.check(array, vectors.len(), self.count, false)?;
        all.get_or_insert_default().extend(vectors);
        Ok(())
    }

    /// What tells ghosts, one for each point or for each of these cells of the file, if something does.
    fn ghosts(&self, parent: &[u8], expected: usize) -> Result<Vec<Ghost>, ReadError> {
        let (of_cells, mut names) = (parent == CELL_DATA, arrays::GHOSTS.into_iter());
        let Some((name, array)) = names.find_map(|name| Some((name, self.get(parent, name)?))) else {
            return Ok(Vec::new());
        };
        let numbers = self.integers(parent, name)?;
        self.check(array, numbers.len(), expected, of_cells)?;
        Ok(numbers.iter().map(|&number| arrays::ghost(name, number, of_cells)).collect())
    }

    /// Adds the cells of all kinds. Returns the first of those that each cell of the file becomes.
    fn cells(&self, builder: &mut Builder) -> Result<Vec<usize>, ReadError> {
        let of_cells = |name: &[u8]| self.integers(b"Cells", name);
        let polyhedra = Polyhedra {
            streams: of_cells(b"faces")?,
            ends: of_cells(b"faceoffsets")?,
            points: of_cells(b"face_connectivity")?,
            faces: of_cells(b"face_offsets")?,
            members: of_cells(b"polyhedron_to_faces")?,
            cells: of_cells(b"polyhedron_offsets")?,
        };
        let corners = |list: &[i64]| -> Result<Vec<u32>, ReadError> {
            let corner = |&index: &i64| match usize::try_from(index) {
                Ok(index) if index < self.count => Ok((self.first + index) as u32),
                _ => Err(beyond(index, 0, self.count as u64)),
            };
            list.iter().map(corner).collect()
        };
        let mut starts = Vec::new();
        for &(parent, kind) in &ELEMENTS[1..] {
            let (connectivity, offsets) = (self.integers(parent, b"connectivity")?, self.integers(parent, b"offsets")?);
            let types = self.integers(parent, b"types")?;
            if kind < 0 && types.len() != offsets.len() {
                let message = format!("has {} offsets of cells, but {} types", offsets.len(), types.len());
                return Err(ReadError::new(message, DAMAGED));
            }
            let mut start = 0;
            for (cell, &offset) in offsets.iter().enumerate() {
                let end = usize::try_from(offset).ok().filter(|&end| start <= end && end <= connectivity.len());
                let Some(end) = end else {
                    let message = format!(
                        "has the offset {offset} of cell {cell}; expected {start} to {}, the length of `connectivity`",
                        connectivity.len()
                    );
                    return Err(ReadError::new(message, DAMAGED));
                };
                let kind = if kind < 0 { types[cell] } else { kind };
                let list = corners(&connectivity[start..end])?;
                start = end;
                starts.push(builder.cells.kinds.len());
                if kind == 42 {
                    let faces = polyhedra.faces_of(cell)?;
                    self.layout.spend(faces.iter().map(|face| 1 + face.len()).sum())?;
                    let faces = faces.into_iter().map(corners).collect::<Result<Vec<_>, _>>()?;
                    kinds::polyhedron(&faces, &list, builder)?;
                } else {
                    kinds::add(kind, &list, builder)?;
                }
            }
        }
        Ok(starts)
    }
}
