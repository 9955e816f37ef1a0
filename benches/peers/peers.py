"""Times a step of other programs and of this one on the same scene, and prints one table.

A cube of 1 m and 1000 kg, of N³ cells, starts 2 cm above a floor. Told is the processor time of one thread for one cell and
step (microseconds, median of many steps). What is not installed is skipped with a notice: pip install numpy pypbd mujoco.

    cargo build --release && python3 benches/peers/peers.py [N ...]

The work differs: pyPBD does one iteration of one sub-step, MuJoCo a finite-element model with implicit contact.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

GAP, MASS, STEP, SECONDS = 0.02, 1000.0, 1 / 600, 3.0
PROGRAM = Path(__file__).parents[2] / "target" / "release" / "localshape"


def median_cpu(step):
    """Median processor time of a step (s)."""
    for _ in range(3):
        step()
    times, end = [], time.perf_counter() + SECONDS
    while time.perf_counter() < end or len(times) < 3:
        start = time.process_time()
        step()
        times.append(time.process_time() - start)
    return sorted(times)[len(times) // 2]


def grid(n):
    """Nodes of the cube (m), and the eight nodes of each cell, y upwards."""
    import numpy as np

    line = np.linspace(0.0, 1.0, n + 1)
    nodes = np.stack([axis.ravel() for axis in np.meshgrid(line, line, line, indexing="ij")], axis=1)
    nodes[:, 1] += GAP
    number = np.arange((n + 1) ** 3).reshape((n + 1,) * 3)
    cuts = [slice(None, -1), slice(1, None)]
    cells = np.stack([number[a, b, c].ravel() for a in cuts for b in cuts for c in cuts], axis=1)
    return nodes, cells


def pypbd(n, springs):
    import itertools

    import numpy as np
    import pypbd as pbd

    nodes, cells = grid(n)
    simulation = pbd.Simulation.getCurrent()
    simulation.initDefault()
    model = simulation.getModel()
    # The library makes particles for a mesh of tetrahedra; one in each cell is enough for that.
    tetrahedra = cells[:, [0, 1, 2, 4]]
    model.addTetModel(list(nodes), [int(node) for node in tetrahedra.ravel()], testMesh=False)
    particles = model.getParticles()
    for node in range(len(nodes)):
        particles.setMass(node, MASS / len(nodes))
    if springs:
        pairs = {tuple(sorted((int(c[i]), int(c[j])))) for c in cells for i, j in itertools.combinations(range(8), 2)}
        for i, j in pairs:
            model.addDistanceConstraint(i, j, 0.5)
    else:
        shared = np.bincount(cells.ravel())
        for cell in cells:
            model.addShapeMatchingConstraint(8, [int(node) for node in cell], [int(shared[node]) for node in cell], 0.5)
    stepper = simulation.getTimeStep()
    stepper.setValueUInt(pbd.TimeStepController.NUM_SUB_STEPS, 1)
    stepper.setValueUInt(pbd.TimeStepController.MAX_ITERATIONS, 1)
    pbd.TimeManager.getCurrent().setTimeStepSize(STEP)
    return median_cpu(lambda: stepper.step(model)) / n**3


def mujoco(n):
    import mujoco

    count, spacing = f"{n + 1} " * 3, f"{1 / n} " * 3
    model = mujoco.MjModel.from_xml_string(f"""<mujoco>
        <size memory="8G"/>
        <option timestep="{STEP}" solver="CG" tolerance="1e-6" jacobian="sparse"/>
        <worldbody>
          <geom type="plane" size="10 10 0.1"/>
          <flexcomp name="cube" type="grid" count="{count}" spacing="{spacing}" pos="0.5 0.5 {0.501 + GAP}"
                    radius="0.001" dim="3" mass="{MASS}">
            <contact selfcollide="none"/>
            <elasticity young="1e5" poisson="0.3" damping="0.001"/>
          </flexcomp>
        </worldbody>
      </mujoco>""")
    data = mujoco.MjData(model)
    return median_cpu(lambda: mujoco.mj_step(model, data)) / n**3


def localshape(n, model):
    """Ours: the time of many steps less that of few, by the program's own clock."""
    mass = MASS / (n + 1) ** 3
    stiffness = 0.02 * mass / STEP**2

    def seconds(steps):
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder) / "cube.toml"
            scene.write_text(f"""
                gravity = [0, -9.81, 0]
                time = {{ duration = {steps * STEP}, step = {STEP}, frames_per_second = {1 / (steps * STEP)} }}
                body = {{ lattice = {{ cells = [{n}, {n}, {n}], side = {1 / n} }}, mass = {mass}, lowest = {GAP} }}
                obstacle = [{{ kind = "floor" }}]
                run = [{{ name = "one", model = {{ stiffness = {stiffness}, {model} }} }}]
            """)
            command = [PROGRAM, "simulate", scene, "--threads", "1", "--frames", "1", "--quiet", "-o", f"{folder}/out"]
            subprocess.run(command, check=True)
            return json.loads((Path(folder) / "out" / "run.json").read_text())["times"]["simulate"]["cpu"]

    few, many = 10, 10 + max(20, 40_000_000 // n**3 // 10)
    return min((seconds(many) - seconds(few)) / (many - few) for _ in range(3)) / n**3


CASES = {
    "localshape, shape model": lambda n: localshape(n, 'kind = "shape-based"'),
    "localshape, paper's solver": lambda n: localshape(n, 'kind = "shape-based", rotation = "arctangent"'),
    "localshape, 13 springs a cell": lambda n: localshape(n, 'kind = "mass-spring", springs = "all"'),
    "pyPBD, shape matching": lambda n: pypbd(n, springs=False),
    "pyPBD, distances": lambda n: pypbd(n, springs=True),
    "MuJoCo, flex": mujoco,
}


def main():
    if len(sys.argv) == 4 and sys.argv[1] == "one":
        print(CASES[sys.argv[2]](int(sys.argv[3])) * 1e6)
        return
    sizes = [int(size) for size in sys.argv[1:]] or [3, 10, 20]
    print(f"{'µs a cell and step, one thread':32}" + "".join(f"{size:>9}³" for size in sizes))
    one = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
    for name in CASES:
        row = ""
        for size in sizes:
            # Each in a process of its own: libraries keep state.
            command = [sys.executable, __file__, "one", name, str(size)]
            done = subprocess.run(command, env={**os.environ, **one}, capture_output=True, text=True)
            if done.returncode != 0:
                row += "   skipped: " + done.stderr.strip().splitlines()[-1]
                break
            row += f"{float(done.stdout.splitlines()[-1]):10.4f}"
        print(f"{name:32}{row}", flush=True)


if __name__ == "__main__":
    main()
