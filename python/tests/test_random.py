"""Random arrays and values at every function: exceptions, never a crash."""

import operator
import os
import types

import numpy as np
import pytest
from conftest import CUBES, TRIANGLE
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from localshape import Recording, Scene

# As many examples as a test may take; more with LOCALSHAPE_EXAMPLES.
usual = settings(
    max_examples=int(os.environ.get("LOCALSHAPE_EXAMPLES", 100)),
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=list(HealthCheck),
)

SHAPES = arrays.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=6) | st.sampled_from([(4, 2), (4, 3), (2, 4), (12, 3), (4,)])
#: Small numbers, so that some arrays are meshes, and any others.
DTYPES = arrays.scalar_dtypes() | st.sampled_from(["f8", "i8", "u1", "f4", "O"])
NUMBERS = arrays.arrays(st.sampled_from(["f8", "i8", "i4", "u8", "f4"]), SHAPES, elements=st.integers(0, 4))
ARRAYS = NUMBERS | DTYPES.flatmap(lambda dtype: arrays.arrays(dtype, SHAPES) if dtype != "O" else st.just(np.array([None, 1], object)))
PLAIN = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5) | st.binary(max_size=5) | ARRAYS
VALUES = st.recursive(PLAIN, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3), max_leaves=5)

#: What a wrong argument may raise.
WRONG = (ValueError, TypeError, KeyError, OverflowError, OSError, MemoryError)
LISTS = ["nodes", "elements", "springs", "faces", "positions", "velocities", "masses"]
CORNERS = {"nodes": np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]), "elements": np.array([[0, 1, 2], [1, 3, 2]])}


def tried(function, *arguments, **keys):
    """Calls a function, which may refuse its arguments but not fail otherwise."""
    try:
        return function(*arguments, **keys)
    except WRONG as error:
        assert str(error), "it says why"


@usual
@given(st.dictionaries(st.sampled_from(LISTS), ARRAYS, max_size=4))
def test_bodies(lists):
    scene = tried(Scene, body={**CORNERS, **lists}, **TRIANGLE)
    if scene is not None:
        position = scene.simulate()["One"].position
        assert position.shape[0] == 3 and np.isfinite(position).all()


@usual
@given(st.dictionaries(st.sampled_from([*CUBES, "hold", "grab", "title", "contact", "x"]), VALUES, max_size=3))
def test_keys(keys):
    tried(Scene, **{**CUBES, **keys})


@pytest.fixture(scope="module")
def cubes():
    scene = Scene(**CUBES)
    return scene, scene.simulate(), scene.world("Springs")


KEYS = st.sampled_from(["gravity", "run[0].model", "run[1].step", "view.labels", "body", "body.offset", "a.b[", "[0]", "time.duration"]) | st.text(max_size=9)


@usual
@given(KEYS, VALUES)
def test_settings(cubes, key, value):
    tried(Scene(**CUBES).set, key, value)
    tried(cubes[0].simulate, value)
    tried(cubes[0].world, value)
    tried(Scene.load, value)


@usual
@given(VALUES)
def test_results(cubes, value):
    _, result, _ = cubes
    tried(result.__getitem__, value)
    tried(result.frame, value)
    tried(result.__contains__, value)


@usual
@given(VALUES, st.integers(0, 3))
def test_worlds(cubes, value, steps):
    _, _, world = cubes
    state = world.state
    for name in ("position", "velocity", "state"):
        tried(setattr, world, name, value)
    tried(world.set_forces, value)
    tried(world.set_gravity, value)
    world.step(steps)
    try:
        is_long = operator.index(value) >= 1000
    except TypeError:
        is_long = False
    if not is_long:
        tried(world.step, value)
    assert world.position.shape == (12, 3)
    assert np.isfinite(world.position).all()
    tried(world.set_forces, None)
    world.state = state


@usual
@given(st.binary(max_size=200))
def test_damaged_states(cubes, noise):
    _, _, world = cubes
    state = world.state
    at = len(noise) * 7 % len(state)
    tried(setattr, world, "state", state[:at] + noise + state[at + len(noise) :])
    world.step(2)
    world.state = state


#: What meshes of other packages have.
BLOCKS = st.lists(st.tuples(st.sampled_from(["tetra", "triangle", "wedge", "hexahedron", "polygon", "line3", "x"]) | VALUES, VALUES), max_size=3)
BLOCKS = BLOCKS.map(lambda blocks: [types.SimpleNamespace(type=kind, data=data) for kind, data in blocks])
MESHES = st.dictionaries(st.sampled_from(["points", "vertices", "faces", "cells", "celltypes"]), VALUES, max_size=4) | st.fixed_dictionaries(
    {"points": st.just(np.eye(4, 3)) | NUMBERS, "cells": BLOCKS}, optional={"point_sets": VALUES, "cell_sets": VALUES}
)


@usual
@given(MESHES.map(lambda parts: types.SimpleNamespace(**parts)) | VALUES)
def test_meshes(mesh):
    tried(Scene, body={"mesh": mesh, "density": 1.0}, **TRIANGLE)
    tried(Scene, body=[{"mesh": mesh}, mesh], **TRIANGLE)


@usual
@given(st.dictionaries(st.sampled_from(["times", "positions", "elements", "rest", "velocities", "masses", "faces", "step", "name"]), VALUES, max_size=4))
def test_recordings(parts):
    whole = {"times": [0.0, 1.0], "positions": np.tile(CORNERS["nodes"], (2, 1, 1)), "elements": CORNERS["elements"], **parts}
    mine = tried(Recording, **whole)
    if mine is not None:
        made = tried(Scene, body=CORNERS, **{**TRIANGLE, "run": [{"name": "Mine", "states": mine}]})
        if made is not None:
            assert np.isfinite(made.simulate()["Mine"].position).all()


OPTIONS = st.dictionaries(st.sampled_from(["frames", "speed", "fps", "plays", "hold_last", "width", "overwrite", "x"]), VALUES, min_size=1, max_size=2)


@usual
@given(VALUES, OPTIONS)
def test_animations(cubes, path, options):
    """No path of these has the ending of an animation, so that none is drawn."""
    tried(cubes[1].animate, path, **options)


@usual
@given(VALUES, VALUES)
def test_paths(cubes, obstacle, at):
    world = cubes[2]
    state = world.state
    tried(world.set_path, obstacle, at)
    tried(world.set_path, 0, lambda t: at)
    tried(world.step, 2)
    world.set_path(0, None)
    assert np.isfinite(world.position).all()
    world.state = state
