//! Tables are read back, and compared with the documentation of their columns.

use std::collections::BTreeMap;

/// The cells of all tables in a Markdown text, without headings and rules.
pub(crate) fn markdown_rows(text: &str) -> Vec<Vec<String>> {
    let cells = |line: &str| line.trim_matches('|').split(" | ").map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
    let lines: Vec<_> = text.lines().collect();
    let of_table = |at: &usize| lines[*at].starts_with('|');
    let head = |at: usize| lines.get(at + 1).is_some_and(|next| next.starts_with("| ---"));
    let rows = (0..lines.len()).filter(of_table).filter(|&at| !head(at) && !lines[at].starts_with("| ---"));
    rows.map(|at| cells(lines[at])).collect()
}

/// The rows of a CSV text, by their headings.
pub(crate) fn records(text: &str) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    reader.deserialize().map(|row| row.expect("a row")).collect()
}

/// The numbers in a formatted cell, such as `1.42 (1.41 – 1.43)`.
pub(crate) fn numbers(cell: &str) -> Vec<f64> {
    let words = cell.split([' ', '(', ')', '–']).filter(|word| !word.is_empty());
    words.map(|word| word.parse().expect("a number")).collect()
}

/// Whether numbers are equal to three digits, or to six decimals.
pub(crate) fn same(shown: &[f64], exact: &[&str]) -> bool {
    let exact: Vec<f64> = exact.iter().map(|text| text.parse().expect("a number")).collect();
    let near = |(shown, exact): (&f64, &f64)| (shown - exact).abs() <= 0.00501 * exact.abs();
    shown.len() == exact.len() && shown.iter().zip(&exact).all(near)
}

/// The columns that `docs/files.md` documents for a CSV file.
pub(crate) fn documented(file: &str) -> Vec<&'static str> {
    let page = include_str!("../../../docs/files.md");
    let section = page.split("\n## ").find(|section| section.starts_with(&format!("`{file}`"))).expect("its section");
    let cells = section.lines().filter_map(|line| line.strip_prefix("| `")?.split(" | ").next());
    cells.flat_map(|cell| cell.split(", ")).map(|name| name.trim_matches('`')).collect()
}
