"""Writes scenes of two soft cubes that meet with 20 m/s, turned at random: 24 of them, and a wall whose cubes are apart."""

import re
import sys
from pathlib import Path

import numpy as np

SCENE = """title = "Impact {index}"
time = {{ duration = 1.03, step = 0.00125, frames_per_second = 240 }}
body = [
    {{ name = "left", {cube}, rotation = {left}, offset = [-0.35, 0, 0], velocity = [10, 0, 0] }},
    {{ name = "right", {cube}, rotation = {right}, offset = {offset}, velocity = [-10, 0, 0] }},
]
run = [{{ name = "Local shape", model = {{ kind = "shape-based", young = 2e4, damping = 2.108, damping_of = "deformation" }} }}]
"""
CUBE = 'lattice = { cells = [3, 3, 3], side = 0.1, elements = "tetrahedra" }'


def rotation(random):
    """A rotation at random, equally dense over all: that of a quaternion."""
    real, *axis = random.normal(size=4)
    return f"{{ axis = {np.array(axis).tolist()}, angle = {2 * np.arctan2(np.linalg.norm(axis), real)} }}"


folder = Path(sys.argv[1] if len(sys.argv) > 1 else "scenes")
folder.mkdir(parents=True, exist_ok=True)
for index in range(24):
    random = np.random.default_rng(1000 + index)
    offset = [0.35, *random.uniform(-0.1, 0.1, 2).tolist()]
    scene = SCENE.format(index=index, cube=CUBE, left=rotation(random), right=rotation(random), offset=offset)
    (folder / f"impact-{index:02}.toml").write_text(scene)

wall = Path("wall.toml").read_text().replace("A wall of ten cubes", "Ten cubes apart").replace("gravity", "# gravity")
places = iter(f"offset = [{2 * index - 10}, 3, 0]" for index in range(10))
(folder / "apart.toml").write_text(re.sub(r"offset = \[.*\]", lambda _: next(places), wall))
