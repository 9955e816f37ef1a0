//! Arrays in NumPy's file format, written into archives.

use std::io::{self, Seek, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// Begins an array of `length` bytes in the archive; its numbers are written next.
pub(crate) fn begin(
    archive: &mut ZipWriter<impl Write + Seek>,
    name: &str,
    number: &str,
    shape: &str,
    bytes: u64,
) -> io::Result<()> {
    let header = header(number, shape);
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644)
        .large_file(header.len() as u64 + bytes >= u64::from(u32::MAX));
    archive.start_file(format!("{name}.npy"), options)?;
    archive.write_all(&header)
}

/// The header of an array in NumPy's file format, version 1.0, for a number type and a shape in Python's notation.
fn header(number: &str, shape: &str) -> Vec<u8> {
    let mut text = format!("{{'descr': '{number}', 'fortran_order': False, 'shape': {shape}, }}");
    // There are ten bytes before the text; the data begin at a multiple of 64.
    let unpadded = 10 + text.len() + 1;
    text.extend(std::iter::repeat_n(' ', unpadded.next_multiple_of(64) - unpadded));
    text.push('\n');
    let length = u16::try_from(text.len()).expect("a short text");
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend(length.to_le_bytes());
    header.extend(text.bytes());
    header
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn header_is_aligned() {
        for shape in ["(181,)", "(181, 64, 3)", "(181, 1000000, 3)"] {
            let header = header("<f8", shape);
            assert_eq!(header.len() % 64, 0);
            assert_eq!(usize::from(header[8]) + 256 * usize::from(header[9]), header.len() - 10);
            assert_eq!(header.last(), Some(&b'\n'));
        }
    }
}
