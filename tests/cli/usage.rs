//! Wrong usage: every mistake has its message and exit status 2.

use crate::cli::support::{Place, SMALL, run};

#[test]
fn help_and_version_are_results() {
    let place = Place::new();
    let help = place.run("--help").good();
    for word in ["render", "simulate", "check", "info", "schema", "completions", "Exit status:", "130", "Examples:"] {
        assert!(help.out.contains(word) || (word == "render" && cfg!(not(feature = "render"))), "{word}");
    }
    assert_eq!(place.run("--version").good().out, format!("localshape {}\n", env!("CARGO_PKG_VERSION")));
    for command in ["simulate", "check", "info", "schema", "completions"] {
        place.run(&format!("{command} --help")).good();
    }
}

#[test]
fn unknown_words() {
    let place = Place::with_small();
    place.run("simulat small.toml").bad(2, &["simulat", "simulate"]);
    place.run("simulate small.toml --thread 2").bad(2, &["--thread", "--threads"]);
    place.run("simulate").bad(2, &["SCENE"]);
    place.run("simulate small.toml --json --quiet").bad(2, &["--json", "--quiet"]);
    for threads in ["0", "-1", "many", "100000"] {
        place.run(&format!("simulate small.toml --threads={threads}")).bad(2, &["--threads", threads]);
    }
    assert_eq!(place.names("."), ["small.toml"]);
}

#[test]
fn frame_ranges() {
    let place = Place::with_small();
    place.run("simulate small.toml --frames 0-7").bad(2, &["Two cubes", "no frame 7", "last one is 6"]);
    place.run("simulate small.toml --frames 4-2").bad(2, &["4-2", "2-4"]);
    place.run("simulate small.toml --frames 0-4x0").bad(2, &["0-4x0"]);
    place.run("simulate small.toml --frames 1..3").bad(2, &["1..3", "0-119x3"]);
    place.run("simulate small.toml --frames -1").bad(2, &["`-1`"]);
    assert_eq!(place.names("."), ["small.toml"]);
}

#[test]
fn unknown_run() {
    let place = Place::with_small();
    place.run("simulate small.toml --only Mass-sprin").bad(2, &["did you mean “Mass-spring”?", "“Local shape”"]);
    let ran = place
        .run("simulate small.toml --only xyz")
        .bad(2, &["no run “xyz”; its runs are “Local shape” and “Mass-spring”"]);
    assert!(!ran.err.contains("did you mean"), "{}", ran.err);
    assert_eq!(place.names("."), ["small.toml"]);
}

#[test]
fn missing_scene() {
    let place = Place::with_small();
    place.run("simulate smal.toml").bad(2, &["smal.toml", "small.toml"]);
    assert_eq!(place.names("."), ["small.toml"]);
}

/// All scenes are checked before the first is run.
#[test]
fn one_wrong_scene_of_several() {
    let place = Place::with_small();
    place.write("wrong.toml", &SMALL.replace("shape-based", "shape-baste"));
    place.run("simulate small.toml wrong.toml").bad(2, &["wrong.toml:", "shape-baste", "shape-based"]);
    assert_eq!(place.names("."), ["small.toml", "wrong.toml"]);
}

#[test]
fn two_scenes_for_one_folder() {
    let place = Place::new();
    place.write("a/scene.toml", SMALL);
    place.write("b/scene.toml", &SMALL.replace("Two cubes", "The same cubes"));
    let ran = place.run("simulate a/scene.toml b/scene.toml").bad(2, &["Two cubes", "The same cubes", "-o"]);
    assert!(ran.err.contains("scene; run them"), "{}", ran.err);
}

/// Colours are for terminals; redirected output has none.
#[test]
fn colours_that_are_forced_stay_out_of_results() {
    let place = Place::with_small();
    for arguments in ["simulate small.toml --json", "check small.toml --json", "info --json", "schema"] {
        let mut command = place.command(arguments.split(' '));
        let ran = run(command.env("CLICOLOR_FORCE", "1").env("TERM", "xterm-256color")).good();
        assert!(ran.json().is_object(), "{arguments}");
    }
    let ran = run(place.command(["simulate"]).env("CLICOLOR_FORCE", "1"));
    assert!(ran.status == Some(2) && ran.err.contains('\x1b'), "a user who asks for colours gets them: {ran:?}");
}
