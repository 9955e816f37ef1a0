"""Loads a scene file, changes it, simulates it, and prints when each run diverges and what is left of its energy."""

from pathlib import Path

import localshape

scene = localshape.Scene.load(Path(__file__).parents[2] / "scenes/fig4b.toml")
scene.set("time.duration", 0.5)
scene.set('run["Local shape"].model.damping_ratio', 0.2)

result = scene.simulate()
for name in result.runs:
    run = result[name]
    energy = run.diagnostics["energy"]
    print(f"{name}: {energy[0]:.1f} J, then {energy[-1]:.1f} J; diverged: {run.divergence}")
