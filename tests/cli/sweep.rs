//! `--sweep`: variants of a scene.

use crate::support::{Place, SMALL};

const TABLE: &str = "run[0].model.stiffness,run[1].step,body.lattice.cells\n2e4,T/60,\n1e4,,\"[1, 1, 1]\"\n,,\n";
const FOLDERS: [&str; 3] = ["0001_stiffness=2e4_step=T-60", "0002_stiffness=1e4_cells=-1--1--1-", "0003"];

fn place() -> Place {
    let place = Place::with_small();
    place.write("sweep.csv", TABLE);
    place
}

fn same(place: &Place, one: &str, other: &str) -> bool {
    let bytes = |folder: &str, name: &str| std::fs::read(place.path(folder).join(name)).unwrap();
    ["diagnostics.csv", "states.npz"].iter().all(|name| bytes(one, name) == bytes(other, name))
}

/// Each variant is what the edited scene would give, in a folder of its own.
#[test]
fn each_line_is_a_variant() {
    let place = place();
    let ran = place.run("simulate small.toml --sweep sweep.csv --states").good();
    assert_eq!(
        place.names("output/small-sweep"),
        [&FOLDERS[..], &["comparison.csv", "variants.csv"]].concat(),
        "{ran:?}"
    );
    assert!(ran.out.ends_with("in output/small-sweep/comparison.csv\n"), "{ran:?}");
    let compared = place.read("output/small-sweep/comparison.csv");
    assert_eq!(compared.lines().next(), Some("folder,run,status,diverged_at_s,turned_over,shape_error_m"));
    let of = |folder: &str| compared.lines().filter(|line| line.starts_with(&format!("{folder},"))).count();
    assert_eq!(FOLDERS.map(of), [2, 2, 2], "{compared}");
    let table = place.read("output/small-sweep/variants.csv");
    assert!(
        table.starts_with(&format!("folder,{}", TABLE.lines().next().unwrap())) && table.contains(FOLDERS[1]),
        "{table}"
    );
    let first = SMALL
        .replacen("stiffness = 1e4", "stiffness = 2e4", 1)
        .replace("one-diagonal\" }\n", "one-diagonal\" }\nstep = \"T/60\"\n");
    for (folder, edited) in FOLDERS.iter().zip([first, SMALL.replace("[2, 1, 1]", "[1, 1, 1]"), SMALL.to_owned()]) {
        place.write("small.toml", &edited);
        place.run("simulate small.toml --states -o edited --overwrite").good();
        assert!(same(&place, "edited", &format!("output/small-sweep/{folder}")), "{folder}");
    }
}

#[test]
fn shards_have_the_folders_of_the_whole() {
    let place = place();
    place.run("simulate small.toml --sweep sweep.csv --states -o whole").good();
    for shard in ["1/2", "2/2"] {
        place.run(&format!("simulate small.toml --sweep sweep.csv --states --shard {shard} -o shards")).good();
    }
    assert_eq!(place.names("whole"), place.names("shards"));
    assert!(FOLDERS.iter().all(|folder| same(&place, &format!("whole/{folder}"), &format!("shards/{folder}"))));
    place.run("simulate small.toml --sweep sweep.csv --shard 4/4").bad(2, &["shard 4/4 of 3 variants is empty"]);
    place.run("simulate small.toml --shard 1/2").bad(2, &["--sweep"]);
}

#[test]
fn complete_variants_are_left_out() {
    let place = place();
    let typed = "simulate small.toml --sweep sweep.csv --states -o out --resume";
    place.run(typed).good();
    std::fs::remove_file(place.path("out").join(FOLDERS[1]).join("states.npz")).unwrap();
    let ran = place.run(typed).good();
    let complete = |number: usize| ran.out.contains(&format!("out/{} is complete", FOLDERS[number]));
    assert_eq!([0, 1, 2].map(complete), [true, false, true], "{ran:?}");
    assert!(place.path("out").join(FOLDERS[1]).join("states.npz").exists());
    let ran = place.run(&format!("{typed} --json")).good();
    assert_eq!(ran.json()["scenes"].as_array().map(Vec::len), Some(3));
}

/// Neither the number of frames nor the last one says which they are.
#[test]
fn variants_with_other_frames_are_not_complete() {
    let place = place();
    place.run("simulate small.toml --sweep sweep.csv --frames 0,2,6").good();
    let ran = place.run("simulate small.toml --sweep sweep.csv --frames 0,3,6 --resume").good();
    assert!(!ran.out.contains("is complete"), "{ran:?}");
    let table = place.read(&format!("output/small-sweep/{}/diagnostics.csv", FOLDERS[2]));
    let frames: Vec<_> = table.lines().skip(1).filter_map(|line| line.split(',').nth(1)).collect();
    assert!(frames.contains(&"3") && !frames.contains(&"2"), "{table}");
    let ran = place.run("simulate small.toml --sweep sweep.csv --frames 0,3,6 --resume").good();
    assert_eq!(ran.out.matches("is complete").count(), 3, "{ran:?}");
}

#[test]
fn warnings_are_given_with_their_lines() {
    let place = place();
    place.write("sweep.csv", "run[0].step\nT/50\nT/2\n");
    let typed = "simulate small.toml --sweep sweep.csv --frames 0-1";
    let ran = place.run(typed);
    let warning = ran.err.starts_with("warning: sweep.csv:3:1: ") && ran.err.contains("  3 | T/2\n");
    assert!(warning && !ran.err.contains("sweep.csv:2:"), "{ran:?}");
    assert_eq!(place.run(&format!("{typed} --quiet")).err, "");
}

#[test]
fn mistakes_are_found_in_their_cells_before_anything_is_made() {
    let place = place();
    let refused = |table: &str, words: &[&str]| {
        place.write("sweep.csv", table);
        place.run("simulate small.toml --sweep sweep.csv -o out").bad(2, words);
        assert!(!place.path("out").exists());
    };
    refused(
        "run[0].model.stifness\n1\n2\n",
        &["sweep.csv:1:1: unknown key `stifness` in `run[0].model`", "did you mean `stiffness`"],
    );
    refused(
        "body.mass,run[0].model.stiffness\n1,2e4\n1,-5\n",
        &["sweep.csv:3:3: `run[0].model.stiffness` is -5", "  3 | 1,-5\n"],
    );
    refused("body.mass\nmuch\n", &["sweep.csv:2:1: ", "\"much\""]);
    refused("run[2].step\n1\n", &["sweep.csv:1:1: the scene has no `run[2]`; it has 2, counted from 0"]);
    refused("body.mass,body.mass\n1,1\n", &["sweep.csv:1:11: the key of column 2 is given a second time"]);
    refused("body.mass\n", &["sweep.csv:1:1: there are no variants"]);
    refused("", &["sweep.csv:1:1: there are no variants"]);
    refused(
        "body.mass\n1,2\n",
        &["sweep.csv:2:3: this line has 2 values; expected 1", "decimals have a point", "  2 | 1,2\n"],
    );
    refused("body.mass;run[0].step\n1;2\n", &["sweep.csv:1:1: the keys are separated by semicolons"]);
    refused("run.model.stiffness\n1\n", &["sweep.csv:1:1: `run` in ", "write `run[0]`"]);
    refused("body.mass\n\"0,5\"\n", &["sweep.csv:2:1: ", "decimals have a point: 0.5"]);
    place.write("sweep.csv", "time.duration\n0.1\n0.05\n");
    let ran = place.run("simulate small.toml --sweep sweep.csv --frames 6");
    ran.bad(2, &["sweep.csv:3:1: frames of “", "  3 | 0.05\n"]);
    place
        .run("simulate small.toml --sweep swep.csv")
        .bad(2, &["swep.csv: there is no such file; did you mean sweep.csv?"]);
    place.run("simulate none.toml --sweep sweep.csv").bad(2, &["none.toml: there is no such file"]);
    place.run("simulate small.toml small.toml --sweep sweep.csv").bad(2, &["--sweep has the variants of one scene"]);
}

/// Nothing of another table, or in a folder of any variant, is mixed with the new ones.
#[test]
fn folders_of_other_tables_are_refused_before_anything_is_made() {
    let place = place();
    let typed = "simulate small.toml --sweep sweep.csv --frames 0-1 -o out";
    place.run(typed).good();
    // A longer table goes on with the same folders.
    place.write("sweep.csv", &format!("{TABLE}3e4,,\n"));
    place.run(&format!("{typed} --resume")).good();
    let table = place.read("out/variants.csv");
    place.write("sweep.csv", TABLE);
    place.run(typed).bad(2, &["out holds variants of another table, such as 0004_stiffness=3e4", "--overwrite"]);
    assert_eq!(place.read("out/variants.csv"), table);
    let ran = place.run(&format!("{typed} --overwrite"));
    assert!(
        ran.status == Some(0) && ran.err.contains("out keeps variants of an earlier table, such as 0004_stiffness=3e4"),
        "{ran:?}"
    );
    // The last folder is occupied: the first is not made.
    place.write(&format!("new/{}/frame_00000.png", FOLDERS[2]), "mine");
    place.run("simulate small.toml --sweep sweep.csv -o new").bad(2, &[FOLDERS[2]]);
    assert_eq!(place.names("new"), [FOLDERS[2]]);
    // Tables that are not ours are kept, unless they may be lost.
    for name in ["comparison.csv", "variants.csv"] {
        place.write(&format!("{name}-own/{name}"), "mine");
        let typed = format!("simulate small.toml --sweep sweep.csv --frames 0-0 -o {name}-own");
        place.run(&typed).bad(2, &[&format!("{name}, which was not written by localshape"), "--overwrite"]);
        assert_eq!(place.read(&format!("{name}-own/{name}")), "mine");
        place.run(&format!("{typed} --overwrite")).good();
    }
    // A comparison has variants of one scene: here the first is of a changed one.
    place.write("small.toml", &place.read("small.toml").replace("0.1\n", "0.2\n"));
    place.run(&format!("{typed} --shard 1/3 --overwrite")).good();
    let compared = place.read("out/comparison.csv");
    assert!(compared.contains(FOLDERS[0]) && !compared.contains(FOLDERS[1]), "{compared}");
}

#[cfg(feature = "render")]
#[test]
fn variants_are_drawn() {
    if !crate::render::can_draw() {
        return;
    }
    let place = place();
    place.run("render small.toml --sweep sweep.csv --frames 3 --size 80x60 -o out").good();
    assert!(FOLDERS.iter().all(|folder| place.path("out").join(folder).join("frame_00003.png").exists()));
    place.run("render small.toml --sweep sweep.csv -o a.png").bad(2, &["a.png is a file for one frame"]);
    place.run("render small.toml --sweep sweep.csv --animate a.gif").bad(2, &["--sweep", "--animate"]);
}
