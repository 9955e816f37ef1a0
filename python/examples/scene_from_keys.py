"""Makes a scene of keys: nested dicts with the keys of scene files."""

import localshape

scene = localshape.Scene(
    title="two models on a slope",
    gravity=[0, -9.8, 0],
    time={"duration": 0.5, "frames_per_second": 30},
    body={"lattice": {"cells": [3, 1, 2], "side": 0.1}, "lowest": 0.2},
    obstacle=[{"kind": "floor", "normal": [0.2, 1, 0], "friction": 0.4}],
    run=[
        {"name": "Local shape", "model": {"kind": "shape-based", "stiffness": 1e4}},
        {"name": "Springs", "model": {"kind": "mass-spring", "stiffness": 1e4}},
    ],
)
print(scene, scene.check()["bodies"][0]["elements"])

try:
    scene.set("run[0].model.stifness", 2e4)
except localshape.SceneError as error:
    print(f"{error.place}: {error.found}; {error.remedy}")

result = scene.simulate()
print("how far each model slides (m):", {name: result[name].position[-1].mean(axis=0)[0].round(3) for name in result.runs})
