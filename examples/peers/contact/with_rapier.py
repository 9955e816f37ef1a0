"""Rapier: corotational tetrahedra."""

from importlib.metadata import version

import numpy as np
import rapier3d as rapier

SETTINGS = {
    "default": dict(dt=1 / 60, iterations=4),
    "edges": dict(dt=1 / 240, iterations=8, edges=True),
}


def record(scene, dt, iterations, edges=False):
    world = rapier.PhysicsWorld(gravity=tuple(scene.gravity))
    world.set_num_threads(1)
    parameters = world.integration_parameters
    parameters.dt, parameters.num_solver_iterations = dt, iterations
    if edges:
        parameters.normalized_max_corrective_velocity = 1e6  # m/s: by default elastic forces are limited to restoring 3 m/s
        soft = parameters.soft_bodies
        recovery = soft.recovery
        recovery.edge_speculation = recovery.crossing_repulsion = True
        soft.recovery = recovery
        parameters.soft_bodies = soft
        assert parameters.soft_bodies.recovery.edge_speculation
    ratio = scene.damping_time / 2 * np.sqrt(scene.young * scene.side / 2 / scene.mass[0])
    material = rapier.SoftBodyMaterial(young_modulus=scene.young, poisson_ratio=0.0, elastic_damping_ratio=ratio)
    handles = []
    for nodes, tetrahedra in scene.bodies():
        body = rapier.SoftBodyBuilder(scene.position[nodes]).masses(scene.mass[nodes].tolist()).material(material)
        body = body.cells(tetrahedra).cell_model(rapier.SoftBodyCellModel.COROTATIONAL).can_sleep(False)
        body = body.pinned_particles(np.flatnonzero(scene.held[nodes]))
        body = body.surface_collider(rapier.Collider.ball(1.0).friction(scene.friction))  # its shape is that of the body
        handles.append(world.add_soft_body(body))
        world.soft_bodies[handles[-1]].particle_velocities = scene.velocity[nodes]
    if scene.floor:
        floor = rapier.Collider.cuboid(50.0, 1.0, 50.0).translation((0.0, -1.0, 0.0))
        world.add_collider(floor.friction(scene.friction))
    if scene.rod:
        rod = rapier.RigidBody.kinematic_position_based().translation(tuple(scene.rod.at(0)))
        rod = world.add_body(rod)
        world.add_collider(rapier.Collider.capsule_z(scene.rod.half, scene.rod.radius).friction(scene.friction), rod)

    def state():
        bodies = [world.soft_bodies[handle] for handle in handles]
        return [np.concatenate([b.particle_positions for b in bodies]), np.concatenate([b.particle_velocities for b in bodies])]

    def move(centre):
        world.rigid_bodies[rod].set_next_kinematic_translation(tuple(map(float, centre)))

    return scene.record(f"Rapier {version('rapier3d')}", dt, world.step, state, move)
