"""Animations have the pictures of the program's."""

import os
import signal
import subprocess
import sys
import textwrap
import time

import numpy as np
import pytest
from conftest import CUBES, TRIANGLE
from localshape import Scene

FLAT = {"body": {"polygon": {"sides": 6, "radius": 1.0}, "velocity": [1, 0]}, **TRIANGLE}


@pytest.fixture(scope="module")
def result():
    return Scene(**FLAT).simulate()


def without_comment(path):
    """The bytes of a GIF after its comment, which names the call."""
    data = path.read_bytes()
    at = data.index(b"\x21\xfe") + 2
    while data[at]:
        at += data[at] + 1
    return data[at:]


@pytest.mark.parametrize("ending", ["gif", "apng", "mp4"])
def test_they_are_those_of_the_program(cubes_file, program, tmp_path, ending):
    program("render", cubes_file, "-o", tmp_path / "frames")
    program("animate", tmp_path / "frames", "-o", tmp_path / f"a.{ending}", "--width", "160", "--speed", "0.5", "--hold-last", "1")
    result, mine = Scene.load(cubes_file).simulate(), tmp_path / f"b.{ending}"
    assert result.animate(mine, width=160, speed=0.5, hold_last=1) is None
    if ending == "gif":
        assert without_comment(mine) == without_comment(tmp_path / "a.gif")
        assert b"command: result.animate('b.gif', speed=0.5, hold_last=1, width=160)" in mine.read_bytes()
    assert abs(len(mine.read_bytes()) - len((tmp_path / f"a.{ending}").read_bytes())) < 300
    # Its own file is replaced.
    result.animate(str(mine), frames=range(2))
    assert len(mine.read_bytes()) > 100 and sorted(os.listdir(tmp_path)) == sorted([f"a.{ending}", f"b.{ending}", "cubes.toml", "frames"])


def test_parts_and_files_of_others(result, tmp_path):
    path = tmp_path / "-a.gif"
    result.animate(path, frames=np.array([2, 0]), plays=1, fps=50)
    assert path.read_bytes().startswith(b"GIF89a") and b"NETSCAPE" not in path.read_bytes()
    path.write_bytes(b"mine")
    with pytest.raises(ValueError, match=r"was not made by this command; choose another name, or replace it with overwrite=True"):
        result.animate(path)
    assert path.read_bytes() == b"mine"
    result.animate(path, overwrite=True)
    assert path.read_bytes().startswith(b"GIF89a")


@pytest.mark.parametrize(
    ("path", "options", "error", "words"),
    [
        ("a.png", {}, ValueError, "the ending says what to make: .gif, .apng, .mp4 or .webm"),
        ("", {}, ValueError, ""),
        ("a.gif", {"speed": 0}, ValueError, "'speed <TIMES>'"),
        ("a.gif", {"speed": float("nan")}, ValueError, "expected a number from 0.001 to 1000"),
        ("a.gif", {"width": 3}, ValueError, "width"),
        ("a.gif", {"width": 2.5}, ValueError, "width"),
        ("a.gif", {"plays": -1}, ValueError, "or 0 for endless"),
        ("a.mp4", {"plays": 2}, ValueError, "plays is for .gif and .apng"),
        ("a.gif", {"hold_last": "x"}, ValueError, "hold_last"),
        ("a.gif", {"frames": []}, ValueError, "`frames` is empty; expected"),
        ("a.gif", {"frames": [9]}, IndexError, "there is no frame 9; the last one is 2"),
        ("a.gif", {"frames": [-1]}, (ValueError, OverflowError), ""),
        ("a.gif", {"frames": [0.5]}, TypeError, "integer"),
        ("a.gif", {"frames": 1}, TypeError, "iterable"),
        ("a.gif", {"colours": 3}, TypeError, "colours"),
        ("absent/a.gif", {}, (ValueError, OSError), "absent"),
        (3, {}, TypeError, ""),
    ],
)
def test_wrong_arguments(result, tmp_path, monkeypatch, path, options, error, words):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(error) as caught:
        result.animate(path, **options)
    assert words in str(caught.value) and os.listdir(tmp_path) == []


#: A progress bar that tells what it is told.
BAR = """
class tqdm:
    def __init__(self, total, **keys):
        self.n, self.total = 0, total
    def __enter__(self):
        return self
    def __exit__(self, *error):
        print(f"bar {self.n:g} of {self.total}", flush=True)
    def update(self, more):
        assert more >= 0
        self.n += more
"""


def run(tmp_path, text):
    """Starts a program in which `tqdm` tells what it is told."""
    (tmp_path / "tqdm").mkdir(exist_ok=True)
    (tmp_path / "tqdm/__init__.py").write_text("")
    (tmp_path / "tqdm/auto.py").write_text(BAR)
    begin = "import sys; sys.path.insert(0, {here!r}); from conftest import *; from localshape import *\n"
    words = [sys.executable, "-c", begin.format(here=os.path.dirname(__file__)) + textwrap.dedent(text)]
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    return subprocess.Popen(words, stdout=subprocess.PIPE, text=True, cwd=tmp_path, env=environment)


def test_a_progress_bar(tmp_path):
    child = run(tmp_path, "Scene(**CUBES).simulate().animate('a.gif')")
    assert child.communicate(timeout=120)[0] == "bar 10 of 10\n" and child.returncode == 0


def test_ctrl_c_is_heard(tmp_path):
    """A long animation ends, and leaves no file."""
    text = """
        scene = Scene(**CUBES)
        scene.set('time.frames_per_second', 5000)
        result = scene.simulate()
        print('begun', flush=True)
        try: result.animate('a.gif')
        except KeyboardInterrupt: print('heard')
    """
    child = run(tmp_path, text)
    try:
        assert child.stdout.readline() == "begun\n"
        time.sleep(0.3)
        child.send_signal(signal.SIGINT)
        told = child.communicate(timeout=60)[0]
        assert told.endswith("heard\n") and not (tmp_path / "a.gif").exists()
    finally:
        child.kill()
        child.wait()


def test_pictures_that_need_another_run(tmp_path):
    scene = Scene(**CUBES)
    scene.set("run[1].step", "T/50")
    scene.set("view.colour", {"by": "distance", "to": "Local shape"})
    with pytest.raises(ValueError, match="was not simulated"):
        scene.simulate(runs=["Springs"]).animate(tmp_path / "a.gif")
    assert os.listdir(tmp_path) == []
