"""Writes scenes/contact/rolling.npz: a rigid disc that rolls down the slope in scenes/contact/slope.toml without sliding.

Its centre moves by s = a t²/2 with a = 2/3 g sin θ, and it turns by s/r.

    python3 examples/rolling.py
"""

import pathlib
import tomllib

import numpy

scenes = pathlib.Path(__file__).parent.parent / "scenes" / "contact"
scene = tomllib.loads((scenes / "slope.toml").read_text())
across, up = scene["obstacle"][0]["normal"]
down = numpy.array([up, -across])
body = scene["body"]
radius, rings, sectors = (body["disc"][key] for key in ("radius", "rings", "sectors"))
# Nodes from the centre outwards, in each ring from the left end of the lowest side, before the disc is turned onto the slope.
angles = (2 * numpy.arange(sectors) - 1) * numpy.pi / sectors - numpy.pi / 2 + body["rotation"]["angle"]
circle = numpy.stack([numpy.cos(angles), numpy.sin(angles)], axis=1)
arms = numpy.vstack([[0.0, 0.0], *(circle * radius * (ring + 1) / rings for ring in range(rings))])
centre = numpy.array(body["offset"]) + [0, radius * numpy.cos(numpy.pi / sectors)]
acceleration = -scene["gravity"][1] * across / 1.5
frames = round(scene["time"]["duration"] * scene["time"]["frames_per_second"]) + 1
time = numpy.arange(frames) / scene["time"]["frames_per_second"]
ways = 0.5 * acceleration * time**2
turns = -ways / radius
cosine, sine = numpy.cos(turns)[:, None], numpy.sin(turns)[:, None]
turned = numpy.stack([cosine * arms[:, 0] - sine * arms[:, 1], sine * arms[:, 0] + cosine * arms[:, 1]], axis=2)
position = centre + ways[:, None, None] * down + turned
numpy.savez_compressed(scenes / "rolling.npz", time=time, position=position.astype(numpy.float32))
