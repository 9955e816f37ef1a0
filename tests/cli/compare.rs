//! `compare`: verdicts on pictures and folders of them.

use crate::support::Place;
use localshape::output::{Tags, encode};

fn picture(adapter: &str, state: &str, frame: u64, bytes: &[u8]) -> Vec<u8> {
    let tags = Tags {
        scene: "s".into(),
        states: vec![(state.into(), "Local shape".into())],
        frame,
        time: frame as f64 / 60.0,
        version: "0".into(),
        adapter: adapter.into(),
    };
    encode([16, 8], bytes, &tags)
}

fn put(place: &Place, name: &str, bytes: &[u8]) {
    let path = place.path(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, bytes).unwrap();
}

const GREY: [u8; 16 * 8 * 3] = [120; 16 * 8 * 3];

#[test]
fn two_pictures() {
    let place = Place::new();
    let mut other = GREY;
    other[..30].fill(0);
    put(&place, "a.png", &picture("one", "1", 0, &GREY));
    put(&place, "b.png", &picture("two", "1", 0, &other));
    put(&place, "c.png", &picture("one", "2", 0, &GREY));
    assert_eq!(place.run("compare a.png a.png").good().out, "a.png: identical\n");
    let drawn = place.run("compare a.png b.png");
    assert_eq!((drawn.status, drawn.err.as_str()), (Some(1), ""));
    assert!(drawn.out.starts_with("b.png: same state, drawn differently: 10 pixels differ by more than 2 of 255"));
    let moved = place.run("compare a.png c.png --json");
    assert_eq!(moved.status, Some(1));
    let told: serde_json::Value = serde_json::from_str(&moved.out).unwrap();
    assert_eq!((told["passes"].as_bool(), told["first_moved"].as_str()), (Some(false), Some("c.png")));
    assert_eq!(told["pictures"][0]["verdict"], "state-moved");
    assert_eq!(told["pictures"][0]["runs"][0], "Local shape");
    let quiet = place.run("compare a.png c.png -q");
    assert_eq!((quiet.status, quiet.out.as_str()), (Some(1), ""));
}

#[test]
fn two_folders() {
    let place = Place::new();
    for frame in 0..5 {
        put(&place, &format!("was/frame_{frame:05}.png"), &picture("one", "1", frame, &GREY));
        let state = if frame < 3 { "1" } else { "2" };
        put(&place, &format!("is/frame_{frame:05}.png"), &picture("one", state, frame, &GREY));
    }
    put(&place, "was/gone.png", &picture("one", "1", 9, &GREY));
    put(&place, "is/new.png", &picture("one", "1", 9, &GREY));
    put(&place, "is/diagnostics.csv", b"no picture");
    let found = place.run("compare was is");
    assert_eq!(found.status, Some(1));
    assert_eq!(
        found.out,
        "frame_00003.png: state moved: Local shape\n\
         frame_00004.png: state moved: Local shape\n\
         gone.png: missing\n\
         new.png: extra\n\
         4 of 7 pictures are not as expected\n\
         the first whose state moved is frame_00003.png\n"
    );
    let same = place.run("compare was was").good();
    assert_eq!(same.out, "6 pictures, nothing moved; at most 0 pixels of one differ visibly\n");
}

#[test]
fn what_is_no_picture_never_passes() {
    let place = Place::new();
    let whole = picture("one", "1", 0, &GREY);
    put(&place, "whole.png", &whole);
    let mut flipped = whole.clone();
    let middle = whole.len() - 30;
    flipped[middle] ^= 0x55;
    let wrong: [(&str, Vec<u8>, &str); 4] = [
        ("text.png", b"no picture".to_vec(), "no whole PNG picture"),
        ("empty.png", Vec::new(), "no whole PNG picture"),
        ("cut.png", whole[..whole.len() - 20].to_vec(), "no whole PNG picture"),
        ("flipped.png", flipped, "no whole PNG picture"),
    ];
    for (name, bytes, words) in wrong {
        put(&place, name, &bytes);
        for order in [format!("{name} whole.png"), format!("whole.png {name}")] {
            let ran = place.run(&format!("compare {order}"));
            assert_eq!((ran.status, ran.err.as_str()), (Some(1), ""), "{order}: {ran:?}");
            assert!(ran.out.contains("unreadable") && ran.out.contains(words), "{order}: {ran:?}");
        }
    }
    for (name, depth, colour, bytes, words) in [
        ("deep.png", png::BitDepth::Sixteen, png::ColorType::Rgb, 16 * 8 * 6, "16 bits a channel"),
        ("grey.png", png::BitDepth::Eight, png::ColorType::Grayscale, 16 * 8, "is grey"),
    ] {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, 16, 8);
        encoder.set_depth(depth);
        encoder.set_color(colour);
        encoder.write_header().unwrap().write_image_data(&vec![7; bytes]).unwrap();
        put(&place, name, &file);
        let ran = place.run(&format!("compare whole.png {name}"));
        assert!(ran.status == Some(1) && ran.out.contains(words), "{ran:?}");
    }
}

#[test]
fn wrong_words() {
    let place = Place::new();
    put(&place, "a.png", &picture("one", "1", 0, &GREY));
    std::fs::create_dir(place.path("none")).unwrap();
    place.run("compare a.png b.png").bad(4, &["cannot read b.png"]);
    place.run("compare none a.png").bad(2, &["none is a folder and a.png is a file"]);
    place.run("compare none none").bad(2, &["holds a PNG picture"]);
    place.run("compare a.png").bad(2, &["<ACTUAL>"]);
}
