//! The times at which frames are shown.

use super::*;

fn even(count: u64, rate: f64) -> Timeline {
    Timeline::of(&(0..count).map(|number| (number, number as f64 / rate)).collect::<Vec<_>>())
}

#[test]
fn the_rate_follows_from_times_that_stray() {
    let stray = |number: u64| (number, number as f64 / 60.0 + if number % 3 == 1 { 1e-3 } else { 0.0 });
    let timeline = Timeline::of(&(0..=180).map(stray).collect::<Vec<_>>());
    assert!(timeline.shots().iter().all(|shot| (shot.duration - 1.0 / 60.0).abs() < 1e-12));
    assert_eq!(timeline.rate(), [60, 1]);
    assert_eq!(even(5, 25.0).faster(0.5).rate(), [25, 2]);
    assert_eq!(even(5, 60.0).faster(2.0).for_screens().rate(), [60, 1]);
    assert_eq!(even(5, 60.0).faster(2.0).rate(), [120, 1]);
    let few = Timeline::of(&[(0, 0.0), (1, 1.0 / 30.0 + 1e-3), (2, 2.0 / 30.0), (3, 3.0 / 30.0 + 1e-3)]);
    assert_eq!(few.rate(), [30, 1]);
    let tenth = Timeline::of(&[(0, 0.0), (10, 10.0 / 60.0), (20, 20.0 / 60.0)]);
    assert_eq!(tenth.rate(), [6, 1]);
}

#[test]
fn hundredths_carry_their_errors_on() {
    let ticks = even(31, 30.0).ticks(100.0, 2);
    assert_eq!(ticks.len(), 31);
    assert_eq!(ticks.iter().take(4).map(|(_, delay)| *delay).collect::<Vec<_>>(), [3, 4, 3, 3]);
    let mut start = 0;
    for (frame, delay) in ticks {
        assert!((start as f64 / 100.0 - frame as f64 / 30.0).abs() < 0.0051, "{frame} at {start}");
        start += delay;
    }
    let uneven = Timeline::of(&[(0, 0.0), (1, 0.001), (2, 0.5), (3, 0.501)]);
    assert_eq!(uneven.ticks(100.0, 2), [(0, 50), (3, 2)], "the first and the last are shown");
}

#[test]
fn held_and_sampled() {
    let frames = |timeline: &Timeline| timeline.shots().iter().map(|shot| shot.frame).collect::<Vec<_>>();
    let held = even(3, 10.0).holding(1.0);
    assert!((held.duration() - 1.3).abs() < 1e-12);
    assert_eq!(held.ticks(10.0, 1), [(0, 1), (1, 1), (2, 11)]);
    assert_eq!(frames(&even(8, 60.0).at_rate(30.0)), [0, 2, 4, 6]);
    assert_eq!(frames(&even(9, 60.0).at_rate(10.0)), [0, 6]);
    assert_eq!(frames(&even(9, 60.0).at_most(50.0)), [0, 2, 4, 6, 8]);
    assert_eq!(even(9, 50.0).at_most(50.0), even(9, 50.0));
    assert_eq!(even(4, 10.0).at_rate(20.0).ticks(20.0, 1), [(0, 2), (1, 2), (2, 2), (3, 2)]);
}

#[test]
fn fractions_are_simple() {
    for (number, most, expected) in [
        (1.0 / 60.0, 65535, [1, 60]),
        (30_000.0 / 1001.0, 1 << 20, [30_000, 1001]),
        (0.5, 65535, [1, 2]),
        (3.0, 65535, [3, 1]),
        (1e9, 65535, [65535, 1]),
    ] {
        assert_eq!(fraction(number, most), expected, "{number}");
    }
}
