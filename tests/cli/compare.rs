//! `compare`: results for pictures and folders of them.

use crate::cli::support::{Place, SMALL, frame_file, frame_tags, run};
use localshape::internals::Tags;

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
    let told = "b.png: drawn differently: 10 pixels differ by more than 16 of 255 (8 may), 10 by more than 2 (8 may), the mean of \
                16×16 pixels by 9.4 (1.5 may)\n";
    assert_eq!(drawn.out, told);
    let moved = place.run("compare a.png c.png --json");
    assert_eq!(moved.status, Some(1));
    let told: serde_json::Value = serde_json::from_str(&moved.out).unwrap();
    assert_eq!((told["passes"].as_bool(), told["verdict"].as_str()), (Some(false), Some("state moved")));
    assert_eq!(told["pictures"][0]["verdict"], "state moved");
    assert_eq!(told["pictures"][0]["runs"][0], "Local shape");
    // The expected moment is reported, not only the difference.
    place.write("late.png", &picture("one", "2", 6, &GREY));
    let late = place.run("compare a.png late.png");
    assert_eq!(late.out, "late.png: state moved: Local shape; it shows frame 6 instead of frame 0\n");
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
        "state moved: Local shape, first at frame 3\n\
         frame_00003.png: state moved: Local shape\n\
         frame_00004.png: state moved: Local shape\n\
         gone.png: missing\n\
         new.png: extra\n\
         4 of 7 pictures are not as expected\n"
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
    assert_eq!(ran.out, "the scenes are not the same\nb.png: identical\n");
}

/// Pictures of other programs are compared by their pixels, within the same tolerance.
#[test]
fn foreign_pictures_are_compared_by_their_pixels() {
    let place = Place::new();
    let foreign = |bytes: &[u8]| {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, 16, 8);
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header().unwrap().write_image_data(bytes).unwrap();
        file
    };
    let changed = |count: usize| {
        let mut other = GREY;
        other[..3 * count].fill(100);
        other
    };
    for (name, bytes) in
        [("was/a.png", GREY), ("same/a.png", GREY), ("near/a.png", changed(8)), ("other/a.png", changed(9))]
    {
        place.write(name, &foreign(&bytes));
    }
    for end in ["", "/a.png"] {
        let same = place.run(&format!("compare was{end} same{end}")).good();
        assert_eq!(same.out, "a.png: identical (no state recorded)\n");
        let near = place.run(&format!("compare was{end} near{end}")).good();
        assert!(near.out.starts_with("a.png: within tolerance (no state recorded): 8 pixels differ"), "{near:?}");
        let differs = place.run(&format!("compare was{end} other{end}"));
        assert!(
            differs.status == Some(1) && differs.out.starts_with("a.png: no state recorded: 9 pixels"),
            "{differs:?}"
        );
    }
}

/// A PNG file of 16 × 8 equal pixels with these samples.
fn of_kind(colour: png::ColorType, depth: png::BitDepth, pixel: &[u8], palette: &[u8], trns: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, 16, 8);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    if !palette.is_empty() {
        encoder.set_palette(palette);
    }
    if !trns.is_empty() {
        encoder.set_trns(trns);
    }
    encoder.write_header().unwrap().write_image_data(&pixel.repeat(16 * 8)).unwrap();
    file
}

/// One colour in all kinds of PNG files is one picture. Of transparent pixels colour and opacity count.
#[test]
fn pictures_of_every_kind_are_compared() {
    use png::{BitDepth, ColorType};
    let place = Place::new();
    let plain = |red: u8| of_kind(ColorType::Rgb, BitDepth::Eight, &[red, 120, 120], &[], &[]);
    place.write("grey.png", &plain(120));
    let orange = of_kind(ColorType::Rgb, BitDepth::Eight, &[200, 100, 0], &[], &[]);
    place.write("orange.png", &orange);
    let same = |name: &str, file: &[u8]| {
        place.write("other.png", file);
        let ran = place.run(&format!("compare {name} other.png")).good();
        assert_eq!(ran.out, "other.png: identical (no state recorded)\n");
    };
    same("grey.png", &of_kind(ColorType::Grayscale, BitDepth::Eight, &[120], &[], &[]));
    same("grey.png", &of_kind(ColorType::Grayscale, BitDepth::Sixteen, &[120, 120], &[], &[]));
    // 120 of 255 is 30 840 of 65 535, and half of the next step less is rounded to it.
    same("grey.png", &of_kind(ColorType::Grayscale, BitDepth::Sixteen, &[119, 249], &[], &[]));
    same("grey.png", &of_kind(ColorType::GrayscaleAlpha, BitDepth::Eight, &[120, 255], &[], &[]));
    same("orange.png", &of_kind(ColorType::Rgba, BitDepth::Eight, &[200, 100, 0, 255], &[], &[]));
    same("orange.png", &of_kind(ColorType::Rgba, BitDepth::Sixteen, &[200, 200, 100, 100, 0, 0, 255, 255], &[], &[]));
    same("orange.png", &of_kind(ColorType::Rgb, BitDepth::Sixteen, &[200, 200, 100, 100, 0, 0], &[], &[]));
    same("orange.png", &of_kind(ColorType::Indexed, BitDepth::Eight, &[1], &[0, 0, 0, 200, 100, 0], &[]));
    let differs = |name: &str, file: &[u8], words: &str| {
        place.write("other.png", file);
        let ran = place.run(&format!("compare {name} other.png"));
        assert!(ran.status == Some(1) && ran.out.contains(words), "{ran:?}");
    };
    // Wholly transparent orange shows white on white, and black on black.
    let clear = of_kind(ColorType::Rgba, BitDepth::Eight, &[200, 100, 0, 0], &[], &[]);
    place.write("clear.png", &clear);
    place.write("white.png", &of_kind(ColorType::Rgb, BitDepth::Eight, &[255; 3], &[], &[]));
    differs("white.png", &clear, "128 pixels differ by more than 16");
    differs("orange.png", &clear, "128 pixels differ by more than 16");
    same("clear.png", &of_kind(ColorType::Rgba, BitDepth::Eight, &[0, 0, 0, 0], &[], &[]));
    same("clear.png", &of_kind(ColorType::Indexed, BitDepth::Eight, &[0], &[7, 7, 7], &[0]));
    // Half transparent: (200, 100, 0) on white is (227.4, 177.2, 126.9), on black (100.4, 50.2, 0) with 128 of 255.
    let half = of_kind(ColorType::Rgba, BitDepth::Eight, &[200, 100, 0, 128], &[], &[]);
    place.write("half.png", &half);
    differs(
        "half.png",
        &of_kind(ColorType::Rgb, BitDepth::Eight, &[227, 177, 127], &[], &[]),
        "128 pixels differ by more than 16",
    );
    same("half.png", &of_kind(ColorType::Rgba, BitDepth::Sixteen, &[200, 200, 100, 100, 0, 0, 128, 128], &[], &[]));
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
        assert!(ran.status == Some(1) && ran.out == told, "{ran:?}");
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
    assert!(page.starts_with("<!doctype html>") && page.contains("state moved: Local shape"), "{}", &page[..200]);
    place.run("compare a.png c.png --report none/page.html -q").bad(4, &["none/page.html"]);
    place
        .run("compare a.png c.png --report a.png/page.html -q")
        .bad(4, &["error: --report: a.png is a file, not a folder; name a file elsewhere\n"]);
    #[cfg(unix)]
    {
        run(std::process::Command::new("mkfifo").arg(place.path("pipe"))).good();
        place.run("compare a.png c.png --report pipe/page.html -q").bad(4, &["pipe is a pipe, not a folder"]);
    }
    // Only an earlier page is replaced.
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
    let wrong: [(&str, Vec<u8>, &str); 20] = [
        ("damaged-text.png", damaged, "damaged or cut short (a checksum is wrong)"),
        ("twice.png", twice, "is missing, damaged or repeated"),
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
    // A mistyped path gets the same message on both sides.
    for (words, absent) in
        [("a.png b.png", "b.png"), ("b.png a.png", "b.png"), ("none below", "below"), ("below none", "below")]
    {
        let message = format!("{absent} does not exist; expected a picture or a folder of pictures");
        place.run(&format!("compare {words}")).bad(4, &[&message]);
    }
    if cfg!(feature = "render") {
        place.run("compare a.png a.png --adapter cpu").bad(2, &["--adapter is for scenes and figures"]);
    }
    place.write("small.toml", SMALL);
    if cfg!(feature = "render") {
        place.run("compare a.png small.toml").bad(2, &["a.png is not a golden"]);
    }
    place.run("compare --bless a.png a.png").bad(2, &["--bless makes or renews the golden of a scene"]);
    place.run("compare --bless-state a.png a.png").bad(2, &["'--bless-state'", "'--bless'"]);
    place
        .run("compare small.toml none")
        .bad(2, &["small.toml is a scene or figure, which comes last, after its golden", "give two folders"]);
    std::fs::create_dir(place.path("broken")).unwrap();
    place.write("broken/golden.toml", "format = 7");
    if cfg!(feature = "render") {
        place.run("compare broken small.toml").bad(2, &["broken/golden.toml", "cannot be read", "--bless"]);
    }
    place.write("broken/a.png", &picture("one", "1", 0, &GREY));
    place.run("compare broken broken").bad(2, &["broken is a golden, which is compared with its scene"]);
    place.write("wrong.toml", "body.lattice = { cells = [1, 1, 1], size = 0.1 }");
    let words = if cfg!(feature = "render") { "`size`" } else { "without the feature `render`" };
    place.run("compare none2 wrong.toml").bad(2, &["wrong.toml", words]);
    place.run("compare none a.png").bad(2, &["none is a folder and a.png is a file"]);
    place.write("full/a.png", &picture("one", "1", 0, &GREY));
    place.run("compare full a.png").bad(2, &["full is a folder and a.png is a file"]);
    place.run("compare none none").bad(2, &["has a PNG picture"]);
    place.run("compare a.png").bad(2, &["<ACTUAL>"]);
}

/// The picture with most differing pixels is the first on the page.
#[test]
fn a_report_begins_with_the_worst_picture() {
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
    let order: Vec<_> = page.split("<h2>").skip(1).filter_map(|rest| rest.split("</h2>").next()).collect();
    assert_eq!(order, ["✕ 2.png", "✕ 3.png", "✕ 1.png", "✓ 0.png"]);
}
