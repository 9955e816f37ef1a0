"""Makes a body of arrays: a tube of hexahedra, held at its left end, bends under its weight."""

import localshape
import numpy as np

around, along = 12, 10
turn = 2 * np.pi * np.arange(around) / around
# Nodes: x fastest, then outwards, then around.
places = [(x, radius, angle) for angle in turn for radius in (0.15, 0.25) for x in np.linspace(-0.5, 0.5, along + 1)]
nodes = [(x, radius * np.cos(angle), radius * np.sin(angle)) for x, radius, angle in places]


def node(i, j, k):
    return i + (along + 1) * (j + 2 * (k % around))


corners = [(i, j, k) for k in (0, 1) for j in (0, 1) for i in (0, 1)]
elements = [[node(i + a, b, k + c) for a, b, c in corners] for k in range(around) for i in range(along)]

scene = localshape.Scene(
    gravity=[0, -9.8, 0],
    time={"duration": 0.5},
    body={"nodes": np.array(nodes), "elements": np.array(elements), "mass": 0.05},
    hold=[{"nodes": "left"}],
    run=[{"name": "Tube", "model": {"kind": "shape-based", "stiffness": 1e3, "damping_ratio": 0.1}}],
)
height = scene.simulate()["Tube"].position[..., 1]
print(f"The free end sinks by up to {1000 * (height[0] - height).max():.1f} mm.")
