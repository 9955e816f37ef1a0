//! Tests that need a device: pictures are drawn, identically each time, in every size.
//!
//! Without a graphics adapter these tests are skipped with a message. `LOCALSHAPE_REQUIRE_GPU=1` makes that a failure.

mod fields;
mod fine;
mod forces;
mod inside;
mod look;
mod obstacles;
mod pictures;
mod sheets;
mod shown;
mod smooth;
mod steady;
mod strips;
mod vectors;
mod words;

use localshape::gpu::{AdapterChoice, Gpu};
use localshape::runner::Runner;
use localshape::scene::{Limits, Scene};
use localshape::sim::snapshot::Frame;
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
        eprintln!("SKIPPED {test}: no graphics adapter");
    }
    GPU.as_ref()
}

/// The scene of Fig. 4(b) with a view that sets only its size, its clock and a camera that follows.
fn plain() -> String {
    let text = include_str!("../../scenes/fig4b.toml");
    let (world, view) = text.split_once("[view]").expect("a view");
    let asked = |line: &&str| !["size", "title", "letters", "strip"].iter().any(|key| line.starts_with(key));
    let view: Vec<_> = view.lines().filter(asked).collect();
    format!("{world}[view]\nsize = [1280, 720]{}\n", view.join("\n"))
}

/// The scene of Fig. 4(b) with default drawing, and one of its frames.
fn fig4b(frame: u64) -> (Scene, Frame) {
    let scene = Scene::parse(&plain(), "fig4b.toml", &Limits::default()).expect("the shipped scene is sound");
    let frame = Runner::new(&scene, &[0, 1]).frame(frame);
    (scene, frame)
}

/// A byte of sRGB as linear light, from 0 to 1.
fn linear(byte: u8) -> f64 {
    let encoded = f64::from(byte) / 255.0;
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}
