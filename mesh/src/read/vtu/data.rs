//! The numbers of arrays: text, or Base64 or raw bytes, packed or not.

use super::{Array, Layout, Place};
use crate::read::ReadError;
use crate::read::source::{CUT, DAMAGED, Source, quoted};
use base64::Engine;
use base64::engine::general_purpose::STANDARD_NO_PAD;
use flate2::read::ZlibDecoder;
use std::borrow::Cow;
use std::io::Read;

impl Layout<'_> {
    pub(super) fn spend(&self, count: usize) -> Result<(), ReadError> {
        match self.left.get().checked_sub(count) {
            Some(left) => {
                self.left.set(left);
                Ok(())
            }
            None => Err(self.too_long()),
        }
    }

    fn too_long(&self) -> ReadError {
        let message = format!("has more than {} numbers in its arrays and faces", self.most);
        ReadError::new(message, COARSER)
    }

    pub(super) fn integers(&self, array: &Array, name: &[u8], most: usize) -> Result<Vec<i64>, ReadError> {
        let mut numbers = Vec::new();
        self.each(array, name, most, |source| {
            if numbers.len() >= most {
                return Err(too_long(name, most));
            }
            numbers.push(source.integer(array.scalar, "an integer")?);
            Ok(())
        })?;
        Ok(numbers)
    }

    /// Reads an array of at most so many numbers until its end.
    pub(super) fn each(
        &self,
        array: &Array,
        name: &[u8],
        most: usize,
        mut read: impl FnMut(&mut Source<'_>) -> Result<(), ReadError>,
    ) -> Result<(), ReadError> {
        let bytes;
        let mut source = match array.place {
            Place::Text(start, end) => Source::part(self.bytes, start, end),
            _ => {
                bytes = self.unpacked(array, name, most)?;
                Source::binary(&bytes, self.coding)
            }
        };
        while !source.is_done() {
            read(&mut source).map_err(|error| {
                let message = format!("{}, in its array {}", error.message, quoted(name));
                ReadError { message, help: error.help }
            })?;
        }
        Ok(())
    }

    /// The bytes of an array that is no text.
    fn unpacked(&self, array: &Array, name: &[u8], most: usize) -> Result<Cow<'_, [u8]>, ReadError> {
        let size = array.scalar.size();
        let too_long = || if most < self.left.get() { too_long(name, most) } else { self.too_long() };
        let most = most.min(self.left.get()).saturating_mul(size);
        let cut = || ReadError::new(format!("ends in its array {}", quoted(name)), CUT);
        let (encoded, is_raw) = match array.place {
            Place::Text(start, end) | Place::Inline(start, end) => (&self.bytes[start..end], false),
            Place::Appended(offset) => {
                let (data, is_raw) = self.appended.ok_or_else(|| {
                    let message = format!("has no `<AppendedData>`, where its array {} should be", quoted(name));
                    ReadError::new(message, DAMAGED)
                })?;
                (data.get(offset..).ok_or_else(cut)?, is_raw)
            }
        };
        if encoded.trim_ascii().is_empty() && !is_raw {
            return Ok(Cow::Borrowed(&[]));
        }
        let get = |length: usize| -> Result<Cow<'_, [u8]>, ReadError> {
            let bytes = if is_raw { Cow::Borrowed(encoded) } else { Cow::Owned(from_base64(encoded, length)) };
            if bytes.len() < length { Err(cut()) } else { Ok(bytes) }
        };
        let word = self.header.size();
        let number = |bytes: &[u8], at: usize| {
            let length = Source::binary(&bytes[at * word..], self.coding).count(self.header, "a length");
            length.ok().and_then(|length| length.try_into().ok()).unwrap_or(usize::MAX)
        };
        let first = number(&get(word)?, 0);
        if self.packer.is_empty() {
            if first > most {
                return Err(too_long());
            }
            let bytes = get(word + first)?;
            self.spend(first / size)?;
            return Ok(match bytes {
                Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[word..word + first]),
                Cow::Owned(mut bytes) => {
                    bytes.truncate(word + first);
                    bytes.drain(..word);
                    Cow::Owned(bytes)
                }
            });
        }
        if self.packer != "vtkZLibDataCompressor" {
            let message = format!("is packed by {}; expected `vtkZLibDataCompressor`", quoted(self.packer.as_bytes()));
            return Err(ReadError::new(message, "write it packed by zlib, or not packed"));
        }
        // The number of blocks, the length of each, that of the last, and the packed length of each.
        let words =
            first.checked_add(3).and_then(|words| words.checked_mul(word)).filter(|&length| length <= self.bytes.len());
        let words = words.ok_or_else(cut)?;
        let header = get(words)?;
        let lengths = (0..first).map(|block| number(&header, 3 + block));
        let total = lengths.clone().try_fold(words, usize::checked_add);
        let total = total.filter(|&total| total <= self.bytes.len()).ok_or_else(cut)?;
        let packed = get(total)?;
        let mut bytes = Vec::new();
        let mut start = words;
        for length in lengths {
            let block = ZlibDecoder::new(&packed[start..start + length]);
            let left = most - bytes.len();
            let is_read = block.take(left as u64 + 1).read_to_end(&mut bytes).is_ok();
            if bytes.len() > most {
                return Err(too_long());
            }
            if !is_read {
                return Err(ReadError::new(format!("has damaged packed data in its array {}", quoted(name)), DAMAGED));
            }
            start += length;
        }
        self.spend(bytes.len().max(total) / size)?;
        Ok(Cow::Owned(bytes))
    }
}

/// The remedy for large files.
const COARSER: &str = "make the mesh coarser, with a decimation of the program that wrote it";

fn too_long(name: &[u8], most: usize) -> ReadError {
    let message = format!("has more than {most} numbers in its array {}", quoted(name));
    ReadError::new(message, COARSER)
}

/// The first bytes of Base64, at least so many if they are there. Padding ends a part, after which another one begins.
fn from_base64(text: &[u8], length: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut part = Vec::new();
    let end = |part: &mut Vec<u8>, bytes: &mut Vec<u8>| {
        let is_sound = STANDARD_NO_PAD.decode_vec(&*part, bytes).is_ok();
        part.clear();
        is_sound
    };
    for &byte in text {
        match byte {
            b'=' => {
                if !part.is_empty() && !end(&mut part, &mut bytes) {
                    return bytes;
                }
            }
            b' ' | b'\t' | b'\r' | b'\n' => {}
            // The end of the element.
            b'<' => break,
            _ => part.push(byte),
        }
        if part.len() == 1 << 12 && !end(&mut part, &mut bytes) || bytes.len() >= length {
            return bytes;
        }
    }
    end(&mut part, &mut bytes);
    bytes
}
