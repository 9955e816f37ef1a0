//! Scene files: correct ones have the right meaning, and every mistake is found, located and explained.

mod archives;
mod bodies;
mod contact;
mod digest;
mod figures;
mod good;
mod loads;
#[cfg(feature = "render")]
mod look;
mod manipulators;
mod material;
mod measures;
mod meshes;
mod mistakes;
mod peers;
mod plausible;
mod plural;
mod recordings;
mod regions;
mod rest;
mod robust;
mod schema;
mod several;

use localshape::scene::{Limits, Scene, SceneError};

/// A scene of one run, to which tests add lines.
const WORLD: &str = "\
[time]
duration = 1

[[run]]
name = 'Local shape'
model = { kind = 'shape-based', stiffness = 1e4 }
";

/// The scene of a text, which must be correct.
#[track_caller]
fn good(text: &str) -> Scene {
    match Scene::parse(text, "test.toml", &Limits::default()) {
        Ok(scene) => scene,
        Err(error) => panic!("{error}"),
    }
}

/// The mistakes of a text, which must have some.
#[track_caller]
fn bad(text: &str) -> SceneError {
    match Scene::parse(text, "test.toml", &Limits::default()) {
        Ok(_) => panic!("this was taken for a good scene:\n{text}"),
        Err(error) => error,
    }
}

/// Expects exactly these mistakes, one in each line: `LINE:COLUMN` and a part of its message or help. Lines are counted
/// after the first `before`.
#[track_caller]
fn expect(error: &SceneError, before: usize, expected: &str) {
    assert_eq!(error.mistakes().len(), expected.lines().count(), "{error}");
    for (mistake, expected) in error.mistakes().iter().zip(expected.lines()) {
        let (place, words) = expected.split_once(' ').expect("a place and words");
        assert_eq!(format!("{}:{}", mistake.line - before, mistake.column), place, "{error}");
        let text = format!("{} {}", mistake.message, mistake.help.as_deref().unwrap_or_default());
        assert!(text.contains(words), "{words:?} is not in\n{error}");
    }
}

/// A shipped scene.
fn shipped(name: &str) -> String {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}
