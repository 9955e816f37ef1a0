//! The cost of a step, beside the floor of the machine: `cargo bench --bench step`. `benches/README.md` explains the
//! numbers.
//!
//! All cases of one size are measured in turn, so that other load of the machine affects all alike, and the best of
//! many short samples counts. `-- 3 10 40` measures only these sizes.

use localshape::internals::multiply_adds;
use localshape::internals::{lanes, limit_lanes};
use localshape::scene::{Limits, Scene};
use localshape::sim::{Assembly, Body, Crew, World};
use rayon::ThreadPoolBuilder;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

/// The least number of multiply-adds of one lane for a box and step.
const FLOOR: f64 = 320.0;
/// Elements times steps in one sample: many steps, so that work once per call, as once per frame, is a small part.
const WORK: u64 = 3_000_000;
/// The least number of steps in one sample, for the same reason: each call keeps a copy of the state.
const LEAST: u64 = 8;
/// Cells along an edge.
const SIZES: [u64; 6] = [3, 10, 20, 40, 80, 160];

/// A timed case.
struct Case {
    name: &'static str,
    world: World,
    /// Elements of all bodies.
    count: u64,
    steps: u64,
    threads: usize,
    /// Nanoseconds per element and step.
    times: Vec<f64>,
}

impl Case {
    fn new(name: &'static str, scene: &Scene, run: usize, threads: usize) -> Self {
        let count = scene.bodies.iter().map(|named| named.body.elements().len() as u64).sum();
        let mut world = scene.world(run);
        world.set_crew(Crew::new(threads));
        Self { name, world, count, steps: (WORK / count).max(LEAST), threads, times: Vec::new() }
    }

    fn sample(&mut self) {
        let Self { world, steps, .. } = self;
        if self.threads > 1 {
            // Threads that have slept need some milliseconds until each has a processor.
            world.advance(*steps);
        }
        let start = Instant::now();
        world.advance(*steps);
        self.times.push(start.elapsed().as_secs_f64() * 1e9 / (self.steps * self.count) as f64);
    }

    fn best(&self) -> f64 {
        self.times.iter().copied().fold(f64::INFINITY, f64::min)
    }

    fn median(&self) -> f64 {
        let mut times = self.times.clone();
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    }
}

/// Equal bodies on a floor, with the compared models.
fn scene(copies: usize, body: &str, dimension: &str, runs: &[(&str, &str)]) -> Scene {
    let copy =
        |at: usize| format!("{{ name = '{at}', {body}, mass = 1, lowest = 0, offset = [{}, 0{dimension}] }}", 10 * at);
    let bodies: Vec<_> = (0..copies).map(copy).collect();
    let bodies = bodies.join(", ");
    let mut text = format!(
        "gravity = [0, -9.8{dimension}]
        time = {{ duration = 1, step = 'T/50', frames_per_second = 60 }}
        body = [{bodies}]
        obstacle = [{{ kind = 'floor', restitution = 0.5, friction = 0.3 }}]
        "
    );
    for (at, (model, more)) in runs.iter().enumerate() {
        text +=
            &format!("[[run]]\nname = '{at}'\nmodel = {{ stiffness = 1e4, damping_ratio = 0.1, {model} }}\n{more}\n");
    }
    Scene::parse(&text, "step", &Limits::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// A body of which every fourth element is half filled, with masses in proportion.
fn filled_in_part(body: &Body) -> Arc<Body> {
    let fill: Vec<f64> = (0..body.elements().len()).map(|at| if at % 4 == 0 { 0.5 } else { 1.0 }).collect();
    let body = body.clone().with_fill(fill).expect("parts of each element");
    let parts = body.fill_of_nodes().expect("it is filled in part");
    let masses = body.mass().iter().zip(parts).map(|(mass, part)| mass * part).collect();
    Arc::new(body.with_masses(masses).expect("masses above 0"))
}

/// The present floor of the machine: nanoseconds per box and step.
fn floor() -> f64 {
    let start = Instant::now();
    let count = black_box(multiply_adds(20_000));
    start.elapsed().as_secs_f64() * 1e9 / count as f64 * FLOOR
}

/// Calls `work` with vectors of at most `most` doubles.
fn in_lanes<T>(most: usize, work: impl FnOnce() -> T) -> T {
    let widest = lanes();
    limit_lanes(most);
    let done = work();
    limit_lanes(widest);
    done
}

/// The rate (bytes per nanosecond) of reading two arrays and writing one that do not fit into a cache.
fn bandwidth() -> f64 {
    let count = 1 << 24;
    let (mut to, one, two) = (vec![0.0f64; count], vec![1.0f64; count], vec![2.0f64; count]);
    let pass = |to: &mut [f64]| {
        let start = Instant::now();
        for ((to, one), two) in to.iter_mut().zip(&one).zip(&two) {
            *to = one + 0.5 * two;
        }
        black_box(to);
        24.0 * count as f64 / (start.elapsed().as_secs_f64() * 1e9)
    };
    (0..5).map(|_| pass(&mut to)).fold(0.0, f64::max)
}

/// Times all cases and the floor in turn; the floor also with vectors of four doubles.
fn measure(cases: &mut [Case], samples: usize) -> [f64; 2] {
    let mut least = [f64::INFINITY; 2];
    for _ in 0..samples {
        least = [least[0].min(floor()), least[1].min(in_lanes(4, floor))];
        cases.iter_mut().for_each(|case| case.sample());
    }
    least
}

fn print(cases: &[Case], floor: f64) {
    for case in cases {
        let (best, median) = (case.best(), case.median());
        println!("  {:<44} {best:8.1} {median:8.1} {:8.2}", case.name, best / floor);
    }
}

fn find<'a>(cases: &'a [Case], name: &str) -> &'a Case {
    cases.iter().find(|case| case.name == name).expect("a case that was timed")
}

fn main() {
    let asked: Vec<u64> = std::env::args().filter_map(|argument| argument.parse().ok()).collect();
    // Code without vectors also runs on one thread.
    ThreadPoolBuilder::new().num_threads(1).build_global().expect("a thread");
    println!("floor: {FLOOR} multiply-adds a cube; memory {:.1} GB/s", bandwidth());
    println!("ns per element and step: best, median, best over floor\n");
    let mut results = Vec::new();
    for cells in SIZES.into_iter().filter(|size| asked.is_empty() || asked.contains(size)) {
        let lattice = format!("lattice = {{ cells = [{cells}, {cells}, {cells}], side = 0.1 }}");
        let mut runs = vec![
            ("kind = 'shape-based'", ""),
            ("kind = 'shape-based', rotation = 'arctangent'", ""),
            ("kind = 'mass-spring', springs = 'all'", ""),
        ];
        if cells <= 80 {
            runs.extend([
                ("kind = 'mass-spring', springs = 'edges+one-diagonal'", ""),
                ("kind = 'mass-spring', springs = 'edges+face-diagonals'", ""),
                ("kind = 'mass-spring', springs = 'edges+body-diagonals'", ""),
                ("kind = 'mass-spring', springs = 'edges'", ""),
            ]);
        }
        if cells <= 40 {
            runs.extend([
                ("kind = 'shape-based', rotation = 'arctangent'", "kernel = 'reference'"),
                ("kind = 'mass-spring', springs = 'all'", "kernel = 'reference'"),
            ]);
        }
        let scene_of_lattice = scene(1, &lattice, ", 0", &runs);
        let names = [
            "shape",
            "shape, Eq. (15) twice",
            "springs, all (13 a cube)",
            "springs, edges+one-diagonal",
            "springs, edges+face-diagonals",
            "springs, edges+body-diagonals",
            "springs, edges",
            "plain shape, Eq. (15) twice",
            "plain springs, all",
        ];
        let mut cases: Vec<_> = (0..runs.len()).map(|run| Case::new(names[run], &scene_of_lattice, run, 1)).collect();
        cases.push(Case::new("shape, 2 threads", &scene_of_lattice, 0, 2));
        cases.push(Case::new("springs, all, 2 threads", &scene_of_lattice, 2, 2));
        if lanes() > 4 {
            cases.push(in_lanes(4, || Case::new("shape, AVX2", &scene_of_lattice, 0, 1)));
        }
        let mut filled = scene_of_lattice.clone();
        filled.runs[0].bodies = Arc::new(Assembly::new(vec![filled_in_part(&filled.bodies[0].body)]));
        cases.push(Case::new("shape, filled in part", &filled, 0, 1));
        cases.push(Case::new("shape, filled in part, 2 threads", &filled, 0, 2));
        let one = [("kind = 'shape-based'", "")];
        let other = |body: String, dimension: &str, name: &'static str| {
            Case::new(name, &scene(1, &body, dimension, &one), 0, 1)
        };
        if cells <= 20 {
            let ten = scene(10, &lattice, ", 0", &one);
            cases.push(Case::new("shape, ten blocks", &ten, 0, 1));
            cases.push(Case::new("shape, ten blocks, 2 threads", &ten, 0, 2));
        }
        if cells <= 40 {
            let cube = format!("cells = [{cells}, {cells}, {cells}], side = 0.1");
            cases.push(other(format!("lattice = {{ {cube}, irregular = 0.2 }}"), ", 0", "irregular hexahedra"));
            cases.push(other(format!("lattice = {{ {cube}, elements = 'tetrahedra' }}"), ", 0", "tetrahedra"));
            let side = (cells * cells * cells).isqrt();
            let square = format!("cells = [{side}, {side}], side = 0.1");
            cases.push(other(
                format!("lattice = {{ {square}, irregular = 0.2 }}"),
                "",
                "irregular squares in the plane",
            ));
            cases.push(other(
                format!("lattice = {{ {square}, elements = 'triangles' }}"),
                "",
                "triangles in the plane",
            ));
        }
        let samples = match cells {
            0..=40 => 15,
            41..=80 => 7,
            _ => 4,
        };
        let floors = measure(&mut cases, samples);
        println!("{cells}³ cubes, floor {:.2}", floors[0]);
        print(&cases, floors[0]);
        println!();
        results.push((cells, floors, cases));
    }
    if let Some((_, [floor, narrow], cases)) = results.iter().find(|(cells, ..)| *cells == 40) {
        let best = |name: &str| find(cases, name).best();
        // Of paired samples, the best speed-up.
        let pairs = find(cases, "shape").times.iter().zip(&find(cases, "shape, 2 threads").times);
        println!("ratio-to-floor: {:.2}", best("shape") / floor);
        if lanes() > 4 {
            println!("ratio-to-floor-avx2: {:.2}", best("shape, AVX2") / narrow);
        }
        println!("general-to-floor: {:.2}", best("irregular hexahedra") / floor);
        println!("shape-to-spring: {:.2}", best("shape") / best("springs, all (13 a cube)"));
        println!("threads-2: {:.2}", pairs.map(|(one, two)| one / two).fold(0.0, f64::max));
        println!("plain-to-fast: {:.2}", best("plain shape, Eq. (15) twice") / best("shape, Eq. (15) twice"));
    }
}
