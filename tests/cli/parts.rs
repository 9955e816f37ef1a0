//! Sequences drawn in parts: after an interruption, and from stored states.

use crate::cli::render::{can_draw, place_to_draw};
use crate::cli::support::{Place, Ran, SMALL, lasting, run};
use serde_json::Value;
use std::collections::BTreeMap;

/// All files in a folder but `run.json`, which has times.
pub(crate) fn files(place: &Place, folder: &str) -> BTreeMap<String, Vec<u8>> {
    let names = place.names(folder).into_iter().filter(|name| name != "run.json");
    names.map(|name| (name.clone(), std::fs::read(place.path(folder).join(name)).unwrap())).collect()
}

/// The numbers of drawn and of kept frames.
pub(crate) fn drawn_and_kept(place: &Place, folder: &str) -> [u64; 2] {
    let frames: &Value = &place.json(&format!("{folder}/run.json"))["frames"];
    [&frames["written"], &frames["kept"]].map(|count| count.as_u64().unwrap_or(0))
}

/// The pictures of the whole scene determine how far it is simulated, not `--only`.
#[test]
fn only_a_scene_whose_pictures_show_its_course_is_simulated_to_its_end() {
    let Some(place) = place_to_draw() else { return };
    place.write("still.toml", &lasting("0.1"));
    let steps = |scene: &str, options: &str| {
        place.run(&format!("render {scene}.toml --overwrite{options}")).good();
        let runs = place.json(&format!("output/{scene}/run.json"))["runs"].as_array().unwrap().clone();
        runs.iter().map(|run| run["steps"].as_u64().unwrap()).collect::<Vec<_>>()
    };
    let whole = steps("still", "");
    assert_eq!(steps("small", " --frames 2"), whole, "its camera follows");
    assert_eq!(steps("still", " --frames 2"), whole.iter().map(|steps| (steps + 1) / 3).collect::<Vec<_>>());
    assert_eq!(steps("still", " --only Mass-spring"), whole[1..]);
    assert_eq!(drawn_and_kept(&place, "output/still"), [7, 0]);
}

/// A killed program leaves whole frames, and drawing the others gives the bytes of an uninterrupted program.
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
        let running = crate::cli::interrupt::start(&place, &format!("render scene.toml -o {folder}"), &sign);
        crate::cli::interrupt::signal(&running, &[signal]);
        running.wait();
        let before = place.names(folder).iter().filter(|name| name.ends_with(".png")).count() as u64;
        assert!((4..121).contains(&before), "{before} frames of 121 are drawn");
        let ran = place.run(&format!("render scene.toml -o {folder} --resume")).good();
        assert!(
            ran.out.contains(&format!("121 frames of 96×64 in {folder}, {before} of them drawn before")),
            "{ran:?}"
        );
        assert_eq!(drawn_and_kept(&place, folder), [121 - before, before]);
        assert!(files(&place, folder) == files(&place, "whole"), "{folder}");
    }
}

/// A frame is kept only if it equals the frame that would be drawn.
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
    // A missing frame, a frame of another moment, and a truncated one.
    std::fs::remove_file(place.path(frame(1))).unwrap();
    std::fs::copy(place.path(frame(3)), place.path(frame(2))).unwrap();
    let bytes = std::fs::read(place.path(frame(4))).unwrap();
    std::fs::write(place.path(frame(4)), &bytes[..60]).unwrap();
    let ran = place.run("render small.toml --resume");
    ran.bad(2, &["output/small holds frame_00004.png, which was not written by localshape"]);
    assert_eq!(resume(" --overwrite"), [3, 4]);
    assert!(files(&place, "output/small") == whole);
    // Another size, and an earlier version of the scene, are treated as without `--resume`.
    place.run("render small.toml --resume --size 80x60").bad(2, &["frames of this scene of 96×64 pixels"]);
    place.write("small.toml", &SMALL.replace("restitution = 0.5", "restitution = 0.6"));
    let ran = place.run("render small.toml --resume").good();
    assert!(ran.out.starts_with("output/small: replacing the results of another version of small.toml"), "{ran:?}");
    assert_eq!(drawn_and_kept(&place, "output/small"), [7, 0]);
}

/// An animation has all frames, drawn by this process or another.
#[test]
fn an_animation_of_resumed_frames_is_the_same() {
    let Some(place) = place_to_draw() else { return };
    place.run("render small.toml --animate whole.apng").good();
    std::fs::remove_file(place.path("output/small/frame_00002.png")).unwrap();
    place.run("render small.toml --resume --animate resumed.apng").good();
    assert_eq!(drawn_and_kept(&place, "output/small"), [1, 6]);
    let shown = |name: &str| crate::cli::animate::decode_apng(&place.path(name));
    assert!(shown("whole.apng") == shown("resumed.apng"));
    place.run("render small.toml --resume --animate again.apng --no-frames").good();
    assert!(shown("whole.apng") == shown("again.apng"));
    place.run("render small.toml --resume --frames 1 -o one.png").bad(2, &["one.png gets one frame", "--resume"]);
}

/// The small scene with everything that pictures show beyond states: a course, paths, forces that act for a while, a
/// field from the model, and a run that diverges.
pub(crate) fn rich() -> String {
    let wild = "[[run]]\nname = \"Wild\"\nmodel = { kind = \"mass-spring\", stiffness = 1e4, springs = \"edges\" }\nstep = \"T/2\"\n";
    let grab = "[[grab]]\nnodes = [0]\npath = { keys = [{ time = 0.02 }, { time = 0.3, shift = [0, 0.2, 0] }] }\n";
    let view = "[view]\ncharts = [\"energy\"]\ncolour = { by = \"elastic-energy\", range = [0, 1] }\n\
                paths = [\"centre\"]\n";
    let rotation = "stiffness = 1e4, damping_ratio = 0.1, rotation = \"arctangent\" }";
    SMALL
        .replacen("stiffness = 1e4, damping_ratio = 0.1 }", rotation, 1)
        .replace("[[obstacle]]", &format!("{wild}{grab}[[obstacle]]"))
        .replace("[view]\n", view)
        .replace("size = [96, 64]", "size = [640, 360]")
        .replace("duration = 0.1", "duration = 1.0")
}

/// The steps of each run in the last command.
fn steps(place: &Place, folder: &str) -> Vec<u64> {
    let runs = place.json(&format!("{folder}/run.json"))["runs"].as_array().unwrap().clone();
    runs.iter().map(|run| run["steps"].as_u64().unwrap()).collect()
}

/// Frames of stored states have the same bytes, and nothing is simulated for them.
#[test]
fn frames_of_stored_states_are_those_of_a_simulation() {
    let Some(place) = place_to_draw() else { return };
    place.write("rich.toml", &rich());
    place.write("distance.toml", &format!("{SMALL}colour = {{ by = \"distance\", to = \"Mass-spring\" }}\n"));
    for (scene, options) in [
        ("small", ""),
        ("distance", " --frames 1,4"),
        ("rich", " --frames 0-60x15"),
        ("rich", " --frames 3,45 --only Mass-spring --only Local\u{a0}shape --size 500x300"),
    ] {
        // One run of the rich scene diverges.
        let expect = if scene == "rich" { Ran::too_large_steps } else { Ran::good };
        expect(place.run(&format!("simulate {scene}.toml --states -o states --overwrite")));
        for (folder, source) in [("direct", ""), ("stored", " --from-states states/states.npz")] {
            let typed = format!("render {scene}.toml -o {folder} --overwrite{source}{options}");
            let words = typed.split(' ').map(|word| word.replace('\u{a0}', " "));
            expect(run(&mut place.command(words)));
        }
        assert!(files(&place, "direct") == files(&place, "stored"), "{scene}{options}");
        assert!(steps(&place, "stored").iter().all(|&steps| steps == 0) && steps(&place, "direct")[0] > 0);
        let summary = |folder: &str| {
            let run = place.json(&format!("{folder}/run.json"));
            run["runs"]
                .as_array()
                .unwrap()
                .iter()
                .map(|run| (run["status"].clone(), run["last"].clone()))
                .collect::<Vec<_>>()
        };
        assert_eq!(summary("stored"), summary("direct"));
    }
    // Rows between frames are in the file, also of the steps of frames that are left out.
    place.write("rows.toml", &SMALL.replace("frames_per_second", "every = 1e-6\nframes_per_second"));
    place.run("simulate rows.toml --states -o rows").good();
    place.run("simulate rows.toml --frames 1,4 -o direct --overwrite").good();
    place.run("render rows.toml --frames 1,4 --from-states rows/states.npz -o stored --overwrite").good();
    assert!(place.read("direct/diagnostics.csv") == place.read("stored/diagnostics.csv"));
    let extremes =
        |folder: &str, end: &str| place.json(&format!("{folder}/run.json"))["runs"][0][end]["momentum"].clone();
    assert_eq!(extremes("direct", "greatest"), extremes("stored", "greatest"));
    // The wild run is one that diverges.
    place.run("render rich.toml --from-states states/states.npz --frames 60 -o last").too_large_steps();
    assert_eq!(place.json("last/run.json")["runs"][2]["status"], "diverged");
}

/// States written by `render` serve as well, and so do states of some frames up to the last.
#[test]
fn states_of_some_frames_are_drawn() {
    let Some(place) = place_to_draw() else { return };
    place.run("render small.toml --states --frames 2-6x2").good();
    let bytes = |path: &str| std::fs::read(place.path(path)).unwrap();
    place.run("simulate small.toml --states --frames 2-6x2 -o numbers").good();
    assert!(bytes("output/small/states.npz") == bytes("numbers/states.npz"));
    let from = "--from-states numbers/states.npz";
    place.run(&format!("render small.toml {from} --frames 4 -o one")).good();
    assert!(bytes("one/frame_00004.png") == bytes("output/small/frame_00004.png"));
    place
        .run(&format!("render small.toml {from} -o all"))
        .bad(2, &["numbers/states.npz lacks frame 0: it has 3 frames from 2 to 6; choose among them with --frames"]);
    // Pictures that show the whole course need it.
    place.run("simulate small.toml --states --frames 0-4 -o early").good();
    let ran = place.run("render small.toml --from-states early/states.npz --frames 0-4 -o all");
    ran.bad(2, &["early/states.npz lacks the course of the scene to its end", "--states"]);
    assert_eq!(steps(&place, "early")[0], steps(&place, "numbers")[0] * 4 / 6);
    place.write("still.toml", &lasting("0.1"));
    place.run("simulate still.toml --states --frames 0-4 -o early --overwrite").good();
    place.run("render still.toml --from-states early/states.npz --frames 0-4 -o still").good();
    assert!(!place.path("all").exists());
}

/// Drawing states beside them does not remove them.
#[test]
fn states_stay_beside_their_pictures() {
    let Some(place) = place_to_draw() else { return };
    place.run("simulate small.toml --states").good();
    let states = std::fs::read(place.path("output/small/states.npz")).unwrap();
    for _ in 0..2 {
        let ran = place.run("render small.toml --resume --from-states output/small/states.npz").good();
        assert!(ran.out.starts_with("Two cubes\n7 frames"), "{ran:?}");
        assert!(std::fs::read(place.path("output/small/states.npz")).unwrap() == states);
    }
    assert_eq!(drawn_and_kept(&place, "output/small"), [0, 7]);
}

#[test]
fn states_that_do_not_fit_are_refused() {
    let Some(place) = place_to_draw() else { return };
    place.run("simulate small.toml --states -o states").good();
    let states = std::fs::read(place.path("states/states.npz")).unwrap();
    let refused = |status: i32, words: &[&str]| {
        place.run("render small.toml --from-states states/states.npz -o out").bad(status, words);
        assert!(!place.path("out").exists(), "nothing is written before it is known that it can be drawn");
    };
    place.run("render small.toml --from-states none.npz -o out").bad(2, &["none.npz: there is no such file"]);
    place.run("render small.toml --from-states small.toml -o out").bad(2, &["small.toml is not a NumPy archive"]);
    place.run("render small.toml small.toml --from-states states/states.npz -o out").bad(2, &["one scene"]);
    place.run("render small.toml --from-states states/states.npz --states").bad(2, &["--from-states", "--states"]);
    place.run("render small.toml --frames 1 --from-states states/states.npz -o a.png").bad(2, &["--from-states"]);
    place.write("small.toml", &SMALL.replace("restitution = 0.5", "restitution = 0.6"));
    refused(2, &["states.npz belongs to another version of “Two cubes”; expected “Two cubes” as it is now"]);
    place.write("small.toml", &SMALL.replace("Two cubes", "Cubes"));
    refused(2, &["states.npz belongs to another scene, “Two cubes”; expected “Cubes”", "--states"]);
    place.write("small.toml", SMALL);
    std::fs::write(place.path("states/states.npz"), &states[..states.len() / 2]).unwrap();
    refused(2, &["states/states.npz is a damaged NumPy archive, or is cut short"]);
    place.run("simulate small.toml --states --only Mass-spring -o states --overwrite").good();
    refused(2, &["states.npz has no run \"Local shape\", only \"Mass-spring\"; choose among these with --only"]);

    // With one changed bit in frame 3, earlier frames are drawn, and their files are whole.
    let position = |frame: usize| {
        let at = states.windows(24).position(|bytes| bytes == b"Local shape.position.npy").unwrap();
        let start = at + states[at..].windows(6).position(|bytes| bytes == b"\x93NUMPY").unwrap();
        let head = 10 + usize::from(u16::from_le_bytes([states[start + 8], states[start + 9]]));
        start + head + frame * 12 * 24
    };
    let mut damaged = states.clone();
    damaged[position(3)] ^= 1;
    std::fs::write(place.path("states/states.npz"), &damaged).unwrap();
    let ran = place.run("render small.toml --from-states states/states.npz -o out");
    ran.bad(4, &["cannot read states/states.npz: the state of “Local shape” at 0.05027 s is damaged"]);
    assert_eq!(place.json("out/run.json")["outcome"], "failed");
    let names = ["diagnostics.csv", "frame_00000.png", "frame_00001.png", "frame_00002.png", "run.json"];
    assert_eq!(place.names("out"), names);
}

/// A file rewritten by another program is not accepted.
#[test]
fn states_that_numpy_has_written_are_refused() {
    let (Some(place), Some(python)) = (place_to_draw(), crate::cli::support::numpy()) else { return };
    place.run("simulate small.toml --states -o states").good();
    let script = "import numpy; states = dict(numpy.load('states/states.npz')); print(states['localshape'].dtype)\n\
                  assert states['Mass-spring.memory'].shape == (7, 0)\n\
                  numpy.savez_compressed('packed.npz', **states); del states['localshape']; numpy.savez('bare.npz', **states)";
    assert_eq!(python(&place.path("."), script).trim(), "uint8");
    let ran = place.run("render small.toml --from-states packed.npz -o out");
    ran.bad(2, &["packed.npz `localshape` is packed, or longer than the file; simulate the scene again with --states"]);
    let ran = place.run("render small.toml --from-states bare.npz -o out");
    ran.bad(2, &["bare.npz has no array `localshape`, which `localshape simulate --states` writes"]);
}
