"""Meshes of other packages as bodies, and recordings as runs."""

import copy
import gc
import os
import tempfile
import types

import meshio
import numpy as np
import pytest
import trimesh
from conftest import CUBES, TRIANGLE
from localshape import Recording, Scene, SceneError

CUBE = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
#: The corners of a hexahedron in the order of VTK.
AROUND = [[0, 1, 3, 2, 4, 5, 7, 6]]
RUN = {"name": "One", "model": {"kind": "shape-based", "stiffness": 1e3}}


def scene(of, **keys):
    whole = {"body": {"density": 1000.0, **of}, "time": {"duration": 0.1, "frames_per_second": 20}, "run": [RUN]}
    return Scene(**whole | keys)


def mistake(make, *arguments, **keys):
    with pytest.raises(SceneError) as caught:
        make(*arguments, **keys)
    return caught.value


def grid(points, cells, kinds):
    """What pyvista's grids have."""
    return types.SimpleNamespace(points=points, cells=np.array(cells), celltypes=np.array(kinds, "u1"))


def test_cells_of_meshio(tmp_path):
    """They mean what a file of them means."""
    mesh = meshio.Mesh(CUBE, [("hexahedron", AROUND)])
    mesh.write(tmp_path / "cube.vtu")
    given, named = scene({"mesh": mesh}), scene({"mesh": tmp_path / "cube.vtu"})
    assert given.simulate()["One"].position.tobytes() == named.simulate()["One"].position.tobytes()
    assert given.check()["bodies"][0]["element_count"] == 1
    lists = scene({"nodes": CUBE, "elements": np.arange(8)[None]})
    np.testing.assert_array_equal(given.simulate()["One"].position, lists.simulate()["One"].position)


def test_cells_of_several_kinds_and_of_higher_order():
    """Faces beside cells, and points between corners, are left out with a warning, as of files."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1], [0.5, 0, 0], [0, 0.5, 0], [0.5, 0.5, 0], [0, 0, 0.5], [0.5, 0, 0.5], [0, 0.5, 0.5]], float)
    second = meshio.Mesh(points, [("tetra10", [[0, 1, 2, 3, 5, 7, 6, 8, 9, 10]]), ("tetra", [[1, 2, 3, 4]]), ("triangle", [[0, 1, 2]])])
    made = scene({"mesh": second})
    assert made.simulate()["One"].position.shape == (3, 5, 3)
    assert any("Mesh.vtk` has" in one.message for one in made.warnings), made.warnings
    wedge = meshio.Mesh(CUBE, [("wedge", [[0, 1, 2, 4, 5, 6]])])
    assert scene({"mesh": wedge}).check()["bodies"][0]["nodes"] == 6
    flat = meshio.Mesh(CUBE[:4, :2], [("triangle", [[0, 1, 2]]), ("quad", [[0, 1, 3, 2]])])
    assert scene({"mesh": flat}, view=TRIANGLE["view"]).check()["bodies"][0]["extent"] == [1, 1]


def test_groups_of_meshio():
    """Sets are names of nodes."""
    two = np.vstack([CUBE, CUBE[4:] + [0, 0, 1]])
    cells = [("hexahedron", [AROUND[0], [4, 5, 7, 6, 8, 9, 11, 10]])]
    mesh = meshio.Mesh(two, cells, point_sets={"tip": [8, 9]}, cell_sets={"base": [[0]], "gmsh:bounding_entities": [[5]]})
    made = scene({"mesh": mesh}, hold=[{"nodes": "base"}], gravity=[0, -9.8, 0])
    position = made.simulate()["One"].position
    moved = np.abs(position[-1] - position[0]).max(axis=1) > 0
    assert moved.sum() == 4 and made.check()["bodies"][0]["nodes"] == 12
    made = scene({"mesh": mesh}, hold=[{"nodes": "tip"}], gravity=[0, -9.8, 0])
    position = made.simulate()["One"].position
    assert (np.abs(position[-1] - position[0]).max(axis=1) == 0).sum() == 2
    plain = meshio.Mesh(two, cells)
    assert made.digest != scene({"mesh": plain}).digest
    one = scene({"mesh": mesh}).simulate()["One"].position
    np.testing.assert_array_equal(one, scene({"mesh": plain}).simulate()["One"].position)


def test_surfaces_of_trimesh(tmp_path):
    """They are filled, as of files."""
    ball = trimesh.creation.icosphere(subdivisions=1, radius=0.5)
    body = {"fill": {"with": "cubes", "cells": 4}, "lowest": 0.2, "scale": 2.0, "up": "z"}
    made = scene({**body, "mesh": ball})
    assert made.check()["bodies"][0]["element_count"] > 20
    with (tmp_path / "ball.obj").open("w") as file:
        file.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in ball.vertices.tolist())
        file.writelines(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in ball.faces.tolist())
    named = scene({**body, "mesh": tmp_path / "ball.obj"})
    assert made.simulate()["One"].position.tobytes() == named.simulate()["One"].position.tobytes()
    several = trimesh.Scene([ball])
    assert scene({**body, "mesh": several}).check()["bodies"][0]["element_count"] == made.check()["bodies"][0]["element_count"]
    # Any object with such arrays.
    other = types.SimpleNamespace(vertices=ball.vertices, faces=ball.faces)
    assert scene({**body, "mesh": other}).digest == made.digest
    made.set("view.size", [320, 180])
    assert made.simulate().frame(0).array.shape == (180, 320, 4)


def test_grids_of_pyvista():
    cells = grid(CUBE, [8, *AROUND[0]], [12])
    made = scene({"mesh": cells})
    assert made.digest == scene({"mesh": meshio.Mesh(CUBE, [("hexahedron", AROUND)])}).digest
    # Other grids are turned into these.
    other = types.SimpleNamespace(points=CUBE, cast_to_unstructured_grid=lambda: cells)
    assert scene({"mesh": other}).digest == made.digest
    sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    surface = types.SimpleNamespace(points=CUBE, faces=np.insert(sides, 0, 4, axis=1).ravel())
    filled = scene({"mesh": surface, "fill": {"cells": 2}})
    assert filled.check()["bodies"][0]["element_count"] == 8


def test_several_bodies_and_settings(tmp_path, monkeypatch):
    """A scene keeps what it was given, and the files of it end with it."""
    mesh = meshio.Mesh(CUBE.copy(), [("hexahedron", AROUND)])
    bodies = [{"name": name, "mesh": mesh, "density": 1.0, "offset": [3.0 * at, 0, 0]} for at, name in enumerate("ab")]
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    made = scene({}, **{"body": bodies, "run": [{**RUN, "bodies": ["a", "b"]}]})
    mesh.points[0] = np.nan
    assert [len(os.listdir(folder)) for folder in tmp_path.iterdir()] == [2]
    made.set("body[0].scale", 2.0)
    made.set("run[0].model.stiffness", 2e3)
    result = made.simulate()
    assert np.isfinite(result["One"].position).all() and result["One"].position.shape[1] == 16
    del made, result
    gc.collect()
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(
    ("mesh", "place", "found", "expected", "remedy"),
    [
        (object(), "body.mesh", "is object", "points and cells", "meshio, trimesh or pyvista"),
        (7, "body.mesh", "is the whole number 7", "a string", None),
        (grid(CUBE, [8, *range(8)], [42]), "body.mesh.celltypes", "has polyhedra", "hexahedra", "save it as a .vtu file"),
        (grid(CUBE, [4, 0, 1, 2, 8], [10]), "body.mesh.cells[4]", "is 8", "from 0 to 7", None),
        (grid(CUBE, [4, 0, 1, 2], [10]), "body.mesh.cells[0]", "is 4", "these behind it", None),
        (grid(CUBE, [4, 0, 1, 2, 3], [10, 10]), "body.mesh.celltypes", "has 2 entries", "each of 1 cells", None),
        (grid(CUBE, [4, 0, 1, 2, 3], [99]), "body.mesh", "type 99", "a type of cells", "linear"),
        (types.SimpleNamespace(vertices=CUBE, faces=[[0, 1, -1]]), "body.mesh.faces[0][2]", "is -1", "from 0 to 7", None),
        (types.SimpleNamespace(vertices=CUBE, faces=[[0.5, 1, 2]]), "body.mesh.faces", "float64", "integers", None),
        (types.SimpleNamespace(vertices=CUBE[:, :1], faces=[[0, 1, 2]]), "body.mesh.vertices", "(8, 1)", "2 or 3 coordinates", None),
        (types.SimpleNamespace(vertices=[[0], [1, 2]], faces=[]), "body.mesh.vertices", "is no array", "numbers", None),
        (meshio.Mesh(CUBE, [("VTK_LAGRANGE_TETRAHEDRON", [[0, 1, 2, 3]])]), "body.mesh.cells[0]", "of the type VTK", "tetrahedra", "a .vtu file"),
        (meshio.Mesh(CUBE, [("polyhedron8", [[[0, 1, 2], [3, 4, 5]]])]), "body.mesh.cells[0]", "polyhedron8", "tetrahedra", "a .vtu file"),
        (meshio.Mesh(CUBE, [("line", [[0, 1]])]), "body.mesh", "neither faces nor cells", None, "of triangles or of cells"),
        (meshio.Mesh(CUBE, []), "body.mesh", "neither faces nor cells", None, "of triangles or of cells"),
        (types.SimpleNamespace(points=CUBE, cells=[types.SimpleNamespace(type="tetra", data=[0, 1])]), "body.mesh.cells[0].data", "(2,)", "one row", None),
        (types.SimpleNamespace(points=CUBE, cells=3), "body.mesh.cells", "is int", "a list of blocks of cells", None),
        (meshio.Mesh(CUBE * np.nan, [("hexahedron", AROUND)]), "body.mesh", "without coordinates", "numbers", None),
        (meshio.Mesh(CUBE, [("hexahedron", AROUND)], point_sets={"a": [9]}), "body.mesh.point_sets['a']", "not there", "numbers of points", None),
    ],
)
def test_wrong_meshes(mesh, place, found, expected, remedy):
    error = mistake(scene, {"mesh": mesh})
    assert error.place == place, error
    for part, words in [(error.found, found), (error.expected, expected), (error.remedy, remedy)]:
        assert words is None or words in (part or ""), (part, words)
    assert "localshape-" not in str(error), "no name of a temporary folder"


def integrated(steps=20, step=0.005):
    """A body in free fall, by an integrator of one's own."""
    at, speed, times, course = CUBE.copy(), np.zeros((8, 3)), [0.0], [CUBE.copy()]
    for number in range(1, steps + 1):
        speed[:, 1] -= 9.8 * step
        at = at + step * speed
        times.append(number * step)
        course.append(at.copy())
    return np.array(times), np.array(course)


def test_a_recording_beside_simulated_runs():
    times, course = integrated()
    keys = {"body": {"nodes": CUBE, "elements": np.arange(8)[None]}, "gravity": [0, -9.8, 0]}
    mine = Recording(times, course, name="My integrator", step=0.005)
    result = Scene(**TRIANGLE | keys | {"run": [RUN, {"name": "Mine", "states": mine}]}).simulate()
    assert result.runs == ["One", "Mine"]
    # Frames are at 0, 0.05 and 0.1 s.
    np.testing.assert_array_equal(result["Mine"].position, course[::10])
    np.testing.assert_allclose(result["Mine"].position, result["One"].position, atol=0.01)
    assert np.isnan(result["Mine"].diagnostics["elastic"]).all() and result["Mine"].diagnostics["kinetic"][-1] > 0
    assert result.frame(0.1).array.any() and "My integrator" in repr(mine)


def test_a_recording_with_a_body_of_its_own():
    times, course = integrated()
    rows = [[0, 1, 2, 3, 4, 5, 6, 7], [0, 1, 2, 4]]
    mine = Recording(times, course, rows, velocities=np.zeros_like(course), masses=np.full(8, 2.0))
    body = {"lattice": {"cells": [2, 1, 1], "side": 0.1}}
    made = Scene(**CUBES | {"body": body, "run": [RUN, {"name": "Mine", "states": mine}]})
    result = made.simulate()
    assert result["Mine"].position.shape == (5, 8, 3) and result["One"].position.shape == (5, 12, 3)
    assert result["Mine"].diagnostics["kinetic"][0] == 0
    assert result["Mine"].divergence.is_end, "the recording ends after 0.1 s of 0.2 s"
    digest, again = made.digest, Recording(times, course, rows, velocities=np.zeros_like(course), masses=np.full(8, 2.0))
    course[:] = 0
    assert made.digest == digest == Scene(**CUBES | {"body": body, "run": [RUN, {"name": "Mine", "states": again}]}).digest


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"positions": np.zeros((5, 8, 2))}, "has 2 coordinates for each node, and the scene is in space; expected 3"),
        ({"positions": np.zeros((5, 7, 3))}, "has 7 nodes, and the bodies of the run have 8"),
        ({"positions": np.zeros((5, 8))}, "has the shape (5, 8); expected moments × nodes × 3"),
        ({"positions": np.zeros((4, 8, 3))}, "expected 4, one time for each moment"),
        ({"positions": np.full((5, 8, 3), np.nan)}, "position[0][0][0]` is NaN; expected a finite number"),
        ({"positions": 3.0}, "has the shape ()"),
        ({"times": [0, 1, 1, 2, 3], "positions": np.random.default_rng(1).random((5, 8, 3))}, "time[2]` is 1, after 1; expected rising times"),
        ({"velocities": np.zeros((5, 8, 2))}, "has the shape (5, 8, 2); expected (5, 8, 3), as `position`"),
        ({"elements": [[0, 1, 2, 9]]}, "there is no node 9"),
        ({"masses": np.ones(8)}, "belongs to a body, whose nodes at rest are missing"),
        ({"step": -1.0}, "expected a time step (s) above 0"),
        ({"name": "two\nlines"}, "up to 80 letters on one line"),
    ],
)
def test_wrong_recordings(change, words):
    given = {"times": np.arange(5.0), "positions": np.tile(CUBE, (5, 1, 1)), **change}
    mine = Recording(**given)
    keys = {"body": {"nodes": CUBE, "elements": np.arange(8)[None]}, "run": [{"name": "Mine", "states": mine}]}
    error = mistake(Scene, **TRIANGLE | keys)
    assert words in str(error) and "Recording.npz" in str(error) and "localshape-" not in str(error), str(error)


@pytest.mark.parametrize("value", ["text", [None], [1j], [[1], "no"], np.array([object()])])
@pytest.mark.parametrize("key", ["times", "positions", "rest", "velocities", "masses", "step", "elements", "faces"])
def test_arrays_that_are_no_numbers(key, value):
    error = mistake(Recording, **{"times": [0.0], "positions": np.zeros((1, 8, 3)), key: value})
    assert error.place == key and error.expected in ("numbers", "integers")


def test_goldens_do_not_name_the_folder(tmp_path):
    """It has another name each time."""
    from localshape import _core

    mesh = meshio.Mesh(CUBE[:4, :2], [("quad", [[0, 1, 3, 2]])])
    for accepts in (True, False):
        result = scene({"mesh": mesh}, view=TRIANGLE["view"]).simulate()
        verdict, passes, words, _ = _core._compare(result, tmp_path / "golden", ("test", "command"), accepts, None)
    assert passes and verdict == "identical" and "localshape-" not in (tmp_path / "golden/golden.toml").read_text()
    keys = copy.deepcopy(TRIANGLE)
    keys["run"][0]["model"]["stiffness"] = 2e3
    result = scene({"mesh": mesh, "velocity": [0, 1]}, view=TRIANGLE["view"]).simulate()
    _, passes, words, _ = _core._compare(result, tmp_path / "golden", ("test", "command"), False, None)
    assert not passes and "body.velocity" in words and "body.mesh" not in words
