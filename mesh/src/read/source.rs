//! Bytes read one number or word after the other, as text or as binary numbers.

use super::ReadError;
use glam::DVec3;

/// The remedy for a file that ends early.
pub(super) const CUT: &str = "the file is incomplete: copy, download or write it again";
pub(super) const DAMAGED: &str = "the file is damaged: copy, download or write it again";

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Coding {
    Text,
    Little,
    Big,
}

/// A type of binary numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    /// The type of a name in PLY or in VTK's files, in capital letters or not.
    pub(super) fn named(name: &[u8]) -> Option<Self> {
        Some(match &*name.to_ascii_lowercase() {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" | b"unsigned_char" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" | b"unsigned_short" => Self::U16,
            // Indices have 32 bits in VTK's legacy format.
            b"int" | b"int32" | b"vtkidtype" => Self::I32,
            b"uint" | b"uint32" | b"unsigned_int" => Self::U32,
            // No standard of PLY has these, but large meshes do.
            b"long" | b"int64" | b"vtktypeint64" => Self::I64,
            b"unsigned_long" | b"uint64" | b"vtktypeuint64" => Self::U64,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }
}

/// Bytes, and a place in them.
#[derive(Clone, Debug)]
pub(super) struct Source<'b> {
    /// The whole file.
    bytes: &'b [u8],
    /// The place of the next byte.
    pub(super) at: usize,
    /// The end of what is read: of the file, or of a line.
    end: usize,
    pub(super) coding: Coding,
}

fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t'..=b'\r')
}

impl<'b> Source<'b> {
    /// A text, without its byte order mark.
    pub(super) fn text(bytes: &'b [u8]) -> Self {
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Self { bytes, at, end: bytes.len(), coding: Coding::Text }
    }

    pub(super) fn part(bytes: &'b [u8], start: usize, end: usize) -> Self {
        Self { bytes, at: start, end, coding: Coding::Text }
    }

    pub(super) fn rest(&self) -> &'b [u8] {
        &self.bytes[self.at..self.end]
    }

    /// A place in words: a line of a text, or a byte.
    pub(super) fn place(&self, at: usize) -> String {
        match self.coding {
            Coding::Text => {
                let before = at.min(self.bytes.len());
                format!("in line {}", 1 + (0..before).filter(|&at| self.ends_line(at)).count())
            }
            _ => format!("at byte {at}"),
        }
    }

    /// Whether a byte is the last of the end of a line: a line feed, a carriage return, or both.
    fn ends_line(&self, at: usize) -> bool {
        self.bytes[at] == b'\n' || self.bytes[at] == b'\r' && self.bytes.get(at + 1) != Some(&b'\n')
    }

    fn skip_space(&mut self) {
        while self.at < self.end {
            match self.bytes[self.at] {
                byte if is_space(byte) => self.at += 1,
                // A line that is continued in the next.
                b'\\' if matches!(self.rest(), [b'\\', b'\n' | b'\r', ..]) => self.at += 1,
                _ => break,
            }
        }
    }

    /// Whether nothing is left, except space after a text.
    pub(super) fn is_done(&mut self) -> bool {
        if self.coding == Coding::Text {
            self.skip_space();
        }
        self.at == self.end
    }

    /// The next word, empty at the end.
    pub(super) fn word(&mut self) -> &'b [u8] {
        self.skip_space();
        let rest = self.rest();
        let length = rest.iter().position(|&byte| is_space(byte)).unwrap_or(rest.len());
        self.at += length;
        &rest[..length]
    }

    /// The next word, without going on.
    pub(super) fn peek(&mut self) -> &'b [u8] {
        let at = self.at;
        let word = self.word();
        self.at = at;
        word
    }

    /// The rest of the line, and goes to the next.
    pub(super) fn line(&mut self) -> &'b [u8] {
        let rest = self.rest();
        let is_end = |&byte: &u8| byte <= b'\r' && (byte == b'\n' || byte == b'\r');
        let length = rest.iter().position(is_end).unwrap_or(rest.len());
        let end = if rest[length..].starts_with(b"\r\n") { 2 } else { 1 };
        self.at += (length + end).min(rest.len());
        &rest[..length]
    }

    /// The next line that is not empty and not a comment, with the lines that continue it.
    pub(super) fn next_line(&mut self, comment: u8) -> Option<Self> {
        while !self.is_done() {
            let start = self.at;
            while self.line().ends_with(b"\\") && self.at < self.end {}
            if self.bytes[start] != comment {
                return Some(Self { at: start, end: self.at, ..self.clone() });
            }
        }
        None
    }

    /// The fields of a line between commas that are not blank, with their numbers.
    pub(super) fn fields(&self) -> impl Iterator<Item = (usize, Self)> {
        let (bytes, mut next) = (self.bytes, self.at);
        let parts = self.rest().split(|&byte| byte == b',').map(move |part| {
            let start = next;
            next += part.len() + 1;
            Self::part(bytes, start, start + part.len())
        });
        parts.enumerate().filter(|(_, part)| !part.rest().trim_ascii().is_empty())
    }

    pub(super) fn take(&mut self, count: usize, expected: &str) -> Result<&'b [u8], ReadError> {
        let rest = self.rest();
        if count > rest.len() {
            return Err(self.ends(expected));
        }
        self.at += count;
        Ok(&rest[..count])
    }

    /// So many numbers, not looked at: in text, words.
    pub(super) fn skip(&mut self, count: u64, scalar: Scalar, expected: &str) -> Result<(), ReadError> {
        if self.coding == Coding::Text {
            for _ in 0..count {
                if self.word().is_empty() {
                    return Err(self.ends(expected));
                }
            }
            return Ok(());
        }
        let length = usize::try_from(count).ok().and_then(|count| count.checked_mul(scalar.size()));
        self.take(length.unwrap_or(usize::MAX), expected)?;
        Ok(())
    }

    #[inline]
    fn array<const N: usize>(&mut self, expected: &str) -> Result<[u8; N], ReadError> {
        match self.rest().first_chunk::<N>() {
            Some(bytes) => {
                self.at += N;
                let mut bytes = *bytes;
                if self.coding == Coding::Big {
                    bytes.reverse();
                }
                Ok(bytes)
            }
            None => Err(self.ends(expected)),
        }
    }

    /// A number: a coordinate, for example.
    #[inline]
    pub(super) fn float(&mut self, scalar: Scalar, expected: &str) -> Result<f64, ReadError> {
        self.number(scalar, expected, false)
    }

    /// A number, or NaN if it may be unknown.
    #[inline]
    fn number(&mut self, scalar: Scalar, expected: &str, may_be_unknown: bool) -> Result<f64, ReadError> {
        if self.coding != Coding::Text {
            return match scalar {
                Scalar::F32 => Ok(f64::from(f32::from_le_bytes(self.array(expected)?))),
                Scalar::F64 => Ok(f64::from_le_bytes(self.array(expected)?)),
                _ => Ok(self.integer(scalar, expected)? as f64),
            };
        }
        let word = self.word();
        match real(word).filter(|value| value.is_finite()) {
            Some(value) => Ok(value),
            None if may_be_unknown && is_no_number(word) => Ok(f64::NAN),
            None => Err(match comma(word) {
                Some(help) => ReadError::new(self.wrong(word, expected).message, help),
                None => self.wrong(word, expected),
            }),
        }
    }

    /// A coordinate of a point, or what programs write for one that they do not know, which is read as NaN.
    #[inline]
    pub(super) fn coordinate(&mut self, scalar: Scalar) -> Result<f64, ReadError> {
        self.number(scalar, "a coordinate", true)
    }

    /// The coordinates of a point, one after the other. Those that are no numbers are NaN.
    #[inline]
    pub(super) fn point(&mut self, scalar: Scalar) -> Result<DVec3, ReadError> {
        Ok(DVec3::new(self.coordinate(scalar)?, self.coordinate(scalar)?, self.coordinate(scalar)?))
    }

    /// An integer: an index, for example.
    #[inline]
    pub(super) fn integer(&mut self, scalar: Scalar, expected: &str) -> Result<i64, ReadError> {
        if self.coding == Coding::Text {
            let word = self.word();
            return integer(word).ok_or_else(|| self.wrong(word, expected));
        }
        let start = self.at;
        let whole = |value: f64| (value.fract() == 0.0 && value.abs() < 1e15).then_some(value as i64);
        let value = match scalar {
            Scalar::I8 => Some(i8::from_le_bytes(self.array(expected)?).into()),
            Scalar::U8 => Some(u8::from_le_bytes(self.array(expected)?).into()),
            Scalar::I16 => Some(i16::from_le_bytes(self.array(expected)?).into()),
            Scalar::U16 => Some(u16::from_le_bytes(self.array(expected)?).into()),
            Scalar::I32 => Some(i32::from_le_bytes(self.array(expected)?).into()),
            Scalar::U32 => Some(u32::from_le_bytes(self.array(expected)?).into()),
            Scalar::I64 => Some(i64::from_le_bytes(self.array(expected)?)),
            Scalar::U64 => i64::try_from(u64::from_le_bytes(self.array(expected)?)).ok(),
            Scalar::F32 => whole(f32::from_le_bytes(self.array(expected)?).into()),
            Scalar::F64 => whole(f64::from_le_bytes(self.array(expected)?)),
        };
        value.ok_or_else(|| {
            ReadError::new(format!("has a number out of range {}; expected {expected}", self.place(start)), DAMAGED)
        })
    }

    /// A number of things that follow.
    pub(super) fn count(&mut self, scalar: Scalar, expected: &str) -> Result<u64, ReadError> {
        let start = self.at;
        let count = self.integer(scalar, expected)?;
        u64::try_from(count).map_err(|_| self.found(&count.to_string(), start, expected))
    }

    /// The error of a word that was just read, or of the end.
    pub(super) fn wrong(&self, word: &[u8], expected: &str) -> ReadError {
        if word.is_empty() { self.ends(expected) } else { self.found(&quoted(word), self.at - word.len(), expected) }
    }

    pub(super) fn found(&self, found: &str, at: usize, expected: &str) -> ReadError {
        let found = if found.starts_with('`') { found.to_owned() } else { format!("`{found}`") };
        ReadError::new(format!("has {found} {}; expected {expected}", self.place(at)), DAMAGED)
    }

    pub(super) fn ends(&self, expected: &str) -> ReadError {
        if self.end < self.bytes.len() {
            let place = self.place(self.end.saturating_sub(1));
            return ReadError::new(format!("has nothing more {place}; expected {expected}"), DAMAGED);
        }
        ReadError::new(format!("ends {}; expected {expected}", self.place(self.bytes.len())), CUT)
    }
}

/// A number in the notation of C, or in that of Fortran: `1.5D+00`.
#[inline]
fn real(word: &[u8]) -> Option<f64> {
    let word = std::str::from_utf8(word).ok()?;
    word.parse().ok().or_else(|| word.replace(['D', 'd'], "e").parse().ok())
}

/// What to do about a number with a comma.
fn comma(word: &[u8]) -> Option<String> {
    let word = std::str::from_utf8(word).ok().filter(|word| word.contains(','))?;
    let point = word.replacen(',', ".", 1);
    let is_number = |text: &str| text.is_empty() || text.parse::<f64>().is_ok();
    match () {
        () if !word.ends_with(',') && is_number(&point) => Some(format!("write a decimal point, not a comma: {point}")),
        () if word.split(',').all(is_number) => Some("separate numbers by spaces, not by commas".to_owned()),
        () => None,
    }
}

/// Whether a word stands for a number that is none, in the notations of C and of Windows: `-nan(ind)`, `1.#QNAN`, `inf`.
fn is_no_number(word: &[u8]) -> bool {
    let lower = word.to_ascii_lowercase();
    let unsigned = lower.strip_prefix(b"-").or(lower.strip_prefix(b"+")).unwrap_or(&lower);
    matches!(unsigned, b"nan" | b"inf" | b"infinity" | [b'1', b'.', b'#', ..] | [b'n', b'a', b'n', b'(', ..])
}

pub(super) fn integer(word: &[u8]) -> Option<i64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// The beginning of some bytes, in quotes and readable.
pub(super) fn quoted(bytes: &[u8]) -> String {
    /// The most characters that are shown.
    const MOST: usize = 40;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * MOST)]);
    let mut shown: String = text.chars().take(MOST).flat_map(char::escape_debug).collect();
    if text.chars().count() > MOST {
        shown.push('…');
    }
    format!("`{shown}`")
}
