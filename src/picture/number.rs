//! Numbers as text: few digits, a suitable unit, a true minus sign.

use super::text::THIN_SPACE;
use crate::reading::captions::{prefix as prefix_of, quantity, rounded};
use crate::sim::Diagnostic;

/// Standard gravity (m/s²).
pub(super) const EARTH: f64 = 9.806_65;

/// Shorter scenes have a clock with three digits (s).
const LEAST_SPAN: f64 = 0.1;

/// A time (s) in a scene that lasts `span` (s): milliseconds below a second, then seconds with two or one decimals. In a short scene all times
/// have one unit and so many decimals that its end has three digits.
pub(super) fn time(seconds: f64, span: f64) -> String {
    let milliseconds = (seconds * 1e3).round();
    let text = if span > 0.0 && span < LEAST_SPAN {
        let (factor, prefix) = prefix_of(span);
        let decimals = if span >= 100.0 * factor { 0 } else { 2 - usize::from(span >= 10.0 * factor) };
        format!("{:.decimals$} {prefix}s", seconds / factor)
    } else if milliseconds == 0.0 && seconds != 0.0 {
        quantity(rounded(seconds, 1), "s")
    } else if milliseconds.abs() < 1e3 {
        format!("{} ms", milliseconds + 0.0)
    } else if seconds.abs() < 9.995 {
        format!("{seconds:.2} s")
    } else {
        format!("{seconds:.1} s")
    };
    with_minus(text)
}

/// A moment (s) as exactly as it was typed: milliseconds below a second, also for zero if `small`, then seconds with a
/// number of decimals.
fn moment(seconds: f64, small: bool, decimals: usize) -> String {
    let text = match seconds.abs() {
        0.0 if !small => "0 s".to_owned(),
        size if size < LEAST_SECOND => format!("{} ms", rounded(seconds * 1e3, 4)),
        _ => format!("{seconds:.decimals$} s"),
    };
    with_minus(text)
}

/// The number of significant decimals of a moment (s) from a second on, at least one.
fn decimals(seconds: f64) -> usize {
    let text = format!("{:?}", rounded(seconds, 4));
    let plain = seconds.abs() >= LEAST_SECOND && !text.contains('e');
    text.split_once('.').filter(|_| plain).map_or(1, |(_, decimals)| decimals.len())
}

/// Writes times (s) that stand beside each other: with the same number of decimals from a second on, and zero in the
/// unit of its neighbours.
pub(super) fn moments(times: impl Iterator<Item = f64>) -> impl Fn(f64) -> String {
    let times: Vec<_> = times.collect();
    let small = times.iter().all(|&time| time < 1.0) || times.iter().any(|&time| time > 0.0 && time < 1.0);
    let decimals = times.iter().map(|&time| decimals(time)).max().unwrap_or(1);
    move |time| moment(time, small, decimals)
}

/// Shorter times are written in milliseconds (s).
const LEAST_SECOND: f64 = 0.999_95;

/// The factor and the prefix of the unit of all lengths in pictures of a body of a size (m): metres from 30 m on, millimetres from 30 mm on.
pub(super) fn metre(extent: f64) -> (f64, &'static str) {
    prefix_of(extent / 30.0)
}

/// Whether lengths up to one (m) have one to three digits in the unit of a body of a size (m). Zero has none in any unit.
pub(super) fn suits(longest: f64, extent: f64) -> bool {
    longest == 0.0 || (0.999_5..999.5).contains(&(longest / metre(extent).0))
}

/// A count.
pub(super) fn count(count: usize) -> String {
    with_minus(count.to_string())
}

/// A text that may begin with a count, such as `1000000 cubes`.
pub(super) fn counted(text: String) -> String {
    match text.split_once(' ').map(|(first, rest)| (first.parse(), rest)) {
        Some((Ok(number), rest)) => format!("{} {rest}", count(number)),
        _ => text,
    }
}

/// A small length (m), in the unit that suits the size of the body (m) throughout a run; a far longer one in that of charts.
pub(super) fn length(metres: f64, extent: f64) -> String {
    if !metres.is_finite() {
        return "∞".to_owned();
    }
    let (factor, prefix) = metre(extent);
    /// Shorter ones are round-off (sizes of the body).
    const ROUND_OFF: f64 = 1e-8;
    let (value, unit) = (metres / factor, format!("{prefix}m"));
    match value.abs() {
        size if size < 0.05 && metres > ROUND_OFF * extent => format!("< 0.1 {unit}"),
        size if size < 9.95 => with_minus(format!("{value:.1} {unit}")),
        size if size < 999.5 => with_minus(format!("{value:.0} {unit}")),
        _ => with_minus(quantity(metres, "m")),
    }
}

/// A value of a diagnostic with its unit, of a body of a size (m).
pub(super) fn value(diagnostic: Diagnostic, value: f64, extent: f64) -> String {
    match diagnostic {
        Diagnostic::TurnedOver | Diagnostic::Broken | Diagnostic::Crossings => value.to_string(),
        Diagnostic::VolumeRatio => ratio(value),
        Diagnostic::ShapeError => length(value, extent),
        _ => with_unit(value, diagnostic.unit()),
    }
}

/// A value with a unit.
pub(super) fn with_unit(value: f64, unit: &str) -> String {
    with_minus(quantity(value, unit))
}

/// A ratio around 1, with two decimals.
pub(super) fn ratio(value: f64) -> String {
    match value.abs() {
        size if size < 999.5 => with_minus(format!("{:.2}", value + 0.0)),
        _ if value.is_finite() => with_minus(format!("{value:.1e}")),
        _ => "∞".to_owned(),
    }
}

/// A typeset number: with a true minus sign, no negative zero, and thin spaces between thousands from 10 000 on.
pub(super) fn with_minus(text: String) -> String {
    let zero = text.strip_prefix('-').filter(|rest| !rest.contains(|c: char| ('1'..='9').contains(&c)));
    let text = zero.map_or_else(|| text.replace('-', "−"), str::to_owned);
    let is_digit = |c: char| c.is_ascii_digit();
    let Some(first) = text.find(is_digit) else { return text };
    let length = text[first..].find(|c| !is_digit(c)).unwrap_or(text.len() - first);
    let mut set = text[..first].to_owned();
    for (at, digit) in text[first..first + length].chars().enumerate() {
        if at > 0 && length > 4 && (length - at).is_multiple_of(3) {
            set.push(THIN_SPACE);
        }
        set.push(digit);
    }
    set + &text[first + length..]
}

/// The largest of 1, 2 and 5 times a power of ten that is not larger than a positive value.
pub(super) fn round_below(value: f64) -> f64 {
    let power = libm::floor(libm::log10(value.clamp(1e-300, 1e300)));
    let digit = value / libm::pow(10.0, power);
    times_ten([5.0, 2.0].into_iter().find(|round| digit >= *round).unwrap_or(1.0), power)
}

/// A number times a power of ten, rounded like its text.
pub(super) fn times_ten(digits: f64, power: f64) -> f64 {
    format!("{digits}e{power}").parse().unwrap_or(digits)
}

/// A round length (m) in pictures of a body of a size (m): in the unit of its other lengths, or a larger one for
/// thousands.
pub(super) fn round_length(metres: f64, extent: f64) -> String {
    let (factor, prefix) = metre(extent);
    let suits = (1e-2..0.999e3).contains(&(metres / factor));
    let (factor, prefix) = if suits { (factor, prefix) } else { prefix_of(metres) };
    let value = metres / factor;
    let plain = (0.01..1e4).contains(&value);
    if plain { format!("{} {prefix}m", rounded(value, 3)) } else { with_minus(quantity(metres, "m")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_change_their_unit_at_one_second() {
        let times = [0.0, 0.07, 0.016_667, 0.9994, 0.9996, 1.0, 2.345, 9.994, 9.996, 10.0, 123.456, -0.02];
        let expected = [
            "0 ms", "70 ms", "17 ms", "999 ms", "1.00 s", "1.00 s", "2.35 s", "9.99 s", "10.0 s", "10.0 s", "123.5 s",
            "−20 ms",
        ];
        assert_eq!(times.map(|seconds| time(seconds, 200.0)), expected);
    }

    #[test]
    fn short_times_keep_their_digits() {
        assert_eq!(prefix_of(0.0), (1.0, ""), "an axis of zeros is not in attonewtons");
        assert_eq!([0.0, 2.3e-4, -4e-7].map(|seconds| time(seconds, 3.0)), ["0 ms", "200 µs", "−400 ns"]);
        assert_eq!([0.0, 4.02e-4, 1e-3].map(|seconds| time(seconds, 1e-3)), ["0.00 ms", "0.40 ms", "1.00 ms"]);
        assert_eq!([0.0, 0.0123, 0.05].map(|seconds| time(seconds, 0.05)), ["0.0 ms", "12.3 ms", "50.0 ms"]);
        assert_eq!([7.3e-8, 2e-7].map(|seconds| time(seconds, 2e-7)), ["73 ns", "200 ns"]);
    }

    #[test]
    fn values_have_three_digits_in_any_size() {
        let values = [7.42, 1022.4, 5.2e-17, 3e18, -4e-30].map(|value| with_unit(value, "J"));
        assert_eq!(values, ["7.42 J", "1.02 kJ", "52 aJ", "3 EJ", "−4×10⁻³⁰ J"]);
        assert_eq!([with_unit(12_345.0, "kg m/s"), with_unit(3e6, "kg m/s")], ["12\u{2009}300 kg m/s", "3×10⁶ kg m/s"]);
    }

    #[test]
    fn moments_are_what_was_typed() {
        let times = [0.0, 0.07, 0.0125, 1.0 / 3.0, 0.999_96, 1.0, 1.46, 12.345_678, 1e5];
        let expected =
            ["0 ms", "70 ms", "12.5 ms", "333.3 ms", "1.0 s", "1.0 s", "1.46 s", "12.35 s", "100\u{2009}000.0 s"];
        assert_eq!(times.map(|time| moment(time, true, decimals(time))), expected);
        assert_eq!((moment(0.0, false, 2), moment(1.5, false, 2)), ("0 s".to_owned(), "1.50 s".to_owned()));
    }

    #[test]
    fn lengths_have_the_unit_of_their_body() {
        assert_eq!(length(0.0241, 0.3), "24 mm");
        assert_eq!(length(0.0, 0.3), "0.0 mm");
        assert_eq!(
            [-1e-9, 1e-9, 1.87e-5, 6e-5].map(|small| length(small, 0.3)),
            ["0.0 mm", "0.0 mm", "< 0.1 mm", "0.1 mm"]
        );
        assert_eq!(length(2.5, 100.0), "2.5 m");
        assert_eq!(length(f64::NAN, 0.3), "∞");
        assert_eq!([length(0.83, 0.3), length(4.12, 0.3), length(1e12, 0.3)], ["830 mm", "4.12 m", "1 Tm"]);
        assert_eq!([length(4e-9, 6e-6), length(2e3, 5e5)], ["4.0 nm", "2.0 km"]);
    }

    #[test]
    fn ratios_have_two_decimals_and_a_real_minus() {
        assert_eq!([0.987, -1.0, -0.001, f64::INFINITY].map(ratio), ["0.99", "−1.00", "0.00", "∞"]);
    }

    #[test]
    fn round_lengths_have_the_unit_of_the_others() {
        let lengths = [0.0123, 0.05, 0.99, 1.0, 2.6, 4000.0, 3e-6, 7e-13, 6e13];
        let expected = ["10 mm", "50 mm", "500 mm", "1 m", "2 m", "2 km", "2 µm", "500 fm", "50 Tm"];
        assert_eq!(lengths.map(|length| round_length(round_below(length), 0.3)), expected);
        assert_eq!((round_length(0.5, 50.0), round_length(0.5, 0.3)), ("0.5 m".to_owned(), "500 mm".to_owned()));
    }

    #[test]
    fn thousands_stand_apart() {
        let set = |text: &str| with_minus(text.to_owned());
        assert_eq!(set("-12345.6789"), "−12\u{2009}345.6789");
        assert_eq!([set("9999"), set("1234567 J")], ["9999", "1\u{2009}234\u{2009}567 J"]);
        assert_eq!([set("-0.0"), set("1.5e-7"), count(27), count(39_304)], ["0.0", "1.5e−7", "27", "39\u{2009}304"]);
        let texts = ["27 cubes", "39304 cubes, k = 10 kN/m", "springs"].map(|text| counted(text.to_owned()));
        assert_eq!(texts, ["27 cubes", "39\u{2009}304 cubes, k = 10 kN/m", "springs"]);
    }
}
