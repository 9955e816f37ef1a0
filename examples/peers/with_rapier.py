"""Rapier: tetrahedra of corotational or neo-Hookean material, or shape matching of each cube."""

from importlib.metadata import version

import numpy as np
import rapier3d as rapier

from peer import STEP, Scene

SUBSTEPS = 4

scene = Scene(__doc__, models=["corotational", "neo-Hookean", "shape-matching"])
world = rapier.PhysicsWorld(gravity=tuple(scene.gravity))
settings = world.integration_parameters
settings.num_solver_iterations = SUBSTEPS
settings.dt = SUBSTEPS * STEP
settings.normalized_max_corrective_velocity = 1e6  # m/s: by default elastic forces are limited to restoring 3 m/s

material = rapier.SoftBodyMaterial(
    young_modulus=scene.young,
    # At ν = 0 a neo-Hookean body that is shrunk to a point has no more energy than at rest, and stays there.
    poisson_ratio=0.2 if scene.model == "neo-Hookean" else 0.0,
    elastic_damping_ratio=scene.damping_ratio,
    shape_matching_softness=rapier.SpringCoefficients(scene.frequency / (2 * np.pi), scene.damping_ratio),
)
body = rapier.SoftBodyBuilder(scene.position).masses(scene.mass.tolist()).material(material)
if scene.model == "shape-matching":
    body = body.surface(scene.triangles)
else:
    kinds = {"corotational": "COROTATIONAL", "neo-Hookean": "NEO_HOOKEAN"}
    body = body.cells(scene.tetrahedra()).cell_model(getattr(rapier.SoftBodyCellModel, kinds[scene.model]))
body = body.pinned_particles(np.flatnonzero(scene.held)).particle_radius(0.001).can_sleep(False)
if scene.floor:
    sides = rapier.Collider.ball(1.0), rapier.Collider.cuboid(10.0, 1.0, 10.0).translation((0.0, -1.0, 0.0))
    surface, floor = (side.restitution(scene.floor["restitution"]).friction(scene.floor["friction"]) for side in sides)
    body = body.surface_collider(surface)  # the shape of its collider is that of the body
    world.add_collider(floor)
else:
    body = body.no_surface_collider()
handle = world.add_soft_body(body)
if scene.model == "shape-matching":
    for cube in scene.cubes:
        cluster = world.add_soft_body_cluster(handle, cube)
        world.soft_bodies[handle].enable_cluster_shape_matching(cluster, True)
world.soft_bodies[handle].particle_velocities = scene.velocity

scene.record(
    f"Rapier {version('rapier3d')}, {scene.model}",
    world.step,
    lambda: world.soft_bodies[handle].particle_positions,
    stride=SUBSTEPS,
)
