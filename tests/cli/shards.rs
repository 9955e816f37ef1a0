//! `render --shard`: processes that draw into one folder at the same time.

use crate::cli::parts::{drawn_and_kept, files, rich};
use crate::cli::render::{can_draw, place_to_draw};
use crate::cli::support::{Place, SMALL, lasting, run};
#[cfg(unix)]
use std::process::Command;

/// Three shards draw at once. One is killed and repeated. The folder then has the bytes of one process.
#[cfg(unix)]
#[test]
fn shards_at_once_are_the_whole() {
    if !can_draw() {
        return;
    }
    let place = Place::new();
    place.write("scene.toml", &rich().replace("size = [640, 360]", "size = [320, 240]"));
    place.run("render scene.toml -o whole --states").too_large_steps();
    place.run("simulate scene.toml -o made --states").too_large_steps();
    let before = place.read("made/run.json");
    let shard = |number: usize| {
        format!("render scene.toml --from-states made/states.npz --shard {number}/3 --threads 1 -o made --resume")
    };
    let others = [1, 3].map(|number| crate::cli::interrupt::start(&place, &shard(number), "made/run.json"));
    // At once after its first frame, so that a busy machine leaves it none of the last ones.
    crate::cli::interrupt::start(&place, &shard(2), "made/frame_00001.png").kill();
    for running in others {
        running.wait().too_large_steps();
    }
    assert!(files(&place, "made") != files(&place, "whole"), "the killed one has not drawn all");
    let ran = place.run(&shard(2)).too_large_steps();
    assert!(ran.out.contains("20 frames of 320×240 in made") && ran.out.contains("drawn before"), "{ran:?}");
    assert!(files(&place, "made") == files(&place, "whole"));
    assert_eq!(place.read("made/run.json"), before, "that of the command which wrote the tables");
}

/// `simulate` may run before, between and after shards, which simulate the scene if there are no states.
#[test]
fn the_order_does_not_matter() {
    let Some(place) = place_to_draw() else { return };
    place.run("render small.toml -o whole").good();
    let commands = [
        "render small.toml --shard 1/2 -o made",
        "render small.toml --shard 2/2 -o made",
        "simulate small.toml -o made",
    ];
    for order in [[0, 1, 2], [1, 2, 0], [2, 0, 1]] {
        for (number, command) in order.into_iter().enumerate() {
            place.run(commands[command]).good();
            let run = place.json("made/run.json");
            let is_simulated = order[..=number].contains(&2);
            assert_eq!(run["outcome"], if is_simulated { "done" } else { "shards" });
            assert_eq!(run["frames"]["asked"], 7);
        }
        assert!(files(&place, "made") == files(&place, "whole"), "{order:?}");
        std::fs::remove_dir_all(place.path("made")).unwrap();
    }
}

/// A process that draws a frame removes its leftovers of killed processes. Others may be at work without a visible lock.
#[test]
fn leftovers_go_with_their_frames() {
    let Some(place) = place_to_draw() else { return };
    place.run("render small.toml --shard 1/2 -o out").good();
    let left = [1, 4].map(|frame| format!(".localshape-frame_0000{frame}.png-abc.partial"));
    left.iter().for_each(|name| place.write(&format!("out/{name}"), "cut"));
    place.run("simulate small.toml -o out").good();
    place.run("render small.toml --shard 1/3 --frames 0-2 -o out").good();
    assert_eq!(place.names("out").iter().filter(|name| name.starts_with('.')).count(), 2);
    place.run("render small.toml --shard 2/3 -o out").good();
    assert_eq!(place.names("out")[..2], ["diagnostics.csv".to_owned(), "frame_00000.png".to_owned()]);
}

#[test]
fn other_scenes_and_sizes_are_refused() {
    let Some(place) = place_to_draw() else { return };
    let shard = "render small.toml --shard 1/2";
    place.run(&format!("{shard} -o out")).good();
    place.run(&format!("{shard} -o out --size 80x60")).bad(2, &["out holds frames of this scene of 96×64 pixels"]);
    place
        .run(&format!("{shard} -o out --only Mass-spring"))
        .bad(2, &["96×64 pixels with “Local shape”, “Mass-spring”"]);
    place.write("other.toml", &SMALL.replace("Two cubes", "Others"));
    place.run("render other.toml --shard 2/2 -o out").bad(2, &["the results of another scene (“Two cubes”"]);
    assert_eq!(place.names("out").len(), 4 + 1);
    // Shards only add frames. `simulate` replaces the results of other versions and scenes.
    place.run(shard).good();
    place.write("small.toml", &SMALL.replace("restitution = 0.5", "restitution = 0.6"));
    let words =
        ["output/small holds the results of another version of small.toml, and a shard only adds frames; choose"];
    place.run(shard).bad(2, &words);
    assert_eq!(place.names("output/small").len(), 4 + 1, "nothing is removed");
    let ran = place.run("simulate small.toml").good();
    assert!(ran.out.starts_with("output/small: replacing the results of another version of small.toml\n"), "{ran:?}");
    place.run(shard).good();
    assert_eq!(place.names("output/small").len(), 4 + 2);
    place.run("render other.toml --shard 2/2 -o out --overwrite").bad(2, &["--shard", "--overwrite"]);
    place.run("simulate other.toml -o out --overwrite").good();
    place.run("render other.toml --shard 2/2 -o out").good();
    let names = ["diagnostics.csv", "frame_00001.png", "frame_00003.png", "frame_00005.png", "run.json"];
    assert_eq!(place.names("out"), names);
}

/// Shards keep the checkpoint of an interrupted simulation, and write none. Other shards may draw beside them, but no
/// other command.
#[cfg(unix)]
#[test]
fn checkpoints_are_left_alone() {
    let Some(place) = place_to_draw() else { return };
    place.write("scene.toml", &lasting("100000"));
    let simulate = "simulate scene.toml -o made";
    let running = crate::cli::interrupt::start(&place, simulate, "made/run.json");
    let shard = "render scene.toml --frames 0-9 --shard 1/2 -o made";
    place.run(shard).bad(2, &["made is in use: another process is writing there"]);
    crate::cli::interrupt::signal(&running, &["INT"]);
    assert_eq!(running.wait().status, Some(130));
    let hidden = |place: &Place| -> Vec<(String, Vec<u8>)> {
        let names = place.names("made").into_iter().filter(|name| name.starts_with('.'));
        names.map(|name| (name.clone(), std::fs::read(place.path("made").join(name)).unwrap())).collect()
    };
    let before = hidden(&place);
    assert!(!before.is_empty());
    place.run(shard).good();
    let running = crate::cli::interrupt::start(&place, "render scene.toml --shard 1/2 -o made", "made/frame_00012.png");
    place.run("render scene.toml --frames 0-9 --shard 2/2 -o made --resume").good();
    place.run(&format!("{simulate} --resume")).bad(2, &["made is in use"]);
    crate::cli::interrupt::signal(&running, &["TERM"]);
    let ran = running.wait();
    assert!(ran.status == Some(130) && ran.out.contains("render --resume scene.toml --shard 1/2 -o made"), "{ran:?}");
    assert!(hidden(&place) == before);
}

#[test]
fn wrong_shards() {
    let place = Place::with_small();
    for (shard, words) in [
        ("0/4", "there is no shard 0 of 4; expected 1/4 to 4/4"),
        ("5/4", "there is no shard 5 of 4"),
        ("4", "such as 2/4"),
    ] {
        place.run(&format!("render small.toml --shard {shard}")).bad(2, &["--shard", words]);
    }
    place.run("render small.toml --shard 8/9").bad(2, &["--shard: shard 8/9 of 7 frames is empty; expected at most 7"]);
    place.run("render small.toml --shard 1/2 --states").bad(2, &["--shard", "--states"]);
    place.run("render small.toml --frames 1 --shard 1/1 -o one.png").bad(2, &["one.png gets one frame", "--shard"]);
    assert_eq!(place.names("."), ["small.toml"]);
}

/// The lines of `docs/clusters.md` from the one with this beginning to the end of its block, for another scene.
#[cfg(unix)]
fn documented(beginning: &str) -> String {
    let page = include_str!("../../docs/clusters.md");
    let block = page.split("```sh\n").find(|block| block.starts_with(beginning)).expect("a block");
    block.split("```").next().expect("its lines").replace("fig4b", "small")
}

/// Runs a script in which `localshape` is the program of this test.
#[cfg(unix)]
fn script(place: &Place, lines: &str) -> Command {
    let program = std::path::Path::new(env!("CARGO_BIN_EXE_localshape")).parent().expect("its folder");
    let paths = std::env::var_os("PATH").unwrap_or_default();
    let paths = std::iter::once(program.to_owned()).chain(std::env::split_paths(&paths));
    let mut command = Command::new("bash");
    command.args(["-euc", lines, "frames.sh"]).current_dir(place.path("."));
    command.env("PATH", std::env::join_paths(paths).expect("plain paths")).env("LC_ALL", "C");
    command
}

/// The tasks of the array, one after another. Slurm itself was tried on a cluster of two nodes.
#[cfg(unix)]
#[test]
fn the_tasks_of_slurm_draw_the_whole() {
    let Some(place) = place_to_draw() else { return };
    place.run("render small.toml -o whole --states").good();
    let submit = documented("states=$(sbatch");
    let wrapped = submit.split('\'').nth(1).expect("the command of the first job");
    run(&mut script(&place, wrapped)).good();
    let tasks = documented("#!/bin/bash").replace("40", "3");
    for task in ["2", "1", "3", "2"] {
        run(script(&place, &tasks).env("SLURM_ARRAY_TASK_ID", task)).good();
    }
    assert_eq!(drawn_and_kept(&place, "small"), [0, 0], "the tables are those of the first job");
    assert!(files(&place, "small") == files(&place, "whole"));
}

#[cfg(unix)]
#[test]
fn gnu_parallel_draws_the_whole() {
    let Some(place) = place_to_draw() else { return };
    if Command::new("parallel").arg("--version").output().is_err() {
        let missing = "there is no GNU parallel: `apt install parallel`";
        assert!(std::env::var_os("LOCALSHAPE_REQUIRE_PARALLEL").is_none_or(|value| value != "1"), "{missing}");
        return localshape::internals::skipped(missing);
    }
    place.run("render small.toml -o whole --states").good();
    run(&mut script(&place, documented("localshape simulate").lines().next().expect("a line"))).good();
    let line = documented("seq 8").replace('8', "7");
    for _ in 0..2 {
        let ran = run(script(&place, &line).env("HOME", place.path(".")));
        assert_eq!(ran.status, Some(0), "{ran:?}");
        assert!(files(&place, "small") == files(&place, "whole"));
    }
}
