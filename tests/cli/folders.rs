//! Whose folder it is.

use crate::support::{Place, lasting};

#[test]
fn the_same_scene_replaces_its_files() {
    let place = Place::with_small();
    place.run("simulate small.toml").good();
    place.write("output/small/notes.txt", "mine");
    place.write("small.toml", &format!("# another comment\n{}", crate::support::SMALL));
    place.run("simulate small.toml").good();
    assert_eq!(place.names("output/small"), ["diagnostics.csv", "notes.txt", "run.json"]);
}

/// States that are not those of the diagnostics beside them would mislead.
#[test]
fn states_of_an_earlier_run_do_not_stay() {
    let place = Place::with_small();
    place.run("simulate small.toml --states").good();
    let files = |place: &Place| place.json("output/small/run.json")["files"].clone();
    assert_eq!(files(&place), serde_json::json!(["diagnostics.csv", "states.npz"]));
    place.run("simulate small.toml --states --frames 3").good();
    assert_eq!(place.names("output/small"), ["diagnostics.csv", "run.json", "states.npz"]);
    place.run("simulate small.toml --frames 2").good();
    assert_eq!(place.names("output/small"), ["diagnostics.csv", "run.json"]);
    assert_eq!(files(&place), serde_json::json!(["diagnostics.csv"]));
}

#[test]
fn another_scene_is_refused_unless_told() {
    let place = Place::with_small();
    place.run("simulate small.toml -o out --states").good();
    place.write("out/notes.txt", "mine");
    place.write("other.toml", &lasting("0.05"));
    let before = place.read("out/run.json");
    place.run("simulate other.toml -o out").bad(2, &["out holds", "another scene", "Two cubes", "--overwrite", "-o"]);
    assert_eq!(place.read("out/run.json"), before);

    place.run("simulate other.toml -o out --overwrite").good();
    assert_eq!(place.names("out"), ["diagnostics.csv", "notes.txt", "run.json"]);
    assert_eq!(place.read("out/diagnostics.csv").lines().count(), 1 + 2 * 4);
}

/// Whoever edits a scene and runs it again wants just that, without being asked each time.
#[test]
fn a_folder_named_after_its_scene_follows_the_file() {
    let place = Place::with_small();
    place.run("simulate small.toml --states").good();
    let first = place.json("output/small/run.json");
    let file = place.path("small.toml").canonicalize().unwrap();
    assert_eq!(first["scene"]["file"].as_str(), file.to_str());
    place.write("output/small/notes.txt", "mine");
    for duration in ["0.05", "0.06"] {
        place.write("small.toml", &lasting(duration));
        let ran = place.run("simulate ./small.toml").good();
        let told = "output/small: replacing results made by an earlier version of small.toml\nTwo cubes\n";
        assert!(ran.out.starts_with(told), "{ran:?}");
        assert_eq!(place.names("output/small"), ["diagnostics.csv", "notes.txt", "run.json"]);
    }
    assert_ne!(place.json("output/small/run.json")["scene"]["digest"], first["scene"]["digest"]);
    // What stays the same is not said to be replaced, and nothing is said where nothing should be.
    assert!(place.run("simulate small.toml").good().out.starts_with("Two cubes\n"));
    place.write("small.toml", &lasting("0.05"));
    assert_eq!(place.run("simulate small.toml -q").good().out, "");
    // A file of the same name elsewhere is another scene.
    place.write("elsewhere/small.toml", crate::support::SMALL);
    let other = place.run("simulate elsewhere/small.toml");
    other.bad(2, &["output/small holds the results of another scene (“Two cubes”, ", file.to_str().unwrap()]);
    // So is one of which nobody knows where it came from.
    place.write("small.toml", crate::support::SMALL);
    let summary = place.read("output/small/run.json");
    let line = summary.lines().find(|line| line.contains("\"file\":")).unwrap();
    place.write("output/small/run.json", &summary.replace(line, ""));
    let unknown = place.run("simulate small.toml");
    unknown
        .bad(2, &["another scene, or an earlier version of this one (“Two cubes”)", "simulate --overwrite small.toml"]);
}

/// What was put aside with `-o` may be what later versions are compared with.
#[test]
fn a_folder_named_by_its_user_keeps_an_earlier_version() {
    let place = Place::with_small();
    place.run("simulate small.toml -o before").good();
    let before = place.read("before/run.json");
    place.write("small.toml", &lasting("0.05"));
    let program = env!("CARGO_BIN_EXE_localshape");
    let command = format!("--overwrite: {program} simulate --overwrite small.toml -o before\n");
    let told =
        "before holds results made by an earlier version of small.toml; choose another folder with -o, or replace";
    place.run("simulate small.toml -o before").bad(2, &[told, &command]);
    assert_eq!(place.read("before/run.json"), before);
    place.run("simulate --overwrite small.toml -o before").good();
    assert_ne!(place.read("before/run.json"), before);
}

#[test]
fn files_of_others_under_our_names_are_refused_unless_told() {
    let place = Place::with_small();
    place.write("out/diagnostics.csv", "mine");
    place.write("out/frame_00003.png", "mine");
    place.write("out/frame_3.png", "mine");
    let words = ["out holds", "diagnostics.csv and 1 more", "not written by localshape", "--overwrite"];
    place.run("simulate small.toml -o out").bad(2, &words);
    assert_eq!(place.names("out"), ["diagnostics.csv", "frame_00003.png", "frame_3.png"]);

    // Only what is written anew is replaced.
    place.run("simulate small.toml -o out --overwrite").good();
    assert_eq!(place.read("out/frame_00003.png"), "mine");
    assert_eq!(place.read("out/frame_3.png"), "mine");
    assert!(place.read("out/diagnostics.csv").starts_with("run,frame,"));
}

#[test]
fn a_file_in_the_way() {
    let place = Place::with_small();
    place.write("taken", "a file");
    place.run("simulate small.toml -o taken").bad(4, &["taken"]);
    place.run("simulate small.toml -o taken/below").bad(4, &["taken"]);
    assert_eq!(place.read("taken"), "a file");
}

#[cfg(unix)]
#[test]
fn a_folder_that_may_not_be_written() {
    use std::os::unix::fs::PermissionsExt;
    let place = Place::with_small();
    place.write("locked/notes.txt", "mine");
    std::fs::set_permissions(place.path("locked"), PermissionsExt::from_mode(0o555)).unwrap();
    if std::fs::write(place.path("locked/probe"), "").is_ok() {
        return crate::support::skip("this user may write anywhere; the test needs one who may not");
    }
    place.run("simulate small.toml -o locked").bad(4, &["cannot write locked", "ermission denied"]);
    assert_eq!(place.names("locked"), ["notes.txt"]);
    std::fs::set_permissions(place.path("locked"), PermissionsExt::from_mode(0o755)).unwrap();
}
