//! Words as numbers, and in messages.

/// A number in the notation of C, or in that of Fortran: `1.5D+00`.
#[inline]
pub(super) fn real(word: &[u8]) -> Option<f64> {
    let word = std::str::from_utf8(word).ok()?;
    word.parse().ok().or_else(|| word.replace(['D', 'd'], "e").parse().ok())
}

/// What to do about a number with a comma.
pub(in crate::read) fn comma(word: &[u8]) -> Option<String> {
    let word = std::str::from_utf8(word).ok().filter(|word| word.contains(','))?;
    let point = word.replacen(',', ".", 1);
    let is_number = |text: &str| text.is_empty() || text.parse::<f64>().is_ok();
    match () {
        () if !word.ends_with(',') && is_number(&point) => Some(format!("write a decimal point, not a comma: {point}")),
        () if word.split(',').all(is_number) => Some("separate numbers by spaces, not by commas".to_owned()),
        () => None,
    }
}

/// Whether a word stands for a number that is none, in the notations of C and of Windows: `-nan(ind)`, `1.#QNAN`, `inf`.
pub(super) fn is_no_number(word: &[u8]) -> bool {
    let lower = word.to_ascii_lowercase();
    let unsigned = lower.strip_prefix(b"-").or(lower.strip_prefix(b"+")).unwrap_or(&lower);
    matches!(unsigned, b"nan" | b"inf" | b"infinity" | [b'1', b'.', b'#', ..] | [b'n', b'a', b'n', b'(', ..])
}

pub(in crate::read) fn integer(word: &[u8]) -> Option<i64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// The beginning of some bytes, in quotes and readable.
pub(in crate::read) fn quoted(bytes: &[u8]) -> String {
    /// The most characters that are shown.
    const MOST: usize = 40;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * MOST)]);
    let mut shown: String = text.chars().take(MOST).flat_map(char::escape_debug).collect();
    if text.chars().count() > MOST {
        shown.push('…');
    }
    format!("`{shown}`")
}
