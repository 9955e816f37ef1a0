"""This program, with the tetrahedra that all engines have, or with whole cubes of the same material."""

import resource
import tempfile
from pathlib import Path

import numpy as np

SETTINGS = {"tetrahedra": {}, "cubes": dict(cubes=True), "fine": dict(step=0.0005)}


def record(scene, cubes=False, step=None):
    options = [f"time.step={step}"] if step else []
    if cubes:  # The elastic constant of a cube is half of E times the side.
        options += [f"run[0].model.damping={scene.damping_time * scene.young * scene.side / 2}"]
        options += [f"body[{body}].lattice.elements=cells" for body in range(scene.body.max() + 1)]
    folder = Path(tempfile.mkdtemp())
    options = [word for option in options for word in ("--set", option)]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    states = scene.simulate(folder, *options, "--set", f"time.duration={scene.duration}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    name = next(key for key in states if key.endswith(".position")).removesuffix(".position")
    kept = {key: states[key] for key in ("time", "elements", "faces")}
    kept |= {key: states[f"{name}.{key}"] for key in ("position", "velocity", "step")}
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    crossings = np.genfromtxt(folder / "diagnostics.csv", delimiter=",", names=True, dtype=None, encoding=None)
    crossings = crossings["crossings"][np.isin(crossings["body"], ["all", ""])]
    return dict(engine="localshape", seconds=seconds, crossings=crossings, **kept)
