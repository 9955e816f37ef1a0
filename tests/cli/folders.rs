//! Ownership of output folders.

use crate::cli::support::{Place, Running, lasting, run};
use std::process::Command;

#[test]
fn the_same_scene_replaces_its_files() {
    let place = Place::with_small();
    place.run("simulate small.toml").good();
    place.write("output/small/notes.txt", "mine");
    place.write("small.toml", &format!("# another comment\n{}", crate::cli::support::SMALL));
    place.run("simulate small.toml").good();
    assert_eq!(place.names("output/small"), ["diagnostics.csv", "notes.txt", "run.json"]);
}

/// The states of a scene are right, with any command that writes them.
#[test]
fn results_of_the_same_scene_stay_unless_they_are_made_again() {
    let place = Place::with_small();
    place.run("simulate small.toml --states -o out").good();
    let states = |place: &Place| std::fs::read(place.path("out/states.npz")).unwrap();
    let before = states(&place);
    place.run("simulate small.toml --frames 2 --only Mass-spring -o out").good();
    assert!(states(&place) == before);
    assert_eq!(place.json("out/run.json")["files"], serde_json::json!(["diagnostics.csv"]));
    assert_eq!(place.read("out/diagnostics.csv").lines().count(), 2);
    place.run("simulate small.toml --states --frames 3 -o out").good();
    assert!(states(&place) != before);
    assert_eq!(place.names("out"), ["diagnostics.csv", "run.json", "states.npz"]);
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
    assert_eq!(
        place.names("out"),
        ["diagnostics.csv", "notes.txt", "run.json"],
        "the states of the other scene are gone"
    );
    assert_eq!(place.read("out/diagnostics.csv").lines().count(), 1 + 2 * 4);
}

/// A user who edits a scene and runs it again wants its results replaced, without a question each time.
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
        let told = "output/small: replacing the results of another version of small.toml\nTwo cubes\n";
        assert!(ran.out.starts_with(told), "{ran:?}");
        assert_eq!(place.names("output/small"), ["diagnostics.csv", "notes.txt", "run.json"]);
    }
    assert_ne!(place.json("output/small/run.json")["scene"]["digest"], first["scene"]["digest"]);
    // Unchanged results are not reported as replaced, and `--quiet` reports nothing.
    assert!(place.run("simulate small.toml").good().out.starts_with("Two cubes\n"));
    place.write("small.toml", &lasting("0.05"));
    assert_eq!(place.run("simulate small.toml -q").good().out, "");
    // A file of the same name elsewhere is another scene.
    place.write("elsewhere/small.toml", crate::cli::support::SMALL);
    let other = place.run("simulate elsewhere/small.toml");
    other.bad(2, &["output/small holds the results of another scene (“Two cubes”, ", file.to_str().unwrap()]);
    // A scene of unknown origin is another scene, too. A scene with another value of a key is another version.
    place.write("small.toml", crate::cli::support::SMALL);
    let summary = place.read("output/small/run.json");
    let nameless: String = summary.lines().filter(|line| !line.contains("file\":")).collect();
    place.write("output/small/run.json", &nameless);
    let told = ["output/small holds the results of another scene (“Two cubes”)", "simulate --overwrite small.toml"];
    place.run("simulate small.toml").bad(2, &told);
    place.run("simulate small.toml --overwrite").good();
    let ran = place.run("simulate small.toml --set time.duration=0.05").good();
    assert!(ran.out.starts_with("output/small: replacing the results of another version of small.toml\n"), "{ran:?}");
}

#[test]
fn a_project_that_has_moved_is_the_same() {
    let place = Place::new();
    place.write("before/small.toml", crate::cli::support::SMALL);
    let simulate = |project: &str| run(place.command(["simulate", "small.toml"]).current_dir(place.path(project)));
    simulate("before").good();
    assert_eq!(place.json("before/output/small/run.json")["scene"]["relative_file"], "../../small.toml");
    std::fs::rename(place.path("before"), place.path("after")).unwrap();
    place.write("after/small.toml", &lasting("0.05"));
    let told = "output/small: replacing the results of another version of small.toml\n";
    assert!(simulate("after").good().out.starts_with(told));
    // If only its results were moved, its full path identifies it.
    place.run("simulate after/small.toml -o results").good();
    std::fs::create_dir(place.path("below")).unwrap();
    std::fs::rename(place.path("results"), place.path("below/results")).unwrap();
    place.write("after/small.toml", &lasting("0.06"));
    place.run("simulate after/small.toml -o below/results").bad(2, &["another version of small.toml"]);
}

/// Results in another folder (`-o`) may be needed for comparison with later versions.
#[test]
fn a_folder_named_by_its_user_keeps_another_version() {
    let place = Place::with_small();
    place.run("simulate small.toml -o before").good();
    let before = place.read("before/run.json");
    place.write("small.toml", &lasting("0.05"));
    let program = env!("CARGO_BIN_EXE_localshape");
    let command = format!("--overwrite: {program} simulate --overwrite small.toml -o before\n");
    let told = "before holds the results of another version of small.toml; choose another folder with -o, or replace";
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

    // Only files that are written anew are replaced.
    place.run("simulate small.toml -o out --overwrite").good();
    assert_eq!(place.read("out/frame_00003.png"), "mine");
    assert_eq!(place.read("out/frame_3.png"), "mine");
    assert!(place.read("out/diagnostics.csv").starts_with("run,body,frame,"));
}

#[test]
fn a_file_in_the_way() {
    let place = Place::with_small();
    place.write("taken", "a file");
    let commands = ["simulate small.toml", "render small.toml", "figure fig1"];
    for command in commands.iter().take(if cfg!(feature = "render") { 3 } else { 1 }) {
        for folder in ["taken", "taken/below"] {
            let ran = place.run(&format!("{command} -o {folder}"));
            ran.bad(4, &["error: taken is a file, not a folder; choose another folder with -o\n"]);
        }
    }
    let commands = [
        "render small.toml --frames 3 -o taken/one.svg",
        "render small.toml --animate taken/film.gif",
        "figure fig1 -o taken/fig1.png",
        "animate out -o taken/film.gif",
    ];
    for command in commands.iter().take(if cfg!(feature = "render") { 4 } else { 0 }) {
        place.run(command).bad(4, &["error: taken is a file, not a folder; choose another folder with -o\n"]);
    }
    assert_eq!(place.read("taken"), "a file");
}

/// Opening a pipe would block.
#[cfg(unix)]
#[test]
fn pipes_under_our_names_are_told_at_once() {
    let place = Place::with_small();
    let fifo = |name: &str| {
        let path = place.path("out").join(name);
        let _ = std::fs::remove_dir_all(place.path("out"));
        std::fs::create_dir(place.path("out")).unwrap();
        assert_eq!(run(Command::new("mkfifo").arg(&path)).status, Some(0));
    };
    for name in ["frame_00000.png", "run.json", "diagnostics.csv", "states.npz"] {
        fifo(name);
        for overwrite in ["", " --overwrite"] {
            let ran = place.run(&format!("simulate small.toml -o out --states{overwrite}"));
            ran.bad(
                2,
                &[&format!("out/{name} is a pipe, not a file; move it away, or choose another folder with -o\n")],
            );
            assert_eq!(place.names("out"), [name]);
        }
    }
    if cfg!(feature = "render") {
        fifo("fig1.png");
        place.run("figure fig1 -o out").bad(2, &["out holds fig1.png"]);
    }
}

/// A folder cannot be replaced by a file.
#[test]
fn folders_under_our_names_are_told_at_once() {
    for name in ["frame_00003.png", "run.json", "diagnostics.csv", "states.npz"] {
        let place = Place::with_small();
        place.write(&format!("out/{name}/notes.txt"), "mine");
        for overwrite in ["", " --overwrite"] {
            let ran = place.run(&format!("simulate small.toml -o out --states{overwrite}"));
            ran.bad(2, &[&format!("out/{name} is a folder, not a file; move it away")]);
            assert_eq!(place.names("out"), [name]);
        }
    }
}

#[cfg(unix)]
#[test]
fn a_link_to_nothing_is_a_file_of_others() {
    let place = Place::with_small();
    for name in ["frame_00001.png", "run.json"] {
        let folder = format!("with-{name}");
        std::fs::create_dir(place.path(&folder)).unwrap();
        let link = place.path(&folder).join(name);
        std::os::unix::fs::symlink("nowhere", &link).unwrap();
        let words = [&format!("{folder} holds {name}, which was not written by localshape"), "--overwrite"];
        place.run(&format!("simulate small.toml -o {folder}")).bad(2, &words);
        place.run(&format!("simulate small.toml -o {folder} --overwrite")).good();
        // Only files that are written anew are replaced.
        assert_eq!(link.is_symlink(), name != "run.json");
    }
}

/// A scene in a pipe is read, as with `localshape check <(./make-scene)`.
#[cfg(unix)]
#[test]
fn a_scene_from_a_pipe() {
    let place = Place::with_small();
    let scene = std::fs::File::open(place.path("small.toml")).unwrap();
    run(Command::new("sh")
        .args(["-c", "cat | \"$0\" check /dev/stdin", env!("CARGO_BIN_EXE_localshape")])
        .stdin(scene))
    .good();
}

/// The lock is released when its process ends in any way.
#[cfg(unix)]
#[test]
fn one_program_at_a_time() {
    let place = Place::with_small();
    place.write("long.toml", &lasting("100000"));
    place.write("other.toml", &lasting("0.05").replace("Two cubes", "Others"));
    let mut first = crate::cli::interrupt::start(&place, "simulate long.toml -o out", "out/run.json");
    let words = ["out is in use: another process is writing there; ", "-o"];
    for command in ["simulate long.toml", "simulate other.toml", "simulate other.toml --overwrite"] {
        place.run(&format!("{command} -o out")).bad(2, &words);
    }
    assert!(first.is_running());
    first.kill();
    assert_eq!(place.json("out/run.json")["outcome"], "unfinished");
    place.run("simulate other.toml -o out --overwrite").good();
    assert_eq!(place.names("out"), ["diagnostics.csv", "run.json"]);
}

/// No other process can interfere between the inspection and the lock.
#[cfg(unix)]
#[test]
fn of_two_that_begin_together_one_is_refused() {
    let place = Place::new();
    place.write("a.toml", &lasting("1").replace("Two cubes", "a"));
    place.write("b.toml", &lasting("2").replace("Two cubes", "b"));
    for number in 0..20 {
        let folder = format!("out-{number}");
        let start = |name| Running::start(&mut place.command(["simulate", name, "-o", &folder]));
        let both = [start("a.toml"), start("b.toml")].map(Running::wait);
        let won = both.iter().position(|ran| ran.status == Some(0)).expect("one of them runs");
        assert_eq!(both[1 - won].status, Some(2), "{both:?}");
        let summary = place.json(&format!("{folder}/run.json"));
        assert_eq!((summary["scene"]["title"].as_str(), &summary["outcome"]), (Some(["a", "b"][won]), &"done".into()));
        let rows = place.read(&format!("{folder}/diagnostics.csv")).lines().count();
        assert_eq!(rows, 1 + 2 * [61, 121][won]);
    }
}

#[cfg(unix)]
#[test]
fn a_folder_that_may_not_be_written() {
    use std::os::unix::fs::PermissionsExt;
    let place = Place::with_small();
    place.write("locked/notes.txt", "mine");
    std::fs::set_permissions(place.path("locked"), PermissionsExt::from_mode(0o555)).unwrap();
    if std::fs::write(place.path("locked/probe"), "").is_ok() {
        return localshape::internals::skipped("this user may write anywhere; the test needs one who may not");
    }
    place.run("simulate small.toml -o locked").bad(4, &["cannot write locked", "ermission denied"]);
    assert_eq!(place.names("locked"), ["notes.txt"]);
    std::fs::set_permissions(place.path("locked"), PermissionsExt::from_mode(0o755)).unwrap();
}
