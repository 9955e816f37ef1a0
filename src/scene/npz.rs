//! Reads NumPy archives (.npz): ZIP archives of plain arrays, as `numpy.savez` and `numpy.savez_compressed` write them.
//!
//! Archives are untrusted. Sizes are compared with the file before memory is allocated, and memory grows only with the
//! data.
//!
//! No library reads the arrays: `npyz` allocates the length that a header claims, up to 4 GiB, before it reads it, and
//! brings twelve crates. It would not replace the checks and messages, which are most of this file.

use crate::reading::words::{count, quoted};
use std::borrow::Cow;
use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;
use zip::read::ZipFile;
use zip::{CompressionMethod, ZipArchive};

/// The longest accepted header of an array (bytes); usual ones have some hundred.
const LONGEST_HEAD: usize = 4096;

/// The largest allocation for an array before it is read (bytes), larger than most arrays and available on every machine.
const MOST_RESERVED: u64 = 1 << 26;

/// An open archive.
#[derive(Debug)]
pub(crate) struct Npz {
    zip: ZipArchive<BufReader<File>>,
    /// Length of the file (bytes).
    length: u64,
}

/// The header of an array in an archive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Array {
    /// Index in the archive.
    index: usize,
    dtype: Dtype,
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

    /// The type of a NumPy name, or a message about it.
    fn of(name: &str) -> Result<Self, String> {
        const EXPECTED: &str = "expected float64, float32 or whole numbers";
        let (order, rest) = name.split_at_checked(1).unwrap_or_default();
        let (letter, bytes) = rest.split_at_checked(1).unwrap_or_default();
        let dtype = match (letter, bytes) {
            ("f", "8") => Self::Float64,
            ("f", "4") => Self::Float32,
            ("i" | "u", "1" | "2" | "4" | "8") => {
                let bytes = bytes.parse().unwrap_or(8);
                if letter == "i" { Self::Signed(bytes) } else { Self::Unsigned(bytes) }
            }
            ("O", _) => {
                return Err(format!(
                    "contains Python objects, as made from lists of different lengths; {EXPECTED}, with -1 at the end of short lists"
                ));
            }
            _ => return Err(format!("has numbers of the type {}; {EXPECTED}", quoted(name))),
        };
        match order {
            "<" | "|" => Ok(dtype),
            _ => Err("has big-endian numbers; expected little-endian ones, as by astype(\"<f8\") or, for indices, astype(\"<i4\")".to_owned()),
        }
    }
}

/// The numbers of an array with one to three axes, row by row.
#[derive(Clone, Debug)]
pub(crate) struct Values {
    bytes: Vec<u8>,
    dtype: Dtype,
    by_columns: bool,
    rows: usize,
    columns: usize,
}

impl Values {
    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    pub(crate) fn columns(&self) -> usize {
        self.columns
    }

    fn raw(&self, row: usize, column: usize) -> &[u8] {
        let at = if self.by_columns { column * self.rows + row } else { row * self.columns + column };
        let width = self.dtype.bytes();
        &self.bytes[at * width..(at + 1) * width]
    }

    /// The bytes of all numbers.
    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// One number as an integer, saturated to signed 64 bits. Zero for a fraction.
    pub(crate) fn whole(&self, row: usize, column: usize) -> i64 {
        let raw = self.raw(row, column);
        match self.dtype {
            Dtype::Float64 | Dtype::Float32 => 0,
            Dtype::Signed(bytes) => {
                let is_negative = raw[bytes - 1] >= 0x80;
                let mut all = [if is_negative { 0xff } else { 0 }; 8];
                all[..bytes].copy_from_slice(raw);
                i64::from_le_bytes(all)
            }
            Dtype::Unsigned(bytes) => {
                let mut all = [0; 8];
                all[..bytes].copy_from_slice(raw);
                i64::try_from(u64::from_le_bytes(all)).unwrap_or(i64::MAX)
            }
        }
    }

    /// One number in double precision.
    pub(crate) fn double(&self, row: usize, column: usize) -> f64 {
        let raw = self.raw(row, column);
        match self.dtype {
            Dtype::Float64 => f64::from_le_bytes(raw.try_into().unwrap_or_default()),
            Dtype::Float32 => f32::from_le_bytes(raw.try_into().unwrap_or_default()).into(),
            _ => self.whole(row, column) as f64,
        }
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
        Ok(Self { zip: ZipArchive::new(BufReader::new(file)).map_err(broken)?, length })
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
        let kind = dtype.get(1..2).filter(|_| shape.iter().product::<u64>() == 1 && !dtype.starts_with('>'));
        let bytes = entry.size().saturating_sub(length);
        if !matches!(kind, Some("U" | "S")) || bytes > LONGEST {
            return Err(format!("has numbers of the type {}; expected one short text", quoted(&dtype)));
        }
        let mut text = Vec::new();
        let read = (&mut entry).take(LONGEST).read_to_end(&mut text);
        read.map_err(|error| format!("cannot be read, the file is damaged or cut short ({error})"))?;
        let letters: Option<String> = match kind {
            Some("U") => {
                text.as_chunks::<4>().0.iter().map(|&letter| char::from_u32(u32::from_le_bytes(letter))).collect()
            }
            _ => String::from_utf8(text).ok(),
        };
        Ok(letters.ok_or("is not a text")?.trim_end_matches('\0').to_owned())
    }

    fn head(&mut self, index: usize) -> Result<Array, String> {
        let Head { dtype, by_columns, shape, length, entry, is_packed } = self.open_head(index)?;
        let dtype = Dtype::of(&dtype)?;
        let array = Array { index, dtype, by_columns, is_packed, shape, head: length };
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

    /// Reads all numbers of an array in blocks of up to `most` bytes, and compares the checksum.
    pub(crate) fn blocks(&mut self, array: &Array, most: usize, each: &mut dyn FnMut(&[u8])) -> Result<(), String> {
        let broken = |error| format!("cannot be read, the file is damaged or cut short ({error})");
        let mut left = array.bytes().unwrap_or(u64::MAX);
        let mut entry = self.zip.by_index(array.index).map_err(|error| broken(error.into()))?;
        std::io::copy(&mut (&mut entry).take(array.head), &mut std::io::sink()).map_err(broken)?;
        let mut block = Vec::new();
        while left > 0 {
            block.clear();
            let read = (&mut entry).take(left.min(most as u64)).read_to_end(&mut block).map_err(broken)?;
            if read == 0 {
                return Err(format!("is cut short: {} bytes are missing", count(left.into())));
            }
            left -= read as u64;
            each(&block);
        }
        // At the end the reader compares the checksum.
        entry.read(&mut [0]).map_err(broken).map(drop)
    }

    /// The numbers of an array: without an axis as one number, with one axis as one column, with three axes with the last two in one row.
    pub(crate) fn values(&mut self, array: &Array) -> Result<Values, String> {
        let expected = array.bytes().unwrap_or(u64::MAX);
        let mut bytes = Vec::with_capacity(expected.min(MOST_RESERVED) as usize);
        self.blocks(array, 1 << 20, &mut |block| bytes.extend_from_slice(block))?;
        let [rows, columns] = match array.shape[..] {
            [] => [1, 1],
            [rows] => [rows, 1],
            [rows, columns] => [rows, columns],
            [rows, columns, depth] if !array.by_columns => [rows, columns * depth],
            _ => return Err(format!("has the shape {}; expected rows and columns", array.shape_in_words())),
        };
        let (dtype, by_columns) = (array.dtype, array.by_columns);
        Ok(Values { bytes, dtype, by_columns, rows: rows as usize, columns: columns as usize })
    }
}

impl Npz {
    /// Reads a part of the numbers of an array, from an offset (bytes).
    pub(crate) fn part(&mut self, array: &Array, offset: u64, into: &mut [u8]) -> Result<(), String> {
        use std::io::SeekFrom;
        let broken = |error: &dyn std::fmt::Display| format!("cannot be read, the file is damaged or packed ({error})");
        let mut entry = self.zip.by_index_seek(array.index).map_err(|error| broken(&error))?;
        entry.seek(SeekFrom::Start(array.head + offset)).map_err(|error| broken(&error))?;
        entry.read_exact(into).map_err(|error| broken(&error))
    }
}

impl Array {
    /// Whether the array has numbers with a point.
    pub(crate) fn is_float(&self) -> bool {
        matches!(self.dtype, Dtype::Float64 | Dtype::Float32)
    }

    /// Whether rows, not columns, are contiguous.
    pub(crate) fn is_by_rows(&self) -> bool {
        !self.by_columns
    }

    /// Whether it is compressed, so that no part of it can be read alone.
    pub(crate) fn is_packed(&self) -> bool {
        self.is_packed
    }

    /// The width of a number (bytes).
    pub(crate) fn width(&self) -> usize {
        self.dtype.bytes()
    }

    /// The numbers with these bytes, for an array of numbers with a point.
    pub(crate) fn numbers<'b>(&self, bytes: &'b [u8]) -> impl Iterator<Item = f64> + use<'b> {
        let is_double = self.dtype == Dtype::Float64;
        let doubles = if is_double { bytes.as_chunks::<8>().0 } else { &[] };
        let singles = if is_double { &[] } else { bytes.as_chunks::<4>().0 };
        let doubles = doubles.iter().map(|&number| f64::from_le_bytes(number));
        doubles.chain(singles.iter().map(|&number| f64::from(f32::from_le_bytes(number))))
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
mod tests {
    use super::*;

    #[test]
    fn heads_are_read_as_numpy_writes_them() {
        let text = "{'descr': '<f8', 'fortran_order': False, 'shape': (64, 3), }          \n";
        assert_eq!(value(text, "descr").and_then(quoted_text), Some("<f8"));
        assert!(value(text, "fortran_order").unwrap().starts_with("False"));
        assert_eq!(value(text, "shape").and_then(tuple), Some(vec![64, 3]));
        assert_eq!(tuple("(3L,)"), Some(vec![3]));
        assert_eq!(tuple("()"), Some(vec![]));
        assert_eq!((tuple("(3"), tuple("(-1, 2)"), tuple("(99999999999999999999,)")), (None, None, None));
        assert_eq!((value(text, "size"), quoted_text("<f8"), quoted_text("'<f8")), (None, None, None));
    }

    #[test]
    fn types_are_known_or_refused_in_words() {
        assert_eq!(Dtype::of("<f8"), Ok(Dtype::Float64));
        assert_eq!(Dtype::of("|u1"), Ok(Dtype::Unsigned(1)));
        for (name, words) in [
            (">f8", "big-endian"),
            ("<f2", "of the type \"<f2\""),
            ("<c16", "of the type"),
            ("|O", "Python objects"),
            ("<U7", "of the type"),
            ("", "of the type"),
            ("é", "of the type"),
        ] {
            assert!(Dtype::of(name).unwrap_err().contains(words), "{name}");
        }
    }

    #[test]
    fn whole_numbers_of_all_widths_keep_their_sign() {
        for bytes in [1, 2, 4, 8] {
            let mut raw = (-1i64).to_le_bytes()[..bytes].to_vec();
            raw.extend(&5i64.to_le_bytes()[..bytes]);
            let mut numbers =
                Values { bytes: raw, dtype: Dtype::Signed(bytes), by_columns: false, rows: 1, columns: 2 };
            assert_eq!((numbers.whole(0, 0), numbers.whole(0, 1)), (-1, 5));
            numbers.dtype = Dtype::Unsigned(bytes);
            let largest = if bytes == 8 { i64::MAX } else { (1 << (8 * bytes)) - 1 };
            assert_eq!((numbers.whole(0, 0), numbers.double(0, 1)), (largest, 5.0));
        }
    }
}
