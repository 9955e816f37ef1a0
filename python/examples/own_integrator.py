"""Puts an integrator of one's own beside a model: its states are a recorded run."""

import localshape
import numpy as np

scene_keys = {
    "gravity": [0, -9.8],
    "time": {"duration": 1.0, "frames_per_second": 30},
    "body": {"nodes": np.array([[0.0, 1.0], [1.0, 1.0]]), "elements": np.array([[0, 1]]), "mass": 1.0},
    "hold": [{"nodes": [0]}],
}
model = {"name": "Springs", "model": {"kind": "mass-spring", "stiffness": 2e3}}

# The free node of a pendulum, by the leapfrog method.
step, at, speed = 1e-3, np.array([1.0, 1.0]), np.zeros(2)
times, positions = [], []
for number in range(1001):
    times.append(number * step)
    positions.append([[0.0, 1.0], at])
    arm = at - [0, 1]
    length = np.linalg.norm(arm)
    force = -2e3 * (length - 1) * arm / length + [0, -9.8]
    speed = speed + step * force * (0.5 if number == 0 else 1)
    at = at + step * speed

mine = localshape.Recording(times, positions, name="Leapfrog", step=step)
result = localshape.Scene(**scene_keys, run=[model, {"name": "Mine", "states": mine}]).simulate()
apart = np.abs(result["Mine"].position - result["Springs"].position).max()
print(f"The two are up to {1000 * apart:.2f} mm apart in 1 s.")
assert apart < 0.05
