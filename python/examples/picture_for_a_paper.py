"""Draws one moment of two models beside each other, as PDF and SVG with text that can be searched, and as an array."""

import localshape

scene = localshape.Scene(
    title="a disc dropped on a ball",
    gravity=[0, -9.8],
    time={"duration": 0.6},
    body={"disc": {"radius": 0.5, "rings": 4, "sectors": 24}, "lowest": 0.3},
    obstacle=[{"kind": "sphere", "centre": [0.1, -0.5], "radius": 0.5, "friction": 0.5}],
    run=[
        {"name": "Local shape", "model": {"kind": "shape-based", "stiffness": 3e3, "damping_ratio": 0.1}},
        {"name": "Springs", "model": {"kind": "mass-spring", "stiffness": 3e3, "damping_ratio": 0.1}},
    ],
    view={"size": {"mm": [170, 80], "dpi": 300}, "labels": ["letters", "name", "scale-bar"], "colour": {"by": "strain"}},
)
picture = scene.simulate().frame(0.4)
for name, file in [("disc.pdf", picture.pdf()), ("disc.svg", picture.svg()), ("disc.png", picture.png())]:
    open(name, "wb").write(file)
print(picture, picture.array.shape)
