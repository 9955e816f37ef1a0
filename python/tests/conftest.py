"""Scenes and the program of the library, which must agree with the package."""

import os
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(os.environ.get("LOCALSHAPE_PROGRAM", ROOT / "target/release/localshape"))

#: Keys of a short scene with two runs: two cubes fall onto a floor.
CUBES = {
    "gravity": [0, -9.8, 0],
    "time": {"duration": 0.2, "frames_per_second": 20},
    "body": {"lattice": {"cells": [2, 1, 1], "side": 0.1}, "velocity": [0, -2, 0]},
    "obstacle": [{"kind": "floor", "restitution": 0.5}],
    "run": [
        {"name": "Local shape", "model": {"kind": "shape-based", "stiffness": 1e4}},
        {"name": "Springs", "model": {"kind": "mass-spring", "stiffness": 1e4}, "step": "T/70"},
    ],
    "view": {"size": [320, 180]},
}

#: The same as a scene file.
CUBES_FILE = """
gravity = [0, -9.8, 0]
time = { duration = 0.2, frames_per_second = 20 }
body.lattice = { cells = [2, 1, 1], side = 0.1 }
body.velocity = [0, -2, 0]
obstacle = [{ kind = 'floor', restitution = 0.5 }]
view.size = [320, 180]
[[run]]
name = 'Local shape'
model = { kind = 'shape-based', stiffness = 1e4 }
[[run]]
name = 'Springs'
model = { kind = 'mass-spring', stiffness = 1e4 }
step = 'T/70'
"""

#: A triangle in the plane: its pictures need no device.
TRIANGLE = {
    "title": "triangle",
    "time": {"duration": 0.1, "frames_per_second": 20},
    "run": [{"name": "One", "model": {"kind": "shape-based", "stiffness": 1e3}}],
    "view": {"size": [320, 180]},
}


@pytest.fixture
def cubes_file(tmp_path):
    path = tmp_path / "cubes.toml"
    path.write_text(CUBES_FILE)
    return path


@pytest.fixture
def program():
    """Runs the program and returns what it prints."""
    assert PROGRAM.exists(), f"{PROGRAM} is missing: build it with `cargo build --release`, or name it by LOCALSHAPE_PROGRAM"

    def run(*words):
        done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run
