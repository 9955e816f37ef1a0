//! Object File Format: a header, numbers of points and faces, and one line for each (<http://www.geomview.org/docs/html/OFF.html>).

use super::builder::Builder;
use super::source::{Scalar, Source};
use super::{Cells, Format, Limits, ReadError, content};

pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<Cells, ReadError> {
    let mut source = Source::text(bytes);
    source.comment = Some(b'#');
    let mut header = source.next_line().ok_or_else(|| source.ends("`OFF`"))?;
    let mut word = header.word();
    // The number of points may follow without a space, as in the files of ModelNet: `OFF490 518 0`.
    if word.starts_with(b"OFF") {
        (word, header.at) = (b"OFF", header.at + 3 - word.len());
    }
    // Normals (N), colours (C) and coordinates of textures (ST) follow the coordinates in their line.
    match word.strip_suffix(b"OFF") {
        Some(b"" | b"C" | b"N" | b"CN" | b"NC" | b"ST" | b"STC" | b"STN" | b"STCN") => {}
        Some(_) => {
            let found = header.wrong(word, "points in space: `OFF`, `COFF`, `NOFF` or `STOFF`").message;
            return Err(ReadError::new(found, "write it with three coordinates for each point"));
        }
        None => return Err(content::no_beginning(bytes, Format::Off, "`OFF`")),
    }
    if header.peek() == b"BINARY" {
        return Err(ReadError::new("is a binary OFF file; expected text", "write it as text, or as binary PLY"));
    }
    // The numbers are in the same line, or in the next.
    let mut numbers = match header.is_done() {
        false => header,
        true => source.next_line().ok_or_else(|| source.ends("the number of points"))?,
    };
    let points = numbers.count(Scalar::I64, "the number of points")?;
    let faces = numbers.count(Scalar::I64, "the number of faces")?;
    let mut builder = Builder::new(limits);
    builder.expect(points, faces)?;
    for at in 0..points {
        let mut line =
            source.next_line().ok_or_else(|| source.ends(&format!("a line with point {} of {points}", at + 1)))?;
        let start = line.at;
        builder.point_at(line.point(Scalar::F64)?, start)?;
    }
    let mut corners = Vec::new();
    for at in 0..faces {
        let mut line =
            source.next_line().ok_or_else(|| source.ends(&format!("a line with face {} of {faces}", at + 1)))?;
        corners.clear();
        for _ in 0..line.count(Scalar::I64, "the number of corners of a face")? {
            let start = line.at;
            let index = line.integer(Scalar::I64, "the index of a point")?;
            corners.push(builder.corner(index, start, &line)?);
        }
        builder.face(&corners)?;
    }
    if let Some(mut rest) = source.next_line() {
        builder.tell_rest(&mut rest);
    }
    builder.finish(&source, 0)
}
