//! Drawing with a device that is lost on the way.

use super::*;
use crate::gpu::AdapterChoice;
use crate::runner::Runner;
use crate::scene::Limits;

/// Frames that were drawn are whole and written, and a second device goes on after them.
#[test]
fn a_lost_device_loses_no_frame_that_was_drawn() {
    const DRAWN: usize = 3;
    let Ok(gpu) = Gpu::new(&AdapterChoice::Auto) else {
        return eprintln!("SKIPPED: no graphics adapter");
    };
    let text = include_str!("../../../scenes/fig4b.toml").replace("size = ", "# ");
    let mut scene = Scene::parse(&text, "test.toml", &Limits::default()).expect("a scene");
    scene.view.size = [480, 320];
    let runs: Vec<_> = (0..scene.runs.len()).collect();
    let mut runner = Runner::new(&scene, &runs);
    let frames: Vec<_> = (0..6).map(|index| runner.frame(index)).collect();
    let asked: Vec<_> = (0..6).collect();
    let studio = |gpu: &Gpu, resume: bool| Device {
        gpu: gpu.clone(),
        writers: 2,
        keep: true,
        resume,
        shard: None,
        shared: None,
        made: Mutex::default(),
    };
    let summary = || Summary::new(&scene, &runs, asked.len(), &[]);
    let folders = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    let [broken, sound] = [&folders[0], &folders[1]].map(tempfile::TempDir::path);

    let device = studio(&gpu, false);
    let mut pictures = device.begin(&scene, broken, &asked).expect("a device");
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
        let device = studio(&gpu, resume);
        let mut pictures = device.begin(&scene, folder, &asked).expect("a device");
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
