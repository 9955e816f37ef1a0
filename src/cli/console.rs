//! Results on standard output.

use super::failure::Failure;
use crate::output::document;
use serde::Serialize;
use std::io::{ErrorKind, Write};

/// Prints results. A closed pipe is not an error: the work continues without its reader.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(()),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        Err(error) => Err(Failure::files(format!("cannot write to standard output: {error}"))),
    }
}

/// Prints one JSON document.
pub(super) fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    print(&document(value))
}

/// Rows with aligned columns: to the left, or to the right where `right` says so.
pub(super) fn columns<const N: usize>(rows: &[[String; N]], right: [bool; N]) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; N] = std::array::from_fn(width);
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for ((cell, width), right) in row.iter().zip(widths).zip(right) {
            line += &if right { format!("  {cell:>width$}") } else { format!("  {cell:<width$}") };
        }
        text += line.trim_end();
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up() {
        let rows = [["run", "turned"], ["½", "12"]].map(|row| row.map(str::to_owned));
        assert_eq!(columns(&rows, [false, true]), "  run  turned\n  ½        12\n");
    }
}
