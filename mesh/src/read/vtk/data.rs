//! Arrays about points and cells.

use super::{Of, Reader};
use crate::read::source::{Coding, Scalar, integer, vector};
use crate::read::{ReadError, arrays};

impl Reader<'_> {
    /// Reads an array of points or cells. Returns false if it is none.
    pub(super) fn attribute(&mut self, keyword: &[u8], word: &[u8]) -> Result<bool, ReadError> {
        let columns = match keyword {
            b"SCALARS" | b"GLOBAL_IDS" | b"PEDIGREE_IDS" | b"EDGE_FLAGS" => 1,
            b"VECTORS" | b"NORMALS" => 3,
            b"TENSORS" => 9,
            b"TENSORS6" => 6,
            b"COLOR_SCALARS" | b"LOOKUP_TABLE" | b"TEXTURE_COORDINATES" => 0,
            _ => {
                let note = self.source.wrong(word, "").message;
                let note = note.trim_end_matches("; expected ");
                self.builder.cells.notes.push(format!("{note} among its data, of which the rest is not read"));
                return Ok(false);
            }
        };
        let name = self.source.word();
        let columns =
            if columns > 0 { columns } else { self.source.count(Scalar::I64, "a number of columns or rows")? };
        match keyword {
            b"COLOR_SCALARS" | b"LOOKUP_TABLE" => {
                self.source.line();
                let (columns, rows) = if keyword == b"LOOKUP_TABLE" { (4, columns) } else { (columns, self.rows) };
                self.skip(columns.saturating_mul(rows), Scalar::U8)?;
            }
            _ => self.array(name, columns, self.rows)?,
        }
        Ok(true)
    }

    /// Reads an array from its type on, if it is wanted. Another number of columns may follow the type.
    fn array(&mut self, typed: &[u8], columns: u64, rows: u64) -> Result<(), ReadError> {
        let at = self.source.at;
        let kind = self.source.peek().to_ascii_lowercase();
        if matches!(&*kind, b"string" | b"bit") {
            self.source.line();
            let count = columns.saturating_mul(rows);
            return match self.coding {
                _ if kind == b"string" => self.texts(count),
                Coding::Text => self.skip(count, Scalar::U8),
                _ => self.skip(count.div_ceil(8), Scalar::U8),
            };
        }
        let scalar = self.scalar()?;
        let columns = integer(self.source.line().trim_ascii()).map_or(columns, |own| own.unsigned_abs());
        if self.source.peek().eq_ignore_ascii_case(b"LOOKUP_TABLE") {
            self.source.line();
        }
        let of_cells = self.of == Of::Cells;
        let name = arrays::wanted(typed, of_cells, columns as usize).filter(|_| self.of != Of::All);
        let is_read = |name: &&[u8]| {
            if arrays::is_vector(name) { matches!(columns, 2 | 3) } else { columns == 1 && *name != arrays::PRESSURE }
        };
        let Some(name) = name.filter(is_read) else {
            name.into_iter().for_each(|name| drop(self.vectors.insert(name, Vec::new())));
            return self.skip(columns.saturating_mul(rows), scalar);
        };
        let expected = if of_cells { self.starts.len() } else { self.builder.points() };
        self.source.coding = self.coding;
        arrays::check(typed, rows as usize, expected, of_cells, || self.source.place(at))?;
        if !arrays::is_vector(name) {
            let mut ghosts = Vec::new();
            for _ in 0..expected {
                ghosts.push(arrays::ghost(name, self.source.integer(scalar, "what tells ghosts")?, of_cells));
            }
            if of_cells {
                self.builder.ghosts_of_cells(&self.starts, &ghosts);
            } else {
                self.builder.ghosts(0, ghosts);
            }
        } else {
            let mut vectors = Vec::new();
            for _ in 0..expected {
                vectors.push(vector(columns as usize, || self.source.float(scalar, "a component of a vector"))?);
            }
            self.vectors.insert(name, vectors);
        }
        self.source.coding = Coding::Text;
        Ok(())
    }

    fn skip(&mut self, count: u64, scalar: Scalar) -> Result<(), ReadError> {
        self.source.coding = self.coding;
        self.source.skip(count, scalar, "a number of an array")?;
        self.source.coding = Coding::Text;
        Ok(())
    }

    pub(super) fn fields(&mut self) -> Result<(), ReadError> {
        self.source.word();
        for _ in 0..self.source.count(Scalar::I64, "the number of arrays")? {
            let mut name = self.source.word();
            if name.eq_ignore_ascii_case(b"METADATA") {
                self.metadata();
                name = self.source.word();
            }
            let columns = self.source.count(Scalar::I64, "the number of columns of an array")?;
            let rows = self.source.count(Scalar::I64, "the number of rows of an array")?;
            self.array(name, columns, rows)?;
        }
        Ok(())
    }

    /// Skips texts: lines, or bytes after their number. The first two bits of the number tell its length.
    fn texts(&mut self, count: u64) -> Result<(), ReadError> {
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
