"""Simulates a mesh of meshio, whose sets of points and cells are names of nodes. `meshio.read` makes one of a file."""

import localshape
import meshio
import numpy as np

x, y, z = np.meshgrid(np.linspace(0, 1, 11), np.linspace(0, 0.2, 3), np.linspace(0, 0.2, 3), indexing="ij")
points = np.stack([x, y, z], axis=-1).reshape(-1, 3)
number = np.arange(len(points)).reshape(x.shape)
around = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
cells = [number[a : a + 10, b : b + 2, c : c + 2].ravel() for a, b, c in around]
mesh = meshio.Mesh(points, [("hexahedron", np.stack(cells, axis=-1))], point_sets={"wall": number[0].ravel()})

scene = localshape.Scene(
    gravity=[0, -9.8, 0],
    time={"duration": 0.5, "frames_per_second": 30, "step": "auto"},
    body={"mesh": mesh, "density": 1000.0},
    hold=[{"nodes": "wall"}],
    run=[{"name": "Beam", "model": {"kind": "corotational", "young": 1e6, "poisson": 0.3}}],
)
position = scene.simulate()["Beam"].position
print("nodes that stay:", int((position == position[0]).all(axis=(0, 2)).sum()), "of", len(points))
