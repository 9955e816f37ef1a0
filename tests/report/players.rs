//! Animations in the browser's own players: their first and last pictures.

use super::browser::Browser;
use localshape::internals::{Compression, Shown, Tags, encode};
use serde_json::json;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const SIZE: [u32; 2] = [64, 48];
const COUNT: u64 = 12;
const INK: [u8; 3] = [200, 60, 30];
const GROUND: [u8; 3] = [230, 236, 240];
/// The places of the square in the first frame only, and in the last frame only.
const PLACES: [[f64; 2]; 2] = [[8.0, 24.0], [52.0, 24.0]];
/// The colours at these places.
const FIRST: [[u8; 3]; 2] = [INK, GROUND];
const LAST: [[u8; 3]; 2] = [GROUND, INK];
/// Films blur colours, and a GIF has few of them.
const NEAR: u8 = 16;
/// The time limit for an animation to show a picture, on a slow and busy machine.
const PATIENCE: Duration = Duration::from_secs(30);

/// Frames of a square that moves from left to right, thirty per second.
fn put_frames(folder: &Path) {
    std::fs::create_dir(folder).expect("a folder");
    for number in 0..COUNT {
        let is_ink = |x: u32, y: u32| (x as u64).wrapping_sub(4 * number) < 16 && (16..32).contains(&y);
        let places = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
        let pixels: Vec<u8> = places.flat_map(|(x, y)| if is_ink(x, y) { INK } else { GROUND }).collect();
        let tags = Tags {
            shows: Shown::Frame { frame: number, time: number as f64 / 30.0 },
            scenes: vec!["5c".repeat(32)],
            states: vec![("ab".repeat(32), "Local shape".to_owned())],
            version: String::new(),
            adapter: String::new(),
        };
        let file = encode(SIZE, &pixels, &tags.texts(), Compression::Fast);
        std::fs::write(folder.join(format!("frame_{number:05}.png")), file).expect("a frame");
    }
}

fn animate(folder: &Path, file: &str, arguments: &[&str]) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_localshape"));
    command.current_dir(folder).args(["animate", "in", "-q", "-o", file]).args(arguments).stdin(Stdio::null());
    let output = command.output().expect("the program starts");
    assert!(output.status.success(), "{file}: {}", String::from_utf8_lossy(&output.stderr));
}

/// Waits until the frame is seen.
fn is_shown(browser: &mut Browser, what: &str, expected: [[u8; 3]; 2]) {
    let start = Instant::now();
    loop {
        let seen = browser.colours(PLACES);
        let near = |(one, other): (&u8, &u8)| one.abs_diff(*other) <= NEAR;
        if seen.as_flattened().iter().zip(expected.as_flattened()).all(near) {
            return;
        }
        assert!(start.elapsed() < PATIENCE, "{what}: expected {expected:?}, seen {seen:?}");
        std::thread::sleep(Duration::from_millis(25));
    }
}

fn page(element: &str) -> String {
    format!("<!doctype html><body style=\"margin: 0; background: #777\">{element}")
}

#[test]
fn first_and_last_frames_are_shown() {
    let Some(mut browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    put_frames(&folder.join("in"));
    let image = |file: &str| page(&format!("<img src=\"file://{}\">", folder.join(file).display()));
    for ending in ["gif", "apng"] {
        let file = &format!("slow.{ending}");
        // The first frame lasts half a minute.
        animate(folder, file, &["--speed", "0.001"]);
        browser.open(&image(file));
        is_shown(&mut browser, file, FIRST);
        let file = &format!("once.{ending}");
        animate(folder, file, &["--loop", "1"]);
        browser.open(&image(file));
        is_shown(&mut browser, file, LAST);
    }
    let has_ffmpeg = Command::new("ffmpeg").arg("-version").stdout(Stdio::null()).status().is_ok();
    if !has_ffmpeg {
        let missing = "there is no ffmpeg: `apt install ffmpeg`";
        assert!(std::env::var_os("LOCALSHAPE_REQUIRE_FFMPEG").is_none_or(|value| value != "1"), "{missing}");
        localshape::internals::skipped(missing);
        return;
    }
    for (file, kind) in [("film.webm", "video/webm; codecs=vp9"), ("film.mp4", "video/mp4; codecs=avc1.64001f")] {
        let can_play = format!("document.createElement('video').canPlayType({})", json!(kind));
        if browser.text(&can_play).is_empty() {
            localshape::internals::skipped(&format!("this Chromium does not play {kind}"));
            continue;
        }
        animate(folder, file, &[]);
        let address = folder.join(file);
        browser.open(&page(&format!("<video muted preload=auto src=\"file://{}\">", address.display())));
        const FILM: &str = "document.querySelector('video')";
        browser.until(file, &format!("{FILM}.readyState === 4"));
        let [seconds, width, height] =
            ["duration", "videoWidth", "videoHeight"].map(|name| browser.number(&format!("{FILM}.{name}")));
        assert!((seconds - 0.4).abs() < 0.01 && [width, height] == SIZE.map(f64::from), "{file}: {seconds} s");
        is_shown(&mut browser, file, FIRST);
        // It plays to its end and stays there.
        browser.value(&format!("{FILM}.play()"));
        browser.until(file, &format!("{FILM}.ended"));
        is_shown(&mut browser, file, LAST);
    }
}
