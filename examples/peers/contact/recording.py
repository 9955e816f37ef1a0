"""A recording of any engine, and what its positions and velocities tell."""

import numpy as np

from geometry import crossing, inside, winding
from peer import rod_of

CUT = np.array([[0, 1, 2, 4], [3, 1, 7, 2], [5, 1, 4, 7], [6, 2, 7, 4], [1, 2, 4, 7]])  # five tetrahedra in a cube
ARM = 0.5  # m: angular momenta are told as shares of the sum of m |v| times this
CELL = 0.1  # m


class Recording:
    def __init__(self, file):
        data = np.load(file)
        self.engine, self.setting, self.scene = file.stem.split("-", 2)
        self.time, self.position, self.velocity = data["time"], data["position"], data["velocity"]
        self.mass, self.body, self.file = data["mass"], data["body"], str(data["scene"])
        self.step, self.seconds = float(data["step"]), float(data["seconds"])
        self.own = data["crossings"] if "crossings" in data else None
        self.finite = np.isfinite(self.position).all(axis=(1, 2))

        # A quadrilateral is a fan of triangles around its middle, which follows the nodes.
        faces, nodes = data["faces"], len(self.mass)
        self.middles = faces if faces.shape[1] == 4 else np.zeros((0, 4), int)
        middles = nodes + np.arange(len(self.middles))
        fan = [np.stack([faces[:, k], faces[:, (k + 1) % 4], middles], axis=1) for k in range(4)] if len(middles) else [faces]
        triangles = np.concatenate(fan)
        self.surfaces = [triangles[self.body[triangles[:, 0]] == body] for body in range(self.body.max() + 1)]

        # The volume of a cube is the mean of its two cuts.
        elements = data["elements"]
        cells = elements[:, None, [0, 1, 2, 3]] if elements.shape[1] == 4 else elements[:, np.concatenate([CUT, CUT ^ 1])]
        sign = np.sign(self.volumes(cells, 0))
        turned = [int(((sign * self.volumes(cells, frame)).sum(axis=1) < 0).sum()) for frame in np.flatnonzero(self.finite)]
        self.turned_over, self.turned_at_end, self.elements = max(turned), turned[-1], len(elements)

    def volumes(self, cells, frame):
        corners = self.position[frame][cells]
        return np.linalg.det(corners[..., 1:, :] - corners[..., :1, :])

    def points(self, frame):
        position = self.position[frame]
        return np.concatenate([position, position[self.middles].mean(axis=1)])

    def changes(self):
        """The largest changes of momentum and of angular momentum, as shares, and the final kinetic energy as one."""
        x, v, m = self.position[self.finite], self.velocity[self.finite], self.mass[:, None]
        momentum, angular = (m * v).sum(axis=1), (m * np.cross(x, v)).sum(axis=1)
        scale = (m[:, 0] * np.linalg.norm(v[0], axis=1)).sum()
        energy = (m * v**2).sum(axis=(1, 2))
        largest = [np.linalg.norm(each - each[0], axis=1).max() for each in (momentum, angular)]
        return largest[0] / scale, largest[1] / scale / ARM, energy[-1] / energy[0]

    def crossings(self):
        """In each frame the number of pairs of triangles of different bodies that cross."""
        found = []
        for frame in np.flatnonzero(self.finite):
            x = self.points(frame)
            found.append(sum(crossing(x[a], x[b]) for n, a in enumerate(self.surfaces) for b in self.surfaces[:n]))
        return np.array(found)

    def depth(self, every=1):
        """The deepest node inside the surface of another body (m)."""
        deepest = 0.0
        for frame in np.flatnonzero(self.finite)[::every]:
            x = self.points(frame)
            for a in self.surfaces:
                for b in self.surfaces:
                    if a is not b:
                        deepest = max(deepest, inside(x[np.unique(a)], x[b]))
        return deepest

    def rod(self):
        """The deepest point of the surface inside the rod (m), and the largest part of its axis in the block that is inside the block."""
        rod, parts = rod_of(self.file), 12
        grid = np.array([(i, j, parts - i - j) for i in range(parts + 1) for j in range(parts + 1 - i)]) / parts
        deepest = share = 0.0
        for frame in np.flatnonzero(self.finite):
            triangles, centre = self.points(frame)[self.surfaces[0]], rod.at(self.time[frame])
            distance = np.linalg.norm(np.einsum("gk,tkc->gtc", grid, triangles)[..., :2] - centre[:2], axis=-1)
            deepest = max(deepest, rod.radius - distance.min())
            axis = centre + [0, 0, 1] * np.linspace(-1.1, 1.1, 23)[:, None] * CELL
            share = max(share, (winding(axis, triangles) > 0.5).mean())
        return deepest, share
