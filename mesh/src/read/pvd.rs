//! VTK's files that list other files: ParaView's files over time (`.pvd`), and the pieces of a grid (`.pvtu`, `.pvtp`).

use super::ReadError;
use super::source::{DAMAGED, Source, comma, quoted};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

/// A file in a list.
#[derive(Clone, Debug, PartialEq)]
pub struct Listed {
    /// Its time (s).
    pub time: f64,
    /// Its path, as typed.
    pub file: String,
    /// Its part of the moment, as typed.
    pub part: Option<String>,
}

/// Reads a list of files over time (`.pvd`), in its own order, which need not be that of the times.
///
/// # Errors
/// If it is damaged, or lists no file.
pub fn read_list(bytes: &[u8]) -> Result<Vec<Listed>, ReadError> {
    let listed = entries(bytes, &["Collection"], "DataSet", |tag, place| {
        let file = required(tag, "file", place)?;
        let time = required(tag, "timestep", place)?;
        let number = time.trim().parse().ok().filter(|time: &f64| time.is_finite());
        let time = number.ok_or_else(|| {
            let message = format!("has the time {} {}; expected a number (s)", quoted(time.as_bytes()), place());
            ReadError::new(message, comma(time.trim().as_bytes()).unwrap_or_else(|| DAMAGED.to_owned()))
        })?;
        Ok(Listed { time, file, part: attribute(tag, "part")? })
    })?;
    if listed.is_empty() {
        return Err(ReadError::new("lists no file: it has no `<DataSet>`", DAMAGED));
    }
    Ok(listed)
}

/// Reads the paths, as typed, of the files with the pieces of a grid or of polygons (`.pvtu`, `.pvtp`), in their order.
///
/// # Errors
/// If it is damaged, or names no file.
pub fn read_pieces(bytes: &[u8]) -> Result<Vec<String>, ReadError> {
    let kinds = ["PUnstructuredGrid", "PPolyData"];
    let files = entries(bytes, &kinds, "Piece", |tag, place| required(tag, "Source", place))?;
    if files.is_empty() {
        return Err(ReadError::new("names no file: it has no `<Piece>`", DAMAGED));
    }
    Ok(files)
}

/// The elements of a name in a VTK file of one of these types. `read` gets the place of each in words, which takes long to find.
fn entries<T>(
    bytes: &[u8],
    kinds: &[&str],
    name: &str,
    read: impl Fn(&BytesStart<'_>, &dyn Fn() -> String) -> Result<T, ReadError>,
) -> Result<Vec<T>, ReadError> {
    let place = |at: u64| Source::text(bytes).place(at as usize);
    let mut reader = Reader::from_reader(bytes);
    let (mut found, mut is_begun) = (Vec::new(), false);
    loop {
        let event = reader.read_event().map_err(|error| unsound(&place(reader.error_position()), &error))?;
        match event {
            Event::Start(tag) | Event::Empty(tag) if tag.local_name().as_ref().as_bytes() == b"VTKFile" => {
                is_begun = true;
                check_type(&tag, kinds, "a single file is named by its own ending, such as .vtu")?;
            }
            Event::Start(tag) | Event::Empty(tag) if tag.local_name().as_ref().as_bytes() == name.as_bytes() => {
                let end = reader.buffer_position();
                found.push(read(&tag, &|| place(end))?);
            }
            Event::Eof if !is_begun => {
                return Err(ReadError::new("is no list of VTK's files: it has no `<VTKFile>`", DAMAGED));
            }
            Event::Eof => return Ok(found),
            _ => {}
        }
    }
}

/// Refuses a VTK file that is of none of these types.
pub(super) fn check_type(tag: &BytesStart<'_>, types: &[&str], help: &str) -> Result<(), ReadError> {
    let found = attribute(tag, "type")?.unwrap_or_default();
    if types.contains(&&*found) {
        return Ok(());
    }
    let (found, types) = (quoted(found.as_bytes()), types.join("` or `"));
    Err(ReadError::new(format!("is a VTK file of the type {found}; expected `{types}`"), help))
}

/// An attribute that an element at a place has to have.
fn required(tag: &BytesStart<'_>, name: &str, place: &dyn Fn() -> String) -> Result<String, ReadError> {
    let element = tag.local_name();
    let element = String::from_utf8_lossy(element.as_ref().as_bytes());
    let missing = || ReadError::new(format!("has a `<{element}>` without `{name}` {}", place()), DAMAGED);
    attribute(tag, name)?.ok_or_else(missing)
}

/// An attribute without its escapes.
pub(super) fn attribute(tag: &BytesStart<'_>, name: &str) -> Result<Option<String>, ReadError> {
    let Some(attribute) = tag.try_get_attribute(name).map_err(|error| unsound("", &error))? else { return Ok(None) };
    quick_xml::escape::unescape(&attribute.value)
        .map(|text| Some(text.into_owned()))
        .map_err(|error| unsound("", &error))
}

/// The error of a file that is no XML, at a place if it is known.
pub(super) fn unsound(place: &str, error: &dyn std::fmt::Display) -> ReadError {
    let space = if place.is_empty() { "" } else { " " };
    ReadError::damaged(format!("is no sound XML{space}{place}: {error}"))
}
