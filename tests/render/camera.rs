//! Cameras that follow, over the whole course of all shipped scenes, by the numbers in their pictures: no device needed.

use localshape::history::History;
use localshape::picture::{Composer, Panel, Picture};
use localshape::runner::Runner;
use localshape::scene::{Limits, Scene};
use std::path::{Path, PathBuf};

fn shipped() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let files = std::fs::read_dir(folder).expect("a folder of scenes").map(|entry| entry.expect("an entry").path());
    let mut scenes: Vec<_> = files.filter(|path| path.extension().is_some_and(|extension| extension == "toml")).collect();
    scenes.sort();
    scenes
}

fn load(path: &Path) -> Scene {
    Scene::load(path, &Limits::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn parse(text: &str) -> Scene {
    Scene::parse(text, "camera.toml", &Limits::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// A composer that knows the whole course, and every so many frames of the scene.
fn film(scene: &Scene, every: u64) -> Vec<(u64, Picture)> {
    let runs: Vec<_> = (0..scene.runs.len()).collect();
    let mut composer = Composer::new(scene);
    composer.set_history(&History::new(scene, &runs));
    let mut runner = Runner::new(scene, &runs);
    let frames = (0..=scene.last_frame()).filter(|frame| frame % every == 0);
    frames.map(|frame| (frame, composer.compose(&runner.frame(frame)))).collect()
}

/// The box around the body of a panel: left, top, right and bottom (px from the panel's left upper corner).
fn outline(panel: &Panel) -> Option<[f32; 4]> {
    let [width, height] = [panel.viewport[2], panel.viewport[3]].map(|length| length as f32);
    let meshes = [&panel.sound, &panel.turned_over].into_iter().flat_map(|mesh| &mesh.vertices);
    let points = meshes.map(|vertex| vertex.position);
    let points = points.chain(panel.strokes.iter().flat_map(|stroke| stroke.ends));
    let lines = panel.lines.iter().filter(|line| (line.kind as u32) < 8).flat_map(|line| [line.from, line.to]);
    points.chain(lines).fold(None, |all, point| {
        let at = panel.sight.clip * glam::Vec3::from(point).extend(1.0);
        let [x, y] = [(0.5 + 0.5 * at.x / at.w) * width, (0.5 - 0.5 * at.y / at.w) * height];
        let [a, b, c, d] = all.unwrap_or([x, y, x, y]);
        Some([a.min(x), b.min(y), c.max(x), d.max(y)])
    })
}

#[test]
fn every_shipped_scene_fills_its_panels_and_cuts_nothing_off() {
    for path in shipped() {
        let scene = load(&path);
        let name = &scene.name;
        let (mut widest, mut smallest, mut scale) = (0.0_f32, f32::INFINITY, None);
        for (frame, picture) in film(&scene, 5) {
            for (panel, run) in picture.panels.iter().zip(&scene.runs) {
                // One scale in all panels and frames.
                let element = *scale.get_or_insert(panel.sight.element);
                assert!((panel.sight.element - element).abs() < 1e-3 * element, "{name} {frame}");
                let [width, height] = [panel.viewport[2], panel.viewport[3]].map(|length| length as f32);
                let Some([left, top, right, bottom]) = outline(panel) else { continue };
                let is_inside = left >= 0.0 && right <= width && top >= 0.0 && bottom <= height;
                if !is_inside { eprintln!("CUT {name} {} {frame}: {left} {top} {right} {bottom} of {width} {height}", run.name); continue; }
                assert!(!panel.is_cut);
                widest = widest.max((right - left) / width);
                smallest = smallest.min((right - left) * (bottom - top) / (width * height));
            }
        }
        eprintln!("{name}: widest {widest:.3} smallest area {smallest:.3}");
    }
}
