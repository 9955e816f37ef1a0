//! Wavefront: points and polygons, one a line. Names of groups, objects and materials become groups of points. Textures, normals, lines
//! and free-form curves are left out.

use super::builder::Builder;
use super::source::{Scalar, Source, integer};
use super::{Cells, Limits, ReadError};

pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<Cells, ReadError> {
    let mut source = Source::text(bytes);
    source.comment = Some(b'#');
    let mut builder = Builder::new(limits);
    let mut corners = Vec::new();
    // The first keyword that is not one of the format.
    let mut unknown = None;
    while let Some(mut line) = source.next_line() {
        match line.word() {
            b"v" => {
                let start = line.at;
                builder.point_at(line.point(Scalar::F64)?, start)?;
            }
            b"f" | b"fo" => {
                corners.clear();
                while !line.is_done() {
                    let start = line.at;
                    let word = line.word();
                    let point = word.split(|&byte| byte == b'/').next().unwrap_or_default();
                    let index = match integer(point) {
                        Some(index @ 1..) => index - 1,
                        // Counted backwards from the last point.
                        Some(index @ ..=-1) => index.saturating_add(builder.points() as i64),
                        _ => return Err(line.wrong(word, "the number of a point, counted from 1")),
                    };
                    corners.push(builder.corner(index, start, &line)?);
                }
                builder.face(&corners)?;
            }
            b"g" => builder.name(0, groups(line.rest())),
            b"o" => builder.name(1, vec![whole(line.rest())]),
            b"usemtl" => builder.name(2, vec![whole(line.rest())]),
            b"vt" | b"vn" | b"vp" | b"s" | b"l" | b"p" | b"mtllib" => {}
            // The first keyword of a free-form curve or surface.
            b"cstype" => {
                let error =
                    ReadError::new("has free-form curves or surfaces only", "export it as triangles or polygons");
                unknown = unknown.or(Some(error));
            }
            word => unknown = unknown.or_else(|| Some(line.wrong(word, "`v`, `f` or another keyword of OBJ"))),
        }
    }
    // Keywords of rare kinds are skipped in a file that has faces. Without faces, the first probably says why.
    match unknown {
        Some(error) if builder.is_empty() => Err(error),
        _ => builder.finish(&source, 1),
    }
}

/// The rest of a line as a name, without a comment behind it.
fn whole(rest: &[u8]) -> String {
    let begins = |pair: &[u8]| pair[0].is_ascii_whitespace() && pair[1] == b'#';
    let name = &rest[..rest.windows(2).position(begins).unwrap_or(rest.len())];
    String::from_utf8_lossy(name.trim_ascii()).into_owned()
}

/// The groups that a line names. By the format each word is one, but many programs write one name with spaces: both are names.
fn groups(rest: &[u8]) -> Vec<String> {
    /// More words are a sentence. This limits the groups of a face.
    const MOST: usize = 8;
    let whole = whole(rest);
    let words: Vec<_> = whole.split_whitespace().collect();
    let each = words.iter().filter(|_| (2..=MOST).contains(&words.len()));
    each.map(|&word| word.to_owned()).chain([whole.clone()]).collect()
}
