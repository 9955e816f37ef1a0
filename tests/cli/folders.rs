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
