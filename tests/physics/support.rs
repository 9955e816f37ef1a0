//! Shipped scenes for the tests.

use localshape::scene::{Limits, Scene};
use localshape::sim::Snapshot;

/// A shipped scene, with parts of its text replaced.
pub(crate) fn shipped(name: &str, changes: &[(&str, &str)]) -> Scene {
    let path = format!("{}/scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let mut text = std::fs::read_to_string(&path).expect("the scene ships");
    if changes.is_empty() {
        return Scene::load(path.as_ref(), &Limits::default()).unwrap_or_else(|error| panic!("{error}"));
    }
    for (old, new) in changes {
        assert!(text.contains(old), "the scene holds `{old}`");
        text = text.replace(old, new);
    }
    Scene::parse(&text, name, &Limits::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// A run of a scene after some seconds.
pub(crate) fn after(scene: &Scene, run: &str, seconds: f64) -> Snapshot {
    let at = scene.runs.iter().position(|known| known.name == run).expect("the scene has this run");
    let mut world = scene.world(at);
    world.advance((seconds / scene.runs[at].step).round() as u64);
    world.snapshot()
}
