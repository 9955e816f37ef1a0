//! Results on standard output, progress on standard error.

use super::failure::Failure;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;
use std::io::{ErrorKind, Write};

/// Prints results. A closed pipe is not an error: the work goes on without its reader.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(()),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        Err(error) => Err(Failure::files(format!("cannot write to standard output: {error}"))),
    }
}

/// Prints one JSON document.
pub(super) fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value).expect("plain data");
    print(&(text + "\n"))
}

/// A progress bar with the estimated time left and frames in its message. Invisible when `quiet` or without a terminal.
pub(super) fn progress(title: &str, steps: u64, quiet: bool) -> ProgressBar {
    let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let style = ProgressStyle::with_template("{prefix}  {wide_bar}  {msg}, {eta} left");
    let bar = ProgressBar::with_draw_target(Some(steps), target);
    bar.set_style(style.expect("a template of known keys"));
    bar.set_prefix(title.to_owned());
    bar
}

/// A number with three significant digits.
pub(super) fn significant(number: f64) -> String {
    let size = number.abs();
    if number == 0.0 {
        "0".to_owned()
    } else if !(1e-4..1e6).contains(&size) {
        format!("{number:.2e}")
    } else {
        let decimals = (2.0 - size.log10().floor()).max(0.0) as usize;
        format!("{number:.decimals$}")
    }
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
    fn three_digits() {
        let cases =
            [(0.0, "0"), (1.0, "1.00"), (0.012345, "0.0123"), (1234.5, "1234"), (99.96, "100.0"), (1e-9, "1.00e-9")];
        for (number, text) in cases {
            assert_eq!(significant(number), text);
        }
        assert_eq!(significant(f64::NAN), "NaN");
    }

    #[test]
    fn columns_line_up() {
        let rows = [["run", "turned"], ["½", "12"]].map(|row| row.map(str::to_owned));
        assert_eq!(columns(&rows, [false, true]), "  run  turned\n  ½        12\n");
    }
}
