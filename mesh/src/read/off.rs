//! Object File Format: a header, numbers of points and faces, and one line for each (<http://www.geomview.org/docs/html/OFF.html>).

use super::builder::Builder;
use super::source::{Scalar, Source};
use super::{Cells, Format, Limits, ReadError, content};
use glam::DVec3;

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
    if let Some(all) = Together::new(&numbers, &source, [points, faces], word) {
        all.points.iter().try_for_each(|&(point, at)| builder.point_at(point, at).map(drop))?;
        all.faces.iter().try_for_each(|face| builder.face(face))?;
        return builder.finish(&source, 0);
    }
    for at in 0..points {
        let mut line = source.next_line().ok_or_else(|| source.ends(&format!("point {} of {points}", at + 1)))?;
        let start = line.at;
        builder.point_at(line.point(Scalar::F64)?, start)?;
    }
    let mut corners = Vec::new();
    for at in 0..faces {
        let mut line = source.next_line().ok_or_else(|| source.ends(&format!("face {} of {faces}", at + 1)))?;
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

/// The points, with their places, and the faces of a file with several in one line.
#[derive(Default)]
struct Together {
    points: Vec<(DVec3, usize)>,
    faces: Vec<Vec<u32>>,
}

impl Together {
    /// Reads so many points and faces as words, if there are fewer lines than that and exactly as many words. They begin in the line
    /// with `numbers`, behind the number of edges, or in the `rest`. What `word`, the first of the file, names follows coordinates.
    fn new(numbers: &Source<'_>, rest: &Source<'_>, [points, faces]: [u64; 2], word: &[u8]) -> Option<Self> {
        if lines(rest) >= points.saturating_add(faces) {
            return None;
        }
        let mut source = rest.clone();
        source.at = numbers.at;
        if !numbers.clone().is_done() {
            source.word();
        }
        let has = |letter: u8| u64::from(word.strip_suffix(b"OFF").is_some_and(|before| before.contains(&letter)));
        let behind = 3 * has(b'N') + 4 * has(b'C') + 2 * has(b'T');
        let mut all = Self::default();
        for _ in 0..points {
            all.points.push((source.point(Scalar::F64).ok()?, source.at - 1));
            source.skip(behind, Scalar::F64, "a number").ok()?;
        }
        // Colours of faces end with their lines.
        let are_lines = lines(&source) >= faces;
        for _ in 0..faces {
            let mut line = are_lines.then(|| source.next_line()).flatten();
            all.faces.push(face(line.as_mut().unwrap_or(&mut source), points)?);
        }
        source.is_done().then_some(all)
    }
}

/// The number of lines that are left.
fn lines(source: &Source<'_>) -> u64 {
    let mut source = source.clone();
    std::iter::from_fn(|| source.next_line()).count() as u64
}

/// A face with some of so many points.
fn face(source: &mut Source<'_>, points: u64) -> Option<Vec<u32>> {
    let mut corner = || source.count(Scalar::I64, "a number").ok();
    let count = corner()?;
    (0..count).map(|_| corner().filter(|&corner| corner < points).and_then(|corner| corner.try_into().ok())).collect()
}
