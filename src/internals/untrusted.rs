//! Every reader of files by its name, called with any bytes: what is fuzzed (`fuzz/`), and tested with damaged files.
//!
//! Whatever it is given, a reader returns a mistake or a meaning. It never panics, and takes no more time and memory than
//! limits and the length of the file allow.

use crate::golden::{Pixels, is_record};
use crate::output::StoredStates;
use crate::runner::{Frames, Next, Progress, Runner};
use crate::scene::figure::Figure;
use crate::scene::{Limits, Scene};
use crate::sim::diagnostics::Diagnostic;
use crate::sim::state::State;
use std::fs;
use std::path::Path;

/// A reader, its name and the ending of its files.
pub struct Reader {
    /// Its name, which is that of its fuzz target.
    pub name: &'static str,
    /// Reads a file with these bytes.
    pub read: fn(&[u8]),
}

/// All readers.
pub const READERS: [Reader; 8] = [
    Reader { name: "scene", read: scene },
    Reader { name: "figure", read: figure },
    Reader { name: "body", read: body },
    Reader { name: "states", read: states },
    Reader { name: "checkpoint", read: checkpoint },
    Reader { name: "state", read: |bytes| drop(State::from_bytes(bytes)) },
    Reader { name: "picture", read: |bytes| drop(Pixels::from_bytes(bytes)) },
    Reader { name: "golden", read: golden },
];

/// Reads a file by the reader of this name.
///
/// # Panics
/// If there is none.
pub fn read(name: &str, bytes: &[u8]) {
    (READERS.iter().find(|reader| reader.name == name).expect("a reader").read)(bytes);
}

/// What is read within milliseconds.
const LIMITS: Limits = Limits { nodes: 1000, corners: 8000, springs: 20_000, file: 1 << 20 };

/// The scene to which states, checkpoints and bodies of tests belong.
pub const SCENE: &str = "
    gravity = [0, -9.8, 0]
    time = { duration = 0.1, frames_per_second = 60 }
    body.lattice = { cells = [1, 1, 1], side = 0.1 }
    obstacle = [{ kind = 'floor' }]
    [[run]]
    name = 'shape'
    model = { kind = 'shape-based', stiffness = 1e4 }
    [[run]]
    name = 'springs'
    model = { kind = 'mass-spring', stiffness = 1e4 }
";

/// A scene is read and takes its first steps.
fn scene(bytes: &[u8]) {
    if let Ok(text) = std::str::from_utf8(bytes) {
        begin(Scene::parse(text, "fuzz.toml", &LIMITS));
    }
}

/// The first steps, and the first picture, of a scene.
fn begin<E>(scene: Result<Scene, E>) {
    let Ok(scene) = scene else { return };
    let frame = Runner::new(&scene, &(0..scene.runs.len()).collect::<Vec<_>>()).frame(0);
    #[cfg(feature = "render")]
    crate::picture::compose(&scene, &frame);
    drop(frame);
    for run in 0..scene.runs.len() {
        let mut world = scene.world(run);
        world.advance(3);
        world.snapshot();
    }
}

fn figure(bytes: &[u8]) {
    in_folder("figure.toml", bytes, |path| drop(Figure::load(path, &LIMITS)));
}

/// A NumPy archive as the body of a scene.
fn body(bytes: &[u8]) {
    in_folder("body.npz", bytes, |path| {
        let text = SCENE.replace("body.lattice = { cells = [1, 1, 1], side = 0.1 }", "body.file = 'body.npz'");
        let scene = path.with_file_name("scene.toml");
        fs::write(&scene, text).expect("a file");
        begin(Scene::load(&scene, &LIMITS));
    });
}

/// States of [`SCENE`], of which the first frame is read.
fn states(bytes: &[u8]) {
    in_folder("states.npz", bytes, |path| {
        let scene = Scene::parse(SCENE, "scene.toml", &LIMITS).expect("sound");
        let Ok(stored) = StoredStates::open(path, &scene, &[0, 1], &[0]) else { return };
        let Ok(mut frames) = Frames::stored(Runner::new(&scene, &[0, 1]), &[0], stored) else { return };
        while let Ok(Next::TimeSeries(_)) = frames.next(1) {}
    });
}

/// How far [`SCENE`] was simulated, without the digest that would refuse every damage.
fn checkpoint(bytes: &[u8]) {
    let Ok(progress) = postcard::from_bytes::<Progress>(bytes) else { return };
    let scene = Scene::parse(SCENE, "scene.toml", &LIMITS).expect("sound");
    let runner = Runner::new(&scene, &[0, 1]).with_time_series(Diagnostic::ALL);
    let mut frames = Frames::new(runner, &[2, 4], None);
    if frames.resume(progress).is_ok() {
        for _ in 0..100 {
            if !matches!(frames.next(10), Ok(Next::Working | Next::Frame(_))) {
                return;
            }
        }
    }
}

/// The record of a golden.
fn golden(bytes: &[u8]) {
    if let Ok(text) = std::str::from_utf8(bytes) {
        is_record(text);
    }
}

/// A checkpoint for that reader.
pub fn checkpoint_of_scene() -> Vec<u8> {
    let scene = Scene::parse(SCENE, "scene.toml", &LIMITS).expect("sound");
    let runner = Runner::new(&scene, &[0, 1]).with_time_series(Diagnostic::ALL);
    let mut frames = Frames::new(runner, &[2, 4], None);
    frames.next(3).expect("no file is needed");
    let progress = frames.progress().expect("no file is needed").expect("frames are left");
    postcard::to_allocvec(&progress).expect("plain data")
}

/// Calls `read` with a file of these bytes, in a folder of its own.
fn in_folder(name: &str, bytes: &[u8], read: impl FnOnce(&Path)) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    fs::write(&path, bytes).expect("a file");
    read(&path);
}
