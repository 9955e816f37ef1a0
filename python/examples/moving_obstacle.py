"""Steps a world by hand: a ball follows a path that is a function in Python, and a wind blows."""

import math

import localshape
import numpy as np

scene = localshape.Scene(
    gravity=[0, -9.8, 0],
    time={"duration": 1.0},
    body={"lattice": {"cells": [4, 2, 4], "side": 0.1}, "mass": 0.1},
    obstacle=[{"kind": "floor", "friction": 0.6}, {"kind": "sphere", "name": "ball", "centre": [-0.7, 0.1, 0], "radius": 0.2}],
    run=[{"name": "Block", "model": {"kind": "shape-based", "stiffness": 500, "damping_ratio": 0.2}}],
)
world = scene.world("Block")
world.set_path("ball", lambda t: [0.3 * (1 - math.cos(math.pi * t)), 0, 0])
start = world.position.mean(axis=0)
while world.time < 1.0:
    world.set_forces(0.05 * (np.array([0, 0, 2.0]) - world.velocity))
    world.step(5)
moved = world.position.mean(axis=0) - start
print(f"The block is pushed by {moved[0]:.2f} m, and the wind moves it by {moved[2]:.2f} m.")
assert moved[0] > 0.05
