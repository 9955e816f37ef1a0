"""Triangles that cross, points inside closed surfaces, and how deep these lie."""

import numpy as np


def crossing(a, b):
    """The number of pairs of triangles (n, 3, 3) that cross: a side of one goes through the other."""
    low, high = (np.maximum(a.min(axis=(0, 1)), b.min(axis=(0, 1))), np.minimum(a.max(axis=(0, 1)), b.max(axis=(0, 1))))
    a, b = (each[((each.max(axis=1) >= low) & (each.min(axis=1) <= high)).all(axis=1)] for each in (a, b))
    near = ((a.min(axis=1)[:, None] <= b.max(axis=1)) & (b.min(axis=1) <= a.max(axis=1)[:, None])).all(axis=-1)
    first, second = np.nonzero(near)
    hit = np.zeros(len(first), bool)
    for k in range(3):
        for side, face in ((a[first], b[second]), (b[second], a[first])):
            hit |= pierces(side[:, k], side[:, (k + 1) % 3], *face.swapaxes(0, 1))
    return int(hit.sum())


def pierces(p, q, a, b, c):
    """Whether segments p q go through triangles a b c (Möller and Trumbore 1997)."""
    way, normal = q - p, np.cross(b - a, c - a)
    against = -(way * normal).sum(axis=-1)
    crosses = np.abs(against) > 1e-12
    against = np.where(crosses, against, 1)
    turn = np.cross(p - a, way)
    place = ((p - a) * normal).sum(axis=-1) / against
    u, v = ((c - a) * turn).sum(axis=-1) / against, -((b - a) * turn).sum(axis=-1) / against
    return crosses & (place >= 0) & (place <= 1) & (u >= 0) & (v >= 0) & (u + v <= 1)


def winding(points, triangles):
    """How often closed surfaces wind around points (van Oosterom and Strackee 1983)."""
    a, b, c = (triangles[None, :, k] - points[:, None] for k in range(3))
    x, y, z = (np.linalg.norm(each, axis=-1) for each in (a, b, c))
    below = x * y * z + (a * b).sum(axis=-1) * z + (b * c).sum(axis=-1) * x + (c * a).sum(axis=-1) * y
    return np.arctan2((a * np.cross(b, c)).sum(axis=-1), below).sum(axis=-1) / (2 * np.pi)


def inside(points, triangles):
    """The depth of the deepest of the points inside a surface (m)."""
    corners = triangles.reshape(-1, 3)
    points = points[((points > corners.min(axis=0)) & (points < corners.max(axis=0))).all(axis=1)]
    if len(points):
        points = points[winding(points, triangles) > 0.5]
    if not len(points):
        return 0.0
    a, b, c = triangles.swapaxes(0, 1)
    normal, p = np.cross(b - a, c - a), points[:, None]
    area = (normal**2).sum(axis=-1)
    v, w = ((np.cross(side, p - start) * normal).sum(axis=-1) / area for side, start in ((b - a, a), (a - c, c)))
    over = (v >= 0) & (w >= 0) & (v + w <= 1)
    nearest = np.where(over, np.abs(((p - a) * normal).sum(axis=-1)) / np.sqrt(area), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        way = end - start
        part = np.clip(((p - start) * way).sum(axis=-1) / (way**2).sum(axis=-1), 0, 1)[..., None]
        nearest = np.minimum(nearest, np.linalg.norm(p - start - part * way, axis=-1))
    return float(nearest.min(axis=1).max())
