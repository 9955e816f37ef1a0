//! `compare` with a scene or a figure: drawn, compared with its golden, accepted.

use crate::support::{Place, SMALL, frame_file, lasting, run, skip};
use localshape::gpu::{AdapterChoice, Gpu};
use localshape::internals::Pixels;

/// A place with `small.toml`, if there is a graphics adapter.
fn place() -> Option<Place> {
    match Gpu::new(&AdapterChoice::Cpu) {
        Ok(_) => Some(Place::with_small()),
        Err(error) if std::env::var_os("LOCALSHAPE_REQUIRE_GPU").is_some() => panic!("{error}"),
        Err(error) => {
            skip(&error.to_string());
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
    // It must not be in a folder with other files.
    place.write("other/notes.txt", "mine");
    let other = place.run("compare other small.toml");
    let told =
        "the golden other is missing\nit cannot be made: other has other files, such as notes.txt; name a folder";
    assert!(other.status == Some(1) && other.out.starts_with(told), "{other:?}");
    place.run("compare --bless other small.toml").bad(1, &["nothing was accepted", "other has other files"]);
    assert_eq!(place.names("other"), ["notes.txt"]);

    // Another stiffness of one run: reports the run, the first frame, the node and the distance.
    let stiffer = SMALL.replace("1e4, damping_ratio = 0.1, springs", "2e4, damping_ratio = 0.1, springs");
    place.write("stiffer.toml", &stiffer.replace("T/50", "T/71"));
    let slower = place.run("compare golden stiffer.toml").out;
    assert!(slower.contains("the scene files are not the same"), "{slower}");
    assert!(slower.contains("state moved: Mass-spring, first at frame"), "{slower}");
    assert!(slower.contains("the golden is of small.toml, and this is stiffer.toml"), "{slower}");
    // Whether a stiffer run changed another is decided by their common time step, unless the golden is too old to have
    // it.
    place.write("small.toml", &stiffer);
    let shared = "(T/50 of the stiffest run)";
    assert_eq!(place.run("compare golden small.toml").out.matches(shared).count(), 2);
    let record = place.read("golden/golden.toml");
    let is_new = |line: &&str| line.starts_with("step = ") || line.starts_with("cycle = ");
    assert_eq!(record.lines().filter(is_new).count(), 4);
    let old: Vec<_> = record.lines().filter(|line| !is_new(line)).collect();
    place.write("golden/golden.toml", &(old.join("\n") + "\n"));
    let untold = place.run("compare golden small.toml").out;
    assert!(untold.contains("state moved: Local shape, first at") && !untold.contains(shared), "{untold}");
    place.write("golden/golden.toml", &record);
    place.write("small.toml", &SMALL.replace("restitution = 0.5", "restitution = 0.2"));
    let moved = place.run("compare golden small.toml --json");
    assert_eq!(moved.status, Some(1));
    let moved = moved.json();
    assert_eq!((moved["verdict"].as_str(), moved["same_scene"].as_bool()), (Some("state moved"), Some(false)));
    for run in moved["moved"].as_array().unwrap() {
        assert_eq!((run["change"].as_str(), run["first"].as_u64()), (Some("moved"), Some(1)), "{run}");
        let [distance, precision] = ["distance", "precision"].map(|key| run["largest"][key].as_f64().unwrap());
        assert!(distance > 1e-3 && precision < 1e-4, "{run}");
    }
    let golden = place.read("golden/golden.toml");
    let refused = place.run("compare --bless golden small.toml");
    refused.bad(1, &["the state moved, so nothing was accepted", "compare --bless-state golden small.toml"]);
    assert_eq!(place.read("golden/golden.toml"), golden);
    place.run("compare --bless-state golden small.toml").good();
    place.run("compare golden small.toml").good();
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
    // Other colours, and other sizes.
    place.write("small.toml", &(SMALL.to_owned() + "theme = 'dark'\n"));
    let dark = place.run("compare golden small.toml");
    assert!(
        dark.out.contains("same state, drawn differently") && dark.out.contains("14 states are the same"),
        "{dark:?}"
    );
    let large = place.run("compare golden small.toml --size 90x64");
    assert!(large.out.contains("same state, drawn differently: 90×64 pixels instead of 96×64"), "{large:?}");
    // So they are accepted without a message about states, and with the requested size.
    let accepted = place.run("compare --bless golden small.toml --size 90x64").good();
    assert_eq!(accepted.out.matches("accepted").count(), 4, "{accepted:?}");
    place.run("compare golden small.toml").good();
}

#[test]
fn only_what_failed_is_rewritten() {
    let Some(place) = with_golden() else { return };
    let made = |name: &str| std::fs::metadata(place.path(format!("golden/{name}"))).unwrap().modified().unwrap();
    let names = ["frame_00002.png", "frame_00006.png", "golden.toml"];
    let before = names.map(made);
    let mut broken = std::fs::read(place.path("golden/frame_00004.png")).unwrap();
    std::fs::remove_file(place.path("golden/frame_00004.png")).unwrap();
    let missing = place.run("compare golden small.toml");
    assert!(missing.status == Some(1) && missing.out.contains("frame_00004.png: extra"), "{missing:?}");
    place.run("compare --bless golden small.toml").good();
    assert_eq!(std::fs::read(place.path("golden/frame_00004.png")).unwrap(), broken);
    assert_eq!(names.map(made), before);
    // A damaged picture fails, and the state that it shows is unknown.
    broken.truncate(200);
    std::fs::write(place.path("golden/frame_00004.png"), broken).unwrap();
    let damaged = place.run("compare golden small.toml");
    assert!(damaged.out.contains("frame_00004.png: unreadable: golden/frame_00004.png: "), "{damaged:?}");
    place.run("compare --bless golden small.toml").bad(1, &["the expected side is damaged", "--bless-state"]);
    place.run("compare --bless-state golden small.toml").good();
    assert_eq!(names.map(made), before);
    place.run("compare golden small.toml").good();
    // The command that accepts it contains the options of this one.
    let other = place.run("compare golden small.toml --size 90x64 --frames 3").out;
    assert!(other.contains("--bless --frames 3 --size 90x64 golden small.toml\n"), "{other}");
    // Nothing outside the golden is changed.
    place.write("precious.png", "precious");
    let record = place.read("golden/golden.toml").replace("\"frame_00002.png\"", "\"../precious.png\"");
    place.write("golden/golden.toml", &record);
    place.run("compare --bless-state golden small.toml").bad(2, &["golden.toml", "not a plain name of a PNG picture"]);
    assert_eq!(place.read("precious.png"), "precious");
}

#[test]
fn whatever_is_lost_is_no_pass() {
    let Some(place) = with_golden() else { return };
    // Pictures without metadata, on either side.
    let stripped = |from: &str, to: &str| {
        let pixels = Pixels::read(&place.path(from)).unwrap();
        let image = image::RgbImage::from_raw(pixels.size[0], pixels.size[1], pixels.bytes).unwrap();
        image.save(place.path(to)).unwrap();
    };
    place.run("render small.toml -o plain --frames 2,4,6 -q").good();
    for frame in [2, 4, 6] {
        let name = format!("plain/frame_0000{frame}.png");
        stripped(&name, &name);
    }
    let untold = place.run("compare golden plain");
    assert!(untold.status == Some(1) && untold.out.contains("of which none is known here"), "{untold:?}");
    place.run("compare --bless golden plain").bad(1, &["nothing was accepted"]);
    // States of some frames in an archive do not hide missing ones of others.
    place.run("render small.toml -o part --states -q").good();
    place.run("simulate small.toml -o first --frames 0-3 --states -q").good();
    for name in ["states.npz", "diagnostics.csv"] {
        std::fs::copy(place.path(format!("first/{name}")), place.path(format!("part/{name}"))).unwrap();
    }
    assert!(place.run("compare golden part").good().out.contains("14 states are the same"));
    let record = place.read("golden/golden.toml");
    let line = record.lines().find(|line| line.starts_with("5 ")).unwrap().to_owned();
    let digit = line.chars().last().unwrap();
    let other = format!("{}{}", &line[..line.len() - 1], if digit == '0' { '1' } else { '0' });
    place.write("golden/golden.toml", &record.replace(&line, &other));
    let moved = place.run("compare golden part");
    assert!(moved.out.contains("state moved: Mass-spring, first at frame 5"), "{moved:?}");
    let moved = place.run("compare golden small.toml");
    assert!(moved.out.contains("state moved: Mass-spring, first at frame 5"), "{moved:?}");
    place.write("golden/golden.toml", &record);
    // Frames of another scene, damaged ones and other files among those that have no picture in the golden.
    place.write("other.toml", &SMALL.replace("restitution = 0.5", "restitution = 0.2"));
    place.run("render small.toml -o mixed --frames 2,4,6 -q").good();
    place.run("render other.toml -o other --frames 1,3,5 -q").good();
    for frame in [1, 3] {
        let name = format!("frame_0000{frame}.png");
        std::fs::copy(place.path(format!("other/{name}")), place.path(format!("mixed/{name}"))).unwrap();
    }
    place.write("mixed/frame_00005.png", "no picture");
    stripped("other/frame_00001.png", "mixed/frame_00000.png");
    let mixed = place.run("compare golden mixed");
    assert_eq!(mixed.status, Some(1));
    for told in [
        "frame_00001.png: state moved",
        "frame_00003.png: state moved",
        "frame_00005.png: unreadable",
        "frame_00000.png: extra",
    ] {
        assert!(mixed.out.contains(told), "{told}: {mixed:?}");
    }
    // A golden whose picture was drawn by another adapter than its record has.
    let strange = record.replacen("adapter = \"", "adapter = \"another ", 1);
    place.write("golden/golden.toml", &strange);
    let ran = place.run("compare golden small.toml");
    assert!(ran.status == Some(1) && ran.out.contains("another adapter drew this picture"), "{ran:?}");
    // And one without its record.
    std::fs::remove_file(place.path("golden/golden.toml")).unwrap();
    place.run("compare golden small.toml").bad(2, &["golden is not a golden"]);
}

#[test]
fn a_golden_that_contradicts_itself_never_passes() {
    let Some(place) = with_golden() else { return };
    let copy = |from: &str, to: &str| std::fs::copy(place.path(from), place.path(to)).map(drop).unwrap();
    copy("golden/frame_00002.png", "golden/frame_00004.png");
    let ran = place.run("compare golden golden");
    assert!(ran.status == Some(1) && ran.out.contains("contradicts itself"), "{ran:?}");
    let ran = place.run("compare golden small.toml");
    assert!(ran.status == Some(1) && ran.out.contains("frame_00004.png: "), "{ran:?}");
    place.run("compare --bless-state golden small.toml").good();
    copy("golden/frame_00002.png", "golden/frame_00003.png");
    let ran = place.run("compare golden golden");
    assert!(ran.status == Some(1) && ran.out.contains("golden.toml does not know this picture"), "{ran:?}");
    place.run("compare --bless golden small.toml").bad(1, &["--bless-state"]);
    let ran = place.run("compare --bless-state golden small.toml");
    assert!(ran.status == Some(0) && ran.out.contains("removed golden/frame_00003.png"), "{ran:?}");
    place.run("compare golden small.toml").good();
}

#[test]
fn a_golden_beside_a_folder_of_frames() {
    let Some(place) = with_golden() else { return };
    place.run("render small.toml -o all --states -q").good();
    let same = place.run("compare golden all").good();
    assert!(
        same.out.contains("3 pictures: 3 identical\n14 states are the same\n4 more frames have no picture"),
        "{same:?}"
    );
    place.write("small.toml", &SMALL.replace("restitution = 0.5", "restitution = 0.2"));
    place.run("render small.toml -o all --states -q --overwrite").good();
    let moved = place.run("compare golden all").out;
    assert!(moved.starts_with("state moved: Local shape, first at frame 1") && moved.contains(" node "), "{moved}");
    let refused = place.run("compare --bless golden all");
    refused.bad(1, &["--bless-state golden all"]);
    place.run("compare --bless-state golden all").good();
    place.run("compare golden small.toml").good();
    // Without the archive most states of the record are missing.
    place.write("small.toml", SMALL);
    place.run("render small.toml -o few --frames 2,4,6 -q").good();
    place.run("compare --bless-state golden few").bad(1, &["the golden records", "--states"]);
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
    assert!(!moved.contains("column 1") && !moved.contains("step"), "{moved}");
    let spring = "1e4, damping_ratio = 0.1, springs";
    place.write("small.toml", &SMALL.replace(spring, &spring.replace("1e4", "2e4")));
    let moved = place.run("compare golden sheet.toml").out;
    let shared = "from 0.001257 s to 0.0008886 s (T/50 of the stiffest run)";
    assert!(
        moved.lines().any(|line| line.contains("Local shape, row 1, column 2") && line.ends_with(shared)),
        "{moved}"
    );
    place.run("compare golden sheet.toml --frames 1").bad(2, &["--frames is for scenes"]);
}

#[test]
fn scenes_that_end_earlier_and_frames_that_are_not_there() {
    let Some(place) = with_golden() else { return };
    // A camera that follows shows bodies at another scale in a shorter scene.
    place.write("small.toml", &lasting("0.1"));
    place.run("compare --bless-state golden small.toml").good();
    place.run("compare --bless early small.toml --frames 1").good();
    place.write("small.toml", &lasting("0.05"));
    // No picture is missing, only states.
    let early = place.run("compare early small.toml");
    assert_eq!(early.status, Some(1), "{early:?}");
    assert!(early.out.contains("frame_00001.png: identical\n"), "{early:?}");
    assert!(early.out.contains("the golden continues to frame 6, the scene ends with frame 3\n"), "{early:?}");
    place.run("compare --bless early small.toml").bad(1, &["the state moved", "--bless-state early small.toml"]);
    let shorter = place.run("compare golden small.toml");
    assert_eq!(shorter.status, Some(1));
    assert!(shorter.out.contains("the golden continues to frame 6, the scene ends with frame 3"), "{shorter:?}");
    assert!(shorter.out.contains("frame_00006.png: missing"), "{shorter:?}");
    assert!(shorter.out.contains("missing: 2 of 3 pictures are not as expected"), "{shorter:?}");
    // Fewer states count as changed states.
    place.run("compare --bless golden small.toml").bad(1, &["the state moved", "--bless-state"]);
    place.run("compare --bless-state golden small.toml").good();
    place.run("compare golden small.toml").good();
    place.write("small.toml", &lasting("0.1"));
    let longer = place.run("compare golden small.toml").good();
    assert!(longer.out.contains("the golden ends with frame 3, the scene continues to frame 6"), "{longer:?}");
    place.write("small.toml", &lasting("0.05"));
    place.run("compare golden small.toml --frames 9").bad(2, &["there is no frame 9; the last one is 3"]);
    place.run("compare golden absent.toml").bad(2, &["absent.toml: there is no such file"]);
    place.run("compare golden small.toml --adapter nonsense").bad(3, &["nonsense"]);
}
