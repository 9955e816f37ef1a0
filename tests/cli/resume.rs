//! `--resume`: completes the results of an interrupted command, with the bytes of an uninterrupted one.
#![cfg(unix)]

use crate::cli::interrupt::{results, signal, start};
#[cfg(feature = "render")]
use crate::cli::support::disc;
use crate::cli::support::{Place, Ran, Running, lasting};
use std::collections::BTreeMap;

const CHECKPOINT: &str = ".localshape-checkpoint.partial";

/// All results in a folder but `run.json`, which has times.
fn files(place: &Place, folder: &str) -> BTreeMap<String, Vec<u8>> {
    let names = results(place, folder).into_iter().filter(|name| name != "run.json");
    names.map(|name| (name.clone(), std::fs::read(place.path(folder).join(name)).unwrap())).collect()
}

/// The steps of the first run, with those before interruptions.
fn steps(place: &Place, folder: &str) -> u64 {
    place.json(&format!("{folder}/run.json"))["runs"][0]["steps"].as_u64().unwrap()
}

/// What `run.json` tells of the runs.
fn told(place: &Place, folder: &str) -> serde_json::Value {
    place.json(&format!("{folder}/run.json"))["runs"].clone()
}

/// Starts a command that makes a folder, and ends it by a signal after a while, but not before a file exists.
fn stopped(place: &Place, arguments: &str, sign: &str, name: &str) -> Ran {
    let running = start(place, arguments, sign);
    signal(&running, &[name]);
    running.wait()
}

/// Starts the command of a folder `out` again and waits until it simulates.
fn again(place: &Place, arguments: &str) -> Running {
    let mut running = start(place, arguments, "out/run.json");
    let is_new =
        |run: &serde_json::Value| run["command"].as_array().and_then(|words| words.last()) == Some(&"--resume".into());
    running.until("its summary", |_| is_new(&place.json("out/run.json")));
    running
}

/// A scene that takes some seconds on one thread, so that a killed command leaves a checkpoint: these are written every two seconds. It has few
/// frames, whose states are small.
fn seconds() -> String {
    lasting("20").replace("cells = [2, 1, 1]", "cells = [4, 4, 4]").replace("T/50", "T/5000")
}

#[test]
fn after_ctrl_c_it_goes_on_from_there() {
    let place = Place::new();
    place.write("scene.toml", &lasting("60"));
    place.run("simulate scene.toml --states -o whole").good();
    let typed = "simulate scene.toml --states -o out";
    let ran = stopped(&place, typed, "out/run.json", "INT");
    let how = "to go on: ".to_owned() + &place.shown("simulate --resume scene.toml --states -o out");
    assert!(ran.status == Some(130) && ran.out.lines().any(|line| line == how), "{how}: {ran:?}");
    let line = ran.out.lines().find(|line| line.starts_with("interrupted after ")).expect("where it stopped");
    assert!(line.contains(" of 3601 frames simulated in out, simulated to ") && line.ends_with(" s of 60 s"), "{line}");
    assert!(place.path("out").join(CHECKPOINT).exists());
    let ran = place.run("simulate scene.toml -o out --resume");
    ran.bad(2, &["to go on from it, type that command with --resume: ", "simulate scene.toml --states -o out"]);
    let before = steps(&place, "out");
    // A second interruption, on the way.
    let typed = format!("{typed} --resume");
    let running = again(&place, &typed);
    signal(&running, &["TERM"]);
    let ran = running.wait();
    assert!([Some(130), Some(0)].contains(&ran.status), "{ran:?}");
    assert!(steps(&place, "out") >= before);
    if ran.status == Some(130) {
        place.run(&typed).good();
    }
    assert_eq!(told(&place, "out"), told(&place, "whole"), "all steps and all extremes");
    assert!(files(&place, "out") == files(&place, "whole"));
    assert_eq!(place.names("out"), ["diagnostics.csv", "run.json", "states.npz"], "nothing else is left");
}

/// Findings before an interruption are neither simulated again nor forgotten.
#[test]
fn causes_of_divergences_are_kept() {
    let place = Place::new();
    let scene = seconds().replace("one-diagonal\" }", "one-diagonal\" }\nstep = \"T/2\"");
    place.write("scene.toml", &scene);
    let typed = "simulate scene.toml --threads 1 -q -o out";
    stopped(&place, typed, &format!("out/{CHECKPOINT}"), "KILL");
    place.run(&format!("{typed} --resume")).good();
    let run = place.json("out/run.json")["runs"][1].clone();
    assert_eq!(run["status"], "diverged");
    assert!(run["cause"].is_string() && run["node"].is_u64(), "{run}");
}

#[test]
fn after_a_kill_it_goes_on_from_the_last_checkpoint() {
    let place = Place::new();
    place.write("scene.toml", &seconds());
    let typed = "simulate scene.toml --threads 1 --states -o out";
    let ran = stopped(&place, typed, &format!("out/{CHECKPOINT}"), "KILL");
    assert_eq!(ran.status, None, "killed");
    assert_eq!(place.json("out/run.json")["outcome"], "unfinished");
    // The lock has gone with its process; a running process holds it.
    let running = again(&place, &format!("{typed} --resume"));
    place.run(&format!("{typed} --resume")).bad(2, &["out is in use: another process is writing there"]);
    running.wait().good();
    place.run("simulate scene.toml --states -o whole").good();
    assert_eq!(told(&place, "out"), told(&place, "whole"));
    assert!(files(&place, "out") == files(&place, "whole"));
    assert_eq!(place.names("out"), ["diagnostics.csv", "run.json", "states.npz"], "nothing else is left");
}

/// With and without charts and cameras that follow, which wait for the end of the simulation.
#[cfg(feature = "render")]
#[test]
fn pictures_go_on_too() {
    if !crate::cli::render::can_draw() {
        return;
    }
    let place = Place::new();
    // Steps so small that the simulation takes a second after the frame that is waited for.
    let still = lasting("6").replace("T/50", "T/10000");
    let follows = crate::cli::support::SMALL.replace("duration = 0.1", "duration = 600");
    for (name, scene, sign, frames) in
        [("still", still, "frame_00020.png", "0-360x20"), ("follows", follows, "run.json", "0-36000x2000")]
    {
        place.write(&format!("{name}.toml"), &scene);
        let typed = format!("render {name}.toml --frames {frames} --states -o {name}");
        let ran = stopped(&place, &typed, &format!("{name}/{sign}"), "INT");
        assert!(ran.status == Some(130) && ran.out.contains("to go on: "), "{ran:?}");
        assert!(place.path(name).join(CHECKPOINT).exists(), "{name}");
        let kept = place.names(name).iter().filter(|name| name.ends_with(".png")).count() as u64;
        let ran = place.run(&format!("{typed} --resume")).good();
        assert!(ran.out.contains("19 frames of 96×64"), "{ran:?}");
        assert_eq!(crate::cli::parts::drawn_and_kept(&place, name), [19 - kept, kept], "{name}");
        place.run(&format!("render {name}.toml --frames {frames} --states -o whole --overwrite")).good();
        assert_eq!(told(&place, name), told(&place, "whole"), "{name}");
        assert!(files(&place, name) == files(&place, "whole"), "{name}");
        assert!(place.names(name).iter().all(|name| !name.starts_with('.')), "nothing else is left");
    }
}

#[test]
fn a_checkpoint_of_something_else_is_refused() {
    let place = Place::new();
    place.write("scene.toml", &lasting("100000"));
    stopped(&place, "simulate scene.toml", "output/scene/run.json", "INT");
    let all = |folder: &str| {
        place
            .names(folder)
            .into_iter()
            .map(|name| std::fs::read(place.path(folder).join(name)).unwrap())
            .collect::<Vec<_>>()
    };
    let before = all("output/scene");
    let refused = |options: &str, words: &[&str]| {
        let ran = place.run(&format!("simulate scene.toml --resume{options}"));
        ran.bad(2, &[&["the checkpoint in output/scene ", "to begin anew, leave out --resume"], words].concat());
        assert!(all("output/scene") == before, "nothing is lost");
    };
    refused(
        " --only Mass-spring --overwrite",
        &[
            "belongs to a command with other frames, runs, states, files or size; to go on from it, type that command with --resume: ",
            "simulate scene.toml;",
        ],
    );
    refused(" --frames 0-3", &["belongs to a command with other frames"]);
    refused(" --states", &["belongs to a command with other frames, runs, states"]);
    place.write("scene.toml", &lasting("100001"));
    refused("", &["belongs to another version of “Two cubes”; expected “Two cubes” as it is now"]);
    place.write("scene.toml", &lasting("100000"));
    let path = place.path("output/scene").join(CHECKPOINT);
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
    let ran = place.run("simulate scene.toml --resume");
    ran.bad(2, &["the checkpoint in output/scene is damaged or cut short (.localshape-checkpoint.partial); to begin anew, leave out --resume"]);
    std::fs::write(&path, &bytes).unwrap();
    std::fs::write(place.path("output/scene/diagnostics.csv"), "run,frame\n").unwrap();
    let ran = place.run("simulate scene.toml --resume");
    ran.bad(2, &["the checkpoint in output/scene cannot be used (", "diagnostics.csv", "leave out --resume"]);
    assert_eq!(std::fs::read(&path).unwrap(), bytes, "it stays");
    let ran = place.run("simulate scene.toml --frames 0-1 -o output/scene");
    ran.bad(2, &["output/scene holds the checkpoint of an interrupted command, from which --resume", "--overwrite"]);
    assert_eq!(std::fs::read(&path).unwrap(), bytes, "it stays");
    let ran = place.run("simulate scene.toml --frames 0-1").good();
    assert!(ran.out.starts_with("output/scene: replacing the checkpoint of an interrupted command"), "{ran:?}");
    assert_eq!(place.names("output/scene"), ["diagnostics.csv", "run.json"], "another command begins anew");
}

/// A frame that was removed later cannot be drawn from a later state. All files stay until the user decides.
#[cfg(feature = "render")]
#[test]
fn without_its_frames_a_checkpoint_is_refused() {
    if !crate::cli::render::can_draw() {
        return;
    }
    let place = Place::new();
    place.write("scene.toml", &lasting("5"));
    stopped(&place, "render scene.toml -o out", "out/frame_00003.png", "INT");
    let (frame, other) = (place.path("out/frame_00002.png"), place.path("out/frame_00001.png"));
    let bytes = std::fs::read(&frame).unwrap();
    std::fs::remove_file(&frame).unwrap();
    let before = files(&place, "out");
    let refused = |words: &[&str]| {
        place.run("render scene.toml -o out --resume").bad(2, words);
        assert!(place.path("out").join(CHECKPOINT).exists());
    };
    let way_out = "; to begin anew, leave out --resume and add --overwrite";
    refused(&["the checkpoint in out counts on frame_00002.png, which is missing; restore it", way_out]);
    assert!(files(&place, "out") == before, "nothing is lost");
    std::fs::copy(&other, &frame).unwrap();
    refused(&[
        "the checkpoint in out counts on frame_00002.png, which is damaged or has been replaced since; restore it",
        way_out,
    ]);
    let (size, tags) = localshape::internals::read_tags(&other).unwrap().expect("a frame of ours");
    let drawn = std::fs::read(&other).unwrap();
    let tags = localshape::internals::Tags { adapter: "Another one".to_owned(), ..tags };
    let pixels = vec![0; size[0] as usize * size[1] as usize * 3];
    std::fs::write(&other, crate::cli::support::frame_file(size, &pixels, &tags)).unwrap();
    refused(&["frame_00001.png, which Another one has drawn, and this is ", "; choose that with --adapter", way_out]);
    std::fs::write(&other, drawn).unwrap();
    std::fs::write(&frame, &bytes).unwrap();
    place.run("render scene.toml -o out --resume").good();
    place.run("render scene.toml -o whole").good();
    assert!(files(&place, "out") == files(&place, "whole"));
}

/// Flips bits all over the first bytes of a hidden file, one at a time. A command is to refuse each by the name of the file.
fn flip(place: &Place, name: &str, length: usize, command: &str) {
    const PLACES: usize = 24;
    let path = place.path("out").join(name);
    let bytes = std::fs::read(&path).unwrap();
    assert!(length >= PLACES && length <= bytes.len(), "{name}: {length} of {} bytes", bytes.len());
    for number in 0..PLACES {
        let mut damaged = bytes.clone();
        damaged[number * (length - 1) / (PLACES - 1)] ^= 1 << (number % 8);
        std::fs::write(&path, &damaged).unwrap();
        let ran = place.run(command);
        // The digits of a checkpoint's version say that another version has written it.
        let is_version = ran.err.contains("was written by another version");
        let words = if is_version { "the checkpoint in out" } else { name };
        ran.bad(2, &["the checkpoint in out ", words, "leave out --resume"]);
        assert!(std::fs::read(&path).unwrap() == damaged, "nothing is lost");
    }
    std::fs::write(&path, bytes).unwrap();
}

#[test]
fn damage_to_what_waits_is_refused() {
    let place = Place::new();
    place.write("scene.toml", &seconds());
    let typed = "simulate scene.toml --threads 1 --states -q -o out";
    place.run("simulate scene.toml --states -q -o whole").good();
    stopped(&place, typed, &format!("out/{CHECKPOINT}"), "KILL");
    for (name, parts) in [(CHECKPOINT, 1), (".localshape-diagnostics.partial", 2), (".localshape-states.partial", 2)] {
        // Rows and states after the checkpoint are not used.
        let length = std::fs::metadata(place.path("out").join(name)).unwrap().len() as usize / parts;
        flip(&place, name, length, &format!("{typed} --resume"));
    }
    place.run(&format!("{typed} --resume")).good();
    assert!(files(&place, "out") == files(&place, "whole"), "restored, they are used");
}

#[cfg(feature = "render")]
#[test]
fn damage_to_states_that_wait_to_be_drawn_is_refused() {
    let place = Place::new();
    place.write("scene.toml", &disc("2000").replace(", every = 0.004", ""));
    let typed = "render scene.toml --frames 0-120000x10000 -q -o out";
    let name = ".localshape-frames.partial";
    let length = || std::fs::metadata(place.path("out").join(name)).map_or(0, |found| found.len() as usize);
    let mut running = start(&place, typed, "out/run.json");
    running.until("states that wait", |_| length() > 1000);
    signal(&running, &["INT"]);
    assert_eq!(running.wait().status, Some(130));
    flip(&place, name, length(), &format!("{typed} --resume"));
    place.run(&format!("{typed} --resume")).good();
    place.run(&typed.replace("out", "whole")).good();
    assert!(files(&place, "out") == files(&place, "whole"), "restored, they are used");
}

/// The animation has the same bytes, with frames that are kept and with frames that are not.
#[cfg(feature = "render")]
#[test]
fn animations_go_on_too() {
    let (whole, place) = (Place::new(), Place::new());
    let scene = disc("60").replace("charts", "camera.distance = 1\nlabels");
    let scene = scene.replace("[\"kinetic\"]", "[\"clock\"]");
    [&whole, &place].into_iter().for_each(|place| place.write("scene.toml", &scene));
    let films = "--animate film.gif --animate film.apng --frames 0-1200x12";
    for (options, folder) in [("", "out"), (" --no-frames", "out/.localshape-pictures.partial")] {
        let typed = format!("render scene.toml {films}{options} -o out");
        whole.run(&format!("{typed} --overwrite")).good();
        let ran = stopped(&place, &typed, &format!("{folder}/frame_00036.png"), "INT");
        assert!(ran.status == Some(130) && ran.out.contains("to go on: "), "{ran:?}");
        assert!(place.path("out").join(CHECKPOINT).exists());
        // One wrong bit among the pixels of a frame that is kept.
        let kept = place.path(format!("{folder}/frame_00012.png"));
        let bytes = std::fs::read(&kept).unwrap();
        let mut damaged = bytes.clone();
        damaged[bytes.len() - 40] ^= 4;
        std::fs::write(&kept, damaged).unwrap();
        let words = "the checkpoint in out counts on frame_00012.png, which is damaged or has been replaced since";
        place.run(&format!("{typed} --resume")).bad(2, &[words]);
        std::fs::write(&kept, bytes).unwrap();
        place.run(&format!("{typed} --resume")).good();
        // The command differs by more than `--resume`.
        whole.run(&typed).good();
        for film in ["film.gif", "film.apng"] {
            let [one, other] = [&whole, &place].map(|place| std::fs::read(place.path(film)).unwrap());
            assert!(one == other, "{film}{options}");
        }
        assert!(files(&place, "out") == files(&whole, "out"), "{options}");
        assert!(place.names("out").iter().all(|name| !name.starts_with('.')), "{:?}", place.names("out"));
        [&whole, &place].into_iter().for_each(|place| std::fs::remove_dir_all(place.path("out")).unwrap());
    }
}

/// A killed command leaves an unfinished animation beside the one that it makes.
#[cfg(feature = "render")]
#[test]
fn what_is_left_of_an_animation_goes() {
    let place = Place::new();
    place.write("scene.toml", &disc("0.1"));
    for options in ["", " --resume", " --no-frames --overwrite"] {
        place.write(".localshape-film.gif-Ab12Cd.partial", "GIF89a");
        place.run(&format!("render scene.toml --animate film.gif -o out{options}")).good();
        assert_eq!(place.names("."), ["film.gif", "out", "scene.toml"], "{options}");
    }
}

/// Rows between frames and extremes are those of a whole command, whether states wait to be drawn or not.
#[test]
fn rows_between_frames_go_on() {
    let place = Place::new();
    place.write("scene.toml", &lasting("60").replace("frames_per_second = 60", "frames_per_second = 6\nevery = 0.003"));
    place.run("simulate scene.toml -q -o whole").good();
    let ran = stopped(&place, "simulate scene.toml -o out", "out/run.json", "INT");
    assert_eq!(ran.status, Some(130), "{ran:?}");
    place.run("simulate scene.toml -o out --resume").good();
    assert!(files(&place, "out") == files(&place, "whole"));
    assert_eq!(told(&place, "out"), told(&place, "whole"));
    let between = place.read("whole/diagnostics.csv").lines().filter(|line| line.contains(",all,,")).count();
    // 60 s have 20 001 rows for each run, at most 361 of them of frames.
    assert!((2 * (20_001 - 361)..2 * 20_001).contains(&between), "{between}");
}
