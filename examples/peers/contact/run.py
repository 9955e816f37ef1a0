"""Runs a scene in one engine and writes positions and velocities at its frames."""

import argparse
import importlib
from pathlib import Path

import numpy as np

from peer import PROGRAM, Scene

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("engine", help="localshape, rapier, mujoco, newton or pybullet")
parser.add_argument("setting", help="one of SETTINGS in with_ENGINE.py")
parser.add_argument("scenes", nargs="+", help="scene files")
parser.add_argument("--until", type=float, help="end before the end of the scene (s)")
parser.add_argument("--program", default=PROGRAM, help="this program")
parser.add_argument("-o", "--out", type=Path, default=Path("output"), help="the folder of recordings")
arguments = parser.parse_args()
engine = importlib.import_module("with_" + arguments.engine)

for file in arguments.scenes:
    scene = Scene(file, arguments.program)
    scene.duration = arguments.until or scene.duration
    recording = engine.record(scene, **engine.SETTINGS[arguments.setting])
    name = f"{arguments.engine}-{arguments.setting}-{scene.file.stem}.npz"
    arguments.out.mkdir(parents=True, exist_ok=True)
    np.savez_compressed(arguments.out / name, body=scene.body, mass=scene.mass, scene=str(scene.file.resolve()), **recording)
    print(f"{name}: {recording['time'][-1]:.3f} s in {recording['seconds']:.2f} s of processor time", flush=True)
