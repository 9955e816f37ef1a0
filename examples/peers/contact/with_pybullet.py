"""PyBullet: neo-Hookean tetrahedra of its deformable world. It has no call for velocities: they are differences over a step."""

import os
import tempfile
from importlib.metadata import version

import numpy as np
import pybullet

SETTINGS = {"default": dict(dt=1 / 240), "fine": dict(dt=1 / 960, face_contact=1, margin=0.002)}
POISSON = 0.3


def vtk(points, tetrahedra):
    """A file of tetrahedra as PyBullet reads it."""
    with tempfile.NamedTemporaryFile("w", suffix=".vtk", delete=False) as file:
        file.write(f"# vtk DataFile Version 2.0\nbody\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {len(points)} double\n")
        np.savetxt(file, points, fmt="%.8f")
        file.write(f"\nCELLS {len(tetrahedra)} {5 * len(tetrahedra)}\n")
        np.savetxt(file, np.c_[np.full(len(tetrahedra), 4), tetrahedra], fmt="%d")
        file.write(f"\nCELL_TYPES {len(tetrahedra)}\n")
        np.savetxt(file, np.full(len(tetrahedra), 10), fmt="%d")
    return file.name


def record(scene, dt, face_contact=0, margin=None):
    pybullet.connect(pybullet.DIRECT)
    pybullet.resetSimulation(pybullet.RESET_USE_DEFORMABLE_WORLD)
    pybullet.setGravity(*scene.gravity)
    pybullet.setTimeStep(dt)
    mu, lame = scene.young / (2 * (1 + POISSON)), scene.young * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    bodies, extra = [], dict(collisionMargin=margin) if margin else {}
    for nodes, tetrahedra in scene.bodies():
        file = vtk(scene.position[nodes], tetrahedra)
        bodies.append(pybullet.loadSoftBody(
            file, basePosition=[0, 0, 0], mass=scene.mass[nodes].sum(), scale=1.0, frictionCoeff=scene.friction, useNeoHookean=1,
            NeoHookeanMu=mu, NeoHookeanLambda=lame, NeoHookeanDamping=scene.damping_time, useSelfCollision=0,
            useFaceContact=face_contact, **extra))
        os.unlink(file)
        if scene.velocity[nodes].any():
            pybullet.resetBaseVelocity(bodies[-1], linearVelocity=scene.velocity[nodes[0]].tolist())
        for node in np.flatnonzero(scene.held[nodes]):
            pybullet.createSoftBodyAnchor(bodies[-1], int(node), -1, -1)
    if scene.floor:
        shape = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[50, 1, 50])
        floor = pybullet.createMultiBody(0, shape, basePosition=[0, -1, 0])
        pybullet.changeDynamics(floor, -1, lateralFriction=scene.friction)
    if scene.rod:
        shape = pybullet.createCollisionShape(pybullet.GEOM_CAPSULE, radius=scene.rod.radius, height=2 * scene.rod.half)
        rod = pybullet.createMultiBody(0, shape, basePosition=scene.rod.at(0).tolist())
        pybullet.changeDynamics(rod, -1, lateralFriction=scene.friction)

    def positions():
        meshes = (pybullet.getMeshData(body, -1, flags=pybullet.MESH_DATA_SIMULATION_MESH) for body in bodies)
        return np.concatenate([np.array(points) for _, points in meshes])

    before = scene.position - dt * scene.velocity

    def step():
        nonlocal before
        before = positions()
        pybullet.stepSimulation()

    def state():
        now = positions()
        return [now, (now - before) / dt]

    def move(centre):
        pybullet.resetBasePositionAndOrientation(rod, centre.tolist(), [0, 0, 0, 1])

    return scene.record(f"PyBullet {version('pybullet')}", dt, step, state, move)
