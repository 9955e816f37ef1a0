//! VTK's files that list other files: ParaView's files over time (`.pvd`), and the pieces of a grid (`.pvtu`, `.pvtp`).

use super::ReadError;
use super::source::{DAMAGED, Source, quoted};
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
            ReadError::new(message, DAMAGED)
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
        let event = reader.read_event().map_err(|error| {
            ReadError::new(format!("is no sound XML {}: {error}", place(reader.error_position())), DAMAGED)
        })?;
        match event {
            Event::Start(tag) | Event::Empty(tag) if tag.local_name().as_ref().as_bytes() == b"VTKFile" => {
                is_begun = true;
                let kind = attribute(&tag, "type")?.unwrap_or_default();
                if !kinds.contains(&&*kind) {
                    let (kind, kinds) = (quoted(kind.as_bytes()), kinds.join("` or `"));
                    let message = format!("is a VTK file of the type {kind}; expected `{kinds}`");
                    return Err(ReadError::new(message, "a single file is named by its own ending, such as .vtu"));
                }
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

/// An attribute that an element at a place has to have.
fn required(tag: &BytesStart<'_>, name: &str, place: &dyn Fn() -> String) -> Result<String, ReadError> {
    let element = tag.local_name();
    let element = String::from_utf8_lossy(element.as_ref().as_bytes());
    let missing = || ReadError::new(format!("has a `<{element}>` without `{name}` {}", place()), DAMAGED);
    attribute(tag, name)?.ok_or_else(missing)
}

/// An attribute without its escapes.
pub(super) fn attribute(tag: &BytesStart<'_>, name: &str) -> Result<Option<String>, ReadError> {
    let damaged = |error: &dyn std::fmt::Display| ReadError::new(format!("is no sound XML: {error}"), DAMAGED);
    let Some(attribute) = tag.try_get_attribute(name).map_err(|error| damaged(&error))? else { return Ok(None) };
    quick_xml::escape::unescape(&attribute.value).map(|text| Some(text.into_owned())).map_err(|error| damaged(&error))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(sets: &str) -> Result<Vec<Listed>, String> {
        let text =
            format!("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\"><Collection>{sets}</Collection></VTKFile>");
        read_list(text.as_bytes()).map_err(|error| error.message)
    }

    #[test]
    fn files_are_listed_with_their_times() {
        let found = list(
            "<DataSet timestep='0' part='0' file='a &lt;b&gt;/c_0.vtu'/><DataSet timestep='0.5' file='d.vtu'></DataSet>",
        );
        let expected = [(0.0, "a <b>/c_0.vtu", Some("0")), (0.5, "d.vtu", None)].map(|(time, file, part)| Listed {
            time,
            file: file.to_owned(),
            part: part.map(str::to_owned),
        });
        assert_eq!(found.unwrap(), expected);
    }

    #[test]
    fn mistakes_are_told_with_their_places() {
        for (sets, message) in [
            ("", "lists no file"),
            ("<DataSet file='a.vtu'/>", "without `timestep`"),
            ("<DataSet timestep='0'/>", "without `file`"),
            ("<DataSet timestep='soon' file='a.vtu'/>", "has the time `soon`"),
            ("<DataSet timestep='0' file='a'", "is no sound XML"),
        ] {
            let error = list(sets).unwrap_err();
            assert!(error.contains(message), "{sets}: {error}");
        }
        assert!(read_list(b"").unwrap_err().message.contains("no `<VTKFile>`"));
        assert!(
            read_list(b"<VTKFile type='UnstructuredGrid'/>").unwrap_err().message.contains("expected `Collection`")
        );
    }
}
