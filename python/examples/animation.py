"""Makes an animation in slow motion. A bar shows progress if tqdm is installed."""

import localshape

scene = localshape.Scene(
    gravity=[0, -9.8],
    time={"duration": 0.5, "frames_per_second": 30},
    body={"polygon": {"sides": 6, "radius": 0.3}, "lowest": 0.5, "rotation": {"angle": 0.3}},
    obstacle=[{"kind": "floor", "restitution": 0.8}],
    run=[{"name": "Hexagon", "model": {"kind": "shape-based", "stiffness": 2e3}}],
    view={"size": [480, 320]},
)
result = scene.simulate()
result.animate("hexagon.gif", speed=0.5, hold_last=1)
result.animate("part.apng", frames=range(5, 12), width=240)
