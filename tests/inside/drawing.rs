//! Scenes that are drawn for comparisons.

use super::super::Comparison;
use super::super::verdict::Verdict;
use super::*;
use crate::runner::Runner;
use crate::scene::Limits;
use std::path::{Path, PathBuf};

/// Every scene that ships.
fn shipped() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let files = ["scenes", "scenes/elements"].map(|folder| std::fs::read_dir(root.join(folder)).expect("scenes"));
    let paths = files.into_iter().flatten().map(|entry| entry.expect("an entry").path());
    let mut scenes: Vec<_> = paths.filter(|path| path.extension().is_some_and(|ending| ending == "toml")).collect();
    scenes.sort();
    scenes
}

/// Some frames of a scene from its start on. One run has the states of `moved`, whose body starts elsewhere.
fn drawn(scene: &Scene, moved: &Scene, moved_run: usize) -> Drawn {
    let mut states = States::default();
    for (number, run) in scene.runs.iter().enumerate() {
        let scene = if number == moved_run { moved } else { scene };
        let mut runner = Runner::new(scene, &[number]);
        for frame in (0..=scene.last_frame()).take(4) {
            add(&mut states, &run.name, (scene, number), frame, &runner.frame(frame).runs[0].snapshot, true);
        }
    }
    let record = Record { size: [320, 200], frames: [0].into(), states, ..Record::default() };
    Drawn { origin: PathBuf::new(), record, pictures: Some(Pictures::new()), notes: Vec::new() }
}

/// The golden of drawn frames, read from its file as stored there.
fn golden(drawn: &Drawn) -> Golden {
    let record = Record::parse(&drawn.record.text()).expect("a record");
    Golden { record: Some(record), ..Golden::read(Path::new("golden-that-is-absent"), false).expect("none") }
}

/// Fewer states differ from more, even if no picture shows the missing ones.
#[test]
fn a_scene_that_became_shorter_never_passes() {
    let text = "
        time = { duration = 0.05, step = 0.01, frames_per_second = 60 }
        body = { lattice = { cells = [1, 1, 1], side = 1 } }
        run = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1 } }]
    ";
    let scene = Scene::parse(text, "one", &Limits::default()).unwrap_or_else(|error| panic!("{error}"));
    let mut drawn = drawn(&scene, &scene, 0);
    let golden = golden(&drawn);
    assert!(Comparison::of_golden(&golden, &drawn).passes());
    drawn.record.states.runs[0].states.remove(&3);
    let shorter = Comparison::of_golden(&golden, &drawn);
    let told = (shorter.passes(), shorter.verdict(), shorter.ends_early);
    assert_eq!(told, (false, Verdict::Missing, Some([3, 2])));
    assert!(shorter.moved.is_empty());
}

/// A relative error of 1e-9 of one node of one run is reported as physics in any scene, and only for this run.
#[test]
fn the_smallest_errors_of_a_node_are_seen_in_every_scene() {
    let shipped = shipped();
    assert!(shipped.len() >= 25, "{}", shipped.len());
    for path in shipped {
        let scene = Scene::load(&path, &Limits::default()).expect("a scene that ships");
        let golden = golden(&drawn(&scene, &scene, 0));
        let compare = |moved: &Scene, run: usize| Comparison::of_golden(&golden, &drawn(&scene, moved, run));
        assert!(compare(&scene, 0).passes(), "{}: {}", path.display(), compare(&scene, 0));
        // A recorded run starts where its file says.
        let run = scene.runs.iter().rposition(|run| run.recording.is_none()).expect("a simulated run");
        let mut moved = scene.clone();
        let position = &mut moved.runs[run].initial.position;
        let node = position.iter().rposition(|at| at.length() > 0.0);
        match node {
            Some(node) => position[node] *= 1.0 + 1e-9,
            // All nodes start at the origin, where no error is relative: a thousand-millionth of the element's side.
            None => position[0].x = 1e-10,
        }
        let found = compare(&moved, run);
        assert_eq!(found.verdict(), Verdict::StateMoved, "{}", path.display());
        // Of several bodies the last is named, too.
        let last = recorded(&scene.runs[run].name, &scene, run).pop().expect("a body").0;
        let runs: Vec<_> = found.moved.iter().map(|moved| (&*moved.run, moved.first)).collect();
        assert_eq!(runs, [(&*last, Some(0))], "{}", path.display());
    }
}

/// For any drawn frames, positions of at least ten frames and of both ends are recorded.
#[test]
fn positions_are_spread_over_the_scene() {
    assert_eq!(frames_with_positions(120), (0..=120).step_by(12).collect());
    assert_eq!(frames_with_positions(4), (0..=4).collect());
    assert_eq!(frames_with_positions(0), [0].into());
    let drawn = [100, 200].into();
    assert_eq!(frames_with_digests(300, 2, &drawn).len(), 301, "each frame of a usual scene");
    let long = frames_with_digests(1_000_000, 3, &drawn);
    assert!(long.len() < 1000 && drawn.is_subset(&long) && frames_with_positions(1_000_000).is_subset(&long));
}
