//! `compare`: results for pictures and folders of them.

use crate::support::{Place, SMALL, frame_file, frame_tags, run};
use localshape::internals::Tags;
use localshape::runner::Runner;
use localshape::scene::{Limits, Scene};

fn picture(adapter: &str, state: &str, frame: u64, bytes: &[u8]) -> Vec<u8> {
    let states = vec![(digest(state), "Local shape".into())];
    let tags = Tags { states, adapter: adapter.into(), ..frame_tags(frame, frame as f64 / 60.0) };
    frame_file([16, 8], bytes, &tags)
}

/// 64 digits.
fn digest(end: &str) -> String {
    format!("{end:0>64}")
}

/// The state of a run, with a complete digest.
const FULL: &str = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef run";

const GREY: [u8; 16 * 8 * 3] = [120; 16 * 8 * 3];

#[test]
fn two_pictures() {
    let place = Place::new();
    let mut other = GREY;
    other[..30].fill(0);
    place.write("a.png", &picture("one", "1", 0, &GREY));
    place.write("b.png", &picture("two", "1", 0, &other));
    place.write("c.png", &picture("one", "2", 0, &GREY));
    assert_eq!(place.run("compare a.png a.png").good().out, "a.png: identical\n");
    let drawn = place.run("compare a.png b.png");
    assert_eq!((drawn.status, drawn.err.as_str()), (Some(1), ""));
    let told = "b.png: same state, drawn differently: another kind of adapter drew it; in objects of one picture only, \
                10 pixels differ (1 may); along silhouettes 0 pixels differ by more than 2 of 255 (none may); between them";
    assert!(drawn.out.starts_with(told), "{drawn:?}");
    assert!(drawn.out.contains("\naccept with: localshape compare --bless a.png b.png\n"), "{drawn:?}");
    let moved = place.run("compare a.png c.png --json");
    assert_eq!(moved.status, Some(1));
    let told: serde_json::Value = serde_json::from_str(&moved.out).unwrap();
    assert_eq!((told["passes"].as_bool(), told["first_moved"].as_str()), (Some(false), Some("c.png")));
    assert_eq!(told["pictures"][0]["verdict"], "state moved");
    assert_eq!(told["pictures"][0]["runs"][0]["run"], "Local shape");
    assert_eq!((told["verdict"].as_str(), told["moved"][0]["first"].as_u64()), (Some("state moved"), Some(0)));
    assert_eq!(told["accept"], "localshape compare --bless-state a.png c.png");
    // The expected moment is reported, not only that the state differs.
    place.write("late.png", &picture("one", "2", 6, &GREY));
    let late = place.run("compare a.png late.png");
    assert!(late.out.contains("\nlate.png shows frame 6 instead of frame 0\n"), "{late:?}");
    // If the page cannot be written, the result is still reported.
    let unwritable = place.run("compare a.png a.png --report none/page.html");
    assert_eq!((unwritable.status, unwritable.out.as_str()), (Some(4), "a.png: identical\n"), "{unwritable:?}");
    let quiet = place.run("compare a.png c.png -q");
    assert_eq!((quiet.status, quiet.out.as_str()), (Some(1), ""));
}

#[test]
fn two_folders() {
    let place = Place::new();
    for frame in 0..5 {
        place.write(&format!("was/frame_{frame:05}.png"), &picture("one", "1", frame, &GREY));
        let state = if frame < 3 { "1" } else { "2" };
        place.write(&format!("is/frame_{frame:05}.png"), &picture("one", state, frame, &GREY));
    }
    place.write("was/gone.png", &picture("one", "1", 9, &GREY));
    place.write("is/new.png", &picture("one", "1", 9, &GREY));
    place.write("is/diagnostics.csv", b"no picture");
    let found = place.run("compare was is");
    assert_eq!(found.status, Some(1));
    assert_eq!(
        found.out,
        "state moved: Local shape, first at frame 3; how far nodes moved is known only with states.npz on both sides (--states)\n\
         frame_00003.png: state moved: Local shape\n\
         frame_00004.png: state moved: Local shape\n\
         gone.png: missing\n\
         new.png: extra\n\
         state moved: 4 of 7 pictures are not as expected\n\
         the first picture whose state moved is frame_00003.png\n\
         accept with: localshape compare --bless-state was is\n"
    );
    let same = place.run("compare was was").good();
    assert_eq!(same.out, "6 pictures: 6 identical\n");
}

#[test]
fn another_scene_file_is_mentioned_and_no_difference() {
    let place = Place::new();
    let tags = |scene: &str| Tags { scenes: vec![scene.into()], ..frame_tags(0, 0.0) };
    place.write("a.png", &frame_file([16, 8], &GREY, &tags("5")));
    place.write("b.png", &frame_file([16, 8], &GREY, &tags("6")));
    let ran = place.run("compare a.png b.png").good();
    assert_eq!(ran.out, "b.png: identical\nthe scene files are not the same\n");
}

#[test]
fn accepting_rewrites_only_what_failed_and_states_only_if_asked() {
    let place = Place::new();
    let mut other = GREY;
    other[..60].fill(0);
    for (name, state, bytes) in [("same", "1", &GREY), ("drawn", "1", &other), ("moved", "2", &GREY)] {
        place.write(&format!("was/{name}.png"), &picture("one", "1", 0, &GREY));
        place.write(&format!("is/{name}.png"), &picture("one", state, 0, bytes));
    }
    place.write("was/gone.png", &picture("one", "1", 0, &GREY));
    let before = std::fs::read(place.path("was/drawn.png")).unwrap();
    let refused = place.run("compare --bless was is");
    refused.bad(1, &["the state moved, so nothing was accepted", "localshape compare --bless-state was is"]);
    assert_eq!(std::fs::read(place.path("was/drawn.png")).unwrap(), before, "all or nothing");
    let written = |name: &str| std::fs::metadata(place.path(name)).unwrap().modified().unwrap();
    let kept = written("was/same.png");
    let accepted = place.run("compare --bless-state was is");
    assert_eq!(accepted.status, Some(1), "one is missing: {accepted:?}");
    let told = "accepted was/drawn.png\naccepted was/moved.png\nwas/gone.png is missing in is and was left\n";
    assert!(accepted.out.ends_with(told), "{accepted:?}");
    assert_eq!(written("was/same.png"), kept);
    assert_eq!(place.names("was"), ["drawn.png", "gone.png", "moved.png", "same.png"]);
    // Missing pictures are still reported, and there is nothing to accept.
    let missed = place.run("compare was is");
    assert!(missed.status == Some(1) && !missed.out.contains("accept with"), "{missed:?}");
    assert_eq!(place.run("compare --bless was is").status, Some(1));
    std::fs::create_dir(place.path("empty")).unwrap();
    let empty = place.run("compare was empty");
    assert!(empty.out.ends_with("\nempty has no PNG picture; to compare with a scene, name its file\n"), "{empty:?}");
    std::fs::remove_file(place.path("was/gone.png")).unwrap();
    place.run("compare was is").good();
    let nothing = place.run("compare --bless was is").good();
    assert!(nothing.out.ends_with("nothing to accept\n"), "{nothing:?}");
}

#[test]
fn what_is_missing_fails_with_the_command_that_makes_it() {
    let place = Place::new();
    place.write("is/a.png", &picture("one", "1", 0, &GREY));
    for (expected, actual) in [("was", "is"), ("was.png", "is/a.png")] {
        // A path that was mistyped is told alike on both sides.
        let words = format!("{expected} does not exist; expected a picture or a folder of pictures");
        place.run(&format!("compare {expected} {actual}")).bad(4, &[&words]);
        place.run(&format!("compare {actual} {expected}")).bad(4, &[&words]);
        place.run(&format!("compare --bless {actual} {expected}")).bad(4, &[&words]);
        place.run(&format!("compare --bless {expected} {actual}")).good();
        place.run(&format!("compare {expected} {actual}")).good();
    }
    // An empty folder is filled on request. A path with spaces is quoted, so that it can be pasted.
    std::fs::create_dir(place.path("my golden")).unwrap();
    let ran = run(&mut place.command(["compare", "my golden", "is"]));
    assert!(ran.out.ends_with("localshape compare --bless 'my golden' is\n"), "{ran:?}");
}

#[test]
fn no_damaged_picture_is_ever_accepted() {
    let place = Place::new();
    place.write("was.png", &picture("one", "1", 0, &GREY));
    place.write("cut.png", &picture("one", "1", 0, &GREY)[..60]);
    place.run("compare --bless-state was.png cut.png").bad(1, &["nothing was accepted", "cut.png", "cut short"]);
    place.run("compare --bless new.png cut.png").bad(1, &["nothing was accepted", "cut.png", "cut short"]);
    place.write("some/cut.png", &picture("one", "1", 0, &GREY)[..60]);
    place.write("none/whole.png", &picture("one", "1", 0, &GREY));
    place.run("compare --bless-state none some").bad(1, &["nothing was accepted", "cut.png", "cut short"]);
    assert!(!place.path("new.png").exists() && place.names("none") == ["whole.png"]);
    // A damaged golden can be renewed, with a message that its state is lost.
    place
        .run("compare --bless cut.png was.png")
        .bad(1, &["the expected side is damaged", "--bless-state cut.png was.png"]);
    place.run("compare --bless-state cut.png was.png").good();
    assert_eq!(place.run("compare cut.png was.png").good().out, "was.png: identical\n");
}

/// The states of a scene in a folder with its name, with grey frames.
fn put_scene(place: &Place, name: &str) {
    place.run(&format!("simulate {name}.toml --states -o {name} -q")).good();
    let scene = Scene::load(&place.path(format!("{name}.toml")), &Limits::default()).unwrap();
    let mut runner = Runner::new(&scene, &[0, 1]);
    for index in 0..=scene.last_frame() {
        let tags = Tags::of_frame(&scene, &runner.frame(index), "one");
        place.write(&format!("{name}/frame_{index:05}.png"), &frame_file([16, 8], &GREY, &tags));
    }
}

/// `step = "T/50"` is a fraction of the period of the stiffest run, so another stiffness of one run changes the others.
#[test]
fn a_run_that_moved_with_the_step_of_a_stiffer_one_says_so() {
    let place = Place::with_small();
    let spring = "stiffness = 1e4, damping_ratio = 0.1, springs";
    place.write("stiffer.toml", &SMALL.replace(spring, &spring.replace("1e4", "2e4")));
    ["small", "stiffer"].into_iter().for_each(|name| put_scene(&place, name));
    let step = |name: &str| place.json(&format!("{name}/run.json"))["runs"][0]["time_step"].as_f64().unwrap();
    let [before, after] = ["small", "stiffer"].map(step);
    assert!((before / after - 2_f64.sqrt()).abs() < 1e-12);
    let told = |folders: &str| place.run(&format!("compare {folders}")).out;
    let line = |folders: &str| told(folders).lines().find(|line| line.contains("Local shape")).unwrap().to_owned();
    let found = line("small stiffer");
    assert!(found.starts_with("state moved: Local shape, first at frame 1: node "), "{found}");
    let words = "; its step changed from 0.001257 s to 0.0008886 s (T/50 of the stiffest run)";
    assert!(found.ends_with(words), "{found}");
    let document = place.run("compare small stiffer --json").json();
    let change = &document["moved"][0]["step"];
    assert_eq!((change["before"].as_f64(), change["after"].as_f64()), (Some(before), Some(after)));
    assert_eq!(change["parts"], 50.0);
    // The same for two single pictures.
    let pair = told("small/frame_00003.png stiffer/frame_00003.png");
    assert!(pair.starts_with("frame_00003.png: state moved: Local shape, node "), "{pair}");
    assert!(pair.contains("\nLocal shape: its step changed from "), "{pair}");
    assert!(pair.contains("frame_00003.png shows frame 3 at 0.04976 s instead of 0.05027 s\n"), "{pair}");
    // Nothing is reported that is not known of these pictures.
    let summary = place.read("small/run.json");
    let (step, cycle) = ("\"time_step\":", "\"cycle\":");
    assert!(summary.contains(step) && summary.contains(cycle));
    for other in [
        place.read("stiffer/run.json"),
        summary.replace(step, "\"none\":"),
        summary.replace(cycle, "\"none\":"),
        "{}".into(),
    ] {
        place.write("small/run.json", &other);
        assert!(!line("small stiffer").contains("step"), "{other}");
    }
}

#[test]
fn exact_states_tell_node_distance_and_first_frame() {
    let place = Place::new();
    let steady = SMALL.replace("\"T/50\"", "0.0012");
    // The other run is unchanged.
    let spring = "stiffness = 1e4, damping_ratio = 0.1, springs";
    place.write("steady.toml", &steady);
    place.write("stiffer.toml", &steady.replace(spring, &spring.replace("1e4", "1.1e4")));
    ["steady", "stiffer"].into_iter().for_each(|name| put_scene(&place, name));
    let found = place.run("compare steady stiffer --json").json();
    let [moved] = &found["moved"].as_array().unwrap()[..] else { panic!("one run: {found}") };
    // The floor is touched in the first step, and then the springs act.
    assert_eq!((moved["run"].as_str(), moved["first"].as_u64()), (Some("Mass-spring"), Some(1)));
    assert_eq!(moved["displacement"]["precision"], 0.0);
    // The distance computed from the archives.
    let positions = |name: &str, frame: u64| {
        let scene = Scene::load(&place.path(format!("{name}.toml")), &Limits::default()).unwrap();
        Runner::new(&scene, &[1]).frame(frame).runs[0].snapshot.position.clone()
    };
    for key in ["displacement", "largest"] {
        let displacement = &moved[key];
        let [frame, node] = ["frame", "node"].map(|key| displacement[key].as_u64().unwrap());
        let [before, after] = ["steady", "stiffer"].map(|name| positions(name, frame));
        let distances: Vec<f64> = before.iter().zip(&after).map(|(a, b)| a.distance(*b)).collect();
        assert_eq!(displacement["distance"].as_f64(), Some(distances[node as usize]), "{key}");
        assert!(distances.iter().all(|&distance| distance <= distances[node as usize]), "{key}");
    }
    assert!(moved["largest"]["distance"].as_f64() >= moved["displacement"]["distance"].as_f64());
    let told = place.run("compare steady stiffer").out;
    assert!(told.starts_with("state moved: Mass-spring, first at frame 1: node "), "{told}");
    // One picture of each, with the archives beside them.
    let pair = place.run("compare steady/frame_00006.png stiffer/frame_00006.png").out;
    assert!(pair.starts_with("frame_00006.png: state moved: Mass-spring, node "), "{pair}");
    // Archives that do not match the pictures beside them are not used.
    std::fs::copy(place.path("stiffer/states.npz"), place.path("steady/states.npz")).unwrap();
    let told = place.run("compare steady stiffer").out;
    assert!(
        told.contains("steady: states.npz does not belong to these pictures; frame 1 shows another state\n"),
        "{told}"
    );
    assert!(told.contains("known only with states.npz on both sides"), "{told}");
    for (bytes, words) in [(&b"PK\x03\x04"[..], "damaged"), (b"", "is empty")] {
        std::fs::write(place.path("steady/states.npz"), bytes).unwrap();
        let told = place.run("compare steady stiffer").out;
        assert!(told.contains("steady: states.npz ") && told.contains(words), "{told}");
    }
    // Accepted frames include their states.
    place.run("compare --bless-state steady stiffer").good();
    for name in ["states.npz", "run.json", "diagnostics.csv"] {
        let [one, other] = ["steady", "stiffer"].map(|folder| std::fs::read(place.path(format!("{folder}/{name}"))));
        assert!(one.unwrap() == other.unwrap(), "{name}");
    }
    place.run("compare steady stiffer").good();
}

/// Without knowledge of the adapters, a difference between pictures is a failure.
#[test]
fn foreign_pictures_pass_only_if_they_are_equal() {
    let place = Place::new();
    let foreign = |bytes: &[u8]| {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, 16, 8);
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header().unwrap().write_image_data(bytes).unwrap();
        file
    };
    let mut other = GREY;
    other[50] += 1;
    for (name, bytes) in [("was/a.png", &GREY), ("same/a.png", &GREY), ("other/a.png", &other)] {
        place.write(name, &foreign(bytes));
    }
    for end in ["", "/a.png"] {
        let same = place.run(&format!("compare was{end} same{end}")).good();
        assert_eq!(same.out, "a.png: no state recorded (the pixels are equal)\n");
        let differs = place.run(&format!("compare was{end} other{end}"));
        let told = "a.png: no state recorded (pixels only): 1 pixel differs, by up to 1 of 255; none may, because neither names its adapter\n";
        assert!(differs.status == Some(1) && differs.out.starts_with(told), "{differs:?}");
    }
}

/// Additional pictures are a failure, even if all expected ones are there.
#[test]
fn a_run_that_only_the_new_side_has_is_no_pass() {
    let place = Place::new();
    let with = |runs: &[&str]| {
        let states = runs.iter().map(|run| (digest("1"), (*run).to_owned())).collect();
        frame_file([16, 8], &GREY, &Tags { states, ..frame_tags(0, 0.0) })
    };
    place.write("was/a.png", &with(&["one"]));
    place.write("is/a.png", &with(&["one", "other"]));
    for (folders, change) in [("was is", "new"), ("is was", "gone")] {
        let ran = place.run(&format!("compare {folders}"));
        let told = format!("state moved: other is {change}\na.png: state moved: other\n");
        assert!(ran.status == Some(1) && ran.out.starts_with(&told), "{ran:?}");
    }
}

#[test]
fn a_report_is_one_file() {
    let place = Place::new();
    place.write("a.png", &picture("one", "1", 0, &GREY));
    place.write("c.png", &picture("one", "2", 0, &GREY));
    let ran = place.run("compare a.png c.png --report page.html -q");
    assert_eq!((ran.status, ran.out.as_str(), ran.err.as_str()), (Some(1), "", ""));
    let page = place.read("page.html");
    assert!(page.starts_with("<!doctype html>") && page.contains("--bless-state a.png c.png"), "{}", &page[..200]);
    place.run("compare a.png c.png --report none/page.html -q").bad(4, &["none/page.html"]);
    place
        .run("compare a.png c.png --report a.png/page.html -q")
        .bad(4, &["error: --report: a.png is a file, not a folder; name a file elsewhere\n"]);
    #[cfg(unix)]
    {
        run(std::process::Command::new("mkfifo").arg(place.path("pipe"))).good();
        place.run("compare a.png c.png --report pipe/page.html -q").bad(4, &["pipe is a pipe, not a folder"]);
    }
    // An earlier page is replaced, and nothing else.
    assert_eq!(place.run("compare a.png c.png --report page.html -q").status, Some(1));
    place.write("precious.toml", "body = 7");
    for name in ["precious.toml", "a.png", "."] {
        place.run(&format!("compare a.png c.png --report {name} -q")).bad(2, &["not a page of a comparison"]);
    }
    assert_eq!(place.read("precious.toml"), "body = 7");
}

#[test]
fn what_is_no_picture_never_passes() {
    let place = Place::new();
    let whole = picture("one", "1", 0, &GREY);
    place.write("whole.png", &whole);
    let mut flipped = whole.clone();
    let middle = whole.len() - 30;
    flipped[middle] ^= 0x55;
    let mut header_lies = whole.clone();
    header_lies[16..24].copy_from_slice(&[0x7f, 0, 0, 0, 0x7f, 0, 0, 0]);
    // The header with another size, or interlaced, with a valid checksum.
    let header = |change: &dyn Fn(&mut [u8])| {
        let mut file = whole.clone();
        change(&mut file);
        let checksum = crc32(&file[12..29]);
        file[29..33].copy_from_slice(&checksum.to_be_bytes());
        file
    };
    let huge =
        header(&|file| [16, 20].into_iter().for_each(|at| file[at..at + 4].copy_from_slice(&20_000_u32.to_be_bytes())));
    let interlaced = header(&|file| file[28] = 1);
    let with = |set: &dyn Fn(&mut png::Encoder<'_, &mut Vec<u8>>), bytes: usize| {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, 16, 8);
        encoder.set_color(png::ColorType::Rgb);
        set(&mut encoder);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(&vec![0; bytes]).unwrap();
        writer.finish().unwrap();
        file
    };
    let text = |keyword: &'static str, text: &'static str| {
        with(&|encoder| encoder.add_text_chunk(keyword.into(), text.into()).unwrap(), 16 * 8 * 3)
    };
    let states = |frame: &str, states: &str| {
        let chunks =
            [("scene", "5"), ("state", states), ("frame", frame), ("time", "0"), ("version", "1"), ("adapter", "one")];
        with(
            &|encoder| {
                for (name, text) in chunks {
                    encoder.add_text_chunk(format!("localshape:{name}"), text.into()).unwrap();
                }
            },
            16 * 8 * 3,
        )
    };
    // The text chunks of `whole` one after the other, and one of them changed without updating its checksum.
    let at = |what: &[u8]| whole.windows(what.len()).position(|part| part == what).unwrap();
    let (texts, data) = (at(b"tEXtlocalshape:scene") - 4, at(b"IDAT") - 4);
    let mut damaged = whole.clone();
    damaged[texts + 20] ^= 1;
    let twice = [&whole[..data], &whole[texts..]].concat();
    let late = [&whole[..texts], &whole[data..whole.len() - 12], &whole[texts..data], &whole[whole.len() - 12..]];
    let mut sum_lies = whole.clone();
    let end = whole.len() - 12;
    sum_lies[end - 5] ^= 1;
    let checksum = crc32(&sum_lies[data + 4..end - 4]);
    sum_lies[end - 4..end].copy_from_slice(&checksum.to_be_bytes());
    let long: &'static str = Box::leak("a".repeat(5 << 20).into_boxed_str());
    let wrong: [(&str, Vec<u8>, &str); 23] = [
        ("damaged-text.png", damaged, "damaged or cut short (a checksum is wrong)"),
        ("twice.png", twice, "is missing, damaged or there twice"),
        ("late.png", late.concat(), "text chunks after its pixels"),
        ("sum.png", sum_lies, "damaged or cut short"),
        ("long.png", text("comment", long), "carries more than 4 MiB beside its pixels"),
        ("bell.png", states("3", &FULL.replace("run", "r\u{7}n")), "`localshape:state` is missing"),
        ("interlaced.png", interlaced, "is interlaced"),
        ("text.png", b"no picture".to_vec(), "this is not a PNG picture"),
        ("empty.png", Vec::new(), "this is not a PNG picture"),
        ("jpeg.png", b"\xff\xd8\xff\xe0\0\x10JFIF".to_vec(), "this is not a PNG picture"),
        ("cut.png", whole[..whole.len() - 20].to_vec(), "damaged or cut short"),
        ("flipped.png", flipped, "damaged or cut short"),
        ("lies.png", header_lies, "damaged or cut short (a checksum is wrong)"),
        ("huge.png", huge, "20000×20000 pixels"),
        ("deep.png", with(&|encoder| encoder.set_depth(png::BitDepth::Sixteen), 16 * 8 * 6), "16 bits a channel"),
        ("grey.png", with(&|encoder| encoder.set_color(png::ColorType::Grayscale), 16 * 8), "is grey"),
        (
            "palette.png",
            with(
                &|encoder| {
                    encoder.set_color(png::ColorType::Indexed);
                    encoder.set_palette(vec![0; 6]);
                },
                16 * 8,
            ),
            "has a palette",
        ),
        ("animated.png", with(&|encoder| encoder.set_animated(1, 0).unwrap(), 16 * 8 * 3), "is an animation"),
        ("untold.png", text("localshape:version", "1"), "`localshape:frame` is missing"),
        ("frame.png", states("-3", FULL), "`localshape:frame` is missing"),
        ("digest.png", states("3", "no-digest run"), "`localshape:state` is missing"),
        ("short.png", states("3", "ab run"), "`localshape:state` is missing"),
        ("none.png", states("3", ""), "`localshape:state` is missing"),
    ];
    for (name, bytes, words) in wrong {
        place.write(name, &bytes);
        for order in [format!("{name} whole.png"), format!("whole.png {name}")] {
            let ran = place.run(&format!("compare {order}"));
            assert_eq!((ran.status, ran.err.as_str()), (Some(1), ""), "{order}: {ran:?}");
            let told = format!("unreadable: {name}: ");
            assert!(ran.out.contains(&told) && ran.out.contains(words), "{order}: {ran:?}");
        }
    }
}

#[test]
fn what_is_no_file_of_a_picture_is_told_at_once() {
    let place = Place::new();
    place.write("whole.png", &picture("one", "1", 0, &GREY));
    let large = std::fs::File::create(place.path("large.png")).unwrap();
    large.set_len((1 << 29) + 1).unwrap();
    let mut wrong =
        vec![("large.png", "this file has 536870913 bytes; a picture that can be compared has at most 536870912")];
    if cfg!(unix) {
        run(std::process::Command::new("mkfifo").arg(place.path("pipe.png"))).good();
        wrong.push(("pipe.png", "this is not a PNG picture"));
    }
    for (name, words) in wrong {
        for order in [format!("{name} whole.png"), format!("whole.png {name}")] {
            let ran = place.run(&format!("compare {order}"));
            assert!(ran.status == Some(1) && ran.out.contains(&format!("{name}: {words}")), "{order}: {ran:?}");
        }
    }
}

/// The checksum of a part of a PNG file.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |sum: u32, _| if sum & 1 == 1 { (sum >> 1) ^ 0xedb8_8320 } else { sum >> 1 };
    !bytes.iter().fold(!0, |sum, &byte| (0..8).fold(sum ^ u32::from(byte), step))
}

#[test]
fn wrong_words() {
    let place = Place::new();
    place.write("a.png", &picture("one", "1", 0, &GREY));
    std::fs::create_dir(place.path("none")).unwrap();
    place.run("compare a.png b.png").bad(4, &["b.png does not exist"]);
    if cfg!(feature = "render") {
        place.run("compare a.png a.png --size 20x20").bad(2, &["--size is for scenes and figures"]);
    }
    place.write("small.toml", SMALL);
    place.run("compare a.png small.toml").bad(2, &["a.png is not a golden"]);
    place
        .run("compare small.toml none")
        .bad(2, &["small.toml is a scene or figure and must come last: localshape compare none"]);
    std::fs::create_dir(place.path("broken")).unwrap();
    place.write("broken/golden.toml", "format = 7");
    place.run("compare broken small.toml").bad(2, &["broken/golden.toml", "record of a golden cannot be read"]);
    place.write("wrong.toml", "body.lattice = { cells = [1, 1, 1], size = 0.1 }");
    let words = if cfg!(feature = "render") { "`size`" } else { "without the feature `render`" };
    place.run("compare none2 wrong.toml").bad(2, &["wrong.toml", words]);
    place.run("compare none a.png").bad(2, &["none is a folder and a.png is a file"]);
    place.write("full/a.png", &picture("one", "1", 0, &GREY));
    place.run("compare full a.png").bad(2, &["full is a folder and a.png is a file"]);
    place.run("compare none none").bad(2, &["has a PNG picture"]);
    place.run("compare a.png").bad(2, &["<ACTUAL>"]);
}

/// Of pictures whose states moved nobody knows how far, the one with most pixels that differ.
#[test]
fn a_report_opens_at_the_worst_picture() {
    let place = Place::new();
    for (frame, different) in [(0, 0), (1, 30), (2, 90), (3, 60)] {
        let mut other = GREY;
        other[..different].fill(0);
        let state = if different > 0 { "2" } else { "1" };
        place.write(&format!("a/{frame}.png"), &picture("one", "1", frame, &GREY));
        place.write(&format!("b/{frame}.png"), &picture("one", state, frame, &other));
    }
    assert_eq!(place.run("compare a b --report page.html -q").status, Some(1));
    let page = place.read("page.html");
    let data = page.split("id=\"data\">").nth(1).and_then(|rest| rest.split("</script>").next()).expect("the data");
    let data: serde_json::Value = serde_json::from_str(data).expect("JSON");
    assert_eq!((&data["first"], &data["pictures"][2]["name"]), (&2.into(), &"2.png".into()));
}
