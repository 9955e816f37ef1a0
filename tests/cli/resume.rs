//! `--resume`: completes the results of an interrupted command, with the bytes of an uninterrupted one.
#![cfg(unix)]

use crate::interrupt::{results, signal, start};
use crate::support::{Place, Ran, Running, lasting};
use std::collections::BTreeMap;

const CHECKPOINT: &str = ".localshape-checkpoint.partial";

/// All results in a folder but `run.json`, which has times.
fn files(place: &Place, folder: &str) -> BTreeMap<String, Vec<u8>> {
    let names = results(place, folder).into_iter().filter(|name| name != "run.json");
    names.map(|name| (name.clone(), std::fs::read(place.path(folder).join(name)).unwrap())).collect()
}

/// The steps of the first run in the last command.
fn steps(place: &Place, folder: &str) -> u64 {
    place.json(&format!("{folder}/run.json"))["runs"][0]["steps"].as_u64().unwrap()
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

/// A scene that takes some seconds, so that a killed command leaves a checkpoint: these are written every two seconds.
fn seconds() -> String {
    lasting("1000").replace("cells = [2, 1, 1]", "cells = [4, 4, 4]")
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
    let between = steps(&place, "out");
    if ran.status == Some(130) {
        place.run(&typed).good();
        assert_eq!(before + between + steps(&place, "out"), steps(&place, "whole"), "no step is taken twice");
    }
    assert!(files(&place, "out") == files(&place, "whole"));
    assert_eq!(place.names("out"), ["diagnostics.csv", "run.json", "states.npz"], "nothing else is left");
}

/// Findings before an interruption are neither simulated again nor forgotten.
#[test]
fn causes_of_divergences_are_kept() {
    let place = Place::new();
    let scene = seconds().replace("one-diagonal\" }", "one-diagonal\" }\nstep = \"T/2\"");
    place.write("scene.toml", &scene);
    let typed = "simulate scene.toml -q -o out";
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
    let typed = "simulate scene.toml --states -o out";
    let ran = stopped(&place, typed, &format!("out/{CHECKPOINT}"), "KILL");
    assert_eq!(ran.status, None, "killed");
    assert_eq!(place.json("out/run.json")["outcome"], "unfinished");
    // The lock has gone with its process; a running process holds it.
    let running = again(&place, &format!("{typed} --resume"));
    place.run(&format!("{typed} --resume")).bad(2, &["out is in use: process ", "is writing there"]);
    running.wait().good();
    place.run("simulate scene.toml --states -o whole").good();
    assert!(steps(&place, "out") < steps(&place, "whole"), "it has not begun anew");
    assert!(files(&place, "out") == files(&place, "whole"));
    assert_eq!(place.names("out"), ["diagnostics.csv", "run.json", "states.npz"], "nothing else is left");
}

/// With and without charts and cameras that follow, which wait for the end of the simulation.
#[cfg(feature = "render")]
#[test]
fn pictures_go_on_too() {
    if !crate::render::can_draw() {
        return;
    }
    let place = Place::new();
    let (still, follows) = (lasting("6"), crate::support::SMALL.replace("duration = 0.1", "duration = 600"));
    for (name, scene, sign, frames) in
        [("still", still, "frame_00020.png", "0-360x20"), ("follows", follows, "run.json", "0-36000x2000")]
    {
        place.write(&format!("{name}.toml"), &scene);
        let typed = format!("render {name}.toml --frames {frames} --states -o {name}");
        let ran = stopped(&place, &typed, &format!("{name}/{sign}"), "INT");
        assert!(ran.status == Some(130) && ran.out.contains("to go on: "), "{ran:?}");
        assert!(place.path(name).join(CHECKPOINT).exists(), "{name}");
        let kept = place.names(name).iter().filter(|name| name.ends_with(".png")).count() as u64;
        let before = steps(&place, name);
        let ran = place.run(&format!("{typed} --resume")).good();
        assert!(ran.out.contains("19 frames of 96×64"), "{ran:?}");
        let (again, resumed) = (crate::parts::drawn_and_kept(&place, name), steps(&place, name));
        assert_eq!(again, [19 - kept, kept], "{name}");
        place.run(&format!("render {name}.toml --frames {frames} --states -o whole --overwrite")).good();
        assert_eq!(before + resumed, steps(&place, "whole"), "{name}: no step is taken twice");
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
    ran.bad(2, &["the checkpoint in output/scene is damaged or cut short; to begin anew, leave out --resume"]);
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
    if !crate::render::can_draw() {
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
    refused(&["the checkpoint in out counts on frame_00002.png, which has been replaced since; restore it", way_out]);
    let (size, tags) = localshape::internals::read_tags(&other).unwrap().expect("a frame of ours");
    let drawn = std::fs::read(&other).unwrap();
    let tags = localshape::internals::Tags { adapter: "Another one".to_owned(), ..tags };
    let pixels = vec![0; size[0] as usize * size[1] as usize * 3];
    std::fs::write(&other, crate::support::frame_file(size, &pixels, &tags)).unwrap();
    refused(&["frame_00001.png, which Another one has drawn, and this is ", "; choose that with --adapter", way_out]);
    std::fs::write(&other, drawn).unwrap();
    std::fs::write(&frame, &bytes).unwrap();
    place.run("render scene.toml -o out --resume").good();
    place.run("render scene.toml -o whole").good();
    assert!(files(&place, "out") == files(&place, "whole"));
}
