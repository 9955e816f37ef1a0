//! Tables of variants of a scene: a line of keys, and a line of values for each variant.

use super::mistake::Mistake;
use super::report::mistake;
use super::source::Source;
use csv::{ReaderBuilder, StringRecord, Trim};
use std::ops::Range;

/// A table as typed.
#[derive(Debug)]
pub(crate) struct Variants {
    /// Keys such as `run[0].model.stiffness`, each once.
    pub(crate) keys: Vec<String>,
    /// At least one, each with a value for each key.
    pub(crate) rows: Vec<Row>,
}

/// The cells of a line, and the place of its first byte.
pub(crate) type Row = (StringRecord, usize);

impl Variants {
    /// Reads a table.
    ///
    /// # Errors
    /// The first mistake in it.
    pub(crate) fn parse(text: &str) -> Result<Self, Box<Mistake>> {
        let source = Source::new(text);
        let wrong = |span: Range<usize>, message: String, help: Option<String>| {
            Box::new(mistake(&source, span, &[], message, help))
        };
        let no_table = |error: csv::Error| {
            let at = error.position().map_or(0, |position| position.byte() as usize);
            wrong(at..at, "this is no table of comma-separated values".to_owned(), None)
        };
        let mut reader = ReaderBuilder::new().trim(Trim::All).flexible(true).from_reader(text.as_bytes());
        let keys: Vec<String> = reader.headers().map_err(no_table)?.iter().map(str::to_owned).collect();
        let separators = [(';', "semicolons"), ('\t', "tabs")];
        if let ([key], Some((_, name))) =
            (&keys[..], separators.iter().find(|(c, _)| text.lines().next().is_some_and(|line| line.contains(*c))))
        {
            let help = "write commas between values, and points in decimals".to_owned();
            return Err(wrong(0..key.len(), format!("the keys are separated by {name}; expected commas"), Some(help)));
        }
        if let Some(at) = keys.iter().position(|key| !value(key).is_str()) {
            let message =
                format!("the first line has keys, such as run[0].model.stiffness, but `{}` is a value", keys[at]);
            let help = "write a line with the key of each column above the values".to_owned();
            return Err(wrong(cell(text, 0, at), message, Some(help)));
        }
        if let Some(at) = (0..keys.len()).find(|&at| keys[at].is_empty() || keys[..at].contains(&keys[at])) {
            let message = format!(
                "the key of column {} is {}; expected one such as run[0].model.stiffness",
                at + 1,
                if keys[at].is_empty() { "missing" } else { "given a second time" }
            );
            return Err(wrong(cell(text, 0, at), message, None));
        }
        let mut rows = Vec::new();
        for row in reader.into_records() {
            let row = row.map_err(no_table)?;
            let read_from = row.position().map_or(0, |position| position.byte() as usize);
            // Empty lines before it are skipped.
            let start = read_from + text[read_from..].bytes().take_while(|byte| b"\r\n".contains(byte)).count();
            if row.len() != keys.len() {
                let plural = if row.len() == 1 { "" } else { "s" };
                let message =
                    format!("this line has {} value{plural}; expected {}, one for each key", row.len(), keys.len());
                let is_whole = |cell: &str| !cell.is_empty() && cell.bytes().all(|byte| byte.is_ascii_digit());
                let cells: Vec<_> = row.iter().collect();
                let is_cut =
                    cells.windows(2).any(|pair| is_whole(pair[0].trim_start_matches(['-', '+'])) && is_whole(pair[1]));
                let help = if row.len() > keys.len() && is_cut {
                    "decimals have a point, such as 0.5, and a value with commas stands in quotation marks"
                } else {
                    "a value that is that of the scene is an empty cell, and one with commas stands in quotation marks"
                };
                return Err(wrong(cell(text, start, keys.len().min(row.len() - 1)), message, Some(help.to_owned())));
            }
            if let Some(at) = row.iter().position(has_comment) {
                let message = format!("`{}` is a value with a comment; expected the value alone", &row[at]);
                let help = "a comment may stand in no cell; leave out `#` and what follows".to_owned();
                return Err(wrong(cell(text, start, at), message, Some(help)));
            }
            rows.push((row, start));
        }
        if keys.is_empty() || rows.is_empty() {
            let message = "there are no variants; expected a line of keys, such as body.lattice.side, and one line of values for each";
            return Err(wrong(0..0, message.to_owned(), None));
        }
        Ok(Self { keys, rows })
    }
}

/// What to do with a value that has a comma where a point was meant.
pub(crate) fn decimal_comma(cell: &str) -> Option<String> {
    let (whole, part) = cell.trim_start_matches(['-', '+']).split_once(',')?;
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    (is_number(whole) && is_number(part)).then(|| format!("decimals have a point: {}", cell.replace(',', ".")))
}

/// The span of a cell in the line that begins at a byte.
pub(crate) fn cell(text: &str, start: usize, column: usize) -> Range<usize> {
    let (mut begin, mut at, mut left, mut is_quoted) = (start, start, column, false);
    for byte in text.as_bytes().get(start..).unwrap_or_default() {
        match byte {
            b'"' => is_quoted = !is_quoted,
            b',' if !is_quoted && left > 0 => (left, begin) = (left - 1, at + 1),
            b',' | b'\r' | b'\n' if !is_quoted => break,
            _ => {}
        }
        at += 1;
    }
    begin..at.max(begin)
}

/// The value of a cell: as in a scene file, or a text without quotation marks.
pub(crate) fn value(cell: &str) -> toml::Value {
    let typed = toml::from_str::<toml::Table>(&format!("value = {cell}")).ok();
    let typed = typed.filter(|table| table.len() == 1).and_then(|mut table| table.remove("value"));
    typed.unwrap_or_else(|| toml::Value::String(cell.to_owned()))
}

/// Whether a cell has a comment behind its value, which a scene file may have.
fn has_comment(cell: &str) -> bool {
    // A comment hides the bracket.
    !value(cell).is_str() && toml::from_str::<toml::Table>(&format!("value = [{cell}]")).is_err()
}

/// Sets the value of a key such as `run[0].model.stiffness`.
pub(crate) fn set(root: &mut toml::Table, key: &str, value: toml::Value) -> Result<(), String> {
    let expected = || format!("`{key}` is no key; expected one such as body.lattice.side or run[0].model.stiffness");
    let mut parts = Vec::new();
    for part in key.split('.') {
        let (name, indices) = part.split_at(part.find('[').unwrap_or(part.len()));
        let indices = indices.split_terminator(']').map(|index| index.strip_prefix('[')?.trim().parse().ok());
        parts.push((name, indices.collect::<Option<Vec<usize>>>().filter(|_| !name.is_empty()).ok_or_else(expected)?));
    }
    let (last, before) = parts.split_last().ok_or_else(expected)?;
    let mut table = root;
    for (name, indices) in before {
        let entry = table.entry(*name).or_insert_with(|| toml::Value::Table(toml::Table::new()));
        let entry = within(entry, name, indices)?;
        let is_list = entry.is_array();
        table = entry.as_table_mut().ok_or_else(|| match is_list {
            true => format!("`{name}` in `{key}` is a list in the scene; write `{name}[0]` for its first entry"),
            false => format!("`{name}` in `{key}` is not a table in the scene"),
        })?;
    }
    let (name, indices) = last;
    if indices.is_empty() {
        table.insert((*name).to_owned(), value);
    } else {
        let entry = table.get_mut(*name).ok_or_else(|| format!("the scene has no `{key}`"))?;
        *within(entry, name, indices)? = value;
    }
    Ok(())
}

/// An entry of nested arrays.
fn within<'a>(mut value: &'a mut toml::Value, name: &str, indices: &[usize]) -> Result<&'a mut toml::Value, String> {
    for &index in indices {
        let items = value.as_array_mut().ok_or_else(|| format!("`{name}` is not an array in the scene"))?;
        let count = items.len();
        value = items
            .get_mut(index)
            .ok_or_else(|| format!("the scene has no `{name}[{index}]`; it has {count}, counted from 0"))?;
    }
    Ok(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_typed_as_in_scenes_and_texts_need_no_quotation_marks() {
        let text = |text: &str| toml::Value::String(text.to_owned());
        assert_eq!(value("1e4"), toml::Value::Float(1e4));
        assert_eq!(value("[3, 3]"), toml::Value::Array(vec![3.into(), 3.into()]));
        assert_eq!(value("true"), toml::Value::Boolean(true));
        assert_eq!((value("T/50"), value("\"T/50\"")), (text("T/50"), text("T/50")));
        assert_eq!(value("1\nother = 2"), text("1\nother = 2"));
    }

    #[test]
    fn keys_are_those_of_messages() {
        let mut root: toml::Table = "run = [{ step = 1 }, { step = 2 }]\nbody.side = 1".parse().unwrap();
        set(&mut root, "run[1].step", 7.into()).unwrap();
        set(&mut root, "body.spin.axis", 8.into()).unwrap();
        assert_eq!(root, "run = [{ step = 1 }, { step = 7 }]\nbody.side = 1\nbody.spin.axis = 8".parse().unwrap());
        for (key, message) in [
            ("run[2].step", "the scene has no `run[2]`; it has 2, counted from 0"),
            ("body[0].side", "`body` is not an array in the scene"),
            ("body.side.x", "`side` in `body.side.x` is not a table in the scene"),
            ("run[x].step", "`run[x].step` is no key"),
            ("run..step", "`run..step` is no key"),
            ("run.step", "`run` in `run.step` is a list in the scene; write `run[0]` for its first entry"),
            ("grab[0]", "the scene has no `grab[0]`"),
        ] {
            let error = set(&mut root, key, 1.into()).unwrap_err();
            assert!(error.contains(message), "{key}: {error}");
        }
    }

    #[test]
    fn cells_are_found_in_their_lines() {
        let text = "a,b\n1,\"x, y\",3\n";
        let at = |start, column| &text[cell(text, start, column)];
        assert_eq!([at(0, 1), at(4, 0), at(4, 1), at(4, 2)], ["b", "1", "\"x, y\"", "3"]);
    }

    #[test]
    fn mistakes_in_tables_have_their_places() {
        for (text, place, words) in [
            ("a;b\n1;2\n", (1, 1), "separated by semicolons"),
            ("a\tb\n1\t2\n", (1, 1), "separated by tabs"),
            ("a,b\n1,2\n0,5,3\n", (3, 5), "this line has 3 values; expected 2"),
            ("a,b\n1\n", (2, 1), "this line has 1 value; expected 2"),
            ("a,b\n\n\r\n1\n", (4, 1), "this line has 1 value; expected 2"),
            ("a,,b\n1,2,3\n", (1, 3), "the key of column 2 is missing"),
            ("a,a\n1,2\n", (1, 3), "given a second time"),
            ("a,b\n1,1e3 # soft\n", (2, 3), "`1e3 # soft` is a value with a comment"),
            ("a,1e3\n1,2\n", (1, 3), "the first line has keys, such as run[0].model.stiffness, but `1e3` is a value"),
            ("a,b\n", (1, 1), "no variants"),
            ("", (1, 1), "no variants"),
        ] {
            let found = Variants::parse(text).expect_err(text);
            assert!((found.line, found.column) == place && found.message.contains(words), "{text:?}: {found:?}");
        }
        let texts = "a\n#0072b2\nnumber # 7\n\"\"\"1 # 2\"\"\"\n\"[1, 2]\"\n";
        assert_eq!(Variants::parse(texts).map(|table| table.rows.len()).ok(), Some(4));
        let help = |text: &str| Variants::parse(text).expect_err(text).help.unwrap_or_default();
        assert!(help("a\n0,5\n").contains("decimals have a point"));
        assert_eq!(decimal_comma("-0,5").as_deref(), Some("decimals have a point: -0.5"));
        assert!(["a,b", "1", "1,2,3", ",5"].iter().all(|cell| decimal_comma(cell).is_none()));
    }
}
