//! The golden suite as used in a test of another project: its output, its files, and its refusals.

use localshape::golden::Suite;
use localshape::gpu::{AdapterChoice, Gpu};
use localshape::internals::{Compression, Pixels, encode};
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

const SCENE: &str = "
    time = { duration = 0.1, frames_per_second = 60 }
    gravity = [0, -9.8, 0]
    body.lattice = { cells = [1, 1, 1], side = 0.1 }
    body.velocity = [0.1, 0, 0]
    view.size = [96, 64]
    [[run]]
    name = 'Local shape'
    model = { kind = 'shape-based', stiffness = 1e4 }
";

/// A test as in another project. It runs in a separate process, as environment variables configure it.
#[test]
#[ignore = "started by the tests below"]
fn of_another_project() {
    // Ends the test if it hangs.
    std::thread::spawn(|| {
        std::thread::sleep(std::time::Duration::from_secs(300));
        std::process::abort();
    });
    let mut goldens = Suite::new("goldens").reports("reports");
    if std::env::var_os("EXACT").is_some() {
        goldens = goldens.exact();
    }
    for scene in std::env::var("SCENES").expect("set by the tests below").split(' ') {
        goldens.scene(scene);
    }
    goldens.finish();
}

/// Runs it and returns whether it passed, and its output.
fn run(place: &TempDir, scenes: &str, update: &str) -> (bool, String) {
    run_with(place, scenes, update, &[])
}

/// Runs it with further environment variables.
fn run_with(place: &TempDir, scenes: &str, update: &str, others: &[(&str, &str)]) -> (bool, String) {
    let mut command = Command::new(std::env::current_exe().expect("this test"));
    command.args(["--exact", "suite::of_another_project", "--ignored"]).current_dir(place.path());
    command.env("SCENES", scenes).env("UPDATE_GOLDENS", update).env("RUST_BACKTRACE", "0");
    command.envs(others.iter().copied());
    // Drivers print warnings about a missing window, which do not matter here.
    command.env_remove("XDG_RUNTIME_DIR");
    let output = command.output().expect("this test starts");
    let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).expect("text")).concat();
    assert!(text.contains("running 1 test") && !text.contains("XDG_RUNTIME_DIR"), "{text}");
    (output.status.success(), text)
}

fn write(place: &TempDir, name: &str, text: &str) {
    std::fs::write(place.path().join(name), text).expect("a file");
}

/// Whether there is a graphics adapter; with `LOCALSHAPE_REQUIRE_GPU=1` there must be.
fn can_draw() -> bool {
    let opened = Gpu::new(&AdapterChoice::Cpu);
    let is_required = std::env::var_os("LOCALSHAPE_REQUIRE_GPU").is_some_and(|value| value == "1");
    assert!(opened.is_ok() || !is_required, "{:?}", opened.err());
    opened.is_ok()
}

#[test]
#[should_panic(expected = "the result was not checked")]
fn a_suite_that_is_forgotten_fails() {
    let _ = Suite::new("nowhere");
}

#[test]
fn a_golden_is_missed_made_kept_renewed_and_guarded() {
    if !can_draw() {
        return;
    }
    let place = tempfile::tempdir().expect("a folder");
    write(&place, "drop.toml", SCENE);
    let (passed, text) = run(&place, "drop.toml", "");
    assert!(!passed && text.contains("drop: the golden goldens/drop is missing"), "{text}");
    assert!(text.contains("UPDATE_GOLDENS=1 cargo test"), "{text}");
    assert!(!place.path().join("goldens").exists(), "nothing is made unasked");

    let (passed, text) = run(&place, "drop.toml", "1");
    assert!(passed && text.contains("drop: accepted goldens/drop/frame_00002.png"), "{text}");
    assert!(run(&place, "drop.toml", "").0);

    // Changed drawing is renewed on request.
    write(&place, "drop.toml", &SCENE.replace("view.size", "view.theme = 'dark'\nview.size"));
    let (passed, text) = run(&place, "drop.toml", "");
    assert!(!passed && text.contains("drawn differently") && text.contains("see reports/drop.html"), "{text}");
    assert!(place.path().join("reports/drop.html").exists());
    assert!(run(&place, "drop.toml", "1").0 && run(&place, "drop.toml", "").0);

    // A changed state is reported when it is accepted, even by a passing test that captures its output.
    write(&place, "drop.toml", &SCENE.replace("0.1, 0, 0]", "0.2, 0, 0]"));
    let (passed, text) = run(&place, "drop.toml", "");
    assert!(!passed && text.contains("state moved: Local shape, first at frame 0: "), "{text}");
    assert!(text.contains("changed: body.velocity: [0.1, 0, 0] → [0.2, 0, 0]"), "{text}");
    let (passed, text) = run(&place, "drop.toml", "1");
    assert!(passed && text.contains("drop: accepted: state moved: Local shape, first at frame 0: "), "{text}");
    assert!(run(&place, "drop.toml", "").0);
    let (passed, text) = run(&place, "drop.toml", "state");
    assert!(!passed && text.contains("UPDATE_GOLDENS=state means nothing; UPDATE_GOLDENS=1 "), "{text}");
}

#[test]
fn on_request_pictures_without_lit_bodies_have_no_tolerance() {
    let place = tempfile::tempdir().expect("a folder");
    let plane = SCENE.replace(", 0]", "]").replace("[1, 1, 1]", "[1, 1]");
    write(&place, "drop.toml", &plane);
    assert!(run(&place, "drop.toml", "1").0);
    let exactly = |update: &str| run_with(&place, "drop.toml", update, &[("EXACT", "1")]);
    assert!(exactly("").0);
    let path = place.path().join("goldens/drop/frame_00002.png");
    let mut picture = Pixels::read(&path).expect("a picture");
    picture.bytes[0] ^= 1;
    let texts = picture.label.expect("its metadata").texts();
    std::fs::write(&path, encode(picture.size, &picture.bytes, &texts, Compression::Small)).expect("a picture");
    assert!(run(&place, "drop.toml", "").0);
    let (passed, text) = exactly("");
    assert!(!passed && text.contains("unequal pixels: 1, but none are allowed without lit bodies"), "{text}");
    let (passed, text) = exactly("1");
    assert!(passed && text.contains("drop: accepted goldens/drop/frame_00002.png"), "{text}");
    assert!(exactly("").0);
}

#[test]
fn goldens_that_no_scene_stands_for_and_scenes_that_are_none_fail() {
    if !can_draw() {
        return;
    }
    let place = tempfile::tempdir().expect("a folder");
    write(&place, "one.toml", SCENE);
    write(&place, "two.toml", SCENE);
    assert!(run(&place, "one.toml two.toml", "1").0);
    let (passed, text) = run(&place, "one.toml", "1");
    assert!(!passed && text.contains("two: no scene of this test has this golden; delete goldens/two"), "{text}");
    std::fs::remove_dir_all(place.path().join("goldens/two")).expect("a golden");
    write(&place, "two.toml", "body = 7");
    let (passed, text) = run(&place, "one.toml two.toml one.toml three.toml", "");
    assert!(!passed && text.contains("two: two.toml:1:"), "{text}");
    assert!(text.contains("one: two scenes of this name share one golden"), "{text}");
    assert!(text.contains("three: ") && text.contains("three.toml"), "{text}");
    // A truncated picture fails.
    let picture = place.path().join("goldens/one/frame_00002.png");
    let bytes = std::fs::read(&picture).expect("a picture");
    std::fs::write(&picture, &bytes[..bytes.len() / 2]).expect("a picture");
    let (passed, text) = run(&place, "one.toml", "");
    assert!(!passed && text.contains("damaged or cut short") && text.contains("UPDATE_GOLDENS=1"), "{text}");
    assert!(run(&place, "one.toml", "1").0 && run(&place, "one.toml", "").0);
}

#[test]
fn without_an_adapter_states_are_compared() {
    if !can_draw() || !cfg!(target_os = "linux") {
        return;
    }
    let place = tempfile::tempdir().expect("a folder");
    write(&place, "drop.toml", SCENE);
    assert!(run(&place, "drop.toml", "1").0);
    let blind = |require: &str| {
        let mut command = Command::new(std::env::current_exe().expect("this test"));
        command.args(["--exact", "suite::of_another_project", "--ignored", "--nocapture"]).current_dir(place.path());
        command.env("SCENES", "drop.toml").env("VK_DRIVER_FILES", Path::new("/nowhere.json"));
        command
            .env("VK_ICD_FILENAMES", "/nowhere.json")
            .env("LOCALSHAPE_REQUIRE_GPU", require)
            .env("UPDATE_GOLDENS", "");
        let output = command.output().expect("this test starts");
        (output.status.success(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (passed, text) = blind("");
    assert!(passed && text.contains("states are compared, but no pictures"), "{text}");
    assert!(!blind("1").0);
    // Missing or damaged files fail without a picture, too.
    let golden = place.path().join("goldens/drop");
    std::fs::rename(&golden, place.path().join("kept")).expect("a golden");
    let (passed, text) = blind("");
    assert!(!passed && text.contains("the golden goldens/drop is missing"), "{text}");
    std::fs::rename(place.path().join("kept"), &golden).expect("a golden");
    let record = std::fs::read(golden.join("golden.toml")).expect("a record");
    std::fs::remove_file(golden.join("golden.toml")).expect("a record");
    let (passed, text) = blind("");
    assert!(!passed && text.contains("goldens/drop is not a golden"), "{text}");
    std::fs::write(golden.join("golden.toml"), record).expect("a record");
    assert!(blind("").0);
    write(&place, "drop.toml", &SCENE.replace("1e4", "1.0001e4").replace("0.1, 0, 0]", "0.1, 0.1, 0]"));
    let (passed, text) = blind("");
    assert!(!passed && text.contains("state moved: Local shape, first at frame 0"), "{text}");
}
