//! Rows and columns as CSV, as Markdown and as JSON.

use serde::Serialize;
use serde_json::{Map, Value, json};

/// A cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Cell {
    /// What does not apply.
    Empty,
    Text(String),
    Count(u64),
    /// A parameter, as short as it can be written.
    Given(f64),
    /// A result, with 17 digits.
    Number(f64),
}

impl Cell {
    fn text(&self) -> String {
        match self {
            Self::Empty => String::new(),
            Self::Text(text) => text.clone(),
            Self::Count(count) => count.to_string(),
            Self::Given(number) => number.to_string(),
            Self::Number(number) if number.is_nan() => "nan".to_owned(),
            Self::Number(number) => format!("{number:.16e}"),
        }
    }

    /// Numbers that are not finite are `null`.
    fn json(&self) -> Value {
        match *self {
            Self::Empty => Value::Null,
            Self::Text(ref text) => json!(text),
            Self::Count(count) => json!(count),
            Self::Given(number) | Self::Number(number) => json!(number),
        }
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<u64> for Cell {
    fn from(count: u64) -> Self {
        Self::Count(count)
    }
}

impl From<u32> for Cell {
    fn from(count: u32) -> Self {
        Self::Count(count.into())
    }
}

impl From<usize> for Cell {
    fn from(count: usize) -> Self {
        Self::Count(count as u64)
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl<T: Into<Self>> From<Option<T>> for Cell {
    fn from(cell: Option<T>) -> Self {
        cell.map_or(Self::Empty, T::into)
    }
}

/// A table.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Table {
    /// The headings of the columns.
    pub(crate) heads: Vec<String>,
    pub(crate) rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table from rows of cells, each with the heading of its column.
    pub(crate) fn of<const N: usize>(rows: impl IntoIterator<Item = [(&'static str, Cell); N]>) -> Self {
        let mut table = Self::default();
        for row in rows {
            table.heads = row.iter().map(|(head, _)| (*head).to_owned()).collect();
            table.rows.push(row.into_iter().map(|(_, cell)| cell).collect());
        }
        table
    }

    /// As CSV.
    pub(crate) fn csv(&self) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let mut write = |row: &mut dyn Iterator<Item = String>| writer.write_record(row).expect("writing to memory");
        write(&mut self.heads.iter().cloned());
        self.rows.iter().for_each(|row| write(&mut row.iter().map(Cell::text)));
        String::from_utf8(writer.into_inner().expect("writing to memory")).expect("made of texts")
    }

    /// As Markdown, with the first `left` columns aligned left and the others, numbers, aligned right.
    pub(crate) fn markdown(&self, left: usize) -> String {
        let escaped = |cell: &str| cell.replace('|', "\\|");
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let rule = |column| if column < left { "---" } else { "---:" }.to_owned();
        let mut text = line(self.heads.iter().map(|head| escaped(head)).collect());
        text += &line((0..self.heads.len()).map(rule).collect());
        self.rows.iter().for_each(|row| text += &line(row.iter().map(|cell| escaped(&cell.text())).collect()));
        text
    }

    /// As a list of objects.
    pub(crate) fn json(&self) -> Value {
        let object =
            |row: &Vec<Cell>| self.heads.iter().cloned().zip(row.iter().map(Cell::json)).collect::<Map<_, _>>();
        self.rows.iter().map(object).collect()
    }
}

/// A number with three significant digits, the same on every machine.
pub(crate) fn figure(number: f64) -> String {
    let short = format!("{number:.2e}");
    // The exponent is read from the rounded text: a logarithm could round powers of ten differently on each platform.
    match short.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok()) {
        Some(_) if number == 0.0 => "0".to_owned(),
        Some(exponent @ -3..=5) => format!("{number:.*}", (2 - exponent).max(0) as usize),
        _ => short,
    }
}

/// A choice as written in a scene.
pub(crate) fn typed(choice: &impl Serialize) -> String {
    serde_json::to_value(choice).ok().and_then(|name| name.as_str().map(String::from)).unwrap_or_default()
}

/// The columns that `docs/files.md` documents for a CSV file.
#[cfg(test)]
pub(crate) fn documented(file: &str) -> Vec<&'static str> {
    let page = include_str!("../../docs/files.md");
    let section = page.split("\n## ").find(|section| section.starts_with(&format!("`{file}`"))).expect("its section");
    let cells = section.lines().filter_map(|line| line.strip_prefix("| `")?.split(" | ").next());
    cells.flat_map(|cell| cell.split(", ")).map(|name| name.trim_matches('`')).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_forms_can_be_read_again() {
        let table = Table::of([[("name", "a, \"b\"".into()), ("|w|", Cell::Given(1.5)), ("none", Cell::Empty)]]);
        assert_eq!(table.csv(), "name,|w|,none\n\"a, \"\"b\"\"\",1.5,\n");
        assert_eq!(table.markdown(1), "| name | \\|w\\| | none |\n| --- | ---: | ---: |\n| a, \"b\" | 1.5 |  |\n");
        assert_eq!(table.json(), json!([{ "name": "a, \"b\"", "|w|": 1.5, "none": null }]));
    }

    #[test]
    fn results_survive_reading() {
        for number in [0.1, -1.0 / 3.0, 5e-324, f64::MAX, 0.0] {
            let text = Cell::from(number).text();
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), number.to_bits(), "{text}");
        }
        assert_eq!(Cell::from(f64::NAN).text(), "nan");
    }

    #[test]
    fn figures_have_three_digits() {
        let cases = [
            (0.0, "0"),
            (4.525_54, "4.53"),
            (30.875_97, "30.9"),
            (9.999, "10.0"),
            (0.001_234_5, "0.00123"),
            (0.000_999_9, "0.00100"),
            (4.93e-4, "4.93e-4"),
            (123_456.0, "123456"),
            (-0.02, "-0.0200"),
            (f64::INFINITY, "inf"),
        ];
        for (number, text) in cases {
            assert_eq!(figure(number), text);
        }
    }
}
