//! Sequences that are drawn in parts: again after an interruption.

use crate::render::{can_draw, place_to_draw};
use crate::support::{Place, SMALL, lasting};
use serde_json::Value;
use std::collections::BTreeMap;

/// All files in a folder but `run.json`, which has times.
fn files(place: &Place, folder: &str) -> BTreeMap<String, Vec<u8>> {
    let names = place.names(folder).into_iter().filter(|name| name != "run.json");
    names.map(|name| (name.clone(), std::fs::read(place.path(folder).join(name)).unwrap())).collect()
}

/// The numbers of frames that were drawn and that were there already.
fn drawn_and_kept(place: &Place, folder: &str) -> [u64; 2] {
    let frames: &Value = &place.json(&format!("{folder}/run.json"))["frames"];
    [&frames["written"], &frames["kept"]].map(|count| count.as_u64().unwrap_or(0))
}

/// Which pictures need the course of the scene decides how far it is simulated, and never `--only`.
#[test]
fn only_a_scene_whose_pictures_show_its_course_is_simulated_to_its_end() {
    let Some(place) = place_to_draw() else { return };
    place.write("still.toml", &lasting("0.1"));
    let steps = |scene: &str, options: &str| {
        place.run(&format!("render {scene}.toml --samples 1 --overwrite{options}")).good();
        let runs = place.json(&format!("output/{scene}/run.json"))["runs"].as_array().unwrap().clone();
        runs.iter().map(|run| run["steps"].as_u64().unwrap()).collect::<Vec<_>>()
    };
    let whole = steps("still", "");
    assert_eq!(steps("small", " --frames 2"), whole, "its camera follows");
    assert_eq!(steps("still", " --frames 2"), whole.iter().map(|steps| (steps + 1) / 3).collect::<Vec<_>>());
    assert_eq!(steps("still", " --only Mass-spring"), whole[1..]);
    assert_eq!(drawn_and_kept(&place, "output/still"), [7, 0]);
}

/// A killed program leaves whole frames, and drawing the others gives the bytes of one that was not killed.
#[cfg(unix)]
#[test]
fn resumed_frames_are_those_of_a_run_without_interruption() {
    if !can_draw() {
        return;
    }
    let place = Place::new();
    place.write("scene.toml", &lasting("2"));
    place.run("render scene.toml -o whole").good();
    for (folder, signal) in [("killed", "KILL"), ("ended", "TERM")] {
        let sign = format!("{folder}/frame_00003.png");
        let running = crate::interrupt::start(&place, &format!("render scene.toml -o {folder}"), &sign);
        crate::interrupt::signal(&running, &[signal]);
        running.wait();
        let before = place.names(folder).iter().filter(|name| name.ends_with(".png")).count() as u64;
        assert!((4..121).contains(&before), "{before} frames of 121 are drawn");
        let ran = place.run(&format!("render scene.toml -o {folder} --resume")).good();
        assert!(ran.out.contains(&format!("121 frames of 96×64 in {folder}, {before} of them drawn before")), "{ran:?}");
        assert_eq!(drawn_and_kept(&place, folder), [121 - before, before]);
        assert!(files(&place, folder) == files(&place, "whole"), "{folder}");
    }
}

/// A frame stays only if it is what would be drawn.
#[test]
fn resuming_draws_again_what_is_not_the_same() {
    let Some(place) = place_to_draw() else { return };
    place.run("render small.toml").good();
    let whole = files(&place, "output/small");
    let frame = |number: u32| format!("output/small/frame_{number:05}.png");
    let resume = |options: &str| {
        place.run(&format!("render small.toml --resume{options}")).good();
        drawn_and_kept(&place, "output/small")
    };
    assert_eq!(resume(""), [0, 7]);
    assert_eq!(resume(" --samples 1"), [7, 0]);
    assert_eq!(resume(""), [7, 0]);
    // Missing, of another moment, and cut off.
    std::fs::remove_file(place.path(frame(1))).unwrap();
    std::fs::copy(place.path(frame(3)), place.path(frame(2))).unwrap();
    let bytes = std::fs::read(place.path(frame(4))).unwrap();
    std::fs::write(place.path(frame(4)), &bytes[..60]).unwrap();
    let ran = place.run("render small.toml --resume");
    ran.bad(2, &["output/small holds frame_00004.png, which was not written by localshape"]);
    assert_eq!(resume(" --overwrite"), [3, 4]);
    assert!(files(&place, "output/small") == whole);
    // Another size, and an earlier version of the scene, are treated as without `--resume`.
    place.run("render small.toml --resume --size 80x60").bad(2, &["7 frames of this scene of 96×64 pixels"]);
    place.write("small.toml", &SMALL.replace("restitution = 0.5", "restitution = 0.6"));
    let ran = place.run("render small.toml --resume").good();
    assert!(ran.out.starts_with("output/small: replacing 7 frames made by an earlier version of small.toml"), "{ran:?}");
    assert_eq!(drawn_and_kept(&place, "output/small"), [7, 0]);
}

/// An animation has all frames, whoever has drawn them.
#[test]
fn an_animation_of_resumed_frames_is_the_same() {
    let Some(place) = place_to_draw() else { return };
    place.run("render small.toml --samples 1 --animate whole.y4m").good();
    std::fs::remove_file(place.path("output/small/frame_00002.png")).unwrap();
    place.run("render small.toml --samples 1 --resume --animate resumed.y4m").good();
    assert_eq!(drawn_and_kept(&place, "output/small"), [1, 6]);
    let bytes = |name: &str| std::fs::read(place.path(name)).unwrap();
    assert!(bytes("whole.y4m") == bytes("resumed.y4m"));
    place.run("render small.toml --resume --animate no.gif --no-frames").bad(2, &["--resume", "--no-frames"]);
    place.run("render small.toml --resume --frames 1 -o one.png").bad(2, &["one.png gets one frame", "--resume"]);
}
