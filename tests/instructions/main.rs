//! How many instructions a step takes, counted by valgrind at the width that it knows (AVX2): a guard against slower code that
//! needs no quiet machine. `LOCALSHAPE_REQUIRE_VALGRIND` makes it fail, not skip, where there is none.

use std::path::Path;
use std::process::{Command, Stdio};

/// A block of 12³ boxes at rest on a floor.
const CELLS: u64 = 12;

/// Instructions of a whole simulation of so many steps.
fn instructions(folder: &Path, body: &str, run: &str, steps: u64) -> u64 {
    let duration = 1e-3 * steps as f64;
    let scene = format!(
        "gravity = [0, -9.8, 0]
        time = {{ duration = {duration}, step = 1e-3, frames_per_second = {} }}
        body = {{ lattice = {{ cells = [{CELLS}, {CELLS}, {CELLS}], side = 0.1{body} }}, lowest = 0 }}
        obstacle = [{{ kind = 'floor', restitution = 0.5, friction = 0.3 }}]
        run = [{{ name = 'one', {run} }}]",
        1.0 / duration
    );
    let path = folder.join("scene.toml");
    std::fs::write(&path, scene).expect("a scene");
    let out = format!("--callgrind-out-file={}", folder.join("out").display());
    let valgrind = Command::new("valgrind")
        .args(["--tool=callgrind", &out, env!("CARGO_BIN_EXE_localshape"), "simulate", "--threads", "1", "--overwrite"])
        .args(["--quiet", "--frames", "1", "-o"])
        .args([folder.join("result"), path])
        .stdin(Stdio::null())
        .output()
        .expect("valgrind runs");
    let told = String::from_utf8_lossy(&valgrind.stderr);
    assert!(valgrind.status.success(), "{told}");
    let collected = told.lines().find_map(|line| line.split("Collected :").nth(1)).expect("a count");
    collected.trim().parse().expect("a number")
}

#[test]
fn a_step_takes_no_more_instructions_than_it_did() {
    let is_there = Command::new("valgrind").arg("--version").stdout(Stdio::null()).status().is_ok();
    if !is_there || !cfg!(target_arch = "x86_64") {
        assert!(std::env::var_os("LOCALSHAPE_REQUIRE_VALGRIND").is_none(), "valgrind is not there");
        eprintln!("skipped: valgrind is not there");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    // Instructions per element and step, and a tenth more.
    for (body, run, most) in [
        ("", "model = { kind = 'shape-based', stiffness = 1e4, damping_ratio = 0.1 }", 0),
        ("", "model = { kind = 'shape-based', stiffness = 1e4, damping_ratio = 0.1, rotation = 'arctangent' }", 0),
        ("", "model = { kind = 'mass-spring', stiffness = 1e4, damping_ratio = 0.1, springs = 'all' }", 0),
        (", irregular = 0.2", "model = { kind = 'shape-based', stiffness = 1e4, damping_ratio = 0.1 }", 0),
        (", elements = 'tetrahedra'", "model = { kind = 'shape-based', stiffness = 1e4, damping_ratio = 0.1 }", 0),
    ] {
        let [few, many] = [20, 120].map(|steps| instructions(folder.path(), body, run, steps));
        let elements = if body.contains("tetrahedra") { 5 } else { 1 } * CELLS.pow(3);
        let each = (many - few) / (100 * elements);
        println!("{each} instructions per element and step: {run}{body}");
        assert!(each <= most, "{each} instructions per element and step, {most} at most: {run}{body}");
    }
}
