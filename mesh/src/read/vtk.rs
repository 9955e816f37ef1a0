//! VTK's legacy format: unstructured grids and polygons, as text or big-endian numbers, in its old layout and that of version 5
//! (<https://docs.vtk.org/en/latest/vtk_file_formats/vtk_legacy_file_format.html>).

use super::cells::Builder;
use super::kinds::GHOSTS;
use super::source::{Coding, DAMAGED, Scalar, Source};
use super::{Cells, Format, Limits, ReadError, content, kinds};
use memchr::memmem;

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
    // Which cells are copies is told behind them.
    let mut reader = read_with(bytes, Vec::new(), limits)?;
    if reader.ghosts[1].contains(&true) {
        reader = read_with(bytes, std::mem::take(&mut reader.ghosts[1]), limits)?;
    }
    let copies = (0..).zip(&reader.ghosts[0]).filter(|&(_, &is_copy)| is_copy).map(|(point, _)| point);
    copies.for_each(|point| reader.builder.cells.copies.push(&[point]));
    reader.source.coding = reader.coding;
    reader.builder.finish(&reader.source, 0)
}

/// Reads a file whose copies among the cells are known.
fn read_with<'b, 'l>(bytes: &'b [u8], copies: Vec<bool>, limits: &'l Limits) -> Result<Reader<'b, 'l>, ReadError> {
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
    let mut reader = Reader {
        source,
        coding,
        builder: Builder::new(limits),
        limits,
        cells: None,
        copies,
        count: 0,
        ghosts: Default::default(),
    };
    while reader.section()? {}
    if reader.cells.is_some() {
        return Err(reader.source.ends("`CELL_TYPES`"));
    }
    reader.ghosts()?;
    Ok(reader)
}

struct Reader<'b, 'l> {
    source: Source<'b>,
    coding: Coding,
    builder: Builder<'l>,
    limits: &'l Limits,
    /// Cells whose types follow.
    cells: Option<Lists>,
    /// Which cells are copies, as far as it is known.
    copies: Vec<bool>,
    /// The number of cells so far.
    count: usize,
    /// Which points and cells are copies, as the end of the file tells.
    ghosts: [Vec<bool>; 2],
}

impl Reader<'_, '_> {
    /// Reads a section. Returns false at the end of the mesh.
    fn section(&mut self) -> Result<bool, ReadError> {
        let word = self.source.word();
        match &*word.to_ascii_uppercase() {
            b"DATASET" => {
                let kind = self.source.word();
                if !matches!(&*kind.to_ascii_uppercase(), b"UNSTRUCTURED_GRID" | b"POLYDATA") {
                    let message = self.source.wrong(kind, "`UNSTRUCTURED_GRID` or `POLYDATA`").message;
                    let help = "write it as an unstructured grid: ParaView's filter `Append Datasets` makes one";
                    return Err(ReadError::new(message, help));
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
            // What follows belongs to points and cells.
            b"" | b"CELL_DATA" | b"POINT_DATA" => {
                self.source.at -= word.len();
                return Ok(false);
            }
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
        self.source.coding = self.coding;
        for _ in 0..count {
            let at = self.source.at;
            self.builder.point_at(self.source.point(scalar)?, at)?;
        }
        self.source.coding = Coding::Text;
        Ok(())
    }

    /// Reads which points and cells are copies, wherever that stands among their data.
    fn ghosts(&mut self) -> Result<(), ReadError> {
        let (start, data) = (self.source.at, self.source.rest());
        let (mut before, mut of_cells) = (0, false);
        for at in memmem::find_iter(data, "vtkGhost") {
            let last = ["POINT_DATA", "CELL_DATA"].map(|of| memmem::rfind(&data[before..at], of.as_bytes()));
            of_cells = if last == [None; 2] { of_cells } else { last[1] > last[0] };
            before = at;
            // What was read as numbers already is no name.
            let is_name =
                |name: &&[u8]| data[at..].strip_prefix(*name).is_some_and(|rest| rest.trim_ascii_start() != rest);
            let found = GHOSTS.into_iter().find(is_name).filter(|_| start + at >= self.source.at);
            let Some(name) = found else { continue };
            self.source.at = start + at + name.len();
            // In a field, the numbers of columns and rows stand before the type; else a table of colours may follow.
            if self.source.peek().first().is_some_and(u8::is_ascii_digit) {
                self.source.skip(2, Scalar::I64, "the number of data")?;
            }
            let scalar = self.scalar()?;
            if self.source.peek() == b"LOOKUP_TABLE" {
                self.source.line();
            }
            let ghosts = &mut self.ghosts[usize::from(of_cells)];
            ghosts.clear();
            self.source.coding = self.coding;
            for _ in 0..if of_cells { self.count } else { self.builder.points() } {
                let number = self.source.integer(scalar, "what tells ghosts")?;
                ghosts.push(kinds::is_ghost(name, number, of_cells));
            }
            self.source.coding = Coding::Text;
        }
        Ok(())
    }

    /// Reads the name of a type and the end of the line.
    fn scalar(&mut self) -> Result<Scalar, ReadError> {
        let word = self.source.word();
        let scalar = match &*word.to_ascii_lowercase() {
            b"unsigned_char" => Scalar::U8,
            b"char" => Scalar::I8,
            b"unsigned_short" => Scalar::U16,
            b"short" => Scalar::I16,
            b"unsigned_int" => Scalar::U32,
            // Indices have 32 bits in this format.
            b"int" | b"vtkidtype" => Scalar::I32,
            b"unsigned_long" | b"vtktypeuint64" => Scalar::U64,
            b"long" | b"vtktypeint64" => Scalar::I64,
            b"float" => Scalar::F32,
            b"double" => Scalar::F64,
            _ => return Err(self.source.wrong(word, "a type of numbers, such as `float`")),
        };
        self.source.line();
        Ok(scalar)
    }

    /// Reads lists of points in either layout, and the place where they begin.
    fn lists(&mut self) -> Result<(Lists, usize), ReadError> {
        let most = 4 * self.limits.corners as u64;
        let [first, second] = [(); 2].map(|()| self.source.count(Scalar::I64, "a number of cells"));
        let (first, second) = (first?, second?);
        if first.max(second) > most {
            let message = format!("has cells with {} numbers; at most {most} are read", first.max(second));
            return Err(ReadError::new(
                message,
                "make the mesh coarser, with a decimation of the program that wrote it",
            ));
        }
        let mut lists = Lists::default();
        if self.source.peek().eq_ignore_ascii_case(b"OFFSETS") {
            // One more offset than lists.
            self.source.word();
            let mut offsets = Vec::new();
            let place = self.source.at;
            self.numbers(first, &mut offsets)?;
            let word = self.source.word();
            if !word.eq_ignore_ascii_case(b"CONNECTIVITY") {
                return Err(self.source.wrong(word, "`CONNECTIVITY`"));
            }
            self.numbers(second, &mut lists.indices)?;
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
    fn numbers(&mut self, count: u64, numbers: &mut Vec<i64>) -> Result<(), ReadError> {
        let scalar = self.scalar()?;
        self.source.coding = self.coding;
        for _ in 0..count {
            numbers.push(self.source.integer(scalar, "an index")?);
        }
        self.source.coding = Coding::Text;
        Ok(())
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
        self.builder.is_copy = self.copies.get(self.count).is_some_and(|&is_copy| is_copy);
        self.count += 1;
        let mut corner = |index: i64| self.builder.corner(index, place, &self.source);
        if kind != 42 {
            let corners = list.iter().map(|&index| corner(index)).collect::<Result<Vec<_>, _>>()?;
            return kinds::add(kind, &corners, &mut self.builder);
        }
        // The number of faces, and for each the number of its points and the points.
        let mut faces = Vec::new();
        let mut rest = list.get(1..).unwrap_or_default();
        while let [count, after @ ..] = rest {
            let count = usize::try_from(*count).ok().filter(|count| *count <= after.len());
            let Some(count) = count else {
                return Err(ReadError::new("has a polyhedron whose faces have more points than it lists", DAMAGED));
            };
            faces.push(after[..count].iter().map(|&index| corner(index)).collect::<Result<Vec<_>, _>>()?);
            rest = &after[count..];
        }
        kinds::polyhedron(&faces, &[], &mut self.builder)
    }

    /// Skips arrays of data.
    fn fields(&mut self) -> Result<(), ReadError> {
        self.source.word();
        for _ in 0..self.source.count(Scalar::I64, "the number of arrays")? {
            if self.source.word().eq_ignore_ascii_case(b"METADATA") {
                self.metadata();
                self.source.word();
            }
            let columns = self.source.count(Scalar::I64, "the number of columns of an array")?;
            let rows = self.source.count(Scalar::I64, "the number of rows of an array")?;
            if self.source.peek().eq_ignore_ascii_case(b"string") {
                self.texts(columns.saturating_mul(rows))?;
                continue;
            }
            let scalar = self.scalar()?;
            self.source.coding = self.coding;
            self.source.skip(columns.saturating_mul(rows), scalar, "a number of an array")?;
            self.source.coding = Coding::Text;
        }
        Ok(())
    }

    /// Skips texts: lines, or bytes after their number. The first two bits of the number tell its length.
    fn texts(&mut self, count: u64) -> Result<(), ReadError> {
        self.source.line();
        for _ in 0..count {
            if self.coding == Coding::Text {
                if self.source.rest().is_empty() {
                    return Err(self.source.ends("a text of an array"));
                }
                self.source.line();
                continue;
            }
            let expected = "the length of a text of an array";
            let first = self.source.rest().first().copied().unwrap_or(0);
            let number = self.source.take(8 >> (first >> 6), expected)?;
            let length = number[1..].iter().fold(u64::from(first & 63), |sum, &byte| sum << 8 | u64::from(byte));
            self.source.take(usize::try_from(length).unwrap_or(usize::MAX), "a text of an array")?;
        }
        Ok(())
    }
}
