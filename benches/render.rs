//! How long a picture takes, stage by stage: composing it, drawing it and reading it back.
//!
//! `cargo bench --bench render`. Encoding is measured elsewhere.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use localshape::gpu::{AdapterChoice, Gpu};
use localshape::picture::Composer;
use localshape::render::Renderer;
use localshape::runner::Runner;
use localshape::scene::{Limits, Scene};
use localshape::sim::Frame;
use std::hint::black_box;

/// Cubes that fall on the floor, as in Fig. 4(b), of any number along each side.
fn scene(cubes: usize) -> (Scene, Frame) {
    let text = include_str!("../scenes/fig4b.toml").replace("cells = [3, 3, 3]", &format!("cells = {:?}", [cubes; 3]));
    let scene = Scene::parse(&text, "fig4b.toml", &Limits::default()).expect("the scene is sound");
    let runs: Vec<_> = (0..scene.runs.len()).collect();
    let frame = Runner::new(&scene, &runs).frame(if cubes > 5 { 0 } else { 4 });
    (scene, frame)
}

fn compose(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("compose");
    for cubes in [3, 20] {
        let (scene, frame) = scene(cubes);
        let composer = Composer::new(&scene);
        group.bench_function(BenchmarkId::from_parameter(cubes), |bencher| {
            bencher.iter(|| black_box(composer.compose(black_box(&frame))));
        });
    }
}

fn draw(criterion: &mut Criterion) {
    let gpu = match Gpu::new(&AdapterChoice::Auto) {
        Ok(gpu) => gpu,
        Err(error) => return eprintln!("drawing is not measured: {error}"),
    };
    eprintln!("drawing on {}", gpu.description());
    let mut group = criterion.benchmark_group("draw");
    group.sample_size(30);
    for cubes in [3, 20] {
        let (mut scene, frame) = scene(cubes);
        for size in [[640, 360], [1280, 720], [1920, 1080]] {
            scene.view.size = size;
            let picture = Composer::new(&scene).compose(&frame);
            for samples in [1, 4] {
                let mut renderer = Renderer::new(&gpu, size, samples).expect("the size is small enough");
                let name = format!("{cubes}/{}x{}/{samples}x", size[0], size[1]);
                group.bench_function(name, |bencher| {
                    bencher.iter(|| black_box(renderer.draw(black_box(&picture)).expect("the device works")));
                });
            }
        }
    }
}

criterion_group!(benches, compose, draw);
criterion_main!(benches);
