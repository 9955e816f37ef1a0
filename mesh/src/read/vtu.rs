//! VTK's formats in XML: unstructured grids (`.vtu`) and polygons (`.vtp`). Arrays are text, Base64 or raw bytes at the end of the file,
//! packed by zlib or not (<https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>).

mod data;
mod piece;
mod polyhedra;

use super::builder::Builder;
use super::pvd::{attribute, check_type, unsound};
use super::source::{CUT, Coding, DAMAGED, Scalar, Source, quoted};
use super::{Cells, Format, Limits, ReadError, arrays, content, kinds};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::cell::Cell;
use std::collections::BTreeMap;

/// An array of numbers where it stands in the file.
struct Array {
    /// Its name as typed.
    name: Vec<u8>,
    scalar: Scalar,
    /// The number of components of a point or a vector.
    columns: usize,
    /// Where it begins to be described.
    at: usize,
    place: Place,
}

enum Place {
    /// Text between two places of the file.
    Text(usize, usize),
    /// Base64 between two places of the file.
    Inline(usize, usize),
    /// The offset in the data at the end.
    Appended(usize),
}

/// Where arrays beside those of points and cells stand.
const POINT_DATA: &[u8] = b"PointData";
const CELL_DATA: &[u8] = b"CellData";

/// Elements whose arrays are all read, and the type of cells in them, if it is one.
const ELEMENTS: [(&[u8], i64); 6] =
    [(b"Points", 0), (b"Cells", -1), (b"Verts", 2), (b"Lines", 4), (b"Polys", 7), (b"Strips", 6)];

/// How the arrays of a file are written.
struct Layout<'b> {
    bytes: &'b [u8],
    limits: &'b Limits,
    coding: Coding,
    /// The type of lengths before arrays.
    header: Scalar,
    /// The name of the program by which arrays are packed; empty for none.
    packer: String,
    /// The data at the end, and whether they are raw.
    appended: Option<(&'b [u8], bool)>,
    /// The most numbers of all arrays that are no text and of the faces of polyhedra, and how many of them are left: several pieces
    /// may name the same data, and packed data may be small.
    most: usize,
    left: Cell<usize>,
}

/// The arrays of a piece by the names of their elements and their own.
type Piece = BTreeMap<Key, Array>;

/// The names of an element and of an array in it.
type Key = (Vec<u8>, Vec<u8>);

pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<Cells, ReadError> {
    // Raw data are no XML, so what stands before them is read alone.
    let begin = bytes.windows(13).position(|window| window == b"<AppendedData");
    let appended = match begin {
        Some(begin) => Some(appended(&bytes[begin..])?),
        None => None,
    };
    // Positions, velocities and displacements, and lists of the faces of polyhedra, where each corner belongs to several faces.
    let most = limits.points.saturating_mul(9).saturating_add(limits.corners.saturating_mul(12));
    let mut layout = Layout {
        bytes,
        limits,
        coding: Coding::Little,
        header: Scalar::U32,
        packer: String::new(),
        appended,
        most,
        left: Cell::new(most),
    };
    let mut builder = Builder::new(limits);
    pieces(&bytes[..begin.unwrap_or(bytes.len())], begin.is_some(), &mut layout, &mut builder)?;
    builder.finish(&Source::text(bytes), 0)
}

/// The data after the start tag, and whether they are raw.
fn appended(bytes: &[u8]) -> Result<(&[u8], bool), ReadError> {
    let position = |byte: u8| bytes.iter().position(|&found| found == byte);
    let (Some(tag), Some(begin)) = (position(b'>'), position(b'_')) else {
        return Err(ReadError::new("ends in its `<AppendedData>`; expected `_` and data", CUT));
    };
    let is_raw = match Reader::from_reader(&bytes[..=tag]).read_event() {
        Ok(Event::Start(tag)) => attribute(&tag, "encoding")?.as_deref() == Some("raw"),
        _ => false,
    };
    Ok((&bytes[(begin + 1).max(tag + 1)..], is_raw))
}

fn pieces(text: &[u8], is_cut: bool, layout: &mut Layout<'_>, builder: &mut Builder) -> Result<(), ReadError> {
    let place = |at: u64| Source::text(text).place(at as usize);
    let mut reader = Reader::from_reader(text);
    let mut path: Vec<Vec<u8>> = Vec::new();
    let mut piece = Piece::new();
    // The array whose text follows.
    let mut open: Option<(Key, Array)> = None;
    let close = |open: &mut Option<(Key, Array)>, piece: &mut Piece, before: u64| {
        if let Some((key, mut array)) = open.take() {
            if let Place::Text(_, end) | Place::Inline(_, end) = &mut array.place {
                *end = before as usize;
            }
            piece.insert(key, array);
        }
    };
    let (mut is_begun, mut is_ended) = (false, false);
    loop {
        let before = reader.buffer_position();
        let event = reader.read_event().map_err(|error| unsound(&place(reader.error_position()), &error))?;
        let is_empty = matches!(event, Event::Empty(_));
        match event {
            Event::Start(tag) | Event::Empty(tag) => {
                // An array may contain elements about it after its numbers.
                close(&mut open, &mut piece, before);
                let name = tag.local_name().as_ref().as_bytes().to_vec();
                match &*name {
                    b"VTKFile" => {
                        is_begun = true;
                        header(&tag, layout)?;
                    }
                    _ if !is_begun => return Err(content::no_beginning(text, Format::Vtu, "`<VTKFile`")),
                    b"DataArray" => {
                        let places = [before as usize, reader.buffer_position() as usize];
                        open =
                            array(&tag, path.last().map_or(&[][..], |parent| &parent[..]), places, || place(before))?;
                        if is_empty {
                            close(&mut open, &mut piece, places[1] as u64);
                        }
                    }
                    _ => {}
                }
                if !is_empty {
                    path.push(name);
                }
            }
            Event::End(tag) => {
                path.pop();
                match tag.local_name().as_ref().as_bytes() {
                    b"DataArray" => close(&mut open, &mut piece, before),
                    b"Piece" => layout.piece(&std::mem::take(&mut piece), builder)?,
                    b"VTKFile" => is_ended = true,
                    _ => {}
                }
            }
            Event::Eof => break,
            _ => {}
        }
    }
    match (is_begun, is_ended || is_cut) {
        (false, _) => Err(content::no_beginning(text, Format::Vtu, "`<VTKFile`")),
        (true, false) => Err(Source::text(text).ends("`</VTKFile>`")),
        (true, true) => Ok(()),
    }
}

fn header(tag: &BytesStart<'_>, layout: &mut Layout<'_>) -> Result<(), ReadError> {
    check_type(tag, &["UnstructuredGrid", "PolyData"], kinds::AS_GRID)?;
    if attribute(tag, "byte_order")?.as_deref() == Some("BigEndian") {
        layout.coding = Coding::Big;
    }
    if attribute(tag, "header_type")?.as_deref() == Some("UInt64") {
        layout.header = Scalar::U64;
    }
    layout.packer = attribute(tag, "compressor")?.unwrap_or_default();
    Ok(())
}

/// An array in an element, if it is read. It begins to be described at the first of two places, and its text begins at the other.
fn array(
    tag: &BytesStart<'_>,
    parent: &[u8],
    places: [usize; 2],
    place: impl Fn() -> String,
) -> Result<Option<(Key, Array)>, ReadError> {
    let typed = attribute(tag, "Name")?.unwrap_or_default().into_bytes();
    let is_data = parent == POINT_DATA || parent == CELL_DATA;
    let name = if is_data {
        let columns = attribute(tag, "NumberOfComponents")?.and_then(|number| number.trim().parse().ok());
        match arrays::wanted(&typed, parent == CELL_DATA, columns.unwrap_or(1)) {
            Some(name) => name.to_vec(),
            None => return Ok(None),
        }
    } else if ELEMENTS.iter().any(|(element, _)| *element == parent) {
        typed.clone()
    } else {
        return Ok(None);
    };
    let is_vector = parent == b"Points" || is_data && arrays::is_vector(&name);
    let scalar = scalar(&attribute(tag, "type")?.unwrap_or_default())?;
    let columns = if is_vector { columns(tag, &typed, &place)? } else { 1 };
    let [at, start] = places;
    let place = match attribute(tag, "format")?.as_deref() {
        Some("appended") => {
            let offset = attribute(tag, "offset")?.and_then(|offset| offset.trim().parse().ok());
            let missing = || ReadError::damaged(format!("has an array without an offset {}", place()));
            Place::Appended(offset.ok_or_else(missing)?)
        }
        Some("binary") => Place::Inline(start, start),
        Some("ascii") | None => Place::Text(start, start),
        Some(other) => {
            let (other, place) = (quoted(other.as_bytes()), place());
            let message =
                format!("has an array of the format {other} {place}; expected `ascii`, `binary` or `appended`");
            return Err(ReadError::damaged(message));
        }
    };
    Ok(Some(((parent.to_vec(), name), Array { name: typed, scalar, columns, at, place })))
}

/// The number of components of points and vectors: 3, or 2 in the plane.
fn columns(tag: &BytesStart<'_>, name: &[u8], place: impl Fn() -> String) -> Result<usize, ReadError> {
    let found = attribute(tag, "NumberOfComponents")?;
    match found.as_deref().map(str::trim) {
        None | Some("3") => Ok(3),
        Some("2") => Ok(2),
        Some(other) => {
            let name = quoted(if name.is_empty() { b"Points" } else { name });
            let message =
                format!("has {other} components in its array {name} {}; expected 3, or 2 in the plane", place());
            Err(ReadError::new(message, "write points and vectors with x, y and z"))
        }
    }
}

fn scalar(name: &str) -> Result<Scalar, ReadError> {
    Scalar::named(name.as_bytes()).ok_or_else(|| {
        let message = format!("has an array of the type {}; expected `Float64` or `Int64`", quoted(name.as_bytes()));
        ReadError::new(message, DAMAGED)
    })
}
