//! ParaView's lists of files over time (`.pvd`).

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

/// Reads a list of files: those of one time after each other, in the order of times.
///
/// # Errors
/// If it is damaged, lists no file, or has times that do not rise.
pub fn read_list(bytes: &[u8]) -> Result<Vec<Listed>, ReadError> {
    let mut reader = Reader::from_reader(bytes);
    let mut listed: Vec<Listed> = Vec::new();
    let mut is_begun = false;
    loop {
        let event = reader.read_event().map_err(|error| {
            let place = Source::text(bytes).place(reader.error_position() as usize);
            ReadError::new(format!("is no sound XML {place}: {error}"), DAMAGED)
        })?;
        let (Event::Start(tag) | Event::Empty(tag)) = event else {
            if matches!(event, Event::Eof) {
                break;
            }
            continue;
        };
        match tag.local_name().as_ref().as_bytes() {
            b"VTKFile" => {
                is_begun = true;
                let kind = attribute(&tag, "type")?.unwrap_or_default();
                if kind != "Collection" {
                    let message =
                        format!("is a VTK file of the type {}; expected `Collection`", quoted(kind.as_bytes()));
                    return Err(ReadError::new(message, "a single file is named by its own ending, such as .vtu"));
                }
            }
            b"DataSet" => {
                let at = reader.buffer_position() as usize;
                let place = || Source::text(bytes).place(at);
                let missing =
                    |what: &str| ReadError::new(format!("has a `<DataSet>` without `{what}` {}", place()), DAMAGED);
                let file = attribute(&tag, "file")?.ok_or_else(|| missing("file"))?;
                let time = attribute(&tag, "timestep")?.ok_or_else(|| missing("timestep"))?;
                let Some(time) = time.trim().parse().ok().filter(|time: &f64| time.is_finite()) else {
                    let message =
                        format!("has the time {} {}; expected a number (s)", quoted(time.as_bytes()), place());
                    return Err(ReadError::new(message, DAMAGED));
                };
                if let Some(before) = listed.last().map(|before| before.time).filter(|before| time < *before) {
                    let message = format!("has the time {time} after {before} {}; expected rising times", place());
                    return Err(ReadError::new(message, "list the files in the order of their times"));
                }
                listed.push(Listed { time, file, part: attribute(&tag, "part")? });
            }
            _ => {}
        }
    }
    match listed.is_empty() {
        true if !is_begun => Err(ReadError::new("is no list of VTK's files: it has no `<VTKFile>`", DAMAGED)),
        true => Err(ReadError::new("lists no file: it has no `<DataSet>`", DAMAGED)),
        false => Ok(listed),
    }
}

/// An attribute without its escapes.
fn attribute(tag: &BytesStart<'_>, name: &str) -> Result<Option<String>, ReadError> {
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
            (
                "<DataSet timestep='1' file='a'/>\n<DataSet timestep='0.5' file='b'/>",
                "has the time 0.5 after 1 in line 3",
            ),
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
