//! Rows and columns as CSV and as Markdown.

use crate::output::rows_as_csv;

/// A table of texts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Sheet {
    /// The headings of the columns.
    pub heads: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Sheet {
    /// A table from rows of cells, each with the heading of its column.
    pub(crate) fn of<const N: usize>(rows: impl IntoIterator<Item = [(&'static str, String); N]>) -> Self {
        let mut sheet = Self::default();
        for row in rows {
            sheet.heads = row.iter().map(|(head, _)| (*head).to_owned()).collect();
            sheet.rows.push(row.into_iter().map(|(_, cell)| cell).collect());
        }
        sheet
    }

    /// As CSV.
    pub(crate) fn csv(&self) -> String {
        let rows = std::iter::once(&self.heads).chain(&self.rows);
        String::from_utf8(rows_as_csv(rows)).expect("made of texts")
    }

    /// As Markdown, with the first `left` columns aligned left and the others, numbers, aligned right.
    pub(crate) fn markdown(&self, left: usize) -> String {
        let escaped = |cell: &str| cell.replace('|', "\\|");
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let rule = |column| if column < left { "---" } else { "---:" }.to_owned();
        let mut text = line(self.heads.iter().map(|head| escaped(head)).collect());
        text += &line((0..self.heads.len()).map(rule).collect());
        self.rows.iter().for_each(|row| text += &line(row.iter().map(|cell| escaped(cell)).collect()));
        text
    }
}

/// A number with three significant digits, the same on every machine.
pub(super) fn figure(number: f64) -> String {
    let short = format!("{number:.2e}");
    // The exponent is read from the rounded text: a logarithm could round powers of ten differently on each platform.
    match short.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok()) {
        Some(_) if number == 0.0 => "0".to_owned(),
        Some(exponent @ -3..=5) => format!("{number:.*}", (2 - exponent).max(0) as usize),
        _ => short,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_can_be_read_again() {
        let sheet = Sheet::of([[("name", "a, \"b\"".to_owned()), ("|w|", "1".to_owned())]]);
        assert_eq!(sheet.csv(), "name,|w|\n\"a, \"\"b\"\"\",1\n");
        assert_eq!(sheet.markdown(1), "| name | \\|w\\| |\n| --- | ---: |\n| a, \"b\" | 1 |\n");
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
