//! Words for messages.

use crate::reading::captions::rounded;
use serde_json::Value as Json;
use toml::de::{DeInteger, DeValue};

/// A text in quotation marks, shortened.
pub(crate) fn quoted(text: &str) -> String {
    format!("\"{}\"", shortened(text))
}

/// A text without control characters, shortened in its middle.
pub(crate) fn shortened(text: &str) -> String {
    let clean = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    let count = text.chars().count();
    if count <= 40 {
        return text.chars().map(clean).collect();
    }
    text.chars().take(24).map(clean).chain(" … ".chars()).chain(text.chars().skip(count - 12).map(clean)).collect()
}

/// Bytes as hexadecimal digits.
pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// `a, b or c`.
pub(crate) fn list<S: AsRef<str>>(names: &[S], joint: &str, write: impl Fn(&str) -> String) -> String {
    match names {
        [] => String::new(),
        [only] => write(only.as_ref()),
        [first @ .., last] => {
            let first: Vec<_> = first.iter().map(|name| write(name.as_ref())).collect();
            format!("{} {joint} {}", first.join(", "), write(last.as_ref()))
        }
    }
}

/// The known name that is most similar to the typed one. They differ by at most one letter in three, or the known name
/// contains the typed one, or its words begin with the letters of the typed one, as in `fps` for `frames_per_second`.
pub(crate) fn nearest<'a>(typed: &str, known: &[&'a str]) -> Option<&'a str> {
    // The comparison is quadratic, so long names are not compared.
    if typed.len() > 100 {
        return None;
    }
    let plain = |text: &str| text.to_lowercase().replace(['_', ' '], "-");
    let typed = plain(typed);
    let distance = |name: &&str| strsim::osa_distance(&typed, &plain(name));
    let near = |name: &&&str| {
        let name: &str = name;
        distance(&name) * 3 <= name.chars().count().max(typed.chars().count()).max(3)
    };
    let contained = |name: &&&str| typed.len() >= 4 && plain(name).contains(&typed);
    let first_letters = |name: &&&str| plain(name).split('-').filter_map(|word| word.chars().next()).eq(typed.chars());
    let initials = |name: &&&str| typed.len() > 1 && first_letters(name);
    let others = || known.iter().find(contained).or_else(|| known.iter().find(initials));
    known.iter().filter(near).min_by_key(|name| distance(name)).or_else(others).copied()
}

/// A value in words: `the string "3"`, `an array of 2`.
pub(crate) fn found(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => format!("the string {}", quoted(text)),
        DeValue::Integer(number) => format!("the whole number {}", shortened(&number.to_string())),
        DeValue::Float(number) => format!("the number {}", shortened(number.as_str())),
        DeValue::Boolean(truth) => truth.to_string(),
        DeValue::Datetime(date) => format!("the date {date}"),
        DeValue::Array(items) => format!("an array of {}", items.len()),
        DeValue::Table(_) => "a table".into(),
    }
}

/// A whole number of any size as a floating-point number.
pub(crate) fn to_f64(integer: &DeInteger<'_>) -> f64 {
    match i128::from_str_radix(integer.as_str(), integer.radix()) {
        Ok(exact) => exact as f64,
        Err(_) => integer.as_str().parse().unwrap_or(f64::INFINITY),
    }
}

/// A whole number as JSON, if 64 bits hold it.
pub(crate) fn to_json(integer: &DeInteger<'_>) -> Option<Json> {
    let exact = i128::from_str_radix(integer.as_str(), integer.radix()).ok()?;
    u64::try_from(exact).map(Json::from).or_else(|_| i64::try_from(exact).map(Json::from)).ok()
}

/// A count with separated thousands: `1 030 301`.
pub(crate) fn count(number: u128) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// A number of things: `1 body`, `1 030 301 nodes`.
pub(crate) fn several(number: impl TryInto<u128>, one: &str) -> String {
    let number = number.try_into().unwrap_or(u128::MAX);
    format!("{} {one}{}", count(number), if number == 1 { "" } else { "s" })
}

/// A number with up to four significant digits.
pub(crate) fn short(number: f64) -> String {
    significant(number, 4)
}

/// The ends of a range, rounded outwards to four significant digits of its length. An end with fewer digits stays as it
/// is.
pub(crate) fn ends([low, high]: [f64; 2]) -> [String; 2] {
    let magnitude = |number: f64| libm::floor(libm::log10(number.abs()));
    let out = |number: f64, is_beyond: fn(f64, f64) -> bool| {
        // Numbers with few digits, to round-off, are not rounded.
        let exact = rounded(number, 12);
        if exact == 0.0 {
            return exact;
        }
        let digits = (4.0 + magnitude(exact) - magnitude(high - low)).clamp(4.0, 12.0);
        let near = rounded(number, digits as usize);
        if near == exact || is_beyond(near, exact) {
            return near;
        }
        let last = libm::exp10(magnitude(exact) + 1.0 - digits);
        rounded(if is_beyond(near - last, exact) { near - last } else { near + last }, digits as usize)
    };
    [out(low, |one, other| one <= other), out(high, |one, other| one >= other)].map(fine)
}

/// A number with up to twelve significant digits, for the bounds of regions.
pub(crate) fn fine(number: f64) -> String {
    significant(number, 12)
}

fn significant(number: f64, digits: usize) -> String {
    // Adding zero turns −0 into 0.
    let rounded = rounded(number, digits) + 0.0;
    if rounded == 0.0 || (1e-4..1e6).contains(&rounded.abs()) { format!("{rounded}") } else { format!("{rounded:e}") }
}

/// An amount of memory in words.
pub(crate) fn size(bytes: u128) -> String {
    match bytes {
        0..1_000_000 => format!("{} kB", bytes.div_ceil(1000)),
        1_000_000..1_073_741_824 => format!("{} MiB", bytes.div_ceil(1 << 20)),
        1_073_741_824..107_374_182_400 => format!("{:.1} GiB", bytes as f64 / f64::from(1 << 30)),
        _ => format!("{} GiB", count(bytes >> 30)),
    }
}

/// A text for XML or HTML, between tags or in double quotation marks. Characters that XML forbids are left out.
pub(crate) fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => safe += "&amp;",
            '<' => safe += "&lt;",
            '>' => safe += "&gt;",
            '"' => safe += "&quot;",
            '\n' | '\t' => safe.push(character),
            '\u{fffe}' | '\u{ffff}' => {}
            other if other.is_control() => {}
            other => safe.push(other),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_keep_their_range() {
        for (range, written) in [
            ([-0.153_26, 0.153_24], ["-0.1533", "0.1533"]),
            ([100.005, 100.015], ["100.005", "100.015"]),
            ([1e6, 1e6 + 0.3], ["1e6", "1.0000003e6"]),
            ([0.0, 0.123_456], ["0", "0.1235"]),
            ([0.0, 0.0], ["0", "0"]),
            ([0.123_456, 0.123_456], ["0.123456", "0.123456"]),
        ] {
            assert_eq!(ends(range), written, "{range:?}");
        }
    }

    #[test]
    fn the_nearest_name_is_a_similar_one() {
        let known = ["stiffness", "damping", "damping_ratio", "springs"];
        assert_eq!(nearest("stifness", &known), Some("stiffness"));
        assert_eq!(nearest("Stiffness", &known), Some("stiffness"));
        assert_eq!(nearest("damping-ratio", &known), Some("damping_ratio"));
        assert_eq!(nearest("ratio", &known), Some("damping_ratio"));
        assert_eq!(nearest("colour", &known), None);
        assert_eq!(nearest("", &known), None);
        assert_eq!(nearest("s", &known), None);
        assert_eq!(nearest("fps", &["duration", "frames_per_second"]), Some("frames_per_second"));
    }

    #[test]
    fn counts_have_separated_thousands() {
        assert_eq!(count(0), "0");
        assert_eq!(count(999), "999");
        assert_eq!(count(1_030_301), "1 030 301");
        assert_eq!([0, 1, 1000].map(|number: usize| several(number, "node")), ["0 nodes", "1 node", "1 000 nodes"]);
    }
}
