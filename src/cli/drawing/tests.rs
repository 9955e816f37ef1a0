//! Drawing the frames of a scene: equal ones, and with a device that is lost on the way.

use super::*;
use crate::cli::failure::Status;
use crate::gpu::AdapterChoice;
use crate::runner::Runner;
use crate::scene::Limits;

/// A device with the settings of the tests.
fn device(gpu: &Gpu, resume: bool) -> Arc<Device> {
    let (films, words) = Default::default();
    Arc::new(Device { gpu: Some(gpu.clone()), threads: 2, keep: true, resume, films, words })
}

/// The scene of Fig. 4(b), drawn small, and its first frames.
fn fig4b(frames: u64) -> (Scene, Vec<Frame>) {
    let text = include_str!("../../../scenes/fig4b.toml").replace("size = ", "# ");
    let mut scene = Scene::parse(&text, "test.toml", &Limits::default()).expect("a scene");
    scene.view.size = [480, 320];
    let runs: Vec<_> = (0..scene.runs.len()).collect();
    let mut runner = Runner::new(&scene, &runs);
    let frames = (0..frames).map(|index| runner.frame(index)).collect();
    (scene, frames)
}

#[test]
fn a_frame_like_the_last_one_is_not_drawn() {
    let Ok(gpu) = Gpu::new(&AdapterChoice::Auto) else {
        return crate::internals::skipped("no graphics adapter");
    };
    let (scene, frames) = fig4b(2);
    let folder = tempfile::tempdir().expect("a folder");
    let mut drawing = Drawing::begin(&device(&gpu, false), &scene, folder.path(), &[0, 1, 2]).expect("a device");
    let again = Frame { index: 1, ..frames[0].clone() };
    let mut draws = |frame: &Frame| {
        drawing.draw(frame).and_then(|()| drawing.flush()).expect("a device");
        drawing.repeated
    };
    assert_eq!([&frames[0], &again, &Frame { index: 2, ..frames[1].clone() }].map(&mut draws), [0, 1, 1]);
    let mut told = Summary::new(&scene, &[0, 1], 3, &[]);
    Box::new(drawing).finish(&mut told, &mut Timings::default()).expect("files");
    assert_eq!((told.frames.written, told.frames.repeated), (Some(3), 1));
}

/// Drawn frames are whole and written, and a second device continues after them.
#[test]
fn a_lost_device_loses_no_frame_that_was_drawn() {
    const DRAWN: usize = 3;
    let Ok(gpu) = Gpu::new(&AdapterChoice::Auto) else {
        return crate::internals::skipped("no graphics adapter");
    };
    let (scene, frames) = fig4b(6);
    let asked: Vec<_> = (0..6).collect();
    let summary = || Summary::new(&scene, &[0, 1], asked.len(), &[]);
    let folders = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    let [broken, sound] = [&folders[0], &folders[1]].map(tempfile::TempDir::path);

    let mut pictures = Drawing::begin(&device(&gpu, false), &scene, broken, &asked).map(Box::new).expect("a device");
    frames[..=DRAWN].iter().for_each(|frame| pictures.draw(frame).expect("a device"));
    // The last one is still being drawn.
    gpu.device().destroy();
    let failure = pictures.draw(&frames[DRAWN + 1]).expect_err("no device");
    let mut told = summary();
    pictures.finish(&mut told, &mut Timings::default()).expect("files");
    assert_eq!(told.frames.written, Some(DRAWN));
    assert_eq!(failure.report(), Status::Adapter);

    let gpu = Gpu::new(&AdapterChoice::Auto).expect("as before");
    for (folder, resume, drawn) in [(sound, false, asked.len()), (broken, true, asked.len() - DRAWN)] {
        let mut pictures =
            Drawing::begin(&device(&gpu, resume), &scene, folder, &asked).map(Box::new).expect("a device");
        frames.iter().for_each(|frame| pictures.draw(frame).expect("a device"));
        let mut told = summary();
        pictures.finish(&mut told, &mut Timings::default()).expect("files");
        assert_eq!(told.frames.written, Some(drawn));
    }
    let names = |folder: &Path| {
        let entries = std::fs::read_dir(folder).expect("a folder");
        let mut names: Vec<_> = entries.map(|entry| entry.expect("a file").file_name()).collect();
        names.sort();
        names
    };
    assert_eq!((names(broken), names(sound).len()), (names(sound), asked.len()), "whole frames only");
    for name in names(sound) {
        let bytes = |folder: &Path| std::fs::read(folder.join(&name)).expect("a frame");
        assert!(bytes(broken) == bytes(sound), "{}", name.display());
    }
}
