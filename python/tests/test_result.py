"""Results have the bits of the program, and pictures its bytes."""

import csv
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from conftest import CUBES, CUBES_FILE, TRIANGLE
from localshape import DeviceError, Scene


@pytest.fixture
def result(cubes_file):
    return Scene.load(cubes_file).simulate()


def test_states_are_those_of_the_program(result, cubes_file, program, tmp_path):
    program("simulate", cubes_file, "--states", "-o", tmp_path / "out")
    states = np.load(tmp_path / "out/states.npz")
    assert result.runs == ["Local shape", "Springs"] and len(result) == 2 and "Springs" in result
    for name in result.runs:
        run = result[name]
        assert run.position.shape == (5, 12, 3) and run.position.dtype == np.float64
        assert run.position.tobytes() == states[f"{name}.position"].tobytes()
        assert run.velocity.tobytes() == states[f"{name}.velocity"].tobytes()
        assert run.step == states[f"{name}.step"] and run.divergence is None
    assert result["Local shape"].time.tobytes() == states["time"].tobytes()
    assert result["Springs"].time.tobytes() == states["Springs.time"].tobytes()
    with open(tmp_path / "out/diagnostics.csv") as file:
        rows = list(csv.DictReader(file))
    for name in result.runs:
        table = result[name].diagnostics.to_pandas()
        for key in table.columns:
            expected = [float(row[key]) for row in rows if row["run"] == name]
            np.testing.assert_array_equal(table[key], expected, key)
        assert len(table.columns) == len(rows[0]) - 3 and result[name].bodies == {}


def test_rows_of_bodies_and_between_frames(program, tmp_path):
    """They are those of `diagnostics.csv`."""
    text = CUBES_FILE.replace("duration = 0.2,", "duration = 0.2, every = 0.013,").replace("body.lattice = { cells = [2, 1, 1], side = 0.1 }", "")
    text = text.replace("body.velocity = [0, -2, 0]", "").replace("step = 'T/70'", "step = 'T/3'")
    text += "".join(f"[[body]]\nname = '{name}'\nlattice = {{ cells = [2, 1, 1], side = 0.1 }}\noffset = [{at}, 0.1, 0]\n" for at, name in enumerate("ab"))
    (tmp_path / "two.toml").write_text(text)
    program("simulate", tmp_path / "two.toml", "-o", tmp_path / "out")
    with open(tmp_path / "out/diagnostics.csv") as file:
        rows = list(csv.DictReader(file))
    result = Scene.load(tmp_path / "two.toml").simulate()
    assert result["Springs"].divergence is not None
    for name in result.runs:
        run = result[name]
        assert list(run.bodies) == ["a", "b"]
        for body, table in [("all", run.diagnostics), *run.bodies.items()]:
            told = [row for row in rows if (row["run"], row["body"]) == (name, body)]
            for key, column in table.to_pandas().items():
                np.testing.assert_array_equal(column, [float(row[key] or "nan") for row in told], key)
        frames = run.diagnostics["frame"]
        assert np.isnan(frames).any() and frames[~np.isnan(frames)].tolist() == [0, 1, 2, 3, 4]


def test_arrays_are_no_copies_and_stay_as_they_are(result):
    position = result["Springs"].position
    assert np.shares_memory(position, result["Springs"].position)
    with pytest.raises(ValueError, match="read-only"):
        position[0] = 0
    start, frame = position[0].copy(), position[1]
    del result, position
    assert not np.array_equal(frame, start), "the array keeps its buffer"


def test_some_runs(result):
    scene = Scene(**CUBES)
    alone = scene.simulate(runs=["Springs"])
    assert alone.runs == ["Springs"]
    assert alone["Springs"].position.tobytes() == result["Springs"].position.tobytes()
    with pytest.raises(KeyError, match="was not simulated"):
        alone["Local shape"]
    with pytest.raises(KeyError, match="no run “Shape”; its runs are “Local shape”, “Springs”"):
        scene.simulate(runs=["Shape"])
    with pytest.raises(ValueError, match="no runs"):
        scene.simulate(runs=[])
    scene.set("run[1].step", "T/50")
    scene.set("view.colour", {"by": "distance", "to": "Local shape"})
    with pytest.raises(ValueError, match="“Local shape”, which `view.colour.to` needs, was not simulated"):
        scene.simulate(runs=["Springs"]).frame(0)


def test_a_divergence_is_a_result():
    scene = Scene(**CUBES)
    scene.set("run[1].step", "T/2")
    run = scene.simulate()["Springs"]
    assert 0 < run.divergence.time <= 0.2 and run.divergence.step >= 1 and not run.divergence.is_end
    assert np.isfinite(run.position).all()


def test_pictures_are_those_of_the_program(result, cubes_file, program, tmp_path):
    program("render", cubes_file, "-o", tmp_path / "frames")
    for number in (0, 3):
        picture = result.frame(number / 20 + 0.01)
        assert picture.number == number and picture.size == [320, 180]
        assert picture.png() == picture._repr_png_() == (tmp_path / f"frames/frame_{number:05}.png").read_bytes()
    for ending in ("svg", "pdf"):
        program("render", cubes_file, "--frames", "3", "-o", tmp_path / f"frame.{ending}")
        assert getattr(picture, ending)() == (tmp_path / f"frame.{ending}").read_bytes()
    array = picture.array
    assert array.shape == (180, 320, 4) and array.dtype == np.uint8 and (array[..., 3] == 255).all()
    assert len(np.unique(array.reshape(-1, 4), axis=0)) > 20


def test_pictures_with_the_course_of_the_scene(program, cubes_file, tmp_path):
    """Charts and paths show what was simulated, without simulating again."""
    view = "view = { size = [640, 480], charts = ['kinetic'], paths = [0] }"
    cubes_file.write_text(cubes_file.read_text().replace("view.size = [320, 180]", view))
    program("render", cubes_file, "-o", tmp_path / "frames")
    picture = Scene.load(cubes_file).simulate().frame(0.1)
    assert picture.png() == (tmp_path / "frames/frame_00002.png").read_bytes()


@pytest.mark.parametrize("t", [-0.1, 0.3, float("nan"), float("inf")])
def test_frames_that_are_not_there(result, t):
    with pytest.raises(ValueError, match="frames are from 0 to 0.2 s"):
        result.frame(t)


def test_small_type_is_refused():
    scene = Scene(body={"polygon": {"sides": 6, "radius": 1.0}}, **{**TRIANGLE, "view": {"size": {"mm": [20, 15]}}})
    with pytest.raises(ValueError, match="pt"):
        scene.simulate().frame(0)


def test_a_missing_driver_is_told():
    """A picture in the plane needs none."""
    words = (
        "import sys; sys.path.insert(0, {here!r}); from conftest import *; from localshape import *\n"
        "flat = Scene(body={{'polygon': {{'sides': 6, 'radius': 1.0}}}}, **TRIANGLE).simulate().frame(0)\n"
        "assert flat.array.shape == (180, 320, 4) and flat.svg().startswith(b'<?xml') or flat.svg().startswith(b'<svg')\n"
        "picture = Scene(**CUBES).simulate().frame(0)\n"
        "try: picture.png()\n"
        "except DeviceError as error: print(error)\n"
    ).format(here=os.path.dirname(__file__))
    nothing = {"VK_DRIVER_FILES": "/nonexistent.json", "VK_ICD_FILENAMES": "/nonexistent.json"}
    done = subprocess.run([sys.executable, "-c", words], env={**os.environ, **nothing}, capture_output=True, text=True, timeout=120)
    assert "apt install mesa-vulkan-drivers" in done.stdout, done.stderr
    assert issubclass(DeviceError, RuntimeError)


def test_ctrl_c_is_heard():
    """A million steps of a large body would take hours."""
    words = (
        "import sys; sys.path.insert(0, {here!r}); from conftest import *; from localshape import *\n"
        "scene = Scene(**CUBES); scene.set('time.duration', 1e5); scene.set('time.frames_per_second', 1e-4)\n"
        "print('begun', flush=True)\n"
        "try: scene.{call}\n"
        "except KeyboardInterrupt: print('heard')\n"
    )
    for call in ("simulate()", "world('Springs').step(10**12)"):
        text = words.format(here=os.path.dirname(__file__), call=call)
        child = subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, text=True)
        try:
            assert child.stdout.readline() == "begun\n"
            time.sleep(0.3)
            child.send_signal(signal.SIGINT)
            assert child.communicate(timeout=60)[0] == "heard\n", call
        finally:
            child.kill()
            child.wait()
