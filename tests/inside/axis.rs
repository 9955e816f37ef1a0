//! Round numbers along an axis.

use super::*;

#[test]
fn ticks_are_few_and_round() {
    type Case<'a> = (Kind, [f64; 2], &'a str, usize, &'a [&'a str], &'a str);
    let expected: [Case; 34] = [
        (Kind::Count, [0.0, 9.0], "", 4, &["0", "3", "6", "9"], ""),
        (Kind::Count, [0.0, 1.0], "", 4, &["0", "1"], ""),
        (Kind::Count, [0.0, 10.0], "", 4, &["0", "5", "10"], ""),
        (Kind::Count, [0.0, 27.0], "", 4, &["0", "10", "20", "30"], ""),
        (Kind::Count, [0.0, 27.0], "", 2, &["0", "30"], ""),
        (Kind::Count, [0.0, 9.0], "", 3, &["0", "5", "10"], ""),
        (Kind::Value, [0.0, 0.102], "m", 4, &["0", "40", "80", "120"], "mm"),
        // Far longer than the body of 0.3 m, and far shorter than a millimetre.
        (Kind::Value, [0.0, 3.136], "m", 4, &["0", "2", "4"], "m"),
        (Kind::Value, [0.0, 1.02e-4], "m", 4, &["0", "40", "80", "120"], "µm"),
        // Their ends would have four digits in millimetres, with three ticks, and so all have a unit in which none has.
        (Kind::Value, [-0.83, 0.0], "m", 3, &["−1.0", "−0.5", "0"], "m"),
        (Kind::Value, [-0.83, 0.0], "m", 4, &["−0.9", "−0.6", "−0.3", "0"], "m"),
        (Kind::Value, [0.0, 0.49], "m", 3, &["0", "250", "500"], "mm"),
        (Kind::Value, [0.0, 7.28], "N", 3, &["0", "4", "8"], "N"),
        (Kind::Value, [0.0, 225.0], "N", 3, &["0", "250"], "N"),
        (Kind::Value, [0.0, 225.0], "N", 4, &["0", "100", "200", "300"], "N"),
        (Kind::Value, [0.0, 62.0], "N", 4, &["0", "25", "50", "75"], "N"),
        (Kind::Value, [0.0, 3136.0], "J", 4, &["0", "2", "4"], "kJ"),
        (Kind::Value, [0.0, 1.55], "", 3, &["0", "1", "2"], ""),
        (Kind::Count, [0.0, 85.0], "", 3, &["0", "50", "100"], ""),
        (Kind::Value, [0.62, 1.08], "", 4, &["0.6", "0.8", "1.0", "1.2"], ""),
        (Kind::Value, [-35.0, 120.0], "J", 4, &["−50", "0", "50", "100"], "J"),
        (Kind::Value, [0.0, 4e-7], "kg m/s", 4, &["0", "2×10⁻⁷", "4×10⁻⁷"], "kg m/s"),
        (Kind::Fixed, [0.0, 3.0], "s", 6, &["0", "1", "2", "3"], "s"),
        (Kind::Fixed, [0.0, 0.1], "s", 4, &["0", "50", "100"], "ms"),
        (Kind::Fixed, [0.0, 6.5], "s", 5, &["0", "2", "4", "6"], "s"),
        (Kind::Fixed, [0.0, 5000.0], "s", 4, &["0", "2500", "5000"], "s"),
        (Kind::Fixed, [0.0, 0.5], "", 5, &["0", "0.25", "0.50"], ""),
        (Kind::Fixed, [0.0, 1.0], "", 5, &["0", "0.25", "0.50", "0.75", "1.00"], ""),
        (Kind::Fixed, [0.0, 9.9], "m/s", 5, &["0", "2", "4", "6", "8"], "m/s"),
        (Kind::Fixed, [0.0, 0.05], "m", 5, &["0", "25", "50"], "mm"),
        (Kind::Fixed, [-0.02, 0.02], "m", 5, &["−20", "−10", "0", "10", "20"], "mm"),
        (Kind::Fixed, [0.0, 12.5], "J", 5, &["0", "5", "10"], "J"),
        (Kind::Fixed, [0.0, 2e6], "J", 5, &["0", "0.5", "1.0", "1.5", "2.0"], "MJ"),
        (Kind::Fixed, [0.0, 3e-7], "", 5, &["0", "1×10⁻⁷", "2×10⁻⁷", "3×10⁻⁷"], ""),
    ];
    for (kind, range, unit, most, texts, with_prefix) in expected {
        let axis = Stretch::new(kind, range, unit, 0.3, most);
        assert_eq!(axis.texts, texts, "{range:?}: {axis:?}");
        assert_eq!(axis.unit, with_prefix, "{range:?}");
    }
}

#[test]
fn whatever_the_range_it_is_inside_and_ticks_rise() {
    for step in 0..3000 {
        let high = 1e-9 * libm::pow(10.0, f64::from(step) * 0.006_13);
        for low in [0.0, 0.1 * high, -0.37 * high, -high, -12.0 * high, 0.7 * high, 0.95 * high] {
            for kind in [Kind::Fixed, Kind::Value] {
                for most in 2..=6 {
                    let axis = Stretch::new(kind, [low, high], "m", 0.3, most);
                    let told = || format!("{kind:?} {low} {high} {most}: {axis:?}");
                    assert!((2..=most).contains(&axis.ticks.len()), "{}", told());
                    assert!(axis.ticks.windows(2).all(|two| two[0] < two[1]), "{}", told());
                    assert!(axis.ticks.iter().all(|&tick| (-1e-6..=1.0 + 1e-6).contains(&axis.share(tick))));
                    assert!((-1e-6..=0.34).contains(&axis.share(low)), "{}", told());
                    assert!((0.66..=1.0 + 1e-6).contains(&axis.share(high)), "{}", told());
                    let distinct: std::collections::BTreeSet<_> = axis.texts.iter().collect();
                    assert_eq!(distinct.len(), axis.texts.len(), "{}", told());
                }
            }
        }
    }
    for count in 1..500 {
        let axis = Stretch::new(Kind::Count, [0.0, f64::from(count)], "", 0.3, 4);
        assert!((2..=4).contains(&axis.ticks.len()), "{count}: {axis:?}");
        assert!(axis.ticks.iter().all(|tick| tick.fract() == 0.0), "{count}: {axis:?}");
    }
}

#[test]
fn odd_ranges_do_no_harm() {
    for odd in [[0.0, 0.0], [3.0, 3.0], [-f64::MAX, f64::MAX], [0.0, 5e-324], [1.0, 1.0 + 1e-15]] {
        for kind in [Kind::Fixed, Kind::Count, Kind::Value] {
            let axis = Stretch::new(kind, odd, "J", 0.3, 4);
            assert!(axis.ticks.len() <= 4 && axis.ticks.len() == axis.texts.len(), "{odd:?} {axis:?}");
        }
    }
    assert_eq!(Stretch::new(Kind::Value, [0.0, 0.0], "m", 0.3, 4).texts, ["0"]);
}

/// Such as the elements that have turned over, if none do.
#[test]
fn a_count_that_stays_zero_has_a_tick_at_one() {
    let axis = Stretch::new(Kind::Count, [0.0, 0.0], "", 0.3, 4);
    assert_eq!(
        (axis.ticks, axis.texts, axis.range),
        (vec![0.0, 1.0], ["0", "1"].map(str::to_owned).into(), [0.0, 1.0])
    );
    assert_eq!(Stretch::new(Kind::Value, [0.0, 0.0], "J", 0.3, 4).ticks, [0.0]);
    assert_eq!(Stretch::new(Kind::Count, [2.0, 2.0], "", 0.3, 4).ticks, [0.0; 0]);
}
