//! `check`: what scenes hold, and every mistake in them.

use crate::support::{Place, SMALL};

#[test]
fn says_what_a_scene_holds() {
    let place = Place::with_small();
    let ran = place.run("check small.toml").good();
    for word in ["Two cubes", "Local shape", "Mass-spring", "12 nodes"] {
        assert!(ran.out.contains(word), "{word}: {}", ran.out);
    }
    assert_eq!(place.run("check small.toml --quiet").good().out, "");
    assert_eq!(place.names("."), ["small.toml"], "it writes nothing");
}

#[test]
fn finds_every_mistake_in_all_scenes() {
    let place = Place::with_small();
    place.write(
        "one.toml",
        &SMALL.replace("stiffness = 1e4", "stifness = 1e4").replace("friction = 0.3", "friction = -1"),
    );
    place.write("two.toml", &SMALL.replace("mass = 1.0", "mass = 0"));
    let ran = place.run("check one.toml small.toml two.toml absent.toml");
    assert_eq!(ran.status, Some(2), "{ran:?}");
    assert!(ran.out.contains("Two cubes"), "{}", ran.out);
    assert_eq!(ran.err.matches("`stifness`").count(), 2, "{}", ran.err);
    for word in ["one.toml:", "stiffness", "friction", "two.toml:", "mass", "absent.toml"] {
        assert!(ran.err.contains(word), "{word}: {}", ran.err);
    }
}

#[test]
fn as_json() {
    let place = Place::with_small();
    place.write("wrong.toml", &SMALL.replace("mass = 1.0", "mass = 0"));
    let ran = place.run("check small.toml wrong.toml --json");
    assert_eq!((ran.status, ran.err.as_str()), (Some(2), ""), "{ran:?}");
    let document = ran.json();
    assert_eq!(document["scenes"][0]["ok"], true);
    assert_eq!(document["scenes"][0]["scene"]["title"], "Two cubes");
    assert_eq!(document["scenes"][1]["ok"], false);
    assert!(document["scenes"][1]["mistakes"][0]["line"].as_u64().unwrap() > 1);
}

#[cfg(unix)]
#[test]
fn a_scene_that_cannot_be_read() {
    let place = Place::new();
    // A link to itself cannot be followed, whoever asks.
    std::os::unix::fs::symlink("loop.toml", place.path("loop.toml")).unwrap();
    place.run("check loop.toml").bad(4, &["loop.toml", "cannot be read"]);
}
