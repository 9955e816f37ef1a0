"""Fills a surface with elements: a ring, as an object with the arrays `vertices` and `faces`, which a mesh of trimesh has, too."""

from types import SimpleNamespace

import localshape
import numpy as np

around, across = 36, 18
u, v = np.meshgrid(2 * np.pi * np.arange(around) / around, 2 * np.pi * np.arange(across) / across, indexing="ij")
wide = 1 + 0.4 * np.cos(v)
vertices = np.stack([wide * np.cos(u), 0.4 * np.sin(v), wide * np.sin(u)], axis=-1).reshape(-1, 3)
i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
corners = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)]
faces = np.stack([(i % around * across + j % across).ravel() for i, j in corners], axis=-1)

scene = localshape.Scene(
    gravity=[0, -9.8, 0],
    time={"duration": 0.5, "frames_per_second": 30, "step": "auto"},
    body={"mesh": SimpleNamespace(vertices=vertices, faces=faces), "scale": 0.1, "density": 300.0, "fill": {"cells": 12}, "lowest": 0.05},
    obstacle=[{"kind": "floor"}],
    run=[{"name": "Ring", "model": {"kind": "shape-based", "stiffness": 300, "damping_ratio": 0.1}}],
)
result = scene.simulate()
print(f"{scene.check()['bodies'][0]['element_count']} elements carry the ring.")
open("ring.png", "wb").write(result.frame(0.5).png())
