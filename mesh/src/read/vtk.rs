//! VTK's legacy format: unstructured grids and polygons, as text or big-endian numbers, in its old layout and that of version 5
//! (<https://docs.vtk.org/en/latest/vtk_file_formats/vtk_legacy_file_format.html>).

mod data;

use super::builder::{Builder, too_many};
use super::source::{Coding, DAMAGED, Scalar, Source};
use super::{Cells, Format, Limits, ReadError, arrays, content, kinds};
use glam::DVec3;
use std::collections::BTreeMap;

/// Lists of points, one after the other.
#[derive(Default)]
struct Lists {
    /// Where each list ends.
    ends: Vec<usize>,
    indices: Vec<i64>,
}

impl Lists {
    fn iter(&self) -> impl Iterator<Item = &[i64]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.indices[start..end])
    }
}

pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<Cells, ReadError> {
    let mut source = Source::text(bytes);
    if !source.line().to_ascii_lowercase().starts_with(b"# vtk datafile version") {
        return Err(content::no_beginning(bytes, Format::Vtk, "`# vtk DataFile Version`"));
    }
    // The title.
    source.line();
    let word = source.word();
    let coding = match &*word.to_ascii_uppercase() {
        b"ASCII" => Coding::Text,
        b"BINARY" => Coding::Big,
        _ => return Err(source.wrong(word, "`ASCII` or `BINARY`")),
    };
    let (cells, starts, of, rows, vectors) = Default::default();
    let mut reader = Reader { source, coding, builder: Builder::new(limits), cells, starts, of, rows, vectors };
    while reader.section()? {}
    if reader.cells.is_some() {
        return Err(reader.source.ends("`CELL_TYPES`"));
    }
    let displacement = arrays::displacement(|name| reader.vectors.contains_key(name));
    reader.builder.cells.velocities = reader.vectors.remove(arrays::VELOCITY);
    reader.builder.cells.displacements = reader.vectors.remove(displacement);
    reader.source.coding = reader.coding;
    reader.builder.finish(&reader.source, 0)
}

struct Reader<'b> {
    source: Source<'b>,
    coding: Coding,
    builder: Builder,
    /// Cells whose types follow.
    cells: Option<Lists>,
    /// The first cell that each cell of the file became.
    starts: Vec<usize>,
    /// What the arrays that follow are about, and how many of them there are.
    of: Of,
    rows: u64,
    /// Vectors of points by the names of their arrays.
    vectors: BTreeMap<&'static [u8], Vec<DVec3>>,
}

/// What an array is about.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
enum Of {
    #[default]
    All,
    Points,
    Cells,
}

impl Reader<'_> {
    /// Reads a section. Returns false at the end of the mesh.
    fn section(&mut self) -> Result<bool, ReadError> {
        let word = self.source.word();
        match &*word.to_ascii_uppercase() {
            b"DATASET" => {
                let kind = self.source.word();
                if !matches!(&*kind.to_ascii_uppercase(), b"UNSTRUCTURED_GRID" | b"POLYDATA") {
                    let message = self.source.wrong(kind, "`UNSTRUCTURED_GRID` or `POLYDATA`").message;
                    return Err(ReadError::new(message, kinds::AS_GRID));
                }
            }
            b"POINTS" => self.points()?,
            b"CELLS" => {
                let (lists, _) = self.lists()?;
                self.cells = Some(lists);
            }
            b"CELL_TYPES" => self.types()?,
            b"VERTICES" => self.faces(2)?,
            b"LINES" => self.faces(4)?,
            b"POLYGONS" => self.faces(7)?,
            b"TRIANGLE_STRIPS" => self.faces(6)?,
            b"METADATA" => self.metadata(),
            b"FIELD" => self.fields()?,
            keyword @ (b"POINT_DATA" | b"CELL_DATA") => {
                self.rows = self.source.count(Scalar::I64, "the number of points or cells")?;
                self.of = if keyword == b"POINT_DATA" { Of::Points } else { Of::Cells };
            }
            b"" => return Ok(false),
            keyword if self.of != Of::All => return self.attribute(keyword, word),
            _ => return Err(self.source.wrong(word, "`POINTS`, `CELLS` or another section")),
        }
        Ok(true)
    }

    /// Skips the lines of a section that ends with an empty one.
    fn metadata(&mut self) {
        self.source.line();
        while !self.source.line().trim_ascii().is_empty() {}
    }

    fn points(&mut self) -> Result<(), ReadError> {
        let count = self.source.count(Scalar::I64, "the number of points")?;
        self.builder.expect(count, 0)?;
        let scalar = self.scalar()?;
        self.source.line();
        self.source.coding = self.coding;
        for _ in 0..count {
            let at = self.source.at;
            self.builder.point_at(self.source.point(scalar)?, at)?;
        }
        self.source.coding = Coding::Text;
        Ok(())
    }

    fn scalar(&mut self) -> Result<Scalar, ReadError> {
        let word = self.source.word();
        Scalar::named(word).ok_or_else(|| self.source.wrong(word, "a type of numbers, such as `float`"))
    }

    /// Reads lists of points in either layout, and the place where they begin.
    fn lists(&mut self) -> Result<(Lists, usize), ReadError> {
        let most = 4 * self.builder.most_corners as u64;
        let [first, second] = [(); 2].map(|()| self.source.count(Scalar::I64, "a number of cells"));
        let (first, second) = (first?, second?);
        if first.max(second) > most {
            return Err(too_many(&format!("cells with {}", first.max(second)), "numbers", most as usize));
        }
        let mut lists = Lists::default();
        if self.source.peek().eq_ignore_ascii_case(b"OFFSETS") {
            // One more offset than lists.
            self.source.word();
            let place = self.source.at;
            let offsets = self.numbers(first)?;
            let word = self.source.word();
            if !word.eq_ignore_ascii_case(b"CONNECTIVITY") {
                return Err(self.source.wrong(word, "`CONNECTIVITY`"));
            }
            lists.indices = self.numbers(second)?;
            for offset in offsets.into_iter().skip(1) {
                let before = lists.ends.last().copied().unwrap_or(0);
                match usize::try_from(offset) {
                    Ok(end) if (before..=lists.indices.len()).contains(&end) => lists.ends.push(end),
                    _ => return Err(self.source.found(&offset.to_string(), place, "ascending offsets of cells")),
                }
            }
            return Ok((lists, place));
        }
        self.source.line();
        let place = self.source.at;
        self.source.coding = self.coding;
        for _ in 0..first {
            for _ in 0..self.source.count(Scalar::I32, "the number of points of a cell")? {
                lists.indices.push(self.source.integer(Scalar::I32, "the index of a point")?);
            }
            lists.ends.push(lists.indices.len());
        }
        self.source.coding = Coding::Text;
        Ok((lists, place))
    }

    /// Reads a type and so many integers of it.
    fn numbers(&mut self, count: u64) -> Result<Vec<i64>, ReadError> {
        let mut numbers = Vec::new();
        let scalar = self.scalar()?;
        self.source.line();
        self.source.coding = self.coding;
        for _ in 0..count {
            numbers.push(self.source.integer(scalar, "an index")?);
        }
        self.source.coding = Coding::Text;
        Ok(numbers)
    }

    /// Cells that all have one type.
    fn faces(&mut self, kind: i64) -> Result<(), ReadError> {
        let (lists, place) = self.lists()?;
        lists.iter().try_for_each(|list| self.cell(kind, list, place))
    }

    fn types(&mut self) -> Result<(), ReadError> {
        let count = self.source.count(Scalar::I64, "the number of cells")?;
        let cells = self.cells.take().unwrap_or_default();
        if count != cells.ends.len() as u64 {
            let message = format!("has {} cells, but {count} types of cells", cells.ends.len());
            return Err(ReadError::new(message, DAMAGED));
        }
        self.source.line();
        self.source.coding = self.coding;
        for list in cells.iter() {
            let start = self.source.at;
            let kind = self.source.integer(Scalar::I32, "the type of a cell")?;
            self.cell(kind, list, start)?;
        }
        self.source.coding = Coding::Text;
        Ok(())
    }

    fn cell(&mut self, kind: i64, list: &[i64], place: usize) -> Result<(), ReadError> {
        self.starts.push(self.builder.cells.kinds.len());
        let mut corners = |list: &[i64]| -> Result<Vec<u32>, ReadError> {
            list.iter().map(|&index| self.builder.corner(index, place, &self.source)).collect()
        };
        if kind != 42 {
            let corners = corners(list)?;
            return kinds::add(kind, &corners, &mut self.builder);
        }
        let damaged = || ReadError::new("has a polyhedron whose faces have more points than it lists", DAMAGED);
        let faces = kinds::faces(list).ok_or_else(damaged)?;
        let faces = faces.into_iter().map(corners).collect::<Result<Vec<_>, _>>()?;
        kinds::polyhedron(&faces, &[], &mut self.builder)
    }
}
