"""Writes scenes/elastica.npz: a beam of Euler and Bernoulli, held at its left end, that hangs by its own weight, without extension.

With θ the slope downwards at the length s from the held end: E I θ'' = −w (L − s) cos θ, θ(0) = 0, θ'(L) = 0, w the weight of a unit of
length (F. Bisshopp, D. Drucker, "Large deflection of cantilever beams", Quart. Appl. Math. 3, 1945, with the load spread evenly). Nodes of
the lattice in scenes/elastica.toml stand on its cross-sections.

    python3 examples/elastica.py
"""

import pathlib
import tomllib

import numpy

scenes = pathlib.Path(__file__).parent.parent / "scenes"
scene = tomllib.loads((scenes / "elastica.toml").read_text())
body = scene["body"]
(along, across), side = body["lattice"]["cells"], body["lattice"]["side"]
length, thickness = along * side, across * side
young = next(run["model"]["young"] for run in scene["run"] if "young" in run.get("model", {}))
bending = young * thickness**3 / 12
weight = body["density"] * thickness * -scene["gravity"][1]

STEPS = 64  # of a cell


def shoot(curvature):
    """The slope at each step, and the curvature at the free end, by the method of Runge and Kutta."""
    step = side / STEPS
    rate = lambda s, theta, bend: (bend, -weight * (length - s) * numpy.cos(theta) / bending)
    theta, bend, slopes = 0.0, curvature, [0.0]
    for at in range(along * STEPS):
        s = at * step
        a = rate(s, theta, bend)
        b = rate(s + step / 2, theta + step / 2 * a[0], bend + step / 2 * a[1])
        c = rate(s + step / 2, theta + step / 2 * b[0], bend + step / 2 * b[1])
        d = rate(s + step, theta + step * c[0], bend + step * c[1])
        theta += step / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0])
        bend += step / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1])
        slopes.append(theta)
    return numpy.array(slopes), bend


# The curvature at the held end is between none and that of small deflections.
low, high = 0.0, weight * length**2 / (2 * bending)
for _ in range(60):
    middle = (low + high) / 2
    low, high = (middle, high) if shoot(middle)[1] < 0 else (low, middle)
slopes, _ = shoot((low + high) / 2)

# The places by the rule of Simpson over pairs of steps.
line = numpy.stack([numpy.cos(slopes), -numpy.sin(slopes)], axis=1)
pairs = (line[:-2:2] + 4 * line[1:-1:2] + line[2::2]) * (side / STEPS) / 3
places = numpy.vstack([[0.0, 0.0], numpy.cumsum(pairs, axis=0)])[:: STEPS // 2]
slopes = slopes[::STEPS]

normals = numpy.stack([numpy.sin(slopes), numpy.cos(slopes)], axis=1)
height = thickness / 2 + body["offset"][1]
start = numpy.array([body["offset"][0] - length / 2, height])
rows = [start + places + normals * (row * side - thickness / 2) for row in range(across + 1)]
nodes = numpy.vstack(rows)
time = numpy.array([0.0, scene["time"]["duration"]])
position = numpy.stack([nodes, nodes])
numpy.savez(scenes / "elastica.npz", time=time, position=position, velocity=0 * position, engine="Euler and Bernoulli")
print(f"w/L {-places[-1, 1] / length:.5f}, u/L {1 - places[-1, 0] / length:.5f}")
