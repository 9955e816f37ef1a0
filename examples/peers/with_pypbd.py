"""PositionBasedDynamics: shape matching of each cube, the paper's force written as a step of positions."""

from importlib.metadata import version
from itertools import product

import numpy as np
import pypbd

from peer import STEP, Scene

scene = Scene(__doc__)
simulation = pypbd.Simulation.getCurrent()
simulation.initDefault()  # gravity is 9.81 m/s² along -y and cannot be set from Python
model, control = simulation.getModel(), simulation.getTimeStep()
solid = model.addTetModel(list(scene.position), scene.tetrahedra().ravel().tolist(), testMesh=bool(scene.floor))
particles = model.getParticles()
for node, mass in enumerate(scene.mass):
    particles.setMass(node, 0.0 if scene.held[node] else mass)  # nodes without mass are held
    particles.setVelocity(node, scene.velocity[node])

# Once in each step h a cube moves its nodes by the share α of their way to its best-fitting rest shape. Velocities
# change by that distance over h: a force of the stiffness k = α m/h².
share = scene.stiffness * STEP**2 / scene.mass[0]
for cube in scene.cubes.tolist():
    model.addShapeMatchingConstraint(8, cube, [1] * 8, share)
control.setValueUInt(pypbd.TimeStepController.NUM_SUB_STEPS, 1)
control.setValueUInt(pypbd.TimeStepController.MAX_ITERATIONS, 1)
control.setValueUInt(pypbd.TimeStepController.MAX_ITERATIONS_V, 1)
pypbd.TimeManager.getCurrent().setTimeStepSize(STEP)

if scene.floor:
    size = np.array([20.0, 2.0, 20.0])  # m: a fixed box below y = 0
    corners, mesh = pypbd.VertexData(), pypbd.IndexedFaceMesh()
    for corner in product((-0.5, 0.5), repeat=3):
        corners.addVertex(np.array(corner))
    mesh.initMesh(8, 24, 12)
    for a, b, c, d in [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]:
        mesh.addFace([a, b, c])
        mesh.addFace([a, c, d])
    floor = model.addRigidBody(1.0, corners, mesh, translation=np.array([0.0, -1.0, 0.0]), scale=size)
    floor.setMass(0.0)
    detection = control.getCollisionDetection()
    rigid = pypbd.CollisionObject.RigidBodyCollisionObjectType
    detection.addCollisionBox(0, rigid, floor.getGeometry().getVertexDataLocal(), 0, 8, size, False, False)
    detection.setTolerance(0.0)
    # Two bodies multiply their restitutions and add their frictions.
    solid.setRestitutionCoeff(1.0), floor.setRestitutionCoeff(scene.floor["restitution"])
    solid.setFrictionCoeff(0.0), floor.setFrictionCoeff(scene.floor["friction"])

nodes = range(particles.size())
scene.record(
    f"pyPBD {version('pypbd')}",
    lambda: control.step(model),
    lambda: [particles.getPosition(node) for node in nodes],
)
