//! Wavefront: points and polygons, one a line. Textures, normals, materials, lines and free-form curves are left out.

use super::cells::Builder;
use super::source::{Scalar, Source, integer};
use super::{Cells, Limits, ReadError};
use glam::DVec3;

pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<Cells, ReadError> {
    let mut source = Source::text(bytes);
    let mut builder = Builder::new(limits);
    let mut corners = Vec::new();
    // The first keyword that is not one of the format.
    let mut unknown = None;
    while let Some(mut line) = source.next_line(b'#') {
        match line.word() {
            b"v" => {
                let mut coordinate = || line.float(Scalar::F64, "a coordinate");
                builder.point(DVec3::new(coordinate()?, coordinate()?, coordinate()?))?;
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
            b"vt" | b"vn" | b"vp" | b"g" | b"o" | b"s" | b"l" | b"p" | b"usemtl" | b"mtllib" => {}
            word => unknown = unknown.or_else(|| Some(line.wrong(word, "`v`, `f` or another keyword of OBJ"))),
        }
    }
    // Keywords of rare kinds are skipped in a file that has faces. Without faces, the first probably says why.
    match unknown {
        Some(error) if builder.is_empty() => Err(error),
        _ => builder.finish(&source, 1),
    }
}
