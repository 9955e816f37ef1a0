"""Sweeps a stiffness: how far a block sinks under its weight."""

import localshape

scene = localshape.Scene(
    gravity=[0, -9.8, 0],
    time={"duration": 0.5, "frames_per_second": 50, "start": "equilibrium"},
    body={"lattice": {"cells": [2, 4, 2], "side": 0.1}, "mass": 0.1},
    hold=[{"nodes": "bottom"}],
    run=[{"name": "Block", "model": {"kind": "shape-based", "stiffness": 1e3, "damping_ratio": 0.2}}],
)
sunk = []
for stiffness in [250, 500, 1000, 2000]:
    scene.set("run[0].model.stiffness", stiffness)
    position = scene.simulate()["Block"].position
    sunk.append(0.4 - position[-1, :, 1].max())
    print(f"{stiffness} N/m: {1000 * sunk[-1]:.2f} mm")
assert sunk == sorted(sunk, reverse=True)
