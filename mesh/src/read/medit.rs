//! Medit's format (`.mesh`) as text, as INRIA's library libMeshb documents it (<https://github.com/LoicMarechal/libMeshb>).
//!
//! References other than 0 are numbers of groups. Of elements of second order the corners are read, which stand first.

use super::builder::Builder;
use super::gmsh::Kind;
use super::source::{Scalar, Source, quoted, vector};
use super::{Cells, Format, Limits, ReadError, content};

/// So many keywords that are not read are told.
const MOST: usize = 8;

pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<Cells, ReadError> {
    if bytes.starts_with(&[1, 0, 0, 0]) || bytes.starts_with(&[0, 0, 0, 1]) {
        let message = "is a binary file of Medit (.meshb); expected Medit's text (.mesh)";
        return Err(ReadError::new(message, "convert it: `meshio convert FILE.meshb NEW.mesh`"));
    }
    let mut reader = Reader { source: Source::text(bytes), builder: Builder::new(limits), unread: Vec::new() };
    reader.source.comment = Some(b'#');
    if reader.source.word() != b"MeshVersionFormatted" {
        return Err(content::no_beginning(bytes, Format::Medit, "`MeshVersionFormatted`"));
    }
    // All versions are the same text.
    reader.count("the version")?;
    let mut dimension = 3;
    loop {
        match reader.source.word() {
            b"End" => break,
            b"" => {
                reader.builder.cells.notes.push("has no `End`, so that its end may be missing".to_owned());
                break;
            }
            b"Dimension" => dimension = reader.count("the dimension")?,
            b"Vertices" if dimension == 2 || dimension == 3 => reader.vertices(dimension)?,
            b"Vertices" => {
                return Err(reader.source.found(&dimension.to_string(), reader.source.at, "the dimension 2 or 3"));
            }
            word => match kind(word) {
                Some(kind) => reader.cells(kind)?,
                None => reader.skip(word)?,
            },
        }
    }
    reader.tell()?;
    reader.builder.finish(&reader.source, 1)
}

struct Reader<'b> {
    source: Source<'b>,
    builder: Builder,
    /// The keywords about cells that are not read, and where the data of each begin.
    unread: Vec<(&'b [u8], usize)>,
}

impl<'b> Reader<'b> {
    fn count(&mut self, expected: &str) -> Result<u64, ReadError> {
        // Mistakes are told where the word is.
        let word = self.source.word();
        self.source.at -= word.len();
        self.source.count(Scalar::I64, expected)
    }

    fn vertices(&mut self, dimension: u64) -> Result<(), ReadError> {
        let count = self.count("the number of vertices")?;
        self.builder.expect(count, 0)?;
        for _ in 0..count {
            let start = self.source.at;
            let point = vector(dimension as usize, || self.source.coordinate(Scalar::F64))?;
            let index = self.builder.point_at(point, start)?;
            self.group(0, &[index])?;
        }
        Ok(())
    }

    fn cells(&mut self, kind: Kind) -> Result<(), ReadError> {
        self.builder.is_curved |= kind.nodes > kind.corners;
        for _ in 0..self.count("the number of elements")? {
            let mut corners = [0; 8];
            for at in 0..kind.nodes {
                let start = self.source.at;
                let number = self.source.integer(Scalar::I64, "the number of a vertex")?;
                if let Some(corner) = corners[..kind.corners].get_mut(at) {
                    *corner = self.builder.corner(number.saturating_sub(1), start, &self.source)?;
                }
            }
            self.builder.around(kind.cell, &corners[..kind.corners])?;
            self.group(kind.dimension, &corners[..kind.corners])?;
        }
        Ok(())
    }

    /// Reads a reference, and adds points to its group.
    fn group(&mut self, dimension: i64, points: &[u32]) -> Result<(), ReadError> {
        match self.source.integer(Scalar::I64, "a reference")? {
            0 => Ok(()),
            reference => self.builder.number((dimension, reference), points),
        }
    }

    /// Tells of keywords that are not read, which is an error if there is nothing else.
    fn tell(&mut self) -> Result<(), ReadError> {
        let named = |&(keyword, at): &(&[u8], usize)| format!("{} {}", quoted(keyword), self.source.place(at));
        let all: Vec<_> = self.unread.iter().map(named).collect();
        let note = match &all[..] {
            [] => return Ok(()),
            [one] => format!("has {one}, which is not read"),
            several => format!("has keywords that are not read: {}", several.join(", ")),
        };
        if self.builder.is_empty() {
            return Err(ReadError::new(
                note,
                "write triangles, quadrilaterals, tetrahedra, hexahedra, prisms or pyramids",
            ));
        }
        // Before what is said of the end.
        self.builder.cells.notes.insert(0, note);
        Ok(())
    }

    /// Goes to the next keyword, and notes cells that it leaves out.
    fn skip(&mut self, keyword: &'b [u8]) -> Result<(), ReadError> {
        /// How keywords begin that are about other things than cells.
        const OTHERS: [&str; 9] =
            ["Required", "Corners", "Ridges", "Normal", "Tangent", "SubDomain", "Geometry", "Identifier", "AngleOf"];
        let name = String::from_utf8_lossy(keyword);
        if !keyword[0].is_ascii_alphabetic() {
            return Err(self.source.wrong(keyword, "a keyword, such as `Tetrahedra`"));
        }
        let is_known = OTHERS.iter().any(|other| name.starts_with(other));
        if !is_known && self.unread.len() < MOST && self.unread.iter().all(|&(other, _)| other != keyword) {
            self.unread.push((keyword, self.source.at));
        }
        loop {
            match self.source.peek().first() {
                Some(first) if !first.is_ascii_alphabetic() => self.source.word(),
                _ => return Ok(()),
            };
        }
    }
}

/// The kind of the elements behind a keyword.
fn kind(keyword: &[u8]) -> Option<Kind> {
    let second = keyword.strip_suffix(b"P2").or(keyword.strip_suffix(b"Q2"));
    let types = match second.unwrap_or(keyword) {
        b"Edges" => [1, 8],
        b"Triangles" => [2, 9],
        b"Quadrilaterals" => [3, 10],
        b"Tetrahedra" => [4, 11],
        b"Hexahedra" | b"Hexaedra" => [5, 12],
        b"Prisms" | b"Wedges" | b"Pentahedra" => [6, 13],
        b"Pyramids" => [7, 14],
        _ => return None,
    };
    Kind::of(types[usize::from(second.is_some())])
}
