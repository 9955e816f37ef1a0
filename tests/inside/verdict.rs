//! Verdicts on two pictures.

use super::*;
use crate::output::{Compression, Shown, encode};

fn pixels(states: &[&str], change: impl FnOnce(&mut [u8])) -> Pixels {
    let mut bytes = vec![100; 40 * 30 * 3];
    change(&mut bytes);
    let tags = Tags {
        shows: Shown::Frame { frame: 3, time: 0.05 },
        scenes: vec!["s".into()],
        states: states.iter().enumerate().map(|(at, state)| ((*state).into(), format!("run {at}"))).collect(),
        version: "0".into(),
        adapter: "any".into(),
    };
    Pixels { size: [40, 30], bytes, on_black: None, label: Some(tags) }
}

fn told(expected: &Pixels, actual: &Pixels) -> (Verdict, String) {
    let (verdict, runs, distance, note) = compare(expected, actual);
    let tags = [&expected.label, &actual.label].map(Clone::clone);
    let (name, frame, sources) = ("a.png".to_owned(), None, [None, None]);
    (verdict, Compared { name, frame, verdict, runs, distance, note, tags, sources }.to_string())
}

#[test]
fn each_verdict_from_a_constructed_pair() {
    let golden = pixels(&["0", "1"], |_| ());
    assert_eq!(told(&golden, &golden), (Verdict::Identical, "identical".to_owned()));
    let dots = |count: usize| pixels(&["0", "1"], move |bytes| (0..count).for_each(|at| bytes[3 * 97 * at] = 0));
    let words = "within tolerance: 8 pixels differ by more than 16 of 255 (8 may), 8 by more than 2 (12 may), the mean of \
                 16×16 pixels by 1.2 (1.5 may)";
    assert_eq!(told(&golden, &dots(8)), (Verdict::WithinTolerance, words.to_owned()));
    let (verdict, words) = told(&golden, &dots(9));
    assert!(verdict == Verdict::DrawnDifferently && words.starts_with("drawn differently: 9 pixels"), "{words}");
    // Physics comes before drawing, even if all pixels are equal, and every run is named.
    let moved = |states: &[&str]| told(&golden, &pixels(states, |_| ()));
    assert_eq!(moved(&["0", "2"]), (Verdict::StateMoved, "state moved: run 1".to_owned()));
    assert_eq!(moved(&["2", "2"]), (Verdict::StateMoved, "state moved: run 0, run 1".to_owned()));
    assert_eq!(told(&golden, &pixels(&["2", "1"], |bytes| bytes.fill(0))).0, Verdict::StateMoved);
    // A run of only one picture is another state, too.
    assert_eq!(moved(&["0", "1", "2"]).1, "state moved: run 2");
    assert_eq!(told(&pixels(&["0", "1", "2"], |_| ()), &golden).1, "state moved: run 2");
    // Without a state pixels alone are compared.
    let untold = |pixels: Pixels| Pixels { label: None, ..pixels };
    assert_eq!(told(&golden, &untold(dots(0))), (Verdict::Identical, "identical (no state recorded)".to_owned()));
    assert_eq!(told(&untold(dots(0)), &dots(9)).0, Verdict::NoState);
    let wide = Pixels { size: [30, 40], ..golden.clone() };
    let words = "drawn differently: 30×40 pixels instead of 40×30";
    assert_eq!(told(&golden, &wide), (Verdict::DrawnDifferently, words.to_owned()));
}

#[test]
fn damage_is_reported_for_both_pictures() {
    let good = encode([29, 50], &[9; 29 * 50 * 3], &[], Compression::Small);
    let memory = |length: usize| Some(Source::Memory(good[..length].to_vec()));
    for (lengths, words) in [
        ([60, 70], &["the expected picture: ", "; the actual picture: "][..]),
        ([60, 60], &["the expected picture: ", "; the actual picture: "]),
        ([good.len(), good.len() - 1], &["the actual picture: "]),
    ] {
        let compared = Compared::read("two.png".to_owned(), lengths.map(memory));
        let note = compared.note.expect("it is damaged");
        assert!(compared.verdict == Verdict::Unreadable && words.iter().all(|word| note.contains(word)), "{note}");
    }
}
