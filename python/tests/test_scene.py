"""Scenes from files and keys, and their mistakes."""

import copy
import pathlib

import numpy as np
import pytest
from conftest import CUBES, TRIANGLE
from localshape import Scene, SceneError

NODES = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
ELEMENTS = np.array([[0, 1, 2], [1, 3, 2]])


def mesh(**lists):
    return Scene(body={"nodes": NODES, "elements": ELEMENTS, **lists}, **TRIANGLE)


def mistake(*arguments, make=mesh, **keys):
    with pytest.raises(SceneError) as caught:
        make(*arguments, **keys)
    return caught.value


def test_keys_mean_what_a_file_says(cubes_file):
    loaded = Scene.load(cubes_file)
    assert loaded.digest == Scene.load(str(cubes_file)).digest == Scene(**CUBES).digest
    assert loaded.runs == ["Local shape", "Springs"] and loaded.title == "cubes"
    assert loaded.check()["bodies"][0]["nodes"] == 12 and loaded.warnings == []


def test_arrays_are_lists():
    masses, turned = [1.0, 2.0, 3.0, 4.0], NODES @ [[0.0, 1.0], [-1.0, 0.0]]
    extra = {"springs": [[0, 1], [2, 3]], "masses": masses, "positions": turned.tolist(), "velocities": NODES.tolist()}
    plain = mesh(nodes=NODES.tolist(), elements=ELEMENTS.tolist(), **extra)
    typed = {"springs": "u1", "masses": "f4", "positions": "f8", "velocities": "i8"}
    arrays = {key: np.array(value, typed[key]) for key, value in extra.items()}
    assert mesh(**arrays).digest == plain.digest
    # Any order in memory, and -1 at the end of shorter rows.
    padded = np.array([[0, 1, 2, -1], [1, 3, 2, -1]], "i2")
    assert mesh(nodes=np.asfortranarray(NODES), elements=padded[:, ::1], **arrays).digest == plain.digest
    one = {**TRIANGLE, "run": [{**TRIANGLE["run"][0], "bodies": ["b"]}]}
    several = [{"name": name, "nodes": NODES + at, "elements": ELEMENTS} for at, name in enumerate("ab")]
    assert Scene(body=several, **one).check()["bodies"][1]["start"] == [[1, 1], [2, 2]]


def test_numbers_of_numpy_paths_and_none():
    keys = copy.deepcopy(CUBES)
    keys["gravity"], keys["time"]["every"] = np.array([0, -9.8, 0]), None
    keys["body"]["lattice"]["cells"] = (np.int32(2), np.uint8(1), 1)
    keys["run"][0]["model"]["stiffness"] = np.float32(1e4)
    assert Scene(**keys).digest == Scene(**CUBES).digest
    keys["body"] = {"mesh": pathlib.Path("absent.obj"), "density": 1}
    assert "absent.obj" in str(mistake(make=Scene, **keys))


def test_mistakes_have_place_found_expected_and_remedy():
    keys = copy.deepcopy(CUBES)
    keys["run"][0]["model"]["stiffness"] = -1.0
    keys["tmie"] = keys.pop("time")
    error = mistake(make=Scene, **keys)
    assert isinstance(error, ValueError)
    assert [one.place for one in error.mistakes].count("run[0].model.stiffness") == 1
    one = next(one for one in error.mistakes if one.place == "run[0].model.stiffness")
    assert (one.found, one.expected) == ("`run[0].model.stiffness` is -1.0", "a number greater than 0")
    assert one.line is None and one.message in str(error)
    assert any("did you mean `time`?" == one.remedy for one in error.mistakes)
    assert "there is no table [time]" not in str(error)


def test_mistakes_of_files_have_lines(cubes_file):
    cubes_file.write_text(cubes_file.read_text().replace("side", "size"))
    error = mistake(make=Scene.load, path=cubes_file)
    assert (error.line, error.column, error.place) == (4, 37, "body.lattice.size")
    assert str(error).startswith(f"{cubes_file}:4:37: unknown key `size` in `body.lattice`")
    with pytest.raises(FileNotFoundError, match="did you mean .*cubes.toml"):
        Scene.load(cubes_file.with_name("cube.toml"))
    with pytest.raises(SceneError, match="this is a folder"):
        Scene.load(cubes_file.parent)


@pytest.mark.parametrize(
    ("lists", "place", "words"),
    [
        ({"nodes": NODES[:, :1]}, "body.nodes", "has the shape (4, 1); expected one row for each node with 2 or 3"),
        ({"nodes": NODES.ravel()}, "body.nodes", "has the shape (8,)"),
        ({"nodes": np.full((4, 2), "x")}, "body.nodes", "is an array of <U1; expected numbers"),
        ({"nodes": NODES * np.nan}, "body.nodes[0][0]", "is nan; expected a finite number"),
        ({"nodes": np.where(NODES == 1, np.inf, NODES)}, "body.nodes[1][0]", "is inf; expected a finite number"),
        ({"nodes": NODES[:0]}, "body.nodes", "is empty"),
        ({"elements": ELEMENTS * 1.0}, "body.elements", "is an array of float64; expected integers"),
        ({"elements": ELEMENTS + 2}, "body.elements[0][2]", "there is no node 4; the body has nodes 0 to 3"),
        ({"elements": -ELEMENTS}, "body.elements[0][1]", "is -1, but a node follows"),
        ({"elements": ELEMENTS - 5}, "body.elements[0][0]", "is -5; expected the number of a node"),
        ({"elements": ELEMENTS + 2**40}, "body.elements[0][0]", "is 1099511627776; expected the number of a node"),
        ({"elements": ELEMENTS[:, :1]}, "body.elements", "expected rows of at least 2 nodes"),
        ({"springs": ELEMENTS}, "body.springs", "has the shape (2, 3); expected one row for each spring with 2 nodes"),
        ({"springs": np.array([[0, -1]])}, "body.springs[0]", "has 1 nodes; expected 2"),
        ({"masses": np.ones(3)}, "body.masses", "has 3 entries, and the body has 4 nodes; expected one for each"),
        ({"masses": np.array([1.0, 1.0, 1.0, -1.0])}, "body.masses[3]", "is -1; expected a number greater than 0"),
        ({"velocities": np.ones((4, 3))}, "body.velocities[0]", "has 3 coordinates; expected 2"),
        ({"mass": {1, 2}}, "body.mass", "is set; expected a number"),
        ({"mass": 2**70}, "body.mass", "expected a whole number of 64 bits"),
        ({"name": "\ud800"}, "body.name", "expected text"),
    ],
)
def test_wrong_arrays(lists, place, words):
    error = mistake(**lists)
    assert place in [one.place for one in error.mistakes], error.mistakes
    assert words in str(error), str(error)


def test_no_keys_and_endless_keys():
    assert "there is no table [time]" in str(mistake(make=Scene))
    endless = []
    endless.append(endless)
    assert "nested more than 64 times" in str(mistake(make=Scene, body=endless))


def test_settings(cubes_file):
    for scene in (Scene.load(cubes_file), Scene(**CUBES)):
        before = scene.digest
        scene.set("run[0].model.stiffness", 2e4)
        other = copy.deepcopy(CUBES)
        other["run"][0]["model"]["stiffness"] = 2e4
        assert scene.digest == Scene(**other).digest != before
        for wrong, value, words in [
            ("run[0].model.stifness", 1.0, "did you mean `stiffness`?"),
            ("run[7].name", "x", "there is no `run[7]`"),
            ("run[0].model.stiffness", -1, "expected a number greater than 0"),
            ("time.duration=3\nrun", 1, "expected a key"),
            ("", 1, "expected"),
            ("time.duration", None, "is NoneType"),
        ]:
            assert words in str(mistake(wrong, value, make=scene.set))
        scene.set('run["Local shape"].model.stiffness', 1e4)
        scene.set("run[0].model.stiffness", np.float64(1e4))
        scene.set("view.labels", ["name"])
        scene.set("title", 'a "new"\ttitle'.replace("\t", " "))
        assert scene.title == 'a "new" title'


def test_arrays_are_not_set():
    scene = mesh()
    scene.set("body.mass", 2.0)
    for key in ["body.nodes", "body.nodes[0]", "body.elements[1][2]", "body"]:
        assert "cannot be set" in str(mistake(key, [1], make=scene.set))
