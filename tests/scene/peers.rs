//! Recordings of other engines in `examples/peers`, and the scripts that made them.

use localshape::scene::{Limits, Scene};
use localshape::sim::{Moment, Status};
use std::path::{Path, PathBuf};

const FOLDER: &str = "examples/peers";

/// The files of a folder with an ending.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let all = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    all.filter(|path| path.extension().is_some_and(|found| found == ending)).collect()
}

#[test]
fn scripts_are_read_on_one_page() {
    let scripts = files(Path::new(FOLDER), "py");
    assert_eq!(scripts.len(), 5);
    for script in scripts {
        let lines = std::fs::read_to_string(&script).unwrap().lines().count();
        assert!(lines <= 80, "{} has {lines} lines", script.display());
    }
}

/// Each recording begins like the runs of this program, lasts to the end of its scene, and is of the engine and version that
/// the name of its run tells.
#[test]
fn recordings_read_back() {
    let recordings = files(&Path::new(FOLDER).join("recordings"), "npz");
    let sizes: Vec<_> = recordings.iter().map(|path| path.metadata().unwrap().len()).collect();
    assert!(sizes.iter().all(|&size| size < 300_000) && sizes.iter().sum::<u64>() < 1_000_000, "{sizes:?} bytes");

    let mut read = 0;
    for name in ["fig4b.toml", "beam.toml"] {
        let scene = Scene::load(&Path::new(FOLDER).join(name), &Limits::default()).unwrap();
        for (index, run) in scene.runs.iter().enumerate() {
            let Some(recording) = &run.recording else { continue };
            let engine = recording.source();
            assert!(run.name.starts_with(engine.split(',').next().unwrap()), "{}: {engine}", run.name);

            let apart = run.initial.position.iter().zip(&scene.runs[0].initial.position).map(|(a, b)| a.distance(*b));
            assert!(apart.fold(0.0, f64::max) < 1e-6, "{} starts elsewhere", run.name);

            let mut world = scene.world(index);
            world.advance_towards(Moment::at(scene.duration), u64::MAX);
            assert_eq!(world.status(), Status::Ok, "{}", run.name);
            let position = &world.state().position;
            if !scene.obstacles.is_empty() {
                let lowest = position.iter().map(|node| node.y).fold(f64::INFINITY, f64::min);
                assert!(lowest > -0.005, "a node of {} is at {lowest} m", run.name);
            }
            for &node in run.grips.iter().flat_map(|grip| &grip.nodes) {
                let moved = position[node as usize].distance(run.initial.position[node as usize]);
                assert!(moved < 1e-6, "held node {node} of {} moved by {moved} m", run.name);
            }
            read += 1;
        }
    }
    assert_eq!(read, recordings.len());
}
