"""What the scripts of this folder share: they read a scene and its start, and write a recording."""

import argparse
import tomllib

import numpy as np

STEP = 1 / 6000  # s: the time step or substep of all engines, far below the shortest period of both scenes
CUT = np.array([[0, 1, 2, 4], [3, 1, 7, 2], [5, 1, 4, 7], [6, 2, 7, 4], [1, 2, 4, 7]])  # five tetrahedra in a cube


class Scene:
    """The numbers that all engines are given, in SI units."""

    def __init__(self, description, models=()):
        parser = argparse.ArgumentParser(description=description)
        parser.add_argument("scene", help="a scene file")
        parser.add_argument("states", help="the states.npz that localshape wrote for it")
        parser.add_argument("recording", help="the file to write, .npz")
        if models:
            parser.add_argument("model", choices=models, help="the elastic model")
        arguments = parser.parse_args()
        self.recording, self.model = arguments.recording, vars(arguments).get("model")

        with open(arguments.scene, "rb") as file:
            scene = tomllib.load(file)
        model, time = scene["run"][0]["model"], scene["time"]
        self.gravity = np.array(scene["gravity"], float)
        self.side = scene["body"]["lattice"]["side"]
        self.stiffness, self.damping_ratio = model["stiffness"], model["damping_ratio"]
        self.young = 2 * self.stiffness / self.side  # Pa: the shape model on cubes is a material with ν = 0
        self.floor = scene.get("obstacle", [None])[0]

        states = np.load(arguments.states)
        first = next(key for key in states if key.endswith(".position"))
        self.position = states[first][0]  # an undeformed start
        self.velocity = states[first.replace(".position", ".velocity")][0]
        self.rest, self.mass, self.cubes = states["rest"], states["mass"], states["elements"]
        self.triangles = states["faces"][:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)
        self.frequency = np.sqrt(self.stiffness / self.mass[0])  # rad/s: where the damping ratio holds
        self.held = np.zeros(len(self.rest), bool)
        for box in (hold["nodes"] for hold in scene.get("hold", [])):
            low, high = np.array(box["low"]) - 1e-9, np.array(box["high"]) + 1e-9
            self.held |= ((self.position >= low) & (self.position <= high)).all(axis=1)

        # The impact is shorter than frames: the first tenth of a second is recorded every 10 ms, too.
        frames = np.arange(round(time["duration"] * time["frames_per_second"]) + 1) / time["frames_per_second"]
        self.steps = np.union1d(np.round(frames / STEP), np.round(np.arange(11) / 100 / STEP)).astype(int)

    def tetrahedra(self):
        """Right-handed tetrahedra. Every second cube is cut the other way, so that the faces of neighbours match."""
        place = np.round((self.rest - self.rest.min(axis=0)) / self.side).astype(int)
        odd = place[self.cubes[:, 0]].sum(axis=1) % 2 == 1
        mirrored = (CUT ^ 1)[:, [0, 1, 3, 2]]
        return np.concatenate([cube[mirrored if flip else CUT] for cube, flip in zip(self.cubes, odd, strict=True)])

    def record(self, engine, step, positions, stride=1):
        """Calls `step`, which takes `stride` steps, and stores `positions()` at the moments of frames."""
        recorded = []
        for before, now in zip([0, *self.steps[:-1]], self.steps, strict=True):
            for _ in range(before, now, stride):
                step()
            recorded.append(np.array(positions(), float))
            if not np.isfinite(recorded[-1]).all():
                recorded.pop()
                break
        time = self.steps[: len(recorded)] * STEP
        np.savez(self.recording, engine=engine, step=STEP, time=time, position=np.array(recorded, np.float32))
        print(f"{engine}: {len(recorded)} moments up to {time[-1]:.2f} s in {self.recording}")
