//! Rows and columns as CSV, as Markdown and as JSON.

use localshape::internals::{exact, rows_as_csv};
use serde_json::{Map, Value, json};

/// A cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Cell {
    /// A value that does not apply.
    Empty,
    Text(String),
    Count(u64),
    /// A parameter, with as few digits as possible.
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
            Self::Number(number) => exact(*number),
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

macro_rules! cells {
    ($($from:ty: $value:ident => $cell:expr),*) => {
        $(impl From<$from> for Cell {
            fn from($value: $from) -> Self {
                $cell
            }
        })*
    };
}

cells! {
    f64: number => Self::Number(number),
    u64: count => Self::Count(count),
    u32: count => Self::Count(count.into()),
    usize: count => Self::Count(count as u64),
    &str: text => Self::Text(text.to_owned()),
    String: text => Self::Text(text)
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
    /// A table with some headings and further ones after them.
    pub(crate) fn wide(heads: &[&str], more: impl IntoIterator<Item = String>, rows: Vec<Vec<Cell>>) -> Self {
        Self { heads: heads.iter().map(|head| (*head).to_owned()).chain(more).collect(), rows }
    }

    /// A table from rows of cells, each with the heading of its column.
    pub(crate) fn of<const N: usize>(rows: impl IntoIterator<Item = [(&'static str, Cell); N]>) -> Self {
        let mut table = Self::default();
        for row in rows {
            table.heads = row.iter().map(|(head, _)| (*head).to_owned()).collect();
            table.rows.push(row.into_iter().map(|(_, cell)| cell).collect());
        }
        table
    }

    /// The table as CSV.
    pub(crate) fn csv(&self) -> String {
        let rows = self.rows.iter().map(|row| row.iter().map(Cell::text).collect());
        let csv = rows_as_csv([self.heads.clone()].into_iter().chain(rows));
        String::from_utf8(csv).expect("made of texts")
    }

    /// The table as Markdown, with the first `left` columns aligned left and the others, numbers, aligned right.
    pub(crate) fn markdown(&self, left: usize) -> String {
        let escaped = |cell: &str| cell.replace('|', "\\|");
        let line = |cells: Vec<String>| format!("| {} |", cells.join(" | "));
        let rule = |column| if column < left { "---" } else { "---:" }.to_owned();
        let heads = line(self.heads.iter().map(|head| escaped(head)).collect());
        let rules = line((0..self.heads.len()).map(rule).collect());
        let rows = self.rows.iter().map(|row| line(row.iter().map(|cell| escaped(&cell.text())).collect()));
        [heads, rules].into_iter().chain(rows).collect::<Vec<_>>().join("\n")
    }

    /// The table as a list of objects.
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

/// A text, or a dash for none.
pub(crate) fn or_dash<T: Into<String>>(text: Option<T>) -> Cell {
    text.map_or_else(|| "–".to_owned(), T::into).into()
}

#[cfg(test)]
#[path = "../tests/inside/table.rs"]
mod tests;
