//! Signals: whole files only, whenever the program is stopped.
#![cfg(unix)]

use crate::support::{Place, lasting};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A scene that would take very long.
fn place_for_long() -> Place {
    let place = Place::new();
    place.write("long.toml", &lasting("100000"));
    place
}

/// Starts the program, and waits until a file is there.
pub(crate) fn start(place: &Place, arguments: &str, sign: &str) -> Child {
    let mut command = place.command(arguments.split(' '));
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
    let started = Instant::now();
    while !place.path(sign).exists() {
        assert!(started.elapsed() < Duration::from_secs(60), "{sign} does not appear");
        std::thread::sleep(Duration::from_millis(5));
    }
    child
}

pub(crate) fn signal(child: &Child, name: &str) {
    // The shell's own, which is everywhere.
    let line = format!("kill -{name} {}", child.id());
    let sent = Command::new("sh").args(["-c", &line]).status().expect("a shell");
    assert!(sent.success());
}

#[test]
fn interrupted_and_terminated() {
    let place = place_for_long();
    for name in ["INT", "TERM"] {
        let folder = format!("out-{name}");
        let child = start(&place, &format!("simulate long.toml --states -o {folder}"), &format!("{folder}/run.json"));
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130));
        assert!(String::from_utf8_lossy(&output.stdout).contains("interrupted after"), "{output:?}");

        assert_eq!(place.names(&folder), ["diagnostics.csv", "run.json", "states.npz"]);
        let run = place.json(&format!("{folder}/run.json"));
        assert_eq!(run["outcome"], "interrupted");
        let rows = place.read(&format!("{folder}/diagnostics.csv")).lines().count() as u64;
        assert_eq!(rows, 1 + 2 * run["frames"]["recorded"].as_u64().unwrap());
    }
}

#[test]
fn later_scenes_are_not_begun() {
    let place = place_for_long();
    place.write("small.toml", crate::support::SMALL);
    let child = start(&place, "simulate long.toml small.toml --json -o out", "out/long/run.json");
    signal(&child, "INT");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one document");
    assert_eq!(document["scenes"].as_array().unwrap().len(), 1);
    assert_eq!(place.names("out"), ["long"]);
}

/// A killed program leaves hidden files, which the next one removes.
#[test]
fn killed() {
    let place = place_for_long();
    let mut child = start(&place, "simulate long.toml", "output/long/run.json");
    // The summary is there before the diagnostics are begun; the first of these must have been written out.
    std::thread::sleep(Duration::from_millis(100));
    child.kill().unwrap();
    child.wait().unwrap();
    let names = place.names("output/long");
    assert!(names.len() == 2 && names[0].starts_with(".localshape-") && names[1] == "run.json", "{names:?}");
    assert_eq!(place.json("output/long/run.json")["outcome"], "unfinished");

    place.run("simulate long.toml --frames 0-2").good();
    assert_eq!(place.names("output/long"), ["diagnostics.csv", "run.json"]);
}

/// A frame that takes very long is given up.
#[test]
fn within_a_frame() {
    let place = Place::new();
    let one_long_frame = lasting("1e6").replace("frames_per_second = 60", "frames_per_second = 1e-6");
    place.write("long.toml", &one_long_frame);
    let child = start(&place, "simulate long.toml --frames 1", "output/long/run.json");
    signal(&child, "INT");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    assert_eq!(place.names("output/long"), ["diagnostics.csv", "run.json"]);
    let run = place.json("output/long/run.json");
    assert_eq!((&run["outcome"], run["frames"]["recorded"].as_u64()), (&"interrupted".into(), Some(0)));
}
