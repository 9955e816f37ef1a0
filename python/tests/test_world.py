"""Worlds, step by step."""

import copy
import threading

import numpy as np
import pytest
from conftest import CUBES
from localshape import Scene, SceneError


@pytest.fixture
def scene():
    return Scene(**CUBES)


def test_steps_are_those_of_a_simulation(scene):
    run, world = scene.simulate()["Springs"], scene.world("Springs")
    for position, velocity, time in zip(run.position, run.velocity, run.time):
        world.step(round((time - world.time) / world.dt))
        assert world.position.tobytes() == position.tobytes() and world.velocity.tobytes() == velocity.tobytes()
        assert world.time == time
    assert world.steps == round(run.time[-1] / run.step) and world.divergence is None
    assert world.diagnostics["kinetic"] == run.diagnostics["kinetic"][-1]
    assert world.diagnostics["momentum"].shape == (3,) and world.mass.tolist() == [1.0] * 12


def test_a_state_goes_on_with_the_same_bits(scene):
    world = scene.world("Local shape")
    world.step(20)
    state, same = world.state, copy.copy(world)
    world.step(30)
    end = world.state
    for other in (same, scene.world("Local shape"), world):
        other.state = state
        other.step(30)
        assert other.state == end
    for wrong in (b"", state[:-1], scene.world("Springs").state, Scene(**{**CUBES, "body": {"polygon": {"sides": 6, "radius": 1}}, "gravity": [0, -1]}).world("Springs").state):
        if wrong == end:
            continue
        try:
            world.state = wrong
        except SceneError as error:
            assert error.place == "state"
        else:
            assert len(wrong) == len(end), "a state of as many numbers"
            world.state = end
    with pytest.raises(TypeError):
        world.state = "text"
    assert world.state == end


def test_forces_and_nodes(scene):
    scene.set("gravity", [0, 0, 0])
    scene.set("obstacle", [])
    world = scene.world("Springs")
    world.velocity = np.zeros((12, 3))
    world.set_forces(np.tile([0.0, 0.0, 2.0], (12, 1)))
    world.step(100)
    np.testing.assert_allclose(world.velocity, np.tile([0, 0, 2 * world.time], (12, 1)), atol=1e-9)
    world.set_forces(None)
    speed = world.velocity.copy()
    world.step(100)
    np.testing.assert_allclose(world.velocity, speed, atol=1e-9)
    world.position = world.position * 2
    assert np.abs(world.forces).max() > 1
    world.set_gravity([0, -1, 0])
    world.set_gravity(np.array([0, -1, 0.5]))


def test_obstacles_along_paths(scene):
    """A floor that rises pushes the cubes up; one that sinks leaves them behind."""
    scene.set("obstacle[0].name", "floor")
    world, calls = scene.world("Local shape"), []

    def rise(t):
        calls.append(t)
        return [0, 0.5 * t, 0]

    world.set_path("floor", rise)
    assert calls == [0.0, world.dt]
    world.step(50)
    assert calls[-2:] == [49 * world.dt, 50 * world.dt] and len(calls) == 2 + 2 * 50
    world.step(round(0.5 / world.dt))
    lowest = world.position[:, 1].min()
    assert lowest >= 0.5 * world.time - 1e-9
    # A copy goes on with the same bits, and neither moves the floor of the other.
    same, other = copy.copy(world), copy.copy(world)
    other.set_path(0, lambda t: np.zeros(6))
    for one in (same, other, world):
        one.step(20)
    assert same.state == world.state != other.state
    world.set_path("floor", None)
    world.step(round(0.5 / world.dt))
    assert world.position[:, 1].min() < lowest


def test_a_path_is_that_of_the_same_keys(scene):
    def path(t):
        return [0, 0.2 * t, 0, 0, 0, 0.1 * t]

    turned = {"axis": [0, 0, 1], "angle": 0.1}
    scene.set("obstacle[0].path", {"keys": [{"time": 0}, {"time": 1, "shift": [0, 0.2, 0], "rotation": turned}], "ease": "linear"})
    keys = scene.world("Local shape")
    scene.set("obstacle[0].path", {"keys": [{"time": 0}, {"time": 9}]})
    world = scene.world("Local shape")
    world.set_path(0, path)
    for one in (keys, world):
        one.step(200)
    np.testing.assert_allclose(world.position, keys.position, atol=1e-9)


def test_paths_that_fail(scene):
    world = scene.world("Springs")

    def late(t):
        if t > 10 * world.dt:
            raise ZeroDivisionError("its own")
        return (0, 0, 0)

    world.set_path(0, late)
    with pytest.raises(ZeroDivisionError, match="its own"):
        world.step(100)
    assert world.steps == 10
    for wrong in (None, 3, "abc", [0, 0], [0, np.nan, 0], [0, np.inf, 0], [0, 1e300, 0], np.zeros((3, 3)), [0, 0, 0, 0], {}):
        with pytest.raises(SceneError, match="expected three finite numbers") as caught:
            world.set_path(0, lambda t, wrong=wrong: wrong)
        assert caught.value.place == "obstacle[0]"
    with pytest.raises(TypeError):
        world.set_path(0, 3)
    for wrong in (1, "roof"):
        with pytest.raises(KeyError, match="no obstacle"):
            world.set_path(wrong, late)
    for wrong in (-1, 2**70, 1.5, None):
        with pytest.raises((OverflowError, TypeError)):
            world.set_path(wrong, late)
    # A path may look at the world, but not advance it.
    world.set_path(0, lambda t: [0, min(world.position[:, 1].min(), 0), 0])
    world.step(3)
    world.set_path(0, lambda t: world.step() if t > 14 * world.dt else [0, 0, 0])
    with pytest.raises((RuntimeError, RecursionError, SceneError)):
        world.step(5)


@pytest.mark.parametrize("name", ["position", "velocity", "forces"])
def test_wrong_arrays(scene, name):
    world = scene.world("Springs")
    give = world.set_forces if name == "forces" else lambda array: setattr(world, name, array)
    before = world.state
    for wrong in (np.zeros((11, 3)), np.zeros((12, 2)), np.zeros(36), np.array(1.0), np.full((12, 3), "x"), np.zeros((12, 3), complex)):
        with pytest.raises(SceneError) as caught:
            give(wrong)
        assert caught.value.place == name
    for number in (np.nan, np.inf):
        with pytest.raises(ValueError, match="finite"):
            give(np.full((12, 3), number))
    with pytest.raises(TypeError):
        give([[0, 0, 0]] * 12)
    assert world.state == before


def test_wrong_calls(scene):
    with pytest.raises(KeyError, match="its runs are"):
        scene.world()
    world = scene.world("Springs")
    for wrong in (-1, 2**64):
        with pytest.raises(OverflowError):
            world.step(wrong)
    with pytest.raises(ValueError, match="finite"):
        world.set_gravity([0, np.nan, 0])


def test_two_worlds_run_at_once(scene):
    """While one thread steps, another one steps another world and Python goes on; the same world is refused."""
    scene.set("body.lattice.cells", [12, 12, 12])
    first, second, done = scene.world("Local shape"), scene.world("Local shape"), threading.Event()

    def step():
        first.step(2000)
        done.set()

    thread = threading.Thread(target=step)
    thread.start()
    steps = refused = 0
    while not done.is_set():
        second.step(1)
        steps += 1
        try:
            first.position
        except RuntimeError as error:
            assert "another thread is using this world" in str(error)
            refused += 1
    thread.join()
    assert refused > 0 and steps > 1
    assert first.steps == 2000
