//! What a step costs: both models, from a body that fits any cache to one that does not, on one thread and on all.
//!
//! `cargo bench --bench step`. Criterion prints median and spread; the throughput is elements times steps a second, so
//! its inverse is the time per element and step.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use localshape::scene::{Limits, Scene};

/// Elements times steps in one sample: enough to hide the hand-over to the pool, a few milliseconds of work.
const WORK: u64 = 64_000;

/// A block of cubes at rest on the floor with each model as one run.
fn scene(cells: u32) -> Scene {
    let text = format!(
        r#"
        gravity = [0, -9.8, 0]
        time = {{ duration = 1.0, step = "T/50", frames_per_second = 60 }}
        body = {{ lattice = {{ cells = [{cells}, {cells}, {cells}], side = 0.1 }}, mass = 1.0, lowest = 0.0 }}
        obstacle = [{{ kind = "floor", restitution = 0.5, friction = 0.3 }}]
        [[run]]
        name = "shape, 2 passes"
        model = {{ kind = "shape-based", stiffness = 1e4, damping_ratio = 0.1 }}
        [[run]]
        name = "shape, 1 pass"
        model = {{ kind = "shape-based", stiffness = 1e4, damping_ratio = 0.1, passes = 1 }}
        [[run]]
        name = "springs, edges+one-diagonal"
        model = {{ kind = "mass-spring", stiffness = 1e4, damping_ratio = 0.1, springs = "edges+one-diagonal" }}
        [[run]]
        name = "springs, all"
        model = {{ kind = "mass-spring", stiffness = 1e4, damping_ratio = 0.1, springs = "all" }}
        "#
    );
    Scene::parse(&text, "step", &Limits::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn step(criterion: &mut Criterion) {
    let most = std::thread::available_parallelism().map_or(1, usize::from);
    for threads in std::collections::BTreeSet::from([1, most]) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads");
        for cells in [3, 10, 20, 40] {
            let scene = scene(cells);
            let mut group = criterion.benchmark_group(format!("{cells}^3 cubes, {threads} threads"));
            let elements = scene.body.elements.len() as u64;
            let steps = (WORK / elements).max(1);
            group.sample_size(10).throughput(Throughput::Elements(steps * elements));
            for (index, run) in scene.runs.iter().enumerate() {
                let mut world = scene.world(index);
                group.bench_function(&run.name, |bencher| bencher.iter(|| pool.install(|| world.advance(steps))));
            }
            group.finish();
        }
    }
}

criterion_group!(benches, step);
criterion_main!(benches);
