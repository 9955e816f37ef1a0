//! Tests that need a device: pictures of every size are drawn, identically each time.
//!
//! Without a graphics adapter these tests are skipped with a message. `LOCALSHAPE_REQUIRE_GPU=1` makes that a failure.

#[expect(dead_code, reason = "tests of the report use the rest")]
#[path = "../report/browser.rs"]
mod browser;
mod camera;
mod carried;
mod charts;
mod compared;
mod fields;
mod fine;
mod forces;
mod inside;
mod listed;
mod look;
mod meshes;
mod obstacles;
mod pages;
mod pictures;
mod printed;
mod room;
mod shades;
mod sheets;
mod shown;
mod smooth;
mod steady;
mod turns;
mod vectors;
mod words;
mod work;

use image::RgbImage;
use listed::{Composer, Listed};
use localshape::gpu::{AdapterChoice, Gpu};
use localshape::picture::{Picture, TextRun};
use localshape::render::Renderer;
use localshape::runner::Frame;
use localshape::runner::Runner;
use localshape::runner::history::History;
use localshape::scene::{Limits, Scene};
use std::sync::LazyLock;

static GPU: LazyLock<Option<Gpu>> = LazyLock::new(|| match Gpu::new(&AdapterChoice::Auto) {
    Ok(gpu) => Some(gpu),
    Err(error) if std::env::var_os("LOCALSHAPE_REQUIRE_GPU").is_some_and(|value| value == "1") => {
        panic!("LOCALSHAPE_REQUIRE_GPU is set, but {error}")
    }
    Err(_) => None,
});

/// The device that all tests share, or `None`, with a message, if a test is skipped.
fn gpu(test: &str) -> Option<&'static Gpu> {
    if GPU.is_none() {
        localshape::internals::skipped(&format!("no graphics adapter for {test}"));
    }
    GPU.as_ref()
}

/// The scene of Fig. 4(b) with a view that sets only its size, its clock and a fixed camera.
fn plain() -> String {
    let text = include_str!("../../scenes/fig4b.toml");
    let (world, view) = text.split_once("[view]").expect("a view");
    let asked = |line: &&str| !["size", "title", "labels", "charts"].iter().any(|key| line.starts_with(key));
    let view: Vec<_> = view.lines().filter(asked).collect();
    format!("{world}[view]\nsize = [1280, 720]{}\ncamera.distance = 2.65\n", view.join("\n"))
}

/// The scene of Fig. 4(b) with default drawing, and one of its frames.
fn fig4b(index: u64) -> (Scene, Frame) {
    let scene = parse(&plain());
    let frame = frame(&scene, index);
    (scene, frame)
}

/// A scene from its text.
fn parse(text: &str) -> Scene {
    Scene::parse(text, "test.toml", &Limits::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// A frame of all runs of a scene.
fn frame(scene: &Scene, index: u64) -> Frame {
    Runner::new(scene, &all(scene)).frame(index)
}

/// The picture of a frame, without the course of its scene.
fn compose(scene: &Scene, frame: &Frame) -> Listed {
    unknown(scene).compose(frame)
}

/// A composer of frames, without the course of their scene.
fn unknown(scene: &Scene) -> Composer<'_> {
    Composer::new(scene, &History::default())
}

/// All runs of a scene.
fn all(scene: &Scene) -> Vec<usize> {
    (0..scene.runs.len()).collect()
}

fn renderer(gpu: &Gpu, size: [u32; 2]) -> Renderer {
    Renderer::new(gpu, size).expect("a size that can be drawn")
}

/// A picture drawn by a new renderer.
fn draw(gpu: &Gpu, picture: &Picture) -> RgbImage {
    renderer(gpu, picture.size).draw(picture).expect("the device works")
}

/// Checks that the boxes of no two lines of text overlap, and that none leaves the picture.
#[track_caller]
fn assert_words_are_clear(picture: &Listed, case: &str) {
    let [width, height] = picture.size.map(|length| length as f32);
    for (at, word) in picture.words.iter().enumerate() {
        let [left, top, right, bottom] = word.bounds();
        let inside = left >= 0.0 && top >= 0.0 && right <= width && bottom <= height;
        assert!(inside, "“{}” leaves the picture, {case}: {:?}", word.text, word.bounds());
        let overlaps = |other: &&TextRun| {
            let [left2, top2, right2, bottom2] = other.bounds();
            left < right2 && left2 < right && top < bottom2 && top2 < bottom
        };
        let other = picture.words[..at].iter().find(overlaps);
        assert!(other.is_none(), "“{}” lies over “{}”, {case}", word.text, other.map_or("", |other| &other.text));
    }
}

/// A byte of sRGB as linear light, from 0 to 1.
fn linear(byte: u8) -> f64 {
    let encoded = f64::from(byte) / 255.0;
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}
