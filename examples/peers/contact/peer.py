"""What the scripts of this folder share: a scene as all engines read it."""

import subprocess
import tempfile
import time
import tomllib
from pathlib import Path

import numpy as np

PROGRAM = "localshape"  # the program that reads scenes; `run.py --program` tells another


class Scene:
    """The numbers that all engines are given, in SI units. y points up."""

    def __init__(self, file, program=PROGRAM):
        self.file, self.program = Path(file), program
        with open(file, "rb") as stream:
            scene = tomllib.load(stream)
        model, time = scene["run"][0]["model"], scene["time"]
        self.gravity = np.array(scene.get("gravity", [0, 0, 0]), float)
        self.duration, self.rate = time["duration"], time["frames_per_second"]
        self.side = scene["body"][0]["lattice"]["side"]
        self.young = model["young"]
        # The stiffest tetrahedron is the middle one of the five in a cube. Its elastic constant is a third of E times the side.
        self.damping_time = model["damping"] / (self.young * self.side / 3)  # s: damping is this times the stiffness
        self.friction = scene.get("contact", {}).get("friction", 0.0)
        self.floor = any(obstacle["kind"] == "floor" for obstacle in scene.get("obstacle", []))
        self.rod = rod_of(file)

        start = self.simulate(Path(tempfile.mkdtemp()), "--frames", "0")
        first = next(key for key in start if key.endswith(".position"))
        self.position, self.velocity = start[first][0], start[first.replace(".position", ".velocity")][0]
        self.mass, self.tetrahedra, self.faces = start["mass"], start["elements"], start["faces"]
        self.body = start["body"] if "body" in start else np.zeros(len(self.mass), int)
        self.held = np.zeros(len(self.mass), bool)
        if scene.get("hold"):  # the bottom is the only side that scenes of this folder hold
            self.held = start["rest"][:, 1] < 1e-9

    def simulate(self, folder, *options):
        """The states that this program computes."""
        subprocess.run([self.program, "simulate", self.file, "--states", "--threads", "1", "--quiet", "-o", folder, *options], check=True)
        return np.load(folder / "states.npz")

    def record(self, engine, dt, step, state, move=None):
        """Calls `step`, which takes one step of `dt`, and keeps `state()` at frames. `move` places the rod at the end of a step."""
        stride = max(1, round(1 / self.rate / dt))
        frames = [np.array(state(), float)]
        moments, seconds = [0.0], 0.0
        for frame in range(1, int(self.duration / (stride * dt) + 1e-9) + 1):
            before = time.process_time()
            for taken in range(1, stride + 1):
                if self.rod:
                    move(self.rod.at(((frame - 1) * stride + taken) * dt))
                step()
            seconds += time.process_time() - before
            frames.append(np.array(state(), float))
            moments.append(frame * stride * dt)
            if not np.isfinite(frames[-1]).all():
                break
        position, velocity = np.swapaxes(frames, 0, 1)
        return dict(engine=engine, step=dt, time=np.array(moments), position=position, velocity=velocity, seconds=seconds,
                    elements=self.tetrahedra, faces=self.faces)

    def bodies(self):
        """For each body its nodes, and its tetrahedra by the numbers of these."""
        for body in range(self.body.max() + 1):
            nodes = np.flatnonzero(self.body == body)
            own = self.tetrahedra[self.body[self.tetrahedra[:, 0]] == body]
            yield nodes, own - nodes[0]


def rod_of(file):
    """The rod of a scene file, or nothing."""
    with open(file, "rb") as stream:
        obstacles = tomllib.load(stream).get("obstacle", [])
    return next((Rod(obstacle) for obstacle in obstacles if obstacle["kind"] == "capsule"), None)


class Rod:
    """A capsule along z that a path lowers."""

    def __init__(self, capsule):
        ends = np.array([capsule["from"], capsule["to"]], float)
        self.radius, self.centre, self.half = capsule["radius"], ends.mean(axis=0), np.ptp(ends[:, 2]) / 2
        self.keys = capsule["path"]["keys"]

    def at(self, time):
        """The centre at a time."""
        times, shifts = [key["time"] for key in self.keys], [key.get("shift", [0, 0, 0])[1] for key in self.keys]
        return self.centre + [0, np.interp(time, times, shifts), 0]
