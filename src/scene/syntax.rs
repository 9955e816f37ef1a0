//! Mistakes in the syntax of TOML.

use crate::reading::Mistakes;
use crate::reading::collector::mistake;
use crate::reading::source::Source;
use crate::reading::words::quoted;

/// The help at a missing comma or end of an array.
const UNCLOSED: &str = "is an array before this not closed with `]`?";

/// The errors of the TOML parser: the first of each line, up to the first array without an end, which causes the
/// others.
pub(super) fn mistakes(source: &Source<'_>, errors: &[toml::de::Error], name: &str) -> Mistakes {
    let mut found: Vec<_> = errors
        .iter()
        .map(|error| {
            let mut span = error.span().unwrap_or(0..0);
            let (found, text) = (error.message(), source.text().get(span.clone()).unwrap_or_default());
            let not_toml = || format!("this is not TOML: {found}");
            let (message, help) = if found == "duplicate key" {
                let is_list = ["body", "run", "obstacle", "hold", "grab", "load", "probe"].contains(&text);
                let help = is_list.then(|| format!("write `[[{text}]]` before each of several"));
                (format!("`{text}` is given a second time"), help)
            } else if let Some((comma, [whole, part])) = decimal_comma(source.text(), span.start) {
                span = comma..comma + 1;
                let message = format!("`{whole},{part}` has a decimal comma");
                (message, Some(format!("a number has a decimal point, not a comma: {whole}.{part}")))
            } else if let Some(key) = key_without_value(source.text(), span.start) {
                (format!("`{key}` has no value"), Some("write one after `=`, or remove the key".to_owned()))
            } else if found.contains("array") {
                (not_toml(), Some(UNCLOSED.to_owned()))
            } else if found.starts_with("invalid boolean") {
                // The parser takes unquoted text for a truth value.
                (not_toml(), Some(format!("a text needs quotation marks: {}", quoted(text))))
            } else {
                (not_toml(), None)
            };
            mistake(Some(source), span, &[], message, help)
        })
        .collect();
    found.sort_by_key(|mistake| (mistake.line, mistake.column));
    found.dedup_by_key(|mistake| mistake.line);
    if let Some(array) = found.iter().position(|mistake| mistake.help.as_deref() == Some(UNCLOSED)) {
        found.truncate(array + 1);
    }
    let total = found.len();
    found.truncate(1000);
    Mistakes { file: name.into(), found, total }
}

/// The key before an equals sign without a value on its line or in its table, before a byte of a text.
fn key_without_value(text: &str, at: usize) -> Option<&str> {
    let (before, after) = text.split_at_checked(at)?;
    let rest = after.lines().next().unwrap_or_default().trim_start();
    let is_end = rest.is_empty() || rest.starts_with(['#', ',', '}']);
    let key = before.lines().last()?.trim_end().strip_suffix('=')?.trim_end();
    key.rsplit([' ', ',', '{']).next().filter(|key| is_end && !key.is_empty())
}

/// The decimal comma of a value in a line, at or before a byte of a text, and the digits before and after the comma.
fn decimal_comma(text: &str, at: usize) -> Option<(usize, [&str; 2])> {
    let (before, after) = text.split_at_checked(at)?;
    let from = before.rfind('\n').map_or(0, |end| end + 1);
    let line = text[from..at + after.find('\n').unwrap_or(after.len())].trim_end();
    let equals = before[from..].rfind('=')?;
    // Equals signs in strings and comments do not count.
    let is_outside = |quote: char| line[..equals].matches(quote).count().is_multiple_of(2);
    if line[..equals].contains('#') || !['"', '\''].into_iter().all(is_outside) {
        return None;
    }
    let value = line[equals + 1..].trim_start();
    let (whole, rest) = value.split_once(',')?;
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let unsigned = whole.trim_start_matches(['+', '-']);
    let (part, rest) = rest.split_at(digits(rest));
    let ends = rest.is_empty() || rest.starts_with([' ', '\t', '#', ',', '}', ']', '\r']);
    let is_number = !unsigned.is_empty() && digits(unsigned) == unsigned.len() && !part.is_empty();
    let comma = from + line.len() - value.len() + whole.len();
    (is_number && ends).then_some((comma, [whole, part]))
}
