//! Stereolithography: triangles, each with its own corners, which are welded here where they are equal.

use super::builder::Builder;
use super::source::{CUT, Coding, DAMAGED, Scalar, Source, vector};
use super::{Cells, Format, Limits, ReadError, content};
use glam::DVec3;
use std::collections::HashMap;

/// The bytes before the first triangle, and of each.
const HEAD: usize = 84;
const TRIANGLE: usize = 50;

/// The number of triangles that a binary file promises.
fn promised(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(80..)?.first_chunk::<4>()?;
    Some(u32::from_le_bytes(*count).into())
}

/// Whether a file has exactly the length of a binary file.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    promised(bytes).is_some_and(|count| HEAD as u64 + TRIANGLE as u64 * count == bytes.len() as u64)
}

pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<Cells, ReadError> {
    let mut source = Source::text(bytes);
    // Many binary files begin with “solid”, too.
    let begins = source.peek().eq_ignore_ascii_case(b"solid");
    let is_text = begins && !is_binary(bytes) && !bytes[..bytes.len().min(1024)].contains(&0);
    let mut welder = Welder { builder: Builder::new(limits), known: HashMap::default() };
    if is_text {
        text(&mut source, &mut welder)?;
    } else {
        source.coding = Coding::Little;
        binary(bytes, &mut source, &mut welder)?;
    }
    welder.builder.finish(&source, 0)
}

/// Reads `facet … vertex x y z vertex x y z vertex x y z … endfacet`, in any number of solids.
fn text(source: &mut Source<'_>, welder: &mut Welder) -> Result<(), ReadError> {
    let mut is_ended = false;
    loop {
        // The name of a solid may be any words.
        while source.peek().eq_ignore_ascii_case(b"solid") {
            source.line();
            is_ended = false;
        }
        let word = source.word();
        // Some programs write `end solid`, `end facet` and `end loop`.
        if word.eq_ignore_ascii_case(b"endsolid") || word.eq_ignore_ascii_case(b"end") {
            source.line();
            is_ended = true;
            continue;
        }
        if word.is_empty() {
            if !is_ended {
                let note = "has no `endsolid` behind its last facet, so that its end may be missing";
                welder.builder.cells.notes.push(note.to_owned());
            }
            return Ok(());
        }
        if !word.eq_ignore_ascii_case(b"facet") {
            return Err(source.wrong(word, "`facet` or `endsolid`"));
        }
        // The normal follows from the corners.
        while !source.peek().eq_ignore_ascii_case(b"vertex") && !source.is_done() {
            let word = source.word();
            if word.eq_ignore_ascii_case(b"endfacet") {
                return Err(source.wrong(word, "`vertex`"));
            }
        }
        let mut corners = [DVec3::ZERO; 3];
        for corner in &mut corners {
            let word = source.word();
            if !word.eq_ignore_ascii_case(b"vertex") {
                return Err(source.wrong(word, "`vertex`"));
            }
            *corner = vector(3, || source.float(Scalar::F64, "a coordinate"))?;
        }
        for expected in ["endloop", "endfacet"] {
            let mut word = source.word();
            let mut last = expected;
            if word.eq_ignore_ascii_case(b"end") {
                (word, last) = (source.word(), &expected[3..]);
            }
            if !word.eq_ignore_ascii_case(last.as_bytes()) {
                return Err(source.wrong(word, &format!("`{expected}`")));
            }
        }
        welder.triangle(corners)?;
    }
}

fn binary(bytes: &[u8], source: &mut Source<'_>, welder: &mut Welder) -> Result<(), ReadError> {
    let Some(count) = promised(bytes) else {
        return Err(content::no_beginning(bytes, Format::Stl, "`solid`, or the 84 bytes of a binary header"));
    };
    let held = (bytes.len() - HEAD) / TRIANGLE;
    if count > held as u64 {
        let message = format!("ends after {held} triangles; expected {count} by its binary header");
        return Err(ReadError::new(message, format!("{CUT}, or name it by its format if it is no STL file")));
    }
    if count == 0 && bytes.len() - HEAD > TRIANGLE {
        return Err(ReadError::new("promises no triangles in its binary header, but has data after it", DAMAGED));
    }
    welder.builder.expect(0, count)?;
    source.at = HEAD;
    // The file is known to have the triangles. A closed surface has half as many points.
    welder.known.reserve(count as usize / 2);
    for _ in 0..count {
        source.skip(3, Scalar::F32, "a normal")?;
        let mut corners = [DVec3::ZERO; 3];
        for corner in &mut corners {
            *corner = vector(3, || source.float(Scalar::F32, "a coordinate"))?;
        }
        source.skip(1, Scalar::U16, "two bytes after a triangle")?;
        welder.triangle(corners)?;
    }
    // Some programs write a few bytes of their own.
    if source.rest().len() >= TRIANGLE {
        welder.builder.tell_rest(source);
    }
    Ok(())
}

/// Makes one point of equal ones.
struct Welder {
    builder: Builder,
    known: HashMap<[u64; 3], u32>,
}

impl Welder {
    fn triangle(&mut self, corners: [DVec3; 3]) -> Result<(), ReadError> {
        let mut indices = [0; 3];
        for (index, corner) in indices.iter_mut().zip(corners) {
            // Zero has two signs.
            let key = (corner + 0.0).to_array().map(f64::to_bits);
            *index = match self.known.get(&key) {
                Some(&known) => known,
                None => {
                    let new = self.builder.point(corner)?;
                    self.known.insert(key, new);
                    new
                }
            };
        }
        self.builder.face(&indices)
    }
}
