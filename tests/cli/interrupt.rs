//! Signals: files are complete at any time of the interruption.
#![cfg(unix)]

use crate::cli::support::{Place, Ran, Running, lasting, run};
use libc::{SIGHUP, SIGINT, SIGTERM};
use std::ffi::c_int;
use std::process::Command;
use std::time::Duration;

/// A scene that would take very long.
fn place_for_long() -> Place {
    let place = Place::new();
    place.write("long.toml", &lasting("100000"));
    place
}

/// Starts the program with default signal handling, independent of this test's, and waits until a file exists.
pub(crate) fn start(place: &Place, arguments: &str, sign: &str) -> Running {
    start_ignoring(&[], place, arguments, sign)
}

/// As [`start`], with some signals ignored.
fn start_ignoring(ignored: &'static [c_int], place: &Place, arguments: &str, sign: &str) -> Running {
    let mut command = place.command(arguments.split(' '));
    set_signals(&mut command, ignored);
    let mut running = Running::start(&mut command);
    running.until(sign, |running| {
        // The file may have been written between the two questions.
        let has_ended = !running.is_running();
        let exists = place.path(sign).exists();
        assert!(exists || !has_ended, "{sign}: the command has ended without it");
        exists
    });
    running
}

/// Ignored signals are inherited by child processes, and no shell can undo that.
#[allow(unsafe_code, reason = "what signals do is set between fork and exec, and there is no safe way to")]
pub(crate) fn set_signals(command: &mut Command, ignored: &'static [c_int]) {
    use std::os::unix::process::CommandExt;
    let set = || {
        for signal in [SIGINT, SIGTERM, SIGHUP] {
            let action = if ignored.contains(&signal) { libc::SIG_IGN } else { libc::SIG_DFL };
            // SAFETY: these are not handlers, so no code of this process is called.
            unsafe { libc::signal(signal, action) };
        }
        Ok(())
    };
    // SAFETY: in the child, `signal` may be called; nothing is allocated or locked.
    unsafe { command.pre_exec(set) };
}

/// Sends signals by name, as fast as possible.
pub(crate) fn signal(running: &Running, names: &[&str]) {
    // The shell's built-in command, which always exists.
    let kill = |name: &&str| format!("kill -{name} {}", running.id());
    let line = names.iter().map(kill).collect::<Vec<_>>().join("; ");
    assert_eq!(run(Command::new("sh").args(["-c", &line])).status, Some(0), "{line}");
}

/// The names in a folder, except for the hidden files for the next command.
pub(crate) fn results(place: &Place, folder: &str) -> Vec<String> {
    place.names(folder).into_iter().filter(|name| !name.starts_with(".localshape-")).collect()
}

/// Checks that all files exist and record that the program was stopped.
#[track_caller]
fn is_whole(place: &Place, folder: &str, ran: &Ran) {
    assert!(ran.status == Some(130) && ran.out.contains("interrupted after"), "{ran:?}");
    assert_eq!(results(place, folder), ["diagnostics.csv", "run.json", "states.npz"]);
    let run = place.json(&format!("{folder}/run.json"));
    assert_eq!(run["outcome"], "interrupted");
    let rows = place.read(&format!("{folder}/diagnostics.csv")).lines().count() as u64;
    assert_eq!(rows, 1 + 2 * run["frames"]["recorded"].as_u64().unwrap());
}

#[test]
fn interrupted_and_terminated() {
    let place = place_for_long();
    for name in ["INT", "TERM", "HUP"] {
        let folder = format!("out-{name}");
        let running = start(&place, &format!("simulate long.toml --states -o {folder}"), &format!("{folder}/run.json"));
        signal(&running, &[name]);
        is_whole(&place, &folder, &running.wait());
    }
}

/// `timeout` sends its signal to the program and to its process group.
#[test]
fn the_same_request_twice_loses_nothing() {
    let place = place_for_long();
    for name in ["INT", "TERM", "HUP"] {
        for number in 0..4 {
            let folder = format!("out-{name}-{number}");
            let arguments = format!("simulate long.toml --states -o {folder}");
            let running = start(&place, &arguments, &format!("{folder}/run.json"));
            signal(&running, &[name, name]);
            is_whole(&place, &folder, &running.wait());
        }
    }
}

/// Like `nohup`, and like the background of a script.
#[test]
fn what_is_ignored_stays_ignored_and_the_rest_is_heard() {
    let place = place_for_long();
    let arguments = "simulate long.toml --states -o out";
    let mut running = start_ignoring(&[SIGINT, SIGHUP], &place, arguments, "out/run.json");
    signal(&running, &["INT", "HUP"]);
    // Without `nohup` it would have stopped by now.
    std::thread::sleep(Duration::from_millis(200));
    assert!(running.is_running());
    assert_eq!(place.json("out/run.json")["outcome"], "unfinished");
    signal(&running, &["TERM", "TERM"]);
    is_whole(&place, "out", &running.wait());
}

/// Even if it does not end after several signals, finished files are kept.
#[test]
fn a_later_ctrl_c_ends_at_once() {
    use std::io::Write;
    let place = place_for_long();
    // Nobody reads from the full pipe, so the program blocks before it ends.
    let (reader, mut writer) = std::io::pipe().unwrap();
    let out = writer.try_clone().unwrap();
    std::thread::spawn(move || while writer.write_all(&[b' '; 4096]).is_ok() {});
    let mut command = place.command(["simulate", "long.toml", "-o", "out"]);
    set_signals(&mut command, &[]);
    let mut running = Running::start_into(&mut command, out);
    running.until("run.json", |_| place.path("out/run.json").exists());
    signal(&running, &["INT"]);
    running.until("the end of the simulation", |_| place.json("out/run.json")["outcome"] == "interrupted");
    std::thread::sleep(Duration::from_millis(1100));
    signal(&running, &["TERM", "HUP"]);
    std::thread::sleep(Duration::from_millis(200));
    assert!(running.is_running(), "other programs only ask");
    signal(&running, &["INT"]);
    assert_eq!(running.wait().status, Some(130));
    assert_eq!(results(&place, "out"), ["diagnostics.csv", "run.json"]);
    drop(reader);
}

#[test]
fn later_scenes_are_not_begun() {
    let place = place_for_long();
    place.write("small.toml", crate::cli::support::SMALL);
    let running = start(&place, "simulate long.toml small.toml --json -o out", "out/long/run.json");
    signal(&running, &["INT"]);
    let ran = running.wait();
    assert_eq!(ran.status, Some(130));
    assert_eq!(ran.json()["scenes"].as_array().unwrap().len(), 1);
    assert_eq!(place.names("out"), ["long"]);
}

/// A killed program leaves hidden files, which the next one removes.
#[test]
fn killed() {
    let place = place_for_long();
    let mut running = start(&place, "simulate long.toml", "output/long/run.json");
    // The summary is written before the diagnostics; the test waits until a part of these is on disk.
    running.until("diagnostics", |_| place.names("output/long").len() == 2);
    running.kill();
    let names = place.names("output/long");
    assert!(names.len() == 2 && names[0].starts_with(".localshape-") && names[1] == "run.json", "{names:?}");
    assert_eq!(place.json("output/long/run.json")["outcome"], "unfinished");

    place.run("simulate long.toml --frames 0-2").good();
    assert_eq!(place.names("output/long"), ["diagnostics.csv", "run.json"]);
}

/// Drawing a frame that takes very long is interrupted.
#[test]
fn within_a_frame() {
    let place = Place::new();
    let one_long_frame = lasting("1e6").replace("frames_per_second = 60", "frames_per_second = 1e-6");
    place.write("long.toml", &one_long_frame);
    let running = start(&place, "simulate long.toml --frames 1", "output/long/run.json");
    signal(&running, &["INT"]);
    assert_eq!(running.wait().status, Some(130));
    assert_eq!(results(&place, "output/long"), ["diagnostics.csv", "run.json"]);
    let run = place.json("output/long/run.json");
    assert_eq!((&run["outcome"], run["frames"]["recorded"].as_u64()), (&"interrupted".into(), Some(0)));
}
