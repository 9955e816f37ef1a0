//! Numbers as a picture writes them: few digits, a unit that suits them, a minus that is one.

/// A time (s): milliseconds below a second, then seconds with two or one decimals.
pub(super) fn time(seconds: f64) -> String {
    let milliseconds = (seconds * 1e3).round();
    let text = if milliseconds.abs() < 1e3 {
        format!("{} ms", milliseconds + 0.0)
    } else if seconds.abs() < 9.995 {
        format!("{seconds:.2} s")
    } else {
        format!("{seconds:.1} s")
    };
    with_minus(text)
}

/// A small length (m), in the unit that suits the size of the body (m) throughout a run.
pub(super) fn length(metres: f64, extent: f64) -> String {
    if !metres.is_finite() {
        return "∞".to_owned();
    }
    let (value, unit) = match extent {
        extent if extent >= 30.0 => (metres, "m"),
        extent if extent >= 0.03 => (metres * 1e3, "mm"),
        _ => (metres * 1e6, "µm"),
    };
    match value.abs() {
        size if size < 9.95 => with_minus(format!("{value:.1} {unit}")),
        size if size < 99_999.5 => with_minus(format!("{value:.0} {unit}")),
        _ => with_minus(format!("{value:.1e} {unit}")),
    }
}

/// A ratio around 1, with two decimals.
pub(super) fn ratio(value: f64) -> String {
    match value.abs() {
        size if size < 999.5 => with_minus(format!("{:.2}", value + 0.0)),
        _ if value.is_finite() => with_minus(format!("{value:.1e}")),
        _ => "∞".to_owned(),
    }
}

fn with_minus(text: String) -> String {
    let zero = text.strip_prefix('-').filter(|rest| !rest.contains(|c: char| ('1'..='9').contains(&c)));
    zero.map_or_else(|| text.replace('-', "−"), str::to_owned)
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
        assert_eq!(times.map(time), expected);
    }

    #[test]
    fn lengths_have_the_unit_of_their_body() {
        assert_eq!(length(0.0241, 0.3), "24 mm");
        assert_eq!(length(0.0, 0.3), "0.0 mm");
        assert_eq!(length(-1e-9, 0.3), "0.0 mm");
        assert_eq!(length(2.5, 100.0), "2.5 m");
        assert_eq!(length(f64::NAN, 0.3), "∞");
        assert_eq!(length(1e12, 0.3), "1.0e15 mm");
    }

    #[test]
    fn ratios_have_two_decimals_and_a_real_minus() {
        assert_eq!([0.987, -1.0, -0.001, f64::INFINITY].map(ratio), ["0.99", "−1.00", "0.00", "∞"]);
    }
}
