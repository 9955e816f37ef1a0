//! A full disk: one message, no partial files, and finished files are kept.
#![cfg(target_os = "linux")]

use crate::cli::support::{Place, Ran, lasting, run};
use localshape::internals::skipped;
use std::process::Command;

/// Runs the program with its output in `out`, on a temporary disk of `size`, and then `after` in a shell. `None` if
/// this machine does not permit it.
fn on_small_disk(place: &Place, size: &str, arguments: &str, after: &str) -> Option<Ran> {
    std::fs::create_dir_all(place.path("out")).unwrap();
    let program = env!("CARGO_BIN_EXE_localshape");
    let script = format!(
        "mount -t tmpfs -o size={size} none out || exit 99; '{program}' {arguments}; status=$?; {after}; exit $status"
    );
    let mut command = Command::new("unshare");
    command.args(["--user", "--map-root-user", "--mount", "sh", "-c", &script]).current_dir(place.path("."));
    if run(Command::new("sh").args(["-c", "unshare --version"])).status != Some(0) {
        skipped("there is no unshare");
        return None;
    }
    let mut ran = run(&mut command);
    // A slow machine writes a checkpoint before.
    ran.err = ran.err.split_inclusive('\n').filter(|line| !line.starts_with("warning: no checkpoint")).collect();
    if ran.status == Some(99) || ran.err.starts_with("unshare:") {
        skipped(&format!("no disk could be made for the test: {}", ran.err));
        return None;
    }
    Some(ran)
}

#[test]
fn simulate_on_a_full_disk() {
    let place = Place::new();
    place.write("long.toml", &lasting("10"));
    let after = "ls -A out | grep -v localshape-checkpoint; tail -n 1 out/diagnostics.csv; grep outcome out/run.json";
    let Some(ran) = on_small_disk(&place, "64k", "simulate long.toml -o out", after) else { return };
    let ran = ran.bad(4, &["cannot write out/diagnostics.csv", "disk is full"]);
    let lines: Vec<_> = ran.out.lines().collect();
    assert_eq!(lines[..2], ["diagnostics.csv", "run.json"], "{ran:?}");
    assert!(lines[2].starts_with("Mass-spring,") && lines[2].ends_with(",ok"), "whole rows of whole frames: {ran:?}");
    // The final summary may not fit; then the initial one remains.
    assert!(["\"outcome\": \"failed\",", "\"outcome\": \"unfinished\","].contains(&lines[3].trim()), "{ran:?}");
}

/// The system ends programs that exceed such a limit, unless they handle its signal.
#[test]
fn a_limit_on_the_size_of_files_is_told() {
    let place = Place::new();
    place.write("long.toml", &lasting("20"));
    let script = format!("ulimit -f 16; exec '{}' simulate long.toml -o out", env!("CARGO_BIN_EXE_localshape"));
    let ran = run(Command::new("sh").args(["-c", &script]).current_dir(place.path(".")));
    ran.bad(4, &["cannot write out/diagnostics.csv: it is larger than the system permits (`ulimit -f`)"]);
    assert_eq!(place.json("out/run.json")["outcome"], "failed");
    assert!(place.read("out/diagnostics.csv").ends_with(",ok\n"), "whole rows of whole frames");
    place.run("simulate long.toml -o out --resume").good();
}

#[test]
fn states_on_a_full_disk() {
    let place = Place::new();
    // More nodes, so that states take most of the room.
    place.write("long.toml", &lasting("10").replace("cells = [2, 1, 1]", "cells = [3, 3, 3]"));
    let after = "ls -A out | grep -v -e localshape-checkpoint -e localshape-states";
    let Some(ran) = on_small_disk(&place, "400k", "simulate long.toml -o out --states", after) else { return };
    let ran = ran.bad(4, &["cannot write out/states.npz", "disk is full"]);
    assert_eq!(ran.out.lines().collect::<Vec<_>>(), ["diagnostics.csv", "run.json"]);
}

/// With enough room again, the same command continues.
#[test]
fn after_a_full_disk_it_goes_on() {
    let place = Place::new();
    place.write("long.toml", &lasting("20"));
    place.run("simulate long.toml -o whole --states").good();
    let program = env!("CARGO_BIN_EXE_localshape");
    let after = format!(
        "mount -o remount,size=64m none out && '{program}' simulate long.toml -o out --states --resume -q && \
         cmp out/diagnostics.csv whole/diagnostics.csv && cmp out/states.npz whole/states.npz && ls -A out"
    );
    let Some(ran) = on_small_disk(&place, "300k", "simulate long.toml -o out --states", &after) else { return };
    assert_eq!(ran.status, Some(4), "{ran:?}");
    assert_eq!(ran.out.lines().collect::<Vec<_>>(), ["diagnostics.csv", "run.json", "states.npz"], "{ran:?}");
}

#[cfg(feature = "render")]
#[test]
fn frames_on_a_full_disk() {
    let place = Place::new();
    place.write("long.toml", &lasting("10"));
    let after = "ls -A out | grep -v localshape-checkpoint";
    let Some(ran) = on_small_disk(&place, "300k", "render long.toml -o out --size 320x240 --quiet", after) else {
        return;
    };
    if ran.status == Some(3) {
        return skipped("no graphics adapter");
    }
    let ran = ran.bad(4, &["cannot write out/", "disk is full"]);
    assert!(!ran.err.contains(".localshape-"), "no hidden names: {}", ran.err);
    assert!(ran.out.lines().all(|name| !name.starts_with('.')), "{ran:?}");
    assert!(ran.out.contains("frame_00000.png") && ran.out.contains("run.json"), "{ran:?}");
}

#[cfg(feature = "render")]
#[test]
fn animations_on_a_full_disk() {
    use crate::cli::support::{frame_file, frame_tags};
    let place = Place::new();
    for number in 0..4 {
        // Noise is incompressible.
        let noise = (0..3 * 320 * 240_u32).map(|at| {
            let mixed = (at + number * 1_000_003).wrapping_mul(0x9e37_79b9);
            ((mixed ^ mixed >> 15).wrapping_mul(0x85eb_ca6b) >> 24) as u8
        });
        let tags = frame_tags(number.into(), f64::from(number) / 30.0);
        let name = format!("in/frame_{number:05}.png");
        place.write(&name, "");
        std::fs::write(place.path(name), frame_file([320, 240], &noise.collect::<Vec<_>>(), &tags)).unwrap();
    }
    for name in ["a.gif", "a.apng"] {
        let arguments = format!("animate in -o out/{name}");
        let Some(ran) = on_small_disk(&place, "64k", &arguments, "ls -A out") else { return };
        let ran = ran.bad(4, &[&format!("cannot write out/{name}"), "disk is full", "this file is removed"]);
        assert_eq!(ran.out, "", "{name}: nothing is left");
    }
}
