//! Reads NumPy archives (.npz): ZIP archives of plain arrays, as `numpy.savez` and `numpy.savez_compressed` write them, in
//! either order of bytes and of axes.
//!
//! Archives are untrusted. Sizes are compared with the file before memory is allocated, and memory grows only with the
//! data.
//!
//! No library reads the arrays: `npyz` allocates the length that a header claims, up to 4 GiB, before it reads it, and
//! brings twelve crates. It would not replace the checks and messages, which are most of this file.

use crate::reading::words::{count, quoted};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::Path;
use zip::read::ZipFile;
use zip::{CompressionMethod, ZipArchive};

/// The longest accepted header of an array (bytes); usual ones have some hundred.
const LONGEST_HEAD: usize = 4096;

/// The largest allocation for an array before it is read (bytes), larger than most arrays and available on every machine.
const MOST_RESERVED: u64 = 1 << 26;

/// Bytes that are held together while an array is copied; few in tests, whose arrays are small.
const MOST_HELD: usize = if cfg!(test) { 1 << 10 } else { 1 << 26 };

/// An open archive.
#[derive(Debug)]
pub(crate) struct Npz {
    zip: ZipArchive<BufReader<File>>,
    /// Length of the file (bytes).
    length: u64,
    /// Copies of arrays by their indices, row by row and little-endian ([`Self::unfold`]).
    copies: BTreeMap<usize, File>,
}

/// The header of an array in an archive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Array {
    /// Index in the archive.
    index: usize,
    dtype: Dtype,
    /// Whether its numbers are big-endian. They are turned where they are read.
    is_big: bool,
    /// Whether columns, not rows, are contiguous (Fortran order).
    by_columns: bool,
    is_packed: bool,
    /// Length along each axis.
    pub(crate) shape: Vec<u64>,
    /// Length of the header (bytes).
    head: u64,
}

/// The header of an array, as it is read.
struct Head<'z> {
    /// NumPy's name of the type.
    dtype: String,
    by_columns: bool,
    shape: Vec<u64>,
    /// Its length (bytes).
    length: u64,
    /// The numbers after it.
    entry: ZipFile<'z, BufReader<File>>,
    is_packed: bool,
}

/// The type of a number, little-endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Dtype {
    Float64,
    Float32,
    Signed(usize),
    Unsigned(usize),
}

impl Dtype {
    fn bytes(self) -> usize {
        match self {
            Self::Float64 => 8,
            Self::Float32 => 4,
            Self::Signed(bytes) | Self::Unsigned(bytes) => bytes,
        }
    }

    /// The type of a NumPy name, and whether it is big-endian, or a message about it.
    fn of(name: &str) -> Result<(Self, bool), String> {
        const EXPECTED: &str = "expected float64, float32 or whole numbers";
        let (order, rest) = name.split_at_checked(1).unwrap_or_default();
        let (letter, bytes) = rest.split_at_checked(1).unwrap_or_default();
        let dtype = match (letter, bytes) {
            _ if !matches!(order, "<" | ">" | "|") => None,
            ("f", "8") => Some(Self::Float64),
            ("f", "4") => Some(Self::Float32),
            ("i", "1" | "2" | "4" | "8") => bytes.parse().ok().map(Self::Signed),
            ("u", "1" | "2" | "4" | "8") => bytes.parse().ok().map(Self::Unsigned),
            ("O", _) => {
                return Err(format!(
                    "contains Python objects, as made from lists of different lengths; {EXPECTED}, with -1 at the end of short lists"
                ));
            }
            _ => None,
        };
        let unknown = || format!("has numbers of the type {}; {EXPECTED}", quoted(name));
        dtype.map(|dtype| (dtype, order == ">")).ok_or_else(unknown)
    }

    /// A number as an integer, saturated to signed 64 bits. Zero for a fraction.
    fn whole(self, raw: &[u8]) -> i64 {
        let mut all = [0; 8];
        match self {
            Self::Float64 | Self::Float32 => 0,
            Self::Signed(bytes) => {
                all.fill(if raw[bytes - 1] >= 0x80 { 0xff } else { 0 });
                all[..bytes].copy_from_slice(raw);
                i64::from_le_bytes(all)
            }
            Self::Unsigned(bytes) => {
                all[..bytes].copy_from_slice(raw);
                i64::try_from(u64::from_le_bytes(all)).unwrap_or(i64::MAX)
            }
        }
    }

    /// A number in double precision.
    fn double(self, raw: &[u8]) -> f64 {
        match self {
            Self::Float64 => f64::from_le_bytes(raw.try_into().unwrap_or_default()),
            Self::Float32 => f32::from_le_bytes(raw.try_into().unwrap_or_default()).into(),
            _ => self.whole(raw) as f64,
        }
    }
}

/// The numbers of an array with up to two axes.
#[derive(Clone, Debug)]
pub(crate) struct Values {
    /// The bytes of all numbers.
    pub(crate) bytes: Vec<u8>,
    dtype: Dtype,
    by_columns: bool,
    pub(crate) rows: usize,
    pub(crate) columns: usize,
}

impl Values {
    fn raw(&self, row: usize, column: usize) -> &[u8] {
        let at = if self.by_columns { column * self.rows + row } else { row * self.columns + column };
        let width = self.dtype.bytes();
        &self.bytes[at * width..(at + 1) * width]
    }

    /// One number as an integer, saturated to signed 64 bits. Zero for a fraction.
    pub(crate) fn whole(&self, row: usize, column: usize) -> i64 {
        self.dtype.whole(self.raw(row, column))
    }

    /// One number in double precision.
    pub(crate) fn double(&self, row: usize, column: usize) -> f64 {
        self.dtype.double(self.raw(row, column))
    }
}

impl Npz {
    /// Opens an archive.
    ///
    /// # Errors
    /// The file is not an archive; the message tells why.
    pub(crate) fn open(path: &Path) -> Result<Self, String> {
        if path.is_dir() {
            return Err("is a folder; expected a NumPy archive (.npz)".to_owned());
        }
        // Opening a pipe would block.
        if path.exists() && !path.is_file() {
            return Err("is not a regular file; expected a NumPy archive (.npz)".to_owned());
        }
        let mut file = File::open(path).map_err(|error| format!("cannot be read: {error}"))?;
        let mut start = Vec::new();
        let read = (&file).take(6).read_to_end(&mut start).and_then(|_| file.rewind());
        read.map_err(|error| format!("cannot be read: {error}"))?;
        match &start[..] {
            [] => return Err("is empty; expected a NumPy archive (.npz)".to_owned()),
            b"\x93NUMPY" => {
                return Err(
                    "is a single array (.npy); expected several in one archive, as numpy.savez writes them".to_owned()
                );
            }
            [b'P', b'K', ..] => {}
            _ => return Err("is not a NumPy archive (.npz); expected one written by numpy.savez".to_owned()),
        }
        Self::of(file)
    }

    /// The archive in a file.
    pub(crate) fn of(file: File) -> Result<Self, String> {
        let broken = |error| format!("is a damaged NumPy archive, or is cut short ({error})");
        let length = file.metadata().map_err(|error| format!("cannot be read: {error}"))?.len();
        let zip = ZipArchive::new(BufReader::new(file)).map_err(broken)?;
        Ok(Self { zip, length, copies: BTreeMap::new() })
    }

    /// Whether an array may be stored unpacked: no longer than the file.
    pub(crate) fn has_room_for(&self, array: &Array) -> bool {
        array.bytes().is_some_and(|bytes| bytes <= self.length)
    }

    /// The names of the arrays, in their order.
    pub(crate) fn names(&self) -> Vec<String> {
        let name = |name: Cow<'_, str>| name.strip_suffix(".npy").unwrap_or(&name).to_owned();
        self.zip.file_names().map(|known| name(known.unwrap_or_default())).collect()
    }

    /// The header of an array, if the archive has it.
    pub(crate) fn array(&mut self, name: &str) -> Option<Result<Array, String>> {
        let index = self.zip.index_for_name(&format!("{name}.npy"))?;
        Some(self.head(index))
    }

    /// The text of an array of one text.
    pub(crate) fn text(&mut self, name: &str) -> Result<String, String> {
        const LONGEST: u64 = 4096;
        let index = self.zip.index_for_name(&format!("{name}.npy")).ok_or("is missing")?;
        let Head { dtype, shape, length, mut entry, .. } = self.open_head(index)?;
        let kind = dtype.get(1..2).filter(|_| shape.iter().product::<u64>() == 1);
        let bytes = entry.size().saturating_sub(length);
        if !matches!(kind, Some("U" | "S")) || bytes > LONGEST {
            return Err(format!("has numbers of the type {}; expected one short text", quoted(&dtype)));
        }
        let mut text = Vec::new();
        let read = (&mut entry).take(LONGEST).read_to_end(&mut text);
        read.map_err(|error| format!("cannot be read, the file is damaged or cut short ({error})"))?;
        let letters: Option<String> = match kind {
            Some("U") => {
                let number = if dtype.starts_with('>') { u32::from_be_bytes } else { u32::from_le_bytes };
                text.as_chunks::<4>().0.iter().map(|&letter| char::from_u32(number(letter))).collect()
            }
            _ => String::from_utf8(text).ok(),
        };
        Ok(letters.ok_or("is not a text")?.trim_end_matches('\0').to_owned())
    }

    fn head(&mut self, index: usize) -> Result<Array, String> {
        let Head { dtype, by_columns, shape, length, entry, is_packed } = self.open_head(index)?;
        let (dtype, is_big) = Dtype::of(&dtype)?;
        let array = Array { index, dtype, is_big, by_columns, is_packed, shape, head: length };
        let stored = entry.size();
        if array.bytes().and_then(|bytes| bytes.checked_add(array.head)) != Some(stored) {
            let (shape, stored) = (array.shape_in_words(), count(stored.saturating_sub(array.head).into()));
            return Err(format!("has the shape {shape}, which does not fit the {stored} bytes that are stored"));
        }
        Ok(array)
    }

    /// The header of an array, and its numbers.
    fn open_head(&mut self, index: usize) -> Result<Head<'_>, String> {
        let packed = self.zip.by_index_raw(index).map_err(|error| format!("cannot be read: {error}"))?.compression();
        if !matches!(packed, CompressionMethod::Stored | CompressionMethod::Deflated) {
            let packed = packed.to_string().to_lowercase();
            let expected = "write it with numpy.savez or numpy.savez_compressed";
            return Err(format!("is compressed by {packed}, which is not read; {expected}"));
        }
        let is_packed = packed != CompressionMethod::Stored;
        let mut entry = self.zip.by_index(index).map_err(|error| format!("cannot be read: {error}"))?;
        let short = || "has no complete header: the file is damaged, or is not a NumPy array".to_owned();
        let mut fixed = [0; 12];
        entry.read_exact(&mut fixed[..10]).map_err(|_| short())?;
        if !fixed.starts_with(b"\x93NUMPY") {
            return Err(short());
        }
        let (length, start) = match fixed[6] {
            1 => (usize::from(u16::from_le_bytes([fixed[8], fixed[9]])), 10),
            2 | 3 => {
                entry.read_exact(&mut fixed[10..]).map_err(|_| short())?;
                (u32::from_le_bytes([fixed[8], fixed[9], fixed[10], fixed[11]]) as usize, 12)
            }
            version => return Err(format!("is written in version {version} of NumPy's format; expected 1, 2 or 3")),
        };
        if length > LONGEST_HEAD {
            return Err(short());
        }
        let mut text = vec![0; length];
        entry.read_exact(&mut text).map_err(|_| short())?;
        let text = String::from_utf8(text).map_err(|_| short())?;
        let dtype = value(&text, "descr").ok_or_else(short)?;
        if dtype.starts_with('[') {
            return Err("has rows of several fields; expected plain numbers".to_owned());
        }
        let dtype = quoted_text(dtype).ok_or_else(short)?.to_owned();
        let by_columns = match value(&text, "fortran_order").ok_or_else(short)? {
            order if order.starts_with("True") => true,
            order if order.starts_with("False") => false,
            _ => return Err(short()),
        };
        let shape = value(&text, "shape").and_then(tuple).ok_or_else(short)?;
        Ok(Head { dtype, by_columns, shape, length: (start + length) as u64, entry, is_packed })
    }

    /// Reads all numbers of an array in blocks of up to `most` bytes, a multiple of a number's, and compares the checksum.
    pub(crate) fn blocks(&mut self, array: &Array, most: usize, each: &mut dyn FnMut(&[u8])) -> Result<(), String> {
        let broken = |error| format!("cannot be read, the file is damaged or cut short ({error})");
        let mut left = array.bytes().unwrap_or(u64::MAX);
        let mut entry: Box<dyn Read + '_> = match self.copies.get_mut(&array.index) {
            Some(copy) => copy.rewind().map(|()| Box::new(copy)).map_err(broken)?,
            None => Box::new(self.zip.by_index(array.index).map_err(|error| broken(error.into()))?),
        };
        io::copy(&mut (&mut entry).take(array.head), &mut io::sink()).map_err(broken)?;
        let mut block = Vec::new();
        while left > 0 {
            block.clear();
            let read = (&mut entry).take(left.min(most as u64)).read_to_end(&mut block).map_err(broken)?;
            if read == 0 {
                return Err(format!("is cut short: {} bytes are missing", count(left.into())));
            }
            left -= read as u64;
            array.turn(&mut block);
            each(&block);
        }
        // At the end the reader compares the checksum.
        entry.read(&mut [0]).map_err(broken).map(drop)
    }

    /// The numbers of an array: without an axis as one number, with one axis as one column.
    pub(crate) fn values(&mut self, array: &Array) -> Result<Values, String> {
        let expected = array.bytes().unwrap_or(u64::MAX);
        let mut bytes = Vec::with_capacity(expected.min(MOST_RESERVED) as usize);
        self.blocks(array, 1 << 20, &mut |block| bytes.extend_from_slice(block))?;
        let [rows, columns] = match array.shape[..] {
            [] => [1, 1],
            [rows] => [rows, 1],
            [rows, columns] => [rows, columns],
            _ => return Err(format!("has the shape {}; expected rows and columns", array.shape_in_words())),
        };
        let (dtype, by_columns) = (array.dtype, array.by_columns);
        Ok(Values { bytes, dtype, by_columns, rows: rows as usize, columns: columns as usize })
    }

    /// Reads a part of the numbers of an array that is stored row by row and not compressed, from an offset (bytes).
    pub(crate) fn part(&mut self, array: &Array, offset: u64, into: &mut [u8]) -> Result<(), String> {
        let broken = |error: &dyn std::fmt::Display| format!("cannot be read, the file is damaged or packed ({error})");
        let place = array.head + offset;
        let read = match self.copies.get_mut(&array.index) {
            Some(copy) => read_at(copy, place, into),
            None => read_at(&mut self.zip.by_index_seek(array.index).map_err(|error| broken(&error))?, place, into),
        };
        array.turn(into);
        read.map_err(|error| broken(&error))
    }

    /// Lets single rows be read of an array with three axes: one that is compressed or stored column by column is copied
    /// into a temporary file, row by row. Memory does not grow with the array.
    pub(crate) fn unfold(&mut self, array: &mut Array) -> Result<(), String> {
        let [rows, nodes, axes] = array.shape[..] else { return Ok(()) };
        if array.is_by_rows() || array.shape.contains(&0) {
            return Ok(());
        }
        let failed = |error: io::Error| format!("cannot be copied into a temporary file: {error}");
        let (mut copy, mut fault) = (tempfile::tempfile().map_err(failed)?, None);
        self.blocks(array, MOST_HELD, &mut |block| fault = copy.write_all(block).err().or(fault.take()))?;
        fault.map_or(Ok(()), Err).map_err(failed)?;
        if array.by_columns {
            copy = by_rows(&mut copy, [rows, nodes, axes], array.width()).map_err(failed)?;
        }
        self.copies.insert(array.index, copy);
        *array = Array { is_big: false, by_columns: false, is_packed: false, head: 0, ..array.clone() };
        Ok(())
    }
}

/// Copies numbers of a width (bytes) in Fortran order into a temporary file row by row: parts of rows with parts of the nodes.
fn by_rows(from: &mut File, [rows, nodes, axes]: [u64; 3], width: usize) -> io::Result<File> {
    let (mut to, wide) = (tempfile::tempfile()?, width as u64);
    let most = (MOST_HELD as u64 / wide / axes).max(1);
    let across = (most / rows).max(most.isqrt()).min(nodes);
    let down = (most / across).min(rows);
    // The numbers of neighbouring nodes follow each other only where a part has all rows.
    let together = if down == rows { across } else { 1 };
    let (mut part, mut column) = (Vec::new(), Vec::new());
    for (node, row) in (0..nodes)
        .step_by(across as usize)
        .flat_map(|node| (0..rows).step_by(down as usize).map(move |row| (node, row)))
    {
        let (across, down) = (across.min(nodes - node), down.min(rows - row));
        let line = (across * axes) as usize * width;
        part.resize(down as usize * line, 0);
        for (axis, first) in
            (0..axes).flat_map(|axis| (0..across).step_by(together as usize).map(move |node| (axis, node)))
        {
            column.resize((together.min(across - first) * down) as usize * width, 0);
            read_at(from, ((axis * nodes + node + first) * rows + row) * wide, &mut column)?;
            for (at, number) in (0..).zip(column.chunks_exact(width)) {
                let (node, row) = (first + at / down, (at % down) as usize);
                part[row * line + (node * axes + axis) as usize * width..][..width].copy_from_slice(number);
            }
        }
        for (row, line) in (row..).zip(part.chunks_exact(line)) {
            to.seek(SeekFrom::Start((row * nodes + node) * axes * wide))?;
            to.write_all(line)?;
        }
    }
    Ok(to)
}

/// Reads the bytes at a place.
fn read_at(from: &mut (impl Read + Seek), place: u64, into: &mut [u8]) -> io::Result<()> {
    from.seek(SeekFrom::Start(place)).and_then(|_| from.read_exact(into))
}

impl Array {
    /// Turns big-endian numbers.
    fn turn(&self, bytes: &mut [u8]) {
        if self.is_big {
            bytes.chunks_exact_mut(self.width()).for_each(<[u8]>::reverse);
        }
    }

    /// Whether single rows can be read: it is stored row by row and not compressed.
    pub(crate) fn is_by_rows(&self) -> bool {
        !self.by_columns && !self.is_packed
    }

    /// The width of a number (bytes).
    pub(crate) fn width(&self) -> usize {
        self.dtype.bytes()
    }

    /// The numbers with these bytes.
    pub(crate) fn numbers<'b>(&self, bytes: &'b [u8]) -> impl Iterator<Item = f64> + use<'b> {
        let (dtype, is_double) = (self.dtype, self.dtype == Dtype::Float64);
        // Most arrays have doubles, which are read fastest without a look at the type of each.
        let (doubles, others) = if is_double { (bytes, &[][..]) } else { (&[][..], bytes) };
        let doubles = doubles.as_chunks::<8>().0.iter().map(|&number| f64::from_le_bytes(number));
        doubles.chain(others.chunks_exact(self.width()).map(move |raw| dtype.double(raw)))
    }

    /// Whether the array has whole numbers.
    pub(crate) fn is_whole(&self) -> bool {
        matches!(self.dtype, Dtype::Signed(_) | Dtype::Unsigned(_))
    }

    /// NumPy's name of the type.
    pub(crate) fn type_in_words(&self) -> String {
        let kind = match self.dtype {
            Dtype::Float64 | Dtype::Float32 => "float",
            Dtype::Signed(_) => "int",
            Dtype::Unsigned(_) => "uint",
        };
        format!("{kind}{}", 8 * self.dtype.bytes())
    }

    /// Length of the numbers (bytes), if it fits in 64 bits.
    pub(crate) fn bytes(&self) -> Option<u64> {
        self.shape.iter().try_fold(self.dtype.bytes() as u64, |all, &length| all.checked_mul(length))
    }

    /// The shape as NumPy writes it.
    pub(crate) fn shape_in_words(&self) -> String {
        let lengths: Vec<_> = self.shape.iter().map(u64::to_string).collect();
        format!("({}{})", lengths.join(", "), if lengths.len() == 1 { "," } else { "" })
    }
}

/// The text after a key in the header of an array, a dictionary in Python's syntax.
fn value<'t>(text: &'t str, key: &str) -> Option<&'t str> {
    let after = ["'", "\""].iter().find_map(|quote| text.split_once(&format!("{quote}{key}{quote}")))?.1;
    Some(after.trim_start().strip_prefix(':')?.trim_start())
}

/// The text in quotation marks at the start.
fn quoted_text(text: &str) -> Option<&str> {
    let quote = text.chars().next().filter(|c| ['\'', '"'].contains(c))?;
    text[1..].split_once(quote).map(|(inside, _)| inside)
}

/// The numbers of a tuple at the start.
fn tuple(text: &str) -> Option<Vec<u64>> {
    let (inside, _) = text.strip_prefix('(')?.split_once(')')?;
    let parts = inside.split(',').map(str::trim).filter(|part| !part.is_empty());
    // Python 2 wrote an L after long numbers.
    parts.map(|part| part.trim_end_matches('L').parse().ok()).collect()
}

#[cfg(test)]
#[path = "../../tests/inside/npz.rs"]
mod tests;
