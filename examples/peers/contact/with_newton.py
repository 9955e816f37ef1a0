"""Newton on Warp: vertex block descent of stable neo-Hookean tetrahedra."""

import newton
import numpy as np
import warp

SETTINGS = {
    "example": dict(margin=0.02, stiffness=5e4),  # as in Newton's example of a soft gift
    "full": dict(margin=0.005, stiffness=5e5, full=True),
}
STEP, ITERATIONS, GAP, POISSON = 1 / 600, 15, 0.02, 0.3


def record(scene, margin, stiffness, full=False):
    warp.config.quiet = True
    warp.set_device("cpu")
    builder = newton.ModelBuilder(up_axis=newton.Axis.Y, gravity=tuple(scene.gravity))
    mu, lame = scene.young / (2 * (1 + POISSON)), scene.young * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    for nodes, tetrahedra in scene.bodies():
        points = [warp.vec3(*map(float, point)) for point in scene.position[nodes]]
        builder.add_soft_mesh(
            pos=warp.vec3(0.0, 0.0, 0.0), rot=warp.quat_identity(), scale=1.0, vel=warp.vec3(*map(float, scene.velocity[nodes[0]])),
            vertices=points, indices=tetrahedra.ravel().tolist(), density=1.0, k_mu=mu, k_lambda=lame,
            k_damp=scene.damping_time * mu, particle_radius=margin / 2,
        )
    builder.particle_mass = np.where(scene.held, 0.0, scene.mass).tolist()  # nodes without mass are held
    side = newton.ModelBuilder.ShapeConfig(mu=scene.friction, ke=stiffness, kd=0.5)
    if scene.floor:
        builder.add_ground_plane(cfg=side)
    if scene.rod:
        place = warp.transform(warp.vec3(*map(float, scene.rod.at(0))), warp.quat_identity())
        builder.add_shape_capsule(-1, xform=place, radius=scene.rod.radius, half_height=scene.rod.half, cfg=side)
    builder.color()
    model = builder.finalize(device="cpu")
    model.soft_contact_ke, model.soft_contact_kd, model.soft_contact_mu = stiffness, 0.5, scene.friction
    pipeline = newton.CollisionPipeline(model, soft_contact_gap=GAP, **(dict(enable_rigid_soft_full_surface_contact=True) if full else {}))
    own = dict(rigid_soft_enable_dat=True, collision_pipeline=pipeline, particle_vertex_contact_buffer_size=64,
               particle_edge_contact_buffer_size=128) if full else {}
    solver = newton.solvers.SolverVBD(
        model, iterations=ITERATIONS, particle_enable_self_contact=True, particle_self_contact_margin=margin,
        particle_self_contact_gap=GAP, particle_topological_contact_filter_threshold=1, particle_enable_tile_solve=False, **own,
    )
    now, after, control, contacts = model.state(), model.state(), model.control(), pipeline.contacts()

    def step():
        nonlocal now, after
        now.clear_forces()
        if not full:
            pipeline.collide(now, contacts)
        solver.step(now, after, control, None if full else contacts, STEP)
        now, after = after, now

    def move(centre):
        places = model.shape_transform.numpy()
        places[-1, :3] = centre
        model.shape_transform.assign(places)

    engine = f"Newton {newton.__version__}, Warp {warp.__version__}"
    return scene.record(engine, STEP, step, lambda: [now.particle_q.numpy(), now.particle_qd.numpy()], move)
