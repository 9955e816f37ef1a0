//! `compare` with a scene or a figure: drawn, compared with its golden, accepted.

use crate::cli::support::{Place, SMALL, frame_file, lasting, run};
use localshape::gpu::{AdapterChoice, Gpu};
use localshape::internals::Pixels;
use localshape::internals::skipped;

/// A place with `small.toml`, if there is a graphics adapter.
fn place() -> Option<Place> {
    match Gpu::new(&AdapterChoice::Cpu) {
        Ok(_) => Some(Place::with_small()),
        Err(error) if std::env::var_os("LOCALSHAPE_REQUIRE_GPU").is_some() => panic!("{error}"),
        Err(error) => {
            skipped(&error.to_string());
            None
        }
    }
}

/// A place with the golden of `small.toml` in `golden/`.
fn with_golden() -> Option<Place> {
    let place = place()?;
    place.run("compare --bless golden small.toml").good();
    Some(place)
}

#[test]
fn a_golden_is_made_and_passes_until_the_state_moves() {
    let Some(place) = place() else { return };
    let missing = place.run("compare golden small.toml");
    let told = "the golden golden is missing\nmake it with: localshape compare --bless golden small.toml\n";
    assert_eq!((missing.status, missing.out.as_str()), (Some(1), told));
    let made = place.run("compare --bless golden small.toml").good();
    assert!(made.out.ends_with("accepted golden/frame_00006.png\naccepted golden/golden.toml\n"), "{made:?}");
    let names = ["frame_00002.png", "frame_00004.png", "frame_00006.png", "golden.toml"];
    assert_eq!(place.names("golden"), names);
    let same = place.run("compare golden small.toml").good();
    assert_eq!(same.out, "3 pictures: 3 identical\n14 states are the same\n");
    let nothing = place.run("compare --bless golden small.toml").good();
    assert!(nothing.out.ends_with("nothing to accept\n"), "{nothing:?}");
    // It must not be in a folder with other files.
    place.write("other/notes.txt", "mine");
    place.run("compare --bless other small.toml").bad(2, &["other is not a golden", "notes.txt"]);
    place.run("compare other small.toml").bad(2, &["other is not a golden", "notes.txt"]);
    assert_eq!(place.names("other"), ["notes.txt"]);

    // Moved states are reported, and accepted with the same words.
    place.write("small.toml", &SMALL.replace("restitution = 0.5", "restitution = 0.2"));
    let moved = place.run("compare golden small.toml --json");
    assert_eq!(moved.status, Some(1));
    let moved = moved.json();
    assert_eq!(moved["verdict"].as_str(), Some("state moved"));
    for run in moved["moved"].as_array().unwrap() {
        assert_eq!((run["change"].as_str(), run["first"].as_u64()), (Some("moved"), Some(1)), "{run}");
        let [distance, precision] = ["distance", "precision"].map(|key| run["largest"][key].as_f64().unwrap());
        assert!(distance > 1e-3 && precision < 1e-4, "{run}");
    }
    let accepted = place.run("compare --bless golden small.toml").good();
    for told in [
        "state moved: Local shape, first at frame 1: node ",
        "changed: obstacle[0].restitution: 0.5 → 0.2\n",
        "accepted: state moved: Local shape, first at frame 1: node ",
        "accepted: state moved: Mass-spring, first at frame 1: node ",
        "accepted golden/golden.toml\n",
    ] {
        assert!(accepted.out.contains(told), "{told}: {accepted:?}");
    }
    place.run("compare golden small.toml").good();
}

/// Changed keys are named, even if states moved because of another run's key: `step = "T/50"` is a fraction of the
/// cycle of the stiffest run.
#[test]
fn changed_keys_are_named() {
    let Some(place) = with_golden() else { return };
    let stiffer = SMALL.replace("1e4, damping_ratio = 0.1, springs", "2e4, damping_ratio = 0.1, springs");
    place.write("small.toml", &stiffer);
    let told = place.run("compare golden small.toml").out;
    let changed: Vec<_> = told.lines().filter(|line| line.starts_with("changed: ")).collect();
    assert_eq!(changed[0], "changed: run[1].model.stiffness: 10000 → 20000", "{told}");
    for (line, run) in changed[1..].iter().zip(0..) {
        assert!(line.starts_with(&format!("changed: run[{run}].step: 0.00125")), "{line}");
        assert!(line.contains(" s → 0.00088") && line.ends_with(" s"), "{line}");
    }
    assert!(changed.len() == 3 && told.contains("state moved: Local shape, first at frame"), "{told}");
    let document = place.run("compare golden small.toml --json").json();
    assert_eq!(document["keys"][0]["key"], "run[1].model.stiffness");
    assert_eq!(document["keys"][0]["after"], "20000");
    // A key without an effect is reported, but is not a failure.
    place.write("small.toml", &(SMALL.to_owned() + "theme = 'light'\n"));
    let same = place.run("compare golden small.toml").good();
    assert!(same.out.starts_with("changed: view.theme: not given → \"light\"\n"), "{same:?}");
    // Another file is reported, too.
    place.write("other.toml", SMALL);
    let other = place.run("compare golden other.toml").good();
    assert!(other.out.contains("the golden is of small.toml, and this is other.toml\n"), "{other:?}");
}

/// Positions of at least ten frames are recorded, from the first to the last, for any drawn frames.
#[test]
fn positions_are_known_all_the_way() {
    let Some(place) = place() else { return };
    place.write("small.toml", &lasting("0.5"));
    place.run("compare --bless golden small.toml").good();
    let record: toml::Table = place.read("golden/golden.toml").parse().unwrap();
    let of = |table: &str, run: &str| -> Vec<u64> {
        let lines = record[table].as_str().unwrap().lines().map(|line| line.split(' ').collect::<Vec<_>>());
        lines.filter(|words| run.is_empty() || words[1] == run).map(|words| words[0].parse().unwrap()).collect()
    };
    assert_eq!(of("digests", ""), (0..=30).collect::<Vec<_>>());
    for run in ["0", "1"] {
        assert_eq!(of("positions", run), (0..=10).map(|at| 3 * at).collect::<Vec<_>>());
    }
}

#[test]
fn drawing_is_never_taken_for_physics() {
    let Some(place) = with_golden() else { return };
    // Another width of the driver's vectors.
    for width in ["256", "512"] {
        let mut command = place.command(["compare", "golden", "small.toml"]);
        let wide = run(command.env("LP_NATIVE_VECTOR_WIDTH", width));
        assert!(wide.status == Some(0) && wide.out.contains("14 states are the same"), "{width}: {wide:?}");
    }
    // Other settings of PNG.
    let path = place.path("golden/frame_00004.png");
    let pixels = Pixels::read(&path).unwrap();
    std::fs::create_dir(place.path("fast")).unwrap();
    let fast = frame_file(pixels.size, &pixels.bytes, pixels.label.as_ref().unwrap());
    assert_ne!(fast.len(), std::fs::read(&path).unwrap().len());
    std::fs::write(place.path("fast/frame_00004.png"), fast).unwrap();
    let same = place.run("compare golden/frame_00004.png fast/frame_00004.png").good();
    assert_eq!(same.out, "frame_00004.png: identical\n");
    // Other colours.
    place.write("small.toml", &(SMALL.to_owned() + "theme = 'dark'\n"));
    let dark = place.run("compare golden small.toml");
    assert!(dark.out.contains("drawn differently") && dark.out.contains("14 states are the same"), "{dark:?}");
    // A body lighter by 3 of 255 also fails.
    let body = pixels.bytes.chunks(3).flat_map(|pixel| {
        let lighter = if pixel[0] < 200 { 3 } else { 0 };
        pixel.iter().map(move |byte| byte + lighter)
    });
    let lighter = frame_file(pixels.size, &body.collect::<Vec<_>>(), pixels.label.as_ref().unwrap());
    std::fs::write(place.path("fast/frame_00004.png"), lighter).unwrap();
    let lighter = place.run("compare golden/frame_00004.png fast/frame_00004.png");
    assert!(lighter.out.contains("drawn differently: 0 pixels differ by more than 16 of 255"), "{lighter:?}");
    // So they are accepted without a message about states.
    let accepted = place.run("compare --bless golden small.toml").good();
    assert_eq!(accepted.out.matches("accepted golden/").count(), 4, "{accepted:?}");
    assert!(!accepted.out.contains("state moved"), "{accepted:?}");
    place.run("compare golden small.toml").good();
}

#[test]
fn only_what_failed_is_rewritten() {
    let Some(place) = with_golden() else { return };
    let made = |name: &str| std::fs::metadata(place.path(format!("golden/{name}"))).unwrap().modified().unwrap();
    let names = ["frame_00002.png", "frame_00006.png", "golden.toml"];
    let before = names.map(made);
    let whole = std::fs::read(place.path("golden/frame_00004.png")).unwrap();
    std::fs::remove_file(place.path("golden/frame_00004.png")).unwrap();
    let missing = place.run("compare golden small.toml");
    assert!(missing.status == Some(1) && missing.out.contains("frame_00004.png: extra"), "{missing:?}");
    place.run("compare --bless golden small.toml").good();
    assert!(std::fs::read(place.path("golden/frame_00004.png")).unwrap() == whole);
    assert_eq!(names.map(made), before);
    // A damaged picture fails.
    place.write("golden/frame_00004.png", &whole[..200]);
    let damaged = place.run("compare golden small.toml");
    assert!(damaged.out.contains("frame_00004.png: unreadable: golden/frame_00004.png: "), "{damaged:?}");
    place.run("compare --bless golden small.toml").good();
    assert_eq!(names.map(made), before);
    // A picture that the scene does not have is removed, and files outside the golden are kept.
    place.write("golden/frame_00003.png", &whole);
    let strange = place.run("compare golden small.toml");
    assert!(strange.status == Some(1) && strange.out.contains("frame_00003.png: missing"), "{strange:?}");
    let accepted = place.run("compare --bless golden small.toml").good();
    assert!(accepted.out.ends_with("\nremoved golden/frame_00003.png\n"), "{accepted:?}");
    assert_eq!(names.map(made), before);
    place.run("compare golden small.toml").good();
}

#[test]
fn whatever_is_lost_is_no_pass() {
    let Some(place) = with_golden() else { return };
    let record = place.read("golden/golden.toml");
    // Another digest of a frame without a picture.
    let line = record.lines().find(|line| line.starts_with("5 ")).unwrap().to_owned();
    let digit = line.chars().last().unwrap();
    let other = format!("{}{}", &line[..line.len() - 1], if digit == '0' { '1' } else { '0' });
    place.write("golden/golden.toml", &record.replace(&line, &other));
    let moved = place.run("compare golden small.toml");
    assert!(moved.status == Some(1) && moved.out.contains("state moved: Mass-spring, first at frame 5"), "{moved:?}");
    place.write("golden/golden.toml", &record);
    // A picture replaced by another one.
    std::fs::copy(place.path("golden/frame_00002.png"), place.path("golden/frame_00004.png")).unwrap();
    let other = place.run("compare golden small.toml");
    let told = "frame_00004.png: state moved: Local shape, Mass-spring; it shows frame 4 instead of frame 2\n";
    assert!(other.status == Some(1) && other.out.contains(told), "{other:?}");
    place.run("compare --bless golden small.toml").good();
    // A record of another version is renewed, with the pictures kept.
    place.write("golden/golden.toml", &record.replace("format = 2", "format = 1"));
    place
        .run("compare golden small.toml")
        .bad(2, &["golden/golden.toml cannot be read: it has the format 1", "--bless"]);
    let accepted = place.run("compare --bless golden small.toml").good();
    assert!(accepted.out.starts_with("golden/golden.toml cannot be read: it has the format 1"), "{accepted:?}");
    assert!(accepted.out.ends_with("\naccepted golden/golden.toml\n"), "{accepted:?}");
    assert_eq!(place.read("golden/golden.toml"), record);
    // A golden without a record is renewed, too.
    std::fs::remove_file(place.path("golden/golden.toml")).unwrap();
    place.run("compare golden small.toml").bad(2, &["golden is not a golden"]);
    place.run("compare --bless golden small.toml").bad(2, &["golden is not a golden"]);
}

#[test]
fn figures_have_goldens_too() {
    let Some(place) = place() else { return };
    place.write(
        "sheet.toml",
        "size = [360, 240]\n[sheet]\nscene = 'small.toml'\n[[sheet.column]]\ntime = 0.0\n[[sheet.column]]\ntime = 0.1\n\
         [[sheet.row]]\nrun = 'Local shape'\n[[sheet.row]]\nrun = 'Mass-spring'\n",
    );
    let made = place.run("compare --bless golden sheet.toml");
    assert_eq!(made.status, Some(0), "{made:?}");
    assert_eq!(place.names("golden"), ["golden.toml", "sheet.png"]);
    let same = place.run("compare golden sheet.toml").good();
    assert!(same.out.contains("identical") && same.out.contains("4 states are the same"), "{same:?}");
    place.run("figure sheet.toml -o drawn -q").good();
    let pair = place.run("compare drawn/sheet.png drawn/sheet.png").good();
    assert_eq!(pair.out, "sheet.png: identical\n");
    place.write("small.toml", &SMALL.replace("restitution = 0.5", "restitution = 0.2"));
    let moved = place.run("compare golden sheet.toml").out;
    assert!(moved.contains("state moved: Two cubes · Local shape, row 1, column 2"), "{moved}");
    assert!(!moved.contains("column 1"), "{moved}");
    assert!(moved.contains("changed: small: obstacle[0].restitution: 0.5 → 0.2\n"), "{moved}");
    let sheet = place.read("sheet.toml");
    place.write("sheet.toml", &sheet.replace("time = 0.1", "time = 0.05"));
    let moved = place.run("compare golden sheet.toml").out;
    assert!(moved.contains("changed: sheet.column[1].time: 0.1 → 0.05\n"), "{moved}");
}

#[test]
fn scenes_that_end_earlier() {
    let Some(place) = place() else { return };
    // A camera that follows shows bodies at another scale in a shorter scene.
    place.write("small.toml", &lasting("0.1"));
    place.run("compare --bless golden small.toml").good();
    place.write("small.toml", &lasting("0.05"));
    let shorter = place.run("compare golden small.toml");
    assert_eq!(shorter.status, Some(1));
    for told in [
        "the golden continues to frame 6, the scene ends with frame 3\n",
        "changed: time.duration: 0.1 → 0.05\n",
        "frame_00006.png: missing",
        "2 of 3 pictures are not as expected\n",
    ] {
        assert!(shorter.out.contains(told), "{told}: {shorter:?}");
    }
    assert!(!shorter.out.contains("state moved"), "{shorter:?}");
    let accepted = place.run("compare --bless golden small.toml").good();
    assert!(accepted.out.contains("removed golden/frame_00006.png\n"), "{accepted:?}");
    place.run("compare golden small.toml").good();
    place.write("small.toml", &lasting("0.1"));
    let longer = place.run("compare golden small.toml").good();
    assert!(longer.out.contains("the golden ends with frame 3, the scene continues to frame 6"), "{longer:?}");
    place.run("compare golden absent.toml").bad(2, &["absent.toml: there is no such file"]);
    place.run("compare golden small.toml --adapter nonsense").bad(3, &["nonsense"]);
}
