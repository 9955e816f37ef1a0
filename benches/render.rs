//! The cost of a frame, by stage: `cargo bench --bench render`. `benches/README.md` explains the numbers.
//!
//! The program itself draws scenes into a temporary folder, a short and a long sequence of frames in turn. The states
//! are simulated once, because the simulation's noise would hide the cost of drawing. The additional time of the longer
//! sequence, over its number of additional frames, is the cost of a frame. The median counts.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Frames a second, as in the scene.
const RATE: u32 = 60;
/// Bodies, by the triangles of their surface, with frames beyond the first one.
const CASES: [(u32, Shown, u32); 5] = [
    (588, Shown::Block([7, 7, 7]), 60),
    (20_172, Shown::Block([41, 41, 41]), 12),
    (300_300, Shown::Block([273, 1, 273]), 4),
    (100_000, Shown::Carried([251, 200]), 8),
    (1_000_000, Shown::Carried([501, 1000]), 3),
];
/// The number of times that each sequence is rendered.
const TURNS: usize = 3;
/// The names of the stages in `run.json`.
const STAGES: [&str; 3] = ["compose", "draw", "encode"];

/// What is drawn.
#[derive(Clone, Copy)]
enum Shown {
    /// Cubes along each edge of a block.
    Block([u32; 3]),
    /// Rows and columns of points of a closed surface, filled with cubes.
    Carried([u32; 2]),
}

impl Shown {
    /// The keys of its body. Its mesh, if it has one, is written into a folder.
    fn body(self, folder: &Path) -> String {
        match self {
            Self::Block(cells) => {
                format!(
                    "lattice = {{ cells = {cells:?}, side = 0.1 }}\nmass = 1.0\nrotation = {{ axis = [1, 0, 1], angle = 0.028284 }}"
                )
            }
            Self::Carried([rows, columns]) => {
                std::fs::write(folder.join("surface.obj"), sphere(rows, columns)).expect("a temporary file");
                "mesh = \"surface.obj\"\nfill.cells = 12\ndensity = 300.0".to_owned()
            }
        }
    }
}

/// An OBJ file of a sphere with waves.
fn sphere(rows: u32, columns: u32) -> String {
    use std::f64::consts::{PI, TAU};
    use std::fmt::Write;
    let mut text = String::new();
    let mut point = |polar: f64, round: f64| {
        let radius = 0.4 * (1.0 + 0.03 * (20.0 * polar).sin() * (8.0 * round).sin());
        let (x, z) = (polar.sin() * round.cos(), polar.sin() * round.sin());
        writeln!(text, "v {} {} {}", radius * x, radius * polar.cos(), radius * z).expect("text");
    };
    let angles = |at: u32| {
        (PI * (f64::from(at / columns) + 0.5) / f64::from(rows), TAU * f64::from(at % columns) / f64::from(columns))
    };
    (0..rows * columns).map(angles).for_each(|(polar, round)| point(polar, round));
    point(0.0, 0.0);
    point(PI, 0.0);
    let mut triangle = |[a, b, c]: [u32; 3]| writeln!(text, "f {a} {b} {c}").expect("text");
    for column in 0..columns {
        let place = |row: u32, column: u32| 1 + row * columns + column % columns;
        for row in 1..rows {
            let [a, b] = [0, 1].map(|right| place(row - 1, column + right));
            let [c, d] = [1, 0].map(|right| place(row, column + right));
            triangle([a, b, c]);
            triangle([a, c, d]);
        }
        let first = rows * columns + 1;
        triangle([first, place(0, column + 1), place(0, column)]);
        triangle([first + 1, place(rows - 1, column), place(rows - 1, column + 1)]);
    }
    text
}

/// Two panels with floor, shadow, lines and words.
const SCENE: &str = r#"
title = "A block dropped on a floor"
gravity = [0, -9.8, 0]
[time]
duration = DURATION
step = "T/50"
frames_per_second = RATE
[body]
BODY
lowest = 0.0
velocity = [0, -9.899495, 0]
[[run]]
name = "Local shape"
model = { kind = "shape-based", stiffness = 1e4, damping_ratio = 0.1 }
[[run]]
name = "Mass-spring"
model = { kind = "mass-spring", stiffness = 1e4, damping_ratio = 0.1, springs = "edges+one-diagonal" }
[[obstacle]]
kind = "floor"
restitution = 0.5
friction = 0.3
[view]
size = [1280, 720]
title = "A block dropped from 5 m"
labels = ["letters", "name", "model", "clock", "count", "number", "scale-bar", "legend"]
"#;

/// One run of the program.
struct Rendered {
    /// Processor time of each stage (s).
    stages: [f64; 3],
    /// The times from its start to its end, and to the first frame on disk (s).
    wall: f64,
    first: f64,
    /// Its peak memory (MiB); 0 if the system does not provide it.
    peak: f64,
}

/// The program, on a scene into a folder.
fn program(command: &str, scene: &Path, folder: &Path) -> Command {
    let mut program = Command::new(env!("CARGO_BIN_EXE_localshape"));
    program.args([command, "--quiet"]).arg(scene).arg("-o").arg(folder).stdout(Stdio::null());
    program
}

/// Renders the first frame of a scene and `more` further ones, from states if there are any.
fn render(scene: &Path, states: Option<&Path>, more: u32, folder: &Path) -> Rendered {
    let start = Instant::now();
    let mut command = program("render", scene, folder);
    if let Some(states) = states {
        command.arg("--from-states").arg(states);
    }
    let mut program = command.args(["--frames", &format!("0-{more}")]).spawn().expect("the program starts");
    let (status, first_frame) = (format!("/proc/{}/status", program.id()), folder.join("frame_00000.png"));
    let (mut first, mut peak) = (None, 0.0);
    let ended = loop {
        if first.is_none() && first_frame.exists() {
            first = Some(start.elapsed().as_secs_f64());
        }
        peak = peak_mib(&status).unwrap_or(peak);
        match program.try_wait().expect("the program ends") {
            Some(ended) => break ended,
            None => sleep(Duration::from_millis(1)),
        }
    };
    let wall = start.elapsed().as_secs_f64();
    assert!(ended.success(), "the program cannot render here");
    let summary = std::fs::read(folder.join("run.json")).expect("a summary");
    let summary: Value = serde_json::from_slice(&summary).expect("a summary");
    let stages = STAGES.map(|stage| summary["times"][stage]["cpu"].as_f64().unwrap_or(f64::NAN));
    std::fs::remove_dir_all(folder).expect("its own folder");
    Rendered { stages, wall, first: first.unwrap_or(wall), peak }
}

/// The peak memory of a process so far (MiB).
fn peak_mib(status: &str) -> Option<f64> {
    let text = std::fs::read_to_string(status).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix(" kB")?.parse::<f64>().ok()? / 1024.0)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("frames");
    println!("milliseconds of processor time a frame, two panels, 1280×720");
    println!("triangles  compose     draw   encode  |   all   wall ms  first s  peak MiB");
    let mut lines = Vec::new();
    for (triangles, shown, more) in CASES {
        let scene = folder.path().join("scene.toml");
        let duration = format!("{:?}", f64::from(more) / f64::from(RATE));
        let text = SCENE.replace("BODY", &shown.body(folder.path())).replace("DURATION", &duration);
        let text = text.replace("RATE", &RATE.to_string());
        std::fs::write(&scene, text).expect("a temporary file");
        let simulated = folder.path().join("states");
        let made = program("simulate", &scene, &simulated).args(["--states", "--overwrite"]).status();
        assert!(made.expect("the program starts").success(), "the program cannot simulate here");
        let states = simulated.join("states.npz");
        let turn = |_| {
            let [short, long] = [0, more].map(|more| render(&scene, Some(&states), more, &out));
            [short, long, render(&scene, None, more, &out)]
        };
        let turns: Vec<_> = (0..TURNS).map(turn).collect();
        let of = |value: &dyn Fn(&[Rendered; 3]) -> f64| median(turns.iter().map(value).collect());
        let each = 1e3 / f64::from(more);
        let stage = |at: usize| of(&|[short, long, _]| each * (long.stages[at] - short.stages[at]));
        let all = |one: &Rendered| one.stages.iter().sum::<f64>();
        let cpu = of(&|[short, long, _]| each * (all(long) - all(short)));
        let wall = of(&|[short, long, _]| each * (long.wall - short.wall));
        let (first, peak) = (of(&|[.., whole]| whole.first), of(&|[.., whole]| whole.peak));
        let [compose, draw, encode] = [0, 1, 2].map(stage);
        println!("{triangles:9}  {compose:7.2} {draw:8.2} {encode:8.2}  | {cpu:5.1} {wall:9.1} {first:8.3} {peak:9.1}");
        lines.push((triangles, cpu, first, peak, compose));
    }
    let [small, large, _, _, carried] = &lines[..] else { unreachable!("one line for each case") };
    println!("\ncpu-ms-{}: {:.2}", small.0, small.1);
    println!("cpu-ms-{}: {:.2}", large.0, large.1);
    // Two panels.
    println!("carried-compose-ms-per-100k: {:.2}", carried.4 / (2.0 * f64::from(carried.0) / 1e5));
    println!("first-frame-s: {:.3}", small.2);
    println!("peak-mib: {:.1}", small.3);
}
