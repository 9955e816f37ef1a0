//! What a file is by its content, whatever its ending says.

use super::source::quoted;
use super::{Format, ReadError, converter};

/// The remedy for a page of the Web.
const PAGE: &str = "the download gave a page in place of the file: download the file itself";
/// The remedy for packed files.
const PACKED: &str = "unpack it first";
/// The remedy for other formats of meshes.
const OTHER: &str = "convert it to OBJ, STL, PLY, OFF, glTF, Gmsh (.msh), VTK, VTU, Medit (.mesh) or Abaqus (.inp)";

/// Refuses a file that is empty, or of another kind than its ending says.
pub(super) fn check(bytes: &[u8], format: Format) -> Result<(), ReadError> {
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return Err(ReadError::new("is empty", super::source::CUT));
    }
    let other = match found(bytes) {
        Some(Found::Format(found)) if found != format => found,
        Some(Found::Other(what, help)) => return Err(ReadError::new(format!("is {what}, and is not read"), help)),
        _ => return Ok(()),
    };
    let message = format!("has the content of {}, but the ending of {}", other.known().1, format.known().1);
    Err(ReadError::new(message, format!("name it `.{}`", other.endings()[0])))
}

/// The error of a file that does not begin as its format does.
pub(super) fn no_beginning(bytes: &[u8], format: Format, expected: &str) -> ReadError {
    let line = bytes.split(|&byte| byte == b'\n' || byte == b'\r').next().unwrap_or_default();
    let message = format!("begins with {}; expected {expected}, as {} does", quoted(line), format.known().1);
    ReadError::new(message, "check that the ending of its name is that of its format")
}

impl Format {
    /// The format whose files begin with these bytes, if the beginning says.
    pub fn within(bytes: &[u8]) -> Option<Self> {
        match found(bytes) {
            Some(Found::Format(format)) => Some(format),
            _ => None,
        }
    }
}

/// A kind of file.
enum Found {
    Format(Format),
    /// Another one in words, and what to do.
    Other(&'static str, &'static str),
}

/// The kind of file that begins like this, if the beginning says.
fn found(bytes: &[u8]) -> Option<Found> {
    use Found::Other;
    let head = &bytes[..bytes.len().min(1024)];
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    let lower = text.to_ascii_lowercase();
    let has = |part: &[u8]| lower.windows(part.len()).any(|window| window == part);
    let begins = |start: &[u8]| lower.starts_with(start);
    let word = |start: &[u8]| begins(start) && lower.get(start.len()).is_none_or(u8::is_ascii_whitespace);
    Some(match () {
        () if begins(b"<!doctype html") || begins(b"<html") => Other("a page of the Web (HTML)", PAGE),
        () if has(b"<vtkfile") => Found::Format(Format::Vtu),
        () if has(b"<collada") => Other("a COLLADA file", converter("dae").unwrap_or(OTHER)),
        () if begins(b"<") => Other("another XML file", OTHER),
        () if head.starts_with(b"glTF") || begins(b"{") => Found::Format(Format::Gltf),
        () if begins(b"meshversionformatted") => Found::Format(Format::Medit),
        () if begins(b"*heading") || begins(b"*node") => Found::Format(Format::Abaqus),
        () if begins(b"$meshformat") || begins(b"$nod") || begins(b"$comments") => Found::Format(Format::Gmsh),
        () if begins(b"# vtk datafile") => Found::Format(Format::Vtk),
        () if word(b"ply") => Found::Format(Format::Ply),
        () if [&b"off"[..], b"coff", b"noff", b"stoff", b"cnoff"].iter().any(|start| word(start)) => {
            Found::Format(Format::Off)
        }
        () if word(b"solid") && has(b"facet") => Found::Format(Format::Stl),
        () if head.starts_with(b"\x1f\x8b") => Other("packed (gzip)", PACKED),
        () if head.starts_with(b"PK\x03\x04") => Other("packed (ZIP)", PACKED),
        () if head.starts_with(b"BZh") => Other("packed (bzip2)", PACKED),
        () if head.starts_with(b"\xfd7zXZ") || head.starts_with(b"7z\xbc\xaf") => Other("packed", PACKED),
        () if head.starts_with(b"\xff\xfe") || head.starts_with(b"\xfe\xff") => {
            Other("text in UTF-16", "save it as UTF-8")
        }
        () if head.starts_with(b"\x89PNG") || head.starts_with(b"\xff\xd8\xff") || head.starts_with(b"GIF8") => {
            Other("a picture", OTHER)
        }
        () if head.starts_with(b"%PDF") => Other("a PDF file", OTHER),
        () if head.starts_with(b"\x89HDF") => Other("an HDF5 file", OTHER),
        () if head.starts_with(b"\x93NUMPY") => Other("a NumPy array", OTHER),
        () if head.starts_with(b"Kaydara FBX") => Other("an FBX file", converter("fbx").unwrap_or(OTHER)),
        () if head.starts_with(b"BLENDER") => Other("a Blender file", converter("blend").unwrap_or(OTHER)),
        () if begins(b"mfem mesh") => Other("an MFEM file", "write it as `.vtu` with `Mesh::PrintVTU` of MFEM"),
        () if begins(b"(0 ") || begins(b"(2 3)") => Other("a Fluent file", converter("cas").unwrap_or(OTHER)),
        () if begins(b"iso-10303") => Other("a STEP file", converter("step").unwrap_or(OTHER)),
        () if begins(b"version https://git-lfs") => Other("a pointer of Git LFS", "run `git lfs pull`"),
        () if is_obj(text) => Found::Format(Format::Obj),
        () => return None,
    })
}

/// Whether a text has a point as OBJ files do, `v` with three numbers, before anything that is no name, material or comment.
fn is_obj(text: &[u8]) -> bool {
    let lines = text.split(|&byte| byte == b'\n' || byte == b'\r').map(|line| line.trim_ascii());
    let mut lines = lines.filter(|line| !line.is_empty() && line[0] != b'#');
    let first =
        lines.find(|line| !["mtllib ", "usemtl ", "o ", "g "].iter().any(|word| line.starts_with(word.as_bytes())));
    let words = first.and_then(|line| std::str::from_utf8(line.split(|&byte| byte == b'#').next()?).ok());
    let mut words = words.unwrap_or_default().split_whitespace();
    words.next() == Some("v") && words.take(3).filter(|word| word.parse::<f64>().is_ok()).count() == 3
}
