//! Draws single frames of a scene: `cargo run --release --example still -- scenes/fig4b.toml 4 picture.png`.
//!
//! A fourth and fifth argument set the size (`1920x1080`) and the samples a pixel (1 or 4); `dark` as sixth takes the
//! dark theme.

use localshape::gpu::{AdapterChoice, Gpu};
use localshape::history::History;
use localshape::look::{Look, Theme};
use localshape::picture::Composer;
use localshape::render::Renderer;
use localshape::runner::Runner;
use localshape::scene::{Limits, Scene};
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let [scene, frame, out, more @ ..] = &arguments[..] else {
        return Err("usage: still SCENE FRAME OUT.png [WIDTHxHEIGHT [SAMPLES [dark]]]".into());
    };
    let mut scene = Scene::load(Path::new(scene), &Limits::default())?;
    if let Some((width, height)) = more.first().and_then(|size| size.split_once('x')) {
        scene.view.size = [width.parse()?, height.parse()?];
    }
    let samples = more.get(1).map_or(Ok(4), |samples| samples.parse())?;
    if more.get(2).is_some_and(|theme| theme == "dark") {
        scene.view.look = Look::of(Theme::Dark);
    }
    let runs: Vec<_> = (0..scene.runs.len()).collect();
    let frame = Runner::new(&scene, &runs).frame(frame.parse()?);
    let mut composer = Composer::new(&scene);
    if scene.view.strip.is_some() {
        composer.set_history(&History::new(&scene, &runs));
    }
    let picture = composer.compose(&frame);
    let gpu = Gpu::new(&AdapterChoice::Auto)?;
    Renderer::new(&gpu, scene.view.size, samples)?.draw(&picture)?.save(out)?;
    Ok(())
}
