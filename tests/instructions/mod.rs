//! The number of instructions of a step, counted by valgrind with vectors that it knows (AVX2): a test against slower
//! code that needs no quiet machine. Without valgrind it is skipped, or fails with `LOCALSHAPE_REQUIRE_VALGRIND`.

use localshape::scene::{Limits, Scene};
use std::path::Path;
use std::process::{Command, Stdio};

/// A block of 12³ boxes at rest on a floor.
const CELLS: u64 = 12;

/// Options of the lattice, options of the model, and the greatest number of instructions per element and step: a tenth
/// more than measured.
const CASES: [(&str, &str, u64); 7] = [
    ("", "kind = 'shape-based'", 294),
    ("", "kind = 'shape-based', rotation = 'arctangent'", 420),
    ("", "kind = 'mass-spring', springs = 'all'", 348),
    (", irregular = 0.2", "kind = 'shape-based'", 424),
    (", elements = 'tetrahedra'", "kind = 'shape-based'", 243),
    ("", "kind = 'shape-based', damping_of = 'deformation'", 427),
    (", irregular = 0.2", "kind = 'shape-based', damping_of = 'deformation'", 650),
];

fn scene((lattice, model, _): (&str, &str, u64)) -> Scene {
    let text = format!(
        "gravity = [0, -9.8, 0]
        time = {{ duration = 1, step = 1e-3 }}
        body = {{ lattice = {{ cells = [{CELLS}, {CELLS}, {CELLS}], side = 0.1{lattice} }}, lowest = 0 }}
        obstacle = [{{ kind = 'floor', restitution = 0.5, friction = 0.3, friction_of = 'velocity' }}]
        run = [{{ name = 'one', model = {{ stiffness = 1e4, damping_ratio = 0.1, {model} }} }}]"
    );
    Scene::parse(&text, "block", &Limits::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// The steps whose difference cancels the first ones.
const STEPS: [u64; 2] = [10, 60];

/// Where a count ends and the next one begins.
#[inline(never)]
fn count_from_here() {
    std::hint::black_box(());
}

/// Counted in a separate process.
#[test]
#[ignore = "started by the other test"]
fn steps() {
    for (case, steps) in CASES.into_iter().flat_map(|case| STEPS.map(|steps| (case, steps))) {
        let mut world = scene(case).world(0);
        count_from_here();
        world.advance(steps);
        count_from_here();
    }
}

/// The numbers of instructions of all these steps, in their order. Each count is a file; every other one is that of a start.
fn instructions(folder: &Path) -> Vec<u64> {
    let valgrind = Command::new("valgrind")
        .args(["--tool=callgrind", "--dump-before=*count_from_here*"])
        .arg(format!("--callgrind-out-file={}", folder.join("out").display()))
        .arg(std::env::current_exe().expect("this test"))
        .args(["--ignored", "--exact", "instructions::steps", "--test-threads", "1"])
        .stdin(Stdio::null())
        .output()
        .expect("valgrind runs");
    assert!(valgrind.status.success(), "{}", String::from_utf8_lossy(&valgrind.stderr));
    let file = |number: usize| std::fs::read_to_string(folder.join(format!("out.{number}"))).expect("a count");
    let total = |text: &str| text.lines().find_map(|line| line.strip_prefix("totals: ")?.parse().ok());
    (1..=2 * CASES.len()).map(|steps| total(&file(2 * steps)).expect("a number")).collect()
}

#[test]
fn a_step_takes_no_more_instructions_than_it_did() {
    let is_there = Command::new("valgrind").arg("--version").stdout(Stdio::null()).status().is_ok();
    if !is_there || !cfg!(target_arch = "x86_64") {
        assert!(std::env::var_os("LOCALSHAPE_REQUIRE_VALGRIND").is_none(), "valgrind is not there");
        localshape::internals::skipped("valgrind is not installed");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let counted = instructions(folder.path());
    let mut slower = Vec::new();
    for (case, counted) in CASES.into_iter().zip(counted.chunks(2)) {
        let more = (STEPS[1] - STEPS[0]) * scene(case).bodies[0].body.elements().len() as u64;
        let each = (counted[1] - counted[0]) / more;
        println!("{each} instructions per element and step, {} at most: {}{}", case.2, case.1, case.0);
        if each > case.2 {
            slower.push((case, each));
        }
    }
    assert!(slower.is_empty(), "slower than before: {slower:?}");
}
